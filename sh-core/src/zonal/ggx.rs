//! The GGX lobe.

use super::kernel::{at_least_zero, write_means};
use super::ratio::write_from_above;
use crate::Real;

/// The zonal coefficients of the GGX lobe, exactly: what a rough mirror that is seen along its normal gathers.
///
/// The density of the reflected direction at the angle `theta` from the normal, when half vectors are distributed as
/// `D(h) (n·h)`, is `D(theta/2)/4`. For GGX that is a rational function of `z = cos theta`, and its expansion is closed:
///
/// ```text
/// α² / (π ((1 + α²) − (1 − α²) z)²)     A_l = −(a² − 1) Q_l'(a),  a = (1 + α²)/(1 − α²)     g_l = √((2l+1)/(4π)) A_l
/// ```
///
/// where `Q_l` is the Legendre function of the second kind. It integrates to one over the whole sphere.
///
/// - `alpha`: the width `α` of GGX, in many programs the square of a "roughness"; 0, below and NaN give the delta function,
///   1 and above the constant
/// - `zonal`: `[n]`, overwritten
///
/// It is not a fit: as a lobe it is exact. As a model of reflection it is the kernel by which environment maps are filtered:
/// no Fresnel term, no masking, nothing cut off at the horizon, beyond which is the share `α²/(1 + α²)` of it (1 % for
/// `α = 0.1`, 20 % for 0.5), and at grazing view the true lobe is stretched and no longer zonal.
///
/// Accuracy: 5e-15 absolute in units of `√((2l+1)/(4π))`, in `f64`, for n = 512 and any `α`, against 30 digits; asserted by
/// `kernels_agree_with_the_long_reference` in `tests/zonal.rs`. Does not allocate.
///
/// ```
/// // Between a mirror and a diffuser: the mean cosine falls with the roughness.
/// let mean_cosine = |alpha: f64| {
///     let mut zonal = [0.0; 2];
///     sh_core::ggx_kernel(alpha, &mut zonal);
///     zonal[1] / zonal[0] / 3.0_f64.sqrt()
/// };
/// assert!(mean_cosine(0.01) > 0.998 && mean_cosine(0.5) < 0.75 && mean_cosine(1.0) < 1e-15);
/// ```
///
/// Source: the distribution of [WMLT07](crate#references) eq. 33; Neumann's integral [DLMF](crate#references) 14.12.13 for
/// `Q_l`, differentiated.
pub fn ggx_kernel<T: Real>(alpha: T, zonal: &mut [T]) {
    let alpha = at_least_zero(alpha).min(1.0);
    // a − 1 without cancellation. 1e300 stands for infinity: the constant.
    let excess = (2.0 * alpha * alpha / ((1.0 - alpha) * (1.0 + alpha))).min(1e300);
    if zonal.len() as f64 * alpha < 1.0 {
        write_means(forward_means(alpha, excess), 1.0, zonal);
    } else {
        write_by_ratios(alpha, excess, zonal);
    }
}

/// `l (A_(l+1) − A_l) = (l+1)(A_l − A_(l−1)) + (2l+1)(a−1) A_l`: differences, because the means are all near 1.
fn forward_means(alpha: f64, excess: f64) -> impl Iterator<Item = f64> {
    // A_1 − 1 = (a − 1) + (a² − 1) ln α, where a² − 1 = (a−1)(a+1). The bound makes 0 · ln 0 zero.
    let logarithm = Real::ln(alpha.max(f64::MIN_POSITIVE));
    let (mut l, mut mean, mut step) = (0.0, 1.0, excess + excess * (excess + 2.0) * logarithm);
    core::iter::repeat_with(move || {
        let current = mean;
        mean += step;
        l += 1.0;
        step = ((l + 1.0) * step + (2.0 * l + 1.0) * excess * mean) / l;
        current
    })
}

/// `r_l = A_l/A_(l−1) = (l+1) / ((2l+1) a − l r_(l+1))`, from above, written for `1 − r_l`, in which nothing cancels.
fn write_by_ratios<T: Real>(alpha: f64, excess: f64, zonal: &mut [T]) {
    // The ratio tends to exp(−ξ) = (1−α)/(1+α), and an error shrinks by exp(−2ξ) in each step, ξ > 2α: to 1e-17.
    let lead = 10 + (10.0 / alpha) as usize;
    let step = |l: f64, fall: f64| {
        let rest = (2.0 * l + 1.0) * excess + l * fall;
        let whole = l + 1.0 + rest;
        (rest / whole, (l + 1.0) / whole)
    };
    write_from_above(lead, 2.0 * alpha / (1.0 + alpha), step, 1.0, zonal);
}
