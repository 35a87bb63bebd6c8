use std::path::{Path, PathBuf};

use anyhow::ensure;
use prt_bake::{FileReport, JournalInfo, journal_info, merge_parts};
use serde::Serialize;

use super::bake::is_exr;
use super::reporting::Reporting;
use crate::laps::Laps;
use crate::progress_bar::BakeBar;
use crate::{arguments, cancel, memory, output, output_file};

/// Puts together what `prt bake --part` baked in parts
///
/// The result has the same bytes as one bake of the whole. Bounces between vertices are followed here, so that all machines of a farm have to do
/// is trace; of an atlas every part has followed them already. The scene itself is not needed.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// All parts, in any order
    #[arg(required = true, value_name = "PART")]
    parts: Vec<PathBuf>,
    /// The baked file; OUT.exr for parts of an atlas
    #[arg(short, long, value_name = "OUT.prt")]
    output: PathBuf,
    /// Threads; by default all
    #[arg(long, value_name = "COUNT", value_parser = arguments::threads)]
    threads: Option<usize>,
    #[command(flatten)]
    reporting: Reporting,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Report {
    parts: usize,
    output: String,
    /// `null` if texels were baked.
    vertices: Option<usize>,
    vertices_invalid: Option<usize>,
    /// Texels that a point of the surface was baked for; `null` if vertices were baked.
    texels: Option<usize>,
    texels_invalid: Option<usize>,
    channels: Option<usize>,
    rays_per_vertex: usize,
    rays_traced: u64,
    occluded_share: f64,
    bounces: usize,
    bounce_energy: Vec<f64>,
    /// What becomes of vertices inside of solids.
    inside: Option<String>,
    error: Option<f64>,
    target_error: Option<f64>,
    seed: u64,
    threads: usize,
    seconds: f64,
    peak_memory_bytes: Option<u64>,
    output_bytes: u64,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let laps = Laps::start();
    let output = &arguments.output;
    output_file::check(output)?;
    let part = arguments.parts.first().map(|part| journal_info(part)).transpose()?;
    let is_atlas = part.as_ref().is_some_and(|part| part.bakes_texels);
    ensure!(
        is_exr(output) == is_atlas,
        "cannot write {}: {} are written as {}",
        output.display(),
        if is_atlas { "the texels of a mesh" } else { "vertices" },
        if is_atlas { ".exr" } else { ".prt" },
    );
    if is_atlas && arguments.reporting.is_asked_for() {
        return Err(output::usage("--report is for the vertices of meshes, not for texels"));
    }
    for part in &arguments.parts {
        output_file::check_differs(output, part)?;
        arguments.reporting.check(part, output, false)?;
    }
    cancel::listen()?;
    let merged = merge(&arguments.parts, output, arguments.threads)?;
    let report = Report::new(arguments, part.as_ref(), &merged, laps);
    let source = merged.metadata.as_ref().and_then(|metadata| metadata.source.as_ref());
    let scene = source.map_or_else(|| output::file_name(output), |source| source.name.clone());
    arguments.reporting.write(&scene, output, &merged, &report)?;
    output::result(arguments.json, &report, || report.summary())
}

impl Report {
    fn new(arguments: &Arguments, part: Option<&JournalInfo>, merged: &FileReport, laps: Laps) -> Self {
        let (bake, metadata) = (&merged.bake, merged.metadata.clone().unwrap_or_default());
        let is_atlas = bake.texels.is_some();
        let of_vertices = |count: usize| (!is_atlas).then_some(count);
        let of_texels = |count: usize| is_atlas.then_some(count);
        Self {
            parts: arguments.parts.len(),
            output: arguments.output.display().to_string(),
            vertices: of_vertices(bake.vertices.len()),
            vertices_invalid: of_vertices(bake.invalid_vertices),
            texels: of_texels(bake.vertices.len()),
            texels_invalid: of_texels(bake.invalid_vertices),
            channels: merged.channels,
            rays_per_vertex: metadata.rays,
            rays_traced: bake.rays_traced,
            occluded_share: bake.occluded_share,
            bounces: metadata.bounces,
            bounce_energy: bake.bounce_energy.clone(),
            inside: part.and_then(|part| part.settings.get("inside").cloned()),
            error: bake.error,
            target_error: metadata.target_error,
            seed: metadata.seed,
            threads: bake.threads,
            seconds: laps.total(),
            peak_memory_bytes: memory::peak_bytes(),
            output_bytes: merged.bytes,
        }
    }

    fn summary(&self) -> String {
        let what = if self.texels.is_some() { "texels" } else { "vertices" };
        let count = self.texels.or(self.vertices).unwrap_or_default();
        format!(
            "{} parts, {} {what}, {} bounces\nwrote {} ({}) after {:.2} s",
            self.parts,
            output::count(count as u64),
            self.bounces,
            self.output,
            output::bytes(self.output_bytes),
            self.seconds
        )
    }
}

/// Merges with a progress bar.
fn merge(parts: &[PathBuf], output: &Path, threads: Option<usize>) -> anyhow::Result<FileReport> {
    let bar = BakeBar::new();
    let merged = merge_parts(parts, output, threads, &bar);
    bar.finish();
    Ok(merged?)
}
