//! Shading with precomputed radiance transfer on the GPU, and the same on the CPU.

mod assemble;
mod buffers;
pub mod cpu;
mod device;
mod error;
mod layout;
mod pass;
mod renderer;
mod shaders;
mod surface;
mod target;
mod tone;
mod triangle;
mod view;

pub use device::Gpu;
pub use error::Error;
pub use pass::{Background, PresentOptions, Presenter};
pub use renderer::SurfaceRenderer;
pub use surface::Surface;
pub use target::Target;
pub use tone::tone_map;
pub use view::{Frame, View};
pub use wgpu;
