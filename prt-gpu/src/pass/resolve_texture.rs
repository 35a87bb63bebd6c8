use super::lobe_light::LobeLight;
use super::{Constants, Resolve};
use crate::buffers::GpuVec;
use crate::cpu::texels_per_uv;
use crate::layout::{self, LobeParams, TextureParams};
use crate::{Error, Gpu, LobeSampling, TexturedSurface};
use wgpu::BufferUsages as Usage;

/// What the pass `resolve_texture` reads for one surface, beside the screen.
#[derive(Debug)]
pub(crate) struct TextureShading {
    pub(crate) light: LobeLight,
    pose: GpuVec<[f32; 4]>,
    attributes: GpuVec<[f32; 4]>,
    uvs: Vec<[f32; 2]>,
    params: GpuVec<TextureParams>,
    lobe_params: GpuVec<LobeParams>,
    lobes: GpuVec<f32>,
    record_length: usize,
    sampling: LobeSampling,
}

impl TextureShading {
    /// The pass for what the light and its evaluation are now.
    pub(crate) fn pass(&self, gpu: &Gpu) -> Result<Resolve, Error> {
        let sampling = match self.sampling {
            LobeSampling::Nearest => 0,
            LobeSampling::PointLobes => 1,
            LobeSampling::Bilinear => 2,
        };
        let constants = Constants { sampling: Some(sampling), ..self.light.constants() };
        gpu.lobe_passes()?.resolve_texture.get(gpu, constants).map(Resolve::with_pipeline)
    }

    /// Uploads texture, coordinates and albedo; the pose has identity frames.
    pub(crate) fn new(gpu: &Gpu, surface: &TexturedSurface<'_>) -> Result<Self, Error> {
        let texture = &surface.texture;
        let albedo_item = layout::lobe_record_length(&texture.lobes.shape);
        let normal_item = albedo_item + if texture.albedo.is_some() { 3 } else { 0 };
        let record_length = normal_item + if texture.normals.is_some() { 3 } else { 0 };
        let bytes = (record_length * texture.width * texture.height * size_of::<f32>()) as u64;
        gpu.check_binding(format!("a texture of {} x {} texels", texture.width, texture.height), bytes)?;
        let params = TextureParams {
            size: [texture.width as u32, texture.height as u32],
            scale: texels_per_uv(surface),
            has_albedo: u32::from(texture.albedo.is_some()),
            albedo_item: albedo_item as u32,
            has_normals: u32::from(texture.normals.is_some()),
            normal_item: normal_item as u32,
        };
        let pose = layout::pack_pose(surface.positions, &[]);
        let mut shading = Self {
            light: LobeLight::new(gpu, &texture.lobes)?,
            pose: GpuVec::with_data(gpu, "pose", Usage::STORAGE | Usage::COPY_SRC, &pose)?,
            attributes: GpuVec::new(gpu, "attributes of vertices", Usage::STORAGE, 2 * surface.vertex_count())?,
            uvs: surface.uvs.to_vec(),
            params: GpuVec::with_data(gpu, "texture parameters", Usage::UNIFORM, &[params])?,
            lobe_params: GpuVec::new(gpu, "shading parameters", Usage::UNIFORM, 1)?,
            lobes: GpuVec::with_data(gpu, "texture of lobes", Usage::STORAGE, &records(surface))?,
            record_length,
            sampling: surface.sampling,
        };
        shading.set_albedo(gpu, surface.albedo)?;
        Ok(shading)
    }

    /// Uploads the light's and the eye's parameters.
    pub(crate) fn upload_params(&mut self, gpu: &Gpu) -> Result<(), Error> {
        let params = LobeParams { point_stride: self.record_length as u32, item_stride: 1, ..*self.light.params() };
        self.lobe_params.write(gpu, &[params]).map(drop)
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
        let pairs = self.uvs.iter().zip(albedo);
        let packed: Vec<[f32; 4]> =
            pairs.flat_map(|(&[u, v], &[r, g, b])| [[u, v, 0.0, 0.0], [r, g, b, 0.0]]).collect();
        self.attributes.write(gpu, &packed).map(drop)
    }

    /// `[V, 3]`, columns of the frames with positions.
    pub(crate) fn pose(&self) -> &wgpu::Buffer {
        self.pose.buffer()
    }

    /// Bindings from 4 on.
    pub(crate) fn buffers(&self) -> Vec<(u32, wgpu::Buffer)> {
        let [table, view_map] = self.light.buffers();
        let buffers = [
            (4, self.pose.buffer()),
            (5, self.attributes.buffer()),
            (6, self.params.buffer()),
            (10, self.lobe_params.buffer()),
            (11, self.lobes.buffer()),
            table,
            view_map,
        ];
        buffers.map(|(binding, buffer)| (binding, buffer.clone())).into()
    }
}

/// All texels, each one's record followed by its albedo and the normal of the relief.
fn records(surface: &TexturedSurface<'_>) -> Vec<f32> {
    let texture = &surface.texture;
    let texels = 0..texture.width * texture.height;
    let albedo = |texel: usize| texture.albedo.map(|albedo| albedo[texel]).into_iter().flatten();
    let normal = |texel: usize| texture.normals.map(|normals| normals[texel]).into_iter().flatten();
    texels
        .flat_map(|texel| layout::lobe_record(&texture.lobes, texel).chain(albedo(texel)).chain(normal(texel)))
        .collect()
}
