//! Products: accuracy, and what they must agree with.
#![cfg(feature = "alloc")]
#![expect(clippy::unwrap_used, clippy::print_stdout, reason = "tests")]

mod exact;

use proptest::prelude::*;
use sh_core::{
    Order, ProductMatrix, ProductTransform, Quadrature, Real, ShRotation, TripleTensor, dot, product, product_many,
    product_matrix, project_function, reconstruct, square, triple_product,
};

fn order(n: usize) -> Order {
    Order::new(n).unwrap()
}

/// A vector of unit length; another one for every seed.
fn unit(n: usize, seed: usize) -> Vec<f64> {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(seed as u64 + 1) | 1;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let f: Vec<f64> = (0..n * n).map(|_| next()).collect();
    let length = dot(&f, &f).sqrt();
    f.into_iter().map(|f| f / length).collect()
}

/// The inputs of a test: random ones, single basis functions, and all the same.
fn inputs(n: usize) -> Vec<Vec<f64>> {
    let mut inputs: Vec<Vec<f64>> = (0..12).map(|seed| unit(n, seed)).collect();
    for i in [0, n * n / 2, n * n - 1] {
        let mut y = vec![0.0; n * n];
        y[i] = 1.0;
        inputs.push(y);
    }
    inputs.push(vec![1.0 / n as f64; n * n]);
    inputs
}

/// The same numbers in `T`, and those numbers in `f64`.
fn rounded<T: Real>(f: &[f64]) -> (Vec<T>, Vec<f64>) {
    let rounded: Vec<T> = f.iter().map(|&f| T::from_f64(f)).collect();
    let exact = rounded.iter().map(|f| f.to_f64()).collect();
    (rounded, exact)
}

fn difference<T: Real>(a: &[T], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a.to_f64() - b).abs())
        .fold(0.0, |worst, d| if d > worst || d.is_nan() { d } else { worst })
}

#[track_caller]
fn assert_at_most(what: &str, error: f64, limit: f64) {
    println!("{what}: {error:.1e}, allowed {limit:.0e}");
    assert!(error <= limit, "{what} is wrong by {error:e}, allowed {limit:e}");
}

/// All coefficients of an order from whole numbers.
fn exact_entries(n: usize) -> Vec<([usize; 3], f64)> {
    let triples = (0..n * n).flat_map(|i| (0..n * n).flat_map(move |j| (0..n * n).map(move |k| [i, j, k])));
    triples.map(|[i, j, k]| ([i, j, k], exact::gaunt(i, j, k))).filter(|(_, g)| *g != 0.0).collect()
}

/// Worst errors of the product, the square, the matrix, and the triple product.
fn small_errors<T: Real>(n: usize, entries: &[([usize; 3], f64)]) -> [f64; 4] {
    let count = n * n;
    let mut worst = [0.0_f64; 4];
    let mut note = |which: usize, error: f64| {
        worst[which] = if error > worst[which] || error.is_nan() { error } else { worst[which] }
    };
    let plain = |a: &[f64], b: &[f64]| {
        let mut out = vec![0.0; count];
        entries.iter().for_each(|&([i, j, k], g)| out[i] += g * a[j] * b[k]);
        out
    };
    let inputs = inputs(n);
    for (at, a) in inputs.iter().enumerate() {
        let (a, a_exact) = rounded::<T>(a);
        let mut out = vec![T::ZERO; count];
        square(order(n), &a, &mut out);
        note(1, difference(&out, &plain(&a_exact, &a_exact)));
        let (mut matrix, mut expected) = (vec![T::ZERO; count * count], vec![0.0; count * count]);
        product_matrix(order(n), &a, &mut matrix);
        entries.iter().for_each(|&([i, j, k], g)| expected[i * count + j] += g * a_exact[k]);
        note(2, difference(&matrix, &expected));
        for b in &inputs[at..] {
            let (b, b_exact) = rounded::<T>(b);
            product(order(n), &a, &b, &mut out);
            let expected = plain(&a_exact, &b_exact);
            note(0, difference(&out, &expected));
            let (c, c_exact) = rounded::<T>(&inputs[(at + 5) % inputs.len()]);
            note(3, (triple_product(order(n), &a, &b, &c).to_f64() - dot(&expected, &c_exact)).abs());
        }
    }
    worst
}

#[test]
fn small_orders_are_right_to_rounding() {
    for n in 1..=6 {
        let entries = exact_entries(n);
        for (which, limits) in small_errors::<f32>(n, &entries).into_iter().zip([2e-7, 2e-7, 2e-7, 4e-7]).enumerate() {
            assert_at_most(&format!("f32, n = {n}, {which}"), limits.0, limits.1);
        }
        for (which, limits) in
            small_errors::<f64>(n, &entries).into_iter().zip([1e-15, 1e-15, 1e-15, 2e-15]).enumerate()
        {
            assert_at_most(&format!("f64, n = {n}, {which}"), limits.0, limits.1);
        }
    }
}

/// The worst error of the transform, against the tensor in `f64`.
fn transform_error<T: Real>(n: usize, tensor: &TripleTensor<f64>) -> f64 {
    let mut transform = ProductTransform::<T>::new(order(n));
    let (mut out, mut expected) = (vec![T::ZERO; n * n], vec![0.0; n * n]);
    let inputs = inputs(n);
    let mut worst = 0.0_f64;
    for (a, b) in inputs.iter().zip(inputs.iter().rev().chain(&inputs[3..])) {
        let ((a, a_exact), (b, b_exact)) = (rounded::<T>(a), rounded::<T>(b));
        transform.product(&a, &b, &mut out);
        tensor.product(&a_exact, &b_exact, &mut expected);
        let error = difference(&out, &expected);
        worst = if error > worst || error.is_nan() { error } else { worst };
    }
    worst
}

#[test]
fn the_transform_is_right_to_rounding() {
    for n in [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 16, 17, 24] {
        let tensor = TripleTensor::new(order(n));
        assert_at_most(&format!("f32, n = {n}"), transform_error::<f32>(n, &tensor), 1e-7);
        assert_at_most(&format!("f64, n = {n}"), transform_error::<f64>(n, &tensor), 1e-15);
    }
}

/// Multiplying values and projecting them with a rule that is exact for the degree.
fn brute_force(n: [usize; 3], a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; n[2] * n[2]];
    let value = |direction| reconstruct(order(n[0]), a, direction) * reconstruct(order(n[1]), b, direction);
    project_function(order(n[2]), &Quadrature::new(n.iter().sum::<usize>() - 3), value, &mut out);
    out
}

#[test]
fn products_are_values_multiplied_and_projected() {
    for n in [1, 2, 3, 4, 5, 6, 7, 10, 32] {
        let (a, b) = (unit(n, 7), unit(n, 8));
        let mut out = vec![0.0; n * n];
        product(order(n), &a, &b, &mut out);
        assert_at_most(&format!("n = {n}"), difference(&out, &brute_force([n; 3], &a, &b)), 4e-15);
    }
    for orders in [[1, 5, 5], [4, 4, 7], [3, 6, 8], [6, 3, 8], [5, 2, 3], [2, 2, 9], [12, 7, 18], [9, 9, 1], [3, 3, 4]]
    {
        let [n_a, n_b, n] = orders;
        let (a, b) = (unit(n_a, 1), unit(n_b, 2));
        let mut transform = ProductTransform::<f64>::with_orders(order(n_a), order(n_b), order(n));
        let mut out = vec![f64::NAN; n * n];
        transform.product(&a, &b, &mut out);
        assert_eq!(transform.orders(), orders.map(order));
        assert_at_most(&format!("{orders:?}"), difference(&out, &brute_force(orders, &a, &b)), 4e-15);
    }
}

#[test]
fn the_matrix_is_symmetric_and_applies_the_product() {
    for n in [1, 2, 3, 4, 5, 6, 7, 9] {
        let count = n * n;
        let a: Vec<f32> = rounded(&unit(n, 4)).0;
        let b: Vec<f32> = (0..5).flat_map(|seed| rounded::<f32>(&unit(n, seed)).0).collect();
        let matrix = ProductMatrix::new(order(n), &a);
        assert_eq!(matrix.order(), order(n));
        let mut plain = vec![0.0; count * count];
        product_matrix(order(n), &a, &mut plain);
        for (i, j) in (0..count).flat_map(|i| (0..count).map(move |j| (i, j))) {
            assert_eq!(plain[i * count + j], plain[j * count + i], "n = {n}, {i} {j}");
            assert_eq!(matrix.entry(i, j), plain[i * count + j]);
        }
        let (mut applied, mut multiplied) = (vec![0.0; 5 * count], vec![0.0; 5 * count]);
        matrix.apply_many(&b, &mut applied);
        product_many(order(n), &a.repeat(5), &b, &mut multiplied);
        for d in 0..5 {
            let (range, mut one) = (d * count..(d + 1) * count, vec![0.0; count]);
            product(order(n), &a, &b[range.clone()], &mut one);
            assert_eq!(multiplied[range.clone()], one);
            let expected: Vec<f64> = one.iter().map(|&f| f64::from(f)).collect();
            assert_at_most(&format!("matrix, n = {n}"), difference(&applied[range.clone()], &expected), 6e-7);
            matrix.apply(&b[range.clone()], &mut one);
            assert_eq!(applied[range], one);
        }
        // The tensor's matrix is the same.
        let mut by_tensor = vec![0.0; count * count];
        TripleTensor::<f64>::new(order(n)).product_matrix(&unit(n, 4), &mut by_tensor);
        assert_at_most(&format!("tensor, n = {n}"), difference(&plain, &by_tensor), 3e-7);
    }
}

/// As many as fill some registers, and some more.
fn batch_error<T: Real>(n: usize) -> f64 {
    let count = n * n;
    let [a, b]: [Vec<T>; 2] = [0, 1].map(|k| (0..37).flat_map(|d| rounded::<T>(&unit(n, 2 * d + k)).0).collect());
    let mut out = vec![T::from_f64(f64::NAN); 37 * count];
    product_many(order(n), &a, &b, &mut out);
    let exact: Vec<[f64; 3]> = a.iter().zip(&b).zip(&out).map(|((a, b), o)| [a, b, o].map(|x| x.to_f64())).collect();
    let errors = exact.chunks_exact(count).map(|vectors| {
        let [a, b, out]: [Vec<f64>; 3] = [0, 1, 2].map(|which| vectors.iter().map(|v| v[which]).collect());
        difference(&out, &multiplied(n, &a, &b))
    });
    errors.fold(0.0, |worst, e| if e > worst || e.is_nan() { e } else { worst })
}

#[test]
fn batches_are_single_products() {
    for n in 1..=7 {
        assert_at_most(&format!("f32, n = {n}"), batch_error::<f32>(n), 2e-7);
        assert_at_most(&format!("f64, n = {n}"), batch_error::<f64>(n), 1e-15);
    }
}

#[test]
fn extremes_have_an_answer() {
    for n in [1, 2, 3, 4, 6, 7, 12] {
        let (zero, huge) = (vec![0.0_f32; n * n], vec![1e17_f32; n * n]);
        let mut out = vec![f32::NAN; n * n];
        product(order(n), &zero, &huge, &mut out);
        assert!(out.iter().all(|&f| f == 0.0), "n = {n}");
        product(order(n), &huge, &huge, &mut out);
        assert!(out.iter().all(|f| f.is_finite()), "n = {n}");
        // A factor that is not finite shows: nothing is silently dropped.
        let mut broken = vec![0.1_f32; n * n];
        broken[n * n - 1] = f32::NAN;
        product(order(n), &broken, &huge, &mut out);
        assert!(out.iter().any(|f| f.is_nan()), "n = {n}");
    }
    product_many::<f32>(order(4), &[], &[], &mut []);
}

#[test]
#[should_panic(expected = "b has 15 elements, it needs 16")]
fn wrong_lengths_are_refused() {
    product(order(4), &[0.0_f32; 16], &[0.0; 15], &mut [0.0; 16]);
}

fn coeffs(n: usize) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(-1.0..1.0_f64, n * n)
}

/// The rotation that a quaternion stands for.
fn rotation([w, x, y, z]: [f64; 4]) -> [[f64; 3]; 3] {
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}

fn multiplied(n: usize, a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; n * n];
    product(order(n), a, b, &mut out);
    out
}

/// Nothing is cut off.
fn whole(n_a: usize, a: &[f64], n_b: usize, b: &[f64]) -> Vec<f64> {
    let n = n_a + n_b - 1;
    let mut out = vec![0.0; n * n];
    ProductTransform::with_orders(order(n_a), order(n_b), order(n)).product(a, b, &mut out);
    out
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    // Vectors of up to 81 numbers of size 1: lengths up to 9, products of sizes up to 30. Tolerances are 1e-13 for those.

    #[test]
    fn products_commute_and_are_bilinear(n in 1..10_usize, a in coeffs(9), b in coeffs(9), c in coeffs(9), s in -2.0..2.0_f64) {
        let [a, b, c] = [&a[..n * n], &b[..n * n], &c[..n * n]];
        let (ab, ba) = (multiplied(n, a, b), multiplied(n, b, a));
        prop_assert!(difference(&ab, &ba) < 1e-13);
        let sum: Vec<f64> = b.iter().zip(c).map(|(b, c)| b + s * c).collect();
        let parts: Vec<f64> = ab.iter().zip(multiplied(n, a, c)).map(|(ab, ac)| ab + s * ac).collect();
        prop_assert!(difference(&multiplied(n, a, &sum), &parts) < 1e-13);
        let mut squared = vec![0.0; n * n];
        square(order(n), a, &mut squared);
        prop_assert!(difference(&squared, &multiplied(n, a, a)) < 1e-13);
    }

    #[test]
    fn one_is_neutral(n in 1..20_usize, a in coeffs(19)) {
        let a = &a[..n * n];
        let mut one = vec![0.0; n * n];
        one[0] = (4.0 * std::f64::consts::PI).sqrt();
        prop_assert!(difference(&multiplied(n, &one, a), a) < 2e-14);
    }

    #[test]
    fn products_commute_with_rotation(n in 1..9_usize, a in coeffs(8), b in coeffs(8), q in prop::array::uniform4(-1.0..1.0_f64)) {
        let length = dot(&q, &q).sqrt();
        prop_assume!(length > 0.1);
        let turn = ShRotation::new(order(n), rotation(q.map(|q| q / length)));
        let rotated = |f: &[f64]| {
            let mut out = vec![0.0; n * n];
            turn.apply(f, &mut out);
            out
        };
        let [a, b] = [&a[..n * n], &b[..n * n]];
        prop_assert!(difference(&rotated(&multiplied(n, a, b)), &multiplied(n, &rotated(a), &rotated(b))) < 1e-13);
    }

    /// Truncated products are not associative; whole ones are.
    #[test]
    fn whole_products_are_associative(a in coeffs(3), b in coeffs(5), c in coeffs(4)) {
        let left = whole(7, &whole(3, &a, 5, &b), 4, &c);
        let right = whole(3, &a, 8, &whole(5, &b, 4, &c));
        prop_assert!(difference(&left, &right) < 1e-13);
    }

    #[test]
    fn triple_products_are_symmetric(n in 1..9_usize, a in coeffs(8), b in coeffs(8), c in coeffs(8)) {
        let [a, b, c] = [&a[..n * n], &b[..n * n], &c[..n * n]];
        let value = triple_product(order(n), a, b, c);
        for [a, b, c] in [[a, c, b], [b, a, c], [b, c, a], [c, a, b], [c, b, a]] {
            // Sizes up to 8 · 30.
            prop_assert!((triple_product(order(n), a, b, c) - value).abs() < 1e-12);
        }
    }

    /// The value of a whole product is the product of the values.
    #[test]
    fn whole_products_have_the_values(a in coeffs(4), b in coeffs(6), z in -1.0..=1.0_f64, phi in 0.0..6.3_f64) {
        let radius = ((1.0 - z) * (1.0 + z)).sqrt();
        let direction = [radius * phi.cos(), radius * phi.sin(), z];
        let values = reconstruct(order(4), &a, direction) * reconstruct(order(6), &b, direction);
        prop_assert!((reconstruct(order(9), &whole(4, &a, 6, &b), direction) - values).abs() < 1e-12);
    }
}
