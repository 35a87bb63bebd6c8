//! Primitives: topology, and placement in the scene.

use glam::{DMat3, DMat4, DVec3};
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;

use super::accessor::Accessor;
use super::attributes::Attributes;
use super::base_color::{self, Materials};
use super::document::Document;
use crate::SurfaceMaterial;
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
    materials: Materials,
    mesh: MeshSource,
    has_normals: bool,
    has_uvs: bool,
    has_albedo: bool,
    /// Whether a texture is looked up elsewhere than at `TEXCOORD_0`.
    has_texture_uvs: bool,
    /// Whether a texture is multiplied by vertex colours.
    has_tints: bool,
    /// Most vertices, and most triangles: nodes may repeat a mesh, so the file's size alone bounds neither.
    limit: usize,
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
            materials: Materials::default(),
            mesh: MeshSource::default(),
            has_normals: false,
            has_uvs: false,
            has_albedo: false,
            has_texture_uvs: false,
            has_tints: false,
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
        let uv_set = match primitive.material {
            Some(material) => base_color::uv_set(self.document, material)?,
            None => None,
        };
        let attributes = Attributes::new(self.document, primitive, uv_set, weights)?;
        let material = match primitive.material {
            Some(index) => self.materials.number(self.document, index, attributes.has_texture_uvs())?,
            None => SurfaceMaterial::NONE,
        };
        if attributes.has_texture_uvs() {
            self.has_texture_uvs |= uv_set != Some(0);
            self.has_tints |= attributes.has_colors();
        }
        let first = self.mesh.positions.len();
        self.check_limit(attributes.vertex_count())?;
        let mirrored = self.add_vertices(&attributes, material, placement)?;
        self.add_triangles(primitive, topology, first as u32, &mirrored)?;
        self.mesh.face_material.resize(self.mesh.triangles.len(), material);
        Ok(())
    }

    /// The faces that are added from now on belong to a part of this name.
    pub(super) fn start_part(&mut self, name: String) {
        self.finish_part();
        self.mesh.parts.push(name);
    }

    fn finish_part(&mut self) {
        let part = self.mesh.parts.len().saturating_sub(1) as u32;
        self.mesh.face_part.resize(self.mesh.triangles.len(), part);
    }

    /// The merged mesh, without arrays that no primitive filled.
    pub(super) fn finish(mut self) -> MeshSource {
        self.finish_part();
        (self.mesh.materials, self.mesh.warnings) = self.materials.into_parts();
        if self.mesh.materials.is_empty() {
            self.mesh.face_material = Vec::new();
        }
        if !self.has_texture_uvs {
            self.mesh.texture_uvs = Vec::new();
        }
        if !self.has_tints {
            self.mesh.tints = Vec::new();
        }
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
        material: u32,
        placement: &Placement<'_>,
    ) -> Result<Vec<bool>, Fault> {
        let material = (material != SurfaceMaterial::NONE).then(|| self.materials.get(material));
        self.has_normals |= attributes.has_normals();
        self.has_uvs |= attributes.has_uvs();
        self.has_albedo |= material.is_some() || attributes.has_colors();
        (0..attributes.vertex_count())
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
                self.mesh.texture_uvs.push(attributes.texture_uv(i));
                self.mesh.tints.push(attributes.tint(i));
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

/// A normal under the inverse transpose of `linear`, made unit; zero where that has no direction.
///
/// The matrix of cofactors is the inverse transpose times the determinant, and exists where that vanishes too.
fn transform_normal(linear: DMat3, mirrored: bool, normal: DVec3) -> [f32; 3] {
    let DMat3 { x_axis: x, y_axis: y, z_axis: z } = linear;
    let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    let sign = if mirrored { -1.0 } else { 1.0 };
    (sign * (cofactors * normal)).normalize_or_zero().as_vec3().to_array()
}
