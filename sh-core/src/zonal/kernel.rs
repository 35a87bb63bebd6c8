//! Kernels in closed form: powers of the clamped cosine, caps, Gaussians.
//!
//! A kernel that integrates to one has the zonal coefficients `A_l / lobe_factor(l)`, where `A_l` is the mean of `P_l` under
//! it: `A_0 = 1` and `|A_l| ≤ 1`. A parameter below 0 or NaN counts as 0, throughout.

use core::f64::consts::{FRAC_PI_2, PI};

use super::legendre::legendre_from_top;
use super::lobe_factor;
use crate::Real;

/// Writes `scale · A_l / lobe_factor(l)`.
pub(super) fn write_means<T: Real>(means: impl Iterator<Item = f64>, scale: f64, zonal: &mut [T]) {
    for (l, (g, mean)) in zonal.iter_mut().zip(means).enumerate() {
        *g = T::from_f64(scale * mean / lobe_factor(l));
    }
}

/// A parameter of a kernel: below 0 and NaN count as 0.
pub(super) fn at_least_zero<T: Real>(parameter: T) -> f64 {
    parameter.to_f64().max(0.0)
}

/// The zonal coefficients of the clamped cosine `max(z, 0)` about +z, for any number of bands.
///
/// ```text
/// g_0 = √π/2     g_1 = √(π/3)     g_l = 0 for odd l > 1
/// g_l = √(π(2l+1)) (−1)^(l/2−1) / ((l+2)(l−1)) · l! / (2^l ((l/2)!)²)   for even l
/// ```
///
/// - `zonal`: `[n]`, overwritten
///
/// There is no `1/π` in it: [`convolve`](crate::convolve) with it turns radiance into irradiance, and a constant light of
/// radiance 1 into π.
///
/// ```
/// let mut zonal = [0.0_f64; 3];
/// sh_core::clamped_cosine(&mut zonal);
/// assert!((zonal[0] - std::f64::consts::PI.sqrt() / 2.0).abs() < 1e-15);
/// ```
///
/// Source: [RH01](crate#references) eq. 7-9, in our normalisation.
pub fn clamped_cosine<T: Real>(zonal: &mut [T]) {
    clamped_cosine_power(T::ONE, zonal);
}

/// The zonal coefficients of a power of the clamped cosine, `max(z, 0)^exponent`: 1 at the axis.
///
/// `exponent` 0 is the half space, 1 the [`clamped_cosine`], larger ones the lobe of the Phong model. It is
/// [`phong_kernel`] times `2π/(exponent + 1)`, which is 0 for an infinite exponent. An exponent below 0 or NaN counts as 0.
///
/// - `zonal`: `[n]`, overwritten
///
/// Accuracy as in [`phong_kernel`].
///
/// ```
/// let mut half_space = [0.0_f64; 2];
/// sh_core::clamped_cosine_power(0.0, &mut half_space);
/// assert!((half_space[0] - std::f64::consts::PI.sqrt()).abs() < 1e-15);
/// ```
pub fn clamped_cosine_power<T: Real>(exponent: T, zonal: &mut [T]) {
    let s = at_least_zero(exponent);
    write_means(cosine_power_means(s), 2.0 * PI / (s + 1.0), zonal);
}

/// The zonal coefficients of the Phong lobe, integrating to one: `(exponent + 1)/(2π) · max(z, 0)^exponent`.
///
/// ```text
/// A_0 = 1     A_1 = (s+1)/(s+2)     A_l = A_(l−2) (s−l+2)/(s+l+1)     g_l = √((2l+1)/(4π)) A_l
/// ```
///
/// - `exponent`: below 0 or NaN counts as 0; infinity gives the delta function
/// - `zonal`: `[n]`, overwritten
///
/// Convolving with it turns radiance into what a Phong mirror reflects, by the direction of reflection. The recurrence only
/// multiplies, so each coefficient keeps its relative accuracy: 2e-13 in `f64` for n = 512, and 5e-15 absolute in units of `√((2l+1)/(4π))`, against 30 digits, asserted by
/// `kernels_agree_with_the_long_reference` in `tests/zonal.rs`.
///
/// Source: the integral of `z^s P_l` on `[0, 1]`, [DLMF](crate#references) 18.17.38; the lobe is that of
/// [RH02](crate#references).
pub fn phong_kernel<T: Real>(exponent: T, zonal: &mut [T]) {
    write_means(cosine_power_means(at_least_zero(exponent)), 1.0, zonal);
}

fn cosine_power_means(exponent: f64) -> impl Iterator<Item = f64> {
    // 1e300 is so sharp that all quotients are 1, and they can still be formed.
    let s = exponent.min(1e300);
    // A_l and A_(l+1), from which A_(l+2) follows.
    let (mut l, mut mean, mut next) = (0.0, 1.0, (s + 1.0) / (s + 2.0));
    core::iter::repeat_with(move || {
        let current = mean;
        (mean, next) = (next, mean * (s - l) / (s + l + 3.0));
        l += 1.0;
        current
    })
}

/// The zonal coefficients of a uniform cap about +z: 1 within `angular_radius`, 0 beyond.
///
/// ```text
/// g_0 = √π (1 − cos α)     g_l = √(π/(2l+1)) (P_(l−1)(cos α) − P_(l+1)(cos α))
/// ```
///
/// - `angular_radius`: `α` in radians; at π and beyond it is the constant 1, at 0, below, and NaN it is 0
/// - `zonal`: `[n]`, overwritten
///
/// Accuracy as in [`cap_kernel`]: relative for small caps, however small.
///
/// Source: [Slo08](crate#references), the spherical light source; `(2l+1) P_l = P'_(l+1) − P'_(l−1)`.
pub fn spherical_cap<T: Real>(angular_radius: T, zonal: &mut [T]) {
    let radius = at_least_zero(angular_radius).min(PI);
    if radius <= FRAC_PI_2 {
        let versine = half_angle_versine(radius);
        write_means(small_cap_means(versine), 2.0 * PI * versine, zonal);
    } else {
        let versine = half_angle_versine(PI - radius);
        write_means(large_cap_means(versine), 2.0 * PI * (2.0 - versine), zonal);
    }
}

/// The zonal coefficients of a uniform cap about +z that integrates to one: the mean over the cap, when convolved with.
///
/// [`spherical_cap`] divided by the solid angle `2π (1 − cos α)`; the delta function for `α = 0`.
///
/// - `angular_radius`: `α` in radians; below 0 and NaN count as 0, above π as π
/// - `zonal`: `[n]`, overwritten
///
/// Accuracy: 5e-15 absolute in units of `√((2l+1)/(4π))`, in `f64`, for n = 512 and any radius, against 30 digits; asserted by
/// `kernels_agree_with_the_long_reference` in `tests/zonal.rs`.
pub fn cap_kernel<T: Real>(angular_radius: T, zonal: &mut [T]) {
    let radius = at_least_zero(angular_radius).min(PI);
    if radius <= FRAC_PI_2 {
        write_means(small_cap_means(half_angle_versine(radius)), 1.0, zonal);
    } else {
        write_means(large_cap_means(half_angle_versine(PI - radius)), 1.0, zonal);
    }
}

/// `1 − cos α = 2 sin²(α/2)`, without cancellation.
fn half_angle_versine(angle: f64) -> f64 {
    let half_sine = Real::sin(0.5 * angle);
    2.0 * half_sine * half_sine
}

/// The means of `P_l` over a cap up to the half space, of the given `1 − cos α`.
fn small_cap_means(versine: f64) -> impl Iterator<Item = f64> {
    // ∫ P_l = (P_(l−1) − P_(l+1))/(2l+1), with the differences of neighbours already divided by the versine.
    let mut above = legendre_from_top(versine).skip(1).map(|(_, slope)| slope);
    let mut below = 0.0;
    (0..).map(move |l: usize| {
        let slope = above.next().unwrap_or(0.0);
        let mean = -(below + slope) / (2 * l + 1) as f64;
        below = slope;
        mean
    })
}

/// The means of `P_l` over the complement of a small cap of the given versine, turned to look along +z.
fn large_cap_means(versine: f64) -> impl Iterator<Item = f64> {
    // The whole sphere has the mean 0 above band 0; the small cap about −z alternates in sign.
    let mut share = versine / (2.0 - versine);
    small_cap_means(versine).enumerate().map(move |(l, mean)| {
        share = -share;
        if l == 0 { 1.0 } else { share * mean }
    })
}

/// The zonal coefficients of the Gaussian on the sphere, integrating to one: the heat kernel.
///
/// `A_l = exp(−l(l+1) deviation²/2)`, `g_l = √((2l+1)/(4π)) A_l`. What diffusion makes of a point: kernels of deviations `a`
/// and `b` convolve to one of `√(a² + b²)`, exactly. For a small deviation it is the normal distribution with that standard
/// deviation, in radians, along each of the two tangents. The mean of the cosine is `exp(−deviation²)`.
///
/// - `deviation`: in radians; 0, below and NaN give the delta function, infinity the constant
/// - `zonal`: `[n]`, overwritten
///
/// ```
/// let mut zonal = [0.0_f64; 3];
/// sh_core::gaussian_kernel(0.5, &mut zonal);
/// let ratio = zonal[2] / zonal[0] / 5.0_f64.sqrt();
/// assert!((ratio - (-3.0_f64 * 0.25).exp()).abs() < 1e-15);
/// ```
///
/// Source: [Bue04](crate#references), the spherical Gaussian at the time `deviation²/2`.
pub fn gaussian_kernel<T: Real>(deviation: T, zonal: &mut [T]) {
    let deviation = at_least_zero(deviation);
    let variance = deviation * deviation;
    let mean = |l: usize| if l == 0 { 1.0 } else { Real::exp(-0.5 * (l * (l + 1)) as f64 * variance) };
    write_means((0..).map(mean), 1.0, zonal);
}
