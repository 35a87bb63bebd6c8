//! Rotation matrices for tests, and expansions to turn.
#![allow(dead_code, reason = "not every test needs all of them")]

use proptest::prelude::*;
use sh_core::{Order, dot};

pub(crate) type Matrix = [[f64; 3]; 3];

pub(crate) const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Rodrigues' formula.
pub(crate) fn about([x, y, z]: [f64; 3], angle: f64) -> Matrix {
    let (s, c) = angle.sin_cos();
    // 1 − cos, without cancellation for tiny angles
    let k = 2.0 * (0.5 * angle).sin().powi(2);
    [
        [c + x * x * k, x * y * k - z * s, x * z * k + y * s],
        [y * x * k + z * s, c + y * y * k, y * z * k - x * s],
        [z * x * k - y * s, z * y * k + x * s, c + z * z * k],
    ]
}

pub(crate) fn transform(matrix: Matrix, v: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row.iter().zip(v).map(|(a, b)| a * b).sum())
}

pub(crate) fn transpose(m: Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| m[j][i]))
}

pub(crate) fn product(a: Matrix, b: Matrix) -> Matrix {
    let columns = transpose(b);
    a.map(|row| columns.map(|column| row.iter().zip(column).map(|(a, b)| a * b).sum()))
}

/// `Z(α) Y(β) Z(γ)`
pub(crate) fn zyz([alpha, beta, gamma]: [f64; 3]) -> Matrix {
    let z = |angle| about([0.0, 0.0, 1.0], angle);
    product(product(z(alpha), about([0.0, 1.0, 0.0], beta)), z(gamma))
}

pub(crate) fn negative(m: Matrix) -> Matrix {
    m.map(|row| row.map(|entry| -entry))
}

/// Angles where rotations go wrong: 0, π/2, π, and at 1e-7 to 1e-1 from them.
pub(crate) fn critical_angles() -> Vec<f64> {
    use std::f64::consts::{FRAC_PI_2, PI};
    let mut angles = vec![0.0, 1e-15, FRAC_PI_2, PI - 1e-15, PI, 0.6, 2.3];
    for exponent in 1..=7 {
        let small = 10_f64.powi(-exponent);
        angles.extend([small, 3.0 * small, FRAC_PI_2 - small, FRAC_PI_2 + small, PI - small, PI - 3.0 * small]);
    }
    angles
}

pub(crate) fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// An expansion of order 1 to `largest`, of unit length.
pub(crate) fn expansion(largest: usize) -> impl Strategy<Value = (Order, Vec<f64>)> {
    (1..=largest).prop_flat_map(|n| {
        let coeffs = prop::collection::vec(-1.0..1.0_f64, n * n).prop_map(|f| {
            let length = dot(&f, &f).sqrt().max(1e-6);
            f.into_iter().map(|f| f / length).collect()
        });
        (Just(Order::new(n).expect("orders of tests are valid")), coeffs)
    })
}
