//! Filament's irradiance in three bands.

use core::f64::consts::PI;

use crate::order::assert_length;
use crate::{Order, Real};

/// Coefficients that filament has.
const COUNT: usize = 9;

/// What a coefficient of radiance is multiplied by: the clamped cosine's `A_l/π = 1, 2/3, 1/4`, and the factor of the
/// polynomial in `1, y, z, x, xy, yz, 3z²−1, xz, x²−y²` that the shader evaluates.
fn factors() -> [f64; COUNT] {
    let root = |x: f64| Real::sqrt(x / PI);
    let (linear, quadratic) = (root(3.0) / 2.0 * 2.0 / 3.0, root(15.0) / 2.0 / 4.0);
    [
        root(1.0) / 2.0,
        -linear,
        linear,
        -linear,
        quadratic,
        -quadratic,
        root(5.0) / 4.0 / 4.0,
        -quadratic,
        quadratic / 2.0,
    ]
}

/// Filament's pre-scaled irradiance from radiance.
///
/// `out[i] = (A_l/π) k_i f_i` with the clamped cosine's `A_l = π, 2π/3, π/4` and `k_i` the factors of bands 0 to 2 as
/// polynomials (see the [crate's page](crate#basis)): the shader's sum over `1, y, z, x, yx, yz, 3z²−1, zx, x²−y²` of the normal
/// is the irradiance over π, what a white diffuse surface sends back. It is what `cmgen --sh-shader` writes, without its
/// window, and what `IndirectLight::Builder::irradiance(3, ...)` takes.
///
/// The polar axis is filament's z, in its frame of the scene, which has y up; nothing is turned.
///
/// - `light`: `[3, n²]`, radiance; bands above the third are not used, missing ones are zero
/// - `out`: nine colours, overwritten
///
/// ```
/// use sh_core::{Order, to_filament};
///
/// let mut out = [[0.0_f64; 3]; 9];
/// let white = (4.0 * std::f64::consts::PI).sqrt(); // radiance 1 from everywhere
/// to_filament(Order::new(1)?, &[white; 3], &mut out);
/// assert!((out[0][0] - 1.0).abs() < 1e-15);
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If `light` is not `[3, n²]`.
///
/// Source: [RH01](crate#references); filament's `libs/ibl/src/CubemapSH.cpp` and `shaders/src/surface_light_indirect.fs`.
pub fn to_filament<T: Real>(order: Order, light: &[T], out: &mut [[T; 3]; COUNT]) {
    assert_length("light", light.len(), 3 * order.coeff_count());
    *out = [[T::ZERO; 3]; COUNT];
    for (channel, coeffs) in light.chunks_exact(order.coeff_count()).enumerate() {
        for ((colour, factor), &f) in out.iter_mut().zip(factors()).zip(coeffs) {
            colour[channel] = T::from_f64(factor) * f;
        }
    }
}

/// The radiance, in three bands, of filament's pre-scaled irradiance: undoes [`to_filament`].
///
/// - `colours`: nine colours
/// - `out`: `[3, 9]`, overwritten
///
/// # Panics
/// If `out` is not `[3, 9]`.
pub fn from_filament<T: Real>(colours: &[[T; 3]; COUNT], out: &mut [T]) {
    assert_length("out", out.len(), 3 * COUNT);
    for (channel, coeffs) in out.chunks_exact_mut(COUNT).enumerate() {
        for ((f, factor), colour) in coeffs.iter_mut().zip(factors()).zip(colours) {
            *f = T::from_f64(1.0 / factor) * colour[channel];
        }
    }
}
