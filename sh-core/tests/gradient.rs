//! Gradients and Hessians against a long reference, at the poles and elsewhere; batches against one direction at a time.
#![cfg(feature = "alloc")]
#![expect(clippy::unwrap_used, clippy::print_stdout, reason = "tests")]

mod long;

use sh_core::{BLOCK, Basis, BasisGradient, Order, Real, eval, eval_gradient, eval_hessian, fibonacci};

fn directions() -> Vec<[f64; 3]> {
    let mut directions = fibonacci(12);
    directions.extend([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.6, 0.0, -0.8]]);
    directions.extend([1e-12_f64, 1e-6, 1e-3, 0.05].map(|t| [0.6 * t.sin(), -0.8 * t.sin(), t.cos()]));
    directions
}

/// The largest difference, NaN if there is one.
fn worst<T: Real>(values: &[T], reference: &[f64]) -> f64 {
    let larger = |a: f64, b: f64| if a > b || a.is_nan() { a } else { b };
    values.iter().zip(reference).map(|(value, r)| (value.to_f64() - r).abs()).fold(0.0, larger)
}

/// The worst errors of gradients and Hessians of order `n`.
fn errors<T: Real>(n: usize, mut eval: impl FnMut([T; 3], &mut [T], &mut [T], &mut [T])) -> [f64; 2] {
    let (mut y, mut gradient, mut hessian) = (vec![T::ZERO; n * n], vec![T::ZERO; 3 * n * n], vec![T::ZERO; 6 * n * n]);
    let mut errors = [0.0_f64; 2];
    for direction in directions().into_iter().map(|s| s.map(T::from_f64)) {
        eval(direction, &mut y, &mut gradient, &mut hessian);
        let s = direction.map(T::to_f64);
        let gradients: Vec<f64> = (0..3).flat_map(|a| long::gradient(n, s, a)).collect();
        let pairs = [[0, 0], [0, 1], [0, 2], [1, 1], [1, 2], [2, 2]];
        let hessians: Vec<f64> = pairs.into_iter().flat_map(|[a, b]| long::hessian(n, s, a, b)).collect();
        errors[0] = errors[0].max(worst(&gradient, &gradients));
        errors[1] = errors[1].max(worst(&hessian, &hessians));
    }
    errors
}

#[test]
fn derivatives_are_right_everywhere() {
    // One more power of n for every derivative; on top of the rounding of values, of which there are three terms each.
    for (n, eps32, eps64) in [(1, 0.0, 0.0), (2, 2e-7, 4e-16), (6, 5e-7, 1e-15), (10, 8e-7, 2e-15), (30, 2e-6, 4e-15)] {
        let order = Order::new(n).unwrap();
        let [g32, h32] = errors::<f32>(n, |s, y, g, h| eval_hessian(order, s, y, g, h));
        let [g64, h64] = errors::<f64>(n, |s, y, g, h| eval_hessian(order, s, y, g, h));
        println!("n = {n}: f32 {g32:.1e} {h32:.1e}, f64 {g64:.1e} {h64:.1e}");
        let size = n as f64;
        assert!(g32 <= eps32 * size && h32 <= 2.0 * eps32 * size * size, "f32, n = {n}: {g32:e} {h32:e}");
        assert!(g64 <= eps64 * size && h64 <= 2.0 * eps64 * size * size, "f64, n = {n}: {g64:e} {h64:e}");
    }
}

#[test]
fn tables_hold_what_is_computed() {
    for n in [1, 2, 3, 7, 10, 11, 33] {
        let order = Order::new(n).unwrap();
        let tables = BasisGradient::<f32>::new(order);
        assert_eq!(tables.order(), order);
        let new = || (vec![0.0; n * n], vec![0.0; 3 * n * n], vec![0.0; 6 * n * n]);
        let ((mut y, mut g, mut h), (mut y2, mut g2, mut h2)) = (new(), new());
        for s in directions().into_iter().map(|s| s.map(|s| s as f32)) {
            eval_hessian(order, s, &mut y, &mut g, &mut h);
            tables.eval_hessian(s, &mut y2, &mut g2, &mut h2);
            assert!(y == y2 && g == g2 && h == h2, "n = {n}, {s:?}");
            eval_gradient(order, s, &mut y2, &mut g2);
            assert!(y == y2 && g == g2, "n = {n}, {s:?}");
            tables.eval(s, &mut y2, &mut g2);
            assert!(y == y2 && g == g2, "n = {n}, {s:?}");
        }
    }
}

#[test]
fn hessians_hold_laplacians_and_gradients() {
    // Trace: −l(l+1) y. Along the ray: H s = −∇y.
    let (n, order) = (9, Order::new(9).unwrap());
    let count = n * n;
    let (mut y, mut g, mut h) = (vec![0.0_f64; count], vec![0.0; 3 * count], vec![0.0; 6 * count]);
    const ROWS: [[usize; 3]; 3] = [[0, 1, 2], [1, 3, 4], [2, 4, 5]];
    for s in directions() {
        eval_hessian(order, s, &mut y, &mut g, &mut h);
        for (l, band) in order.bands() {
            for i in band {
                let trace = h[i] + h[3 * count + i] + h[5 * count + i];
                assert!((trace + (l * (l + 1)) as f64 * y[i]).abs() < 1e-13, "y_{i} {s:?}");
                for (a, row) in ROWS.into_iter().enumerate() {
                    let along: f64 = row.iter().zip(s).map(|(&place, s)| h[place * count + i] * s).sum();
                    assert!((along + g[a * count + i]).abs() < 1e-13, "y_{i} {s:?}");
                }
            }
        }
    }
}

#[test]
fn odd_directions_have_an_answer() {
    for n in [1, 5, 12] {
        let order = Order::new(n).unwrap();
        let (mut y, mut g, mut h) = (vec![0.0_f32; n * n], vec![0.0; 3 * n * n], vec![0.0; 6 * n * n]);
        eval_hessian(order, [0.0; 3], &mut y, &mut g, &mut h);
        assert!(y.iter().chain(&g).chain(&h).all(|v| v.is_finite()), "n = {n}");
        for s in [[f32::NAN; 3], [f32::INFINITY, 0.0, 0.0], [1e30; 3]] {
            eval_hessian(order, s, &mut y, &mut g, &mut h);
            BasisGradient::new(order).eval_batch(&[s; 3], &mut vec![0.0; 3 * n * n], &mut vec![0.0; 9 * n * n]);
        }
    }
}

/// Batches hold the values at each direction, up to the rounding of fused operations, at every count of directions.
fn check_batches<T: Real>(n: usize, tolerance: f64) {
    let (order, count) = (Order::new(n).unwrap(), n * n);
    let (basis, gradients) = (Basis::<T>::new(order), BasisGradient::<T>::new(order));
    for directions_count in [0, 1, 3, 8, 15, 16, 17, 40] {
        let directions: Vec<[T; 3]> = fibonacci(directions_count).into_iter().map(|s| s.map(T::from_f64)).collect();
        let blocks = directions_count.div_ceil(BLOCK);
        let new = |size: usize| vec![T::from_f64(f64::NAN); size];
        let (mut rows, mut blocked) = (new(directions_count * count), new(blocks * count * BLOCK));
        let (mut rows_g, mut blocked_g) = (new(3 * directions_count * count), new(3 * blocks * count * BLOCK));
        basis.eval_batch(&directions, &mut rows);
        basis.eval_blocks(&directions, &mut blocked);
        let (mut rows_2, mut blocked_2) = (rows.clone(), blocked.clone());
        gradients.eval_batch(&directions, &mut rows_2, &mut rows_g);
        gradients.eval_blocks(&directions, &mut blocked_2, &mut blocked_g);
        assert!(rows == rows_2 && blocked == blocked_2, "n = {n}");
        let (mut y, mut g) = (new(count), new(3 * count));
        for d in 0..blocks * BLOCK {
            let inside = d < directions_count;
            if inside {
                eval(order, directions[d], &mut y);
                eval_gradient(order, directions[d], &mut rows_2[..count], &mut g);
            } else {
                y.fill(T::ZERO);
                g.fill(T::ZERO);
            }
            let (block, k) = (d / BLOCK, d % BLOCK);
            for i in 0..3 * count {
                let (value, derivative) = (y.get(i), g[i]);
                if let Some(&value) = value {
                    let blocked = blocked[(block * count + i) * BLOCK + k];
                    assert!((blocked - value).abs().to_f64() <= tolerance, "n = {n}, y_{i}, {d}: {blocked} {value}");
                    assert!(!inside || rows[d * count + i] == blocked);
                }
                let blocked = blocked_g[(3 * block * count + i) * BLOCK + k];
                let size = 2.0 * n as f64;
                assert!((blocked - derivative).abs().to_f64() <= size * tolerance, "n = {n}, {i}, {d}: {blocked}");
                assert!(!inside || rows_g[3 * d * count + i] == blocked);
            }
        }
    }
}

#[test]
fn batches_hold_the_values_at_each_direction() {
    for n in [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 20, 33] {
        // Twice the accuracy that is stated for one of them.
        check_batches::<f32>(n, if n <= 10 { 1.6e-6 } else { 4e-6 });
        check_batches::<f64>(n, if n <= 10 { 4e-15 } else { 1e-14 });
    }
    // Beyond the range of f32: values are rounded from f64, up to 4, and gradients follow from them in f32.
    check_batches::<f32>(130, 5e-7);
}
