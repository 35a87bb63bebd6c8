use super::lobes::no_skin;
use super::stage::{Stage, submit};
use crate::cpu::check_frames;
use crate::pass::{Resolve, Skinning, TextureShading};
use crate::surface::check_light;
use crate::{Error, Evaluation, Frame, Gpu, PoseFrames, Skin, Target, TexturedSurface, View};
use sh_core::Order;

/// A surface with a texture of lobes on the GPU, shaded at every sample.
///
/// Work is done only where something changed: the table of the light when the light did, projection when view or pose did. Triangles are
/// projected on the CPU, which therefore needs the positions of every pose.
#[derive(Debug)]
pub struct TexturedRenderer {
    stage: Stage,
    order: Order,
    shading: TextureShading,
    /// The pass that the stage is bound for.
    resolve: Resolve,
    skinning: Option<Skinning>,
}

impl TexturedRenderer {
    /// Uploads a surface. It is black until a light is set; until a pose is set its frames are the identity.
    ///
    /// Memory on the GPU: `4 R (C k + 3 N + C N b)` bytes per texel for lobes of `b` bands, 12 more with an albedo, in one buffer; 96 bytes per
    /// vertex and 12 per triangle beside it.
    ///
    /// # Errors
    /// As [`crate::LobeRenderer::new`]; [`Error::Limit`] for a texture too large for one buffer.
    pub fn new(gpu: &Gpu, surface: &TexturedSurface<'_>) -> Result<Self, Error> {
        let shading = TextureShading::new(gpu, surface)?;
        let resolve = shading.pass(gpu)?;
        let stage = Stage::new(gpu, surface.positions, surface.triangles, &resolve, shading.buffers())?;
        Ok(Self { stage, order: surface.texture.lobes.shape.order, shading, resolve, skinning: None })
    }

    /// Lights the surface; as [`crate::LobeRenderer::set_light`].
    ///
    /// # Errors
    /// [`Error::OrderAboveStored`], [`Error::Length`], [`Error::NotFinite`]; the light is then as it was.
    pub fn set_light(&mut self, light: &[f32], order: Order) -> Result<(), Error> {
        check_light(light, order, self.order)?;
        let constants = self.shading.light.constants();
        self.shading.light.set_light(&self.stage.gpu, light, order)?;
        if constants == self.shading.light.constants() { Ok(()) } else { self.rebind() }
    }

    /// As [`crate::LobeRenderer::set_evaluation`].
    ///
    /// # Errors
    /// [`Error::Lobes`], [`Error::Device`].
    pub fn set_evaluation(&mut self, evaluation: Evaluation) -> Result<(), Error> {
        self.shading.light.set_evaluation(&self.stage.gpu, evaluation)?;
        self.rebind()
    }

    /// Compiles and binds anew, after a change of the light's order or evaluation.
    fn rebind(&mut self) -> Result<(), Error> {
        self.resolve = self.shading.pass(&self.stage.gpu)?;
        self.stage.set_inputs(&self.resolve, self.shading.buffers())
    }

    /// Poses the surface.
    ///
    /// - `positions`: `[V]`; triangles with a corner that is not finite are not drawn
    /// - `frames`: `[V]`, `[tangent, bitangent, normal]`, replaced as in [`crate::cpu::shade_lobes`]; identity without them
    ///
    /// # Errors
    /// [`Error::Length`], [`Error::Device`].
    pub fn set_pose(&mut self, positions: &[[f32; 3]], frames: Option<&[[[f32; 3]; 3]]>) -> Result<(), Error> {
        self.stage.check_vertices("positions", positions.len())?;
        if let Some(frames) = frames {
            check_frames(frames, positions.len())?;
        }
        self.stage.set_positions(positions);
        self.shading.set_pose(&self.stage.gpu, positions, frames.unwrap_or_default())
    }

    /// Prepares to pose the surface by [`TexturedRenderer::set_joints`].
    ///
    /// # Errors
    /// [`Error::Length`] if the skin has other vertices, [`Error::Limit`], [`Error::Device`].
    pub fn set_skin(&mut self, skin: &Skin<'_>) -> Result<(), Error> {
        self.stage.check_vertices("skin", skin.positions.len())?;
        self.skinning = Some(Skinning::new(&self.stage.gpu, skin, PoseFrames::Tangent, self.shading.pose())?);
        Ok(())
    }

    /// Poses the surface by its skin, as [`crate::LobeRenderer::set_joints`]: frames are those of the skin, posed.
    ///
    /// # Errors
    /// [`Error::Lobes`] without a skin; [`Error::Length`], [`Error::NotFinite`], [`Error::Device`].
    pub fn set_joints(&mut self, matrices: &[[[f32; 4]; 4]]) -> Result<(), Error> {
        let skinning = self.skinning.as_mut().ok_or_else(no_skin)?;
        let positions = skinning.set_joints(&self.stage.gpu, matrices)?;
        self.stage.set_positions(&positions);
        Ok(())
    }

    /// Replaces the albedo of vertices, `[V]` linear, which multiplies that of the texture.
    ///
    /// # Errors
    /// [`Error::Length`].
    pub fn set_albedo(&mut self, albedo: &[[f32; 3]]) -> Result<(), Error> {
        self.stage.check_vertices("albedo", albedo.len())?;
        self.shading.set_albedo(&self.stage.gpu, albedo)
    }

    /// Draws an image and reads it back. The twin of [`crate::cpu::render_textured`].
    ///
    /// - `eye`: for glossy lobes, in the frame of the positions; without one they are seen along the normal
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
    /// [`Error::View`] if the target has another size than the view, and as [`TexturedRenderer::render`].
    pub fn draw(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        view: &View,
        eye: Option<[f32; 3]>,
        target: &Target,
    ) -> Result<(), Error> {
        let gpu = self.stage.gpu.clone();
        let resolve = &self.resolve;
        self.stage.project(view, target, resolve)?;
        if let Some(skinning) = &mut self.skinning {
            skinning.record(&gpu, encoder)?;
        }
        self.shading.light.set_eye(eye);
        self.shading.upload_params(&gpu)?;
        self.shading.light.record(&gpu, encoder)?;
        self.stage.record(encoder, target, resolve, &target.bind(&gpu, resolve));
        Ok(())
    }
}
