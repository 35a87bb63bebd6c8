//! The plain twins of the GPU passes, for machines without a GPU and as the reference in tests.

mod rasterize;
mod shade_vector;

pub use rasterize::rasterize;
pub use shade_vector::shade_vector;

use crate::surface::check_light;
use crate::{Error, Frame, Surface, View};
use sh_core::Order;

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
