use super::stage::{Stage, submit};
use crate::buffers::read_buffer;
use crate::pass::{Shading, ShadingLimits};
use crate::surface::check_light;
use crate::{Error, Frame, Gpu, Surface, Target, View};
use sh_core::Order;

/// A surface on the GPU, ready to be lit and drawn.
///
/// Work is done only where something changed: shading when the light or the albedo did, projection when the view did.
#[derive(Debug)]
pub struct SurfaceRenderer {
    stage: Stage,
    order: Order,
    shading: Shading,
    /// The light or the albedo is newer than the radiance.
    is_stale: bool,
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
        let shading = Shading::new(gpu, surface, limits.within(gpu))?;
        let inputs = vec![(4, shading.radiance().clone())];
        let stage = Stage::new(gpu, surface.positions, surface.triangles, &gpu.passes().resolve, inputs)?;
        Ok(Self { stage, order: surface.order, shading, is_stale: false })
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
        self.shading.set_light(&self.stage.gpu, light, order)
    }

    /// Replaces the albedo, `[V]` linear. For shadowed and unshadowed transfer that is exact; interreflected transfer keeps the
    /// albedo that it was baked with in what it reflects onto other vertices.
    ///
    /// # Errors
    /// [`Error::Length`].
    pub fn set_albedo(&mut self, albedo: &[[f32; 3]]) -> Result<(), Error> {
        self.stage.check_vertices("albedo", albedo.len())?;
        self.is_stale = true;
        self.shading.set_albedo(&self.stage.gpu, albedo)
    }

    /// Shows colours, `[V]` linear, in place of shading, until a light or an albedo is set.
    ///
    /// # Errors
    /// [`Error::Length`].
    pub fn set_colors(&mut self, colors: &[[f32; 3]]) -> Result<(), Error> {
        self.stage.check_vertices("colors", colors.len())?;
        self.is_stale = false;
        self.shading.set_radiance(&self.stage.gpu, colors)
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
        let target = self.stage.take_target(view)?;
        submit(&self.stage.gpu.clone(), "drawing", |encoder| self.draw(encoder, view, &target))?;
        self.stage.read_target(target)
    }

    /// Records the drawing of an image into `target`, for a window; show it with a [`crate::Presenter`].
    ///
    /// Draw at most once between submissions: the view is uploaded when the commands are submitted.
    ///
    /// # Errors
    /// [`Error::View`] if the target has another size than the view, and as [`SurfaceRenderer::render`].
    pub fn draw(&mut self, encoder: &mut wgpu::CommandEncoder, view: &View, target: &Target) -> Result<(), Error> {
        let gpu = self.stage.gpu.clone();
        let resolve = &gpu.passes().resolve;
        self.stage.project(view, target, resolve)?;
        self.record_shading(encoder);
        self.stage.record(encoder, target, resolve, &target.resolve_group);
        Ok(())
    }

    /// Submits the shading that the next image would begin with, if a light or an albedo was set; does not wait for it.
    ///
    /// # Errors
    /// [`Error::Device`].
    pub fn shade(&mut self) -> Result<(), Error> {
        submit(&self.stage.gpu.clone(), "shading", |encoder| {
            self.record_shading(encoder);
            Ok(())
        })
    }

    /// Shades and reads back the radiance of every vertex. The twin of [`crate::cpu::shade_vector`].
    ///
    /// # Errors
    /// [`Error::Device`].
    pub fn read_radiance(&mut self) -> Result<Vec<[f32; 3]>, Error> {
        self.shade()?;
        let radiance = read_buffer::<[f32; 4]>(&self.stage.gpu, self.shading.radiance(), self.stage.vertex_count())?;
        Ok(radiance.into_iter().map(|[r, g, b, _]| [r, g, b]).collect())
    }

    fn record_shading(&mut self, encoder: &mut wgpu::CommandEncoder) {
        if std::mem::take(&mut self.is_stale) {
            self.stage.gpu.passes().shade_vector.record(encoder, &self.shading);
        }
    }
}
