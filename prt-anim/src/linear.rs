//! Linear maps at any scale and of any rank.

use glam::{DMat3, DVec3};

/// The matrix of cofactors: the inverse transpose times the determinant, also where that vanishes.
pub(crate) fn cofactors(matrix: DMat3) -> DMat3 {
    let DMat3 { x_axis: x, y_axis: y, z_axis: z } = matrix;
    DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y))
}

/// The inverse times a positive factor; of a singular matrix the transpose of its cofactors, which may be zero.
pub(crate) fn scaled_inverse(matrix: DMat3) -> DMat3 {
    let matrix = over_largest(matrix);
    over_largest(cofactors(matrix).transpose() * matrix.determinant().signum())
}

/// The matrix in units of its largest element, so that products neither over- nor underflow; zero stays zero.
pub(crate) fn over_largest(matrix: DMat3) -> DMat3 {
    let largest = matrix.to_cols_array().into_iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    // Division, not multiplication by 1 / largest, which may overflow.
    if largest > 0.0 { DMat3::from_cols_array(&matrix.to_cols_array().map(|value| value / largest)) } else { matrix }
}

/// A vector scaled to unit length, however short or long it is; +z where it has no direction.
pub(crate) fn unit_or_z(vector: DVec3) -> DVec3 {
    let largest = vector.abs().max_element();
    if largest > 0.0 && vector.is_finite() { (vector / largest).normalize() } else { DVec3::Z }
}
