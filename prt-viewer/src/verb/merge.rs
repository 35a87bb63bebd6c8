use std::path::{Path, PathBuf};

use prt_bake::merge_parts;
use serde::Serialize;

use crate::laps::Laps;
use crate::progress_bar::BakeBar;
use crate::{arguments, cancel, memory, output, output_file};

/// Puts together what `prt bake --part` baked in parts
///
/// The result has the same bytes as one bake of the whole. Bounces are followed here, so that all machines of a farm have to do is trace. The
/// scene itself is not needed.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// All parts, in any order
    #[arg(required = true, value_name = "PART")]
    parts: Vec<PathBuf>,
    /// The baked file
    #[arg(short, long, value_name = "OUT.prt")]
    output: PathBuf,
    /// Threads; by default all
    #[arg(long, value_name = "COUNT", value_parser = arguments::threads)]
    threads: Option<usize>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Report {
    parts: usize,
    output: String,
    vertices: usize,
    rays_traced: u64,
    bounces: usize,
    bounce_energy: Vec<f64>,
    error: Option<f64>,
    seconds: f64,
    peak_memory_bytes: Option<u64>,
    output_bytes: u64,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let laps = Laps::start();
    output_file::check(&arguments.output)?;
    arguments.parts.iter().try_for_each(|part| output_file::check_differs(&arguments.output, part))?;
    cancel::listen()?;
    let merged = merge(&arguments.parts, &arguments.output, arguments.threads)?;
    let report = Report {
        parts: arguments.parts.len(),
        output: arguments.output.display().to_string(),
        vertices: merged.bake.vertices.len(),
        rays_traced: merged.bake.rays_traced,
        bounces: merged.bake.bounce_energy.len(),
        bounce_energy: merged.bake.bounce_energy,
        error: merged.bake.error,
        seconds: laps.total(),
        peak_memory_bytes: memory::peak_bytes(),
        output_bytes: merged.bytes,
    };
    output::result(arguments.json, &report, || summary(&report))
}

/// Merges with a progress bar.
fn merge(parts: &[PathBuf], output: &Path, threads: Option<usize>) -> anyhow::Result<prt_bake::FileReport> {
    let bar = BakeBar::new();
    let merged = merge_parts(parts, output, threads, &bar);
    bar.finish();
    Ok(merged?)
}

fn summary(report: &Report) -> String {
    format!(
        "{} parts, {} vertices, {} bounces\nwrote {} ({}) after {:.2} s",
        report.parts,
        output::count(report.vertices as u64),
        report.bounces,
        report.output,
        output::bytes(report.output_bytes),
        report.seconds
    )
}
