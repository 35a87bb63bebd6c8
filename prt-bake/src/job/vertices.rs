//! Bakes of the vertices of a mesh.

use std::time::Instant;

use super::blocks::Blocks;
use super::header::Header;
use super::journal::Journal;
use super::reflect::Reflector;
use super::stages::{Baked, Job};
use super::target::{BakeTarget, FileReport, into_file};
use super::{Part, trace};
use crate::diffuse::{InsidePlan, unshadowed};
use crate::parallel::Threads;
use crate::{
    BakeOptions, BakeReport, BakedSurface, Error, Geometry, Mesh, Metadata, Progress, Source, TransferVectors,
    VertexStats,
};

/// Bakes with a journal in memory.
pub(crate) fn bake_in_memory(
    mesh: &Mesh,
    options: &BakeOptions,
    progress: &dyn Progress,
) -> Result<(BakedSurface, BakeReport), Error> {
    let journal = Journal::in_memory();
    let mut job = VertexJob::new(Header::new(mesh, options, Part::whole()), mesh, options, Part::whole(), progress)?;
    job.trace(&journal)?;
    job.finish(&journal, None)
}

/// Bakes diffuse transfer into a file, as [`bake_diffuse`](crate::bake_diffuse) does, and keeps on disk what is done.
///
/// Every block of 16 vertices is written to a journal when it is done, the hits for interreflection too, so that memory holds the mesh,
/// the tree and once the output, and little else. A bake that is killed or cancelled goes on with
/// [`Unfinished::Resume`](super::Unfinished::Resume); the file has
/// the same bytes as one baked in one go. A part is merged with the others by [`merge_parts`](super::merge_parts).
///
/// # Errors
/// As [`bake_diffuse`](crate::bake_diffuse); if a file cannot be read or written; if there is an unfinished bake and
/// [`BakeTarget::unfinished`] refuses it, or it belongs to another mesh or other options.
pub fn bake_to_file(
    mesh: &Mesh,
    options: &BakeOptions,
    target: &BakeTarget,
    progress: &dyn Progress,
) -> Result<FileReport, Error> {
    options.validate()?;
    let part = target.share();
    into_file(VertexJob::new(Header::new(mesh, options, part), mesh, options, part, progress)?, target)
}

/// A bake of vertices.
pub(super) struct VertexJob<'a> {
    mesh: &'a Mesh,
    options: &'a BakeOptions,
    part: Part,
    header: Header,
    threads: Threads,
    progress: &'a dyn Progress,
    report: BakeReport,
}

impl<'a> VertexJob<'a> {
    pub(super) fn new(
        header: Header,
        mesh: &'a Mesh,
        options: &'a BakeOptions,
        part: Part,
        progress: &'a dyn Progress,
    ) -> Result<Self, Error> {
        let threads = Threads::new(options.threads)?;
        Ok(Self { mesh, options, part, header, threads, progress, report: BakeReport::default() })
    }
}

impl Job for VertexJob<'_> {
    type Baked = BakedSurface;

    fn header(&self) -> &Header {
        &self.header
    }

    fn trace(&mut self, journal: &Journal) -> Result<(), Error> {
        let Self { mesh, options, part, ref threads, progress, ref mut report, .. } = *self;
        if !options.shadowed {
            return Ok(());
        }
        let start = Instant::now();
        report.threads = threads.count();
        trace::trace(mesh, options, part, journal, threads, progress, report)?;
        report.trace = start.elapsed().saturating_sub(report.build);
        let blocks = Blocks::of(mesh.positions().len(), options.rays_per_vertex);
        report.count(options, journal.all_stats(0, blocks, part.blocks(blocks.count()))?);
        Ok(())
    }

    fn surface(&self, source: Option<&Source>) -> Result<Vec<u8>, Error> {
        let surface = BakedSurface {
            metadata: Metadata { source: source.cloned(), ..Metadata::default() },
            geometry: Geometry::of(self.mesh),
            transfer: TransferVectors::unshadowed(sh_core::Order::new(1).expect("1 is an order"), self.mesh.normals()),
            transfer_shadowed: None,
            validity: None,
        };
        surface.to_bytes()
    }

    fn finish(self, journal: &Journal, source: Option<&Source>) -> Result<(BakedSurface, BakeReport), Error> {
        let Self { mesh, options, header, threads, progress, mut report, .. } = self;
        let mut baked = if options.shadowed {
            finished(Geometry::of(mesh), &header, options, journal, &threads, progress, &mut report)?
        } else {
            unshadowed(mesh, options)
        };
        baked.complete(&header, source);
        Ok((baked, report))
    }

    fn into_report(self) -> BakeReport {
        self.report
    }
}

/// Adds the bounces to a journal that has all direct light, and puts the surface together.
pub(super) fn finished(
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
