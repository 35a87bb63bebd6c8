//! The smallest value of a zonal function: a polynomial in z.

use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::PI;

use crate::Real;

/// The minimum of a zonal function about +z over the sphere, as `(value, z)`.
///
/// The function is a polynomial in z. The roots of its derivative are found between those of the derivative's own derivative,
/// and so on down to a constant: between them each is monotone, so none is overlooked. It works in `f64`, on sums of Legendre
/// polynomials; the cost grows as `n³`.
///
/// - `zonal`: `[n]`
///
/// Of several minima that are equal the one with the smallest z is returned; of a constant, z = 1. For an empty slice the
/// value is 0; if a coefficient is not finite, NaN; z is 1 then.
///
/// Accuracy: 1e-14 of the sum of the coefficients, asserted by `tests/window.rs` to n = 64.
///
/// ```
/// // 3z² − 1 is lowest on the equator.
/// let (value, z) = sh_core::minimum_zonal(&[0.0_f64, 0.0, 4.0 * (std::f64::consts::PI / 5.0).sqrt()]);
/// assert!((value + 1.0).abs() < 1e-15 && z.abs() < 1e-15);
/// ```
pub fn minimum_zonal<T: Real>(zonal: &[T]) -> (T, T) {
    if !zonal.iter().all(|g| g.is_finite()) {
        return (T::from_f64(f64::NAN), T::ONE);
    }
    // Σ g_l √((2l+1)/4π) P_l(z)
    let norm = |l: usize| Real::sqrt((2 * l + 1) as f64 / (4.0 * PI));
    let series: Vec<f64> = zonal.iter().enumerate().map(|(l, g)| g.to_f64() * norm(l)).collect();
    if series.iter().skip(1).all(|&c| c == 0.0) {
        return (T::from_f64(value(&series, 1.0)), T::ONE);
    }
    let roots = roots(derivative(&series));
    let places = [-1.0].into_iter().chain(roots).chain([1.0]).map(|z| (value(&series, z), z));
    // Rust's `min_by` keeps the first of equals.
    let (value, z) = places.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, 1.0));
    (T::from_f64(value), T::from_f64(z))
}

/// `Σ series[l] P_l(z)`, by Clenshaw's sum.
fn value(series: &[f64], z: f64) -> f64 {
    let (mut b1, mut b2) = (0.0, 0.0);
    for (l, c) in series.iter().enumerate().rev() {
        let l = l as f64;
        (b1, b2) = (c + (2.0 * l + 1.0) / (l + 1.0) * z * b1 - (l + 1.0) / (l + 2.0) * b2, b1);
    }
    b1
}

/// The derivative as a sum of Legendre polynomials, divided by its largest coefficient: `P_l′ = (2l−1) P_(l−1) + P_(l−2)′`.
fn derivative(series: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; series.len().saturating_sub(1)];
    for l in (0..out.len()).rev() {
        let above = if l + 2 < out.len() { out[l + 2] / (2 * l + 5) as f64 } else { 0.0 };
        out[l] = (2 * l + 1) as f64 * (series[l + 1] + above);
    }
    let largest = out.iter().map(|c| c.abs()).fold(0.0, f64::max);
    if largest > 0.0 {
        out.iter_mut().for_each(|c| *c /= largest);
    }
    out
}

/// The places in `−1..1` where a sum of Legendre polynomials changes its sign, increasing; and some where it only is zero.
fn roots(series: Vec<f64>) -> Vec<f64> {
    let mut chain = vec![series];
    while let Some(last) = chain.last().filter(|last| last.len() > 1) {
        chain.push(derivative(last));
    }
    // From the constant back to the series: between the turning points there is one root at most.
    chain.iter().rev().fold(Vec::new(), |turning, series| {
        let ends: Vec<f64> = [-1.0].into_iter().chain(turning).chain([1.0]).collect();
        ends.windows(2).filter_map(|pair| root_between(series, [pair[0], pair[1]])).collect()
    })
}

/// The root in an interval where the sum is monotone, by bisection.
fn root_between(series: &[f64], [mut low, mut high]: [f64; 2]) -> Option<f64> {
    let [at_low, at_high] = [low, high].map(|z| value(series, z));
    if at_low == 0.0 {
        return Some(low);
    }
    if !(at_low < 0.0 && at_high > 0.0 || at_low > 0.0 && at_high < 0.0) {
        return None;
    }
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return Some(middle);
        }
        if (value(series, middle) < 0.0) == (at_low < 0.0) {
            low = middle;
        } else {
            high = middle;
        }
    }
}
