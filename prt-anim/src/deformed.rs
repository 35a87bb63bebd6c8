//! What a deformation leaves of a mesh.

use glam::{DMat3, DVec3};

use crate::frame::surface_rotation;
use crate::linear::unit_or_z;
use crate::parallel::fill_three;

/// Vertices after a deformation, as the shading of zonal lobes takes them.
///
/// Made to be kept and written over in every frame; all three arrays are `[V]`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Deformed {
    /// Positions, scene units.
    pub positions: Vec<[f32; 3]>,
    /// Normals, unit length: `frame · rest normal`; a rest normal without direction counts as +z.
    pub normals: Vec<[f32; 3]>,
    /// Rotations from the rest pose, three columns each: what [`rotation_of`](crate::rotation_of) makes of the gradient.
    pub frames: Vec<[[f32; 3]; 3]>,
}

impl Deformed {
    /// Writes all vertices.
    ///
    /// - `vertex`: for each number the new position, the gradient of the deformation and the rest normal
    pub(crate) fn fill(&mut self, count: usize, vertex: impl Fn(usize) -> (DVec3, DMat3, DVec3) + Sync + Send) {
        self.positions.resize(count, [0.0; 3]);
        self.normals.resize(count, [0.0; 3]);
        self.frames.resize(count, [[0.0; 3]; 3]);
        fill_three((&mut self.positions, &mut self.normals, &mut self.frames), |i| {
            let (position, gradient, normal) = vertex(i);
            let normal = unit_or_z(normal);
            let rotation = surface_rotation(gradient, normal);
            (finite(position), (rotation * normal).as_vec3().to_array(), rotation.as_mat3().to_cols_array_2d())
        });
    }
}

/// A position in `f32`: beyond its range the largest value, where there is none zero.
pub(crate) fn finite(position: DVec3) -> [f32; 3] {
    let limit = f64::from(f32::MAX);
    position.to_array().map(|value| if value.is_nan() { 0.0 } else { value.clamp(-limit, limit) as f32 })
}
