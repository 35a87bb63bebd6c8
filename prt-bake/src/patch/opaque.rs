//! Diffuse transfer of an opaque patch: shadowed, then interreflected.

use super::PatchReport;
use super::direct::{DirectPass, Found};
use super::field::HeightField;
use super::options::PatchOptions;
use super::surface::Surface;
use crate::diffuse::{Bounces, HitRecord};
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
        let (direct, hits) = self.shadowed(bounces > 0, progress, report)?;
        if bounces == 0 {
            return Ok(direct);
        }
        let triangles = self.field.tile_triangles();
        let albedo = vec![self.options.albedo; self.field.texel_count()];
        let mut passes = Bounces::new(&triangles, &albedo, &direct);
        for bounce in 1..=bounces {
            progress.start(Pass::Bounce(bounce), hits.len());
            report.bounce_energy.push(passes.next(&hits, &self.threads, progress)?);
        }
        Ok(passes.into_total())
    }

    /// Direct transfer, and where light may come from after a reflection if that is asked for.
    fn shadowed(
        &self,
        keep_hits: bool,
        progress: &dyn Progress,
        report: &mut PatchReport,
    ) -> Result<(TransferVectors, Vec<Vec<HitRecord>>), Error> {
        let texels = self.field.texel_count();
        let pass = self.direct(&self.directions);
        let mut transfer = TransferVectors::zero(texels, 1, self.options.order);
        let mut hits = vec![Vec::new(); texels];
        let rows = transfer.values.chunks_exact_mut(self.options.order.coeff_count());
        let mut items: Vec<_> = rows.zip(&mut hits).map(|(row, hits)| (row, hits, 0, 0)).collect();
        progress.start(Pass::Direct, texels);
        self.threads.for_each(&mut items, progress, Found::default, |found, texel, (row, hits, rays, occluded)| {
            row.iter_mut().zip(pass.diffuse_vector(texel, found)).for_each(|(value, sum)| *value = sum as f32);
            if keep_hits {
                **hits = found.records();
            }
            (*rays, *occluded) = (found.rays, found.occluded.len() as u64);
            *rays
        })?;
        report.add_rays(items.iter().map(|(_, _, rays, occluded)| (*rays, *occluded)));
        Ok((transfer, hits))
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
