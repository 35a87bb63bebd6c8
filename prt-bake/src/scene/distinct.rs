//! The triangles that go into the tree.

use glam::Vec3;

use crate::{Mesh, SurfaceMaterial};

/// Corners in the same cell of a grid of this many to a scene coincide. It is finer than the distance beside a surface at which rays start.
const CELLS: f32 = 16_777_216.0;

/// The numbers of the faces of a mesh that rays may meet and that are no repetition of an earlier one: in `f32` a face may have no area, or
/// have its corners where another has them. Many that coincide would make a deep tree, whose boxes keep nothing apart.
///
/// - `corners`: of a face, in the frame that is traced in
pub(super) fn faces(mesh: &Mesh, corners: impl Fn(u32) -> [Vec3; 3]) -> Vec<u32> {
    let has_area = |&face: &u32| {
        let [a, b, c] = corners(face);
        (b - a).cross(c - a) != Vec3::ZERO
    };
    let mut faces: Vec<u32> = (0..mesh.original_triangles().len() as u32).filter(has_area).collect();
    if !mesh.materials().iter().any(SurfaceMaterial::may_have_holes) {
        let cells = |face: u32| corners(face).map(|corner| (corner * CELLS).round().as_ivec3().to_array());
        faces.sort_unstable_by(|&a, &b| cells(a).cmp(&cells(b)).then(a.cmp(&b)));
        faces.dedup_by(|a, b| cells(*a) == cells(*b));
        faces.sort_unstable();
    }
    if faces.is_empty() {
        faces.push(0);
    }
    faces
}
