//! A drawing on the GPU, whatever the kind of its transfer.

use eframe::wgpu;
use prt_gpu::{Error, Evaluation, Frame, Gpu, SurfaceRenderer, Target, View};
use sh_core::Order;

use crate::shading::Drawing;

#[derive(Debug)]
pub(crate) enum Renderer {
    Vectors(SurfaceRenderer),
}

impl Renderer {
    pub(crate) fn new(gpu: &Gpu, drawing: &Drawing<'_>) -> Result<Self, Error> {
        match drawing {
            Drawing::Vectors(surface) => SurfaceRenderer::new(gpu, surface).map(Self::Vectors),
            _ => Err(Error::Device { step: "x", message: "not yet".to_owned() }),
        }
    }

    pub(crate) fn set_light(&mut self, light: &[f32], order: Order) -> Result<(), Error> {
        match self {
            Self::Vectors(renderer) => renderer.set_light(light, order),
        }
    }

    pub(crate) fn set_pose(&mut self, _positions: &[[f32; 3]], _frames: &[[[f32; 3]; 3]]) -> Result<bool, Error> {
        Ok(false)
    }

    pub(crate) fn set_colors(&mut self, colors: &[[f32; 3]]) -> Result<(), Error> {
        match self {
            Self::Vectors(renderer) => renderer.set_colors(colors),
        }
    }

    pub(crate) fn draw(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        view: &View,
        _eye: [f32; 3],
        target: &Target,
    ) -> Result<(), Error> {
        match self {
            Self::Vectors(renderer) => renderer.draw(encoder, view, target),
        }
    }

    pub(crate) fn set_evaluation(&mut self, _evaluation: Evaluation) -> Result<(), Error> {
        Ok(())
    }

    pub(crate) fn render(&mut self, view: &View, _eye: [f32; 3]) -> Result<Frame, Error> {
        match self {
            Self::Vectors(renderer) => renderer.render(view),
        }
    }
}
