//! The passes: what each is compiled from, what it is given, and how it is dispatched.

mod build_table;
mod draw_surface;
mod lobe_light;
mod present;
mod resolve;
mod resolve_texture;
mod shade_lobes;
mod shade_vector;
mod skin;
mod variant;

pub(crate) use build_table::BuildTable;
pub(crate) use draw_surface::DrawSurface;
pub use present::{Background, PresentOptions, Presenter};
pub(crate) use resolve::Resolve;
pub(crate) use resolve_texture::TextureShading;
pub(crate) use shade_lobes::LobeShading;
pub use shade_vector::ShadingLimits;
pub(crate) use shade_vector::{ShadeVector, Shading};
pub(crate) use skin::{SkinPass, Skinning};
pub(crate) use variant::{Constants, Variants};

use crate::shaders::{RESOLVE, RESOLVE_TEXTURE, SHADE_LOBES, Shader};

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
            resolve: Resolve::new(device, RESOLVE),
        }
    }
}

/// The pipelines of lobes.
#[derive(Debug)]
pub(crate) struct LobePasses {
    pub(crate) build_table: BuildTable,
    pub(crate) shade_lobes: Variants,
    pub(crate) skin: SkinPass,
    pub(crate) resolve_texture: Variants,
}

impl LobePasses {
    pub(crate) fn new(device: &wgpu::Device) -> Self {
        Self {
            build_table: BuildTable::new(device),
            shade_lobes: Variants::new(device, SHADE_LOBES),
            skin: SkinPass::new(device),
            resolve_texture: Variants::new(device, RESOLVE_TEXTURE),
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

/// A bind group of buffers with their binding numbers.
pub(crate) fn bind_buffers(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    buffers: &[(u32, &wgpu::Buffer)],
) -> wgpu::BindGroup {
    let buffers = buffers.iter().map(|(binding, buffer)| (*binding, buffer.as_entire_binding()));
    let entries: Vec<_> = buffers.map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
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
