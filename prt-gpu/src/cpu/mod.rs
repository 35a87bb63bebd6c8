//! The plain twins of the GPU passes, for machines without a GPU and as the reference in tests.

mod build_table;
mod rasterize;
mod resolve_texture;
mod shade_lobes;
mod shade_vector;
mod skin;

pub use build_table::build_table;
pub use rasterize::rasterize;
pub use shade_lobes::shade_lobes;
pub use shade_vector::shade_vector;
pub use skin::skin;

pub(crate) use build_table::interleave;
pub(crate) use resolve_texture::texels_per_uv;
pub(crate) use skin::skinned_positions;

use crate::assemble::assemble;
use crate::surface::{check_length, check_light};
use crate::{Error, Evaluation, Frame, LobeSurface, Surface, TexturedSurface, View};
use resolve_texture::TexturePaint;
use sh_core::Order;
use shade_lobes::LobeLight;

/// Shades and draws a surface: the twin of [`crate::SurfaceRenderer::render`].
///
/// - `light`: `[3, k²]` for the `order` of `k` bands in use, incident radiance in the frame of the positions
///
/// The result does not depend on the number of threads.
///
/// # Errors
/// [`Error::OrderAboveStored`], [`Error::Length`], [`Error::NotFinite`] for the light; as [`View::check`] for the view.
pub fn render(surface: &Surface<'_>, light: &[f32], order: Order, view: &View) -> Result<Frame, Error> {
    check_light(light, order, surface.order)?;
    view.check()?;
    let mut radiance = vec![[0.0; 3]; surface.vertex_count()];
    shade_vector(surface, light, order, &mut radiance);
    Ok(rasterize(surface.positions, surface.triangles, &radiance, view))
}

/// Shades and draws a surface with lobes: the twin of [`crate::LobeRenderer::render`]. The positions are those of the pose.
///
/// Parameters are those of [`shade_lobes`]. The result does not depend on the number of threads.
///
/// # Errors
/// [`Error::OrderAboveStored`], [`Error::Length`], [`Error::NotFinite`] for the light; [`Error::Length`] for the frames; as
/// [`Evaluation::check`] and [`View::check`].
pub fn render_lobes(
    surface: &LobeSurface<'_>,
    frames: &[[[f32; 3]; 3]],
    light: &[f32],
    order: Order,
    eye: Option<[f32; 3]>,
    evaluation: Evaluation,
    view: &View,
) -> Result<Frame, Error> {
    check_light(light, order, surface.lobes.shape.order)?;
    evaluation.check()?;
    view.check()?;
    if !frames.is_empty() {
        check_frames(frames, surface.vertex_count())?;
    }
    let mut radiance = vec![[0.0; 3]; surface.vertex_count()];
    shade_lobes(surface, frames, light, order, eye, evaluation, &mut radiance);
    Ok(rasterize(surface.positions, surface.triangles, &radiance, view))
}

/// Draws a surface with a texture of lobes, shaded at every sample: the twin of [`crate::TexturedRenderer::render`].
///
/// - `frames`: `[V]`, `[tangent, bitangent, normal]` of the pose; interpolated over triangles and made orthonormal again. Replaced as in
///   [`shade_lobes`]
/// - `light`, `order`, `eye`: as in [`shade_lobes`]
///
/// The result does not depend on the number of threads.
///
/// # Errors
/// As [`render_lobes`].
pub fn render_textured(
    surface: &TexturedSurface<'_>,
    frames: &[[[f32; 3]; 3]],
    light: &[f32],
    order: Order,
    eye: Option<[f32; 3]>,
    evaluation: Evaluation,
    view: &View,
) -> Result<Frame, Error> {
    let shape = &surface.texture.lobes.shape;
    check_light(light, order, shape.order)?;
    evaluation.check()?;
    view.check()?;
    check_frames(frames, surface.vertex_count())?;
    let light = LobeLight::new(light, order, shape, evaluation);
    let paint = TexturePaint::new(surface, frames, &light, eye);
    Ok(rasterize::draw(assemble(surface.positions, surface.triangles, view), &paint, view))
}

/// Compares the number of frames with that of vertices.
pub(crate) fn check_frames(frames: &[[[f32; 3]; 3]], vertex_count: usize) -> Result<(), Error> {
    check_length("frames", frames.len(), "entries", vertex_count, || format!("a surface of {vertex_count} vertices"))
}
