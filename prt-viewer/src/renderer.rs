//! A drawing on the GPU, whatever the kind of its transfer.

use eframe::wgpu::CommandEncoder;
use prt_gpu::{Error, Evaluation, Frame, Gpu, LobeRenderer, SurfaceRenderer, Target, TexturedRenderer, View};
use sh_core::Order;

use crate::shading::Drawing;

#[derive(Debug)]
pub(crate) enum Renderer {
    Vectors(Box<SurfaceRenderer>),
    Lobes(Box<LobeRenderer>),
    Textured(Box<TexturedRenderer>),
}

impl Renderer {
    /// Uploads a drawing in its pose.
    pub(crate) fn new(gpu: &Gpu, drawing: &Drawing<'_>) -> Result<Self, Error> {
        match drawing {
            Drawing::Vectors(surface) => Ok(Self::Vectors(Box::new(SurfaceRenderer::new(gpu, surface)?))),
            Drawing::Lobes { surface, frames } => {
                let mut renderer = LobeRenderer::new(gpu, surface)?;
                renderer.set_pose(surface.positions, Some(frames))?;
                Ok(Self::Lobes(Box::new(renderer)))
            }
            Drawing::Textured { surface, frames } => {
                let mut renderer = TexturedRenderer::new(gpu, surface)?;
                renderer.set_pose(surface.positions, Some(frames))?;
                Ok(Self::Textured(Box::new(renderer)))
            }
        }
    }

    /// Brings lobes into a pose; returns whether that was possible: transfer vectors follow none.
    pub(crate) fn set_pose(&mut self, positions: &[[f32; 3]], frames: &[[[f32; 3]; 3]]) -> Result<bool, Error> {
        match self {
            Self::Vectors(_) => return Ok(false),
            Self::Lobes(renderer) => renderer.set_pose(positions, Some(frames))?,
            Self::Textured(renderer) => renderer.set_pose(positions, Some(frames))?,
        }
        Ok(true)
    }

    pub(crate) fn set_light(&mut self, light: &[f32], order: Order) -> Result<(), Error> {
        match self {
            Self::Vectors(renderer) => renderer.set_light(light, order),
            Self::Lobes(renderer) => renderer.set_light(light, order),
            Self::Textured(renderer) => renderer.set_light(light, order),
        }
    }

    /// How lobes are lit; transfer vectors have one way only.
    pub(crate) fn set_evaluation(&mut self, evaluation: Evaluation) -> Result<(), Error> {
        match self {
            Self::Vectors(_) => Ok(()),
            Self::Lobes(renderer) => renderer.set_evaluation(evaluation),
            Self::Textured(renderer) => renderer.set_evaluation(evaluation),
        }
    }

    /// Shows colours `[V]` in place of shading; textures, which have none at vertices, stay as they are.
    pub(crate) fn set_colors(&mut self, colors: &[[f32; 3]]) -> Result<(), Error> {
        match self {
            Self::Vectors(renderer) => renderer.set_colors(colors),
            Self::Lobes(renderer) => renderer.set_colors(colors),
            Self::Textured(_) => Ok(()),
        }
    }

    pub(crate) fn render(&mut self, view: &View, eye: [f32; 3]) -> Result<Frame, Error> {
        match self {
            Self::Vectors(renderer) => renderer.render(view),
            Self::Lobes(renderer) => renderer.render(view, Some(eye)),
            Self::Textured(renderer) => renderer.render(view, Some(eye)),
        }
    }

    pub(crate) fn draw(
        &mut self,
        encoder: &mut CommandEncoder,
        view: &View,
        eye: [f32; 3],
        target: &Target,
    ) -> Result<(), Error> {
        match self {
            Self::Vectors(renderer) => renderer.draw(encoder, view, target),
            Self::Lobes(renderer) => renderer.draw(encoder, view, Some(eye), target),
            Self::Textured(renderer) => renderer.draw(encoder, view, Some(eye), target),
        }
    }
}
