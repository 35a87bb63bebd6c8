//! The axis of a function, and the best lobe about an axis.

use core::f64::consts::PI;

use crate::direction::unit_or_z;
use crate::order::assert_length;
use crate::{Order, Real, eval, index};

/// The axis of the linear band, at unit length: `(−f_11, −f_1−1, f_10)`, normalised.
///
/// The centre of gravity of the function has this direction; for a light it is where most of it comes from, for transfer
/// without shadows the normal.
///
/// - `coeffs`: `[n²]`
///
/// Where there is no such axis, because n = 1, the linear band is zero, or it is not finite, the answer is +z. Never NaN.
///
/// ```
/// let mut coeffs = [0.0_f32; 9];
/// sh_core::eval(sh_core::Order::new(3)?, [0.48, -0.6, 0.64], &mut coeffs);
/// let [x, y, z] = sh_core::linear_axis(&coeffs);
/// assert!((x - 0.48).abs() < 1e-6 && (y + 0.6).abs() < 1e-6 && (z - 0.64).abs() < 1e-6);
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// Source: [SLS05](crate#references) section 3.3, the optimal linear lobe.
pub fn linear_axis<T: Real>(coeffs: &[T]) -> [T; 3] {
    let linear = |m| coeffs.get(index(1, m)).map_or(0.0, |f| f.to_f64());
    unit_or_z([-linear(1), -linear(-1), linear(0)]).map(T::from_f64)
}

/// Fits one zonal lobe about a given axis, each band by least squares, and returns the squared error.
///
/// `lobe[l] = 4π/(2l+1) Σ_m f_lm y_lm(axis)`: what the band is worth at the axis. No other lobe about this axis is nearer to
/// `f`; the value returned is the squared L2 length of `remainder`, the integral of the squared difference.
///
/// - `coeffs`: `[n²]`, the function `f`
/// - `axis`: unit length; [`linear_axis`] gives a good one
/// - `lobe`: `[n]`, lobe coefficients `g*_l`, overwritten
/// - `remainder`: `[n²]`, overwritten by `f` minus the lobe; a next lobe can be fitted to it
///
/// Sums in `f64`. Does not allocate. For diffuse transfer of order 6 about the linear axis the relative error is about 0.29
/// ([SLS05](crate#references) section 4.1).
///
/// ```
/// use sh_core::{Order, expand_lobe, fit_lobe_about_axis};
///
/// let (order, axis) = (Order::new(3)?, [0.0_f64, 0.6, 0.8]);
/// let (mut f, mut lobe, mut remainder) = ([0.0; 9], [0.0; 3], [0.0; 9]);
/// expand_lobe(order, &[3.0, 2.0, 1.0], axis, &mut f);
/// let error = fit_lobe_about_axis(order, &f, axis, &mut lobe, &mut remainder);
/// assert!(error < 1e-28 && (lobe[1] - 2.0).abs() < 1e-14);
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If a slice length does not match `order`.
///
/// Source: [SLS05](crate#references) eq. 18, whose denominator is `(2l+1)/(4π)`.
pub fn fit_lobe_about_axis<T: Real>(
    order: Order,
    coeffs: &[T],
    axis: [T; 3],
    lobe: &mut [T],
    remainder: &mut [T],
) -> T {
    assert_length("coeffs", coeffs.len(), order.coeff_count());
    assert_length("lobe", lobe.len(), order.get());
    eval(order, axis, remainder);
    let mut squared_error = 0.0;
    for ((l, band), g) in order.bands().zip(lobe) {
        let (f, y) = (&coeffs[band.clone()], &mut remainder[band]);
        let at_axis: f64 = f.iter().zip(&*y).map(|(f, y)| f.to_f64() * y.to_f64()).sum();
        let best = 4.0 * PI / (2 * l + 1) as f64 * at_axis;
        *g = T::from_f64(best);
        for (y, f) in y.iter_mut().zip(f) {
            let rest = f.to_f64() - best * y.to_f64();
            squared_error += rest * rest;
            *y = T::from_f64(rest);
        }
    }
    T::from_f64(squared_error)
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;
    use crate::{dot, expand_lobe};

    /// Something without symmetry.
    fn function<const LEN: usize>() -> [f64; LEN] {
        core::array::from_fn(|i| (i * 7919 % 101) as f64 / 50.0 - 1.0)
    }

    #[test]
    fn a_lobe_and_its_axis_are_found_again() {
        let (order, axis, lobe) = (Order::new(6).unwrap(), [0.48, -0.6, 0.64], [1.0, 0.7, 0.3, -0.1, 0.05, 0.02]);
        let (mut f, mut found, mut remainder) = ([0.0_f64; 36], [0.0; 6], [9.0; 36]);
        expand_lobe(order, &lobe, axis, &mut f);
        let found_axis = linear_axis(&f);
        assert!(found_axis.iter().zip(axis).all(|(a, b)| (a - b).abs() < 1e-15));
        let error = fit_lobe_about_axis(order, &f, found_axis, &mut found, &mut remainder);
        assert!(found.iter().zip(lobe).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?}");
        assert!(error < 1e-28, "{error}");
    }

    #[test]
    fn no_coefficient_can_be_changed_to_the_better() {
        let (order, f) = (Order::new(5).unwrap(), function::<25>());
        let axis = linear_axis(&f);
        let (mut best, mut remainder) = ([0.0; 5], [0.0; 25]);
        let least = fit_lobe_about_axis(order, &f, axis, &mut best, &mut remainder);
        let error = |lobe: &[f64; 5]| {
            let mut expanded = [0.0; 25];
            expand_lobe(order, lobe, axis, &mut expanded);
            f.iter().zip(expanded).map(|(f, e)| (f - e) * (f - e)).sum::<f64>()
        };
        assert!((error(&best) - least).abs() < 1e-14 && (dot(&remainder, &remainder) - least).abs() < 1e-14);
        for (l, step) in (0..5).flat_map(|l| [(l, -1e-3), (l, 1e-3)]) {
            let mut changed = best;
            changed[l] += step;
            // the step squared, times the squared length of the band's basis
            let expected = least + step * step * (2 * l + 1) as f64 / (4.0 * PI);
            assert!((error(&changed) - expected).abs() < 1e-14, "band {l}");
        }
    }

    #[test]
    fn functions_without_an_axis_get_plus_z() {
        for f in [&[0.0_f64; 9][..], &[1.0], &[], &[1.0, f64::NAN, 0.0, 0.0], &[1.0, 0.0, f64::INFINITY, 0.0]] {
            assert_eq!(linear_axis(f), [0.0, 0.0, 1.0], "{f:?}");
        }
        // Neither tiny nor huge ones lose theirs.
        for size in [f32::MIN_POSITIVE, 1e-45, f32::MAX] {
            assert_eq!(linear_axis(&[0.0, size, 0.0, 0.0]), [0.0, -1.0, 0.0]);
        }
    }
}
