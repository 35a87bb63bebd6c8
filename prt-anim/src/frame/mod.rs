//! The rotation by which zonal lobes follow a surface.

mod mesh;
mod tangent;

pub use mesh::frames_from_mesh;
pub use tangent::{push_tangent_frame, push_tangent_frames, tangent_frames};

use glam::{DMat3, DVec3};

use crate::linear::{over_largest, unit_or_z};
use crate::parallel::fill;
use crate::{Affine, Skin};

/// A tangent plane counts as collapsed to a line if its image has less than this fraction of the area of the square over the longer
/// of two orthogonal unit tangents' images: below it the normal would be made of rounding errors of `f64`.
const COLLAPSED_AREA: f64 = 1e-12;

/// The rotation nearest to what a deformation does to a surface: the frame that turns the lobes of a vertex from the rest pose to
/// the deformed one.
///
/// With orthonormal tangents `t1 × t2 = n` of the rest surface and their images `a = F t1`, `b = F t2`:
/// - the normal becomes `n' = a × b / |a × b| = cof(F) n / |cof(F) n|`, which is the direction of `F⁻ᵀ n` where `det F > 0`;
/// - tangents are turned by the rotation of the plane nearest to `(a, b)` in the sense of least squares, its polar factor: for any
///   orthonormal `t1' × t2' = n'` the angle `atan2(a·t2' − b·t1', a·t1' + b·t2')`.
///
/// - `gradient`: columns `∂p'/∂x`, `∂p'/∂y`, `∂p'/∂z`, times any positive factor
/// - `normal`: of the rest surface, of any length
///
/// The result is three columns, `deformed = c0·x + c1·y + c2·z`. It is a rotation (orthonormal, determinant +1) for every input,
/// and exact for rotations times a positive factor:
/// - Mirror (`det F < 0`): `n'` keeps to the winding of the triangles, so that a surface which is turned inside out shows the side
///   that its triangles show. Where a mirror of the tangent plane leaves the angle undefined, the shortest turn from `n` to `n'` remains.
/// - Plane collapsed to a line: the line is followed, and the normal is what the line leaves of `F n`, or else of `n`.
/// - Plane collapsed to a point, and values that are not finite: the identity.
/// - Normal without direction: +z.
///
/// Source: [SLS05](sh_core#references) section 3: lobes rotate with the local frame; the paper leaves the choice of the frame open.
#[must_use]
pub fn rotation_of(gradient: [[f64; 3]; 3], normal: [f64; 3]) -> [[f32; 3]; 3] {
    surface_rotation(DMat3::from_cols_array_2d(&gradient), unit_or_z(DVec3::from(normal))).as_mat3().to_cols_array_2d()
}

/// [`rotation_of`] before it is rounded; the normal is unit length.
pub(crate) fn surface_rotation(gradient: DMat3, normal: DVec3) -> DMat3 {
    let (t1, t2) = normal.any_orthonormal_pair();
    let Some(gradient) = scaled(gradient, t1, t2) else { return DMat3::IDENTITY };
    let (a, b) = (gradient * t1, gradient * t2);
    let deformed_normal = deformed_normal(gradient, normal, a, b);
    let (u1, u2) = turned_tangents(normal, t1, deformed_normal);
    let (cosine, sine) = (a.dot(u1) + b.dot(u2), a.dot(u2) - b.dot(u1));
    let length = cosine.hypot(sine);
    let (cosine, sine) = if length > COLLAPSED_AREA { (cosine / length, sine / length) } else { (1.0, 0.0) };
    let (v1, v2) = (u1 * cosine + u2 * sine, u2 * cosine - u1 * sine);
    DMat3::from_cols(v1, v2, deformed_normal) * DMat3::from_cols(t1, t2, normal).transpose()
}

/// The gradient in units of the longest tangent's image, so that nothing over- or underflows; `None` if there is no such unit.
fn scaled(gradient: DMat3, t1: DVec3, t2: DVec3) -> Option<DMat3> {
    // Two steps: the products may overflow before the first one.
    let gradient = over_largest(gradient);
    let unit = (gradient * t1).abs().max_element().max((gradient * t2).abs().max_element());
    let scaled = DMat3::from_cols_array(&gradient.to_cols_array().map(|value| value / unit));
    (unit > 0.0 && scaled.is_finite()).then_some(scaled)
}

/// `a × b`, or, where the tangent plane collapses to a line, what is orthogonal to it.
fn deformed_normal(gradient: DMat3, normal: DVec3, a: DVec3, b: DVec3) -> DVec3 {
    let cross = a.cross(b);
    if cross.length() > COLLAPSED_AREA {
        return cross.normalize();
    }
    let line = unit_or_z(if a.length_squared() >= b.length_squared() { a } else { b });
    let beside = |vector: DVec3| {
        let vector = vector.try_normalize()?;
        let beside = vector - line * vector.dot(line);
        (beside.length() > COLLAPSED_AREA).then(|| beside.normalize())
    };
    let beside = beside(gradient * normal).or_else(|| beside(normal)).unwrap_or_else(|| line.any_orthonormal_vector());
    // Once more: the first difference may have lost most of its digits.
    (beside - line * beside.dot(line)).normalize()
}

/// `t1` and its partner after the shortest turn that takes `from` to `to`; where that turn is not unique, one of them.
fn turned_tangents(from: DVec3, t1: DVec3, to: DVec3) -> (DVec3, DVec3) {
    let turned = glam::DQuat::from_rotation_arc(from, to) * t1;
    let u1 = (turned - to * turned.dot(to)).normalize();
    (u1, to.cross(u1))
}

/// Frames of all vertices of a skin in a pose.
///
/// The gradient is that of linear blend skinning with the weights held fixed, from the rest pose of the skeleton, in the scene:
/// `Σ w_k map_k · (Σ w_k rest map_k)⁻¹`, linear parts alone; then [`rotation_of`].
///
/// - `maps`: from [`Skin::bone_maps`]
/// - `out`: `[V]`, overwritten
///
/// # Panics
/// If there are not as many maps as bones, or `out` has another length.
pub fn frames_from_skin(skin: &Skin, maps: &[Affine], out: &mut [[[f32; 3]; 3]]) {
    skin.check(maps, out.len());
    fill(out, |vertex| {
        let (linear, _) = skin.blend(vertex, maps);
        surface_rotation(skin.gradient(vertex, linear), unit_or_z(skin.rest_normal(vertex)))
            .as_mat3()
            .to_cols_array_2d()
    });
}
