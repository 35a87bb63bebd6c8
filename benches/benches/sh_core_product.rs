//! Speed of products and exponentials, single thread: `cargo bench -p prt-benches --bench sh_core_product`.
//!
//! Names are `sh-core/what/order`. Times are per vector, those of `many` for a batch of 256.

use std::hint::black_box;

use criterion::{Bencher, Criterion, Throughput, criterion_group, criterion_main};
use sh_core::{
    ExpOptions, Order, ProductMatrix, ProductTransform, Real, TripleTensor, exp, log, product, product_many,
    product_matrix, square, triple_product,
};

criterion_group!(benches, one, fixed, many, exponential);
criterion_main!(benches);

/// Vectors in a batch: few enough for the second cache.
const BATCH: usize = 256;

fn order(n: usize) -> Order {
    Order::new(n).expect("orders of benches are valid")
}

fn coeffs<T: Real>(count: usize, step: f64) -> Vec<T> {
    (0..count).map(|i| T::from_f64((i as f64 * step).sin() / (count as f64).sqrt())).collect()
}

/// One product: the function, the separable transform, and the sparse sum over Gaunt coefficients.
fn one(criterion: &mut Criterion) {
    for n in [2, 3, 4, 5, 6] {
        criterion.bench_function(&format!("sh-core/product/{n}"), |b| bench_product::<f32>(b, n));
        criterion.bench_function(&format!("sh-core/product-f64/{n}"), |b| bench_product::<f64>(b, n));
        let (a, mut out) = (coeffs::<f32>(n * n, 1.3), vec![0.0; n * n]);
        criterion.bench_function(&format!("sh-core/square/{n}"), |b| {
            b.iter(|| square(order(n), black_box(&a), black_box(&mut out)));
        });
        criterion.bench_function(&format!("sh-core/triple-product/{n}"), |b| {
            b.iter(|| triple_product(order(n), black_box(&a), black_box(&a), black_box(&a)));
        });
    }
    for n in [3, 4, 5, 6, 7, 8, 10, 16, 32] {
        criterion.bench_function(&format!("sh-core/product-transform/{n}"), |b| bench_transform::<f32>(b, n));
        criterion.bench_function(&format!("sh-core/product-transform-f64/{n}"), |b| bench_transform::<f64>(b, n));
    }
    for n in [3, 4, 5, 6, 10] {
        let (tensor, a, b) = (TripleTensor::new(order(n)), coeffs::<f32>(n * n, 1.3), coeffs::<f32>(n * n, 0.7));
        let mut out = vec![0.0; n * n];
        criterion.bench_function(&format!("sh-core/product-tensor/{n}"), |bencher| {
            bencher.iter(|| tensor.product(black_box(&a), black_box(&b), black_box(&mut out)));
        });
    }
}

fn bench_product<T: Real>(bencher: &mut Bencher<'_>, n: usize) {
    let (a, b, mut out) = (coeffs::<T>(n * n, 1.3), coeffs::<T>(n * n, 0.7), vec![T::ZERO; n * n]);
    bencher.iter(|| product(order(n), black_box(&a), black_box(&b), black_box(&mut out)));
}

fn bench_transform<T: Real>(bencher: &mut Bencher<'_>, n: usize) {
    let mut transform = ProductTransform::new(order(n));
    let (a, b, mut out) = (coeffs::<T>(n * n, 1.3), coeffs::<T>(n * n, 0.7), vec![T::ZERO; n * n]);
    bencher.iter(|| transform.product(black_box(&a), black_box(&b), black_box(&mut out)));
}

/// One factor is fixed: building its matrix, and applying it.
fn fixed(criterion: &mut Criterion) {
    for n in [3, 4, 5, 6, 10] {
        let (a, mut matrix) = (coeffs::<f32>(n * n, 1.3), vec![0.0; n.pow(4)]);
        criterion.bench_function(&format!("sh-core/product-matrix/{n}"), |b| {
            b.iter(|| product_matrix(order(n), black_box(&a), black_box(&mut matrix)));
        });
        let (matrix, mut out) = (ProductMatrix::new(order(n), &a), vec![0.0; n * n]);
        criterion.bench_function(&format!("sh-core/product-matrix-apply/{n}"), |b| {
            b.iter(|| matrix.apply(black_box(&a), black_box(&mut out)));
        });
    }
}

/// Batches: both factors vary, or one is fixed.
fn many(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("sh-core");
    group.throughput(Throughput::Elements(BATCH as u64));
    for n in [3, 4, 5, 6] {
        let (a, b) = (coeffs::<f32>(BATCH * n * n, 1.3), coeffs::<f32>(BATCH * n * n, 0.7));
        let mut out = vec![0.0; BATCH * n * n];
        group.bench_function(format!("product-many/{n}"), |bencher| {
            bencher.iter(|| product_many(order(n), black_box(&a), black_box(&b), black_box(&mut out)));
        });
        let matrix = ProductMatrix::new(order(n), &a[..n * n]);
        group.bench_function(format!("product-matrix-apply-many/{n}"), |bencher| {
            bencher.iter(|| matrix.apply_many(black_box(&b), black_box(&mut out)));
        });
    }
}

/// Exponential by its presets, of a vector of length 2 beside the first coefficient; logarithm.
fn exponential(criterion: &mut Criterion) {
    for n in [3, 4, 6] {
        let mut f = coeffs::<f32>(n * n, 1.3);
        let length = f[1..].iter().map(|f| f * f).sum::<f32>().sqrt();
        f.iter_mut().for_each(|f| *f *= 2.0 / length);
        let mut out = vec![0.0; n * n];
        for (name, options) in
            [("linear", ExpOptions::linear()), ("hybrid", ExpOptions::hybrid()), ("accurate", ExpOptions::accurate())]
        {
            criterion.bench_function(&format!("sh-core/exp-{name}/{n}"), |b| {
                b.iter(|| exp(order(n), &options, black_box(&f), black_box(&mut out)));
            });
        }
        criterion.bench_function(&format!("sh-core/log/{n}"), |b| {
            b.iter(|| log(order(n), black_box(&f), 0.01, black_box(&mut out)));
        });
    }
}
