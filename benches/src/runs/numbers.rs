//! The table of the README.

use std::hint::black_box;
use std::time::Instant;

use anyhow::Result;
use prt_bake::{BakeOptions, Environment, Mesh, bake_diffuse};
use prt_gpu::{Surface, View, cpu};
use sh_core::{LatLong, Order, rotate};

use super::mesh;
use crate::output::table;

pub(super) fn run(_asked: Option<&str>) -> Result<()> {
    let mut rows = Vec::new();
    harmonics(&mut rows)?;
    baking_and_shading(&mut rows)?;
    table("readme/numbers", &["what", "time", "rate or accuracy"], &rows)
}

/// Median of the seconds that one call takes, over `calls` calls, seven times.
fn median_seconds(calls: usize, mut call: impl FnMut()) -> f64 {
    let mut seconds: Vec<f64> = (0..7)
        .map(|_| {
            let start = Instant::now();
            (0..calls).for_each(|_| call());
            start.elapsed().as_secs_f64() / calls as f64
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    seconds[3]
}

fn harmonics(rows: &mut Vec<Vec<String>>) -> Result<()> {
    let order = Order::new(6)?;
    let directions: Vec<[f32; 3]> = sh_core::fibonacci(4096).iter().map(|d| d.map(|x| x as f32)).collect();
    let mut basis = [0.0_f32; 36];
    let all = median_seconds(100, || {
        directions.iter().for_each(|&direction| sh_core::eval(order, black_box(direction), black_box(&mut basis)));
    });
    rows.push(row("evaluate 36 basis functions, f32", format!("{:.1} ns", all / 4096.0 * 1e9), "one direction".into()));
    let map = LatLong { width: 1024, height: 512 };
    let pixels = vec![[1.0_f32, 0.5, 0.25]; map.width * map.height];
    let mut light = [0.0; 108];
    let seconds =
        median_seconds(3, || sh_core::project_lat_long(order, map, black_box(&pixels), black_box(&mut light)));
    rows.push(row("project a 1024×512 RGB map, n = 6", format!("{:.1} ms", seconds * 1e3), "sums in f64".into()));
    let (sin, cos) = 0.7_f32.sin_cos();
    let rotation = [[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]];
    let mut rotated = [0.0; 36];
    let seconds = median_seconds(20, || {
        (0..1000).for_each(|_| rotate(order, black_box(rotation), black_box(&light[..36]), black_box(&mut rotated)));
    });
    rows.push(row("rotate an expansion, n = 6", format!("{:.0} ns", seconds * 1e6), "any rotation, exact".into()));
    Ok(())
}

fn baking_and_shading(rows: &mut Vec<Vec<String>>) -> Result<()> {
    let bunny = mesh(None, "meshes/stanford_bunny.obj")?;
    let default = BakeOptions::default();
    let alone = bake("the bunny", &bunny, &BakeOptions { threads: Some(1), ..default.clone() }, rows)?;
    let together = bake("the bunny", &bunny, &default, rows)?;
    rows.push(row("the second against the first", format!("{:.2}×", alone / together), String::new()));
    bake("the bunny", &bunny, &BakeOptions { bounces: 2, ..default.clone() }, rows)?;
    let head = mesh(None, "meshes/nefertiti.obj")?;
    let as_in_2002 = BakeOptions { order: Order::new(5)?, rays_per_vertex: 10_000, ..default };
    bake("a head as in [SKS02], where it took 1.1 h", &head, &as_in_2002, rows)?;
    shading(&bunny, rows)
}

/// Median of three bakes; returns its seconds of tracing.
fn bake(what: &str, mesh: &Mesh, options: &BakeOptions, rows: &mut Vec<Vec<String>>) -> Result<f64> {
    let mut reports = Vec::new();
    for _ in 0..3 {
        reports.push(bake_diffuse(mesh, options, &())?.1);
    }
    reports.sort_by_key(|report| report.trace);
    let (report, BakeOptions { rays_per_vertex, bounces, order, .. }) = (&reports[1], options);
    let (seconds, vertices) = (report.trace.as_secs_f64(), mesh.positions().len());
    rows.push(row(
        &format!("bake {what}: {vertices} vertices, n = {order}, {rays_per_vertex} rays, {bounces} bounces"),
        format!("{seconds:.1} s"),
        format!(
            "{:.0} million directions/s on {} threads, {:.0} million rays traced; error {:.1e}",
            report.savings.directions as f64 / seconds / 1e6,
            report.threads,
            report.rays_traced as f64 / 1e6,
            report.error.unwrap_or(0.0)
        ),
    ));
    Ok(seconds)
}

fn shading(mesh: &Mesh, rows: &mut Vec<Vec<String>>) -> Result<()> {
    let baked = bake_diffuse(mesh, &BakeOptions::preview(), &())?.0;
    let transfer = &baked.transfer;
    let surface = Surface::new(
        &baked.geometry.positions,
        &baked.geometry.triangles,
        &baked.geometry.albedo,
        transfer.order,
        transfer.channels,
        &transfer.values,
    )?;
    let white = Environment::LatLong(prt_bake::Image { width: 2, height: 1, pixels: vec![[1.0; 3]; 2] });
    let light = white.light(transfer.order);
    let mut radiance = vec![[0.0; 3]; baked.geometry.positions.len()];
    let count = radiance.len() as f64;
    let seconds =
        median_seconds(5, || cpu::shade_vector(&surface, black_box(&light), transfer.order, black_box(&mut radiance)));
    rows.push(row(
        "shade on the CPU, n = 5",
        format!("{:.1} ns", seconds / count * 1e9),
        "one vertex, three channels".into(),
    ));
    let view = View::new(whole(mesh), 1024, 1024, 1)?;
    let seconds = median_seconds(1, || {
        black_box(cpu::render(&surface, &light, transfer.order, black_box(&view)).is_ok());
    });
    rows.push(row("frame of 1024² on the CPU", format!("{:.0} ms", seconds * 1e3), "shading and rasterising".into()));
    Ok(())
}

/// A parallel view along −z that shows the whole mesh.
fn whole(mesh: &Mesh) -> [[f32; 4]; 4] {
    let [lower, upper] = mesh.bounds();
    let scale = [0, 1, 2].map(|axis| 2.0 / (upper[axis] - lower[axis]) as f32);
    let center = [0, 1, 2].map(|axis| (0.5 * (lower[axis] + upper[axis])) as f32);
    let (s, c) = (scale, center);
    [
        [s[0], 0.0, 0.0, 0.0],
        [0.0, s[1], 0.0, 0.0],
        [0.0, 0.0, -0.5 * s[2], 0.0],
        [-s[0] * c[0], -s[1] * c[1], 0.5 + 0.5 * s[2] * c[2], 1.0],
    ]
}

fn row(what: &str, time: String, rate: String) -> Vec<String> {
    vec![what.to_owned(), time, rate]
}
