use crate::assemble::{Assembly, assemble};
use crate::buffers::{GpuVec, read_buffer};
use crate::layout::{ClipVertex, FrameParams, ScreenVertex};
use crate::pass::{Shading, ShadingLimits, bind};
use crate::surface::{check_length, check_light};
use crate::{Error, Frame, Gpu, Surface, Target, View};
use sh_core::Order;
use wgpu::BufferUsages as Usage;

/// A surface on the GPU, ready to be lit and drawn.
///
/// Work is done only where something changed: shading when the light or the albedo did, projection when the view did.
#[derive(Debug)]
pub struct SurfaceRenderer {
    gpu: Gpu,
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    order: Order,
    shading: Shading,
    /// The light or the albedo is newer than the radiance.
    is_stale: bool,
    screen: Screen,
    /// The view that `screen` was made for.
    projected: Option<View>,
    /// The images of the last [`SurfaceRenderer::render`].
    target: Option<Target>,
}

impl SurfaceRenderer {
    /// Uploads a surface. It is black until a light or colours are set.
    ///
    /// Memory on the GPU: transfer, `16 ⌈n²/4⌉ C` bytes per vertex, split over buffers that the adapter can bind; 48 bytes per
    /// vertex and 12 per triangle beside it.
    ///
    /// # Errors
    /// [`Error::Limit`] for a surface too large for the adapter, [`Error::Device`].
    pub fn new(gpu: &Gpu, surface: &Surface<'_>) -> Result<Self, Error> {
        Self::with_limits(gpu, surface, ShadingLimits::of(gpu))
    }

    /// As [`SurfaceRenderer::new`], with shading split into smaller pieces than the adapter needs; larger ones are cut to its limits.
    ///
    /// # Errors
    /// As [`SurfaceRenderer::new`].
    pub fn with_limits(gpu: &Gpu, surface: &Surface<'_>, limits: ShadingLimits) -> Result<Self, Error> {
        let adapter = ShadingLimits::of(gpu);
        let limits = ShadingLimits {
            buffer_bytes: limits.buffer_bytes.min(adapter.buffer_bytes),
            groups_per_side: limits.groups_per_side.min(adapter.groups_per_side),
        };
        let shading = Shading::new(gpu, surface, limits)?;
        let screen = Screen::new(gpu, surface, shading.radiance())?;
        Ok(Self {
            gpu: gpu.clone(),
            positions: surface.positions.to_vec(),
            triangles: surface.triangles.to_vec(),
            order: surface.order,
            shading,
            is_stale: false,
            screen,
            projected: None,
            target: None,
        })
    }

    /// Lights the surface.
    ///
    /// - `light`: `[3, k²]` for the `order` of `k` bands in use, incident radiance in the frame of the positions
    ///
    /// # Errors
    /// [`Error::OrderAboveStored`], [`Error::Length`], [`Error::NotFinite`]; the light is then as it was.
    pub fn set_light(&mut self, light: &[f32], order: Order) -> Result<(), Error> {
        check_light(light, order, self.order)?;
        self.is_stale = true;
        self.shading.set_light(&self.gpu, light, order)
    }

    /// Replaces the albedo, `[V]` linear. For shadowed and unshadowed transfer that is exact; interreflected transfer keeps the
    /// albedo that it was baked with in what it reflects onto other vertices.
    ///
    /// # Errors
    /// [`Error::Length`].
    pub fn set_albedo(&mut self, albedo: &[[f32; 3]]) -> Result<(), Error> {
        self.check_vertices("albedo", albedo.len())?;
        self.is_stale = true;
        self.shading.set_albedo(&self.gpu, albedo)
    }

    /// Shows colours, `[V]` linear, in place of shading, until a light or an albedo is set.
    ///
    /// # Errors
    /// [`Error::Length`].
    pub fn set_colors(&mut self, colors: &[[f32; 3]]) -> Result<(), Error> {
        self.check_vertices("colors", colors.len())?;
        self.is_stale = false;
        self.shading.set_radiance(&self.gpu, colors)
    }

    /// Draws an image and reads it back. The twin of [`crate::cpu::render`].
    ///
    /// Accuracy: coverage and depth equal the twin's bit by bit, radiance within 4e-6 of its mean (asserted by `tests/gpu.rs` on
    /// Mesa's software adapters).
    ///
    /// # Errors
    /// [`Error::View`], [`Error::NotFinite`] as [`View::check`]; [`Error::Limit`] for an image too large for the adapter;
    /// [`Error::Device`].
    pub fn render(&mut self, view: &View) -> Result<Frame, Error> {
        view.check()?;
        let target = match self.target.take().filter(|target| fits(target, view)) {
            Some(target) => target,
            None => Target::new(&self.gpu, view.width, view.height, view.samples)?,
        };
        self.submit("drawing", |renderer, encoder| renderer.draw(encoder, view, &target))?;
        let frame = target.read(&self.gpu)?;
        self.target = Some(target);
        Ok(frame)
    }

    /// Records the drawing of an image into `target`, for a window; show it with a [`crate::Presenter`].
    ///
    /// Draw at most once between submissions: the view is uploaded when the commands are submitted.
    ///
    /// # Errors
    /// [`Error::View`] if the target has another size than the view, and as [`SurfaceRenderer::render`].
    pub fn draw(&mut self, encoder: &mut wgpu::CommandEncoder, view: &View, target: &Target) -> Result<(), Error> {
        view.check()?;
        if !fits(target, view) {
            let [given, made] =
                [[view.width, view.height, view.samples], [target.width(), target.height(), target.samples()]];
            return Err(Error::View(format!(
                "a view of size and samples {given:?} was drawn into images made for {made:?}"
            )));
        }
        if self.projected != Some(*view) {
            self.projected = None;
            let assembly = assemble(&self.positions, &self.triangles, view);
            self.screen.upload(&self.gpu, &assembly, view, self.positions.len(), self.shading.radiance())?;
            self.projected = Some(*view);
        }
        self.record_shading(encoder);
        let passes = self.gpu.passes();
        passes.draw_surface.record(encoder, &self.screen.draw_group, self.screen.corner_count, target);
        passes.resolve.record(encoder, &self.screen.resolve_group, target);
        Ok(())
    }

    /// Submits the shading that the next image would begin with, if a light or an albedo was set; does not wait for it.
    ///
    /// # Errors
    /// [`Error::Device`].
    pub fn shade(&mut self) -> Result<(), Error> {
        self.submit("shading", |renderer, encoder| {
            renderer.record_shading(encoder);
            Ok(())
        })
    }

    /// Shades and reads back the radiance of every vertex. The twin of [`crate::cpu::shade_vector`].
    ///
    /// # Errors
    /// [`Error::Device`].
    pub fn read_radiance(&mut self) -> Result<Vec<[f32; 3]>, Error> {
        self.shade()?;
        let radiance = read_buffer::<[f32; 4]>(&self.gpu, self.shading.radiance(), self.positions.len())?;
        Ok(radiance.into_iter().map(|[r, g, b, _]| [r, g, b]).collect())
    }

    fn record_shading(&mut self, encoder: &mut wgpu::CommandEncoder) {
        if std::mem::take(&mut self.is_stale) {
            self.gpu.passes().shade_vector.record(encoder, &self.shading);
        }
    }

    /// Records commands and submits them.
    fn submit(
        &mut self,
        step: &'static str,
        record: impl FnOnce(&mut Self, &mut wgpu::CommandEncoder) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let gpu = self.gpu.clone();
        gpu.checked(step, || {
            let mut encoder = gpu.device().create_command_encoder(&Default::default());
            record(self, &mut encoder)?;
            gpu.queue().submit([encoder.finish()]);
            Ok(())
        })?
    }

    fn check_vertices(&self, what: &'static str, given: usize) -> Result<(), Error> {
        let needed = self.positions.len();
        check_length(what, given, "entries", needed, || format!("a surface of {needed} vertices"))
    }
}

fn fits(target: &Target, view: &View) -> bool {
    [target.width(), target.height(), target.samples()] == [view.width, view.height, view.samples]
}

/// The surface on the screen, for one view.
#[derive(Debug)]
struct Screen {
    frame: GpuVec<FrameParams>,
    vertices: GpuVec<ScreenVertex>,
    corners: GpuVec<[u32; 3]>,
    clips: GpuVec<ClipVertex>,
    corner_count: u32,
    draw_group: wgpu::BindGroup,
    resolve_group: wgpu::BindGroup,
}

impl Screen {
    fn new(gpu: &Gpu, surface: &Surface<'_>, radiance: &wgpu::Buffer) -> Result<Self, Error> {
        let frame = GpuVec::new(gpu, "frame parameters", Usage::UNIFORM, 1)?;
        let vertices = GpuVec::new(gpu, "vertices on the screen", Usage::STORAGE, surface.vertex_count())?;
        let corners = GpuVec::new(gpu, "triangles on the screen", Usage::STORAGE, surface.triangles.len())?;
        let clips = GpuVec::new(gpu, "clipped vertices", Usage::STORAGE, 1)?;
        let buffers = [frame.buffer(), vertices.buffer(), corners.buffer(), clips.buffer(), radiance];
        let [draw_group, resolve_group] = bind_screen(gpu, buffers)?;
        Ok(Self { frame, vertices, corners, clips, corner_count: 0, draw_group, resolve_group })
    }

    fn upload(
        &mut self,
        gpu: &Gpu,
        assembly: &Assembly,
        view: &View,
        vertex_count: usize,
        radiance: &wgpu::Buffer,
    ) -> Result<(), Error> {
        let params = FrameParams {
            size: [view.width, view.height],
            samples: view.samples,
            vertex_count: vertex_count as u32,
            front_count: assembly.front_count as u32,
            zero: 0,
            padding: [0; 2],
        };
        self.frame.write(gpu, &[params])?;
        let grown = self.vertices.write(gpu, &assembly.vertices)?
            | self.corners.write(gpu, &assembly.triangles)?
            | self.clips.write(gpu, &assembly.clips)?;
        self.corner_count = 3 * assembly.triangles.len() as u32;
        if grown {
            let buffers =
                [self.frame.buffer(), self.vertices.buffer(), self.corners.buffer(), self.clips.buffer(), radiance];
            [self.draw_group, self.resolve_group] = bind_screen(gpu, buffers)?;
        }
        Ok(())
    }
}

/// Binds frame, vertices, corners, clips and radiance for drawing and for resolving.
fn bind_screen(gpu: &Gpu, buffers: [&wgpu::Buffer; 5]) -> Result<[wgpu::BindGroup; 2], Error> {
    let resources = buffers.map(wgpu::Buffer::as_entire_binding);
    let passes = gpu.passes();
    gpu.checked("binding buffers", || {
        [
            bind(gpu.device(), &passes.draw_surface.layout(), &resources[..3]),
            bind(gpu.device(), &passes.resolve.screen_layout(), &resources),
        ]
    })
}
