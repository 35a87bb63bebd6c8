use super::{bind, compile};
use crate::buffers::GpuVec;
use crate::layout::PresentParams;
use crate::shaders::PRESENT;
use crate::{Error, Gpu, Target, View};

/// Shows a [`Target`] in a render pass of the caller, tone-mapped as [`crate::tone_map`] does it.
///
/// [`Presenter::prepare`] once a frame, then [`Presenter::paint`] in the pass: it covers the viewport, needs no depth buffer, and
/// leaves alpha at 1.
#[derive(Debug)]
pub struct Presenter {
    gpu: Gpu,
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    params: GpuVec<PresentParams>,
    no_background: Background,
    group: Option<wgpu::BindGroup>,
}

/// How a [`Presenter`] shows an image.
#[derive(Debug, Clone, Copy, Default)]
pub struct PresentOptions<'a> {
    /// Radiance is multiplied by 2 to this power.
    pub exposure_stops: f32,
    /// The environment to show where the surface does not cover, and the view that the image was drawn with.
    pub background: Option<(&'a Background, &'a View)>,
}

impl Presenter {
    /// For a pass whose colour target has the `format`, any that can be drawn to; sRGB encoding is left to formats that do it.
    ///
    /// # Errors
    /// [`Error::Device`].
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Result<Self, Error> {
        let layout = gpu.checked("compiling the shaders", || bind_group_layout(gpu.device()))?;
        let pipeline = gpu.checked("compiling the shaders", || pipeline(gpu.device(), &layout, format))?;
        let params = GpuVec::new(gpu, "display parameters", wgpu::BufferUsages::UNIFORM, 1)?;
        let no_background = Background::new(gpu, 1, 1, &[[0.0; 3]])?;
        Ok(Self { gpu: gpu.clone(), pipeline, layout, params, no_background, group: None })
    }

    /// Chooses what [`Presenter::paint`] shows.
    ///
    /// # Errors
    /// [`Error::Device`]; [`Error::View`] if a background was asked for and the camera matrix has no inverse.
    pub fn prepare(&mut self, target: &Target, options: &PresentOptions<'_>) -> Result<(), Error> {
        let world_from_clip = match options.background {
            None => [[0.0; 4]; 4],
            Some((_, view)) => {
                invert(&view.clip_from_world).ok_or_else(|| Error::View("the camera matrix has no inverse".into()))?
            }
        };
        let params = PresentParams {
            world_from_clip,
            exposure: options.exposure_stops.exp2(),
            show_background: u32::from(options.background.is_some()),
            padding: [0; 2],
        };
        self.params.write(&self.gpu, &[params])?;
        let background = options.background.map_or(&self.no_background, |(background, _)| background);
        let views = [target.color(), &background.texture].map(|texture| texture.create_view(&Default::default()));
        let resources = [
            self.params.buffer().as_entire_binding(),
            wgpu::BindingResource::TextureView(&views[0]),
            wgpu::BindingResource::TextureView(&views[1]),
        ];
        self.group = Some(self.gpu.checked("binding images", || bind(self.gpu.device(), &self.layout, &resources))?);
        Ok(())
    }

    /// Draws what was prepared over the viewport of the pass; nothing before [`Presenter::prepare`].
    pub fn paint(&self, pass: &mut wgpu::RenderPass<'_>) {
        if let Some(group) = &self.group {
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, group, &[]);
            pass.draw(0..3, 0..1);
        }
    }
}

/// An environment on the GPU: latitude-longitude, y up, `u = atan2(x, −z) / 2π`, `v = acos(y) / π`, as Mitsuba's `envmap`.
#[derive(Debug)]
pub struct Background {
    texture: wgpu::Texture,
}

impl Background {
    /// Uploads `[height · width]` linear radiance, rows from the top (+y).
    ///
    /// # Errors
    /// [`Error::Length`], [`Error::Limit`], [`Error::Device`].
    pub fn new(gpu: &Gpu, width: u32, height: u32, pixels: &[[f32; 3]]) -> Result<Self, Error> {
        let needed = width as usize * height as usize;
        crate::surface::check_length("background", pixels.len(), "pixels", needed, || {
            format!("an image of {width} x {height}")
        })?;
        let (limit, side) = (gpu.device().limits().max_texture_dimension_2d, width.max(height));
        if side > limit || needed == 0 {
            return Err(gpu.limit_error(
                format!("a background of {width} x {height}"),
                side.into(),
                "pixels in a row or column",
                limit.into(),
            ));
        }
        let texture = gpu.checked("uploading a background", || upload(gpu, width, height, pixels))?;
        Ok(Self { texture })
    }
}

fn upload(gpu: &Gpu, width: u32, height: u32, pixels: &[[f32; 3]]) -> wgpu::Texture {
    let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
    let texture = gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: Some("background"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let texels = crate::layout::pad(pixels);
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(16 * width), rows_per_image: None };
    gpu.queue().write_texture(texture.as_image_copy(), bytemuck::cast_slice(&texels), layout, size);
    texture
}

fn bind_group_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let entry =
        |binding, ty| wgpu::BindGroupLayoutEntry { binding, visibility: wgpu::ShaderStages::FRAGMENT, ty, count: None };
    let uniform = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    // Read texel by texel: adapters need not filter 32-bit floats.
    let image = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: false },
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let entries = [entry(0, uniform), entry(1, image), entry(2, image)];
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(PRESENT.name), entries: &entries })
}

fn pipeline(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    format: wgpu::TextureFormat,
) -> wgpu::RenderPipeline {
    let module = compile(device, PRESENT);
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(PRESENT.name),
        bind_group_layouts: &[Some(layout)],
        immediate_size: 0,
    });
    let constants = [("ENCODE_SRGB", f64::from(u8::from(!format.is_srgb())))];
    let options = wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(PRESENT.name),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: None,
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: None,
            compilation_options: options,
            targets: &[Some(format.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// Inverse of a column-major matrix by Gauss-Jordan elimination with row pivoting in `f64`; `None` if it is singular.
fn invert(matrix: &[[f32; 4]; 4]) -> Option<[[f32; 4]; 4]> {
    // Row r of [M | I].
    let mut rows: [[f64; 8]; 4] = std::array::from_fn(|r| {
        std::array::from_fn(|c| if c < 4 { matrix[c][r].into() } else { f64::from(u8::from(c == r + 4)) })
    });
    for pivot in 0..4 {
        let largest = (pivot..4).max_by(|&a, &b| rows[a][pivot].abs().total_cmp(&rows[b][pivot].abs()))?;
        rows.swap(pivot, largest);
        let scale = 1.0 / rows[pivot][pivot];
        if !scale.is_finite() {
            return None;
        }
        rows[pivot] = rows[pivot].map(|x| x * scale);
        for row in (0..4).filter(|&row| row != pivot) {
            let factor = rows[row][pivot];
            rows[row] = std::array::from_fn(|c| rows[row][c] - factor * rows[pivot][c]);
        }
    }
    Some(std::array::from_fn(|c| std::array::from_fn(|r| rows[r][c + 4] as f32)))
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;

    #[test]
    fn an_inverse_times_the_matrix_is_the_identity() {
        let matrix = [[0.0, 2.0, 0.0, 0.5], [1.0, 0.0, 3.0, 0.0], [0.0, 1.0, -1.0, -1.0], [4.0, 5.0, 6.0, 7.0]];
        let inverse = invert(&matrix).unwrap();
        for (c, column) in inverse.iter().enumerate() {
            let product: [f32; 4] = std::array::from_fn(|r| (0..4).map(|k| matrix[k][r] * column[k]).sum());
            for (r, x) in product.into_iter().enumerate() {
                assert!((x - f32::from(u8::from(c == r))).abs() < 1e-5, "column {c}, row {r}: {x}");
            }
        }
    }

    #[test]
    fn a_singular_matrix_has_no_inverse() {
        assert_eq!(invert(&[[1.0; 4]; 4]), None);
        assert_eq!(invert(&[[0.0; 4]; 4]), None);
    }
}
