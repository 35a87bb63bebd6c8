//! Tangent frames of textured surfaces.

use glam::{DMat3, DVec2, DVec3};

use super::mesh::{corner_angles, corners};
use super::surface_rotation;
use crate::linear::unit_or_z;
use crate::parallel::fill;

/// Frames `[tangent, bitangent, normal]` of a textured mesh in any pose.
///
/// The tangent is the direction in which `u` grows, made orthogonal to the normal; at a vertex the average over its faces' unit
/// tangents weighted by their angles, as in Mikkelsen's tangent space (MikkTSpace). The bitangent is `± normal × tangent` on the
/// side to which `v` grows: where texture coordinates are mirrored, frames are left-handed. Unlike MikkTSpace nothing
/// is split: a vertex where both hands meet takes the one that has more of the angle.
///
/// - `positions`, `normals`, `uvs`: `[V]`; normals of any length
/// - `triangles`: three vertex numbers each
/// - returns `[V]`, each three columns. Where the texture coordinates give no direction, some orthonormal right-handed frame about the normal
///
/// # Panics
/// If lengths differ, or a triangle points past the end.
#[must_use]
pub fn tangent_frames(
    positions: &[[f32; 3]],
    normals: &[[f32; 3]],
    uvs: &[[f32; 2]],
    triangles: &[[u32; 3]],
) -> Vec<[[f32; 3]; 3]> {
    let count = positions.len();
    assert_eq!(normals.len(), count, "one normal for each vertex is needed");
    assert_eq!(uvs.len(), count, "one texture coordinate for each vertex is needed");
    let normals: Vec<DVec3> = normals.iter().map(|normal| unit_or_z(DVec3::from(normal.map(f64::from)))).collect();
    let sums = sum_over_faces(positions, &normals, uvs, triangles);
    let mut frames = vec![[[0.0; 3]; 3]; count];
    fill(&mut frames, |vertex| {
        let (tangent, hand) = sums[vertex];
        orthonormal(tangent, normals[vertex], hand).as_mat3().to_cols_array_2d()
    });
    frames
}

/// For each vertex `Σ angle · unit tangent` and `Σ angle · hand` over its faces.
fn sum_over_faces(
    positions: &[[f32; 3]],
    normals: &[DVec3],
    uvs: &[[f32; 2]],
    triangles: &[[u32; 3]],
) -> Vec<(DVec3, f64)> {
    let mut sums = vec![(DVec3::ZERO, 0.0); normals.len()];
    for &triangle in triangles {
        let corners = corners(positions, triangle);
        let Some((tangent, hand)) = face_tangent(corners, triangle.map(|vertex| uvs[vertex as usize])) else {
            continue;
        };
        for (vertex, angle) in triangle.into_iter().zip(corner_angles(corners)) {
            let normal = normals[vertex as usize];
            let in_plane = (tangent - normal * normal.dot(tangent)).normalize_or_zero();
            sums[vertex as usize].0 += in_plane * angle;
            sums[vertex as usize].1 += hand * angle;
        }
    }
    sums
}

/// The direction in which `u` grows on a face, unit length, and +1, or −1 where `v` grows to the other side than the winding tells.
///
/// `T = (v₂ e₁ − v₁ e₂) / (u₁ v₂ − u₂ v₁)` solves `e_i = u_i T + v_i B` for the edges `e_i`.
fn face_tangent([a, b, c]: [DVec3; 3], uvs: [[f32; 2]; 3]) -> Option<(DVec3, f64)> {
    let [uv_a, uv_b, uv_c] = uvs.map(|uv| DVec2::from(uv.map(f64::from)));
    let (uv1, uv2) = (uv_b - uv_a, uv_c - uv_a);
    let area = uv1.x * uv2.y - uv2.x * uv1.y;
    let hand = area.signum();
    let tangent = ((b - a) * uv2.y - (c - a) * uv1.y) * hand;
    let tangent = tangent.try_normalize()?;
    (area != 0.0 && area.is_finite()).then_some((tangent, hand))
}

/// A frame with unit normal `n`, its tangent as near as possible to the given one, left-handed if `hand` is negative.
fn orthonormal(tangent: DVec3, n: DVec3, hand: f64) -> DMat3 {
    let across = tangent - n * n.dot(tangent);
    let across = if across.is_finite() { across.try_normalize() } else { None };
    let (t, hand) = across.map_or_else(|| (n.any_orthonormal_vector(), 1.0), |t| (t, hand));
    let bitangent = n.cross(t);
    DMat3::from_cols(t, if hand < 0.0 { -bitangent } else { bitangent }, n)
}

/// A tangent frame after a deformation: the tangent keeps to the direction in which `u` grows.
///
/// The normal becomes that of [`rotation_of`](crate::rotation_of), the tangent the part of `F t` orthogonal to it; the bitangent keeps its hand. So the
/// result is that of [`tangent_frames`] on the deformed mesh, where that is smooth. It is orthonormal for every gradient.
///
/// - `gradient`: columns, as in [`rotation_of`](crate::rotation_of)
/// - `frame`: orthonormal columns `[tangent, bitangent, normal]`, of either hand
#[must_use]
pub fn push_tangent_frame(gradient: [[f64; 3]; 3], frame: [[f32; 3]; 3]) -> [[f32; 3]; 3] {
    let gradient = DMat3::from_cols_array_2d(&gradient);
    let [t, b, n] = frame.map(|column| DVec3::from(column.map(f64::from)));
    let n = unit_or_z(n);
    let rotation = surface_rotation(gradient, n);
    let image = gradient * t;
    let largest = image.abs().max_element();
    let tangent = if largest > 0.0 && largest.is_finite() { image / largest } else { rotation * t };
    let normal = rotation * n;
    let follows = (tangent - normal * normal.dot(tangent)).length() > f64::from(f32::EPSILON) * tangent.length();
    let tangent = if follows { tangent } else { rotation * t };
    orthonormal(tangent, normal, t.cross(b).dot(n)).as_mat3().to_cols_array_2d()
}

/// Tangent frames turned by the frames of their vertices: `out[v] = rotations[v] · rest[v]`.
///
/// This is how tangent space follows a [`Deformed`](crate::Deformed) mesh. Under shear it differs from [`push_tangent_frame`]:
/// there the tangent keeps to `u`, here the frame turns as little as the surface does.
///
/// # Panics
/// If lengths differ.
pub fn push_tangent_frames(rotations: &[[[f32; 3]; 3]], rest: &[[[f32; 3]; 3]], out: &mut [[[f32; 3]; 3]]) {
    assert_eq!(rotations.len(), rest.len(), "one rotation for each frame is needed");
    assert_eq!(out.len(), rest.len(), "the result needs one element for each frame");
    fill(out, |vertex| {
        let [rotation, frame] = [rotations[vertex], rest[vertex]].map(|frame| glam::Mat3::from_cols_array_2d(&frame));
        (rotation * frame).to_cols_array_2d()
    });
}
