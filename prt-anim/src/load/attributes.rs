//! The vertices of a primitive, as the document gives them.

use glam::DVec3;
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::validation::Checked;

use super::accessor::Accessor;
use super::document::Document;
use super::fault::Fault;

/// A bone that a vertex follows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Influence {
    pub(super) bone: usize,
    pub(super) weight: f64,
}

/// The arrays of a primitive, each as long as the positions.
pub(super) struct Attributes<'a> {
    positions: Accessor<'a>,
    normals: Option<Accessor<'a>>,
    uvs: Option<Accessor<'a>>,
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
    /// - `weights`: of the morph targets; missing ones are zero
    pub(super) fn new(document: &'a Document<'_>, primitive: &Primitive, weights: &[f32]) -> Result<Self, Fault> {
        let get = |name: Semantic, components: &[usize]| {
            let index = primitive.attributes.get(&Checked::Valid(name));
            index.map(|&index| Accessor::new(document, index, components)).transpose()
        };
        let positions = get(Semantic::Positions, &[3])?;
        let attributes = Self {
            positions: positions.ok_or_else(|| Fault::malformed("a primitive has no positions"))?,
            normals: get(Semantic::Normals, &[3])?,
            uvs: get(Semantic::TexCoords(0), &[2])?,
            influences: influences(|name| get(name, &[4]))?,
            targets: targets(document, primitive, weights)?,
        };
        attributes.check_counts()?;
        Ok(attributes)
    }

    pub(super) fn vertex_count(&self) -> usize {
        self.positions.count()
    }

    pub(super) fn has_influences(&self) -> bool {
        !self.influences.is_empty()
    }

    fn check_counts(&self) -> Result<(), Fault> {
        let targets = self.targets.iter().flat_map(|target| [&target.positions, &target.normals]);
        let optional = [&self.normals, &self.uvs].into_iter().chain(targets).flatten();
        let vertices = self.positions.count();
        match optional.chain(self.influences.iter().flatten()).map(Accessor::count).find(|&count| count != vertices) {
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

    /// `TEXCOORD_0`, zero where there is none or it is not finite.
    pub(super) fn uv(&self, i: usize) -> [f32; 2] {
        let uv = self.uvs.as_ref().map_or([0.0; 2], |uvs| uvs.get(i).map(|value| value as f32));
        if uv.iter().all(|value| value.is_finite()) { uv } else { [0.0; 2] }
    }

    /// The joints of a vertex with their weights, as numbers within the skin; one that has no weight follows its first joint.
    pub(super) fn influences(&self, i: usize, joint_count: usize, out: &mut Vec<Influence>) -> Result<(), Fault> {
        out.clear();
        for [joints, weights] in &self.influences {
            let (joints, weights): ([f64; 4], [f64; 4]) = (joints.get(i), weights.get(i));
            let pairs = joints.into_iter().zip(weights).filter(|&(_, weight)| weight > 0.0);
            out.extend(pairs.map(|(joint, weight)| Influence { bone: joint as usize, weight }));
        }
        if out.is_empty() {
            let [first] = self.influences.first().map_or([0.0], |[joints, _]| joints.get(i));
            out.push(Influence { bone: first as usize, weight: 1.0 });
        }
        match out.iter().find(|influence| influence.bone >= joint_count) {
            Some(Influence { bone, .. }) => {
                Err(Fault::malformed(format!("a vertex follows joint {bone} of a skin of {joint_count} joints")))
            }
            None => Ok(()),
        }
    }
}

/// `JOINTS_n` and `WEIGHTS_n`, as many sets as there are.
fn influences<'a>(
    get: impl Fn(Semantic) -> Result<Option<Accessor<'a>>, Fault>,
) -> Result<Vec<[Accessor<'a>; 2]>, Fault> {
    let mut sets = Vec::new();
    for set in 0.. {
        let (Some(joints), Some(weights)) = (get(Semantic::Joints(set))?, get(Semantic::Weights(set))?) else { break };
        if joints.is_float() {
            return Err(Fault::malformed("a primitive has joints that are not whole numbers"));
        }
        sets.push([joints, weights.normalized()]);
    }
    Ok(sets)
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
