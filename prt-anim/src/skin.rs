//! Which joints each vertex follows.

use glam::{DMat3, DVec3};

use crate::linear::{cofactors, scaled_inverse, unit_or_z};
use crate::{Affine, Error, Pose, Skeleton};

/// A joint together with the space that the vertices which follow it are given in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bone {
    /// The number of the joint.
    pub joint: usize,
    /// The map from the space of the vertices to the joint's, as it was when the skin was bound.
    pub inverse_bind: Affine,
}

/// The parts of a skin before they are checked: the input of [`Skin::new`].
///
/// `V` vertices with `K` bones each.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SkinSource {
    /// All bones.
    pub bones: Vec<Bone>,
    /// `K`, the number of bones of each vertex; weights that are not needed are zero.
    pub bones_per_vertex: usize,
    /// `[V, K]`, numbers of bones.
    pub bone_indices: Vec<u16>,
    /// `[V, K]`, not negative; made to sum to one. A vertex without weight follows its first bone.
    pub weights: Vec<f32>,
    /// `[V]`, positions in the space that the inverse bind maps take them from.
    pub positions: Vec<[f32; 3]>,
    /// `[V]`, normals in the same space, of any length.
    pub normals: Vec<[f32; 3]>,
}

/// Vertices that follow the joints of a skeleton.
///
/// Posed positions are `Σ_k w_k · world(joint_k) · inverse_bind_k · p`. The surface in the rest pose of the skeleton, from which
/// [frames](crate::Deformed::frames) rotate, is part of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Skin {
    pub(crate) source: SkinSource,
    rest_positions: Vec<[f32; 3]>,
    rest_normals: Vec<[f32; 3]>,
    /// For each vertex the inverse of the blended map's linear part in the rest pose, up to a factor that is not negative.
    pub(crate) bind_from_rest: Vec<[[f32; 3]; 3]>,
}

impl Skin {
    /// Checks the parts and poses them as the skeleton rests.
    ///
    /// Weights are brought into falling order and made to sum to one. A normal without direction becomes +z.
    ///
    /// # Errors
    /// If lengths differ, a number points past its end, a weight is negative or something is not finite, in the rest pose too.
    pub fn new(mut source: SkinSource, skeleton: &Skeleton) -> Result<Self, Error> {
        check_shapes(&source)?;
        check_numbers(&source, skeleton)?;
        sort_and_normalize(&mut source);
        let maps = bone_maps(&source.bones, skeleton, &skeleton.rest_pose());
        let mut skin =
            Self { source, rest_positions: Vec::new(), rest_normals: Vec::new(), bind_from_rest: Vec::new() };
        skin.set_rest(&maps)?;
        Ok(skin)
    }

    /// Number of vertices.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.source.positions.len()
    }

    /// All bones, and for each vertex their numbers, weights, and the position and normal where it was bound.
    #[must_use]
    pub fn parts(&self) -> &SkinSource {
        &self.source
    }

    /// Positions `[V]` in the rest pose, in the scene.
    #[must_use]
    pub fn rest_positions(&self) -> &[[f32; 3]] {
        &self.rest_positions
    }

    /// Normals `[V]` in the rest pose, unit length.
    #[must_use]
    pub fn rest_normals(&self) -> &[[f32; 3]] {
        &self.rest_normals
    }

    /// For each bone the map that takes a vertex from where it was bound to where the pose puts it: `world(joint) · inverse bind`.
    ///
    /// # Panics
    /// If pose and skeleton do not belong to the skin.
    #[must_use]
    pub fn bone_maps(&self, skeleton: &Skeleton, pose: &Pose) -> Vec<Affine> {
        bone_maps(&self.source.bones, skeleton, pose)
    }

    fn set_rest(&mut self, maps: &[Affine]) -> Result<(), Error> {
        for vertex in 0..self.vertex_count() {
            let (linear, translation) = self.blend(vertex, maps);
            let position = (linear * self.bound_position(vertex) + translation).as_vec3();
            if !position.is_finite() {
                return Err(Error::Skin(format!("vertex {vertex} rests at a position that is not finite")));
            }
            self.rest_positions.push(position.to_array());
            let normal = unit_or_z(cofactors(linear) * self.bound_normal(vertex) * linear.determinant().signum());
            self.rest_normals.push(normal.as_vec3().to_array());
            self.bind_from_rest.push(scaled_inverse(linear).as_mat3().to_cols_array_2d());
        }
        Ok(())
    }

    /// Whether the rest pose turns a vertex' surroundings inside out.
    pub(crate) fn is_mirrored(&self, vertex: usize) -> bool {
        DMat3::from_cols_array_2d(&self.bind_from_rest[vertex].map(|column| column.map(f64::from))).determinant() < 0.0
    }

    /// The skin of other vertices that rest where some of these do, with normals of their own.
    pub(crate) fn gather(&self, vertices: &[u32], rest_normals: &[[f32; 3]]) -> Self {
        let per_vertex = self.source.bones_per_vertex;
        let of_bones = |vertex: &u32| *vertex as usize * per_vertex..(*vertex as usize + 1) * per_vertex;
        let source = SkinSource {
            bones: self.source.bones.clone(),
            bones_per_vertex: per_vertex,
            bone_indices: vertices
                .iter()
                .flat_map(|vertex| &self.source.bone_indices[of_bones(vertex)])
                .copied()
                .collect(),
            weights: vertices.iter().flat_map(|vertex| &self.source.weights[of_bones(vertex)]).copied().collect(),
            positions: pick(&self.source.positions, vertices),
            normals: vertices
                .iter()
                .zip(rest_normals)
                .map(|(&vertex, normal)| self.bound_from_rest(vertex, *normal))
                .collect(),
        };
        Self {
            source,
            rest_positions: pick(&self.rest_positions, vertices),
            rest_normals: rest_normals.iter().map(|&normal| unit_or_z(vector(normal)).as_vec3().to_array()).collect(),
            bind_from_rest: pick(&self.bind_from_rest, vertices),
        }
    }

    /// A normal of the rest pose where the vertex was bound: `(M⁻¹)⁻ᵀ = cof(M⁻¹)`, up to a factor, for the rest pose's map `M`.
    fn bound_from_rest(&self, vertex: u32, normal: [f32; 3]) -> [f32; 3] {
        let inverse =
            DMat3::from_cols_array_2d(&self.bind_from_rest[vertex as usize].map(|column| column.map(f64::from)));
        let normal = cofactors(inverse) * vector(normal) * inverse.determinant().signum();
        unit_or_z(normal).as_vec3().to_array()
    }

    /// `Σ_k w_k map_k` of a vertex.
    #[inline]
    pub(crate) fn blend(&self, vertex: usize, maps: &[Affine]) -> (DMat3, DVec3) {
        let per_vertex = self.source.bones_per_vertex;
        let range = vertex * per_vertex..(vertex + 1) * per_vertex;
        let (mut linear, mut translation) = (DMat3::ZERO, DVec3::ZERO);
        for (&bone, &weight) in self.source.bone_indices[range.clone()].iter().zip(&self.source.weights[range]) {
            if weight == 0.0 {
                break;
            }
            let (bone_linear, bone_translation) = maps[usize::from(bone)].parts();
            linear += bone_linear * f64::from(weight);
            translation += bone_translation * f64::from(weight);
        }
        (linear, translation)
    }

    #[inline]
    pub(crate) fn bound_position(&self, vertex: usize) -> DVec3 {
        vector(self.source.positions[vertex])
    }

    fn bound_normal(&self, vertex: usize) -> DVec3 {
        vector(self.source.normals[vertex])
    }
}

fn vector(array: [f32; 3]) -> DVec3 {
    DVec3::from(array.map(f64::from))
}

fn pick<T: Copy>(values: &[T], vertices: &[u32]) -> Vec<T> {
    vertices.iter().map(|&vertex| values[vertex as usize]).collect()
}

fn bone_maps(bones: &[Bone], skeleton: &Skeleton, pose: &Pose) -> Vec<Affine> {
    let world = skeleton.world_from_joints(pose);
    bones.iter().map(|bone| world[bone.joint].after(&bone.inverse_bind)).collect()
}

fn check_shapes(source: &SkinSource) -> Result<(), Error> {
    let vertices = source.positions.len();
    let per_vertex = source.bones_per_vertex;
    let expected = [("normals", source.normals.len(), vertices)];
    let by_bone = [("bone indices", source.bone_indices.len()), ("weights", source.weights.len())]
        .map(|(what, given)| (what, given, vertices.saturating_mul(per_vertex)));
    match expected.into_iter().chain(by_bone).find(|(_, given, needed)| given != needed) {
        Some((what, given, needed)) => {
            Err(Error::Skin(format!("{given} {what} for {vertices} vertices; {needed} are needed")))
        }
        None if per_vertex == 0 && vertices > 0 => Err(Error::Skin("its vertices have no bones".to_owned())),
        None => Ok(()),
    }
}

fn check_numbers(source: &SkinSource, skeleton: &Skeleton) -> Result<(), Error> {
    let (bones, joints) = (source.bones.len(), skeleton.joints().len());
    if let Some(bone) = source.bones.iter().position(|bone| bone.joint >= joints) {
        let joint = source.bones[bone].joint;
        return Err(Error::Skin(format!("bone {bone} is joint {joint}, but there are {joints}")));
    }
    if let Some(i) = source.bone_indices.iter().position(|&bone| usize::from(bone) >= bones) {
        let (vertex, bone) = (i / source.bones_per_vertex, source.bone_indices[i]);
        return Err(Error::Skin(format!("vertex {vertex} follows bone {bone}, but there are {bones}")));
    }
    if let Some(i) = source.weights.iter().position(|weight| !(0.0..=f32::MAX).contains(weight)) {
        let (vertex, weight) = (i / source.bones_per_vertex, source.weights[i]);
        return Err(Error::Skin(format!("vertex {vertex} has the weight {weight}")));
    }
    Ok(())
}

/// Brings the weights of each vertex into falling order and to a sum of one.
fn sort_and_normalize(source: &mut SkinSource) {
    let per_vertex = source.bones_per_vertex.max(1);
    for (bones, weights) in source.bone_indices.chunks_mut(per_vertex).zip(source.weights.chunks_mut(per_vertex)) {
        let mut pairs: Vec<(u16, f32)> = bones.iter().copied().zip(weights.iter().copied()).collect();
        pairs.sort_by(|a, b| b.1.total_cmp(&a.1));
        let sum: f64 = pairs.iter().map(|pair| f64::from(pair.1)).sum();
        for ((bone, weight), pair) in bones.iter_mut().zip(&mut *weights).zip(pairs) {
            *bone = pair.0;
            *weight = (f64::from(pair.1) / sum) as f32;
        }
        if sum == 0.0 {
            weights.fill(0.0);
            weights[0] = 1.0;
        }
    }
}
