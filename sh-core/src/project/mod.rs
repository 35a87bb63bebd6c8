//! Expansion of functions and maps, and maps of expansions.

mod circle;
mod cube;
mod lat_long;
mod least_squares;
mod samples;

use alloc::vec;

pub use cube::{project_cube, reconstruct_cube};
pub use lat_long::{project_lat_long, reconstruct_lat_long};
pub use least_squares::LeastSquares;

use crate::order::assert_length;
use crate::{Basis, Order, Quadrature, Real};

/// Expands a function that can be evaluated anywhere: `out[i] = Σ w f(s) y_i(s)` over the points of a quadrature.
///
/// - `quadrature`: exact if `f` is a polynomial of degree `d` and the rule's degree is at least `d + n − 1`; else the
///   larger the better
/// - `f`: value at a unit direction
/// - `out`: `[n²]`, overwritten
///
/// Sums in `f64`.
///
/// ```
/// use sh_core::{Order, Quadrature, project_function};
///
/// let mut coeffs = [0.0_f32; 9];
/// project_function(Order::new(3)?, &Quadrature::new(4), |[_, y, _]| y, &mut coeffs);
/// // y = −√(4π/3) y_1−1
/// assert!((coeffs[1] + (4.0 * std::f32::consts::PI / 3.0).sqrt()).abs() < 1e-6);
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If `out` is not `[n²]`.
pub fn project_function<T: Real>(
    order: Order,
    quadrature: &Quadrature,
    mut f: impl FnMut([f64; 3]) -> f64,
    out: &mut [T],
) {
    assert_length("out", out.len(), order.coeff_count());
    let basis = Basis::<f64>::new(order);
    let (mut y, mut sums) = (vec![0.0; order.coeff_count()], vec![0.0; order.coeff_count()]);
    for &(direction, weight) in quadrature.points() {
        let value = weight * f(direction);
        basis.eval(direction, &mut y);
        sums.iter_mut().zip(&y).for_each(|(sum, y)| *sum += value * y);
    }
    out.iter_mut().zip(sums).for_each(|(out, sum)| *out = T::from_f64(sum));
}
