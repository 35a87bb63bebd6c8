//! Speed of `sh-core`, single thread: `cargo bench -p prt-benches --bench sh_core`.
//!
//! Names are `sh-core/what/order`. Evaluation and rotation are per direction or vector, maps per map.

use std::hint::black_box;

use criterion::{Bencher, Criterion, criterion_group, criterion_main};
use sh_core::{
    BLOCK, Basis, BasisGradient, CubeMap, LatLong, Order, Real, ShRotation, eval, fibonacci, project_cube,
    project_lat_long, reconstruct, reconstruct_lat_long,
};

criterion_group!(benches, evaluation, batches, projection, reconstruction, rotation);
criterion_main!(benches);

fn order(n: usize) -> Order {
    Order::new(n).expect("orders of benches are valid")
}

/// Directions to go round: few enough for the first cache, too many for the branch predictor to learn.
fn directions<T: Real>() -> Vec<[T; 3]> {
    fibonacci(256).into_iter().map(|d| d.map(T::from_f64)).collect()
}

/// Calls `f` with one direction after the other.
fn per_direction<T: Real>(bencher: &mut Bencher<'_>, mut f: impl FnMut([T; 3])) {
    let directions = directions::<T>();
    let mut next = directions.iter().cycle();
    bencher.iter(|| f(black_box(*next.next().expect("a cycle has no end"))));
}

/// One direction: the free function for small orders, tables for all.
fn evaluation(criterion: &mut Criterion) {
    for n in 3..=10 {
        criterion.bench_function(&format!("sh-core/eval/{n}"), |b| bench_eval::<f32>(b, n));
        criterion.bench_function(&format!("sh-core/eval-f64/{n}"), |b| bench_eval::<f64>(b, n));
    }
    for n in [16, 32, 65] {
        criterion.bench_function(&format!("sh-core/eval/{n}"), |b| bench_eval::<f32>(b, n));
        criterion.bench_function(&format!("sh-core/basis/{n}"), |b| bench_basis::<f32>(b, n));
        criterion.bench_function(&format!("sh-core/basis-f64/{n}"), |b| bench_basis::<f64>(b, n));
    }
    criterion.bench_function("sh-core/basis-f64/512", |b| bench_basis::<f64>(b, 512));
}

fn bench_eval<T: Real>(bencher: &mut Bencher<'_>, n: usize) {
    let mut y = vec![T::ZERO; n * n];
    per_direction(bencher, |direction| eval(order(n), direction, black_box(&mut y)));
}

fn bench_basis<T: Real>(bencher: &mut Bencher<'_>, n: usize) {
    let basis = Basis::<T>::new(order(n));
    let mut y = vec![T::ZERO; n * n];
    per_direction(bencher, |direction| basis.eval(direction, black_box(&mut y)));
}

/// Many directions, per batch of 192: vectors, blocks, values with gradients, samples of three channels.
fn batches(criterion: &mut Criterion) {
    const COUNT: usize = 12 * BLOCK;
    let directions: Vec<[f32; 3]> = fibonacci(COUNT).into_iter().map(|s| s.map(|s| s as f32)).collect();
    for n in [3, 4, 6, 10] {
        let (basis, gradients) = (Basis::<f32>::new(order(n)), BasisGradient::<f32>::new(order(n)));
        let (mut y, mut gradient) = (vec![0.0; COUNT * n * n], vec![0.0; 3 * COUNT * n * n]);
        let (mut radiance, mut light) = (vec![[1.0_f32; 3]; COUNT], vec![0.5; 3 * n * n]);
        let mut bench = |what: &str, f: &mut dyn FnMut(&[[f32; 3]])| {
            criterion.bench_function(&format!("sh-core/{what}-192/{n}"), |b| b.iter(|| f(black_box(&directions))));
        };
        bench("eval-batch", &mut |s| basis.eval_batch(s, black_box(&mut y)));
        bench("eval-blocks", &mut |s| basis.eval_blocks(s, black_box(&mut y)));
        bench("gradient-batch", &mut |s| gradients.eval_batch(s, &mut y, black_box(&mut gradient)));
        bench("gradient-blocks", &mut |s| gradients.eval_blocks(s, &mut y, black_box(&mut gradient)));
        bench("reconstruct-rgb", &mut |s| basis.reconstruct(&light, s, black_box(&mut radiance)));
        bench("project-rgb", &mut |s| basis.project(s, &radiance, black_box(&mut light)));
    }
}

/// Some radiance for every texel.
fn pixels(count: usize) -> Vec<[f32; 3]> {
    (0..count).map(|i| (i % 251) as f32).map(|v| [v, 0.5 * v, 2.0 + v]).collect()
}

/// RGB maps to lights, and a light to a map.
fn projection(criterion: &mut Criterion) {
    for (n, width, height) in [(6, 256, 128), (10, 256, 128), (6, 1024, 512), (64, 1024, 512)] {
        let (map, pixels) = (LatLong { width, height }, pixels(width * height));
        let mut light = vec![0.0; 3 * n * n];
        let name = format!("sh-core/project-lat-long-{width}x{height}/{n}");
        criterion.bench_function(&name, |b| b.iter(|| project_lat_long(order(n), map, black_box(&pixels), &mut light)));
    }
    for (n, size) in [(6, 64), (10, 64), (6, 256)] {
        let (map, face) = (CubeMap { size }, pixels(size * size));
        let mut light = vec![0.0; 3 * n * n];
        let name = format!("sh-core/project-cube-{size}/{n}");
        criterion.bench_function(&name, |b| {
            b.iter(|| project_cube(order(n), map, black_box([face.as_slice(); 6]), &mut light));
        });
    }
}

/// A light at a direction, and as a map.
fn reconstruction(criterion: &mut Criterion) {
    for n in [6, 10, 32] {
        let coeffs = vec![1.0_f32; n * n];
        criterion.bench_function(&format!("sh-core/reconstruct/{n}"), |b| {
            per_direction(b, |direction| {
                black_box(reconstruct(order(n), &coeffs, direction));
            });
        });
    }
    let (map, light) = (LatLong { width: 256, height: 128 }, vec![1.0; 3 * 36]);
    let mut pixels = pixels(map.texel_count());
    criterion.bench_function("sh-core/reconstruct-lat-long-256x128/6", |b| {
        b.iter(|| reconstruct_lat_long(order(6), black_box(&light), map, &mut pixels));
    });
}

/// Building a rotation, and applying it to a vector.
fn rotation(criterion: &mut Criterion) {
    let matrix = [[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]];
    for n in [4, 6, 10, 32] {
        criterion.bench_function(&format!("sh-core/rotation-new/{n}"), |b| {
            b.iter(|| ShRotation::<f32>::new(order(n), black_box(matrix)));
        });
        let rotation = ShRotation::<f32>::new(order(n), matrix);
        let (coeffs, mut out) = (vec![1.0; n * n], vec![0.0; n * n]);
        criterion.bench_function(&format!("sh-core/rotation-apply/{n}"), |b| {
            b.iter(|| rotation.apply(black_box(&coeffs), black_box(&mut out)));
        });
    }
}
