//! Diffuse transfer of an opaque patch: shadowed, then interreflected.

use super::PatchReport;
use super::direct::{DirectPass, Found};
use super::field::HeightField;
use super::options::PatchOptions;
use super::surface::Surface;
use crate::diffuse::InsidePlan;
use crate::job::{Blocks, HitLists, Journal, Reflector};
use crate::parallel::Threads;
use crate::sampling::DirectionSet;
use crate::transfer::unshadowed_vector;
use crate::{Error, Pass, Progress, TransferVectors};

/// A field made ready for tracing, with all that its bakes share.
#[derive(Debug)]
pub(super) struct Opaque<'a> {
    pub(super) field: &'a HeightField,
    pub(super) options: &'a PatchOptions,
    pub(super) surface: Surface,
    pub(super) directions: DirectionSet,
    pub(super) normals: Vec<[f32; 3]>,
    pub(super) threads: Threads,
}

impl<'a> Opaque<'a> {
    pub(super) fn new(field: &'a HeightField, options: &'a PatchOptions) -> Result<Self, Error> {
        Ok(Self {
            field,
            options,
            surface: Surface::new(field),
            directions: DirectionSet::new(2 * options.rays_per_texel, options.order, options.seed),
            normals: (0..field.texel_count()).map(|texel| field.normal(texel)).collect(),
            threads: Threads::new(options.threads)?,
        })
    }

    fn blocks(&self) -> Blocks {
        Blocks::of(self.field.texel_count(), self.options.rays_per_texel)
    }

    pub(super) fn direct<'b>(&'b self, directions: &'b DirectionSet) -> DirectPass<'b> {
        DirectPass { surface: &self.surface, directions, normals: &self.normals, heights: self.field.heights() }
    }

    /// Diffuse transfer after some bounces, `[H·W, C, n²]`.
    pub(super) fn diffuse(
        &self,
        bounces: usize,
        progress: &dyn Progress,
        report: &mut PatchReport,
    ) -> Result<TransferVectors, Error> {
        let journal = Journal::in_memory();
        self.trace(bounces > 0, &journal, progress, report)?;
        let triangles = self.field.tile_triangles();
        let reflector = Reflector {
            journal: &journal,
            triangles: &triangles,
            blocks: self.blocks(),
            channels: if bounces > 0 { self.options.channel_count() } else { 1 },
            order: self.options.order,
            bounces,
            threshold: None,
            inside: &InsidePlan::default(),
            threads: &self.threads,
        };
        report.bounce_energy.extend(reflector.reflect(progress)?);
        reflector.total(bounces)
    }

    /// Writes down direct transfer, and where light may come from after a reflection if that is asked for.
    fn trace(
        &self,
        keep_hits: bool,
        journal: &Journal,
        progress: &dyn Progress,
        report: &mut PatchReport,
    ) -> Result<(), Error> {
        let blocks = self.blocks();
        let pass = self.direct(&self.directions);
        progress.start(Pass::Texels, self.field.texel_count());
        let numbers: Vec<u32> = (0..blocks.count()).collect();
        self.threads.for_each_block(&numbers, progress, Found::default, |found, &block| {
            let texels = blocks.vertices(block);
            let (mut rows, mut hits, mut stats) = (Vec::new(), HitLists::default(), Vec::new());
            for texel in texels.clone() {
                rows.extend(pass.diffuse_vector(texel, found).into_iter().map(|sum| sum as f32));
                hits.push(if keep_hits { found.records(self.options.albedo) } else { Vec::new() });
                stats.push(found.stats());
            }
            journal.append_hits(block, &hits)?;
            journal.append_stats(0, block, &stats)?;
            journal.append_rows(0, block, &rows)?;
            Ok((texels.len(), stats.iter().map(|stats| u64::from(stats.rays)).sum()))
        })?;
        let stats = journal.all_stats(0, blocks, 0..blocks.count())?;
        report.add_rays(stats.iter().map(|stats| (u64::from(stats.rays), u64::from(stats.occluded))));
        Ok(())
    }

    /// Bakes some texels twice, with two rotations of the directions: independent results differ by √2 times the error of one.
    ///
    /// - `bake`: a texel's transfer of direct light
    /// - `unshadowed`: the same without shadows
    pub(super) fn estimate_error(
        &self,
        bake: impl Fn(&DirectPass, usize) -> Vec<f64>,
        unshadowed: impl Fn(usize) -> Vec<f64>,
    ) -> f64 {
        let seed = self.options.seed.wrapping_add(0x5bd1_e995);
        let others = DirectionSet::new(2 * self.options.rays_per_texel, self.options.order, seed);
        let [first, second] = [&self.directions, &others].map(|directions| self.direct(directions));
        let texels = self.field.texel_count();
        let (mut difference, mut signal) = (0.0, 0.0);
        for texel in (0..texels).step_by(texels.div_ceil(ERROR_SAMPLES)) {
            let pairs = bake(&first, texel).into_iter().zip(bake(&second, texel));
            difference += pairs.map(|(a, b)| (a - b).powi(2)).sum::<f64>();
            signal += unshadowed(texel).iter().map(|value| value * value).sum::<f64>();
        }
        (0.5 * difference / signal.max(f64::MIN_POSITIVE)).sqrt()
    }

    /// The error of diffuse direct transfer.
    pub(super) fn diffuse_error(&self) -> f64 {
        let bake = |pass: &DirectPass, texel: usize| pass.diffuse_vector(texel, &mut Found::default());
        self.estimate_error(bake, |texel| {
            let mut exact = vec![0.0; self.options.order.coeff_count()];
            unshadowed_vector(self.options.order, self.normals[texel], &mut exact);
            exact
        })
    }
}

/// Texels at which the error is estimated.
const ERROR_SAMPLES: usize = 64;
