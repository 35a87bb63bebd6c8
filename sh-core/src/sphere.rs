//! Point sets on the sphere: an exact quadrature, and evenly spread directions.

use alloc::vec::Vec;
use core::f64::consts::{PI, TAU};

use crate::Real;

/// Points and weights that integrate polynomials on the sphere exactly.
///
/// A product rule: Gauss-Legendre in `z`, equally spaced in longitude. A product of two expansions of order `n` is a
/// polynomial of degree `2(n − 1)`.
///
/// ```
/// let quadrature = sh_core::Quadrature::new(4);
/// let integral: f64 = quadrature.points().iter().map(|([x, _, z], w)| w * x * x * z * z).sum();
/// assert!((integral - 4.0 * std::f64::consts::PI / 15.0).abs() < 1e-14);
/// ```
#[derive(Clone, Debug)]
pub struct Quadrature {
    degree: usize,
    points: Vec<([f64; 3], f64)>,
}

impl Quadrature {
    /// The rule that is exact up to `degree`, with `(degree/2 + 1)(degree + 1)` points.
    ///
    /// Accuracy: about 1e-14 for integrands of size 1, for degrees up to 1022 at least, which is what order 512 needs.
    pub fn new(degree: usize) -> Self {
        let longitudes = degree + 1;
        let around: Vec<[f64; 2]> = (0..longitudes)
            .map(|k| TAU * (k as f64 + 0.5) / longitudes as f64)
            .map(|phi| [Real::cos(phi), Real::sin(phi)])
            .collect();
        let rings = gauss_legendre(degree / 2 + 1);
        let points = rings.flat_map(|(z, weight)| {
            let radius = Real::sqrt((1.0 - z) * (1.0 + z));
            let weight = weight * TAU / longitudes as f64;
            around.iter().map(move |[c, s]| ([radius * c, radius * s, z], weight))
        });
        Self { degree, points: points.collect() }
    }

    /// The degree up to which the rule is exact.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Unit directions with their weights, which add up to 4π.
    pub fn points(&self) -> &[([f64; 3], f64)] {
        &self.points
    }
}

/// Nodes and weights of the Gauss-Legendre rule on `[−1, 1]`, from −1 to 1.
pub(crate) fn gauss_legendre(count: usize) -> impl Iterator<Item = (f64, f64)> {
    (0..count).map(move |k| {
        // The half with z ≥ 0 is computed, the other one is its mirror image.
        let mirrored = count - 1 - k;
        let (z, weight) = gauss_legendre_node(count, k.min(mirrored));
        (if k < mirrored { -z } else { z }, weight)
    })
}

/// The `k`-th node from the end at 1, and its weight: Newton's method from a Chebyshev-like guess.
fn gauss_legendre_node(count: usize, k: usize) -> (f64, f64) {
    if 2 * k + 1 == count {
        let (_, slope) = legendre(count, 0.0);
        return (0.0, 2.0 / (slope * slope));
    }
    let mut z = Real::cos(PI * (k as f64 + 0.75) / (count as f64 + 0.5));
    // The guess has about three digits at worst; Newton doubles them.
    for _ in 0..5 {
        let (value, slope) = legendre(count, z);
        z -= value / slope;
    }
    let (_, slope) = legendre(count, z);
    (z, 2.0 / ((1.0 - z) * (1.0 + z) * slope * slope))
}

/// `P_n(z)` and its derivative, for `|z| < 1`.
fn legendre(n: usize, z: f64) -> (f64, f64) {
    let (mut below, mut value) = (0.0, 1.0);
    for l in 0..n {
        let l = l as f64;
        (below, value) = (value, ((2.0 * l + 1.0) * z * value - l * below) / (l + 1.0));
    }
    (value, n as f64 * (below - z * value) / ((1.0 - z) * (1.0 + z)))
}

/// `count` evenly spread unit directions, each standing for the solid angle `4π/count`: the spherical Fibonacci lattice.
///
/// `z_i = 1 − (2i+1)/count`, longitude `2π i / golden ratio`.
///
/// ```
/// let directions = sh_core::fibonacci(1000);
/// let mean_z2: f64 = directions.iter().map(|[_, _, z]| z * z).sum::<f64>() / 1000.0;
/// assert!((mean_z2 - 1.0 / 3.0).abs() < 1e-6);
/// ```
pub fn fibonacci(count: usize) -> Vec<[f64; 3]> {
    /// `1/golden ratio = (√5 − 1)/2`.
    const TURN: f64 = 0.618_033_988_749_894_9;
    let direction = |i: usize| {
        let z = 1.0 - (2 * i + 1) as f64 / count as f64;
        let turns = i as f64 * TURN;
        let phi = TAU * (turns - (turns as u64) as f64);
        let radius = Real::sqrt((1.0 - z) * (1.0 + z));
        [radius * Real::cos(phi), radius * Real::sin(phi), z]
    };
    (0..count).map(direction).collect()
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;

    /// `∫ x^a y^b z^c` over the sphere, for even exponents: `4π (a−1)!! (b−1)!! (c−1)!! / (a+b+c+1)!!`.
    fn monomial_integral([a, b, c]: [i32; 3]) -> f64 {
        if [a, b, c].iter().any(|e| e % 2 == 1) {
            return 0.0;
        }
        let double_factorial = |k: i32| (1..=k).rev().step_by(2).map(f64::from).product::<f64>();
        4.0 * PI * double_factorial(a - 1) * double_factorial(b - 1) * double_factorial(c - 1)
            / double_factorial(a + b + c + 1)
    }

    #[test]
    fn quadrature_is_exact_up_to_its_degree() {
        for degree in 0..16_usize {
            let quadrature = Quadrature::new(degree);
            assert_eq!(quadrature.degree(), degree);
            assert_eq!(quadrature.points().len(), (degree / 2 + 1) * (degree + 1));
            let d = degree as i32;
            let exponents =
                (0..=d).flat_map(|a| (0..=d - a).flat_map(move |b| (0..=d - a - b).map(move |c| [a, b, c])));
            for e in exponents {
                let value = |p: [f64; 3]| p[0].powi(e[0]) * p[1].powi(e[1]) * p[2].powi(e[2]);
                let sum: f64 = quadrature.points().iter().map(|&(p, w)| w * value(p)).sum();
                // 4π times a few roundings
                assert!((sum - monomial_integral(e)).abs() < 4e-14, "degree {degree}, {e:?}: {sum}");
            }
        }
    }

    #[test]
    fn quadrature_fails_beyond_its_degree() {
        // z^(2k) needs k+1 nodes: degree 6 has 4, exact to z^7. Around the pole x^7 and cos 7φ fail, x^6 does not.
        let value = |e: i32| Quadrature::new(6).points().iter().map(|(p, w)| w * p[2].powi(e)).sum::<f64>();
        assert!((value(6) - 4.0 * PI / 7.0).abs() < 1e-14);
        assert!((value(8) - 4.0 * PI / 9.0).abs() > 1e-3);
    }

    #[test]
    fn gauss_legendre_is_right_at_large_counts() {
        for count in [64, 511, 512] {
            let (mut sum, mut high) = (0.0, 0.0);
            for (z, weight) in gauss_legendre(count) {
                sum += weight;
                // P_l² integrates to 2/(2l+1); l = count − 1 is the highest the rule can do.
                high += weight * legendre(count - 1, z).0.powi(2);
            }
            assert!((sum - 2.0).abs() < 1e-13, "{count}: {sum}");
            let expected = 2.0 / (2 * count - 1) as f64;
            assert!((high / expected - 1.0).abs() < 1e-11, "{count}: {high}");
        }
    }

    #[test]
    fn quadrature_points_are_on_the_sphere() {
        for (p, w) in Quadrature::new(101).points() {
            assert!((p.iter().map(|p| p * p).sum::<f64>() - 1.0).abs() < 5e-16);
            assert!(*w > 0.0);
        }
    }

    #[test]
    fn fibonacci_directions_are_even() {
        for count in [0, 1, 2, 100, 4096] {
            let directions = fibonacci(count);
            assert_eq!(directions.len(), count);
            assert!(directions.iter().all(|d| (d.iter().map(|d| d * d).sum::<f64>() - 1.0).abs() < 1e-15));
        }
        // Every cap of a quarter of the sphere holds a quarter of the points.
        let directions = fibonacci(4096);
        for axis in fibonacci(20) {
            let inside = directions.iter().filter(|d| d.iter().zip(axis).map(|(d, a)| d * a).sum::<f64>() > 0.5);
            assert!((inside.count() as f64 - 1024.0).abs() < 24.0);
        }
        // No two points are closer than 3.09/√count, the distance for the golden ratio (3.54 would be a hexagonal lattice).
        let distance2 = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
        let first = &directions[..200];
        let nearest =
            first.iter().enumerate().flat_map(|(i, a)| directions[i + 1..].iter().map(move |b| distance2(a, b)));
        assert!(nearest.fold(f64::MAX, f64::min).sqrt() > 2.5 / 64.0);
    }
}
