//! Speed of `prt-bake`: `cargo bench -p prt-benches --bench prt_bake`.
//!
//! Names are `prt-bake/what/size`. Throughput is per ray, on all threads; a bake traces about as many rays as the vertices have
//! directions above their horizon. With the test data at hand a real mesh is baked too.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::{DVec3, Vec3};
use prt_bake::{
    BakeOptions, HeightField, Mesh, MeshOptions, PatchOptions, Scene, bake_diffuse, bake_patch, bake_vertices,
    load_mesh,
};
use prt_tests::{SceneBuilder, data_path, grid, icosphere};
use sh_core::Order;

criterion_group!(benches, bake, projection, patch, rays, tree, readers);
criterion_main!(benches);

/// A ball over a floor: about 4,000 vertices.
fn ball_and_floor() -> Mesh {
    SceneBuilder::default()
        .add(grid(DVec3::new(-2.0, -2.0, 0.0), 4.0 * DVec3::X, 4.0 * DVec3::Y, 36), [0.8; 3])
        .add(icosphere(DVec3::new(0.0, 0.0, 0.8), 0.7, 4), [0.8; 3])
        .build()
        .expect("the scene has faces")
}

fn bunny() -> Option<Mesh> {
    let path = data_path("the bench of a real mesh", "meshes/stanford_bunny.obj")?;
    let source = load_mesh(&path).expect("the test data is readable");
    Some(Mesh::new(source, &MeshOptions::default()).expect("the test data has faces").0)
}

fn meshes() -> impl Iterator<Item = (&'static str, Mesh)> {
    std::iter::once(("ball", ball_and_floor())).chain(bunny().map(|mesh| ("bunny", mesh)))
}

fn bake(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("prt-bake/bake");
    group.sample_size(10);
    for (name, mesh) in meshes() {
        for bounces in [0, 2] {
            let options = BakeOptions { rays_per_vertex: 256, bounces, ..BakeOptions::default() };
            let (_, report) = bake_diffuse(&mesh, &options, &()).expect("options are valid");
            group.throughput(Throughput::Elements(report.rays_traced));
            group.bench_function(format!("{name}/{bounces}-bounces"), |b| {
                let mut seed = 0;
                b.iter(|| {
                    seed += 1;
                    bake_diffuse(black_box(&mesh), &BakeOptions { seed, ..options.clone() }, &())
                });
            });
        }
    }
}

/// Some vertices on one thread, at order 1 and at order 6: what the second takes more is the price of 35 more basis functions. The rays are the
/// same.
fn projection(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("prt-bake/projection");
    group.sample_size(10);
    for (name, mesh) in meshes() {
        let vertices: Vec<usize> = (0..mesh.positions().len()).step_by(mesh.positions().len() / 100).collect();
        group.throughput(Throughput::Elements(vertices.len() as u64));
        for n in [1, 6] {
            let order = Order::new(n).expect("1 and 6 are orders");
            let options = BakeOptions { order, threads: Some(1), ..BakeOptions::default() };
            group.bench_function(format!("{name}/order-{n}"), |b| {
                b.iter_custom(|times| {
                    let bake = |_| bake_vertices(&mesh, &options, &vertices).expect("options are valid").trace;
                    (0..times).map(bake).sum()
                });
            });
        }
    }
}

/// The paper's bumps, 64 × 64: rays of stone, paths of wax.
fn patch(criterion: &mut Criterion) {
    let field = HeightField::bumps(64, 0.15).expect("the pattern is valid");
    let cases = [
        ("stone/0-bounces", PatchOptions { rays_per_texel: 256, ..PatchOptions::default() }),
        ("stone/1-bounces", PatchOptions { rays_per_texel: 256, bounces: 1, ..PatchOptions::default() }),
        ("wax/thin", PatchOptions { rays_per_texel: 16, ..PatchOptions::thin() }),
        ("wax/thick", PatchOptions { rays_per_texel: 16, ..PatchOptions::thick() }),
    ];
    let mut group = criterion.benchmark_group("prt-bake/patch");
    group.sample_size(10);
    for (name, options) in cases {
        let (_, report) = bake_patch(&field, &options, &()).expect("options are valid");
        group.throughput(Throughput::Elements(report.rays_traced));
        group.bench_function(format!("bumps-64/{name}"), |b| {
            let mut seed = 0;
            b.iter(|| {
                seed += 1;
                bake_patch(black_box(&field), &PatchOptions { seed, ..options.clone() }, &())
            });
        });
    }
}

/// Packets of 64 neighbouring directions from points around the mesh, one thread.
fn rays(criterion: &mut Criterion) {
    let directions: Vec<Vec3> =
        (0..64).map(|i| Vec3::new(0.1 * (i % 8) as f32, 0.1 * (i / 8) as f32, 1.0).normalize()).collect();
    let mut group = criterion.benchmark_group("prt-bake/rays");
    group.throughput(Throughput::Elements(64));
    for (name, mesh) in meshes() {
        let scene = Scene::new(&mesh);
        let mut positions = mesh.positions().iter().cycle();
        let mut next = || *positions.next().expect("a cycle has no end");
        let (mut occluded, mut hits) = ([false; 64], [None; 64]);
        group.bench_function(format!("{name}/occluded"), |b| {
            b.iter(|| scene.occluded(black_box(next()), &directions, black_box(&mut occluded)));
        });
        group.bench_function(format!("{name}/closest"), |b| {
            b.iter(|| scene.closest(black_box(next()), &directions, black_box(&mut hits)));
        });
    }
}

fn tree(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("prt-bake/tree");
    for (name, mesh) in meshes() {
        group.throughput(Throughput::Elements(mesh.triangles().len() as u64));
        group.bench_function(name, |b| b.iter(|| Scene::new(black_box(&mesh))));
    }
}

fn readers(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("prt-bake/load");
    group.sample_size(10);
    for file in ["meshes/stanford_bunny.obj", "meshes/dragon_100k.ply", "characters/kaykit_knight.glb"] {
        if let Some(path) = data_path("the bench of a reader", file) {
            group.bench_function(file, |b| b.iter(|| load_mesh(black_box(&path))));
        }
    }
}
