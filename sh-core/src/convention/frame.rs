//! Frames with y up.

use crate::{Order, Real, ShRotation};

/// `(x, y, z) → (x, −z, y)`, rows: a quarter turn about x that takes +y to +z.
const Z_UP_FROM_Y_UP: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]];

/// Turns an expansion from a frame with y up into the one with z up: `(x, y, z)` there is `(x, −z, y)` here.
///
/// Both frames are right-handed and share x. The basis has its polar axis along +z in either, as everywhere in this crate;
/// what was above (+y) is about that axis afterwards. Allocates; for many expansions build the [`ShRotation`] once, with the
/// rows `[1, 0, 0], [0, 0, −1], [0, 1, 0]`.
///
/// - `coeffs`: `[n²]`, in the frame with y up
/// - `out`: `[n²]`, overwritten
///
/// ```
/// use sh_core::{Order, eval, z_up_from_y_up};
///
/// let order = Order::new(3)?;
/// let (mut above, mut expected, mut out) = ([0.0_f64; 9], [0.0; 9], [0.0; 9]);
/// eval(order, [0.0, 1.0, 0.0], &mut above);
/// eval(order, [0.0, 0.0, 1.0], &mut expected);
/// z_up_from_y_up(order, &above, &mut out);
/// assert!(out.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15));
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If a slice length does not match `order`.
pub fn z_up_from_y_up<T: Real>(order: Order, coeffs: &[T], out: &mut [T]) {
    turn(order, Z_UP_FROM_Y_UP, coeffs, out);
}

/// Turns an expansion from a frame with z up into the one with y up: `(x, y, z)` there is `(x, z, −y)` here.
///
/// Undoes [`z_up_from_y_up`], with the same shapes.
///
/// # Panics
/// If a slice length does not match `order`.
pub fn y_up_from_z_up<T: Real>(order: Order, coeffs: &[T], out: &mut [T]) {
    let transposed = core::array::from_fn(|i| core::array::from_fn(|j| Z_UP_FROM_Y_UP[j][i]));
    turn(order, transposed, coeffs, out);
}

fn turn<T: Real>(order: Order, matrix: [[f64; 3]; 3], coeffs: &[T], out: &mut [T]) {
    ShRotation::new(order, matrix.map(|row| row.map(T::from_f64))).apply(coeffs, out);
}
