//! Speed of `prt-anim`: `cargo bench -p prt-benches --bench prt_anim`.
//!
//! Names are `prt-anim/what/size`. Throughput is per vertex, on all threads. With the test data at hand a real character is posed too.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;
use prt_anim::{Character, Deformation, Deformed, Playback, frames_from_mesh, frames_from_skin, load_character};
use prt_bake::Mesh;
use prt_tests::{SceneBuilder, data_path, icosphere};

criterion_group!(benches, skinning, deformations, frames);
criterion_main!(benches);

fn knight() -> Option<Character> {
    let path = data_path("the bench of a character", "characters/kaykit_knight.glb")?;
    Some(load_character(&path).expect("the test data is readable"))
}

fn ball() -> (Mesh, Vec<[f32; 3]>) {
    let builder = SceneBuilder::default().add(icosphere(DVec3::ZERO, 1.0, 5), [0.8; 3]);
    let mesh = builder.build().expect("the scene has faces");
    let positions = mesh.positions().iter().map(|position| position.map(|value| value as f32)).collect();
    (mesh, positions)
}

fn skinning(criterion: &mut Criterion) {
    let Some(character) = knight() else { return };
    let mut pose = character.skeleton.rest_pose();
    character.clips[0].sample(0.5, Playback::Loop, &mut pose);
    let skin = &character.mesh.skin;
    let count = skin.vertex_count();
    let mut group = criterion.benchmark_group("prt-anim/skinning");
    group.throughput(Throughput::Elements(count as u64));
    let maps = skin.bone_maps(&character.skeleton, &pose);
    let (mut positions, mut frames) = (vec![[0.0; 3]; count], vec![[[0.0; 3]; 3]; count]);
    group.bench_function("positions/knight", |b| b.iter(|| skin.positions(black_box(&maps), &mut positions)));
    group.bench_function("frames/knight", |b| b.iter(|| frames_from_skin(skin, black_box(&maps), &mut frames)));
    let mut out = Deformed::default();
    group.bench_function("all/knight", |b| b.iter(|| skin.deform(&character.skeleton, black_box(&pose), &mut out)));
    group.finish();
    criterion.bench_function("prt-anim/clip/knight", |b| {
        b.iter(|| character.clips[0].sample(black_box(0.5), Playback::Loop, &mut pose));
    });
}

fn deformations(criterion: &mut Criterion) {
    let (mesh, positions) = ball();
    let mut group = criterion.benchmark_group("prt-anim/deform");
    group.throughput(Throughput::Elements(positions.len() as u64));
    let mut out = Deformed::default();
    for (name, deformation) in [
        ("bend", Deformation::bend(mesh.bounds(), 1.0)),
        ("twist", Deformation::twist(mesh.bounds(), 1.0)),
        ("wave", Deformation::wave(mesh.bounds(), 0.1, 2.0, 0.3)),
    ] {
        group.bench_function(format!("{name}/ball"), |b| {
            b.iter(|| deformation.deform(black_box(&positions), mesh.normals(), &mut out));
        });
    }
}

fn frames(criterion: &mut Criterion) {
    let (mesh, positions) = ball();
    let mut bent = Deformed::default();
    Deformation::bend(mesh.bounds(), 1.0).deform(&positions, mesh.normals(), &mut bent);
    let mut group = criterion.benchmark_group("prt-anim/frames-from-mesh");
    group.throughput(Throughput::Elements(positions.len() as u64));
    group.bench_function("ball", |b| {
        b.iter(|| frames_from_mesh(&positions, mesh.normals(), black_box(&bent.positions), mesh.triangles()));
    });
}
