//! Analytic lights: coefficients without a map.
//!
//! Each function writes `[n²]`, one channel; the light is scaled by its colour afterwards.

#[cfg(feature = "alloc")]
mod polygon;
#[cfg(feature = "alloc")]
mod sky;

use core::f64::consts::PI;

#[cfg(feature = "alloc")]
pub use polygon::polygon_light;
#[cfg(feature = "alloc")]
pub use sky::{CieSky, cie_sky, clear_sky};

use crate::direction::unit_or_z;
use crate::order::assert_length;
use crate::zonal::{cap_kernel, clamped_cosine, clamped_cosine_power, expand_zonal, spherical_cap, zonal_value};
use crate::{Order, Real, dot, eval};

/// Expands a zonal function that `fill` writes, about an axis of any length.
fn expand_about<T: Real>(order: Order, axis: [T; 3], fill: impl FnOnce(&mut [T]), out: &mut [T]) {
    let mut zonal = [T::ZERO; Order::MAX];
    let zonal = &mut zonal[..order.get()];
    fill(zonal);
    expand_zonal(order, zonal, unit_or_z(axis).map(T::from_f64), out);
}

/// A light from one direction, of irradiance 1: the delta function, `out[i] = y_i(direction)`.
///
/// A surface that faces it receives the irradiance 1 and reflects, if it is white, the radiance `1/π`. That is so of the exact
/// light; to order n, see [`directional_light_normalised`].
///
/// - `direction`: towards the light, any length; +z if it is zero or not finite
/// - `out`: `[n²]`, overwritten
///
/// # Panics
/// If `out` is not `[n²]`.
pub fn directional_light<T: Real>(order: Order, direction: [T; 3], out: &mut [T]) {
    eval(order, unit_or_z(direction).map(T::from_f64), out);
}

/// A light from one direction, of such a strength that a white diffuse surface which faces it reflects the radiance 1, as
/// computed to order n.
///
/// ```text
/// out[i] = c y_i(direction)     c = π / Σ_l √((2l+1)/(4π)) g_l     g: clamped cosine
/// ```
///
/// `c` is 4π, 4π/3, 16π/17, 16π/17, 32π/31, 32π/31 for n = 1…6 and tends to π: the order cuts off a part of the reflected
/// light, and the factor makes up for it. DirectX normalises its directional light so.
///
/// - `direction`: towards the light, any length; +z if it is zero or not finite
/// - `out`: `[n²]`, overwritten
///
/// ```
/// use sh_core::{Order, directional_light_normalised, irradiance_from_radiance, reconstruct};
///
/// let (order, sun) = (Order::new(3)?, [0.0, 0.6, 0.8]);
/// let mut light = [0.0_f64; 9];
/// directional_light_normalised(order, sun, &mut light);
/// irradiance_from_radiance(order, &mut light);
/// let reflected = reconstruct(order, &light, sun) / std::f64::consts::PI;
/// assert!((reflected - 1.0).abs() < 1e-15);
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If `out` is not `[n²]`.
///
/// Source: [Slo08](crate#references), "Normalization".
pub fn directional_light_normalised<T: Real>(order: Order, direction: [T; 3], out: &mut [T]) {
    directional_light(order, direction, out);
    let strength = directional_strength(order);
    out.iter_mut().for_each(|f| *f *= T::from_f64(strength));
}

/// The irradiance of [`directional_light_normalised`]: 16π/17 for n = 3.
pub(crate) fn directional_strength(order: Order) -> f64 {
    let mut cosine = [0.0; Order::MAX];
    let cosine = &mut cosine[..order.get()];
    clamped_cosine(cosine);
    PI / zonal_value(cosine, 1.0)
}

/// A disk of light of radiance 1 around a direction, as the sun: the cap of the given angular radius.
///
/// Its irradiance on a surface that faces it is `π sin² α` up to `α = π/2`, and π beyond.
///
/// - `direction`: towards the centre, any length; +z if it is zero or not finite
/// - `angular_radius`: `α`, half the apparent size, in radians; π and more is light from everywhere, 0, less, and NaN are dark
/// - `out`: `[n²]`, overwritten
///
/// # Panics
/// If `out` is not `[n²]`.
///
/// Source: [Slo08](crate#references), the spherical light source.
pub fn disk_light<T: Real>(order: Order, direction: [T; 3], angular_radius: T, out: &mut [T]) {
    expand_about(order, direction, |zonal| spherical_cap(angular_radius, zonal), out);
}

/// A ball of light of radiance 1: [`disk_light`] with `sin α = radius / |centre|`.
///
/// - `centre`: from the point that is lit, in the unit of `radius`
/// - `radius`: from inside, and on the surface, light comes from everywhere; 0, less, and NaN are dark
/// - `out`: `[n²]`, overwritten
///
/// Dark for a centre that is not finite.
///
/// # Panics
/// If `out` is not `[n²]`.
pub fn sphere_light<T: Real>(order: Order, centre: [T; 3], radius: T, out: &mut [T]) {
    disk_light(order, centre, T::from_f64(angular_radius(centre.map(T::to_f64), radius.to_f64())), out);
}

fn angular_radius(centre: [f64; 3], radius: f64) -> f64 {
    let distance = Real::hypot(Real::hypot(centre[0], centre[1]), centre[2]);
    if !distance.is_finite() || radius.is_nan() || radius <= 0.0 {
        0.0
    } else if radius >= distance {
        PI
    } else {
        // The quotient first: squares could overflow.
        let sine = radius / distance;
        Real::atan2(sine, Real::sqrt((1.0 - sine) * (1.0 + sine)))
    }
}

/// A uniform cone of light from a direction, of such a strength that a white diffuse surface which faces it reflects the
/// radiance 1, as computed to order n.
///
/// The shape of [`disk_light`], the normalisation of [`directional_light_normalised`], which it becomes for the angle 0. Its
/// radiance is `π/Σ_l g_l h_l` with the coefficients `g` of the clamped cosine and `h` of the cap: about `1/sin² α` up to
/// `α = π/2`.
///
/// - `direction`: towards the light, any length; +z if it is zero or not finite
/// - `half_angle`: `α`, from the axis to the edge, in radians; below 0 and NaN count as 0, above π as π
/// - `out`: `[n²]`, overwritten
///
/// # Panics
/// If `out` is not `[n²]`.
///
/// Source: [Slo08](crate#references), "Normalization"; DirectX's cone light.
pub fn cone_light<T: Real>(order: Order, direction: [T; 3], half_angle: T, out: &mut [T]) {
    let fill = |zonal: &mut [T]| {
        let (mut cosine, mut cap) = ([0.0; Order::MAX], [0.0; Order::MAX]);
        let (cosine, cap) = (&mut cosine[..order.get()], &mut cap[..order.get()]);
        clamped_cosine(cosine);
        cap_kernel(half_angle.to_f64(), cap);
        // ∫ cosine · cap: the irradiance of a cap of power 1.
        let radiance = PI / dot(cosine, cap);
        zonal.iter_mut().zip(cap).for_each(|(g, cap)| *g = T::from_f64(radiance * *cap));
    };
    expand_about(order, direction, fill, out);
}

/// Sky above, ground below: two half spaces of uniform radiance.
///
/// The irradiance at a normal `n` is the blend `π (sky (1 + n·up)/2 + ground (1 − n·up)/2)`, exactly for every order from 2,
/// which is the usual formula of a hemisphere light.
///
/// - `up`: from ground to sky, any length; +z if it is zero or not finite
/// - `sky`, `ground`: radiances of this channel
/// - `out`: `[n²]`, overwritten
///
/// # Panics
/// If `out` is not `[n²]`.
pub fn hemisphere_light<T: Real>(order: Order, up: [T; 3], sky: T, ground: T, out: &mut [T]) {
    let (mean, contrast) = (T::from_f64(0.5) * (sky + ground), sky - ground);
    let fill = |zonal: &mut [T]| {
        clamped_cosine_power(T::ZERO, zonal);
        zonal.iter_mut().for_each(|g| *g *= contrast);
        zonal[0] = mean * T::from_f64(Real::sqrt(4.0 * PI));
    };
    expand_about(order, up, fill, out);
}

/// Light of radiance 1 from everywhere: `√(4π)` in band 0. Its irradiance is π on every surface.
///
/// - `out`: `[n²]`, overwritten
///
/// # Panics
/// If `out` is not `[n²]`.
pub fn ambient_light<T: Real>(order: Order, out: &mut [T]) {
    assert_length("out", out.len(), order.coeff_count());
    out.fill(T::ZERO);
    out[0] = T::from_f64(Real::sqrt(4.0 * PI));
}

/// The overcast sky of Moon and Spencer, of radiance 1 at the zenith: `(1 + 2 cos θ)/3` at the angle `θ` from the zenith.
///
/// Three times brighter at the zenith than at the horizon, dark below. In closed form for every order; the irradiance of a
/// level surface is 7π/9.
///
/// - `up`: to the zenith, any length; +z if it is zero or not finite
/// - `out`: `[n²]`, overwritten
///
/// # Panics
/// If `out` is not `[n²]`.
///
/// Source: [MS42](crate#references); kept by [CIE03](crate#references) as the traditional overcast sky.
pub fn overcast_sky<T: Real>(order: Order, up: [T; 3], out: &mut [T]) {
    let fill = |zonal: &mut [T]| {
        let (mut flat, mut cosine) = ([0.0; Order::MAX], [0.0; Order::MAX]);
        let (flat, cosine) = (&mut flat[..order.get()], &mut cosine[..order.get()]);
        clamped_cosine_power(0.0, flat);
        clamped_cosine(cosine);
        let sums = flat.iter().zip(cosine).map(|(flat, cosine)| (flat + 2.0 * *cosine) / 3.0);
        zonal.iter_mut().zip(sums).for_each(|(g, sum)| *g = T::from_f64(sum));
    };
    expand_about(order, up, fill, out);
}
