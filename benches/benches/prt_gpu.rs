//! Speed of `prt-gpu`: `cargo bench -p prt-benches --bench prt_gpu`.
//!
//! Names are `prt-gpu/what/twin/size`: `shade_vector` by order, throughput per vertex; `frame` by image side, shading, drawing and, on
//! the GPU, reading back included; `shade_lobes` by evaluation of the light, for 4 lobes of order 6. Without an adapter the GPU is left out, with a word.

#![expect(clippy::print_stderr, reason = "a bench says which adapter it measures")]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;
use prt_gpu::{
    Evaluation, Gpu, LobeRenderer, LobeShape, LobeSurface, Lobes, Surface, SurfaceRenderer, View, cpu, wgpu,
};
use prt_tests::icosphere;
use sh_core::Order;

criterion_group!(benches, shade_vector, shade_lobes, frame);
criterion_main!(benches);

/// A sphere of 10,242 vertices with transfer of the given order.
struct Input {
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    albedo: Vec<[f32; 3]>,
    transfer: Vec<f32>,
    light: Vec<f32>,
    order: Order,
}

impl Input {
    fn new(n: usize) -> Self {
        let (vertices, triangles) = icosphere(DVec3::ZERO, 1.0, 5);
        let positions: Vec<[f32; 3]> = vertices.iter().map(|[position, _]| position.as_vec3().to_array()).collect();
        let order = Order::new(n).expect("orders of benches are valid");
        let wave = |i: usize| (i as f32 * 0.7).sin();
        Self {
            albedo: vec![[0.8, 0.6, 0.4]; positions.len()],
            transfer: (0..positions.len() * n * n).map(wave).collect(),
            light: (0..3 * n * n).map(wave).collect(),
            positions,
            triangles,
            order,
        }
    }

    fn surface(&self) -> Surface<'_> {
        Surface::new(&self.positions, &self.triangles, &self.albedo, self.order, 1, &self.transfer)
            .expect("the shapes match")
    }

    fn renderer(&self, gpu: &Gpu) -> SurfaceRenderer {
        SurfaceRenderer::new(gpu, &self.surface()).expect("the surface is small")
    }
}

/// Opens the GPU and names it, or says why not.
fn gpu() -> Option<Gpu> {
    match Gpu::headless() {
        Ok(gpu) => {
            eprintln!("GPU: {}", gpu.adapter_name());
            Some(gpu)
        }
        Err(error) => {
            eprintln!("skipped on the GPU: {error}");
            None
        }
    }
}

/// Radiance of all vertices under a new light.
fn shade_vector(criterion: &mut Criterion) {
    let gpu = gpu();
    let mut group = criterion.benchmark_group("prt-gpu/shade_vector");
    for n in [3, 4, 6] {
        let input = Input::new(n);
        let surface = input.surface();
        group.throughput(Throughput::Elements(surface.vertex_count() as u64));
        let mut radiance = vec![[0.0; 3]; surface.vertex_count()];
        group.bench_function(format!("cpu/{n}"), |b| {
            b.iter(|| cpu::shade_vector(&surface, black_box(&input.light), input.order, &mut radiance));
        });
        if let Some(gpu) = &gpu {
            let mut renderer = input.renderer(gpu);
            group.bench_function(format!("gpu/{n}"), |b| b.iter(|| shade_and_wait(gpu, &mut renderer, &input)));
        }
    }
}

fn shade_and_wait(gpu: &Gpu, renderer: &mut SurfaceRenderer, input: &Input) {
    renderer.set_light(black_box(&input.light), input.order).expect("the light fits");
    renderer.shade().expect("the device works");
    gpu.device().poll(wgpu::PollType::wait_indefinitely()).expect("the device works");
}

/// Four lobes of order 6 with DC and linear band explicit, on the vertices of [`Input`].
struct LobeInput {
    base: Input,
    shape: LobeShape,
    explicit: Vec<f32>,
    axes: Vec<[f32; 3]>,
    coeffs: Vec<f32>,
    frames: Vec<[[f32; 3]; 3]>,
}

impl LobeInput {
    fn new() -> Self {
        let base = Input::new(6);
        let shape = LobeShape { order: base.order, rows: 1, channels: 1, lobe_count: 4, explicit_count: 4 };
        let points = base.positions.len();
        let wave = |i: usize| (i as f32 * 0.7).sin();
        let axis = |i: usize| {
            let (height, angle) = (wave(i), i as f32 * 2.4);
            let radius = (1.0 - height * height).max(0.0).sqrt();
            [radius * angle.cos(), radius * angle.sin(), height]
        };
        let frame = |v: usize| {
            let (sin, cos) = (v as f32 * 0.01).sin_cos();
            [[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]]
        };
        let coeff = |i: usize| if i % 6 < shape.first_band() { 0.0 } else { wave(i) };
        Self {
            explicit: (0..points * shape.explicit_floats()).map(wave).collect(),
            axes: (0..points * shape.axis_count()).map(axis).collect(),
            coeffs: (0..points * shape.coeff_floats()).map(coeff).collect(),
            frames: (0..points).map(frame).collect(),
            shape,
            base,
        }
    }

    fn surface(&self) -> LobeSurface<'_> {
        let lobes = Lobes::new(self.shape, &self.explicit, &self.axes, &self.coeffs, None).expect("the shapes match");
        LobeSurface::new(&self.base.positions, &self.base.triangles, &self.base.albedo, lobes)
            .expect("the shapes match")
    }
}

/// Radiance of all vertices under a new light, in a pose: the table is built anew each time.
fn shade_lobes(criterion: &mut Criterion) {
    let gpu = gpu();
    let input = LobeInput::new();
    let (surface, order, light) = (input.surface(), input.shape.order, &input.base.light);
    let mut group = criterion.benchmark_group("prt-gpu/shade_lobes");
    group.throughput(Throughput::Elements(surface.vertex_count() as u64));
    let mut radiance = vec![[0.0; 3]; surface.vertex_count()];
    let table = |width, height| (format!("table-{width}x{height}"), Evaluation::Table { width, height });
    let ways = [("direct".into(), Evaluation::Direct), table(32, 16), table(64, 32), table(128, 64)];
    for (name, evaluation) in ways {
        group.bench_function(format!("cpu/{name}"), |b| {
            b.iter(|| {
                cpu::shade_lobes(&surface, &input.frames, black_box(light), order, None, evaluation, &mut radiance);
            });
        });
        if let Some(gpu) = &gpu {
            let mut renderer = LobeRenderer::new(gpu, &surface).expect("the surface is small");
            renderer.set_pose(surface.positions, Some(&input.frames)).expect("the lengths match");
            renderer.set_evaluation(evaluation).expect("the size is valid");
            group.bench_function(format!("gpu/{name}"), |b| {
                b.iter(|| {
                    renderer.set_light(black_box(light), order).expect("the light fits");
                    renderer.shade(None).expect("the device works");
                    gpu.device().poll(wgpu::PollType::wait_indefinitely()).expect("the device works");
                });
            });
        }
    }
}

/// An image under a new light from a new place.
fn frame(criterion: &mut Criterion) {
    let gpu = gpu();
    let input = Input::new(6);
    let surface = input.surface();
    let mut group = criterion.benchmark_group("prt-gpu/frame");
    group.sample_size(20);
    let mut turn = 0.0;
    let mut next_view = |side| {
        turn += 0.01;
        view(turn, side)
    };
    group.bench_function("cpu/512", |b| {
        b.iter(|| cpu::render(&surface, &input.light, input.order, &next_view(512)).expect("the view is valid"));
    });
    if let Some(gpu) = &gpu {
        let mut renderer = input.renderer(gpu);
        group.bench_function("gpu/512", |b| {
            b.iter(|| {
                renderer.set_light(&input.light, input.order).expect("the light fits");
                renderer.render(&next_view(512)).expect("the view is valid")
            });
        });
    }
}

/// A parallel projection that shows the sphere large, turned about the y axis.
fn view(turn: f32, side: u32) -> View {
    let (sin, cos) = turn.sin_cos();
    let clip_from_world =
        [[cos, 0.0, -0.4 * sin, 0.0], [0.0, 1.0, 0.0, 0.0], [-sin, 0.0, -0.4 * cos, 0.0], [0.0, 0.0, 0.5, 1.0]];
    View::new(clip_from_world.map(|column| [0.9 * column[0], 0.9 * column[1], column[2], column[3]]), side, side, 1)
        .expect("the view is valid")
}
