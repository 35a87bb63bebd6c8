//! Complex harmonics.

use core::f64::consts::FRAC_1_SQRT_2;

use crate::order::assert_length;
use crate::{Order, Real, index};

/// The coefficients of an expansion in complex harmonics.
///
/// `Σ_i coeffs[i] y_i = Σ_lm c_lm Y_l^m`, with the orthonormal `Y_l^m` of SciPy's `sph_harm_y(l, m, theta, phi)`, `theta` the
/// polar angle, Condon-Shortley phase included:
///
/// ```text
/// c_l0 = f_l0,   c_lm = (f_lm − i f_l−m)/√2,   c_l−m = (−1)^m (f_lm + i f_l−m)/√2   for m > 0
/// ```
///
/// - `coeffs`: `[n²]`
/// - `out`: `[n²]` pairs `[re, im]`, overwritten, with the index `l(l+1) + m`
///
/// ```
/// use sh_core::{Order, to_complex};
///
/// // y_11 = √2 Re Y_1^1
/// let mut out = [[0.0_f64; 2]; 4];
/// to_complex(Order::new(2)?, &[0.0, 0.0, 0.0, 1.0], &mut out);
/// let half = std::f64::consts::FRAC_1_SQRT_2;
/// assert_eq!(out, [[0.0; 2], [-half, -0.0], [0.0; 2], [half, 0.0]]);
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If a slice length does not match `order`.
pub fn to_complex<T: Real>(order: Order, coeffs: &[T], out: &mut [[T; 2]]) {
    assert_length("coeffs", coeffs.len(), order.coeff_count());
    assert_length("out", out.len(), order.coeff_count());
    let half = T::from_f64(FRAC_1_SQRT_2);
    for l in 0..order.get() {
        out[index(l, 0)] = [coeffs[index(l, 0)], T::ZERO];
        for m in 1..=l as isize {
            let (plus, minus) = (half * coeffs[index(l, m)], half * coeffs[index(l, -m)]);
            out[index(l, m)] = [plus, -minus];
            out[index(l, -m)] = if m % 2 == 0 { [plus, minus] } else { [-plus, -minus] };
        }
    }
}

/// The expansion of the real part of a function that is given in complex harmonics: undoes [`to_complex`].
///
/// ```text
/// f_l0 = Re c_l0,   f_lm = Re (c_lm + (−1)^m c*_l−m)/√2,   f_l−m = −Im (c_lm + (−1)^m c*_l−m)/√2   for m > 0
/// ```
///
/// - `complex`: `[n²]` pairs `[re, im]`; if the function is real, then `c_l−m = (−1)^m c*_lm`
/// - `out`: `[n²]`, overwritten
///
/// # Panics
/// If a slice length does not match `order`.
pub fn from_complex<T: Real>(order: Order, complex: &[[T; 2]], out: &mut [T]) {
    assert_length("complex", complex.len(), order.coeff_count());
    assert_length("out", out.len(), order.coeff_count());
    let half = T::from_f64(FRAC_1_SQRT_2);
    for l in 0..order.get() {
        out[index(l, 0)] = complex[index(l, 0)][0];
        for m in 1..=l as isize {
            let ([re, im], [re_minus, im_minus]) = (complex[index(l, m)], complex[index(l, -m)]);
            let sign = if m % 2 == 0 { T::ONE } else { -T::ONE };
            out[index(l, m)] = half * (re + sign * re_minus);
            out[index(l, -m)] = -(half * (im - sign * im_minus));
        }
    }
}
