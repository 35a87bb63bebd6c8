//! A bake in blocks of vertices, each written down when it is done: what stops half-way goes on from there, and parts that were baked
//! apart are put together. However a bake was cut up, its result has the same bytes.

mod block;
mod blocks;
mod header;
mod info;
mod journal;
mod merge;
mod part;
mod reflect;
mod target;
mod trace;

use std::time::Instant;

use crate::diffuse::InsidePlan;
use crate::parallel::Threads;
use crate::{BakeOptions, BakeReport, BakedSurface, Error, Geometry, Mesh, Metadata, Progress, Savings, VertexStats};

pub(crate) use block::HitLists;
pub(crate) use blocks::Blocks;
use header::Header;
pub use info::{JournalInfo, journal_info};
pub(crate) use journal::Journal;
pub use journal::is_journal;
pub use merge::merge_parts;
pub use part::Part;
pub(crate) use reflect::Reflector;
pub use target::{BakeTarget, FileReport, Unfinished, bake_to_file};

/// Bakes with a journal in memory.
pub(crate) fn bake_in_memory(
    mesh: &Mesh,
    options: &BakeOptions,
    progress: &dyn Progress,
) -> Result<(BakedSurface, BakeReport), Error> {
    let threads = Threads::new(options.threads)?;
    let journal = Journal::in_memory();
    let mut report = BakeReport::default();
    traced(mesh, options, Part::whole(), &journal, &threads, progress, &mut report)?;
    let header = Header::new(mesh, options, Part::whole());
    let baked = finished(Geometry::of(mesh), &header, options, &journal, &threads, progress, &mut report)?;
    Ok((baked, report))
}

/// Traces from all vertices of a part, but for those that are in the journal.
fn traced(
    mesh: &Mesh,
    options: &BakeOptions,
    part: Part,
    journal: &Journal,
    threads: &Threads,
    progress: &dyn Progress,
    report: &mut BakeReport,
) -> Result<(), Error> {
    let start = Instant::now();
    report.threads = threads.count();
    trace::trace(mesh, options, part, journal, threads, progress, report)?;
    report.trace = start.elapsed().saturating_sub(report.build);
    let blocks = Blocks::of(mesh.positions().len(), options.rays_per_vertex);
    count(report, options, journal.all_stats(blocks, part.blocks(blocks.count()))?);
    Ok(())
}

/// Adds the bounces to a journal that has all direct light, and puts the surface together.
fn finished(
    geometry: Geometry,
    header: &Header,
    options: &BakeOptions,
    journal: &Journal,
    threads: &Threads,
    progress: &dyn Progress,
    report: &mut BakeReport,
) -> Result<BakedSurface, Error> {
    let start = Instant::now();
    let triangles = &geometry.triangles;
    let &BakeOptions { order, bounces, bounce_threshold: threshold, .. } = options;
    let inside = &inside_plan(&geometry, options, &report.vertices);
    let reflector = Reflector {
        journal,
        triangles,
        blocks: header.blocks(),
        channels: header.channels,
        order,
        bounces,
        threshold,
        inside,
        threads,
    };
    report.bounce_energy = reflector.reflect(progress)?;
    let bounces = report.bounce_energy.len();
    let is_kept = options.keep_shadowed && bounces > 0;
    let transfer_shadowed = is_kept.then(|| reflector.direct()).transpose()?;
    let transfer = reflector.total(bounces)?;
    report.trace += start.elapsed();
    let metadata = Metadata {
        rays: options.rays_per_vertex,
        bounces,
        seed: options.seed,
        shadowed: true,
        error: report.error,
        target_error: options.target_error,
        identity: Some(header.identity()),
        ..Metadata::default()
    };
    let validity = Some(report.vertices.iter().map(|stats| stats.validity).collect());
    Ok(BakedSurface { metadata, geometry, transfer, transfer_shadowed, validity })
}

/// What becomes of the vertices inside of solids. Positions are those of the file, for that is all that merging has.
fn inside_plan(geometry: &Geometry, options: &BakeOptions, vertices: &[VertexStats]) -> InsidePlan {
    let positions: Vec<[f64; 3]> = geometry.positions.iter().map(|position| position.map(f64::from)).collect();
    let is_valid: Vec<bool> = vertices.iter().map(VertexStats::is_valid).collect();
    InsidePlan::new(options.inside, &geometry.triangles, &positions, &is_valid)
}

/// Takes down what was found at the vertices.
fn count(report: &mut BakeReport, options: &BakeOptions, vertices: Vec<VertexStats>) {
    let sum = |count: fn(&VertexStats) -> u32| vertices.iter().map(|stats| u64::from(count(stats))).sum::<u64>();
    report.rays_traced = sum(|stats| stats.rays);
    report.occluded_share = sum(|stats| stats.occluded) as f64 / (sum(|stats| stats.directions) as f64).max(1.0);
    let errors = vertices.iter().map(|stats| f64::from(stats.error)).filter(|error| !error.is_nan());
    let (count, squares) = errors.fold((0_u32, 0.0), |(count, sum), error| (count + 1, sum + error * error));
    report.error = (count > 0).then(|| (squares / f64::from(count)).sqrt());
    report.invalid_vertices = vertices.iter().filter(|stats| !stats.is_valid()).count();
    report.savings = Savings::of(options, &vertices);
    report.vertices = vertices;
}

#[cfg(test)]
mod tests;
