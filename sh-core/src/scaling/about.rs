//! Scaling about any axis.

use alloc::vec;

use super::matrix::ScalingMatrix;
use crate::{Order, Real, ShRotation};

impl<T: Real> ScalingMatrix<T> {
    /// Scales an expansion about an axis: what [`apply`](Self::apply) does about +z.
    ///
    /// - `axis`: of any length but zero, in the frame of the expansion; if it is zero or not finite, +z is taken
    /// - `coeffs`: `[n′²]`, captured
    /// - `out`: `[n²]`, overwritten
    ///
    /// The matrix commutes with turns about the axis, so the frame in which the axis is +z may be any: two angles are turned
    /// there and back, not three. Allocates.
    ///
    /// # Panics
    /// If a slice length does not match the orders.
    ///
    /// Source: [WXZ06](crate#references) section 3.2.
    pub fn apply_about(&self, axis: [T; 3], coeffs: &[T], out: &mut [T]) {
        let z_from_axis = turn_to_z(axis.map(T::to_f64));
        let axis_from_z = core::array::from_fn(|i| core::array::from_fn(|j| z_from_axis[j][i]));
        let mut turned = vec![T::ZERO; self.source_order().coeff_count()];
        let mut scaled = vec![T::ZERO; self.order().coeff_count()];
        rotate(self.source_order(), z_from_axis, coeffs, &mut turned);
        self.apply(&turned, &mut scaled);
        rotate(self.order(), axis_from_z, &scaled, out);
    }
}

/// The rotation used here, whatever it is.
fn rotate<T: Real>(order: Order, matrix: [[f64; 3]; 3], coeffs: &[T], out: &mut [T]) {
    ShRotation::new(order, matrix.map(|row| row.map(T::from_f64))).apply(coeffs, out);
}

/// Rows of the rotation by the azimuth about z, then by the polar angle about y, that takes `axis` to +z.
fn turn_to_z(axis: [f64; 3]) -> [[f64; 3]; 3] {
    let largest = axis.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    if !(largest > 0.0 && axis.iter().all(|a| a.is_finite())) {
        return [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    }
    let [x, y, z] = axis.map(|a| a / largest);
    let radius = Real::hypot(x, y);
    let length = Real::hypot(radius, z);
    let (cos_phi, sin_phi) = if radius > 0.0 { (x / radius, y / radius) } else { (1.0, 0.0) };
    let (cos_theta, sin_theta) = (z / length, radius / length);
    [
        [cos_theta * cos_phi, cos_theta * sin_phi, -sin_theta],
        [-sin_phi, cos_phi, 0.0],
        [sin_theta * cos_phi, sin_theta * sin_phi, cos_theta],
    ]
}
