use crate::buffers::read_texture;
use crate::pass::{DrawSurface, Resolve, bind};
use crate::{Error, Frame, Gpu};

/// The images that a surface is drawn to: nearest triangles, then radiance and depth.
///
/// Memory: `8 samples² + 20` bytes per pixel.
#[derive(Debug)]
pub struct Target {
    size: [u32; 2],
    samples: u32,
    color: wgpu::Texture,
    depth: wgpu::Texture,
    pub(crate) nearest: wgpu::TextureView,
    pub(crate) sample_depth: wgpu::TextureView,
    pub(crate) resolve_group: wgpu::BindGroup,
    views: [wgpu::TextureView; 2],
}

impl Target {
    /// Images of `width` by `height` pixels, with `samples` samples per pixel along each axis.
    ///
    /// # Errors
    /// [`Error::View`] as [`crate::View::check`], [`Error::Limit`] if the adapter has no textures of that size, [`Error::Device`].
    pub fn new(gpu: &Gpu, width: u32, height: u32, samples: u32) -> Result<Self, Error> {
        crate::View::new([[0.0; 4]; 4], width, height, samples)?;
        let (limit, side) = (gpu.device().limits().max_texture_dimension_2d, width.max(height) * samples);
        if side > limit {
            let what = format!("an image of {width} x {height} with {samples} samples per axis");
            return Err(gpu.limit_error(what, side.into(), "samples in a row or column", limit.into()));
        }
        gpu.checked("allocating images", || Self::allocate(gpu, [width, height], samples))
    }

    fn allocate(gpu: &Gpu, size: [u32; 2], samples: u32) -> Self {
        use wgpu::TextureUsages as Usage;
        let sample_size = size.map(|side| side * samples);
        let pixels = Usage::STORAGE_BINDING | Usage::TEXTURE_BINDING | Usage::COPY_SRC;
        let color = texture(gpu, size, Resolve::COLOR_FORMAT, pixels);
        let depth = texture(gpu, size, Resolve::DEPTH_FORMAT, pixels);
        let nearest =
            texture(gpu, sample_size, DrawSurface::NEAREST_FORMAT, Usage::RENDER_ATTACHMENT | Usage::TEXTURE_BINDING);
        let sample_depth = texture(gpu, sample_size, DrawSurface::DEPTH_FORMAT, Usage::RENDER_ATTACHMENT);
        let [nearest, sample_depth] = [nearest, sample_depth].map(|t| t.create_view(&Default::default()));
        let views = [&color, &depth].map(|t| t.create_view(&Default::default()));
        let resolve_group = bind_images(gpu, &gpu.passes().resolve, &nearest, &views);
        Self { size, samples, color, depth, nearest, sample_depth, resolve_group, views }
    }

    /// The images, bound for another pass that resolves.
    pub(crate) fn bind(&self, gpu: &Gpu, resolve: &Resolve) -> wgpu::BindGroup {
        bind_images(gpu, resolve, &self.nearest, &self.views)
    }

    /// Pixels.
    pub fn width(&self) -> u32 {
        self.size[0]
    }

    /// Pixels.
    pub fn height(&self) -> u32 {
        self.size[1]
    }

    /// Samples per pixel along each axis.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// `rgba32float`: radiance premultiplied by coverage, and coverage.
    pub fn color(&self) -> &wgpu::Texture {
        &self.color
    }

    /// `r32float`: smallest clip depth, 1 where there is nothing.
    pub fn depth(&self) -> &wgpu::Texture {
        &self.depth
    }

    /// Waits for the GPU and reads back what was drawn and submitted.
    ///
    /// # Errors
    /// [`Error::Device`].
    pub fn read(&self, gpu: &Gpu) -> Result<Frame, Error> {
        Ok(Frame {
            width: self.width() as usize,
            height: self.height() as usize,
            pixels: read_texture(gpu, &self.color)?,
            depth: read_texture(gpu, &self.depth)?,
        })
    }
}

fn bind_images(
    gpu: &Gpu,
    resolve: &Resolve,
    nearest: &wgpu::TextureView,
    views: &[wgpu::TextureView; 2],
) -> wgpu::BindGroup {
    let resources = [nearest, &views[0], &views[1]].map(wgpu::BindingResource::TextureView);
    bind(gpu.device(), &resolve.target_layout(), &resources)
}

fn texture(
    gpu: &Gpu,
    [width, height]: [u32; 2],
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}
