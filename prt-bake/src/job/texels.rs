//! Bakes of the texels of an atlas.

use std::time::Instant;

use super::block::TEXELS;
use super::header::Header;
use super::journal::Journal;
use super::stages::{Baked, Job};
use super::target::{BakeTarget, FileReport, into_file};
use super::vertices::VertexJob;
use super::{Blocks, Part};
use crate::parallel::Threads;
use crate::texels::{AtlasPlan, Finish, LaidOut, TexelScratch, TexelTracer};
use crate::{
    BakeOptions, BakeReport, BakedSurface, Error, Mesh, Metadata, Pass, Progress, Scene, Source, TexelOptions,
    TexelReport, TexelTransfer, TransferVectors, VertexStats,
};

/// Bakes diffuse transfer for every texel of an atlas that the texture coordinates of a mesh lay out.
///
/// A texel whose centre lies on a face holds the transfer of the point of the surface there: its position and its smooth normal are
/// interpolated, and rays start outside of the face, above it where the smooth normals make it bulge, so that the edges of a coarse mesh do
/// not show in its own shadow. Texels that a bilinear lookup on a face can read but whose
/// centre lies outside of the chart hold the transfer of the surface as far beyond the chart's edge, so that lookups on both sides of a
/// cut agree; where the surface ends or has a crease, that of the face's nearest point. Where faces overlap, the one with the lowest number is
/// baked; of a two-sided face its front is. Faces may be mirrored. Where faces leave 0 to 1 the atlas wraps round, as textures do.
///
/// Shadowed transfer is that of [`bake_diffuse`](crate::bake_diffuse) at these points. With `b` bounces the vertices are baked first, with
/// `b − 1` of them, and each texel gathers from its own hits what the vertices' transfer sends there (final gathering):
/// `T(p) = T_direct(p) + Σ w ρ(q) T(q)`. Texels inside of solids are treated as [`BakeOptions::inside`] says; filled ones count as empty,
/// and the gutter reaches into them.
///
/// The report is about the texels; [`TexelReport`] has what is of the atlas, and of the vertices that it gathers from.
///
/// Cost: as many rays as that number of vertices. Memory: twice the atlas, about 40 bytes for each texel that is baked, the mesh and its tree;
/// while the vertices are baked what that takes. Same options, same bytes, for any number of threads.
///
/// # Errors
/// [`Error::Option`] if an option is out of range, the result would be larger than [`TexelOptions::MAX_VALUES`], or `keep_shadowed` is set;
/// [`Error::Atlas`] if the mesh has no texture coordinates, they are not finite, a texture would repeat over a face, or no face has an
/// area; [`Error::Cancelled`].
pub fn bake_texels(
    mesh: &Mesh,
    options: &BakeOptions,
    texels: &TexelOptions,
    progress: &dyn Progress,
) -> Result<(TexelTransfer, BakeReport), Error> {
    let journal = Journal::in_memory();
    let mut job = TexelJob::new(mesh, options, texels, Part::whole(), progress)?;
    job.trace(&journal)?;
    job.finish(&journal, None)
}

/// Bakes an atlas into an OpenEXR image, as [`bake_texels`] does, and keeps on disk what is done, as
/// [`bake_to_file`](super::bake_to_file) does.
///
/// A part is a share of the texels; with bounces every part bakes all of the vertices, which are few where texels are worth their while.
///
/// # Errors
/// As [`bake_texels`] and [`bake_to_file`](super::bake_to_file).
pub fn bake_texels_to_file(
    mesh: &Mesh,
    options: &BakeOptions,
    texels: &TexelOptions,
    target: &BakeTarget,
    progress: &dyn Progress,
) -> Result<FileReport, Error> {
    into_file(TexelJob::new(mesh, options, texels, target.share(), progress)?, target)
}

/// A bake of texels.
struct TexelJob<'a> {
    mesh: &'a Mesh,
    options: &'a BakeOptions,
    part: Part,
    header: Header,
    laid_out: LaidOut<'a>,
    threads: Threads,
    progress: &'a dyn Progress,
    report: BakeReport,
    /// The bake of the vertices that texels gather from.
    gathered: Option<Box<BakeReport>>,
}

impl<'a> TexelJob<'a> {
    fn new(
        mesh: &'a Mesh,
        options: &'a BakeOptions,
        texels: &TexelOptions,
        part: Part,
        progress: &'a dyn Progress,
    ) -> Result<Self, Error> {
        options.validate()?;
        if options.keep_shadowed {
            return Err(Error::Option("texels hold one transfer; bake twice to keep the shadowed one".to_owned()));
        }
        let start = Instant::now();
        let laid_out = LaidOut::new(mesh, options, texels, progress)?;
        let header = Header::new(mesh, options, part).with_texels(texels, laid_out.texels.len());
        let report = BakeReport { build: start.elapsed(), ..BakeReport::default() };
        let threads = Threads::new(options.threads)?;
        Ok(Self { mesh, options, part, header, laid_out, threads, progress, report, gathered: None })
    }

    /// What the vertices send out, if texels are to gather it: their transfer with one bounce less than the texels get.
    fn vertices(&mut self, journal: &Journal) -> Result<Option<BakedSurface>, Error> {
        let Some(bounces) = self.options.bounces.checked_sub(1) else { return Ok(None) };
        let options = BakeOptions { bounces, ..self.options.clone() };
        let header = self.header.of_gathered(&options, self.mesh);
        let mut job = VertexJob::new(header, self.mesh, &options, Part::whole(), self.progress)?;
        job.trace(journal)?;
        let (baked, report) = job.finish(journal, None)?;
        self.gathered = Some(Box::new(report));
        self.laid_out.plan.head.bounces = baked.metadata.bounces + 1;
        Ok(Some(baked))
    }

    /// Traces from the texels of some blocks.
    fn trace_blocks(
        &mut self,
        missing: &[u32],
        vertices: Option<&BakedSurface>,
        journal: &Journal,
    ) -> Result<(), Error> {
        let start = Instant::now();
        let Self { laid_out, options, threads, progress, .. } = self;
        let scene = Scene::new(laid_out.mesh());
        let arriving = vertices.map(|baked| &baked.transfer);
        let tracer = TexelTracer::new(laid_out, &scene, options, arriving, self.header.channels);
        self.report.build += start.elapsed();
        let blocks = self.header.blocks();
        let start = Instant::now();
        threads.for_each_block(missing, *progress, TexelScratch::default, |scratch, &block| {
            let (rows, stats) = tracer.block(scratch, blocks.vertices(block), *progress)?;
            journal.append_stats(TEXELS, block, &stats)?;
            journal.append_rows(TEXELS, block, &rows)?;
            Ok((stats.len(), stats.iter().map(|stats| u64::from(stats.rays)).sum()))
        })?;
        self.report.trace = start.elapsed();
        Ok(())
    }
}

impl Job for TexelJob<'_> {
    type Baked = TexelTransfer;

    fn header(&self) -> &Header {
        &self.header
    }

    fn trace(&mut self, journal: &Journal) -> Result<(), Error> {
        self.report.threads = self.threads.count();
        let vertices = self.vertices(journal)?;
        let blocks = self.header.blocks();
        let all = self.part.blocks(blocks.count());
        let texel_count = |numbers: &[u32]| numbers.iter().map(|&block| blocks.vertices(block).len()).sum::<usize>();
        let (done, missing): (Vec<u32>, Vec<u32>) = all.clone().partition(|&block| journal.has_texels(block));
        self.report.vertices_resumed = texel_count(&done);
        self.progress.start(Pass::Texels, texel_count(&done) + texel_count(&missing));
        self.progress.advance(texel_count(&done), 0);
        if !missing.is_empty() {
            self.trace_blocks(&missing, vertices.as_ref(), journal)?;
        }
        if self.options.shadowed {
            self.report.count(self.options, journal.all_stats(TEXELS, blocks, all)?);
        }
        Ok(())
    }

    fn surface(&self, source: Option<&Source>) -> Result<Vec<u8>, Error> {
        Ok(self.laid_out.plan.to_bytes(source))
    }

    fn finish(self, journal: &Journal, source: Option<&Source>) -> Result<(TexelTransfer, BakeReport), Error> {
        let Self { options, header, laid_out, report, gathered: vertices, .. } = self;
        let (mut atlas, found) = assembled(laid_out.plan, &header, options, journal, &report)?;
        atlas.complete(&header, source);
        Ok((atlas, BakeReport { texels: Some(TexelReport { vertices, ..found }), ..report }))
    }

    fn into_report(self) -> BakeReport {
        let texels = TexelReport { vertices: self.gathered, ..TexelReport::default() };
        BakeReport { texels: Some(texels), ..self.report }
    }
}

/// Puts the atlas together from a journal that has all of its blocks.
///
/// - `report`: what was found at the texels
pub(super) fn assembled(
    plan: AtlasPlan,
    header: &Header,
    options: &BakeOptions,
    journal: &Journal,
    report: &BakeReport,
) -> Result<(TexelTransfer, TexelReport), Error> {
    let metadata = Metadata {
        rays: if options.shadowed { options.rays_per_vertex } else { 0 },
        bounces: plan.head.bounces,
        seed: options.seed,
        shadowed: options.shadowed,
        error: report.error,
        target_error: options.target_error,
        ..Metadata::default()
    };
    let texels: Vec<u32> = plan.baked().collect();
    let transfer = scattered(&texels, plan.texel_count(), header, options, journal)?;
    let is_invalid = |(_, stats): &(&u32, &VertexStats)| !stats.is_valid();
    let invalid: Vec<u32> = texels.iter().zip(&report.vertices).filter(is_invalid).map(|(&texel, _)| texel).collect();
    let finish = Finish { inside: options.inside, gutter: header.gutter(), invalid: &invalid };
    Ok(plan.finish(metadata, transfer, finish))
}

/// The transfer of the blocks at their places on the atlas, `[H · W, C, n²]`.
fn scattered(
    texels: &[u32],
    texel_count: usize,
    header: &Header,
    options: &BakeOptions,
    journal: &Journal,
) -> Result<TransferVectors, Error> {
    let mut transfer = TransferVectors::zero(texel_count, header.channels, options.order);
    let length = header.channels * options.order.coeff_count();
    let blocks: Blocks = header.blocks();
    let mut rows = Vec::new();
    for block in 0..blocks.count() {
        let numbers = blocks.vertices(block);
        rows.resize(numbers.len() * length, 0.0);
        journal.read_rows(TEXELS, block, &mut rows)?;
        for (&texel, row) in texels[numbers].iter().zip(rows.chunks_exact(length)) {
            transfer.values[texel as usize * length..][..length].copy_from_slice(row);
        }
    }
    Ok(transfer)
}
