//! The vertices of a primitive, as the document gives them.

use glam::{DMat4, DVec3};
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::validation::Checked;

use super::accessor::Accessor;
use super::document::Document;
use crate::SurfaceMaterial;
use crate::input::Fault;

/// The arrays of a primitive, each as long as the positions.
pub(super) struct Attributes<'a> {
    positions: Accessor<'a>,
    normals: Option<Accessor<'a>>,
    uvs: Option<Accessor<'a>>,
    texture_uvs: Option<Accessor<'a>>,
    colors: Option<Accessor<'a>>,
    /// Joints and weights, four of each a vertex.
    influences: Vec<[Accessor<'a>; 2]>,
    targets: Vec<Target<'a>>,
}

/// A morph target with a weight that is not zero.
struct Target<'a> {
    weight: f64,
    positions: Option<Accessor<'a>>,
    normals: Option<Accessor<'a>>,
}

impl<'a> Attributes<'a> {
    /// Finds the arrays and checks their lengths.
    ///
    /// - `uv_set`: which `TEXCOORD_n` the base colour needs
    /// - `weights`: of the morph targets; missing ones are zero
    pub(super) fn new(
        document: &'a Document<'_>,
        primitive: &Primitive,
        uv_set: Option<u32>,
        weights: &[f32],
    ) -> Result<Self, Fault> {
        let get = |name: Semantic, components: &[usize]| {
            let index = primitive.attributes.get(&Checked::Valid(name));
            index.map(|&index| Accessor::new(document, index, components)).transpose()
        };
        let positions = get(Semantic::Positions, &[3])?;
        let positions = positions.ok_or_else(|| Fault::malformed("a primitive has no positions"))?;
        let influences = (0..)
            .map_while(|set| {
                let pair = get(Semantic::Joints(set), &[4])
                    .and_then(|joints| Ok((joints, get(Semantic::Weights(set), &[4])?)));
                match pair {
                    Ok((Some(joints), Some(weights))) => Some(Ok([joints, weights.normalized()])),
                    Ok(_) => None,
                    Err(fault) => Some(Err(fault)),
                }
            })
            .collect::<Result<_, _>>()?;
        let attributes = Self {
            positions,
            normals: get(Semantic::Normals, &[3])?,
            uvs: get(Semantic::TexCoords(0), &[2])?,
            texture_uvs: uv_set.map_or(Ok(None), |set| get(Semantic::TexCoords(set), &[2]))?,
            colors: get(Semantic::Colors(0), &[3, 4])?.map(Accessor::normalized),
            influences,
            targets: targets(document, primitive, weights)?,
        };
        attributes.check_counts()?;
        Ok(attributes)
    }

    /// How many vertices there are.
    pub(super) fn vertex_count(&self) -> usize {
        self.positions.count()
    }

    pub(super) fn has_normals(&self) -> bool {
        self.normals.is_some()
    }

    pub(super) fn has_uvs(&self) -> bool {
        self.uvs.is_some()
    }

    pub(super) fn has_texture_uvs(&self) -> bool {
        self.texture_uvs.is_some()
    }

    pub(super) fn has_colors(&self) -> bool {
        self.colors.is_some()
    }

    fn check_counts(&self) -> Result<(), Fault> {
        let optional = [&self.normals, &self.uvs, &self.texture_uvs, &self.colors];
        let targets = self.targets.iter().flat_map(|target| [&target.positions, &target.normals]);
        let others = optional.into_iter().chain(targets).flatten().chain(self.influences.iter().flatten());
        let vertices = self.positions.count();
        match others.map(Accessor::count).find(|&count| count != vertices) {
            Some(count) => {
                Err(Fault::malformed(format!("a primitive of {vertices} vertices has an attribute of {count}")))
            }
            None => Ok(()),
        }
    }

    /// A position in the mesh's space, morphed.
    pub(super) fn position(&self, i: usize) -> DVec3 {
        let moved =
            self.targets.iter().filter_map(|target| Some(target.weight * vector(target.positions.as_ref()?, i)));
        vector(&self.positions, i) + moved.sum::<DVec3>()
    }

    /// A normal in the mesh's space, morphed, of any length; zero where there is none.
    pub(super) fn normal(&self, i: usize) -> DVec3 {
        let Some(normals) = &self.normals else { return DVec3::ZERO };
        let moved = self.targets.iter().filter_map(|target| Some(target.weight * vector(target.normals.as_ref()?, i)));
        vector(normals, i) + moved.sum::<DVec3>()
    }

    /// `TEXCOORD_0`, zero where there is none.
    pub(super) fn uv(&self, i: usize) -> [f32; 2] {
        self.uvs.as_ref().map_or([0.0; 2], |uvs| uvs.get(i).map(|value| value as f32))
    }

    /// The coordinate of the base colour's texture, zero where there is none.
    pub(super) fn texture_uv(&self, i: usize) -> [f32; 2] {
        self.texture_uvs.as_ref().map_or([0.0; 2], |uvs| uvs.get(i).map(|value| value as f32))
    }

    /// `COLOR_0`, white where there is none.
    pub(super) fn tint(&self, i: usize) -> [f32; 3] {
        self.colors.as_ref().map_or([1.0; 3], |colors| colors.get(i).map(|value| value as f32))
    }

    /// Base colour × vertex colour, NaN where there is neither.
    pub(super) fn albedo(&self, i: usize, material: Option<&SurfaceMaterial>) -> [f32; 3] {
        let color: Option<[f64; 3]> = self.colors.as_ref().map(|colors| colors.get(i));
        let base = material.map(|material| {
            let uv = self.texture_uvs.as_ref().map(|uvs| uvs.get(i));
            let texel = material.texture.as_ref().zip(uv).map_or([1.0; 3], |(map, uv)| map.color(uv));
            [0, 1, 2].map(|channel| f64::from(material.base_color[channel]) * texel[channel])
        });
        let albedo = match (base, color) {
            (Some(base), Some(color)) => [0, 1, 2].map(|channel| base[channel] * color[channel]),
            (Some(only), None) | (None, Some(only)) => only,
            (None, None) => return [f32::NAN; 3],
        };
        if albedo.iter().any(|value| value.is_nan()) {
            return [f32::NAN; 3];
        }
        albedo.map(|value| value.clamp(0.0, 1.0) as f32)
    }

    /// `Σ w_j joints_j` with weights that are made to sum to one; a vertex without weight follows its first joint.
    pub(super) fn blend(&self, i: usize, joints: &[DMat4]) -> Result<DMat4, Fault> {
        let mut sum = DMat4::ZERO;
        let mut total = 0.0;
        for [indices, weights] in &self.influences {
            let (indices, weights): ([f64; 4], [f64; 4]) = (indices.get(i), weights.get(i));
            for (joint, weight) in indices.into_iter().zip(weights) {
                if weight > 0.0 {
                    sum += weight * joint_matrix(joint, joints)?;
                    total += weight;
                }
            }
        }
        if total > 0.0 {
            return Ok(sum * (1.0 / total));
        }
        let [first] = self.influences.first().map_or([0.0], |[indices, _]| indices.get(i));
        joint_matrix(first, joints)
    }
}

fn joint_matrix(joint: f64, joints: &[DMat4]) -> Result<DMat4, Fault> {
    let missing = || Fault::malformed(format!("a vertex follows joint {joint} of a skin of {} joints", joints.len()));
    joints.get(joint as usize).copied().ok_or_else(missing)
}

fn targets<'a>(document: &'a Document<'_>, primitive: &Primitive, weights: &[f32]) -> Result<Vec<Target<'a>>, Fault> {
    let active = primitive.targets.iter().flatten().zip(weights).filter(|&(_, &weight)| weight != 0.0);
    active
        .map(|(target, &weight)| {
            let get = |index: Option<_>| index.map(|index| Accessor::new(document, index, &[3])).transpose();
            Ok(Target { weight: weight.into(), positions: get(target.positions)?, normals: get(target.normals)? })
        })
        .collect()
}

fn vector(accessor: &Accessor<'_>, i: usize) -> DVec3 {
    DVec3::from(accessor.get::<3>(i))
}
