use super::lobe_light::LobeLight;
use super::{ShadingLimits, bind_buffers};
use crate::buffers::GpuVec;
use crate::layout::{self, Chunk, LobeParams};
use crate::{Error, Gpu, LobeSurface};
use wgpu::BufferUsages as Usage;

/// Invocations per workgroup, as in the shader.
const WORKGROUP: u32 = 64;

/// What the pass reads and writes for one surface.
#[derive(Debug)]
pub(crate) struct LobeShading {
    pub(crate) light: LobeLight,
    pose: GpuVec<[f32; 4]>,
    local_frames: GpuVec<[f32; 4]>,
    albedo: GpuVec<[f32; 4]>,
    radiance: GpuVec<[f32; 4]>,
    parts: Vec<Part>,
    /// Of the constants that the parts are bound for.
    pipeline: wgpu::ComputePipeline,
}

/// One chunk of vertices.
#[derive(Debug)]
struct Part {
    chunk: Chunk,
    params: GpuVec<LobeParams>,
    lobes: GpuVec<f32>,
    bind_group: wgpu::BindGroup,
    groups: [u32; 2],
}

impl LobeShading {
    /// Uploads lobes and albedo, in the rest pose.
    pub(crate) fn new(gpu: &Gpu, surface: &LobeSurface<'_>, limits: ShadingLimits) -> Result<Self, Error> {
        let vertices = surface.vertex_count();
        let local = match (surface.lobes.view_map, surface.local_frames) {
            (None, _) => Vec::new(),
            (_, frames) => layout::pack_pose(surface.positions, frames.unwrap_or_default()),
        };
        let pose = layout::pack_pose(surface.positions, &[]);
        let light = LobeLight::new(gpu, &surface.lobes)?;
        let mut shading = Self {
            pipeline: gpu.lobe_passes()?.shade_lobes.get(gpu, light.constants())?,
            light,
            pose: GpuVec::with_data(gpu, "pose", Usage::STORAGE | Usage::COPY_SRC, &pose)?,
            local_frames: GpuVec::with_data(gpu, "local frames", Usage::STORAGE, &local)?,
            albedo: GpuVec::with_data(gpu, "albedo", Usage::STORAGE, &layout::pad(surface.albedo))?,
            radiance: GpuVec::new(gpu, "radiance", Usage::STORAGE | Usage::COPY_SRC, vertices)?,
            parts: Vec::new(),
        };
        let bytes = layout::lobe_record_length(&surface.lobes.shape) * size_of::<f32>();
        let chunks = layout::split_transfer(vertices, bytes, limits.buffer_bytes).ok_or_else(|| {
            gpu.limit_error("lobes of one vertex".into(), bytes as u64, "bytes in one binding", limits.buffer_bytes)
        })?;
        let parts = chunks.into_iter().map(|chunk| shading.part(gpu, surface, chunk, limits.groups_per_side));
        shading.parts = parts.collect::<Result<_, _>>()?;
        Ok(shading)
    }

    fn part(&self, gpu: &Gpu, surface: &LobeSurface<'_>, chunk: Chunk, max_side: u32) -> Result<Part, Error> {
        let group_count = (chunk.vertex_count as u32).div_ceil(WORKGROUP);
        let groups = layout::split_dispatch(group_count, max_side).ok_or_else(|| {
            gpu.limit_error("shading".into(), group_count.into(), "workgroups", u64::from(max_side).pow(2))
        })?;
        let params = GpuVec::new(gpu, "shading parameters", Usage::UNIFORM, 1)?;
        let lobes = layout::transpose_lobes(&surface.lobes, chunk);
        let lobes = GpuVec::with_data(gpu, "lobes", Usage::STORAGE, &lobes)?;
        let bind_group = self.bind(gpu, &params, &lobes)?;
        Ok(Part { chunk, params, lobes, bind_group, groups })
    }

    fn bind(&self, gpu: &Gpu, params: &GpuVec<LobeParams>, lobes: &GpuVec<f32>) -> Result<wgpu::BindGroup, Error> {
        let [table, view_map] = self.light.buffers();
        let buffers = [
            (0, self.pose.buffer()),
            (1, self.local_frames.buffer()),
            (2, self.albedo.buffer()),
            (3, self.radiance.buffer()),
            (10, params.buffer()),
            (11, lobes.buffer()),
            table,
            view_map,
        ];
        let layout = self.pipeline.get_bind_group_layout(0);
        gpu.checked("binding buffers", || bind_buffers(gpu.device(), &layout, &buffers))
    }

    /// Radiance of all vertices.
    pub(crate) fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&self.pipeline);
        for part in &self.parts {
            let [x, y] = part.groups;
            pass.set_bind_group(0, &part.bind_group, &[]);
            pass.dispatch_workgroups(x, y, 1);
        }
    }

    /// Compiles and binds anew, after a change of the light's order or evaluation.
    pub(crate) fn rebind(&mut self, gpu: &Gpu) -> Result<(), Error> {
        self.pipeline = gpu.lobe_passes()?.shade_lobes.get(gpu, self.light.constants())?;
        let groups = self.parts.iter().map(|part| self.bind(gpu, &part.params, &part.lobes));
        let groups = groups.collect::<Result<Vec<_>, _>>()?;
        self.parts.iter_mut().zip(groups).for_each(|(part, group)| part.bind_group = group);
        Ok(())
    }

    /// Uploads the light's and the eye's parameters.
    pub(crate) fn upload_params(&mut self, gpu: &Gpu) -> Result<(), Error> {
        for part in &mut self.parts {
            let params = LobeParams {
                point_stride: 1,
                item_stride: part.chunk.vertex_count as u32,
                first_point: part.chunk.first_vertex as u32,
                point_count: part.chunk.vertex_count as u32,
                row_length: part.groups[0] * WORKGROUP,
                ..*self.light.params()
            };
            part.params.write(gpu, &[params])?;
        }
        Ok(())
    }

    pub(crate) fn set_pose(
        &mut self,
        gpu: &Gpu,
        positions: &[[f32; 3]],
        frames: &[[[f32; 3]; 3]],
    ) -> Result<(), Error> {
        self.pose.write(gpu, &layout::pack_pose(positions, frames)).map(drop)
    }

    pub(crate) fn set_albedo(&mut self, gpu: &Gpu, albedo: &[[f32; 3]]) -> Result<(), Error> {
        self.albedo.write(gpu, &layout::pad(albedo)).map(drop)
    }

    pub(crate) fn set_radiance(&mut self, gpu: &Gpu, colors: &[[f32; 3]]) -> Result<(), Error> {
        self.radiance.write(gpu, &layout::pad(colors)).map(drop)
    }

    /// `[V, 3]`, columns of the frames with positions.
    pub(crate) fn pose(&self) -> &wgpu::Buffer {
        self.pose.buffer()
    }

    /// `[V]`, radiance in the first three components.
    pub(crate) fn radiance(&self) -> &wgpu::Buffer {
        self.radiance.buffer()
    }
}
