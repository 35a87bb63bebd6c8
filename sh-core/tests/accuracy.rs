//! Evaluation against a long reference: the accuracy that the documentation of `eval` states.
//!
//! For comparison, the plain recurrence `p_l = α z p_l−1 − β p_l−2` in place of the differences: 6e-12 in `f64` at n = 512
//! and 5e-5 in `f32` at n = 65, both near the poles, where neighbouring bands nearly cancel.
//!
//! The largest absolute error that these tests print, and that of PyPI sphericart 2.0.4, whose prefactors underflow from
//! degree 19 in `f32` and 88 in `f64` on (`references/sphericart_errors.py`; its truth is SciPy, good to 1e-13 or so):
//!
//! | n | `f32` | sphericart `f32` | `f64` | sphericart `f64` |
//! |---|---|---|---|---|
//! | 6 | 1.9e-7 | 7.8e-7 | 4.4e-16 | |
//! | 10 | 7.2e-7 | 9.2e-7 | 1.4e-15 | |
//! | 20 | 5.5e-7 | 2.4e-2 | 1.1e-15 | |
//! | 65 | 1.5e-6 | NaN | 4.4e-15 | 7.7e-14 |
//! | 89 | 2.0e-6 | NaN | 5.7e-15 | 3.3e-6 |
//! | 128 | 2.8e-6 | NaN | 7.5e-15 | 1.4 |
//! | 501 | 4.8e-7 | NaN | 3.2e-14 | |
//!
//! (From n = 129 on `f32` is evaluated in `f64` and rounded.)
#![cfg(feature = "alloc")]
#![expect(clippy::unwrap_used, clippy::print_stdout, reason = "tests")]

mod long;

use sh_core::{Basis, Order, Real, eval, fibonacci, reconstruct};

/// Distances from the pole at which recurrences are at their worst, from nothing to the equator.
const THETAS: [f64; 14] =
    [0.0, 1e-300, 1e-20, 1e-12, 1e-8, 1e-6, 1e-4, 1e-3, 3e-3, 1e-2, 0.1, 0.5, 1.0, std::f64::consts::FRAC_PI_2];

/// Directions near both poles, on the axes, and spread evenly.
fn directions(phis: &[f64]) -> Vec<[f64; 3]> {
    let mut directions = fibonacci(20);
    for (theta, &phi) in THETAS.iter().flat_map(|theta| phis.iter().map(move |phi| (theta, phi))) {
        let [x, y, z] = [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()];
        directions.extend([[x, y, z], [x, y, -z]]);
    }
    directions.extend([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, -0.0], [0.0, -1.0, 0.0]]);
    directions
}

/// The largest difference from the reference, over all functions and directions.
fn worst<T: Real>(n: usize, phis: &[f64], mut eval: impl FnMut([T; 3], &mut [T])) -> f64 {
    let mut y = vec![T::ZERO; n * n];
    let error = |direction: [f64; 3]| {
        let direction = direction.map(T::from_f64);
        eval(direction, &mut y);
        let reference = long::basis(n, direction.map(T::to_f64));
        y.iter().zip(reference).map(|(y, r)| (y.to_f64() - r).abs()).fold(0.0, nan_max)
    };
    directions(phis).into_iter().map(error).fold(0.0, nan_max)
}

/// The larger one; NaN if either is.
fn nan_max(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

#[track_caller]
fn assert_at_most(what: &str, error: f64, limit: f64) {
    println!("{what}: {error:.1e}, allowed {limit:.0e}");
    assert!(error <= limit, "{what} is wrong by {error:e}, allowed {limit:e}");
}

#[test]
fn small_orders_are_right_to_rounding() {
    let phis = [0.0, 0.3, 0.8, 2.0, 4.0, 5.5];
    for n in 1..=10 {
        let order = Order::new(n).unwrap();
        let error32 = worst::<f32>(n, &phis, |direction, y| eval(order, direction, y));
        assert_at_most(&format!("f32, n = {n}"), error32, if n <= 6 { 4e-7 } else { 8e-7 });
        let error64 = worst::<f64>(n, &phis, |direction, y| eval(order, direction, y));
        assert_at_most(&format!("f64, n = {n}"), error64, if n <= 6 { 1e-15 } else { 2e-15 });
    }
}

#[test]
fn f32_is_right_to_order_65_and_beyond() {
    for (n, limit) in
        [(11, 2e-6), (20, 2e-6), (32, 2e-6), (65, 4e-6), (89, 5e-6), (128, 6e-6), (129, 5e-7), (501, 5e-7)]
    {
        // From order 129 on the recurrence runs in f64: what is left is the rounding of the values, up to 9.
        let basis = Basis::<f32>::new(Order::new(n).unwrap());
        let error = worst::<f32>(n, &[0.0, 0.3, 4.0], |direction, y| basis.eval(direction, y));
        assert_at_most(&format!("f32, n = {n}"), error, limit);
    }
}

#[test]
fn f64_is_right_to_the_largest_order() {
    // The distance from the pole is known to half a unit in the last place, 5e-17, and moves a function of band 500 by 500
    // times that. Without the correction for the length of the direction, which enters as its m-th power: 8e-14.
    for (n, limit) in [(20, 3e-15), (65, 8e-15), (89, 1e-14), (128, 2e-14), (501, 5e-14), (Order::MAX, 5e-14)] {
        let basis = Basis::<f64>::new(Order::new(n).unwrap());
        let error = worst::<f64>(n, &[0.3, 2.0], |direction, y| basis.eval(direction, y));
        assert_at_most(&format!("f64, n = {n}"), error, limit);
    }
}

#[test]
fn reconstruction_is_the_dot_product_with_the_basis() {
    for n in [1, 2, 6, 10, 11, 40, 150] {
        let order = Order::new(n).unwrap();
        let coeffs: Vec<f64> = (0..n * n).map(|i| (i as f64 * 0.37).sin() / n as f64).collect();
        let coeffs32: Vec<f32> = coeffs.iter().map(|&c| c as f32).collect();
        for direction in fibonacci(10) {
            let expected: f64 = long::basis(n, direction).iter().zip(&coeffs).map(|(y, c)| y * c).sum();
            // Sums of n² terms of at most 3/n: n² roundings of terms of that size, and of the direction.
            let value = reconstruct(order, &coeffs, direction);
            assert!((value - expected).abs() < 1e-14 * n as f64, "{n}: {value} {expected}");
            let value = reconstruct(order, &coeffs32, direction.map(|d| d as f32));
            assert!((f64::from(value) - expected).abs() < 3e-6 * n as f64, "{n}: {value} {expected}");
        }
    }
}

#[test]
fn addition_theorem_holds_to_the_largest_order() {
    // Σ_m y_lm(a) y_lm(b) = (2l+1)/(4π) P_l(a·b), at the poles, on the axes, between near and far neighbours.
    let n = Order::MAX;
    let basis = Basis::<f64>::new(Order::new(n).unwrap());
    let directions = [
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
        [1.0, 0.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.6, 0.0, 0.8],
        [-0.48, 0.6, -0.64],
        [1e-9, 0.0, 1.0],
        [3e-3, 4e-3, -(1.0_f64 - 25e-6).sqrt()],
    ];
    let values = directions.map(|direction| {
        let mut y = vec![0.0; n * n];
        basis.eval(direction, &mut y);
        y
    });
    for (y_a, a) in values.iter().zip(directions) {
        for (y_b, b) in values.iter().zip(directions) {
            for (l, p) in long::legendre(n, a, b).into_iter().enumerate() {
                let band = l * l..(l + 1) * (l + 1);
                let sum: f64 = y_a[band.clone()].iter().zip(&y_b[band]).map(|(a, b)| a * b).sum();
                let expected = (2 * l + 1) as f64 / (4.0 * std::f64::consts::PI) * p;
                // The error of one value, 5e-14, times the sum of the other's, at most √(2l+1) · √((2l+1)/4π), twice.
                let tolerance = 1e-15 + 1e-13 * ((2 * l + 1) as f64 / 3.5);
                assert!((sum - expected).abs() < tolerance, "l = {l}, {a:?} {b:?}: {sum} {expected}");
            }
        }
    }
}
