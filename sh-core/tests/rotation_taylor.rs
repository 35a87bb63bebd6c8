//! The approximate rotation of [KKP05]: its matrices, and the errors that they lead to.
#![cfg(feature = "alloc")]
#![expect(clippy::unwrap_used, reason = "tests")]

mod matrices;

use matrices::{about, largest_difference, negative, zyz};
use sh_core::{Order, ShRotation, Taylor, TaylorDegree, Zyz, radiance_cache_angle_limit, taylor_angle_limit};

const DEGREES: [TaylorDegree; 3] = [TaylorDegree::One, TaylorDegree::OneAndHalf, TaylorDegree::Two];
const Y: [f64; 3] = [0.0, 1.0, 0.0];

/// `[n², n²]`, by columns.
fn matrix(count: usize, mut apply: impl FnMut(&[f64], &mut [f64])) -> Vec<Vec<f64>> {
    let column = |i: usize| {
        let (mut unit, mut out) = (vec![0.0; count], vec![f64::NAN; count]);
        unit[i] = 1.0;
        apply(&unit, &mut out);
        out
    };
    (0..count).map(column).collect()
}

fn exact(order: Order, beta: f64) -> Vec<Vec<f64>> {
    let rotation = ShRotation::new(order, about(Y, beta));
    matrix(order.coeff_count(), |f, out| rotation.apply(f, out))
}

fn approximate(order: Order, degree: TaylorDegree, beta: f64) -> Vec<Vec<f64>> {
    let taylor = Taylor::new(order, degree);
    matrix(order.coeff_count(), |f, out| taylor.rotate_y(beta, f, out))
}

/// By one-sided Jacobi rotations: turns pairs of columns until all are perpendicular; their lengths are the singular values.
fn singular_values(mut columns: Vec<Vec<f64>>) -> Vec<f64> {
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    for _ in 0..12 {
        for j in 1..columns.len() {
            let (before, rest) = columns.split_at_mut(j);
            for a in before {
                let b = &mut rest[0];
                let (aa, bb, ab) = (product(a, a), product(b, b), product(a, b));
                let (sin, cos) = (0.5 * (2.0 * ab).atan2(aa - bb)).sin_cos();
                for (a, b) in a.iter_mut().zip(b) {
                    (*a, *b) = (cos * *a + sin * *b, cos * *b - sin * *a);
                }
            }
        }
    }
    columns.iter().map(|column| product(column, column).sqrt()).collect()
}

/// Worst and mean error of unit vectors, as the paper defines them: largest and mean singular value of the difference.
fn errors(n: usize, degree: TaylorDegree, beta: f64) -> [f64; 2] {
    let order = Order::new(n).unwrap();
    let (exact, approximate) = (exact(order, beta), approximate(order, degree, beta));
    let difference = exact.iter().zip(approximate).map(|(a, b)| a.iter().zip(b).map(|(a, b)| a - b).collect());
    let values = singular_values(difference.collect());
    [values.iter().copied().fold(0.0, f64::max), values.iter().sum::<f64>() / (n * n) as f64]
}

#[track_caller]
fn assert_digits(found: f64, printed: f64) {
    assert!((found - printed).abs() <= 0.000_5, "{found} is not {printed}");
}

#[test]
fn errors_are_those_of_the_paper() {
    let beta = 10_f64.to_radians();
    for (degree, worst, mean) in
        [(TaylorDegree::One, 0.240, 0.060), (TaylorDegree::OneAndHalf, 0.123, 0.035), (TaylorDegree::Two, 0.056, 0.010)]
    {
        let [found_worst, found_mean] = errors(5, degree, beta);
        assert_digits(found_worst, worst);
        assert_digits(found_mean, mean);
    }
    for (degree, worst) in DEGREES.into_iter().zip([0.716, 0.427, 0.296]) {
        assert_digits(errors(8, degree, beta)[0], worst);
    }
}

#[test]
fn worst_errors_of_degrees_1_and_2_have_a_closed_form() {
    // The eigenvalues of D are ±im, and every power of D is normal.
    for (n, beta) in [(3, 0.1), (6, 0.3), (8, 0.05)] {
        let x = (n - 1) as f64 * beta;
        let one = (1.0 - x.cos()).hypot(x - x.sin());
        assert!((errors(n, TaylorDegree::One, beta)[0] - one).abs() < 1e-12);
        let two = (1.0 - x * x / 2.0 - x.cos()).hypot(x - x.sin());
        assert!((errors(n, TaylorDegree::Two, beta)[0] - two).abs() < 1e-12);
    }
}

#[test]
fn derivatives_are_those_of_the_exact_rotation() {
    let order = Order::new(9).unwrap();
    let step = 1e-4;
    let (plus, minus, at_0) = (exact(order, step), exact(order, -step), exact(order, 0.0));
    let (first, second) = (approximate(order, TaylorDegree::One, 1.0), approximate(order, TaylorDegree::Two, 1.0));
    for (i, j) in (0..81).flat_map(|i| (0..81).map(move |j| (i, j))) {
        let derivative = (plus[j][i] - minus[j][i]) / (2.0 * step);
        // A third derivative of up to 8³, times step²/6.
        assert!((first[j][i] - at_0[j][i] - derivative).abs() < 2e-6, "first derivative, {i} {j}");
        let derivative = (plus[j][i] - 2.0 * at_0[j][i] + minus[j][i]) / (step * step);
        // A fourth derivative of up to 8⁴, times step²/12, and rounding.
        assert!((2.0 * (second[j][i] - first[j][i]) - derivative).abs() < 5e-6, "second derivative, {i} {j}");
    }
}

#[test]
fn derivatives_are_sparse() {
    // Figure 2: the first beside the diagonal, the second on it and two beside it; degree 1.5 has the diagonal alone.
    let order = Order::new(8).unwrap();
    let [one, one_and_half, two] = DEGREES.map(|degree| approximate(order, degree, 1.0));
    for (i, j) in (0..64_usize).flat_map(|i| (0..64_usize).map(move |j| (i, j))) {
        let identity = if i == j { 1.0 } else { 0.0 };
        let distance = i.abs_diff(j);
        assert!(distance == 1 || one[j][i] == identity, "first, {i} {j}");
        assert!((one[j][i] - identity) == -(one[i][j] - identity), "antisymmetric, {i} {j}");
        assert!(distance == 0 || one_and_half[j][i] == one[j][i], "diagonal, {i} {j}");
        assert!(distance == 0 || distance == 2 || two[j][i] == one[j][i], "second, {i} {j}");
        assert!(distance != 0 || one_and_half[j][i] == two[j][i], "the same diagonal, {i}");
    }
    // Pairs of neighbours: cosines 0..=l and sines 1..=l.
    let count = (0..64).flat_map(|i| (0..64).map(move |j| (i, j))).filter(|&(i, j)| i != j && one[j][i] != 0.0).count();
    assert_eq!(count, (1..8).map(|l| 2 * (l + l - 1)).sum::<usize>());
    // Band 1: −y, z, −x. z turns towards x.
    assert_eq!((one[2][3], one[3][2], one[1][2]), (-1.0, 1.0, 0.0));
}

#[test]
fn turns_about_z_are_exact() {
    for n in [1, 2, 5, 16, 17, 40, 65] {
        let order = Order::new(n).unwrap();
        let f: Vec<f64> = (0..n * n).map(|i| (1.0 + 1.7 * i as f64).sin()).collect();
        let (mut out, mut y, mut expected) = (vec![f64::NAN; n * n], vec![f64::NAN; n * n], vec![0.0; n * n]);
        for degree in DEGREES {
            let taylor = Taylor::new(order, degree);
            assert_eq!((taylor.order(), taylor.degree()), (order, degree));
            for matrix in [zyz([0.7, 0.0, -2.0]), negative(zyz([0.7, 0.0, 1.0]))] {
                taylor.rotate(&Zyz::from_matrix(matrix), &f, &mut out);
                ShRotation::new(order, matrix).apply(&f, &mut expected);
                assert!(largest_difference(&out, &expected) < 1e-13, "n = {n}");
            }
            // Z(α) Ỹ(β) Z(γ)
            let beta = 0.02;
            taylor.rotate(&Zyz::from_angles([0.7, beta, -2.0]), &f, &mut out);
            ShRotation::about_z(order, -2.0).apply(&f, &mut expected);
            taylor.rotate_y(beta, &expected, &mut y);
            ShRotation::about_z(order, 0.7).apply(&y, &mut expected);
            assert!(largest_difference(&out, &expected) < 1e-13, "n = {n}, {degree:?}");
        }
    }
}

#[test]
fn limits() {
    let order = Order::new(5).unwrap();
    // 2√0.01/4
    assert!((taylor_angle_limit(order, 0.01_f64) - 0.05).abs() < 1e-16);
    assert!(taylor_angle_limit(Order::new(1).unwrap(), 0.01_f64).is_infinite());
    assert_eq!(radiance_cache_angle_limit(0.2_f64), 0.25);
    // The limit is sharp: what it allows is reached to 2 %, at any order.
    for n in [3, 5, 8, 10] {
        for tolerance in [1e-4, 1e-2, 0.1] {
            let limit = taylor_angle_limit(Order::new(n).unwrap(), tolerance);
            let [worst, _] = errors(n, TaylorDegree::OneAndHalf, limit);
            assert!(worst < 1.02 * tolerance, "n = {n}: {worst}");
            assert!(n == 3 || worst > 0.9 * tolerance, "n = {n}: {worst}");
            assert!(errors(n, TaylorDegree::Two, limit)[0] < tolerance);
        }
    }
}
