//! Speed of `sh-fit`: `cargo bench -p prt-benches --bench sh_fit`.
//!
//! Names are `sh-fit/what/lobes`. Throughput is per vector, on one thread. The vectors are transfer under a few caps that hide
//! parts of the sky: smooth, as real transfer is, and made without a ray.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use sh_core::{Order, fibonacci};
use sh_fit::{FitOptions, Method, fit_lobes_many};

criterion_group!(benches, presets, methods);
criterion_main!(benches);

/// `[D, 36]`: the clamped cosine about each of the directions, and two caps of it taken away.
fn transfer(count: usize) -> Vec<f32> {
    let order = Order::new(6).expect("valid");
    let directions = fibonacci(count);
    let mut zonal = [0.0_f64; 6];
    let mut part = [0.0; 36];
    let mut all = Vec::new();
    for (i, &normal) in directions.iter().enumerate() {
        let mut sum = [0.0; 36];
        sh_core::clamped_cosine(&mut zonal);
        sh_core::expand_zonal(order, &zonal, normal, &mut sum);
        for (k, radius) in [(7, 0.5), (13, 0.7)] {
            sh_core::spherical_cap(radius, &mut zonal);
            sh_core::expand_zonal(order, &zonal, directions[(i * k + 31) % count], &mut part);
            sum.iter_mut().zip(&part).for_each(|(sum, part)| *sum -= 0.5 * part);
        }
        all.extend(sum.map(|f| f as f32));
    }
    all
}

fn fit(criterion: &mut Criterion, group: &str, vectors: usize, cases: &[(&str, FitOptions)]) {
    let (order, targets) = (Order::new(6).expect("valid"), transfer(vectors));
    let mut group = criterion.benchmark_group(group);
    group.sample_size(10).throughput(Throughput::Elements(vectors as u64));
    for (name, options) in cases {
        for lobe_count in [1, 2, 4, 6] {
            let options = FitOptions { lobe_count, threads: Some(1), ..options.clone() };
            group.bench_function(BenchmarkId::new(*name, lobe_count), |b| {
                b.iter(|| fit_lobes_many(order, 1, black_box(&targets), None, &options, &|_| ()));
            });
        }
    }
}

fn presets(criterion: &mut Criterion) {
    let cases = [("fast", FitOptions::fast()), ("default", FitOptions::default())];
    fit(criterion, "sh-fit/fit", 256, &cases);
}

/// The greedy start alone, by each method.
fn methods(criterion: &mut Criterion) {
    let one = |method| FitOptions { method, max_iterations: 300, ..FitOptions::fast() };
    let cases = [("newton", one(Method::VariableProjection)), ("bfgs", one(Method::QuasiNewton))];
    fit(criterion, "sh-fit/method", 16, &cases);
}
