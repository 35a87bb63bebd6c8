//! Primitives: attributes, topology, and their placement in the scene.

use glam::{DMat3, DMat4, DVec3};
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;

use super::accessor::Accessor;
use super::base_color::{BaseColor, Textures};
use super::document::Document;
use crate::input::Fault;
use crate::mesh::MeshSource;

/// Vertices and triangles that a scene may always have, whatever little data its nodes repeat.
const MIN_LIMIT: usize = 1 << 22;

/// How a primitive's vertices get into the world.
pub(super) enum Placement<'a> {
    /// By the node's transform.
    Rigid(DMat4),
    /// By the joints that each vertex follows.
    Skinned(&'a [DMat4]),
}

/// The mesh that all primitives are merged into.
pub(super) struct Scene<'a> {
    document: &'a Document<'a>,
    textures: Textures,
    mesh: MeshSource,
    has_normals: bool,
    has_uvs: bool,
    has_albedo: bool,
    /// Most vertices, and most triangles: nodes may repeat a mesh, so the file's size alone bounds neither.
    limit: usize,
}

/// The arrays of a primitive, each as long as the positions.
struct Attributes<'a> {
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

/// Whether a primitive says which joints its vertices follow.
pub(super) fn has_joints(primitive: &Primitive) -> bool {
    [Semantic::Joints(0), Semantic::Weights(0)]
        .into_iter()
        .all(|name| primitive.attributes.contains_key(&Checked::Valid(name)))
}

impl<'a> Scene<'a> {
    pub(super) fn new(document: &'a Document<'a>) -> Self {
        Self {
            document,
            textures: Textures::new(),
            mesh: MeshSource::default(),
            has_normals: false,
            has_uvs: false,
            has_albedo: false,
            limit: MIN_LIMIT + document.data_bytes(),
        }
    }

    /// Adds a primitive; points and lines are passed over.
    ///
    /// - `weights`: of the morph targets; missing ones are zero
    pub(super) fn add(
        &mut self,
        primitive: &Primitive,
        weights: &[f32],
        placement: &Placement<'_>,
    ) -> Result<(), Fault> {
        let Some(topology) = Topology::of(primitive)? else { return Ok(()) };
        let material = match primitive.material {
            Some(material) => Some(BaseColor::load(self.document, material, &mut self.textures)?),
            None => None,
        };
        let uv_set = material.as_ref().and_then(BaseColor::uv_set);
        let attributes = Attributes::new(self.document, primitive, uv_set, weights)?;
        let first = self.mesh.positions.len();
        self.check_limit(attributes.positions.count())?;
        let mirrored = self.add_vertices(&attributes, material.as_ref(), placement)?;
        self.add_triangles(primitive, topology, first as u32, &mirrored)
    }

    /// The merged mesh, without arrays that no primitive filled.
    pub(super) fn finish(mut self) -> MeshSource {
        if !self.has_normals {
            self.mesh.normals = Vec::new();
        }
        if !self.has_uvs {
            self.mesh.uvs = Vec::new();
        }
        if !self.has_albedo {
            self.mesh.albedo = Vec::new();
        }
        self.mesh
    }

    fn check_limit(&self, more: usize) -> Result<(), Fault> {
        if self.mesh.positions.len().max(self.mesh.triangles.len()) + more <= self.limit {
            return Ok(());
        }
        let limit = self.limit;
        Err(Fault::unsupported(format!(
            "a scene that repeats its meshes to more than {limit} vertices or triangles is"
        )))
    }

    /// Appends the vertices; tells which are turned inside out on their way into the world.
    fn add_vertices(
        &mut self,
        attributes: &Attributes<'_>,
        material: Option<&BaseColor>,
        placement: &Placement<'_>,
    ) -> Result<Vec<bool>, Fault> {
        self.has_normals |= attributes.normals.is_some();
        self.has_uvs |= attributes.uvs.is_some();
        self.has_albedo |= material.is_some() || attributes.colors.is_some();
        (0..attributes.positions.count())
            .map(|i| {
                let world_from_local = match placement {
                    Placement::Rigid(matrix) => *matrix,
                    Placement::Skinned(joints) => attributes.blend(i, joints)?,
                };
                let linear = DMat3::from_mat4(world_from_local);
                let mirrored = linear.determinant() < 0.0;
                self.mesh.positions.push(world_from_local.transform_point3(attributes.position(i)).to_array());
                self.mesh.normals.push(transform_normal(linear, mirrored, attributes.normal(i)));
                self.mesh.uvs.push(attributes.uv(i));
                self.mesh.albedo.push(attributes.albedo(i, material));
                Ok(mirrored)
            })
            .collect()
    }

    fn add_triangles(
        &mut self,
        primitive: &Primitive,
        topology: Topology,
        first: u32,
        mirrored: &[bool],
    ) -> Result<(), Fault> {
        let indices = primitive.indices.map(|indices| Accessor::new(self.document, indices, &[1])).transpose()?;
        if indices.as_ref().is_some_and(Accessor::is_float) {
            return Err(Fault::malformed("a primitive has indices that are not whole numbers"));
        }
        let count = indices.as_ref().map_or(mirrored.len(), Accessor::count);
        self.check_limit(topology.triangle_count(count))?;
        for i in 0..topology.triangle_count(count) {
            let corners =
                topology.corners(i).map(|corner| indices.as_ref().map_or(corner as u32, |all| all.index(corner)));
            if let Some(corner) = corners.iter().find(|&&corner| corner as usize >= mirrored.len()) {
                let vertices = mirrored.len();
                return Err(Fault::malformed(format!("a primitive of {vertices} vertices refers to vertex {corner}")));
            }
            let [a, b, c] = corners.map(|corner| first + corner);
            let turned = corners.iter().filter(|&&corner| mirrored[corner as usize]).count() >= 2;
            self.mesh.triangles.push(if turned { [a, c, b] } else { [a, b, c] });
        }
        Ok(())
    }
}

/// How corners make triangles.
#[derive(Debug, Clone, Copy)]
enum Topology {
    Triangles,
    Strip,
    Fan,
}

impl Topology {
    /// `None` for points and lines.
    fn of(primitive: &Primitive) -> Result<Option<Self>, Fault> {
        match primitive.mode {
            Checked::Valid(Mode::Triangles) => Ok(Some(Self::Triangles)),
            Checked::Valid(Mode::TriangleStrip) => Ok(Some(Self::Strip)),
            Checked::Valid(Mode::TriangleFan) => Ok(Some(Self::Fan)),
            Checked::Valid(_) => Ok(None),
            Checked::Invalid => Err(Fault::malformed("a primitive has an unknown mode")),
        }
    }

    fn triangle_count(self, corners: usize) -> usize {
        match self {
            Self::Triangles => corners / 3,
            Self::Strip | Self::Fan => corners.saturating_sub(2),
        }
    }

    /// glTF 2.0, section 3.7.2.1.
    fn corners(self, i: usize) -> [usize; 3] {
        match self {
            Self::Triangles => [3 * i, 3 * i + 1, 3 * i + 2],
            Self::Strip => [i, i + 1 + i % 2, i + 2 - i % 2],
            Self::Fan => [i + 1, i + 2, 0],
        }
    }
}

impl<'a> Attributes<'a> {
    fn new(
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

    fn position(&self, i: usize) -> DVec3 {
        let moved =
            self.targets.iter().filter_map(|target| Some(target.weight * vector(target.positions.as_ref()?, i)));
        vector(&self.positions, i) + moved.sum::<DVec3>()
    }

    /// Zero where there is none.
    fn normal(&self, i: usize) -> DVec3 {
        let Some(normals) = &self.normals else { return DVec3::ZERO };
        let moved = self.targets.iter().filter_map(|target| Some(target.weight * vector(target.normals.as_ref()?, i)));
        vector(normals, i) + moved.sum::<DVec3>()
    }

    fn uv(&self, i: usize) -> [f32; 2] {
        self.uvs.as_ref().map_or([0.0; 2], |uvs| uvs.get(i).map(|value| value as f32))
    }

    /// Base colour × vertex colour, NaN where there is neither.
    fn albedo(&self, i: usize, material: Option<&BaseColor>) -> [f32; 3] {
        let color: Option<[f64; 3]> = self.colors.as_ref().map(|colors| colors.get(i));
        let base = material.map(|material| material.at(self.texture_uvs.as_ref().map(|uvs| uvs.get(i))));
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
    fn blend(&self, i: usize, joints: &[DMat4]) -> Result<DMat4, Fault> {
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

/// A normal under the inverse transpose of `linear`, made unit; zero where that has no direction.
///
/// The matrix of cofactors is the inverse transpose times the determinant, and exists where that vanishes too.
fn transform_normal(linear: DMat3, mirrored: bool, normal: DVec3) -> [f32; 3] {
    let DMat3 { x_axis: x, y_axis: y, z_axis: z } = linear;
    let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    let sign = if mirrored { -1.0 } else { 1.0 };
    (sign * (cofactors * normal)).normalize_or_zero().as_vec3().to_array()
}
