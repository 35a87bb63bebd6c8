use super::compile;
use crate::shaders::Shader;
use crate::{Error, Gpu};
use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

/// Constants of a pipeline of lobes: the overrides of `shared/lobes.wgsl` and `resolve_texture.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Constants {
    pub(crate) order: u32,
    pub(crate) first_band: u32,
    pub(crate) use_table: bool,
    pub(crate) is_grey: bool,
    pub(crate) has_view_map: bool,
    /// For textures only.
    pub(crate) sampling: Option<u32>,
}

impl Constants {
    fn overrides(&self) -> Vec<(&'static str, f64)> {
        let of_lobes = [
            ("ORDER", f64::from(self.order)),
            ("FIRST_BAND", f64::from(self.first_band)),
            ("USE_TABLE", f64::from(u8::from(self.use_table))),
            ("IS_GREY", f64::from(u8::from(self.is_grey))),
            ("HAS_VIEW_MAP", f64::from(u8::from(self.has_view_map))),
        ];
        of_lobes.into_iter().chain(self.sampling.map(|sampling| ("SAMPLING", f64::from(sampling)))).collect()
    }
}

/// The pipelines of one shader, compiled for the constants that were asked for.
///
/// Each has a layout of its own, for which its buffers have to be bound.
#[derive(Debug)]
pub(crate) struct Variants {
    module: wgpu::ShaderModule,
    label: &'static str,
    compiled: Mutex<HashMap<Constants, wgpu::ComputePipeline>>,
}

impl Variants {
    pub(crate) fn new(device: &wgpu::Device, shader: Shader) -> Self {
        Self { module: compile(device, shader), label: shader.name, compiled: Mutex::default() }
    }

    pub(crate) fn get(&self, gpu: &Gpu, constants: Constants) -> Result<wgpu::ComputePipeline, Error> {
        let mut compiled = self.compiled.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(pipeline) = compiled.get(&constants) {
            return Ok(pipeline.clone());
        }
        let pipeline = gpu.checked("compiling the shaders", || self.compile(gpu.device(), constants))?;
        compiled.insert(constants, pipeline.clone());
        Ok(pipeline)
    }

    fn compile(&self, device: &wgpu::Device, constants: Constants) -> wgpu::ComputePipeline {
        device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(self.label),
            layout: None,
            module: &self.module,
            entry_point: None,
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &constants.overrides(),
                ..Default::default()
            },
            cache: None,
        })
    }
}
