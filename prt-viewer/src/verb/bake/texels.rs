//! Baking the texels that the texture coordinates of a mesh lay out.

use std::path::{Path, PathBuf};

use anyhow::ensure;
use prt_bake::{Source, TexelOptions, TexelReport, TexelTransfer, bake_texels};
use serde::Serialize;

use super::Arguments;
use crate::arguments::Size;
use crate::laps::Laps;
use crate::progress_bar::BakeBar;
use crate::{cancel, memory, output, output_file};

#[derive(Debug, Serialize)]
struct Report {
    scene: String,
    output: String,
    width: usize,
    height: usize,
    vertices: usize,
    triangles: usize,
    order: usize,
    channels: usize,
    texels_inside: usize,
    texels_border: usize,
    texels_filled: usize,
    texels_empty: usize,
    texels_overlapping: usize,
    texels_invalid: usize,
    faces_degenerate: usize,
    faces_wrapped: usize,
    faces_without_center: usize,
    texels_per_face: usize,
    seam_edges: usize,
    seam_error: f64,
    seam_max: f64,
    rays_per_texel: usize,
    rays_traced: u64,
    bounces: usize,
    error: Option<f64>,
    seed: u64,
    threads: usize,
    seconds: Seconds,
    peak_memory_bytes: Option<u64>,
    output_bytes: u64,
}

#[derive(Debug, Serialize)]
struct Seconds {
    load: f64,
    build: f64,
    trace: f64,
    write: f64,
    total: f64,
}

pub(super) fn run(arguments: &Arguments, scene: &Path, size: Size) -> anyhow::Result<()> {
    if arguments.keeping.is_asked_for() {
        return Err(output::usage("--resume, --restart, --update and --part are for vertices, not for --texels"));
    }
    if arguments.effort.has_time() {
        return Err(output::usage("--time is for vertices, not for --texels"));
    }
    let mut laps = Laps::start();
    let output = arguments.output.clone().unwrap_or_else(|| super::default_output(scene).with_extension("exr"));
    let is_exr = output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr"));
    ensure!(is_exr, "cannot write {}: the texels of a mesh are written as .exr", output.display());
    output_file::check(&output)?;
    output_file::check_differs(&output, scene)?;
    cancel::listen()?;
    arguments.keeping.lower_priority()?;
    let (mesh, _) = super::load(arguments, scene)?;
    let source = Source::of_file(scene)?;
    let load = laps.lap();
    let texels = options(arguments, scene, size);
    let (options, _) = super::decide(arguments, &mesh, None, &scene.display().to_string())?;
    let bar = BakeBar::new();
    let baked = bake_texels(&mesh, &options, &texels, &bar);
    bar.finish();
    let (mut atlas, found) = baked.map_err(|error| super::name_file(error, &scene.display()))?;
    atlas.metadata.source = Some(source);
    cancel::check()?;
    laps.lap();
    let output_bytes = atlas.write_exr(&output)?;
    let seconds = Seconds {
        load,
        build: found.build.as_secs_f64(),
        trace: found.trace.as_secs_f64(),
        write: laps.lap(),
        total: laps.total(),
    };
    let counts = [mesh.positions().len(), mesh.triangles().len()];
    let report = report(arguments, [scene.to_owned(), output], counts, &atlas, &found, seconds, output_bytes);
    output::result(arguments.json, &report, || summary(&report))
}

/// In glTF the first row of a texture is v = 0, in all other formats v = 1.
fn options(arguments: &Arguments, scene: &Path, size: Size) -> TexelOptions {
    let extension = scene.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    let is_gltf = ["gltf", "glb"].iter().any(|gltf| extension.eq_ignore_ascii_case(gltf));
    TexelOptions { width: size.width as usize, height: size.height as usize, gutter: arguments.gutter, v_up: !is_gltf }
}

fn report(
    arguments: &Arguments,
    [scene, output]: [PathBuf; 2],
    [vertices, triangles]: [usize; 2],
    atlas: &TexelTransfer,
    found: &TexelReport,
    seconds: Seconds,
    output_bytes: u64,
) -> Report {
    let TexelReport {
        texels_inside,
        texels_border,
        texels_filled,
        texels_empty,
        texels_overlapping,
        texels_invalid,
        faces_degenerate,
        faces_wrapped,
        faces_without_center,
        texels_per_face,
        seam_edges,
        seam_error,
        seam_max,
        rays_traced,
        error,
        threads,
        ..
    } = *found;
    Report {
        scene: scene.display().to_string(),
        output: output.display().to_string(),
        width: atlas.width,
        height: atlas.height,
        vertices,
        triangles,
        order: atlas.transfer.order.get(),
        channels: atlas.transfer.channels,
        texels_inside,
        texels_border,
        texels_filled,
        texels_empty,
        texels_overlapping,
        texels_invalid,
        faces_degenerate,
        faces_wrapped,
        faces_without_center,
        texels_per_face,
        seam_edges,
        seam_error,
        seam_max,
        rays_per_texel: atlas.metadata.rays,
        rays_traced,
        bounces: atlas.metadata.bounces,
        error,
        seed: arguments.seed,
        threads,
        seconds,
        peak_memory_bytes: memory::peak_bytes(),
        output_bytes,
    }
}

fn summary(report: &Report) -> String {
    let count = |number: usize| output::count(number as u64);
    let overlapping = match report.texels_overlapping {
        0 => String::new(),
        texels => format!("\n{} texels lie in several faces: charts overlap", count(texels)),
    };
    format!(
        "{}x{} texels: {} on faces, {} at borders, {} filled, {} empty{overlapping}\n\
         {} seam edges, difference {:.2} %\n{} rays in {:.2} s, error about {:.2} %\nwrote {} ({}) after {:.2} s",
        report.width,
        report.height,
        count(report.texels_inside),
        count(report.texels_border),
        count(report.texels_filled),
        count(report.texels_empty),
        count(report.seam_edges),
        100.0 * report.seam_error,
        output::count(report.rays_traced),
        report.seconds.trace,
        100.0 * report.error.unwrap_or(0.0),
        report.output,
        output::bytes(report.output_bytes),
        report.seconds.total
    )
}
