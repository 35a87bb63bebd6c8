//! Rotations: they commute with evaluation, keep lengths, compose, and are right at the angles where rotations go wrong.
#![cfg(feature = "alloc")]
#![expect(clippy::unwrap_used, reason = "tests")]

mod matrices;

use std::f64::consts::{FRAC_PI_2, PI};

use matrices::{IDENTITY, Matrix, about, expansion, largest_difference, product, transform, transpose};
use proptest::prelude::*;
use sh_core::{Order, ShRotation, dot, eval, expand_zonal, fibonacci, reconstruct};

fn rotated(order: Order, matrix: Matrix, coeffs: &[f64]) -> Vec<f64> {
    let mut out = vec![f64::NAN; coeffs.len()];
    ShRotation::new(order, matrix).apply(coeffs, &mut out);
    out
}

/// Rotations of every kind that has been trouble somewhere.
fn special_rotations() -> Vec<Matrix> {
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.36, 0.48, 0.8], [0.6, -0.8, 0.0]];
    let angles = [0.0, 1e-15, 1e-7, 1e-4, 1e-2, 1.0, FRAC_PI_2, PI - 1e-2, PI - 1e-7, PI, -FRAC_PI_2, 3.0];
    axes.iter().flat_map(|&axis| angles.map(|angle| about(axis, angle))).collect()
}

/// The basis at `d` is what a delta function there expands to; rotated, it must be the basis at `R d`.
fn worst_error(order: Order, matrix: Matrix) -> f64 {
    let rotation = ShRotation::new(order, matrix);
    let count = order.coeff_count();
    let (mut at_d, mut at_rd, mut out) = (vec![0.0; count], vec![0.0; count], vec![0.0; count]);
    let mut worst = 0.0_f64;
    for d in fibonacci(5) {
        eval(order, d, &mut at_d);
        eval(order, transform(matrix, d), &mut at_rd);
        rotation.apply(&at_d, &mut out);
        worst = at_rd.iter().zip(&out).map(|(a, b)| (a - b).abs()).fold(worst, f64::max);
    }
    worst
}

#[test]
fn rotation_commutes_with_evaluation_at_every_special_angle() {
    // n = 17 and 18 lie on both sides of the change from one recurrence to the other.
    for (n, limit) in [
        (1, 1e-15),
        (2, 1e-15),
        (3, 2e-15),
        (6, 4e-15),
        (10, 8e-15),
        (17, 2e-14),
        (18, 2e-14),
        (32, 2e-14),
        (64, 4e-14),
    ] {
        let order = Order::new(n).unwrap();
        for matrix in special_rotations() {
            let error = worst_error(order, matrix);
            assert!(error <= limit, "n = {n}, {matrix:?}: {error:e}");
        }
    }
}

#[test]
fn rotation_is_stable_at_order_200() {
    // The recurrence of [IR96] alone has lost every digit here. What is left is mostly that of the direction R d.
    let error = worst_error(Order::new(200).unwrap(), about([0.36, 0.48, 0.8], 1.234));
    assert!(error < 2e-13, "{error:e}");
}

#[test]
fn band_1_is_the_matrix() {
    let order = Order::new(2).unwrap();
    for matrix in special_rotations() {
        // f(s) = v·s has the coefficients √(4π/3) (−v_y, v_z, −v_x) in band 1, and g(s) = (R v)·s.
        for v in fibonacci(4) {
            let [x, y, z] = transform(matrix, v);
            let out = rotated(order, matrix, &[7.0, -v[1], v[2], -v[0]]);
            for (out, expected) in out.iter().zip([7.0, -y, z, -x]) {
                assert!((out - expected).abs() < 1e-15, "{out} {expected}");
            }
        }
    }
}

#[test]
fn quarter_turns_about_z_permute_each_pair() {
    // y_lm → cos, y_l−m → sin of m(phi − π/2): a feature at +x goes to +y.
    let order = Order::new(3).unwrap();
    let f: Vec<f64> = (1..=9).map(f64::from).collect();
    let out = rotated(order, about([0.0, 0.0, 1.0], FRAC_PI_2), &f);
    let expected = [1.0, 4.0, 3.0, -2.0, -5.0, 8.0, 7.0, -6.0, -9.0];
    for (out, expected) in out.iter().zip(expected) {
        assert!((out - expected).abs() < 1e-14, "{out} {expected}");
    }
}

#[test]
fn mirror_images_are_as_good_as_rotations() {
    let order = Order::new(12).unwrap();
    let mirror = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]];
    let inversion = IDENTITY.map(|row| row.map(|entry: f64| -entry));
    for matrix in [mirror, inversion, product(mirror, about([0.36, 0.48, 0.8], 2.0))] {
        assert!(worst_error(order, matrix) < 1e-14);
    }
}

#[test]
fn f32_loses_nothing_but_its_rounding() {
    // Every entry is right to half a unit of f32; a matrix that is rounded to f32 turns by up to 1e-7, times l in band l.
    for n in [2, 3, 4, 5, 6, 10, 32] {
        let order = Order::new(n).unwrap();
        let f: Vec<f64> = (0..n * n).map(|i| (1.0 + i as f64).sin()).collect();
        let length = dot(&f, &f).sqrt();
        let f: Vec<f64> = f.iter().map(|f| f / length).collect();
        let f32s: Vec<f32> = f.iter().map(|&f| f as f32).collect();
        for matrix in special_rotations() {
            let mut out = vec![f32::NAN; n * n];
            ShRotation::<f32>::new(order, matrix.map(|row| row.map(|r| r as f32))).apply(&f32s, &mut out);
            for (out, expected) in out.iter().zip(rotated(order, matrix, &f)) {
                let limit = if n <= 10 { 2e-7 } else { 4e-7 };
                assert!((f64::from(*out) - expected).abs() < limit, "n = {n}, {matrix:?}: {out} {expected}");
            }
        }
    }
}

#[test]
fn a_rounded_matrix_is_made_orthogonal() {
    let order = Order::new(20).unwrap();
    let rounded = about([0.36, 0.48, 0.8], 1.0).map(|row| row.map(|r| (r * 1e4).round() / 1e4));
    let f: Vec<f64> = (0..order.coeff_count()).map(|i| (1.0 + i as f64).sin()).collect();
    let out = rotated(order, rounded, &f);
    assert!((dot(&out, &out) / dot(&f, &f) - 1.0).abs() < 1e-13);
}

#[test]
fn not_a_number_is_not_hidden() {
    let out = rotated(Order::new(4).unwrap(), [[f64::NAN; 3]; 3], &[1.0; 16]);
    assert_eq!(out[0], 1.0);
    assert!(out[1..].iter().all(|f| f.is_nan()));
}

/// A rotation: anywhere, near the identity, near half a turn, about z.
fn rotation() -> impl Strategy<Value = Matrix> {
    let axis = (-1.0..=1.0_f64, 0.0..2.0 * PI).prop_map(|(z, phi)| {
        let radius = ((1.0 - z) * (1.0 + z)).sqrt();
        [radius * phi.cos(), radius * phi.sin(), z]
    });
    let axis = prop_oneof![3 => axis, 1 => Just([0.0, 0.0, 1.0]), 1 => Just([0.0, 1.0, 0.0])];
    let angle = prop_oneof![3 => -PI..PI, 1 => Just(0.0), 1 => Just(PI), 1 => -1e-6..1e-6, 1 => PI - 1e-6..PI];
    (axis, angle).prop_map(|(axis, angle)| about(axis, angle))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn commutes_with_evaluation((order, f) in expansion(24), matrix in rotation(), axis in rotation()) {
        let s = transform(axis, [0.0, 0.0, 1.0]);
        let g = rotated(order, matrix, &f);
        let there = reconstruct(order, &f, transform(transpose(matrix), s));
        // The slope of a function of unit length and order n is at most n²/√(4π): 160 times the rounding of R⁻¹ s.
        prop_assert!((reconstruct(order, &g, s) - there).abs() < 1e-13);
    }

    #[test]
    fn keeps_dot_products((order, f) in expansion(24), matrix in rotation()) {
        let f2: Vec<f64> = f.iter().rev().copied().collect();
        let (g, g2) = (rotated(order, matrix, &f), rotated(order, matrix, &f2));
        prop_assert!((dot(&g, &g) - dot(&f, &f)).abs() < 1e-13);
        prop_assert!((dot(&g, &g2) - dot(&f, &f2)).abs() < 1e-13);
    }

    #[test]
    fn composes((order, f) in expansion(24), a in rotation(), b in rotation()) {
        let one_by_one = rotated(order, a, &rotated(order, b, &f));
        prop_assert!(largest_difference(&one_by_one, &rotated(order, product(a, b), &f)) < 1e-13);
    }

    #[test]
    fn the_transpose_goes_back((order, f) in expansion(24), matrix in rotation()) {
        let there = rotated(order, matrix, &f);
        prop_assert!(largest_difference(&rotated(order, transpose(matrix), &there), &f) < 1e-13);
    }

    #[test]
    fn turns_the_axis_of_a_lobe(n in 1..=24_usize, matrix in rotation(), axis in rotation()) {
        let order = Order::new(n).unwrap();
        let axis = transform(axis, [0.0, 0.0, 1.0]);
        let zonal = vec![1.0 / n as f64; n];
        let (mut before, mut after) = (vec![0.0; n * n], vec![0.0; n * n]);
        expand_zonal(order, &zonal, axis, &mut before);
        expand_zonal(order, &zonal, transform(matrix, axis), &mut after);
        prop_assert!(largest_difference(&rotated(order, matrix, &before), &after) < 1e-13);
    }
}
