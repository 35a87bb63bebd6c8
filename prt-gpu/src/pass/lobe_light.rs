use super::Constants;
use super::build_table::TableBuffers;
use crate::buffers::GpuVec;
use crate::cpu::interleave;
use crate::layout::{LobeParams, MAX_LOBE_LIGHT, MAX_LOBE_ORDER};
use crate::lobes::LobeShape;
use crate::table::TableLayout;
use crate::{Error, Evaluation, Gpu, Lobes};
use bytemuck::Zeroable;
use sh_core::Order;
use wgpu::BufferUsages as Usage;

/// What lobes are shaded with: light, its table, view map and eye.
#[derive(Debug)]
pub(crate) struct LobeLight {
    shape: LobeShape,
    /// All but what tells one buffer of lobes from another.
    params: LobeParams,
    table: TableBuffers,
    /// The light is newer than the table.
    is_table_stale: bool,
    view_map: GpuVec<f32>,
}

impl LobeLight {
    pub(crate) fn new(gpu: &Gpu, lobes: &Lobes<'_>) -> Result<Self, Error> {
        let shape = lobes.shape;
        if shape.order.get() > MAX_LOBE_ORDER {
            return Err(Error::Lobes(format!(
                "lobes of order {} were given; the GPU shades up to order {MAX_LOBE_ORDER}",
                shape.order
            )));
        }
        let values = lobes.view_map.map_or(&[][..], |map| map.values);
        let params = LobeParams {
            rows: shape.rows as u32,
            channels: shape.channels as u32,
            lobe_count: shape.lobe_count as u32,
            explicit_count: shape.explicit_count as u32,
            stored_bands: stored_bands(&shape) as u32,
            first_band: shape.first_band() as u32,
            view_size: lobes.view_map.map_or(0, |map| map.size as u32),
            ..LobeParams::zeroed()
        };
        let mut light = Self {
            shape,
            params,
            table: TableBuffers::new(gpu, TableLayout { width: 2, height: 2, band_count: 0 })?,
            is_table_stale: false,
            view_map: GpuVec::with_data(gpu, "view map", Usage::STORAGE, values)?,
        };
        light.set_evaluation(gpu, Evaluation::default())?;
        Ok(light)
    }

    /// Uploads a light of `order` bands, `[3, order²]`.
    pub(crate) fn set_light(&mut self, gpu: &Gpu, light: &[f32], order: Order) -> Result<(), Error> {
        let mut padded = [[0.0; 4]; MAX_LOBE_LIGHT];
        for (padded, e) in padded.iter_mut().zip(interleave(light, order)) {
            *padded = e;
        }
        self.params.light = padded;
        self.params.used_bands = order.get().saturating_sub(self.shape.first_band()) as u32;
        self.update_table(gpu)
    }

    /// Returns after a change of the table's buffer, which has to be bound anew.
    pub(crate) fn set_evaluation(&mut self, gpu: &Gpu, evaluation: Evaluation) -> Result<(), Error> {
        evaluation.check()?;
        let (width, height) = match evaluation {
            Evaluation::Direct => (0, 0),
            Evaluation::Table { width, height } => (width, height),
        };
        if width > 0 {
            let layout = TableLayout { width, height, band_count: stored_bands(&self.shape) };
            self.table = TableBuffers::new(gpu, layout)?;
        }
        (self.params.table_width, self.params.table_height) = (width as u32, height as u32);
        self.update_table(gpu)
    }

    fn update_table(&mut self, gpu: &Gpu) -> Result<(), Error> {
        self.is_table_stale = self.params.table_width > 0 && self.params.used_bands > 0;
        let LobeParams { first_band, used_bands, light, .. } = self.params;
        self.table.set_light(gpu, &light, [first_band, used_bands])
    }

    /// Returns whether shading changes.
    pub(crate) fn set_eye(&mut self, eye: Option<[f32; 3]>) -> bool {
        let before = (self.params.eye, self.params.has_eye);
        // An eye that is not finite has no direction.
        let eye = eye.filter(|eye| eye.iter().all(|x| x.is_finite()));
        (self.params.eye, self.params.has_eye) = (eye.unwrap_or_default(), u32::from(eye.is_some()));
        self.params.view_size > 0 && before != (self.params.eye, self.params.has_eye)
    }

    /// Builds the table, if the light has changed.
    pub(crate) fn record(&mut self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder) -> Result<(), Error> {
        if std::mem::take(&mut self.is_table_stale) {
            gpu.lobe_passes()?.build_table.record(encoder, &self.table);
        }
        Ok(())
    }

    /// What the pipelines that shade are compiled for; it changes with the light's order and the evaluation.
    pub(crate) fn constants(&self) -> Constants {
        Constants {
            order: self.params.first_band + self.params.used_bands,
            first_band: self.params.first_band,
            use_table: self.params.table_width > 0,
            is_grey: self.params.channels == 1,
            has_view_map: self.params.view_size > 0,
            sampling: None,
        }
    }

    pub(crate) fn params(&self) -> &LobeParams {
        &self.params
    }

    /// Bindings 12 and 13 of `shared/lobes.wgsl`.
    pub(crate) fn buffers(&self) -> [(u32, &wgpu::Buffer); 2] {
        [(12, self.table.texels()), (13, self.view_map.buffer())]
    }

    /// Size of the table with the bands in use; none if the light is evaluated directly.
    pub(crate) fn table_layout(&self) -> Option<TableLayout> {
        let LobeParams { table_width, table_height, used_bands, .. } = self.params;
        let [width, height, band_count] = [table_width, table_height, used_bands].map(|x| x as usize);
        (width > 0).then_some(TableLayout { width, height, band_count })
    }

    /// The table's texels, `[H + 2, W + 1, bands in use]`.
    pub(crate) fn table(&self) -> &wgpu::Buffer {
        self.table.texels()
    }
}

fn stored_bands(shape: &LobeShape) -> usize {
    shape.order.get().saturating_sub(shape.first_band())
}
