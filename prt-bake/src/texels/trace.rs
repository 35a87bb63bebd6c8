//! Transfer of the points that texels stand for.

use super::layout::Layout;
use super::points::Points;
use super::raster::{NO_FACE, Raster};
use crate::diffuse::{DirectPass, ErrorProbe, HitRecord, Ladder, Reflection, Scratch as DirectScratch, ValidityTest};
use crate::parallel::Threads;
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
    /// See [`smooth_neighbors`](super::edges::smooth_neighbors).
    pub(super) neighbors: Vec<[u32; 3]>,
    pub(super) ladder: &'a Ladder,
    pub(super) shadowed: bool,
    pub(super) validity: ValidityTest<'a>,
    /// What vertices send out.
    pub(super) reflection: Option<Reflection<'a>>,
}

/// Memory that a thread uses again for each texel.
struct Scratch {
    direct: DirectScratch,
    vector: Vec<f32>,
    hits: Vec<HitRecord>,
    /// What arrives after reflections, `[C, n²]`.
    gathered: Vec<f64>,
}

/// What was found at the texels: sums of [`VertexStats`].
#[derive(Debug, Default)]
pub(super) struct Found {
    pub(super) directions: u64,
    pub(super) occluded: u64,
    pub(super) rays: u64,
    /// Numbers of the texels that lie inside of solids.
    pub(super) invalid: Vec<usize>,
}

impl Found {
    fn add(&mut self, texel: usize, stats: &VertexStats) {
        if !stats.is_valid() {
            self.invalid.push(texel);
        }
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
    ) -> Result<Found, Error> {
        let row_length = transfer.channels * transfer.order.coeff_count();
        progress.start(Pass::Direct, self.raster.faces.iter().filter(|&&face| face != NO_FACE).count());
        let mut found = Found::default();
        for (block, values) in transfer.values.chunks_mut(BLOCK * row_length).enumerate() {
            let texels = block * BLOCK..block * BLOCK + values.len() / row_length;
            let points = self.points(texels.clone());
            let rows = texels.zip(values.chunks_exact_mut(row_length));
            let rows = rows.filter(|&(texel, _)| self.raster.faces[texel] != NO_FACE);
            let mut items: Vec<_> = rows.map(|(texel, row)| (texel, row, VertexStats::default())).collect();
            let direct = self.direct(&points);
            threads.for_each(
                &mut items,
                progress,
                || self.scratch(&direct),
                |scratch, point, (_, row, stats)| {
                    *stats = self.texel(&direct, scratch, point, row);
                    u64::from(stats.rays)
                },
            )?;
            items.iter().for_each(|(texel, _, stats)| found.add(*texel, stats));
        }
        Ok(found)
    }

    fn points(&self, texels: impl IntoIterator<Item = usize>) -> Points {
        let with_face = texels.into_iter().map(|texel| (texel, self.raster.faces[texel]));
        Points::new(self.layout, self.scene, &self.neighbors, with_face.filter(|&(_, face)| face != NO_FACE))
    }

    fn direct<'b>(&'b self, points: &'b Points) -> DirectPass<'b> {
        DirectPass {
            mesh: self.layout.mesh,
            scene: self.scene,
            ladder: self.ladder,
            normals: &points.normals,
            origins: &points.origins,
        }
    }

    fn scratch(&self, direct: &DirectPass) -> Scratch {
        Scratch {
            direct: direct.scratch(),
            vector: vec![0.0; self.ladder.order.coeff_count()],
            hits: Vec::new(),
            gathered: vec![0.0; self.ladder.order.coeff_count()],
        }
    }

    /// The transfer of one texel, `[C, n²]`.
    fn texel(&self, direct: &DirectPass, scratch: &mut Scratch, point: usize, row: &mut [f32]) -> VertexStats {
        if !self.shadowed {
            let unshadowed = TransferVectors::unshadowed(self.ladder.order, &direct.normals[point..=point]);
            row.copy_from_slice(&unshadowed.values);
            return VertexStats::default();
        }
        let mut stats = direct.shadowed_vector(&mut scratch.direct, point, &mut scratch.vector);
        self.validity.complete_at(direct.normals[point], direct.origins[point], &mut stats);
        if let Some(reflection) = &self.reflection {
            scratch.hits.clear();
            stats.rays += direct.nearest_hits(&mut scratch.direct, point, &mut scratch.hits);
            reflection.gather(&scratch.hits, &mut scratch.gathered);
        }
        let direct = scratch.vector.iter().cycle();
        let sums = direct.zip(&scratch.gathered).map(|(&direct, &gathered)| (f64::from(direct) + gathered) as f32);
        row.iter_mut().zip(sums).for_each(|(value, sum)| *value = sum);
        stats
    }

    /// As for vertices, from some texels that are spread evenly.
    pub(super) fn estimate_error(&self, options: &BakeOptions) -> f64 {
        let faces = self.raster.faces.iter().enumerate();
        let baked: Vec<usize> = faces.filter(|&(_, &face)| face != NO_FACE).map(|(texel, _)| texel).collect();
        let points = self.points(baked.iter().copied().step_by(baked.len().div_ceil(ERROR_SAMPLES)));
        let (direct, probe) = (self.direct(&points), ErrorProbe::new(options, 1));
        let mut scratch = self.scratch(&direct);
        let errors = (0..points.normals.len()).map(|point| {
            let stats = direct.shadowed_vector(&mut scratch.direct, point, &mut scratch.vector);
            let again = |probe: &ErrorProbe| probe.estimate(&direct, &mut scratch.direct, point, &scratch.vector);
            f64::from(probe.as_ref().map_or(stats.error, again))
        });
        (errors.map(|error| error * error).sum::<f64>() / points.normals.len() as f64).sqrt()
    }
}
