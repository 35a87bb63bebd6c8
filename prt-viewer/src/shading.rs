//! From baked transfer and light to a frame, on the GPU or on the CPU.

use std::borrow::Cow;
use std::sync::OnceLock;

use anyhow::bail;
use prt_bake::{BakedSurface, Geometry, TransferVectors, ZonalTransfer};
use prt_gpu::{Evaluation, Frame, Gpu, LobeSampling, LobeSurface, LobeTexture, Surface, TexturedSurface, View, cpu};
use sh_core::Order;

use crate::model::{Content, Model};
use crate::renderer::Renderer;
use crate::{lobes, output};

/// What shades and draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Backend {
    /// The GPU, or the CPU where there is no usable adapter.
    Auto,
    Gpu,
    Cpu,
}

/// Which light paths are shown, and how transfer follows a deformation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, clap::ValueEnum)]
pub(crate) enum Part {
    /// All that was baked; lobes turn with the surface.
    Full,
    /// Direct light with shadows, no interreflections.
    Shadowed,
    /// Direct light without shadows, from the normals of the pose.
    Unshadowed,
    /// Lobes as they were baked, not turned with the surface: wrong on purpose, for comparison.
    Undeformed,
    /// Transfer traced anew in this pose: the truth, and slow.
    Traced,
}

impl std::fmt::Display for Part {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let value = clap::ValueEnum::to_possible_value(self);
        f.write_str(value.as_ref().map_or("", |value| value.get_name()))
    }
}

impl Part {
    /// Transfer vectors of this part.
    ///
    /// # Errors
    /// If the file does not hold it.
    pub(crate) fn vectors(self, baked: &BakedSurface) -> anyhow::Result<Cow<'_, TransferVectors>> {
        match (self, &baked.transfer_shadowed) {
            (Self::Full | Self::Undeformed, _) => Ok(Cow::Borrowed(&baked.transfer)),
            (Self::Unshadowed, _) => Ok(Cow::Owned(baked.unshadowed())),
            (Self::Shadowed, Some(shadowed)) => Ok(Cow::Borrowed(shadowed)),
            (Self::Shadowed, None) if baked.metadata.shadowed && baked.metadata.bounces == 0 => {
                Ok(Cow::Borrowed(&baked.transfer))
            }
            (Self::Shadowed, None) if baked.metadata.shadowed => {
                bail!("it holds no shadowed transfer without interreflections: bake with --keep-shadowed")
            }
            (Self::Shadowed, None) => bail!("it was baked without shadows"),
            (Self::Traced, _) => bail!("traced transfer is not in a file"),
        }
    }
}

/// The transfer of one part of a model.
#[derive(Debug, Clone)]
pub(crate) enum PartTransfer<'a> {
    /// At each vertex.
    Vectors(Cow<'a, TransferVectors>),
    /// At each vertex, turned by frames.
    Lobes(Cow<'a, ZonalTransfer>),
    /// At each texel, turned by frames. Lobes of neighbours that are coherent are interpolated.
    Textured { transfer: Cow<'a, ZonalTransfer>, is_coherent: bool },
}

/// Everything that a picture needs but the light and the view.
#[derive(Debug)]
pub(crate) enum Drawing<'a> {
    Vectors(Surface<'a>),
    Lobes { surface: LobeSurface<'a>, frames: &'a [[[f32; 3]; 3]] },
    Textured { surface: TexturedSurface<'a>, frames: &'a [[[f32; 3]; 3]] },
}

impl<'a> Drawing<'a> {
    /// A part of a model in a pose, ready to be shaded.
    ///
    /// - `frames`: of the part in the pose
    ///
    /// # Errors
    /// If the arrays contradict one another.
    pub(crate) fn new(
        model: &'a Model,
        transfer: &'a PartTransfer<'_>,
        positions: &'a [[f32; 3]],
        frames: &'a [[[f32; 3]; 3]],
    ) -> Result<Self, prt_gpu::Error> {
        let Geometry { triangles, albedo, uvs, .. } = model.geometry();
        match transfer {
            PartTransfer::Vectors(transfer) => {
                let TransferVectors { order, channels, values } = transfer.as_ref();
                Surface::new(positions, triangles, albedo, *order, *channels, values).map(Self::Vectors)
            }
            PartTransfer::Lobes(transfer) => {
                let surface = LobeSurface::new(positions, triangles, albedo, lobes::shaded(transfer)?)?;
                Ok(Self::Lobes { surface, frames })
            }
            PartTransfer::Textured { transfer, is_coherent } => {
                let Content::Textured(textured) = &model.content else { unreachable!("only textures have texels") };
                let texture = &textured.texture;
                let texture = LobeTexture::new(texture.width, texture.height, None, lobes::shaded(transfer)?)?
                    .with_normals(&texture.normals)?;
                let sampling = if *is_coherent { LobeSampling::Bilinear } else { LobeSampling::PointLobes };
                let uvs = uvs.as_deref().unwrap_or_default();
                let surface = TexturedSurface::new(positions, triangles, uvs, albedo, texture)?
                    .with_repeat(textured.repeat.map(|tiles| tiles as f32))?;
                Ok(Self::Textured { surface: surface.with_sampling(sampling), frames })
            }
        }
    }
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

/// What a drawing is lit by and seen from.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shot<'a> {
    /// `[3, k²]` for the `order` of `k` bands in use.
    pub(crate) light: &'a [f32],
    pub(crate) order: Order,
    pub(crate) eye: [f32; 3],
    pub(crate) evaluation: Evaluation,
    pub(crate) view: &'a View,
}

/// Shades and draws.
///
/// # Errors
/// If the order is above that of the surface, the view is impossible, or the GPU that was insisted on fails.
pub(crate) fn shade(drawing: &Drawing<'_>, shot: &Shot<'_>, backend: Backend) -> anyhow::Result<Shaded> {
    if backend != Backend::Cpu {
        match on_gpu(drawing, shot) {
            Ok(shaded) => return Ok(shaded),
            Err(error) if backend == Backend::Gpu => return Err(error.into()),
            Err(error) => output::note(format_args!("shading on the CPU: {}", first_line(&error.to_string()))),
        }
    }
    Ok(Shaded { frame: on_cpu(drawing, shot)?, backend: "cpu", adapter: None })
}

fn on_cpu(drawing: &Drawing<'_>, shot: &Shot<'_>) -> Result<Frame, prt_gpu::Error> {
    let Shot { light, order, eye, evaluation, view } = *shot;
    match drawing {
        Drawing::Vectors(surface) => cpu::render(surface, light, order, view),
        Drawing::Lobes { surface, frames } => {
            cpu::render_lobes(surface, frames, light, order, Some(eye), evaluation, view)
        }
        Drawing::Textured { surface, frames } => {
            cpu::render_textured(surface, frames, light, order, Some(eye), evaluation, view)
        }
    }
}

fn on_gpu(drawing: &Drawing<'_>, shot: &Shot<'_>) -> Result<Shaded, prt_gpu::Error> {
    let gpu = gpu()?;
    let mut renderer = Renderer::new(&gpu, drawing)?;
    renderer.set_evaluation(shot.evaluation)?;
    renderer.set_light(shot.light, shot.order)?;
    let frame = renderer.render(shot.view, shot.eye)?;
    Ok(Shaded { frame, backend: "gpu", adapter: Some(gpu.adapter_name()) })
}

/// The adapter, opened once for all pictures.
fn gpu() -> Result<Gpu, prt_gpu::Error> {
    static OPENED: OnceLock<Gpu> = OnceLock::new();
    match OPENED.get() {
        Some(gpu) => Ok(gpu.clone()),
        None => Gpu::headless().map(|gpu| OPENED.get_or_init(|| gpu).clone()),
    }
}

/// Accounts of adapters are long; the first line says what matters.
fn first_line(text: &str) -> &str {
    text.lines().next().unwrap_or_default().trim_end_matches(':')
}
