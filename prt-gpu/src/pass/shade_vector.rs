use super::{bind, compute_pipeline};
use crate::buffers::GpuVec;
use crate::layout::{self, Chunk, ShadeParams};
use crate::shaders::SHADE_VECTOR;
use crate::{Error, Gpu, Surface};
use sh_core::Order;
use wgpu::BufferUsages as Usage;

/// Invocations per workgroup, as in the shader.
const WORKGROUP: u32 = 64;

/// Radiance of vertices from transfer vectors.
#[derive(Debug)]
pub(crate) struct ShadeVector {
    pipeline: wgpu::ComputePipeline,
}

impl ShadeVector {
    pub(crate) fn new(device: &wgpu::Device) -> Self {
        Self { pipeline: compute_pipeline(device, SHADE_VECTOR) }
    }

    pub(crate) fn record(&self, encoder: &mut wgpu::CommandEncoder, shading: &Shading) {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&self.pipeline);
        for part in &shading.parts {
            let [x, y] = part.groups;
            pass.set_bind_group(0, &part.bind_group, &[]);
            pass.dispatch_workgroups(x, y, 1);
        }
    }
}

/// How large the pieces may be that shading is split into.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ShadingLimits {
    /// Bytes of transfer in one buffer.
    pub buffer_bytes: u64,
    /// Workgroups of 64 vertices along each side of a two-dimensional dispatch.
    pub groups_per_side: u32,
}

impl ShadingLimits {
    /// The largest that the adapter allows.
    pub fn of(gpu: &Gpu) -> Self {
        Self {
            buffer_bytes: gpu.max_binding(),
            groups_per_side: gpu.device().limits().max_compute_workgroups_per_dimension,
        }
    }

    /// Cut to what the adapter allows.
    pub(crate) fn within(self, gpu: &Gpu) -> Self {
        let adapter = Self::of(gpu);
        Self {
            buffer_bytes: self.buffer_bytes.min(adapter.buffer_bytes),
            groups_per_side: self.groups_per_side.min(adapter.groups_per_side),
        }
    }
}

/// What the pass reads and writes for one surface.
#[derive(Debug)]
pub(crate) struct Shading {
    light: GpuVec<[f32; 4]>,
    albedo: GpuVec<[f32; 4]>,
    radiance: GpuVec<[f32; 4]>,
    parts: Vec<Part>,
}

/// One chunk of vertices.
#[derive(Debug)]
struct Part {
    params: ShadeParams,
    params_buffer: GpuVec<ShadeParams>,
    bind_group: wgpu::BindGroup,
    groups: [u32; 2],
}

impl Shading {
    /// Uploads transfer and albedo.
    pub(crate) fn new(gpu: &Gpu, surface: &Surface<'_>, limits: ShadingLimits) -> Result<Self, Error> {
        let blocks = layout::block_count(surface.order.coeff_count());
        let mut shading = Self {
            light: GpuVec::new(gpu, "light", Usage::STORAGE, 3 * blocks)?,
            albedo: GpuVec::with_data(gpu, "albedo", Usage::STORAGE, &layout::pad(surface.albedo))?,
            radiance: GpuVec::new(gpu, "radiance", Usage::STORAGE | Usage::COPY_SRC, surface.vertex_count())?,
            parts: Vec::new(),
        };
        let bytes = layout::transfer_bytes_per_vertex(surface);
        let chunks = layout::split_transfer(surface.vertex_count(), bytes, limits.buffer_bytes);
        let chunks = chunks.ok_or_else(|| {
            gpu.limit_error("transfer of one vertex".into(), bytes as u64, "bytes in one binding", limits.buffer_bytes)
        })?;
        let parts = chunks.into_iter().map(|chunk| shading.part(gpu, surface, chunk, limits.groups_per_side));
        shading.parts = parts.collect::<Result<_, _>>()?;
        Ok(shading)
    }

    fn part(&self, gpu: &Gpu, surface: &Surface<'_>, chunk: Chunk, max_side: u32) -> Result<Part, Error> {
        let group_count = (chunk.vertex_count as u32).div_ceil(WORKGROUP);
        let groups = layout::split_dispatch(group_count, max_side).ok_or_else(|| {
            gpu.limit_error("shading".into(), group_count.into(), "workgroups", u64::from(max_side).pow(2))
        })?;
        let params = ShadeParams {
            first_vertex: chunk.first_vertex as u32,
            vertex_count: chunk.vertex_count as u32,
            stored_blocks: layout::block_count(surface.order.coeff_count()) as u32,
            used_blocks: 0,
            channel_count: surface.channels as u32,
            row_length: groups[0] * WORKGROUP,
            padding: [0; 2],
        };
        let params_buffer = GpuVec::with_data(gpu, "shading parameters", Usage::UNIFORM, &[params])?;
        let transfer = GpuVec::with_data(gpu, "transfer", Usage::STORAGE, &layout::transpose_transfer(surface, chunk))?;
        let bind_group = self.bind(gpu, &params_buffer, &transfer)?;
        Ok(Part { params, params_buffer, bind_group, groups })
    }

    fn bind(
        &self,
        gpu: &Gpu,
        params: &GpuVec<ShadeParams>,
        transfer: &GpuVec<[f32; 4]>,
    ) -> Result<wgpu::BindGroup, Error> {
        let buffers =
            [params.buffer(), transfer.buffer(), self.light.buffer(), self.albedo.buffer(), self.radiance.buffer()];
        let layout = gpu.passes().shade_vector.pipeline.get_bind_group_layout(0);
        gpu.checked("binding buffers", || bind(gpu.device(), &layout, &buffers.map(wgpu::Buffer::as_entire_binding)))
    }

    /// Uploads a light of `order` bands, `[3, order²]`.
    pub(crate) fn set_light(&mut self, gpu: &Gpu, light: &[f32], order: Order) -> Result<(), Error> {
        self.light.write(gpu, &layout::block_light(light, order.coeff_count()))?;
        for part in &mut self.parts {
            part.params.used_blocks = layout::block_count(order.coeff_count()) as u32;
            part.params_buffer.write(gpu, &[part.params])?;
        }
        Ok(())
    }

    pub(crate) fn set_albedo(&mut self, gpu: &Gpu, albedo: &[[f32; 3]]) -> Result<(), Error> {
        self.albedo.write(gpu, &layout::pad(albedo)).map(drop)
    }

    pub(crate) fn set_radiance(&mut self, gpu: &Gpu, colors: &[[f32; 3]]) -> Result<(), Error> {
        self.radiance.write(gpu, &layout::pad(colors)).map(drop)
    }

    /// `[V]`, radiance in the first three components.
    pub(crate) fn radiance(&self) -> &wgpu::Buffer {
        self.radiance.buffer()
    }
}
