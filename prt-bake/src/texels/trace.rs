//! Transfer of the points that texels stand for.

use std::ops::Range;

use super::edges::smooth_neighbors;
use super::plan::LaidOut;
use super::points::Points;
use crate::diffuse::{DirectPass, ErrorProbe, HitRecord, Ladder, Reflection, Scratch as DirectScratch, ValidityTest};
use crate::{BakeOptions, Error, Progress, Scene, TransferVectors, VertexStats};

/// All that the texels of one bake share.
#[derive(Debug)]
pub(crate) struct TexelTracer<'a> {
    laid_out: &'a LaidOut<'a>,
    scene: &'a Scene,
    /// See [`smooth_neighbors`].
    neighbors: Vec<[u32; 3]>,
    ladder: Ladder,
    probe: Option<ErrorProbe>,
    shadowed: bool,
    validity: ValidityTest<'a>,
    /// What vertices send out.
    reflection: Option<Reflection<'a>>,
    channels: usize,
}

/// Memory that a thread uses again for each texel.
#[derive(Debug, Default)]
pub(crate) struct TexelScratch {
    direct: DirectScratch,
    vector: Vec<f32>,
    hits: Vec<HitRecord>,
    /// What arrives after reflections, `[C, n²]`.
    gathered: Vec<f64>,
}

impl<'a> TexelTracer<'a> {
    /// - `arriving`: transfer at the vertices, if texels gather what they send out
    /// - `channels`: of the result
    pub(crate) fn new(
        laid_out: &'a LaidOut<'a>,
        scene: &'a Scene,
        options: &BakeOptions,
        arriving: Option<&TransferVectors>,
        channels: usize,
    ) -> Self {
        let mesh = laid_out.layout.mesh;
        Self {
            laid_out,
            scene,
            neighbors: smooth_neighbors(&laid_out.layout),
            ladder: Ladder::new(options),
            probe: ErrorProbe::new(options, laid_out.texels.len()).filter(|_| options.shadowed),
            shadowed: options.shadowed,
            validity: ValidityTest::new(scene, mesh),
            reflection: arriving.map(|arriving| Reflection::new(mesh.triangles(), arriving.with_channels(channels))),
            channels,
        }
    }

    /// The transfer of some of the texels that are baked, `[texels, C, n²]`, and what was found there.
    ///
    /// - `numbers`: among the texels that are baked
    pub(crate) fn block(
        &self,
        scratch: &mut TexelScratch,
        numbers: Range<usize>,
        progress: &dyn Progress,
    ) -> Result<(Vec<f32>, Vec<VertexStats>), Error> {
        let points = Points::new(self.laid_out, self.scene, &self.neighbors, numbers.clone());
        let direct = DirectPass {
            mesh: self.laid_out.layout.mesh,
            scene: self.scene,
            ladder: &self.ladder,
            normals: &points.normals,
            origins: &points.origins,
        };
        let row_length = self.channels * self.ladder.order.coeff_count();
        let mut rows = vec![0.0; numbers.len() * row_length];
        let mut stats = Vec::with_capacity(numbers.len());
        for ((point, number), row) in numbers.enumerate().zip(rows.chunks_exact_mut(row_length)) {
            if progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            stats.push(self.texel(&direct, scratch, [point, number], row));
        }
        Ok((rows, stats))
    }

    /// The transfer of one texel, `[C, n²]`.
    fn texel(
        &self,
        direct: &DirectPass,
        scratch: &mut TexelScratch,
        [point, number]: [usize; 2],
        row: &mut [f32],
    ) -> VertexStats {
        if !self.shadowed {
            let unshadowed = TransferVectors::unshadowed(self.ladder.order, &direct.normals[point..=point]);
            row.copy_from_slice(&unshadowed.values);
            return VertexStats::default();
        }
        scratch.vector.resize(self.ladder.order.coeff_count(), 0.0);
        let mut stats = direct.shadowed_vector(&mut scratch.direct, point, &mut scratch.vector);
        self.validity.complete(direct.normals[point], direct.origins[point], &mut stats);
        row.chunks_exact_mut(scratch.vector.len()).for_each(|row| row.copy_from_slice(&scratch.vector));
        if let Some(reflection) = &self.reflection {
            scratch.hits.clear();
            stats.rays += direct.nearest_hits(&mut scratch.direct, point, &mut scratch.hits);
            reflection.gather(&scratch.hits, &mut scratch.gathered);
            let sum = |(value, gathered): (&mut f32, &f64)| *value = (f64::from(*value) + gathered) as f32;
            row.iter_mut().zip(&scratch.gathered).for_each(sum);
        }
        if let Some(probe) = self.probe.as_ref().filter(|probe| probe.samples(number)) {
            stats.error = probe.estimate(direct, &mut scratch.direct, point, &scratch.vector);
        }
        stats
    }
}
