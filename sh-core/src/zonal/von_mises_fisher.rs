//! The von Mises-Fisher distribution, in graphics the spherical Gaussian.

use core::f64::consts::PI;

use super::kernel::{at_least_zero, write_means};
use super::ratio::write_from_above;
use crate::Real;

/// The zonal coefficients of the von Mises-Fisher distribution, which integrates to one: `κ/(4π sinh κ) · exp(κ z)`.
///
/// ```text
/// A_l = I_(l+1/2)(κ) / I_(1/2)(κ)     g_l = √((2l+1)/(4π)) A_l
/// ```
///
/// - `concentration`: `κ`; 0, below and NaN give the constant `1/(4π)`, infinity the delta function
/// - `zonal`: `[n]`, overwritten
///
/// The ratios of neighbouring Bessel functions by their continued fraction from above, which is stable where they fall; by
/// the forward recurrence where `κ ≥ n²` and they hardly do. Does not allocate; about `n + √(40κ)` divisions at most.
///
/// Accuracy: 5e-15 absolute in units of `√((2l+1)/(4π))`, in `f64`, for n = 512 and κ from 1e-300 to 1e300, against 30
/// digits; asserted by `kernels_agree_with_the_long_reference` in `tests/zonal.rs`.
///
/// ```
/// let mut zonal = [0.0_f64; 2];
/// sh_core::von_mises_fisher_kernel(2.0, &mut zonal);
/// let mean_cosine = zonal[1] / zonal[0] / 3.0_f64.sqrt();
/// assert!((mean_cosine - (1.0 / 2.0_f64.tanh() - 0.5)).abs() < 1e-15);
/// ```
///
/// Source: [HSRG07](crate#references); [DLMF](crate#references) 10.29.1 for the recurrence.
pub fn von_mises_fisher_kernel<T: Real>(concentration: T, zonal: &mut [T]) {
    write_bessel(at_least_zero(concentration), 1.0, zonal);
}

/// The zonal coefficients of the spherical Gaussian `exp(sharpness (z − 1))`: 1 at the axis.
///
/// [`von_mises_fisher_kernel`] times the integral `2π (1 − exp(−2 sharpness)) / sharpness`, which is 4π for 0 and falls to 0.
///
/// - `sharpness`: below 0 and NaN count as 0: the constant 1
/// - `zonal`: `[n]`, overwritten
///
/// Source: [WRGSG09](crate#references).
pub fn spherical_gaussian<T: Real>(sharpness: T, zonal: &mut [T]) {
    let sharpness = at_least_zero(sharpness);
    let integral = if sharpness == 0.0 { 4.0 * PI } else { -2.0 * PI * Real::exp_m1(-2.0 * sharpness) / sharpness };
    write_bessel(sharpness, integral, zonal);
}

fn write_bessel<T: Real>(concentration: f64, scale: f64, zonal: &mut [T]) {
    let count = zonal.len() as f64;
    if concentration >= count * count {
        write_means(forward_means(concentration), scale, zonal);
    } else {
        write_by_ratios(concentration, scale, zonal);
    }
}

/// `A_(l+1) = A_(l−1) − (2l+1)/κ A_l`. An error grows by `exp(l²/κ)`.
fn forward_means(concentration: f64) -> impl Iterator<Item = f64> {
    let decay = Real::exp(-2.0 * concentration);
    let coth = (1.0 + decay) / (1.0 - decay);
    let (mut l, mut mean, mut next) = (0.0, 1.0, coth - 1.0 / concentration);
    core::iter::repeat_with(move || {
        let current = mean;
        l += 1.0;
        (mean, next) = (next, mean - (2.0 * l + 1.0) / concentration * next);
        current
    })
}

/// `r_l = A_l/A_(l−1) = 1/((2l+1)/κ + r_(l+1))`, from above. An error shrinks by `r_l²`, about `exp(−2l/κ)`.
fn write_by_ratios<T: Real>(concentration: f64, scale: f64, zonal: &mut [T]) {
    // The square root makes (start² − end²)/κ at least 40, so that the start is forgotten to 1e-17; the rest is for small κ.
    let lead = 10 + Real::sqrt(40.0 * concentration) as usize;
    let step = |l: f64, above: f64| {
        let ratio = 1.0 / ((2.0 * l + 1.0) / concentration + above);
        (ratio, ratio)
    };
    write_from_above(lead, 0.0, step, scale, zonal);
}
