//! Transfer of the points that texels stand for.

use super::layout::Layout;
use super::points::Points;
use super::raster::{NO_FACE, Raster};
use crate::diffuse::{Bounces, DirectPass, DirectScratch, HitRecord, estimate_error};
use crate::parallel::Threads;
use crate::sampling::DirectionSet;
use crate::{BakeOptions, Error, Pass, Progress, Scene, TransferVectors, VertexStats};

/// Texels whose points are held at one time.
const BLOCK: usize = 1 << 14;

/// Texels at which the error is estimated.
const ERROR_SAMPLES: usize = 64;

/// All that the texels of one bake share.
#[derive(Debug)]
pub(super) struct TexelBake<'a> {
    pub(super) layout: &'a Layout<'a>,
    pub(super) raster: &'a Raster,
    pub(super) scene: &'a Scene,
    pub(super) directions: &'a DirectionSet,
    pub(super) shadowed: bool,
    /// What vertices send out.
    pub(super) bounces: Option<Bounces<'a>>,
}

/// Memory that a thread uses again for each texel.
struct Scratch {
    direct: DirectScratch,
    vector: Vec<f32>,
    hits: Vec<HitRecord>,
    /// What arrives after reflections, `[C, n²]`.
    gathered: Vec<f64>,
}

/// Sums of [`VertexStats`] over texels.
#[derive(Debug, Default)]
pub(super) struct StatsSum {
    pub(super) directions: u64,
    pub(super) occluded: u64,
    pub(super) rays: u64,
}

impl StatsSum {
    fn add(&mut self, stats: &VertexStats) {
        self.directions += u64::from(stats.directions);
        self.occluded += u64::from(stats.occluded);
        self.rays += u64::from(stats.rays);
    }
}

impl TexelBake<'_> {
    pub(super) fn run(
        &self,
        threads: &Threads,
        progress: &dyn Progress,
        transfer: &mut TransferVectors,
    ) -> Result<StatsSum, Error> {
        let row_length = transfer.channels * transfer.order.coeff_count();
        progress.start(Pass::Direct, self.raster.faces.iter().filter(|&&face| face != NO_FACE).count());
        let mut sum = StatsSum::default();
        for (block, values) in transfer.values.chunks_mut(BLOCK * row_length).enumerate() {
            let texels = block * BLOCK..block * BLOCK + values.len() / row_length;
            let points = self.points(texels.clone());
            let rows = values.chunks_exact_mut(row_length).zip(&self.raster.faces[texels]);
            let rows = rows.filter(|&(_, &face)| face != NO_FACE).map(|(row, _)| row);
            let mut items: Vec<_> = rows.map(|row| (row, VertexStats::default())).collect();
            let direct = self.direct(&points);
            threads.for_each(
                &mut items,
                progress,
                || self.scratch(&direct, row_length),
                |scratch, point, (row, stats)| {
                    *stats = self.texel(&direct, scratch, point, row);
                    u64::from(stats.rays)
                },
            )?;
            items.iter().for_each(|(_, stats)| sum.add(stats));
        }
        Ok(sum)
    }

    fn points(&self, texels: impl IntoIterator<Item = usize>) -> Points {
        let with_face = texels.into_iter().map(|texel| (texel, self.raster.faces[texel]));
        Points::new(self.layout, self.scene, with_face.filter(|&(_, face)| face != NO_FACE))
    }

    fn direct<'b>(&'b self, points: &'b Points) -> DirectPass<'b> {
        DirectPass {
            scene: self.scene,
            directions: self.directions,
            normals: &points.normals,
            origins: &points.origins,
        }
    }

    fn scratch(&self, direct: &DirectPass, row_length: usize) -> Scratch {
        Scratch {
            direct: direct.scratch(),
            vector: vec![0.0; self.directions.order.coeff_count()],
            hits: Vec::new(),
            gathered: vec![0.0; row_length],
        }
    }

    /// The transfer of one texel, `[C, n²]`.
    fn texel(&self, direct: &DirectPass, scratch: &mut Scratch, point: usize, row: &mut [f32]) -> VertexStats {
        if !self.shadowed {
            let unshadowed = TransferVectors::unshadowed(self.directions.order, &direct.normals[point..=point]);
            row.copy_from_slice(&unshadowed.values);
            return VertexStats::default();
        }
        let mut stats = direct.shadowed_vector(&mut scratch.direct, point, &mut scratch.vector);
        if let Some(bounces) = &self.bounces {
            scratch.hits.clear();
            stats.rays += direct.nearest_hits(&mut scratch.direct, point, &mut scratch.hits);
            bounces.gather(&scratch.hits, &mut scratch.gathered);
        }
        let direct = scratch.vector.iter().cycle();
        let sums = direct.zip(&scratch.gathered).map(|(&direct, &gathered)| (f64::from(direct) + gathered) as f32);
        row.iter_mut().zip(sums).for_each(|(value, sum)| *value = sum);
        stats
    }

    /// As for vertices, from some texels that are spread evenly.
    pub(super) fn estimate_error(&self, options: &BakeOptions) -> f64 {
        let faces = self.raster.faces.iter().enumerate();
        let covered: Vec<usize> = faces.filter(|&(_, &face)| face != NO_FACE).map(|(texel, _)| texel).collect();
        let points = self.points(covered.iter().copied().step_by(covered.len().div_ceil(ERROR_SAMPLES)));
        let direct = self.direct(&points);
        let mut transfer = TransferVectors::zero(points.normals.len(), 1, options.order);
        let mut scratch = direct.scratch();
        for (point, row) in transfer.values.chunks_exact_mut(options.order.coeff_count()).enumerate() {
            direct.shadowed_vector(&mut scratch, point, row);
        }
        estimate_error(&direct, options, &transfer)
    }
}
