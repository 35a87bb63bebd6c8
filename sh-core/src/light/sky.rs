//! The CIE standard general sky.

use core::f64::consts::{FRAC_PI_2, PI};

use alloc::vec;
use alloc::vec::Vec;

use crate::direction::{cross, dot3, unit, unit_or_z};
use crate::order::assert_length;
use crate::sphere::gauss_legendre;
use crate::{Basis, Error, Order, Real};

/// One of the fifteen skies of the CIE standard general sky: how radiance falls from the zenith and around the sun.
///
/// ```text
/// L(Z, χ) / L(0, Z_s) = f(χ) φ(Z) / (f(Z_s) φ(0))
/// φ(Z) = 1 + a exp(b / cos Z)                             Z: angle from the zenith
/// f(χ) = 1 + c (exp(d χ) − exp(d π/2)) + e cos² χ          χ: angle from the sun, Z_s from the zenith
/// ```
///
/// Source: [CIE03](crate#references).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CieSky {
    a: f64,
    b: f64,
    c: f64,
    d: f64,
    e: f64,
}

impl CieSky {
    /// Type 12, the CIE standard clear sky of low turbidity.
    pub const CLEAR: Self = Self::of(4, 3);
    /// Type 13, the CIE standard clear sky of a polluted atmosphere.
    pub const CLEAR_POLLUTED: Self = Self::of(4, 4);

    /// The sky of a type from 1 (overcast, steep) over 5 (uniform) to 15 (white-blue, turbid, with a broad corona).
    ///
    /// # Errors
    /// [`Error::SkyType`] if the type is not in `1..=15`.
    pub const fn standard(sky_type: u8) -> Result<Self, Error> {
        let (gradation, indicatrix) = match sky_type {
            1..=2 => (0, sky_type - 1),
            3..=4 => (1, sky_type - 3),
            5..=8 => (2, sky_type - 5),
            9..=11 => (3, sky_type - 8),
            12..=13 => (4, sky_type - 9),
            14..=15 => (5, sky_type - 10),
            given => return Err(Error::SkyType { given }),
        };
        Ok(Self::of(gradation, indicatrix as usize))
    }

    /// Six gradations from zenith to horizon, and six indicatrices of scattering.
    const fn of(gradation: usize, indicatrix: usize) -> Self {
        const GRADATIONS: [[f64; 2]; 6] =
            [[4.0, -0.7], [1.1, -0.8], [0.0, -1.0], [-1.0, -0.55], [-1.0, -0.32], [-1.0, -0.15]];
        const INDICATRICES: [[f64; 3]; 6] = [
            [0.0, -1.0, 0.0],
            [2.0, -1.5, 0.15],
            [5.0, -2.5, 0.3],
            [10.0, -3.0, 0.45],
            [16.0, -3.0, 0.3],
            [24.0, -2.8, 0.15],
        ];
        let ([a, b], [c, d, e]) = (GRADATIONS[gradation], INDICATRICES[indicatrix]);
        Self { a, b, c, d, e }
    }

    /// The radiance in a direction, in relation to the zenith's.
    ///
    /// - `zenith_cosine`: of the direction's angle from the zenith; 0 and below is dark
    /// - `sun_angle`: between the direction and the sun, in radians
    /// - `sun_zenith_angle`: of the sun from the zenith, in radians
    pub fn relative_radiance(&self, zenith_cosine: f64, sun_angle: f64, sun_zenith_angle: f64) -> f64 {
        if zenith_cosine <= 0.0 {
            return 0.0;
        }
        let at_zenith = self.indicatrix(sun_zenith_angle) * self.gradation(1.0);
        self.indicatrix(sun_angle) * self.gradation(zenith_cosine) / at_zenith
    }

    fn gradation(&self, zenith_cosine: f64) -> f64 {
        1.0 + self.a * Real::exp(self.b / zenith_cosine)
    }

    fn indicatrix(&self, sun_angle: f64) -> f64 {
        let cosine = Real::cos(sun_angle);
        1.0 + self.c * (Real::exp(self.d * sun_angle) - Real::exp(self.d * FRAC_PI_2)) + self.e * cosine * cosine
    }
}

/// The CIE standard clear sky, of radiance 1 at the zenith: [`cie_sky`] with [`CieSky::CLEAR`].
///
/// # Panics
/// If `out` is not `[n²]`.
pub fn clear_sky<T: Real>(order: Order, up: [T; 3], sun: [T; 3], out: &mut [T]) {
    cie_sky(order, CieSky::CLEAR, up, sun, out);
}

/// A CIE standard sky, of radiance 1 at the zenith; without the sun itself, and dark below the horizon.
///
/// - `up`: to the zenith; `sun`: to the sun, which may have set; any length, +z if zero or not finite
/// - `out`: `[n²]`, overwritten
///
/// The standard is relative to the zenith. For a given irradiance `E` of level ground, divide by
/// [`irradiance`](crate::irradiance) at `up` and multiply by `E`. Add a [`disk_light`](super::disk_light) for the sun.
///
/// By quadrature in angles about the sun, where the radiance has a kink, cut at the horizon, where it jumps. Accuracy:
/// 2e-7 of band 0 for every type and sun, 1e-8 for the clear sky with the sun up; asserted by `skies_are_their_integrals` in
/// `tests/lights.rs`. Takes about `3 (2n + 40)²` evaluations of the basis, once per sky.
///
/// ```
/// use sh_core::{Order, clear_sky, irradiance};
///
/// let (order, up) = (Order::new(6)?, [0.0, 1.0, 0.0]);
/// let mut sky = [0.0_f32; 36];
/// clear_sky(order, up, [0.6, 0.8, 0.0], &mut sky);
/// let to_sun = irradiance(order, &sky, [1.0, 0.0, 0.0]);
/// let from_sun = irradiance(order, &sky, [-1.0, 0.0, 0.0]);
/// assert!(to_sun > 1.5 * from_sun);
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If `out` is not `[n²]`.
///
/// Source: [CIE03](crate#references).
pub fn cie_sky<T: Real>(order: Order, sky: CieSky, up: [T; 3], sun: [T; 3], out: &mut [T]) {
    assert_length("out", out.len(), order.coeff_count());
    let sums = integrate(order, sky, &SunFrame::new(unit_or_z(up), unit_or_z(sun)), 2 * order.get() + EXTRA_POINTS);
    out.iter_mut().zip(sums).for_each(|(out, sum)| *out = T::from_f64(sum));
}

/// `∫ L y_i` with `count` points for each angle and piece.
fn integrate(order: Order, sky: CieSky, frame: &SunFrame, count: usize) -> Vec<f64> {
    let basis = Basis::<f64>::new(order);
    let (mut y, mut sums) = (vec![0.0; order.coeff_count()], vec![0.0; order.coeff_count()]);
    frame.for_each_point(count, |direction, sun_angle, zenith_cosine, weight| {
        let value = weight * sky.relative_radiance(zenith_cosine, sun_angle, frame.sun_zenith_angle);
        basis.eval(direction, &mut y);
        sums.iter_mut().zip(&y).for_each(|(sum, y)| *sum += value * y);
    });
    sums
}

/// Points in each of the two angles, beyond the two per band that resolve the basis around a ring. They resolve the radiance:
/// with 40 the accuracy stated for [`cie_sky`], each 24 more give two digits.
const EXTRA_POINTS: usize = 40;

/// Angles about the sun, the second one from the direction of the zenith.
struct SunFrame {
    sun: [f64; 3],
    towards_up: [f64; 3],
    across: [f64; 3],
    sun_zenith_angle: f64,
}

impl SunFrame {
    fn new(up: [f64; 3], sun: [f64; 3]) -> Self {
        let normal = cross(sun, up);
        let sine = Real::sqrt(dot3(normal, normal));
        // With the sun at the zenith every direction across will do.
        let across = unit(normal).unwrap_or_else(|| perpendicular(sun));
        Self { sun, towards_up: cross(across, sun), across, sun_zenith_angle: Real::atan2(sine, dot3(sun, up)) }
    }

    /// Calls `visit(direction, angle from the sun, cosine of the angle from the zenith, weight)` for all points above the
    /// horizon.
    fn for_each_point(&self, count: usize, mut visit: impl FnMut([f64; 3], f64, f64, f64)) {
        let rule: Vec<_> = gauss_legendre(count).collect();
        // A ring about the sun is whole or below the horizon, but for those between these two radii.
        let first = (FRAC_PI_2 - self.sun_zenith_angle).abs();
        for (start, end) in [(0.0, first), (first, PI - first), (PI - first, PI)] {
            for &(t, weight) in &rule {
                // The sine clusters points at the ends: there the part of a ring above the horizon changes as a square root.
                let sun_angle = 0.5 * (start + end) + 0.5 * (end - start) * Real::sin(FRAC_PI_2 * t);
                let weight = weight * 0.5 * (end - start) * FRAC_PI_2 * Real::cos(FRAC_PI_2 * t);
                self.for_each_on_ring(sun_angle, weight, &rule, &mut visit);
            }
        }
    }

    fn for_each_on_ring(
        &self,
        sun_angle: f64,
        weight: f64,
        rule: &[(f64, f64)],
        visit: &mut impl FnMut([f64; 3], f64, f64, f64),
    ) {
        let (c, s) = (Real::cos(sun_angle), Real::sin(sun_angle));
        // cos Z = along + around cos ψ
        let (along, around) = (c * Real::cos(self.sun_zenith_angle), s * Real::sin(self.sun_zenith_angle));
        // Above the horizon for |ψ| < half; acos(−along/around), and 0 or π where there is no such angle.
        let half = match -along {
            level if level >= around => return,
            level if level <= -around => PI,
            level => Real::atan2(Real::sqrt((around - level) * (around + level)), level),
        };
        for &(t, ring_weight) in rule {
            let psi = half * t;
            let (x, y) = (s * Real::cos(psi), s * Real::sin(psi));
            let direction = core::array::from_fn(|k| c * self.sun[k] + x * self.towards_up[k] + y * self.across[k]);
            visit(direction, sun_angle, along + around * Real::cos(psi), weight * ring_weight * half * s);
        }
    }
}

/// Some unit vector perpendicular to a unit vector.
fn perpendicular([x, y, z]: [f64; 3]) -> [f64; 3] {
    let across = if x.abs() < 0.6 { [0.0, z, -y] } else { [-z, 0.0, x] };
    unit_or_z(across)
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    /// More points change nothing: every type, the sun from the zenith to the nadir.
    #[test]
    fn the_points_are_enough_for_every_sky() {
        let order = Order::new(4).unwrap();
        let angles = [0.0, 1e-8, 0.01, 0.3, 0.8, 1.2, 1.5, 1.56, FRAC_PI_2, 1.58, 1.65, 1.75, 1.9, 2.3, 2.8, 3.13, PI];
        for (sky_type, angle) in (1..=15).flat_map(|sky_type| angles.map(|angle| (sky_type, angle))) {
            let sky = CieSky::standard(sky_type).unwrap();
            let frame = SunFrame::new([0.0, 0.0, 1.0], [Real::sin(angle), 0.0, Real::cos(angle)]);
            let (some, more) =
                (integrate(order, sky, &frame, 2 * 4 + EXTRA_POINTS), integrate(order, sky, &frame, 120));
            let error = some.iter().zip(&more).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / more[0];
            assert!(error < 2e-7, "type {sky_type}, sun at {angle}: {error:e}");
        }
    }
}
