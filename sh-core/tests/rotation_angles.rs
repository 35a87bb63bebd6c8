//! Rotations by angles: right at every angle, above all where `√(1 − c²)` and `atan2` go wrong, and the same by every way.
//!
//! `cargo test -p sh-core --test rotation_angles -- --nocapture stability` prints the error of `rotate` in `f32` against β.
//! It is even. Implementations that take `sin β = √(1 − cos² β)` lose half their digits near 0 and π; DirectXMath's
//! `XMSHRotate` is known to lose three there.
#![cfg(feature = "alloc")]
#![expect(clippy::unwrap_used, reason = "tests")]
#![expect(clippy::print_stdout, reason = "a comparison that the documentation tells of")]

mod matrices;

use std::f64::consts::{FRAC_PI_2, PI};

use matrices::{
    IDENTITY, Matrix, about, critical_angles, expansion, largest_difference, negative, product, transform, transpose,
    zyz,
};
use proptest::prelude::*;
use sh_core::{
    Order, Real, ShRotation, Zxzxz, Zyz, dot, eval, fibonacci, reconstruct, rotate, rotate_quaternion, rotate_z,
    rotate_zyz,
};

/// Coefficients up to 1.
fn coefficients(count: usize) -> Vec<f64> {
    (0..count).map(|i| (1.0 + 1.7 * i as f64).sin()).collect()
}

fn rotated<T: Real>(order: Order, matrix: Matrix, coeffs: &[f64]) -> Vec<f64> {
    let coeffs: Vec<T> = coeffs.iter().copied().map(T::from_f64).collect();
    let mut out = vec![T::from_f64(f64::NAN); coeffs.len()];
    rotate(order, matrix.map(|row| row.map(T::from_f64)), &coeffs, &mut out);
    out.into_iter().map(T::to_f64).collect()
}

/// By [IR96], in `f64`.
fn by_ivanic(order: Order, matrix: Matrix, coeffs: &[f64]) -> Vec<f64> {
    let mut out = vec![f64::NAN; coeffs.len()];
    ShRotation::new(order, matrix).apply(coeffs, &mut out);
    out
}

/// Critical β, with α and γ of all sorts.
fn sweep() -> impl Iterator<Item = [f64; 3]> {
    let others = [[0.0, 0.0], [0.7, -2.1], [PI, FRAC_PI_2], [-3.0, 3.1], [1e-7, -1e-7]];
    critical_angles().into_iter().flat_map(move |beta| others.map(|[alpha, gamma]| [alpha, beta, gamma]))
}

/// The largest error over [`sweep`], of coefficients up to 1.
fn worst<T: Real>(n: usize) -> f64 {
    let order = Order::new(n).unwrap();
    let coeffs = coefficients(n * n);
    let error = |angles: [f64; 3]| {
        [zyz(angles), negative(zyz(angles))]
            .map(|m| largest_difference(&rotated::<T>(order, m, &coeffs), &by_ivanic(order, m, &coeffs)))
    };
    sweep().flat_map(error).fold(0.0, f64::max)
}

#[test]
fn f32_is_right_at_every_angle() {
    // A matrix that is rounded to f32 alone turns by 1e-7, times l, times the length of the band.
    for (n, limit) in [(1, 6e-8), (2, 6e-7), (3, 1e-6), (4, 1.5e-6), (5, 2e-6), (6, 2e-6), (8, 3e-6), (10, 4e-6)] {
        let error = worst::<f32>(n);
        assert!(error <= limit, "n = {n}: {error:e}");
    }
}

#[test]
fn f64_is_right_at_every_angle() {
    for (n, limit) in [(1, 0.0), (2, 2e-15), (4, 4e-15), (6, 6e-15), (10, 1e-14), (11, 1e-14), (24, 4e-14)] {
        let error = worst::<f64>(n);
        assert!(error <= limit, "n = {n}: {error:e}");
    }
}

#[test]
fn stability() {
    let order = Order::new(6).unwrap();
    let coeffs = coefficients(36);
    println!("β                error of f32, n = 6");
    let mut angles = critical_angles();
    angles.sort_by(f64::total_cmp);
    for beta in angles {
        let errors = sweep().filter(|angles| angles[1] == beta).map(|angles| {
            largest_difference(&rotated::<f32>(order, zyz(angles), &coeffs), &by_ivanic(order, zyz(angles), &coeffs))
        });
        let error = errors.fold(0.0, f64::max);
        println!("{beta:<16.7} {error:.1e}");
        assert!(error < 2e-6, "β = {beta}: {error:e}");
    }
}

#[test]
fn a_matrix_multiplied_in_f32_is_as_good() {
    // Its small entries are noise: 1e-7 where 1e-8 should be. α is meaningless then, and γ has to make up for it.
    let order = Order::new(6).unwrap();
    let coeffs = coefficients(36);
    for [alpha, beta, gamma] in sweep() {
        let [a, b] = [zyz([alpha, 0.0, 1.0]), zyz([-1.0, beta, gamma])].map(|m| m.map(|row| row.map(|r| r as f32)));
        let entry = |i: usize, j: usize| (0..3).map(|k| a[i][k] * b[k][j]).sum::<f32>();
        let noisy: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(entry(i, j))));
        let exact = by_ivanic(order, zyz([alpha, beta, gamma]), &coeffs);
        let error = largest_difference(&rotated::<f32>(order, noisy, &coeffs), &exact);
        assert!(error < 4e-6, "{alpha} {beta} {gamma}: {error:e}");
    }
}

#[test]
fn every_way_gives_the_same() {
    // Straight-line kernels, factors on the way, tables, recurrences over bands: low bands do not depend on the order.
    let coeffs = coefficients(40 * 40);
    for matrix in sweep().map(zyz).chain([negative(zyz([0.3, 1.0, 2.0]))]).step_by(7) {
        let expected = by_ivanic(Order::new(40).unwrap(), matrix, &coeffs);
        for n in (1..=16).chain([31, 32, 33, 40]) {
            let (order, coeffs) = (Order::new(n).unwrap(), &coeffs[..n * n]);
            let mut tabled = vec![f64::NAN; n * n];
            Zxzxz::new(order).rotate(&Zyz::from_matrix(matrix), coeffs, &mut tabled);
            assert!(largest_difference(&tabled, &expected[..n * n]) < 1e-13, "tables, n = {n}");
            let mut by_angles = vec![f64::NAN; n * n];
            rotate_zyz(order, &Zyz::from_matrix(matrix), coeffs, &mut by_angles);
            assert!(largest_difference(&by_angles, &expected[..n * n]) < 1e-13, "angles, n = {n}");
            let other = rotated::<f64>(order, matrix, coeffs);
            assert!(largest_difference(&other, &expected[..n * n]) < 1e-13, "n = {n}");
        }
    }
}

/// The basis at `d` is what a delta function there expands to; rotated, it must be the basis at `R d`.
fn error_of_basis(order: Order, matrix: Matrix, rotate: impl Fn(&[f64], &mut [f64])) -> f64 {
    let count = order.coeff_count();
    let (mut at_d, mut at_rd, mut out) = (vec![0.0; count], vec![0.0; count], vec![0.0; count]);
    let error = |d| {
        eval(order, d, &mut at_d);
        eval(order, transform(matrix, d), &mut at_rd);
        rotate(&at_d, &mut out);
        largest_difference(&at_rd, &out)
    };
    fibonacci(3).into_iter().map(error).fold(0.0, f64::max)
}

#[test]
fn tables_are_stable_at_high_orders() {
    for (n, limit) in [(64, 3e-14), (130, 1e-13), (256, 2e-13)] {
        let order = Order::new(n).unwrap();
        let tables = Zxzxz::new(order);
        for angles in [[0.3, 1.1, -2.0], [2.0, 1e-7, 1.0], [0.4, PI - 1e-4, 0.1]] {
            let rotate = |f: &[f64], out: &mut [f64]| tables.rotate(&Zyz::from_matrix(zyz(angles)), f, out);
            let error = error_of_basis(order, zyz(angles), rotate);
            println!("n = {n}: {error:e}");
            assert!(error < limit, "n = {n}, {angles:?}: {error:e}");
        }
    }
}

#[test]
fn factors_are_stable_up_to_the_largest_order() {
    let order = Order::new(Order::MAX).unwrap();
    let matrix = zyz([0.3, 1.1, -2.0]);
    let error = error_of_basis(order, matrix, |f, out| rotate(order, matrix, f, out));
    println!("n = 512: {error:e}");
    assert!(error < 2e-13, "{error:e}");
}

#[test]
fn f32_tables() {
    let order = Order::new(50).unwrap();
    let coeffs = coefficients(2500);
    let narrow: Vec<f32> = coeffs.iter().map(|&f| f as f32).collect();
    let mut out = vec![0.0_f32; 2500];
    let zyz32 = Zyz::from_angles([0.3_f32, 1.1, -2.0]);
    Zxzxz::<f32>::new(order).rotate(&zyz32, &narrow, &mut out);
    let expected = by_ivanic(order, zyz32.matrix().map(|row| row.map(f64::from)), &coeffs);
    let out: Vec<f64> = out.into_iter().map(f64::from).collect();
    // l times the rounding of a cosine, for coefficients up to 1.
    assert!(largest_difference(&out, &expected) < 3e-5);
}

#[test]
fn mirror_images() {
    for n in [3, 6, 12] {
        let order = Order::new(n).unwrap();
        let f = coefficients(n * n);
        // A mirror in y changes the sign of the sines.
        let mirror = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]];
        let out = rotated::<f64>(order, mirror, &f);
        for (l, band) in order.bands() {
            for (i, (out, f)) in out[band.clone()].iter().zip(&f[band]).enumerate() {
                assert!((out - if i < l { -f } else { *f }).abs() < 1e-15, "{l} {i}");
            }
        }
        let out = rotated::<f64>(order, negative(IDENTITY), &f);
        for (l, band) in order.bands() {
            let sign = if l % 2 == 0 { 1.0 } else { -1.0 };
            assert!(out[band.clone()].iter().zip(&f[band]).all(|(out, f)| (out - sign * f).abs() < 1e-15));
        }
    }
    assert!(Zyz::from_matrix(negative(IDENTITY)).is_mirror_image());
    assert!(!Zyz::from_matrix(IDENTITY).is_mirror_image());
}

#[test]
fn the_identity_changes_nothing() {
    for n in [1, 2, 5, 10, 11, 20] {
        let f = coefficients(n * n);
        let error = largest_difference(&rotated::<f64>(Order::new(n).unwrap(), IDENTITY, &f), &f);
        assert!(error < 4e-15, "n = {n}: {error:e}");
    }
}

#[test]
fn angles_of_a_matrix_and_back() {
    for [alpha, beta, gamma] in sweep() {
        let matrix = zyz([alpha, beta, gamma]);
        let found = Zyz::from_matrix(matrix);
        let [a, b, g] = found.angles();
        // The angle near 0 has its full relative precision.
        assert!((b - beta).abs() <= 1e-9 * beta.min(1.0) + 4e-16, "{b} {beta}");
        for other in [found.matrix(), zyz([a, b, g]), Zyz::from_angles([a, b, g]).matrix()] {
            assert!(largest_difference(matrix.as_flattened(), other.as_flattened()) < 2e-15, "{alpha} {beta} {gamma}");
        }
        let mirrored = Zyz::from_matrix(negative(matrix));
        assert!(largest_difference(negative(matrix).as_flattened(), mirrored.matrix().as_flattened()) < 2e-15);
    }
    let [alpha, beta, gamma] = Zyz::from_matrix(zyz([0.3, 1.2, -2.0])).angles();
    assert!((alpha - 0.3).abs() < 1e-15 && (beta - 1.2).abs() < 1e-15 && (gamma + 2.0).abs() < 1e-15);
}

#[test]
fn small_angles_keep_their_digits() {
    // cos β is 1 in f32: from it alone, β would be 0.
    let [_, beta, _] = Zyz::from_matrix(zyz([0.5, 1e-5, 0.0]).map(|row| row.map(|r| r as f32))).angles();
    assert!((beta / 1e-5 - 1.0).abs() < 1e-6, "{beta:e}");
}

#[test]
fn quaternions() {
    let order = Order::new(5).unwrap();
    let f = coefficients(25);
    for (axis, angle) in
        [([0.36, 0.48, 0.8], 2.0), ([0.0, 0.0, 1.0], 1.0), ([0.6, -0.8, 0.0], PI), ([0.0, 1.0, 0.0], 1e-7)]
    {
        let (s, c) = (0.5_f64 * angle).sin_cos();
        let expected = by_ivanic(order, about(axis, angle), &f);
        for length in [1.0, -1.0, 3.0] {
            let quaternion = [axis[0] * s, axis[1] * s, axis[2] * s, c].map(|q| length * q);
            let mut out = vec![0.0; 25];
            rotate_quaternion(order, quaternion, &f, &mut out);
            assert!(largest_difference(&out, &expected) < 1e-14);
            ShRotation::from_quaternion(order, quaternion).apply(&f, &mut out);
            assert!(largest_difference(&out, &expected) < 1e-14);
        }
    }
}

#[test]
fn about_z() {
    for n in [1, 2, 7, 30] {
        let order = Order::new(n).unwrap();
        let f = coefficients(n * n);
        for angle in [0.0, 0.3, -2.0, PI, 1e-7] {
            let expected = by_ivanic(order, about([0.0, 0.0, 1.0], angle), &f);
            let mut out = vec![f64::NAN; n * n];
            rotate_z(order, [angle.cos(), angle.sin()], &f, &mut out);
            assert!(largest_difference(&out, &expected) < 4e-16 * n as f64 + 1e-15, "n = {n}, {angle}");
            ShRotation::about_z(order, angle).apply(&f, &mut out);
            assert!(largest_difference(&out, &expected) < 1e-14);
            let narrow: Vec<f32> = f.iter().map(|&f| f as f32).collect();
            let mut out = vec![f32::NAN; n * n];
            rotate_z(order, [angle.cos() as f32, angle.sin() as f32], &narrow, &mut out);
            let out: Vec<f64> = out.into_iter().map(f64::from).collect();
            assert!(largest_difference(&out, &expected) < 2e-7 * n as f64, "n = {n}, {angle}");
        }
    }
}

#[test]
fn rounded_matrices_still_rotate() {
    // Not quite orthogonal: what comes out is a rotation nevertheless, nearly the one that was meant.
    let order = Order::new(6).unwrap();
    let f = coefficients(36);
    let rounded = about([0.36, 0.48, 0.8], 1.0).map(|row| row.map(|r| (r * 1e4).round() / 1e4));
    let out = rotated::<f64>(order, rounded, &f);
    assert!((dot(&out, &out) / dot(&f, &f) - 1.0).abs() < 1e-6);
    assert!(largest_difference(&out, &by_ivanic(order, rounded, &f)) < 5e-3);
}

#[test]
fn odd_matrices_have_an_answer() {
    for n in [1, 2, 3, 4, 10, 11, 20] {
        let order = Order::new(n).unwrap();
        let f = vec![1.0_f32; n * n];
        let mut out = vec![7.0_f32; n * n];
        for bad in [f32::NAN, f32::INFINITY] {
            rotate(order, [[bad; 3]; 3], &f, &mut out);
            assert!(out[0] == 1.0 && out[1..].iter().all(|f| !f.is_finite()), "n = {n}: {out:?}");
        }
        rotate_quaternion(order, [0.0; 4], &f, &mut out);
        assert!(out[0] == 1.0 && out[1..].iter().all(|f| f.is_nan()));
        for finite in [0.0, 1.0, -2.0, 1e-30, 1e9] {
            rotate(order, [[finite; 3]; 3], &f, &mut out);
            assert_eq!(out[0], 1.0);
        }
        rotate(order, [[0.0; 3]; 3], &f, &mut out);
        assert!(out.iter().all(|f| f.is_finite()));
    }
}

#[test]
fn bands_do_not_mix() {
    // A NaN stays in its band.
    for n in [6, 10, 12] {
        let order = Order::new(n).unwrap();
        for (_, band) in order.bands() {
            let mut f = coefficients(n * n);
            f[band.end - 1] = f64::NAN;
            let out = rotated::<f64>(order, zyz([0.1, 0.2, 0.3]), &f);
            assert!(out.iter().enumerate().all(|(i, f)| f.is_finite() || band.contains(&i)), "n = {n} {band:?}");
        }
    }
}

#[test]
#[should_panic(expected = "out has 15 elements, it needs 16")]
fn wrong_lengths_are_named() {
    rotate(Order::new(4).unwrap(), [[0.0_f32; 3]; 3], &[0.0; 16], &mut [0.0; 15]);
}

#[test]
#[should_panic(expected = "coeffs has 17 elements, it needs 16")]
fn wrong_lengths_are_named_by_tables() {
    let order = Order::new(4).unwrap();
    Zxzxz::new(order).rotate(&Zyz::from_angles([0.0_f32; 3]), &[0.0; 17], &mut [0.0; 16]);
}

fn angles() -> impl Strategy<Value = [f64; 3]> {
    let beta = prop_oneof![3 => 0.0..PI, 1 => Just(0.0), 1 => Just(PI), 1 => 0.0..1e-6, 1 => PI - 1e-6..PI];
    (-PI..PI, beta, -PI..PI).prop_map(|(alpha, beta, gamma)| [alpha, beta, gamma])
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn commutes_with_evaluation((order, f) in expansion(14), a in angles(), b in angles()) {
        let (matrix, s) = (zyz(a), transform(zyz(b), [0.0, 0.0, 1.0]));
        let there = reconstruct(order, &f, transform(transpose(matrix), s));
        prop_assert!((reconstruct(order, &rotated::<f64>(order, matrix, &f), s) - there).abs() < 1e-13);
    }

    #[test]
    fn keeps_dot_products_and_energies_of_bands((order, f) in expansion(14), a in angles()) {
        let f2: Vec<f64> = f.iter().rev().copied().collect();
        let (g, g2) = (rotated::<f64>(order, zyz(a), &f), rotated::<f64>(order, zyz(a), &f2));
        for (_, band) in order.bands() {
            let (f, f2, g, g2) = (&f[band.clone()], &f2[band.clone()], &g[band.clone()], &g2[band]);
            prop_assert!((dot(g, g) - dot(f, f)).abs() < 1e-14);
            prop_assert!((dot(g, g2) - dot(f, f2)).abs() < 1e-14);
        }
    }

    #[test]
    fn composes((order, f) in expansion(14), a in angles(), b in angles()) {
        let one_by_one = rotated::<f64>(order, zyz(a), &rotated::<f64>(order, zyz(b), &f));
        prop_assert!(largest_difference(&one_by_one, &rotated::<f64>(order, product(zyz(a), zyz(b)), &f)) < 1e-13);
    }

    #[test]
    fn inverts((order, f) in expansion(14), [alpha, beta, gamma] in angles()) {
        let (mut there, mut back) = (vec![0.0; f.len()], vec![0.0; f.len()]);
        rotate_zyz(order, &Zyz::from_angles([alpha, beta, gamma]), &f, &mut there);
        rotate_zyz(order, &Zyz::from_angles([-gamma, -beta, -alpha]), &there, &mut back);
        prop_assert!(largest_difference(&back, &f) < 1e-14);
    }
}

#[test]
fn quaternions_of_every_length_turn_alike() {
    let coeffs: [f32; 16] = std::array::from_fn(|i| (i as f32).cos());
    let mut expected = [0.0; 16];
    rotate_quaternion(Order::new(4).unwrap(), [0.1, -0.7, 0.3, 0.64], &coeffs, &mut expected);
    for length in [1e-30_f32, 1e-20, 7.0, 1e20, 1e37] {
        let mut out = [0.0; 16];
        rotate_quaternion(Order::new(4).unwrap(), [0.1, -0.7, 0.3, 0.64].map(|q| q * length), &coeffs, &mut out);
        // The components are rounded once more.
        assert!(out.iter().zip(expected).all(|(a, b)| (a - b).abs() < 2e-6), "{length}");
    }
}
