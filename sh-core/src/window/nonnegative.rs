//! The weakest window that leaves nothing negative.

use alloc::vec::Vec;

use super::minimum::is_nonnegative;
use super::weights::Window;
use crate::order::assert_length;
use crate::{Order, Real, scale_bands};

/// The strength is found to this fraction.
const STRENGTH_TOLERANCE: f64 = 1e-6;

/// Strengths below this change no weight of any band by more than a rounding of `f32`.
const WEAKEST: f64 = 1e-13;

/// The weakest window of a family with which an expansion is nowhere negative; returns its strength.
///
/// A light that is positive can have an expansion that is negative somewhere, and be seen so by a glossy surface. This is the
/// least change that repairs it: bisection over the strength, each time with a search for
/// negative values like that of [`minimum`](crate::minimum).
///
/// - `coeffs`: `[n²]`, not changed
/// - `weights`: `[n]`, overwritten; for [`scale_bands`]
///
/// The strength is at most 1e-6 of itself above the smallest one, where the minimum rises with the strength: it always does
/// with [`Window::Gaussian`], see [`gaussian`](crate::gaussian). The windowed minimum is 0 or above, with the accuracy of
/// [`minimum`](crate::minimum) and of the type.
///
/// For sharp lights take [`Window::Gaussian`] or [`Window::Laplacian`], which keep something of every band: the kernels of the
/// other two are negative somewhere until two or three bands are left (strengths of 0.48 and 0.58 for two points of light, at
/// every order from 3 to 10).
///
/// If the expansion is nowhere negative already, the strength is 0 and all weights are 1. If its mean is negative, or a
/// coefficient is not finite, no window helps: the strength is infinite, and the weights keep band 0 only.
///
/// ```
/// use sh_core::{Order, Window, eval, minimum, nonnegative_window, scale_bands};
///
/// // A point of light rings.
/// let order = Order::new(6)?;
/// let mut light = [0.0_f64; 36];
/// eval(order, [0.6, 0.0, 0.8], &mut light);
/// assert!(minimum(order, &light).value < -0.2);
///
/// let mut weights = [0.0; 6];
/// nonnegative_window(order, &light, Window::Gaussian, &mut weights);
/// scale_bands(order, &weights, &mut light);
/// assert!(minimum(order, &light).value.abs() < 1e-6);
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If a slice length does not match `order`.
///
/// Source: [Slo17](crate#references), with other families and another search.
pub fn nonnegative_window<T: Real>(order: Order, coeffs: &[T], window: Window, weights: &mut [T]) -> T {
    assert_length("coeffs", coeffs.len(), order.coeff_count());
    assert_length("weights", weights.len(), order.get());
    let coeffs: Vec<f64> = coeffs.iter().map(|f| f.to_f64()).collect();
    let strength = smallest_strength(order, &coeffs, window);
    window.weights(order, T::from_f64(strength), weights);
    T::from_f64(strength)
}

fn smallest_strength(order: Order, coeffs: &[f64], window: Window) -> f64 {
    if !coeffs.iter().all(|f| f.is_finite()) {
        return f64::INFINITY;
    }
    let is_enough = |strength: f64| {
        let mut weights = alloc::vec![0.0; order.get()];
        let mut windowed = coeffs.to_vec();
        window.weights(order, strength, &mut weights);
        scale_bands(order, &weights, &mut windowed);
        is_nonnegative(order, windowed)
    };
    if is_enough(0.0) {
        return 0.0;
    }
    if coeffs[0] <= 0.0 {
        return f64::INFINITY;
    }
    // Strong enough: doubled until it is. Band 0 alone is positive, so it ends.
    let mut high = WEAKEST;
    while !is_enough(high) {
        high *= 2.0;
    }
    let mut low = 0.5 * high;
    while high - low > STRENGTH_TOLERANCE * high {
        let middle = 0.5 * (low + high);
        if is_enough(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    high
}
