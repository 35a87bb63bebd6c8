//! Samples to coefficients and back, against plain sums; least squares against its normal equations.
#![cfg(feature = "alloc")]
#![expect(clippy::unwrap_used, reason = "tests")]

use proptest::prelude::*;
use sh_core::{Basis, Error, LeastSquares, Order, Quadrature, Real, eval, fibonacci, reconstruct};

fn order(n: usize) -> Order {
    Order::new(n).unwrap()
}

/// Three channels of some samples, of both signs.
fn samples<T: Real>(count: usize) -> Vec<[T; 3]> {
    let sample = |d: usize, c: usize| T::from_f64((d as f64 * 0.7 + c as f64).sin() + 0.2);
    (0..count).map(|d| [sample(d, 0), sample(d, 1), sample(d, 2)]).collect()
}

/// Projection and reconstruction against plain sums in `f64`; `accuracy` is that of one basis function.
fn check_sums<T: Real>(n: usize, accuracy: f64) {
    let (count, basis) = (n * n, Basis::<T>::new(order(n)));
    for directions_count in [0, 1, 5, 16, 17, 700] {
        let directions: Vec<[T; 3]> = fibonacci(directions_count).into_iter().map(|s| s.map(T::from_f64)).collect();
        let samples = samples::<T>(directions_count);
        let mut coeffs = vec![T::from_f64(f64::NAN); 3 * count];
        basis.project(&directions, &samples, &mut coeffs);
        let mut y = vec![0.0; count];
        let mut expected = vec![0.0; 3 * count];
        for (direction, sample) in directions.iter().zip(&samples) {
            eval(order(n), direction.map(T::to_f64), &mut y);
            for (expected, sample) in expected.chunks_exact_mut(count).zip(sample) {
                expected.iter_mut().zip(&y).for_each(|(sum, y)| *sum += sample.to_f64() * y);
            }
        }
        // Errors of the terms, of at most 1.2 times `accuracy`, add up at worst; values are of size up to √n.
        let rounding = T::EPSILON.to_f64() * directions_count as f64 * (n as f64).sqrt();
        let tolerance = 1.2 * accuracy * directions_count as f64 + rounding;
        for (i, (c, e)) in coeffs.iter().zip(&expected).enumerate() {
            assert!((c.to_f64() - e).abs() <= tolerance, "n = {n}, {i}, {directions_count}: {c} {e}");
        }
        check_values(&basis, &coeffs, &directions, accuracy);
    }
}

fn check_values<T: Real>(basis: &Basis<T>, coeffs: &[T], directions: &[[T; 3]], accuracy: f64) {
    let order = basis.order();
    let mut values = vec![[T::from_f64(f64::NAN); 3]; directions.len()];
    basis.reconstruct(coeffs, directions, &mut values);
    for (&direction, values) in directions.iter().zip(&values) {
        for (coeffs, value) in coeffs.chunks_exact(order.coeff_count()).zip(values) {
            let size: f64 = coeffs.iter().map(|c| c.to_f64().abs()).sum();
            let expected = reconstruct(order, coeffs, direction);
            // Both are wrong by the error of the basis, and round sums of terms of size up to √n.
            let tolerance = size * (2.0 * accuracy + 4.0 * T::EPSILON.to_f64() * order.get() as f64);
            assert!((*value - expected).abs().to_f64() <= tolerance, "{order} {value} {expected}");
        }
    }
}

#[test]
fn sums_over_samples_are_the_plain_ones() {
    for n in [1, 2, 3, 6, 10, 11, 25] {
        check_sums::<f32>(n, if n <= 10 { 8e-7 } else { 3e-6 });
        check_sums::<f64>(n, if n <= 10 { 2e-15 } else { 1e-14 });
    }
    check_sums::<f32>(130, 5e-7);
}

#[test]
fn many_samples_lose_no_digits() {
    // A million samples of f32: a plain f32 sum of them is wrong by 1e-4 or so.
    let count = 1_000_000;
    let directions: Vec<[f32; 3]> = fibonacci(count).into_iter().map(|s| s.map(|s| s as f32)).collect();
    let weight = (4.0 * std::f64::consts::PI / count as f64) as f32;
    let samples: Vec<[f32; 3]> = directions.iter().map(|s| [weight * (1.0 + s[2]); 3]).collect();
    let mut coeffs = [0.0_f32; 12];
    Basis::new(order(2)).project(&directions, &samples, &mut coeffs);
    let expected = [(4.0 * std::f64::consts::PI).sqrt(), 0.0, (4.0 * std::f64::consts::PI / 3.0).sqrt(), 0.0];
    for (c, e) in coeffs.iter().zip(expected.into_iter().cycle()) {
        // The rounding of the weight, and of the result.
        assert!((f64::from(*c) - e).abs() < 4e-7, "{coeffs:?}");
    }
}

#[test]
fn small_samples_beside_a_large_one_count() {
    // What a chunk of blocks adds up to is below the rounding of the large one: sums in f32 alone would leave out those in its
    // lane, 3.75e-5 of it.
    let count = 200_000;
    let directions = vec![[0.0_f32, 0.0, 1.0]; count];
    let mut samples = vec![[3e-9_f32; 3]; count];
    samples[0] = [1.0; 3];
    let mut coeffs = [0.0_f32; 3 * 36];
    Basis::new(order(6)).project(&directions, &samples, &mut coeffs);
    let expected = (1.0 + 3e-9 * (count - 1) as f64) / (4.0 * std::f64::consts::PI).sqrt();
    // The rounding of the result, and some tens of small samples.
    assert!((f64::from(coeffs[0]) / expected - 1.0).abs() < 1e-6, "{coeffs:?} {expected}");
}

#[test]
fn weights_of_a_quadrature_project_exactly() {
    let quadrature = Quadrature::new(10);
    let directions: Vec<[f64; 3]> = quadrature.points().iter().map(|&(s, _)| s).collect();
    let coeffs: Vec<f64> = (0..36).map(|i| (i as f64).cos()).collect();
    let samples: Vec<[f64; 3]> =
        quadrature.points().iter().map(|&(s, w)| [w * reconstruct(order(6), &coeffs, s); 3]).collect();
    let mut back = [0.0; 3 * 36];
    Basis::new(order(6)).project(&directions, &samples, &mut back);
    assert!(back.iter().zip(coeffs.iter().cycle()).all(|(a, b)| (a - b).abs() < 1e-13), "{back:?}");
}

/// Directions at random, with a hole around −z.
fn irregular() -> impl Strategy<Value = Vec<[f64; 3]>> {
    let direction = prop::array::uniform3(-1.0..1.0_f64).prop_filter_map("outside the ball or in the hole", |v| {
        let length = v.iter().map(|v| v * v).sum::<f64>().sqrt();
        let s = v.map(|v| v / length);
        (length > 0.1 && length < 1.0 && s[2] > -0.7).then_some(s)
    });
    prop::collection::vec(direction, 150)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn functions_of_the_order_are_fitted_exactly(
        directions in irregular(), coeffs in prop::collection::vec(-1.0..1.0_f64, 16)
    ) {
        let fit = LeastSquares::new(order(4), &directions, None, 0.0).unwrap();
        let values: Vec<f64> = directions.iter().map(|&s| reconstruct(order(4), &coeffs, s)).collect();
        let mut fitted = [0.0; 16];
        fit.fit(&values, &mut fitted);
        for (f, c) in fitted.iter().zip(&coeffs) {
            // 1e-16 times the condition of the matrix, some thousands with this hole.
            prop_assert!((f - c).abs() < 1e-10, "{f} {c}");
        }
    }

    #[test]
    fn residuals_are_orthogonal_to_the_basis(
        directions in irregular(),
        values in prop::collection::vec(-1.0..1.0_f64, 150),
        weights in prop::collection::vec(0.1..2.0_f64, 150),
    ) {
        // The gradient of what is minimised: Yᵀ W (Y f − v) + smoothing W/(4π) (l(l+1))² f = 0.
        let smoothing = 1e-3;
        let fit = LeastSquares::new(order(3), &directions, Some(&weights), smoothing).unwrap();
        let mut f = [0.0; 9];
        fit.fit(&values, &mut f);
        let residuals: Vec<[f64; 3]> = directions.iter().zip(&values).zip(&weights)
            .map(|((&s, v), w)| [w * (reconstruct(order(3), &f, s) - v); 3]).collect();
        let mut gradient = [0.0; 27];
        Basis::new(order(3)).project(&directions, &residuals, &mut gradient);
        let scale = smoothing * weights.iter().sum::<f64>() / (4.0 * std::f64::consts::PI);
        for (l, band) in order(3).bands() {
            for i in band {
                let laplacian = (l * (l + 1)) as f64;
                prop_assert!((gradient[i] + scale * laplacian * laplacian * f[i]).abs() < 1e-10, "{i}");
            }
        }
    }
}

#[test]
fn too_few_samples_are_refused_or_smoothed() {
    let directions = fibonacci(8);
    let error = LeastSquares::new(order(3), &directions, None, 0.0).unwrap_err();
    assert!(matches!(error, Error::Undetermined { order: 3, samples: 8, index: 1..9 }), "{error:?}");
    assert!(error.to_string().starts_with("8 samples do not determine all 9 coefficients of order 3"), "{error}");
    let error = LeastSquares::new(order(1), &[], None, 0.0).unwrap_err();
    assert_eq!(error, Error::Undetermined { order: 1, samples: 0, index: 0 });
    // On a circle nothing tells z from 0.
    let circle: Vec<[f64; 3]> = (0..50).map(|k| f64::from(k) * 0.1257).map(|a| [a.cos(), a.sin(), 0.0]).collect();
    assert!(LeastSquares::new(order(2), &circle, None, 0.0).is_err());

    let fit = LeastSquares::new(order(3), &directions, None, 1e-6).unwrap();
    let mut f = [0.0_f32; 9];
    fit.fit(&[2.0_f32; 8], &mut f);
    assert!((f[0] - 2.0 * (4.0 * std::f32::consts::PI).sqrt()).abs() < 1e-4, "{f:?}");
    assert!(f[1..].iter().all(|f| f.abs() < 1e-4), "{f:?}");
}

#[test]
fn numbers_that_cannot_be_fitted_are_named() {
    let message = |directions: &[[f64; 3]], weights: &[f64], smoothing| {
        LeastSquares::new(order(1), directions, Some(weights), smoothing).unwrap_err().to_string()
    };
    let s = [0.0, 0.0, 1.0];
    assert_eq!(message(&[s, [0.0, f64::NAN, 1.0]], &[1.0, 1.0], 0.0), "direction 1 of the samples is NaN");
    assert_eq!(message(&[s, s], &[1.0, -2.0], 0.0), "weight 1 of the samples is -2");
    assert_eq!(message(&[s, [0.0; 3]], &[1.0, 1.0], 0.0), "the squared length of direction 1 of the samples is 0");
    assert_eq!(message(&[s; 9], &[1e308; 9], 0.0), "the sum of weights up to 8 of the samples is inf");
    assert_eq!(message(&[s], &[1.0], -1.0), "smoothing -1 is not a finite number from 0");
}
