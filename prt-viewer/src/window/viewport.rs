//! The picture in the window: drawn into images of our own before egui's pass, and shown in it.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use eframe::egui;
use eframe::egui_wgpu::{CallbackResources, CallbackTrait, ScreenDescriptor};
use eframe::wgpu;
use prt_bake::{Environment, TransferVectors};
use prt_gpu::{Background, Evaluation, Frame, Gpu, PresentOptions, Presenter, Target, View};
use sh_core::{LatLong, Order};

use super::settings::signed_color;
use crate::lighting::Lighting;
use crate::model::Model;
use crate::motion::Motion;
use crate::renderer::Renderer;
use crate::shading::{Drawing, Part, PartTransfer};

/// Samples per pixel along each axis of a picture that is saved.
const SAVED_SAMPLES: u32 = 3;
/// Rays per vertex of transfer that is traced while the window waits.
const TRACED_RAYS: usize = 256;
/// Width of the map that a cube map is shown through.
const CUBE_AS_MAP: LatLong = LatLong { width: 2048, height: 1024 };

/// What is on the surface.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Content {
    /// Exit radiance under a light `[3, k²]`.
    Lit { order: Order, light: Vec<f32> },
    /// A coefficient of the transfer.
    Coefficient(usize),
}

/// Everything that a frame depends on.
#[derive(Debug, Clone)]
pub(super) struct Shot {
    pub(super) view: View,
    /// Where the camera is: gloss depends on it.
    pub(super) eye: [f32; 3],
    pub(super) part: Part,
    pub(super) motion: Motion,
    pub(super) evaluation: Evaluation,
    pub(super) content: Content,
    /// Stops.
    pub(super) exposure: f32,
    /// The environment, and the view in its frame.
    pub(super) background: Option<(Arc<Lighting>, View)>,
}

/// What is kept on the GPU.
#[derive(Debug)]
pub(super) struct Viewport {
    gpu: Gpu,
    model: Arc<Model>,
    presenter: Presenter,
    renderers: HashMap<Part, Shown>,
    target: Option<Target>,
    background: Option<(Arc<Lighting>, Background)>,
    /// Why the last frame is not there.
    fault: Option<String>,
}

/// The renderer of one part of the transfer.
#[derive(Debug)]
struct Shown {
    renderer: Renderer,
    motion: Motion,
    evaluation: Option<Evaluation>,
    content: Option<Content>,
}

impl Viewport {
    pub(super) fn new(gpu: Gpu, format: wgpu::TextureFormat, model: Arc<Model>) -> Result<Self, prt_gpu::Error> {
        let presenter = Presenter::new(&gpu, format)?;
        Ok(Self { gpu, model, presenter, renderers: HashMap::new(), target: None, background: None, fault: None })
    }

    pub(super) fn adapter_name(&self) -> String {
        self.gpu.adapter_name()
    }

    /// Whether the adapter is the CPU in disguise.
    pub(super) fn is_software(&self) -> bool {
        self.gpu.info().device_type == wgpu::DeviceType::Cpu
    }

    pub(super) fn take_fault(&mut self) -> Option<String> {
        self.fault.take()
    }

    /// Draws a picture and reads it back; without background.
    pub(super) fn render(&mut self, shot: &Shot) -> anyhow::Result<Frame> {
        let view = View { samples: SAVED_SAMPLES, ..shot.view };
        Ok(self.renderer(shot)?.render(&view, shot.eye)?)
    }

    fn draw(&mut self, encoder: &mut wgpu::CommandEncoder, shot: &Shot) -> anyhow::Result<()> {
        let View { width, height, samples, .. } = shot.view;
        let size = |target: &Target| [target.width(), target.height(), target.samples()];
        let target = match self.target.take().filter(|target| size(target) == [width, height, samples]) {
            Some(target) => target,
            None => Target::new(&self.gpu, width, height, samples)?,
        };
        self.renderer(shot)?.draw(encoder, &shot.view, shot.eye, &target)?;
        if let Some((lighting, _)) = &shot.background {
            self.upload_background(lighting)?;
        }
        let background =
            self.background.as_ref().zip(shot.background.as_ref()).map(|((_, map), (_, view))| (map, view));
        self.presenter.prepare(&target, &PresentOptions { exposure_stops: shot.exposure, background })?;
        self.target = Some(target);
        Ok(())
    }

    /// Uploads an environment if it is not the last one that was shown.
    fn upload_background(&mut self, lighting: &Arc<Lighting>) -> Result<(), prt_gpu::Error> {
        if !self.background.as_ref().is_some_and(|(shown, _)| Arc::ptr_eq(shown, lighting)) {
            let background = upload(&self.gpu, &lighting.environment)?;
            self.background = Some((Arc::clone(lighting), background));
        }
        Ok(())
    }

    /// The renderer for a shot, with its pose and content set.
    fn renderer(&mut self, shot: &Shot) -> anyhow::Result<&mut Renderer> {
        self.pose(shot)?;
        let shown = self.renderers.get_mut(&shot.part).expect("it was just posed");
        if shown.evaluation != Some(shot.evaluation) {
            shown.renderer.set_evaluation(shot.evaluation)?;
            shown.evaluation = Some(shot.evaluation);
        }
        if shown.content.as_ref() != Some(&shot.content) {
            match &shot.content {
                Content::Lit { order, light } => shown.renderer.set_light(light, *order)?,
                Content::Coefficient(i) => {
                    let transfer = self.model.transfer(shot.part, &shot.motion, TRACED_RAYS, &())?;
                    if let PartTransfer::Vectors(transfer) = transfer {
                        shown.renderer.set_colors(&coefficient_colors(&transfer, *i))?;
                    }
                }
            }
            shown.content = Some(shot.content.clone());
        }
        Ok(&mut shown.renderer)
    }

    /// Brings the renderer of a part into the pose of a shot. Lobes are turned; transfer vectors are uploaded anew, and traced anew if
    /// they are of the traced part.
    fn pose(&mut self, shot: &Shot) -> anyhow::Result<()> {
        let shown = self.renderers.get_mut(&shot.part);
        if shown.as_ref().is_some_and(|shown| shown.motion == shot.motion) {
            return Ok(());
        }
        let posed = self.model.pose(&shot.motion);
        let frames = self.model.frames(shot.part, &posed);
        if let Some(shown) = shown
            && shown.renderer.set_pose(&posed.positions, &frames)?
        {
            shown.motion = shot.motion;
            return Ok(());
        }
        let transfer = self.model.transfer(shot.part, &shot.motion, TRACED_RAYS, &())?;
        let drawing = Drawing::new(&self.model, &transfer, &posed.positions, &frames)?;
        let renderer = Renderer::new(&self.gpu, &drawing)?;
        self.renderers.insert(shot.part, Shown { renderer, motion: shot.motion, evaluation: None, content: None });
        Ok(())
    }
}

/// Maps a coefficient to colours, its largest magnitude to the brightest.
fn coefficient_colors(transfer: &TransferVectors, coefficient: usize) -> Vec<[f32; 3]> {
    let rows = transfer.values.chunks_exact(transfer.channels * transfer.order.coeff_count());
    let mean = |row: &[f32]| row.iter().skip(coefficient).step_by(transfer.order.coeff_count()).sum::<f32>();
    let values: Vec<f32> = rows.map(mean).collect();
    let largest = values.iter().fold(f32::MIN_POSITIVE, |largest, value| largest.max(value.abs()));
    values.iter().map(|value| signed_color(value / largest)).collect()
}

fn upload(gpu: &Gpu, environment: &Environment) -> Result<Background, prt_gpu::Error> {
    let limit = gpu.device().limits().max_texture_dimension_2d as usize;
    match environment {
        Environment::LatLong(image) if image.width.max(image.height) <= limit => {
            Background::new(gpu, image.width as u32, image.height as u32, &image.pixels)
        }
        other => {
            let map = CUBE_AS_MAP;
            let texel = |i: usize| {
                let direction = map.direction((i % map.width) as f64 + 0.5, (i / map.width) as f64 + 0.5);
                other.radiance(direction.map(|coordinate| coordinate as f32))
            };
            let pixels: Vec<[f32; 3]> = (0..map.texel_count()).map(texel).collect();
            Background::new(gpu, map.width as u32, map.height as u32, &pixels)
        }
    }
}

/// A viewport that egui's callbacks and the app share.
pub(super) type SharedViewport = Arc<Mutex<Viewport>>;

pub(super) fn lock(viewport: &SharedViewport) -> MutexGuard<'_, Viewport> {
    viewport.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Draws a shot where egui asks for it.
#[derive(Debug)]
pub(super) struct Painting {
    pub(super) viewport: SharedViewport,
    pub(super) shot: Shot,
}

impl CallbackTrait for Painting {
    fn prepare(
        &self,
        _: &wgpu::Device,
        _: &wgpu::Queue,
        _: &ScreenDescriptor,
        encoder: &mut wgpu::CommandEncoder,
        _: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        let mut viewport = lock(&self.viewport);
        viewport.fault = viewport.draw(encoder, &self.shot).err().map(|error| format!("{error:#}"));
        Vec::new()
    }

    fn paint(&self, _: egui::PaintCallbackInfo, pass: &mut wgpu::RenderPass<'static>, _: &CallbackResources) {
        lock(&self.viewport).presenter.paint(pass);
    }
}
