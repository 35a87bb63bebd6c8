//! What a light holds: its main direction and colour, irradiance, energy per band.

use core::f64::consts::PI;

use crate::light::directional_strength;
use crate::order::assert_length;
use crate::zonal::{clamped_cosine, convolve, linear_axis};
use crate::{Order, Real, index, reconstruct};

/// Luminance of linear RGB with the primaries of Rec. 709 and sRGB.
const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// The direction that most of an RGB light comes from, at unit length: the axis of the luminance's linear band.
///
/// - `light`: `[3, n²]`, channel-major: red, green, blue, linear, with the primaries of Rec. 709
///
/// A light without such a direction gives +z: black, uniform, of order 1, or with a linear band that is not finite. Never NaN.
///
/// # Panics
/// If `light` is not `[3, n²]`.
///
/// Source: [Slo08](crate#references), "Extracting Dominant Light Direction".
pub fn dominant_direction<T: Real>(order: Order, light: &[T]) -> [T; 3] {
    assert_length("light", light.len(), 3 * order.coeff_count());
    let mut luminance = [T::ZERO; 4];
    for (channel, weight) in light.chunks_exact(order.coeff_count()).zip(LUMINANCE) {
        // The weights first: they keep a sum of huge radiances finite.
        luminance.iter_mut().zip(channel).for_each(|(sum, &f)| *sum += T::from_f64(weight) * f);
    }
    linear_axis(&luminance[..order.coeff_count().min(4)])
}

/// The directional light that [`dominant_light`] finds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DominantLight<T> {
    /// Towards the light, unit length.
    pub direction: [T; 3],
    /// Red, green, blue: multiples of [`directional_light_normalised`](crate::directional_light_normalised), so a white
    /// surface that faces the light reflects just this radiance. Never negative.
    pub colour: [T; 3],
}

/// The directional light that is nearest to an RGB light, from its dominant direction.
///
/// With `d` the [`dominant_direction`] and `b` the [`directional_light_normalised`](crate::directional_light_normalised) from
/// there, the colour of a channel `f` is the least-squares factor `f·b / b·b`, or 0 if that is negative. To order n it is the
/// radiance of `f` at `d`, times `4π/n²` and the factor of the normalised light.
///
/// - `light`: `[3, n²]`, channel-major: red, green, blue, linear
///
/// A light without a direction is seen from +z, and a black one has the colour 0. Coefficients that are not finite give 0 for
/// their channel. Never NaN.
///
/// ```
/// use sh_core::{Order, directional_light_normalised, dominant_light};
///
/// let order = Order::new(4)?;
/// let mut light = [0.0_f32; 48];
/// for (channel, colour) in light.chunks_exact_mut(16).zip([3.0, 2.0, 1.0]) {
///     directional_light_normalised(order, [0.0, 0.6, -0.8], channel);
///     channel.iter_mut().for_each(|f| *f *= colour);
/// }
/// let found = dominant_light(order, &light);
/// assert!((found.direction[1] - 0.6).abs() < 1e-6 && (found.colour[0] - 3.0).abs() < 1e-5);
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If `light` is not `[3, n²]`.
///
/// Source: [Slo08](crate#references), "Extracting Dominant Light Direction".
pub fn dominant_light<T: Real>(order: Order, light: &[T]) -> DominantLight<T> {
    let direction = dominant_direction(order, light);
    // b = c y and y·y = n²/(4π), so f·b / b·b = 4π/n² f(d) / c.
    let n = order.get() as f64;
    let factor = 4.0 * PI / (n * n) / directional_strength(order);
    let mut colour = [T::ZERO; 3];
    for (colour, channel) in colour.iter_mut().zip(light.chunks_exact(order.coeff_count())) {
        let value = factor * reconstruct(order, channel, direction).to_f64();
        *colour = T::from_f64(if value.is_finite() { value.max(0.0) } else { 0.0 });
    }
    DominantLight { direction, colour }
}

/// Turns radiance into irradiance, in place: `f_lm *= √(4π/(2l+1)) g_l` with the clamped cosine `g`.
///
/// [`reconstruct`] of the result at a normal is the irradiance there. A transfer of 1 without shadows is this over π.
///
/// - `coeffs`: `[n²]`, one channel
///
/// Exact for a light of order n: what the cosine has beyond band n−1 meets nothing. Of a light that had more, nine
/// coefficients keep the irradiance to about 1 % ([RH01](crate#references)). Does not allocate.
///
/// # Panics
/// If `coeffs` is not `[n²]`.
///
/// Source: [RH01](crate#references) eq. 5.
pub fn irradiance_from_radiance<T: Real>(order: Order, coeffs: &mut [T]) {
    let mut cosine = [T::ZERO; Order::MAX];
    let cosine = &mut cosine[..order.get()];
    clamped_cosine(cosine);
    convolve(order, cosine, coeffs);
}

/// The irradiance of a surface: `∫ f(s) max(n·s, 0) ds`.
///
/// - `coeffs`: `[n²]`, one channel of incident radiance
/// - `normal`: unit length
///
/// For many normals, call [`irradiance_from_radiance`] once and [`reconstruct`] for each; that does not allocate.
///
/// ```
/// use sh_core::{Order, ambient_light, irradiance};
///
/// let mut light = [0.0_f64; 16];
/// ambient_light(Order::new(4)?, &mut light);
/// assert!((irradiance(Order::new(4)?, &light, [0.6, 0.0, 0.8]) - std::f64::consts::PI).abs() < 1e-14);
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If `coeffs` is not `[n²]`.
#[cfg(feature = "alloc")]
pub fn irradiance<T: Real>(order: Order, coeffs: &[T], normal: [T; 3]) -> T {
    let mut coeffs = coeffs.to_vec();
    irradiance_from_radiance(order, &mut coeffs);
    reconstruct(order, &coeffs, normal)
}

/// Irradiance as a quadratic form: one symmetric 4×4 matrix per channel, `E(n) = ñᵀ M ñ` with `ñ = (n_x, n_y, n_z, 1)`.
///
/// ```text
///     c1 L22    c1 L2−2  −c1 L21   −c2 L11
///     c1 L2−2  −c1 L22   −c1 L2−1  −c2 L1−1
///    −c1 L21   −c1 L2−1   c3 L20    c2 L10
///    −c2 L11   −c2 L1−1   c2 L10    c4 L00 − c5 L20
///
/// c1 = √(15π)/16   c2 = √(π/3)/2   c3 = 3√(5π)/16   c4 = √π/2   c5 = √(5π)/16
/// ```
///
/// The signs of odd `m` are those of this crate's basis; the paper has none. The first three bands are used, those that the
/// light lacks count as 0.
///
/// - `light`: `[3, n²]`, channel-major
///
/// ```
/// use sh_core::{Order, ambient_light, irradiance_matrices};
///
/// let order = Order::new(3)?;
/// let mut light = [0.0_f64; 27];
/// light.chunks_exact_mut(9).for_each(|channel| ambient_light(order, channel));
/// let [red, ..] = irradiance_matrices(order, &light);
/// assert!((red[3][3] - std::f64::consts::PI).abs() < 1e-14);
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If `light` is not `[3, n²]`.
///
/// Source: [RH01](crate#references) eq. 11-12.
pub fn irradiance_matrices<T: Real>(order: Order, light: &[T]) -> [[[T; 4]; 4]; 3] {
    assert_length("light", light.len(), 3 * order.coeff_count());
    let mut matrices = [[[T::ZERO; 4]; 4]; 3];
    for (matrix, channel) in matrices.iter_mut().zip(light.chunks_exact(order.coeff_count())) {
        *matrix = irradiance_matrix(|l, m| channel.get(index(l, m)).map_or(0.0, |f| f.to_f64()));
    }
    matrices
}

fn irradiance_matrix<T: Real>(f: impl Fn(usize, isize) -> f64) -> [[T; 4]; 4] {
    let c1 = Real::sqrt(15.0 * PI) / 16.0;
    let c2 = Real::sqrt(PI / 3.0) / 2.0;
    let c5 = Real::sqrt(5.0 * PI) / 16.0;
    let (c3, c4) = (3.0 * c5, Real::sqrt(PI) / 2.0);
    let (xy, yz, xz) = (c1 * f(2, -2), -c1 * f(2, -1), -c1 * f(2, 1));
    let (x, y, z) = (-c2 * f(1, 1), -c2 * f(1, -1), c2 * f(1, 0));
    let difference = c1 * f(2, 2);
    [
        [difference, xy, xz, x],
        [xy, -difference, yz, y],
        [xz, yz, c3 * f(2, 0), z],
        [x, y, z, c4 * f(0, 0) - c5 * f(2, 0)],
    ]
    .map(|row| row.map(T::from_f64))
}

/// The energy of each band: `energy[l] = Σ_m f_lm²`, the power spectrum.
///
/// It does not change when the function is rotated; the sum over all bands is the integral of `f²`.
///
/// - `coeffs`: `[n²]`
/// - `energy`: `[n]`, overwritten
///
/// Sums in `f64`.
///
/// ```
/// let mut energy = [0.0_f32; 2];
/// sh_core::band_energy(sh_core::Order::new(2)?, &[3.0, 1.0, 2.0, 2.0], &mut energy);
/// assert_eq!(energy, [9.0, 9.0]);
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If a slice length does not match `order`.
pub fn band_energy<T: Real>(order: Order, coeffs: &[T], energy: &mut [T]) {
    assert_length("coeffs", coeffs.len(), order.coeff_count());
    assert_length("energy", energy.len(), order.get());
    for ((_, band), energy) in order.bands().zip(energy) {
        *energy = T::from_f64(coeffs[band].iter().map(|f| f.to_f64() * f.to_f64()).sum());
    }
}
