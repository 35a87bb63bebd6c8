//! Transfer of a tile of relief in tangent space: opaque with shadows, interreflection and glossy rows, or translucent.
//!
//! Source: [SLS05](sh_core#references) section 6.

mod direct;
mod field;
mod glossy;
mod image;
mod interface;
mod medium;
mod opaque;
mod options;
mod pattern;
mod surface;
mod transfer;
mod translucent;
mod walk;

use std::time::{Duration, Instant};

use crate::{Error, Progress, TransferVectors};
use opaque::Opaque;

pub use field::HeightField;
pub use medium::Medium;
pub use options::PatchOptions;
pub use transfer::PatchTransfer;

/// What a bake of a patch did.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PatchReport {
    /// Rays traced, for shadows and for interreflection; for a translucent patch the paths.
    pub rays_traced: u64,
    /// Share of the rays that met the surface; 0 for a translucent patch.
    pub occluded_share: f64,
    /// Time to trace and sum.
    pub trace: Duration,
    /// Threads used.
    pub threads: usize,
    /// Estimated root-mean-square error of the transfer vectors, relative to the unshadowed ones.
    pub error: Option<f64>,
    /// Length of what each bounce added, relative to the direct transfer.
    pub bounce_energy: Vec<f64>,
    /// What became of the paths in a translucent patch.
    pub scattering: Option<ScatteringReport>,
}

/// What became of the light in a translucent patch: each array has a number for each channel of the transfer.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ScatteringReport {
    /// Share of uniform light from above that the mean texel sends out: the reflectance of the patch, surface reflection included.
    pub from_above: Vec<f64>,
    /// Share of uniform light from below: the transmittance.
    pub from_below: Vec<f64>,
    /// Share that was given up after [`ScatteringReport::MAX_EVENTS`]: the most that transfer is too small by, relative to white.
    pub given_up: Vec<f64>,
    /// Mean number of free paths.
    pub mean_events: Vec<f64>,
}

impl ScatteringReport {
    /// Free paths after which a path is given up.
    pub const MAX_EVENTS: u32 = 1 << 20;
}

impl PatchReport {
    /// Counts rays, and how many of them were occluded, texel by texel.
    fn add_rays(&mut self, texels: impl Iterator<Item = (u64, u64)>) {
        let (rays, occluded) = texels.fold((0, 0), |(a, b), (rays, occluded)| (a + rays, b + occluded));
        let before = self.occluded_share * self.rays_traced as f64;
        self.rays_traced += rays;
        self.occluded_share = (before + occluded as f64) / (self.rays_traced as f64).max(1.0);
    }
}

/// Bakes the transfer of every texel of a height field that tiles the plane.
///
/// Points of an opaque patch are the texel centres, on the surface, with the smooth normals of [`HeightField::normal`]. Their rays
/// follow the surface without end in both directions, in `f64`; what is shadowed is the surface's own triangles, so light from
/// below the plane reaches nothing. Shadowed transfer is the analytic unshadowed one less the occluded directions, so a level field is exact.
/// The error of the paper's bumps at 1,024 rays and order 6 is 6e-3 of the unshadowed vectors, as the report estimates it.
///
/// A translucent patch is baked by the random walks that [`Medium`] describes. The vector of a texel is the mean of `w y(d)` over paths
/// that start evenly over the texel's square in u and v, on the true surface, in directions with density `cos θ/π` about the normal there, and
/// that leave in the direction `d` with the weight `w`. A path carries radiance over squared index of refraction, so that entry and
/// exit need no factor, and light of radiance 1 from all sides gives `Σ w` = 1 where nothing absorbs. The vector thus is the mean exit radiance of
/// the texel: albedo is included, and it is shaded with albedo 1. Light from below counts only where the medium has an end below.
/// Reflectance and transmittance of plane slabs agree with the adding-doubling method to 1e-3, which is the noise of the 10⁶ paths
/// (`repro -- ldprt/scattering` of `prt-benches`). Vectors are noisier than an opaque patch's: 0.4 of the unshadowed ones at 64
/// paths and order 6, falling with the root of the paths; most of it is in the upper bands.
///
/// Same options, same bytes, for any number of threads.
///
/// ```
/// use prt_bake::{HeightField, PatchOptions, bake_patch};
///
/// let field = HeightField::waffle(32, 0.3)?;
/// let (transfer, _) = bake_patch(&field, &PatchOptions::preview(), &())?;
/// // Under a white sky: the top of the wall between two pits sees nearly all of it, the bottom of a pit less than half.
/// let radiance = |texel: usize| transfer.vector(texel, 0, 0)[0] * (4.0 * std::f32::consts::PI).sqrt();
/// assert!(radiance(0) > 0.95 && radiance(4 * 32 + 4) < 0.5);
/// # Ok::<(), prt_bake::Error>(())
/// ```
///
/// # Errors
/// If an option is out of range, or the caller cancels.
pub fn bake_patch(
    field: &HeightField,
    options: &PatchOptions,
    progress: &dyn Progress,
) -> Result<(PatchTransfer, PatchReport), Error> {
    options.validate(field)?;
    let start = Instant::now();
    let mut transfer = PatchTransfer::zero(field, options);
    let mut report = PatchReport::default();
    match options.scattering {
        Some(_) => translucent::bake(field, options, &mut transfer, progress, &mut report)?,
        None => bake_opaque(field, options, &mut transfer, progress, &mut report)?,
    }
    report.trace = start.elapsed();
    Ok((transfer, report))
}

fn bake_opaque(
    field: &HeightField,
    options: &PatchOptions,
    transfer: &mut PatchTransfer,
    progress: &dyn Progress,
    report: &mut PatchReport,
) -> Result<(), Error> {
    if options.responses.is_empty() && !options.shadowed {
        transfer.values = TransferVectors::unshadowed(options.order, &transfer.normals).values;
        return Ok(());
    }
    let opaque = Opaque::new(field, options)?;
    report.threads = opaque.threads.count();
    if options.responses.is_empty() {
        transfer.values = opaque.diffuse(options.bounces, progress, report)?.values;
        report.error = Some(opaque.diffuse_error());
        return Ok(());
    }
    glossy::bake(&opaque, transfer, progress, report)
}

#[cfg(test)]
mod tests;
