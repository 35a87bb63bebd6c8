use super::{bind_buffers, compute_pipeline};
use crate::buffers::GpuVec;
use crate::layout::{MAX_LOBE_LIGHT, TableParams};
use crate::shaders::BUILD_TABLE;
use crate::table::TableLayout;
use crate::{Error, Gpu};
use wgpu::BufferUsages as Usage;

/// Invocations per workgroup, as in the shader.
const WORKGROUP: u32 = 64;

/// The table of a light.
#[derive(Debug)]
pub(crate) struct BuildTable {
    pipeline: wgpu::ComputePipeline,
}

impl BuildTable {
    pub(crate) fn new(device: &wgpu::Device) -> Self {
        Self { pipeline: compute_pipeline(device, BUILD_TABLE) }
    }

    pub(crate) fn record(&self, encoder: &mut wgpu::CommandEncoder, table: &TableBuffers) {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &table.bind_group, &[]);
        pass.dispatch_workgroups((table.layout.texel_count() as u32).div_ceil(WORKGROUP), 1, 1);
    }
}

/// A table on the GPU and what it is made from.
#[derive(Debug)]
pub(crate) struct TableBuffers {
    /// Its bands are those that can be in use.
    layout: TableLayout,
    params: GpuVec<TableParams>,
    texels: GpuVec<[f32; 4]>,
    bind_group: wgpu::BindGroup,
}

impl TableBuffers {
    pub(crate) fn new(gpu: &Gpu, layout: TableLayout) -> Result<Self, Error> {
        let params = GpuVec::new(gpu, "table parameters", Usage::UNIFORM, 1)?;
        let angles = GpuVec::with_data(gpu, "angles of a table", Usage::STORAGE, &layout.angles())?;
        let count = layout.texel_count() * layout.band_count;
        let texels = GpuVec::new(gpu, "table of a light", Usage::STORAGE | Usage::COPY_SRC, count)?;
        let bindings = gpu.lobe_passes()?.build_table.pipeline.get_bind_group_layout(0);
        let buffers = [(0, params.buffer()), (1, angles.buffer()), (2, texels.buffer())];
        let bind_group = gpu.checked("binding buffers", || bind_buffers(gpu.device(), &bindings, &buffers))?;
        Ok(Self { layout, params, texels, bind_group })
    }

    /// Uploads the light that the next table is built of.
    pub(crate) fn set_light(
        &mut self,
        gpu: &Gpu,
        light: &[[f32; 4]; MAX_LOBE_LIGHT],
        bands: [u32; 2],
    ) -> Result<(), Error> {
        let params = TableParams {
            columns: self.layout.columns() as u32,
            rows: self.layout.height as u32 + 2,
            band_count: bands[1],
            first_band: bands[0],
            light: *light,
        };
        self.params.write(gpu, &[params]).map(drop)
    }

    /// `[H + 2, W + 1, bands in use]`.
    pub(crate) fn texels(&self) -> &wgpu::Buffer {
        self.texels.buffer()
    }
}
