//! Frames from the triangles of a mesh before and after a deformation of any kind.

use glam::{DMat3, DVec3};

use crate::frame::surface_rotation;
use crate::linear::{cofactors, unit_or_z};
use crate::parallel::fill;

/// Frames of all vertices of a mesh that was deformed in an unknown way.
///
/// A face's gradient takes its two edges and its normal to those of the deformed face, the normal scaled by the square root of the
/// ratio of areas, so that it is exact for similar triangles. A vertex has the average of its faces' gradients, weighted by
/// their areas in the rest pose (so that the noise in the gradient of a sliver does not count), and then [`rotation_of`](crate::rotation_of).
///
/// - `rest_positions`, `rest_normals`, `deformed_positions`: `[V]`
/// - `triangles`: three vertex numbers each
/// - returns `[V]`
///
/// A vertex without faces, or whose faces have no area in the rest pose, keeps the identity. Exact (to rounding) under rigid motions and
/// uniform scaling; under a smooth deformation the error falls with the length of the edges (measured in
/// `tests/frames.rs`). Vertices that are split at seams of texture coordinates see the faces of one side only.
///
/// # Panics
/// If lengths differ, or a triangle points past the end.
#[must_use]
pub fn frames_from_mesh(
    rest_positions: &[[f32; 3]],
    rest_normals: &[[f32; 3]],
    deformed_positions: &[[f32; 3]],
    triangles: &[[u32; 3]],
) -> Vec<[[f32; 3]; 3]> {
    let count = rest_positions.len();
    assert_eq!(rest_normals.len(), count, "one normal for each vertex is needed");
    assert_eq!(deformed_positions.len(), count, "one deformed position for each vertex is needed");
    let mut faces = vec![None; triangles.len()];
    fill(&mut faces, |face| {
        let rest = corners(rest_positions, triangles[face]);
        weighted_gradient(rest, corners(deformed_positions, triangles[face]))
    });
    let sums = sum_over_faces(count, triangles, &faces);
    let mut frames = vec![DMat3::IDENTITY.as_mat3().to_cols_array_2d(); count];
    fill(&mut frames, |vertex| {
        let normal = unit_or_z(DVec3::from(rest_normals[vertex].map(f64::from)));
        surface_rotation(sums[vertex], normal).as_mat3().to_cols_array_2d()
    });
    frames
}

/// The sum over the faces around each vertex.
fn sum_over_faces(count: usize, triangles: &[[u32; 3]], faces: &[Option<DMat3>]) -> Vec<DMat3> {
    let mut sums = vec![DMat3::ZERO; count];
    for (triangle, face) in triangles.iter().zip(faces) {
        let Some(gradient) = face else { continue };
        triangle.iter().for_each(|&vertex| sums[vertex as usize] += *gradient);
    }
    sums
}

pub(super) fn corners(positions: &[[f32; 3]], triangle: [u32; 3]) -> [DVec3; 3] {
    triangle.map(|vertex| DVec3::from(positions[vertex as usize].map(f64::from)))
}

/// The angle at each corner; zero at one that has none.
pub(super) fn corner_angles([a, b, c]: [DVec3; 3]) -> [f64; 3] {
    let angle = |at: DVec3, p: DVec3, q: DVec3| {
        let (p, q) = (p - at, q - at);
        p.cross(q).length().atan2(p.dot(q))
    };
    [angle(a, b, c), angle(b, c, a), angle(c, a, b)]
}

/// The linear map that takes the edges and the scaled normal of one triangle to those of another, times the first one's area.
///
/// `None` if the first has no area or something is not finite.
fn weighted_gradient(rest: [DVec3; 3], deformed: [DVec3; 3]) -> Option<DMat3> {
    let rest = edges_and_normal(rest);
    let determinant = rest.determinant();
    // The determinant is the parallelogram's area to the power 3/2.
    let gradient = edges_and_normal(deformed) * cofactors(rest).transpose() * (1.0 / determinant.cbrt());
    (determinant > 0.0 && gradient.is_finite()).then_some(gradient)
}

/// Two edges, and the normal with the square root of the parallelogram's area as its length.
fn edges_and_normal([a, b, c]: [DVec3; 3]) -> DMat3 {
    let (e1, e2) = (b - a, c - a);
    let normal = e1.cross(e2);
    let length = normal.length();
    let normal = if length > 0.0 { normal / length.sqrt() } else { DVec3::ZERO };
    DMat3::from_cols(e1, e2, normal)
}
