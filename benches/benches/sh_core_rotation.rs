//! Speed of rotations, single thread: `cargo bench -p prt-benches --bench sh_core_rotation`.
//!
//! Names are `sh-core/what/order`; `rotate-many` is per block of 64 vectors, which stay in the first cache for n ≤ 6.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use sh_core::{Order, ShRotation, Taylor, TaylorDegree, Zxzxz, Zyz, rotate, rotate_quaternion, rotate_z};

criterion_group!(benches, one_vector, many_vectors, splats);
criterion_main!(benches);

fn order(n: usize) -> Order {
    Order::new(n).expect("orders of benches are valid")
}

fn coefficients(count: usize) -> Vec<f32> {
    (0..count).map(|i| (1.0 + i as f32).sin()).collect()
}

/// Rotations to go round: too many for the branch predictor to learn.
fn matrices() -> Vec<[[f32; 3]; 3]> {
    let angles = (0..64).map(|i| i as f32).map(|i| [1.1 * i, 0.045 * i, -0.7 * i]);
    angles.map(|angles| Zyz::from_angles(angles).matrix()).collect()
}

/// Build and apply, one vector: per rotation.
fn one_vector(criterion: &mut Criterion) {
    let matrices = matrices();
    for n in 3..=10 {
        let (coeffs, mut out) = (coefficients(n * n), vec![0.0; n * n]);
        let mut next = matrices.iter().cycle();
        criterion.bench_function(&format!("sh-core/rotate/{n}"), |b| {
            b.iter(|| {
                rotate(order(n), *black_box(next.next().expect("no end")), black_box(&coeffs), black_box(&mut out));
            });
        });
    }
    for n in [4, 6, 10, 32] {
        let (coeffs, mut out) = (coefficients(n * n), vec![0.0; n * n]);
        let tables = Zxzxz::new(order(n));
        let taylor = Taylor::new(order(n), TaylorDegree::OneAndHalf);
        let mut next = matrices.iter().cycle();
        let mut zyz = || Zyz::from_matrix(*black_box(next.next().expect("no end")));
        criterion.bench_function(&format!("sh-core/rotate-tables/{n}"), |b| {
            b.iter(|| tables.rotate(&zyz(), black_box(&coeffs), black_box(&mut out)));
        });
        criterion.bench_function(&format!("sh-core/rotate-taylor-1.5/{n}"), |b| {
            b.iter(|| taylor.rotate(&zyz(), black_box(&coeffs), black_box(&mut out)));
        });
        criterion.bench_function(&format!("sh-core/rotate-z/{n}"), |b| {
            b.iter(|| rotate_z(order(n), black_box([0.6, 0.8]), black_box(&coeffs), black_box(&mut out)));
        });
        criterion.bench_function(&format!("sh-core/rotate-quaternion/{n}"), |b| {
            let quaternion = [0.1, 0.5, -0.5, 0.7];
            b.iter(|| rotate_quaternion(order(n), black_box(quaternion), black_box(&coeffs), black_box(&mut out)));
        });
    }
}

/// One rotation, 64 vectors.
fn many_vectors(criterion: &mut Criterion) {
    for n in 3..=10 {
        let rotation = ShRotation::new(order(n), matrices()[7]);
        let (coeffs, mut out) = (coefficients(64 * n * n), vec![0.0; 64 * n * n]);
        criterion.bench_function(&format!("sh-core/rotate-many-64/{n}"), |b| {
            b.iter(|| rotation.apply_many(black_box(&coeffs), black_box(&mut out)));
        });
    }
}

/// A million Gaussian splats of one channel: per call. Memory is the limit, so a copy stands beside it.
fn splats(criterion: &mut Criterion) {
    let rotation = ShRotation::new(order(4), matrices()[7]);
    let (coeffs, mut out) = (coefficients(16_000_000), vec![0.0; 16_000_000]);
    let mut group = criterion.benchmark_group("sh-core");
    group.sample_size(10);
    group.bench_function("rotate-million/4", |b| {
        b.iter(|| rotation.apply_many(black_box(&coeffs), black_box(&mut out)));
    });
    group.bench_function("rotate-million-in-place/4", |b| b.iter(|| rotation.apply_many_in_place(black_box(&mut out))));
    group.bench_function("copy-million/4", |b| b.iter(|| black_box(&mut out).copy_from_slice(black_box(&coeffs))));
    group.finish();
}
