//! Surfaces on the GPU: one renderer per kind of transfer, on a common stage.

mod lobes;
mod stage;
mod surface;
mod texture;

pub use lobes::LobeRenderer;
pub use surface::SurfaceRenderer;
pub use texture::TexturedRenderer;
