use super::compile;
use crate::Target;
use crate::shaders::DRAW_SURFACE;

/// The nearest triangle at every sample.
#[derive(Debug)]
pub(crate) struct DrawSurface {
    pipeline: wgpu::RenderPipeline,
}

impl DrawSurface {
    /// Texels that hold the number of a triangle.
    pub(crate) const NEAREST_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;
    pub(crate) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

    pub(crate) fn new(device: &wgpu::Device) -> Self {
        let module = compile(device, DRAW_SURFACE);
        let depth = wgpu::DepthStencilState {
            format: Self::DEPTH_FORMAT,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Less),
            stencil: Default::default(),
            bias: Default::default(),
        };
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(DRAW_SURFACE.name),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: None,
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: Some(depth),
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: None,
                compilation_options: Default::default(),
                targets: &[Some(Self::NEAREST_FORMAT.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        Self { pipeline }
    }

    /// Layout of the frame's parameters, screen vertices and corners.
    pub(crate) fn layout(&self) -> wgpu::BindGroupLayout {
        self.pipeline.get_bind_group_layout(0)
    }

    /// - `screen`: bound as [`DrawSurface::layout`]
    pub(crate) fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        screen: &wgpu::BindGroup,
        corner_count: u32,
        target: &Target,
    ) {
        let nearest = wgpu::RenderPassColorAttachment {
            view: &target.nearest,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store },
        };
        let depth = wgpu::RenderPassDepthStencilAttachment {
            view: &target.sample_depth,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Discard }),
            stencil_ops: None,
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(DRAW_SURFACE.name),
            color_attachments: &[Some(nearest)],
            depth_stencil_attachment: Some(depth),
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, screen, &[]);
        pass.draw(0..corner_count, 0..1);
    }
}
