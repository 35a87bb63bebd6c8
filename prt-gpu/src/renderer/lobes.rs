use super::stage::{Stage, submit};
use crate::buffers::read_buffer;
use crate::cpu::check_frames;
use crate::pass::{LobeShading, ShadingLimits, Skinning};
use crate::surface::check_light;
use crate::{Error, Evaluation, Frame, Gpu, LobeSurface, LobeTable, PoseFrames, Skin, Target, View};
use sh_core::Order;

/// A surface with lobes per vertex on the GPU, ready to be lit, posed and drawn.
///
/// Work is done only where something changed: the table of the light when the light did, shading when light, pose, albedo or, for glossy
/// lobes, the eye did, projection when view or pose did. Triangles are projected on the CPU, which therefore needs the
/// positions of every pose.
#[derive(Debug)]
pub struct LobeRenderer {
    stage: Stage,
    order: Order,
    shading: LobeShading,
    skinning: Option<Skinning>,
    /// Something is newer than the radiance.
    is_stale: bool,
    /// The radiance is the caller's colours.
    shows_colors: bool,
}

impl LobeRenderer {
    /// Uploads a surface, in its rest pose. It is black until a light or colours are set.
    ///
    /// Memory on the GPU: `4 R (C k + 3 N + C N b)` bytes per vertex for lobes of `b` bands (`n − 1` for k = 1, `n − 2` for k = 4), split
    /// over buffers that the adapter can bind; 96 bytes per vertex, 48 more with a view map, and 12 per triangle beside it.
    ///
    /// # Errors
    /// [`Error::Lobes`] for an order above 10; [`Error::Limit`] for a surface too large for the adapter, or an adapter with fewer than 8
    /// storage buffers per shader; [`Error::Device`].
    pub fn new(gpu: &Gpu, surface: &LobeSurface<'_>) -> Result<Self, Error> {
        Self::with_limits(gpu, surface, ShadingLimits::of(gpu))
    }

    /// As [`LobeRenderer::new`], with shading split into smaller pieces than the adapter needs; larger ones are cut to its limits.
    ///
    /// # Errors
    /// As [`LobeRenderer::new`].
    pub fn with_limits(gpu: &Gpu, surface: &LobeSurface<'_>, limits: ShadingLimits) -> Result<Self, Error> {
        let shading = LobeShading::new(gpu, surface, limits.within(gpu))?;
        let inputs = vec![(4, shading.radiance().clone())];
        let stage = Stage::new(gpu, surface.positions, surface.triangles, &gpu.passes().resolve, inputs)?;
        Ok(Self {
            stage,
            order: surface.lobes.shape.order,
            shading,
            skinning: None,
            is_stale: false,
            shows_colors: false,
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
        let constants = self.shading.light.constants();
        self.shading.light.set_light(&self.stage.gpu, light, order)?;
        if constants == self.shading.light.constants() { Ok(()) } else { self.shading.rebind(&self.stage.gpu) }
    }

    /// Chooses between the light's table, of any size, and the direct formula. A new renderer has a table of 64 by 32.
    ///
    /// # Errors
    /// [`Error::Lobes`], [`Error::Device`].
    pub fn set_evaluation(&mut self, evaluation: Evaluation) -> Result<(), Error> {
        self.is_stale = true;
        self.shading.light.set_evaluation(&self.stage.gpu, evaluation)?;
        self.shading.rebind(&self.stage.gpu)
    }

    /// Poses the surface.
    ///
    /// - `positions`: `[V]`; triangles with a corner that is not finite are not drawn
    /// - `frames`: `[V]`, rotation from the rest pose, replaced as in [`crate::cpu::shade_lobes`]; without them the lobes stay as they are
    ///
    /// # Errors
    /// [`Error::Length`], [`Error::Device`].
    pub fn set_pose(&mut self, positions: &[[f32; 3]], frames: Option<&[[[f32; 3]; 3]]>) -> Result<(), Error> {
        self.stage.check_vertices("positions", positions.len())?;
        if let Some(frames) = frames {
            check_frames(frames, positions.len())?;
        }
        self.is_stale = true;
        self.stage.set_positions(positions);
        self.shading.set_pose(&self.stage.gpu, positions, frames.unwrap_or_default())
    }

    /// Prepares to pose the surface by [`LobeRenderer::set_joints`].
    ///
    /// # Errors
    /// [`Error::Length`] if the skin has other vertices, [`Error::Limit`], [`Error::Device`].
    pub fn set_skin(&mut self, skin: &Skin<'_>) -> Result<(), Error> {
        self.stage.check_vertices("skin", skin.positions.len())?;
        let pose = self.shading.pose();
        self.skinning = Some(Skinning::new(&self.stage.gpu, skin, PoseFrames::FromRest, pose)?);
        Ok(())
    }

    /// Poses the surface by its skin: frames on the GPU, positions on the GPU and, to be projected, on the CPU. The twin of
    /// [`crate::cpu::skin`].
    ///
    /// - `matrices`: column-major, from the rest pose to the pose, as many as joints or more
    ///
    /// # Errors
    /// [`Error::Lobes`] without a skin; [`Error::Length`], [`Error::NotFinite`], [`Error::Device`].
    pub fn set_joints(&mut self, matrices: &[[[f32; 4]; 4]]) -> Result<(), Error> {
        let skinning = self.skinning.as_mut().ok_or_else(no_skin)?;
        let positions = skinning.set_joints(&self.stage.gpu, matrices)?;
        self.stage.set_positions(&positions);
        self.is_stale = true;
        Ok(())
    }

    /// Replaces the albedo, `[V]` linear. Exact for transfer without interreflection, as [`crate::SurfaceRenderer::set_albedo`].
    ///
    /// # Errors
    /// [`Error::Length`].
    pub fn set_albedo(&mut self, albedo: &[[f32; 3]]) -> Result<(), Error> {
        self.stage.check_vertices("albedo", albedo.len())?;
        self.is_stale = true;
        self.shading.set_albedo(&self.stage.gpu, albedo)
    }

    /// Shows colours, `[V]` linear, in place of shading, until something else is set.
    ///
    /// # Errors
    /// [`Error::Length`].
    pub fn set_colors(&mut self, colors: &[[f32; 3]]) -> Result<(), Error> {
        self.stage.check_vertices("colors", colors.len())?;
        (self.is_stale, self.shows_colors) = (false, true);
        self.shading.set_radiance(&self.stage.gpu, colors)
    }

    /// Draws an image and reads it back. The twin of [`crate::cpu::render_lobes`].
    ///
    /// - `eye`: for glossy lobes, in the frame of the positions; without one they are seen along the local +z
    ///
    /// # Errors
    /// As [`crate::SurfaceRenderer::render`].
    pub fn render(&mut self, view: &View, eye: Option<[f32; 3]>) -> Result<Frame, Error> {
        let target = self.stage.take_target(view)?;
        submit(&self.stage.gpu.clone(), "drawing", |encoder| self.draw(encoder, view, eye, &target))?;
        self.stage.read_target(target)
    }

    /// Records the drawing of an image into `target`, for a window; show it with a [`crate::Presenter`].
    ///
    /// Draw at most once between submissions: what has changed is uploaded when the commands are submitted.
    ///
    /// # Errors
    /// [`Error::View`] if the target has another size than the view, and as [`LobeRenderer::render`].
    pub fn draw(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        view: &View,
        eye: Option<[f32; 3]>,
        target: &Target,
    ) -> Result<(), Error> {
        let gpu = self.stage.gpu.clone();
        let resolve = &gpu.passes().resolve;
        self.stage.project(view, target, resolve)?;
        self.record_shading(encoder, eye)?;
        self.stage.record(encoder, target, resolve, &target.resolve_group);
        Ok(())
    }

    /// Submits the shading that the next image would begin with, if something was set; does not wait for it.
    ///
    /// # Errors
    /// [`Error::Device`].
    pub fn shade(&mut self, eye: Option<[f32; 3]>) -> Result<(), Error> {
        submit(&self.stage.gpu.clone(), "shading", |encoder| self.record_shading(encoder, eye))
    }

    /// Shades and reads back the radiance of every vertex. The twin of [`crate::cpu::shade_lobes`].
    ///
    /// # Errors
    /// [`Error::Device`].
    pub fn read_radiance(&mut self, eye: Option<[f32; 3]>) -> Result<Vec<[f32; 3]>, Error> {
        self.shade(eye)?;
        let radiance = read_buffer::<[f32; 4]>(&self.stage.gpu, self.shading.radiance(), self.stage.vertex_count())?;
        Ok(radiance.into_iter().map(|[r, g, b, _]| [r, g, b]).collect())
    }

    /// Poses, shades, and reads back the frames: rotations from the rest pose. The twin of [`crate::cpu::skin`].
    ///
    /// # Errors
    /// [`Error::Device`].
    pub fn read_frames(&mut self) -> Result<Vec<[[f32; 3]; 3]>, Error> {
        self.shade(None)?;
        let pose = read_buffer::<[[f32; 4]; 3]>(&self.stage.gpu, self.shading.pose(), self.stage.vertex_count())?;
        Ok(pose.into_iter().map(|columns| columns.map(|[x, y, z, _]| [x, y, z])).collect())
    }

    /// Builds the table of the light and reads it back; none if the light is evaluated directly. The twin of [`crate::cpu::build_table`].
    ///
    /// # Errors
    /// [`Error::Device`].
    pub fn read_table(&mut self) -> Result<Option<LobeTable>, Error> {
        self.shade(None)?;
        let Some(layout) = self.shading.light.table_layout() else { return Ok(None) };
        let count = layout.texel_count() * layout.band_count;
        let bands = read_buffer::<[f32; 4]>(&self.stage.gpu, self.shading.light.table(), count)?;
        Ok(Some(LobeTable::from_bands(layout, &bands)))
    }

    fn record_shading(&mut self, encoder: &mut wgpu::CommandEncoder, eye: Option<[f32; 3]>) -> Result<(), Error> {
        let gpu = &self.stage.gpu;
        if let Some(skinning) = &mut self.skinning {
            skinning.record(gpu, encoder)?;
        }
        self.is_stale |= self.shading.light.set_eye(eye) && !self.shows_colors;
        if !std::mem::take(&mut self.is_stale) {
            return Ok(());
        }
        self.shows_colors = false;
        self.shading.upload_params(gpu)?;
        self.shading.light.record(gpu, encoder)?;
        self.shading.record(encoder);
        Ok(())
    }
}

pub(super) fn no_skin() -> Error {
    Error::Lobes("joints were set for a surface without a skin; set a skin before".into())
}
