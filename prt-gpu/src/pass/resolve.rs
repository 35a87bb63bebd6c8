use super::compute_pipeline;
use crate::Target;
use crate::shaders::Shader;

/// Pixels per side of a workgroup, as in the shader.
const WORKGROUP: u32 = 8;

/// From the nearest triangles to radiance, coverage and depth of pixels.
#[derive(Debug)]
pub(crate) struct Resolve {
    pipeline: wgpu::ComputePipeline,
}

impl Resolve {
    pub(crate) const COLOR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;
    pub(crate) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;

    pub(crate) fn new(device: &wgpu::Device, shader: Shader) -> Self {
        Self { pipeline: compute_pipeline(device, shader) }
    }

    /// A pass of another shader with the same target.
    pub(crate) fn with_pipeline(pipeline: wgpu::ComputePipeline) -> Self {
        Self { pipeline }
    }

    /// Layout of the frame's parameters, screen vertices, corners, clip vertices and radiance.
    pub(crate) fn screen_layout(&self) -> wgpu::BindGroupLayout {
        self.pipeline.get_bind_group_layout(0)
    }

    /// Layout of the nearest triangles, color and depth.
    pub(crate) fn target_layout(&self) -> wgpu::BindGroupLayout {
        self.pipeline.get_bind_group_layout(1)
    }

    /// - `screen`: bound as [`Resolve::screen_layout`]
    /// - `images`: of the target, bound as [`Resolve::target_layout`]
    pub(crate) fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        screen: &wgpu::BindGroup,
        images: &wgpu::BindGroup,
        target: &Target,
    ) {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, screen, &[]);
        pass.set_bind_group(1, images, &[]);
        pass.dispatch_workgroups(target.width().div_ceil(WORKGROUP), target.height().div_ceil(WORKGROUP), 1);
    }
}
