//! The passes: what each is compiled from, what it is given, and how it is dispatched.

mod draw_surface;
mod present;
mod resolve;
mod shade_vector;

pub(crate) use draw_surface::DrawSurface;
pub use present::{Background, PresentOptions, Presenter};
pub(crate) use resolve::Resolve;
pub use shade_vector::ShadingLimits;
pub(crate) use shade_vector::{ShadeVector, Shading};

use crate::shaders::Shader;

/// The pipelines that every renderer uses.
#[derive(Debug)]
pub(crate) struct Passes {
    pub(crate) shade_vector: ShadeVector,
    pub(crate) draw_surface: DrawSurface,
    pub(crate) resolve: Resolve,
}

impl Passes {
    pub(crate) fn new(device: &wgpu::Device) -> Self {
        Self {
            shade_vector: ShadeVector::new(device),
            draw_surface: DrawSurface::new(device),
            resolve: Resolve::new(device),
        }
    }
}

fn compile(device: &wgpu::Device, shader: Shader) -> wgpu::ShaderModule {
    let source = wgpu::ShaderSource::Wgsl(shader.source().into());
    device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(shader.name), source })
}

fn compute_pipeline(device: &wgpu::Device, shader: Shader) -> wgpu::ComputePipeline {
    device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(shader.name),
        layout: None,
        module: &compile(device, shader),
        entry_point: None,
        compilation_options: Default::default(),
        cache: None,
    })
}

/// A bind group of resources in the order of their binding numbers, from 0.
pub(crate) fn bind(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    resources: &[wgpu::BindingResource<'_>],
) -> wgpu::BindGroup {
    let numbered = resources.iter().cloned().enumerate();
    let entries: Vec<_> = numbered.map(|(i, resource)| wgpu::BindGroupEntry { binding: i as u32, resource }).collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
}
