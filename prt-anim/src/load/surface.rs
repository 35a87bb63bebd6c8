//! All primitives of the scene as one skinned mesh.

use std::collections::HashMap;

use glam::{DMat3, DVec3};
use gltf::json::mesh::{Mode, Primitive};
use gltf::json::validation::Checked;
use gltf::json::{Index, Skin as SkinJson};

use super::LoadReport;
use super::accessor::Accessor;
use super::attributes::{Attributes, Influence};
use super::document::Document;
use super::fault::Fault;
use crate::{Affine, Bone, Skeleton, Skin, SkinSource, SkinnedMesh};

/// Vertices and triangles that a scene may always have, whatever little data its nodes repeat.
const MIN_LIMIT: usize = 1 << 22;

/// Most bones that a vertex keeps.
const MAX_PER_VERTEX: usize = 8;

/// Albedo of a surface without a material, as elsewhere in the workspace.
const DEFAULT_ALBEDO: [f32; 3] = [0.8; 3];

/// Weights may miss a sum of one by so much without being counted: far more than rounding to `f32`, less than a step of sixteen bits or eight.
const WEIGHT_SUM_TOLERANCE: f64 = 1e-4;

/// The mesh in the making.
pub(super) struct Surface<'a> {
    document: &'a Document<'a>,
    report: &'a mut LoadReport,
    /// With [`MAX_PER_VERTEX`] bones for each vertex.
    skin: SkinSource,
    uvs: Vec<[f32; 2]>,
    albedo: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    /// The number of the first bone of each skin that is in use.
    skins: HashMap<usize, usize>,
    /// Most vertices, and most triangles: nodes may repeat a mesh, so the file's size alone bounds neither.
    limit: usize,
}

impl<'a> Surface<'a> {
    pub(super) fn new(document: &'a Document<'a>, report: &'a mut LoadReport) -> Self {
        Self {
            document,
            report,
            skin: SkinSource { bones_per_vertex: MAX_PER_VERTEX, ..SkinSource::default() },
            uvs: Vec::new(),
            albedo: Vec::new(),
            triangles: Vec::new(),
            skins: HashMap::new(),
            limit: MIN_LIMIT.saturating_add(document.data_bytes()),
        }
    }

    /// Adds the mesh of a node, if it has one.
    pub(super) fn add_node(&mut self, index: usize) -> Result<(), Fault> {
        let node = &self.document.root.nodes[index];
        let Some(mesh) = node.mesh else { return Ok(()) };
        let mesh = self.document.get(mesh, "mesh")?;
        let weights = node.weights.as_deref().or(mesh.weights.as_deref()).unwrap_or_default();
        for primitive in &mesh.primitives {
            self.add_primitive(primitive, weights, index, node.skin)?;
        }
        Ok(())
    }

    /// Puts everything together. Faces that the rest pose turns inside out are turned back.
    pub(super) fn finish(mut self, skeleton: &Skeleton) -> Result<SkinnedMesh, Fault> {
        drop_empty_bones(&mut self.skin);
        let skin = Skin::new(self.skin, skeleton).map_err(|error| Fault::inconsistent(&error))?;
        for triangle in &mut self.triangles {
            let [a, b, c] = *triangle;
            if triangle.iter().filter(|&&vertex| skin.is_mirrored(vertex as usize)).count() >= 2 {
                *triangle = [a, c, b];
            }
        }
        Ok(SkinnedMesh { skin, uvs: self.uvs, albedo: self.albedo, triangles: self.triangles })
    }

    fn add_primitive(
        &mut self,
        primitive: &Primitive,
        morph_weights: &[f32],
        node: usize,
        skin: Option<Index<SkinJson>>,
    ) -> Result<(), Fault> {
        let Some(topology) = Topology::of(primitive)? else {
            self.report.other_primitives += 1;
            return Ok(());
        };
        let attributes = Attributes::new(self.document, primitive, morph_weights)?;
        self.check_limit(attributes.vertex_count())?;
        let first = self.skin.positions.len();
        let albedo = self.albedo_of(primitive)?;
        self.add_vertices(&attributes, albedo);
        match skin {
            Some(skin) if attributes.has_influences() => self.add_influences(&attributes, skin)?,
            _ => self.add_rigid(attributes.vertex_count(), node)?,
        }
        let first_triangle = self.triangles.len();
        self.add_triangles(primitive, topology, first, attributes.vertex_count())?;
        self.complete_normals(first, first_triangle);
        self.report.morphed_primitives += usize::from(primitive.targets.as_ref().is_some_and(|all| !all.is_empty()));
        Ok(())
    }

    fn check_limit(&self, more: usize) -> Result<(), Fault> {
        let limit = self.limit;
        if self.skin.positions.len().max(self.triangles.len()).saturating_add(more) <= limit {
            return Ok(());
        }
        Err(Fault::unsupported(format!(
            "a scene that repeats its meshes to more than {limit} vertices or triangles is"
        )))
    }

    fn albedo_of(&mut self, primitive: &Primitive) -> Result<[f32; 3], Fault> {
        let Some(material) = primitive.material else { return Ok(DEFAULT_ALBEDO) };
        let base = &self.document.get(material, "material")?.pbr_metallic_roughness;
        let [red, green, blue, _] = base.base_color_factor.0;
        self.report.textured_primitives += usize::from(base.base_color_texture.is_some());
        Ok([red, green, blue].map(|channel| channel.clamp(0.0, 1.0)))
    }

    fn add_vertices(&mut self, attributes: &Attributes<'_>, albedo: [f32; 3]) {
        for i in 0..attributes.vertex_count() {
            self.skin.positions.push(attributes.position(i).as_vec3().to_array());
            self.skin.normals.push(attributes.normal(i).as_vec3().to_array());
            self.uvs.push(attributes.uv(i));
            self.albedo.push(albedo);
        }
    }

    /// Vertices that hang from a node.
    fn add_rigid(&mut self, count: usize, node: usize) -> Result<(), Fault> {
        let bone = self.skin.bones.len();
        self.skin.bones.push(Bone { joint: node, inverse_bind: Affine::IDENTITY });
        self.report.rigid_vertices += count;
        (0..count).try_for_each(|_| self.push_influences(&mut vec![Influence { bone, weight: 1.0 }]))
    }

    fn add_influences(&mut self, attributes: &Attributes<'_>, skin: Index<SkinJson>) -> Result<(), Fault> {
        let first = self.bones_of(skin)?;
        let bone_count = self.document.get(skin, "skin")?.joints.len();
        let mut influences = Vec::new();
        for i in 0..attributes.vertex_count() {
            attributes.influences(i, bone_count, &mut influences)?;
            influences.iter_mut().for_each(|influence| influence.bone += first);
            let sum: f64 = influences.iter().map(|influence| influence.weight).sum();
            self.report.weights_normalized += usize::from((sum - 1.0).abs() > WEIGHT_SUM_TOLERANCE);
            self.push_influences(&mut influences)?;
        }
        Ok(())
    }

    /// The eight largest weights of a vertex.
    fn push_influences(&mut self, influences: &mut Vec<Influence>) -> Result<(), Fault> {
        influences.sort_by(|a, b| b.weight.total_cmp(&a.weight));
        self.report.weights_dropped += influences.len().saturating_sub(MAX_PER_VERTEX);
        influences.resize(MAX_PER_VERTEX, Influence { bone: 0, weight: 0.0 });
        for influence in influences {
            let bone = u16::try_from(influence.bone);
            self.skin.bone_indices.push(bone.map_err(|_| Fault::unsupported("more than 65536 joints are"))?);
            self.skin.weights.push(influence.weight as f32);
        }
        Ok(())
    }

    /// The number of the first bone of a skin; its bones are added where they are not there yet.
    fn bones_of(&mut self, index: Index<SkinJson>) -> Result<usize, Fault> {
        if let Some(&first) = self.skins.get(&index.value()) {
            return Ok(first);
        }
        let skin = self.document.get(index, "skin")?;
        let matrices =
            skin.inverse_bind_matrices.map(|accessor| Accessor::new(self.document, accessor, &[16])).transpose()?;
        let joints = skin.joints.len();
        if let Some(count) = matrices.as_ref().map(Accessor::count).filter(|&count| count < joints) {
            return Err(Fault::malformed(format!(
                "skin {index} has {joints} joints and {count} inverse bind matrices"
            )));
        }
        let first = self.skin.bones.len();
        for (number, &node) in skin.joints.iter().enumerate() {
            self.document.get(node, "node")?;
            let inverse_bind = matrices.as_ref().map_or(Affine::IDENTITY, |all| affine(all.get(number)));
            self.skin.bones.push(Bone { joint: node.value(), inverse_bind });
        }
        self.skins.insert(index.value(), first);
        Ok(first)
    }

    fn add_triangles(
        &mut self,
        primitive: &Primitive,
        topology: Topology,
        first: usize,
        vertices: usize,
    ) -> Result<(), Fault> {
        let indices = primitive.indices.map(|indices| Accessor::new(self.document, indices, &[1])).transpose()?;
        if indices.as_ref().is_some_and(Accessor::is_float) {
            return Err(Fault::malformed("a primitive has indices that are not whole numbers"));
        }
        let count = topology.triangle_count(indices.as_ref().map_or(vertices, Accessor::count));
        self.check_limit(count)?;
        for i in 0..count {
            let corners =
                topology.corners(i).map(|corner| indices.as_ref().map_or(corner as u32, |all| all.index(corner)));
            if let Some(corner) = corners.iter().find(|&&corner| corner as usize >= vertices) {
                return Err(Fault::malformed(format!("a primitive of {vertices} vertices refers to vertex {corner}")));
            }
            self.triangles.push(corners.map(|corner| first as u32 + corner));
        }
        Ok(())
    }

    /// Where a vertex of the last primitive has no normal: the sum of its faces' normals, weighted by their areas.
    fn complete_normals(&mut self, first: usize, first_triangle: usize) {
        let is_missing = |normal: &[f32; 3]| *normal == [0.0; 3] || !normal.iter().all(|part| part.is_finite());
        let missing = self.skin.normals[first..].iter().filter(|normal| is_missing(normal)).count();
        if missing == 0 {
            return;
        }
        self.report.normals_computed += missing;
        let mut sums = vec![DVec3::ZERO; self.skin.normals.len() - first];
        for triangle in &self.triangles[first_triangle..] {
            let [a, b, c] = triangle.map(|vertex| DVec3::from(self.skin.positions[vertex as usize].map(f64::from)));
            let normal = (b - a).cross(c - a);
            triangle.iter().for_each(|&vertex| sums[vertex as usize - first] += normal);
        }
        for (normal, sum) in self.skin.normals[first..].iter_mut().zip(sums) {
            if is_missing(normal) {
                *normal = sum.normalize_or(DVec3::Z).as_vec3().to_array();
            }
        }
    }
}

fn affine(matrix: [f64; 16]) -> Affine {
    let matrix = glam::DMat4::from_cols_array(&matrix);
    Affine::from_parts(DMat3::from_mat4(matrix), matrix.w_axis.truncate())
}

/// Four bones for each vertex where no vertex has more.
fn drop_empty_bones(skin: &mut SkinSource) {
    let half = MAX_PER_VERTEX / 2;
    if skin.weights.chunks(MAX_PER_VERTEX).any(|weights| weights[half] > 0.0) {
        return;
    }
    skin.bones_per_vertex = half;
    skin.weights = skin.weights.chunks(MAX_PER_VERTEX).flat_map(|weights| &weights[..half]).copied().collect();
    skin.bone_indices = skin.bone_indices.chunks(MAX_PER_VERTEX).flat_map(|bones| &bones[..half]).copied().collect();
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
