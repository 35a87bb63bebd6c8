//! Light in a sinusoidal groove, by integrals over its cross-section.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI, TAU};

use nalgebra::DMatrix;
use sh_core::{Basis, Order, Quadrature};

use crate::Error;

/// A surface of parallel grooves, `z = −d (1 − cos 2πx)/2`, the same for all y.
///
/// Lengths are in widths of a groove: `x` and the depth `d`. Crests are at whole `x`, at height 0; the bottom is at `x = ½`, at
/// height `−d`. Its transfer is that of a single groove in a plane, too: what is beyond the next crest is hidden by it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Groove {
    depth: f64,
}

impl Groove {
    /// The deepest groove. The light at its bottom is far below what `f32` tells from none.
    pub const MAX_DEPTH: f64 = 1e3;

    /// A groove of a depth in `0..=`[`Groove::MAX_DEPTH`] of its widths.
    ///
    /// # Errors
    /// [`Error::Parameter`] for another depth.
    pub fn new(depth: f64) -> Result<Self, Error> {
        if !(0.0..=Self::MAX_DEPTH).contains(&depth) {
            return Err(Error::Parameter { what: "depth of the groove", given: depth, accepted: "0..=1000 widths" });
        }
        Ok(Self { depth })
    }

    /// The height `z` at `x`.
    #[must_use]
    pub fn height(&self, x: f64) -> f64 {
        let sine = (PI * x).sin();
        -self.depth * sine * sine
    }

    /// `dz/dx`.
    fn slope(&self, x: f64) -> f64 {
        -PI * self.depth * (TAU * x).sin()
    }

    /// The unit normal at `x`, in the frame of the undisturbed surface.
    #[must_use]
    pub fn normal(&self, x: f64) -> [f64; 3] {
        let slope = self.slope(x);
        let length = slope.hypot(1.0);
        [-slope / length, 0.0, 1.0 / length]
    }

    /// The angles from +z towards +x, from the left to the right one, between which the sky is seen in the cross-section.
    fn horizons(&self, x: f64) -> [f64; 2] {
        let x = x - x.floor();
        // The left side is the mirror image of the right one.
        [-FRAC_PI_2 + self.right_elevation(1.0 - x), FRAC_PI_2 - self.right_elevation(x)]
    }

    /// Elevation of the horizon towards +x, for `x` in `0..=1`.
    fn right_elevation(&self, x: f64) -> f64 {
        // From three quarters on the wall bends away from its tangent.
        if x >= 0.75 {
            return self.slope(x).atan();
        }
        // The tangent through x touches the last quarter, where the difference of tangent and chord falls through 0.
        let here = self.height(x);
        let rises = |t: f64| self.slope(t) * (t - x) > self.height(t) - here;
        let (mut low, mut high) = (0.75, 1.0);
        for _ in 0..f64::MANTISSA_DIGITS {
            let middle = 0.5 * (low + high);
            *(if rises(middle) { &mut low } else { &mut high }) = middle;
        }
        ((self.height(low) - here) / (low - x)).atan()
    }
}

/// Diffuse transfer of a groove at evenly spaced points.
///
/// Point `k` of `count` is at `x = k/count`. Direct light is integrated over the visible wedge of the sky; interreflection follows
/// from the form factors of the cross-section, all bounces at once.
///
/// - `albedo`: of the walls, in `0..=1`, for what they reflect onto each other; 0 is direct light alone
///
/// Returns `[count, n²]` in the frame of the undisturbed surface: x across the groove, y along it, z up. The `1/π` is included,
/// the albedo of the receiving point is not.
///
/// Accuracy: the direct part 1e-12 at n = 6 (`direct_light_is_that_of_brute_force` compares 1e-3, which is the other's);
/// interreflection converges with `count`; energy is kept exactly, so that a white furnace gives 1 for any count.
///
/// # Errors
/// [`Error::Parameter`] for an albedo out of its range or a `count` that is not in `1..=4096`.
///
/// Source: the transfer of [SLS05](sh_core#references) section 4.2, wrinkle model; the form factor of a strip that is endless
/// in y is half the difference of the sines of its angles to the normal: Hottel's method of crossed strings.
pub fn groove_transfer(order: Order, groove: &Groove, albedo: f64, count: usize) -> Result<Vec<f64>, Error> {
    /// 4,096 points are a linear system of 128 MiB.
    const MAX_POINTS: usize = 4096;
    if !(0.0..=1.0).contains(&albedo) {
        return Err(Error::Parameter { what: "albedo", given: albedo, accepted: "0..=1" });
    }
    if !(1..=MAX_POINTS).contains(&count) {
        return Err(Error::Parameter { what: "number of points", given: count as f64, accepted: "1..=4096" });
    }
    let mut sky = Sky::new(order);
    let points = (0..count).map(|k| k as f64 / count as f64);
    let mut transfer: Vec<f64> = points.flat_map(|x| sky.direct(groove, x)).collect();
    if albedo > 0.0 && groove.depth > 0.0 {
        interreflect(groove, albedo, count, &mut transfer);
    }
    Ok(transfer)
}

/// Integrates over wedges of the sky whose edge is the y axis.
#[derive(Debug)]
struct Sky {
    basis: Basis<f64>,
    values: Vec<f64>,
    /// Nodes and weights on `[−1, 1]`.
    rule: Vec<[f64; 2]>,
}

impl Sky {
    fn new(order: Order) -> Self {
        // Trigonometric polynomials of degree n over up to π: the rule converges to rounding within n + 16 nodes.
        let rule = gauss_legendre(order.get() + 16);
        Self { basis: Basis::new(order), values: vec![0.0; order.coeff_count()], rule }
    }

    /// `1/π ∫ max(n·s, 0) V(s) y(s) ds`, with `s = (sin η sin ψ, cos η, sin η cos ψ)` and `ds = sin η dη dψ`.
    fn direct(&mut self, groove: &Groove, x: f64) -> Vec<f64> {
        let [left, right] = groove.horizons(x);
        let tilt = -groove.slope(x).atan();
        let mut sums = vec![0.0; self.values.len()];
        for &[u, across] in &self.rule {
            let psi = 0.5 * ((right + left) + (right - left) * u);
            let cosine = (psi - tilt).cos() * across * 0.5 * (right - left);
            for &[v, along] in &self.rule {
                let eta = FRAC_PI_2 * (1.0 + v);
                let (sin, cos) = eta.sin_cos();
                self.basis.eval([sin * psi.sin(), cos, sin * psi.cos()], &mut self.values);
                let weight = FRAC_1_PI * cosine * sin * sin * along * FRAC_PI_2;
                sums.iter_mut().zip(&self.values).for_each(|(sum, y)| *sum += weight * y);
            }
        }
        sums
    }
}

/// The rings of a quadrature of the sphere are the nodes of Gauss and Legendre.
fn gauss_legendre(count: usize) -> Vec<[f64; 2]> {
    let quadrature = Quadrature::new(2 * (count - 1));
    let longitudes = quadrature.degree() + 1;
    let rings = quadrature.points().iter().step_by(longitudes);
    rings.map(|([_, _, z], weight)| [*z, weight * longitudes as f64 / TAU]).collect()
}

/// Solves `T = T⁰ + ρ F T`.
fn interreflect(groove: &Groove, albedo: f64, count: usize, transfer: &mut [f64]) {
    let coeffs = transfer.len() / count;
    let mut system = DMatrix::identity(count, count);
    for (k, factors) in form_factors(groove, count).chunks_exact(count).enumerate() {
        factors.iter().enumerate().for_each(|(j, factor)| system[(k, j)] -= albedo * factor);
    }
    let direct = DMatrix::from_row_slice(count, coeffs, transfer);
    // Walls reflect at most what they get and part of it reaches the sky, so the matrix is dominated by its diagonal.
    if let Some(solved) = system.lu().solve(&direct) {
        for (k, row) in transfer.chunks_exact_mut(coeffs).enumerate() {
            row.iter_mut().zip(solved.row(k).iter()).for_each(|(to, from)| *to = *from);
        }
    }
}

/// `[count, count]`: the share of what a point sees, weighted by the cosine, that is the wall around another point.
fn form_factors(groove: &Groove, count: usize) -> Vec<f64> {
    let mut factors = vec![0.0; count * count];
    for (k, row) in factors.chunks_exact_mut(count).enumerate() {
        let tilt = -groove.slope(k as f64 / count as f64).atan();
        for side in [1, -1] {
            sweep(groove, k, side, tilt, row);
        }
    }
    factors
}

/// Walks along the wall to one side of a point up to the crest. What rises above all before it is seen.
fn sweep(groove: &Groove, k: usize, side: isize, tilt: f64, row: &mut [f64]) {
    let count = row.len() as isize;
    let at = |j: isize| j as f64 / count as f64;
    let k = k as isize;
    let (x, crest) = if side > 0 { (at(k), count) } else { (at(k), 0) };
    let [left, right] = groove.horizons(x);
    let horizon = if side > 0 { right } else { -left };
    // Angles from +z towards the side. Nothing is seen below the tangent.
    let tilt = tilt * side as f64;
    let (mut seen, mut last) = (FRAC_PI_2 + tilt, k);
    let mut add = |ends: [isize; 2], from: f64, to: f64| {
        let strip = 0.5 * ((from - tilt).sin() - (to - tilt).sin()).max(0.0);
        // Each end of a piece of wall takes half.
        ends.iter().for_each(|end| row[end.rem_euclid(count) as usize] += 0.5 * strip);
    };
    for step in 1..=(crest - k).abs() {
        let j = k + side * step;
        let angle = (at(j) - x).abs().atan2(groove.height(at(j)) - groove.height(x)).max(horizon);
        if angle < seen {
            add([j - side, j], seen, angle);
            (seen, last) = (angle, j);
        }
    }
    // The rest below the exact horizon, which lies between two points.
    if horizon < seen {
        add([last, last], seen, horizon);
    }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    use std::f64::consts::FRAC_1_PI;

    use proptest::prelude::*;
    use sh_core::{clamped_cosine, eval, fibonacci};

    use super::*;

    fn order(n: usize) -> Order {
        Order::new(n).unwrap()
    }

    /// Where a ray in three dimensions meets the groove: `None` if it escapes. By small steps.
    fn hit(groove: &Groove, x: f64, z: f64, direction: [f64; 3]) -> Option<[f64; 2]> {
        let step = 0.002;
        let across = direction[0].hypot(direction[2]).max(1e-9);
        let [dx, dz] = [direction[0] / across * step, direction[2] / across * step];
        let (mut x, mut z) = (x + 0.5 * dx, z + 0.5 * dz);
        while z <= 0.0 {
            if z < groove.height(x) {
                return Some([x, groove.height(x)]);
            }
            (x, z) = (x + dx, z + dz);
        }
        None
    }

    fn near(a: &[f64], b: &[f64], tolerance: f64) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < tolerance)
    }

    #[test]
    fn without_depth_it_is_the_clamped_cosine() {
        for n in [1, 2, 6, 10] {
            let mut zonal = vec![0.0; n];
            clamped_cosine(&mut zonal);
            let transfer = groove_transfer(order(n), &Groove::new(0.0).unwrap(), 0.8, 3).unwrap();
            for point in transfer.chunks_exact(n * n) {
                let expected: Vec<f64> = (0..n * n)
                    .map(|i| (i.isqrt(), i))
                    .map(|(l, i)| if i == l * (l + 1) { zonal[l] * FRAC_1_PI } else { 0.0 })
                    .collect();
                assert!(near(point, &expected, 1e-13), "{point:?}");
            }
        }
    }

    #[test]
    fn direct_light_is_that_of_brute_force() {
        let groove = Groove::new(0.7).unwrap();
        let directions = fibonacci(40_000);
        let mut sky = Sky::new(order(4));
        for x in [0.05, 0.3, 0.5, 0.8] {
            let (normal, z) = (groove.normal(x), groove.height(x));
            let mut expected = vec![0.0; 16];
            let mut values = vec![0.0; 16];
            for s in &directions {
                let cosine = s[0] * normal[0] + s[2] * normal[2];
                if cosine > 0.0 && hit(&groove, x, z, *s).is_none() {
                    eval(order(4), *s, &mut values);
                    let weight = FRAC_1_PI * cosine * 4.0 * PI / directions.len() as f64;
                    expected.iter_mut().zip(&values).for_each(|(sum, y)| *sum += weight * y);
                }
            }
            // The steps of the rays: 0.001 of an angle.
            assert!(near(&sky.direct(&groove, x), &expected, 2e-3), "{x} {expected:?} {:?}", sky.direct(&groove, x));
        }
    }

    /// Random walks in three dimensions: each carries the albedo of what it met to the sky.
    #[test]
    fn interreflection_is_that_of_random_walks() {
        let (groove, albedo, walks) = (Groove::new(1.0).unwrap(), 0.8, 20_000);
        let transfer = groove_transfer(order(2), &groove, albedo, 100).unwrap();
        let mut state = 1_u64;
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        for k in [30, 50] {
            let mut sums = [0.0; 4];
            for _ in 0..walks {
                let (mut x, mut weight) = (k as f64 / 100.0, 1.0);
                loop {
                    let [nx, _, nz] = groove.normal(x);
                    let (r, phi) = (random().sqrt(), TAU * random());
                    let (a, b, c) = (r * phi.cos(), r * phi.sin(), (1.0 - r * r).sqrt());
                    // Tangent (nz, 0, −nx) and y.
                    let s = [a * nz + c * nx, b, c * nz - a * nx];
                    let Some([hit_x, _]) = hit(&groove, x, groove.height(x), s) else {
                        let mut values = [0.0; 4];
                        eval(order(2), s, &mut values);
                        sums.iter_mut().zip(values).for_each(|(sum, y)| *sum += weight * y);
                        break;
                    };
                    (x, weight) = (hit_x, weight * albedo);
                }
            }
            let expected = sums.map(|sum| sum / f64::from(walks));
            // A standard deviation is at most 0.5/√20,000 = 0.0035.
            assert!(
                near(&transfer[4 * k..4 * k + 4], &expected, 0.012),
                "{:?} {expected:?}",
                &transfer[4 * k..4 * k + 4]
            );
        }
    }

    proptest! {
        /// White walls under a white sky look white: everywhere, however deep, with however few points.
        #[test]
        fn a_white_furnace_is_white(depth in 0.0_f64..3.0, count in 1_usize..60) {
            let transfer = groove_transfer(order(1), &Groove::new(depth * depth * depth).unwrap(), 1.0, count).unwrap();
            for t in transfer {
                prop_assert!((t * 2.0 * PI.sqrt() - 1.0).abs() < 1e-9, "{t}");
            }
        }

        #[test]
        fn albedo_only_adds_light(depth in 0.0_f64..4.0, albedo in 0.0_f64..=1.0) {
            let groove = Groove::new(depth).unwrap();
            let [dark, light] = [0.0, albedo].map(|albedo| groove_transfer(order(1), &groove, albedo, 16).unwrap());
            prop_assert!(dark.iter().zip(&light).all(|(dark, light)| *light >= dark - 1e-12 && *dark >= 0.0));
        }

        /// Mirroring x leaves the surface as it is.
        #[test]
        fn the_two_sides_are_mirror_images(depth in 0.0_f64..4.0) {
            // Not 12, where three points lie on a line and rounding decides which of them is seen.
            let count = 11;
            let transfer = groove_transfer(order(4), &Groove::new(depth).unwrap(), 0.5, count).unwrap();
            for k in 1..count {
                let (here, there) = (&transfer[16 * k..][..16], &transfer[16 * (count - k)..][..16]);
                for l in 0..4_usize {
                    for m in -(l as isize)..=l as isize {
                        let sign = if (m < 0) != (m % 2 == 0) { 1.0 } else { -1.0 };
                        let i = sh_core::index(l, m);
                        prop_assert!((here[i] - sign * there[i]).abs() < 1e-9, "{l} {m}: {} {}", here[i], there[i]);
                    }
                }
            }
        }
    }

    #[test]
    fn more_points_change_little() {
        let groove = Groove::new(1.0).unwrap();
        let at = |count: usize| {
            let transfer = groove_transfer(order(3), &groove, 0.8, count).unwrap();
            transfer[9 * (count / 4)..][..9].to_vec()
        };
        let (coarse, fine, finest) = (at(32), at(64), at(256));
        let distance = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
        assert!(distance(&fine, &finest) < 0.5 * distance(&coarse, &finest), "{coarse:?} {fine:?} {finest:?}");
        assert!(distance(&fine, &finest) < 1e-3);
    }

    #[test]
    fn normals_and_heights_belong_together() {
        let groove = Groove::new(0.6).unwrap();
        assert_eq!((groove.height(0.0), groove.height(0.5), groove.normal(0.5)[2]), (0.0, -0.6, 1.0));
        for x in [0.1, 0.37, 0.9, 1.3, -0.2] {
            let slope = (groove.height(x + 1e-5) - groove.height(x - 1e-5)) / 2e-5;
            let [nx, ny, nz] = groove.normal(x);
            assert!((nx + slope * nz).abs() < 1e-8 && ny == 0.0 && (nx * nx + nz * nz - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn extremes_are_finite_and_others_refused() {
        let deepest = groove_transfer(order(6), &Groove::new(Groove::MAX_DEPTH).unwrap(), 1.0, 64).unwrap();
        assert!(deepest.iter().all(|t| t.is_finite() && t.abs() < 1.0));
        for depth in [-0.1, f64::NAN, f64::INFINITY, 1001.0] {
            assert!(Groove::new(depth).unwrap_err().to_string().starts_with("depth of the groove is"));
        }
        let groove = Groove::new(1.0).unwrap();
        assert!(
            groove_transfer(order(2), &groove, 1.5, 8).is_err()
                && groove_transfer(order(2), &groove, f64::NAN, 8).is_err()
        );
        assert!(groove_transfer(order(2), &groove, 0.5, 0).is_err());
    }
}
