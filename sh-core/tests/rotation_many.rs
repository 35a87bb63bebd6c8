//! One rotation of many vectors is the same as one vector after the other.
#![cfg(feature = "alloc")]
#![expect(clippy::unwrap_used, reason = "tests")]

use sh_core::{Order, Real, ShRotation, Zyz};

fn check<T: Real>(n: usize, vectors: usize, tolerance: f64) {
    let order = Order::new(n).unwrap();
    let rotation = ShRotation::new(order, Zyz::from_angles([0.3, 1.1, -2.0].map(T::from_f64)).matrix());
    let coeffs: Vec<T> = (0..vectors * n * n).map(|i| T::from_f64((1.0 + 1.7 * i as f64).sin())).collect();
    let mut expected = vec![T::ZERO; coeffs.len()];
    for (f, out) in coeffs.chunks_exact(n * n).zip(expected.chunks_exact_mut(n * n)) {
        rotation.apply(f, out);
    }
    let mut out = vec![T::from_f64(f64::NAN); coeffs.len()];
    rotation.apply_many(&coeffs, &mut out);
    let mut in_place = coeffs;
    rotation.apply_many_in_place(&mut in_place);
    for (i, expected) in expected.iter().enumerate() {
        for found in [out[i], in_place[i]] {
            assert!(
                (found - *expected).to_f64().abs() < tolerance,
                "n = {n}, {vectors} vectors, {i}: {found} {expected}"
            );
        }
    }
}

#[test]
fn any_number_of_vectors_of_any_order() {
    for n in (1..=12).chain([17, 33]) {
        // Around the numbers of lanes: 4, 8, 16.
        for vectors in [0, 1, 3, 4, 5, 8, 9, 15, 16, 17, 31, 32, 33, 67] {
            check::<f32>(n, vectors, 3e-6);
            check::<f64>(n, vectors, 6e-15);
        }
    }
}

#[test]
#[should_panic(expected = "coeffs has 17 elements, it needs a multiple of 16")]
fn parts_of_vectors_are_refused() {
    ShRotation::about_z(Order::new(4).unwrap(), 1.0_f32).apply_many(&[0.0; 17], &mut [0.0; 17]);
}

#[test]
#[should_panic(expected = "out has 16 elements, it needs 32")]
fn different_lengths_are_refused() {
    ShRotation::about_z(Order::new(4).unwrap(), 1.0_f32).apply_many(&[0.0; 32], &mut [0.0; 16]);
}

#[test]
#[should_panic(expected = "coeffs has 3 elements, it needs a multiple of 4")]
fn parts_of_vectors_are_refused_in_place() {
    ShRotation::about_z(Order::new(2).unwrap(), 1.0_f32).apply_many_in_place(&mut [0.0; 3]);
}
