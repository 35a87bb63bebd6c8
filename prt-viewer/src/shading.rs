//! From baked transfer and light to a frame, on the GPU or on the CPU.

use std::borrow::Cow;

use anyhow::bail;
use prt_bake::{BakedSurface, TransferVectors};
use prt_gpu::{Frame, Gpu, Surface, SurfaceRenderer, View, cpu};
use sh_core::Order;

use crate::output;

/// What shades and draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Backend {
    /// The GPU, or the CPU where there is no usable adapter.
    Auto,
    Gpu,
    Cpu,
}

/// Which light paths are shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, clap::ValueEnum)]
pub(crate) enum Part {
    /// All that was baked.
    Full,
    /// Direct light with shadows, no interreflections.
    Shadowed,
    /// Direct light without shadows.
    Unshadowed,
}

impl Part {
    /// The transfer of this part.
    ///
    /// # Errors
    /// If the file does not hold it.
    pub(crate) fn transfer(self, baked: &BakedSurface) -> anyhow::Result<Cow<'_, TransferVectors>> {
        match (self, &baked.transfer_shadowed) {
            (Self::Full, _) => Ok(Cow::Borrowed(&baked.transfer)),
            (Self::Unshadowed, _) => Ok(Cow::Owned(baked.unshadowed())),
            (Self::Shadowed, Some(shadowed)) => Ok(Cow::Borrowed(shadowed)),
            (Self::Shadowed, None) if baked.metadata.shadowed && baked.metadata.bounces == 0 => {
                Ok(Cow::Borrowed(&baked.transfer))
            }
            (Self::Shadowed, None) if baked.metadata.shadowed => {
                bail!("it holds no shadowed transfer without interreflections: bake with --keep-shadowed")
            }
            (Self::Shadowed, None) => bail!("it was baked without shadows"),
        }
    }
}

/// A surface with one part of its transfer, ready to be shaded.
///
/// # Errors
/// If the arrays contradict one another.
pub(crate) fn surface<'a>(
    baked: &'a BakedSurface,
    transfer: &'a TransferVectors,
) -> Result<Surface<'a>, prt_gpu::Error> {
    let prt_bake::Geometry { positions, triangles, albedo, .. } = &baked.geometry;
    Surface::new(positions, triangles, albedo, transfer.order, transfer.channels, &transfer.values)
}

/// A frame, and what made it.
#[derive(Debug)]
pub(crate) struct Shaded {
    pub(crate) frame: Frame,
    /// `gpu` or `cpu`.
    pub(crate) backend: &'static str,
    /// Name and driver of the GPU.
    pub(crate) adapter: Option<String>,
}

/// Shades and draws.
///
/// - `light`: `[3, k²]` for the `order` of `k` bands in use
///
/// # Errors
/// If the order is above that of the surface, the view is impossible, or the GPU that was insisted on fails.
pub(crate) fn shade(
    surface: &Surface<'_>,
    light: &[f32],
    order: Order,
    view: &View,
    backend: Backend,
) -> anyhow::Result<Shaded> {
    if backend != Backend::Cpu {
        match on_gpu(surface, light, order, view) {
            Ok(shaded) => return Ok(shaded),
            Err(error) if backend == Backend::Gpu => return Err(error.into()),
            Err(error) => output::note(format_args!("shading on the CPU: {}", first_line(&error.to_string()))),
        }
    }
    Ok(Shaded { frame: cpu::render(surface, light, order, view)?, backend: "cpu", adapter: None })
}

fn on_gpu(surface: &Surface<'_>, light: &[f32], order: Order, view: &View) -> Result<Shaded, prt_gpu::Error> {
    let gpu = Gpu::headless()?;
    let mut renderer = SurfaceRenderer::new(&gpu, surface)?;
    renderer.set_light(light, order)?;
    let frame = renderer.render(view)?;
    Ok(Shaded { frame, backend: "gpu", adapter: Some(gpu.adapter_name()) })
}

/// Accounts of adapters are long; the first line says what matters.
fn first_line(text: &str) -> &str {
    text.lines().next().unwrap_or_default().trim_end_matches(':')
}
