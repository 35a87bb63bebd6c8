//! What faces look like: base colour, holes, and whether both sides count.

mod texture;

use std::collections::HashSet;
use std::sync::Arc;

#[cfg(feature = "trace")]
use crate::hash::Content;
pub use texture::{Texture, TextureMap, TextureWrap};

/// The material of some faces of a mesh.
///
/// The base colour at a point is `base_color · texture`; its first three channels are the diffuse albedo, the fourth decides where the
/// surface has holes.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceMaterial {
    /// As the file names it; may be empty.
    pub name: String,
    /// Linear red, green, blue, and alpha; the texture multiplies it.
    pub base_color: [f32; 4],
    /// The texture of the base colour.
    pub texture: Option<TextureMap>,
    /// The surface is there only where alpha is at least this; everywhere if `None`.
    pub alpha_cutoff: Option<f32>,
    /// Whether the back of a face is a surface like its front.
    pub two_sided: bool,
}

impl Default for SurfaceMaterial {
    /// White, opaque, one-sided.
    fn default() -> Self {
        Self { name: String::new(), base_color: [1.0; 4], texture: None, alpha_cutoff: None, two_sided: false }
    }
}

impl SurfaceMaterial {
    /// The number of the material of a face that has none.
    pub const NONE: u32 = u32::MAX;

    /// Whether some point of a surface of this material may be a hole.
    #[must_use]
    pub fn may_have_holes(&self) -> bool {
        let least = self.texture.as_ref().map_or(1.0, |map| map.texture.least_alpha());
        self.alpha_cutoff.is_some_and(|cutoff| self.base_color[3] * least < cutoff)
    }

    /// Whether the surface is there at a texture coordinate.
    #[must_use]
    pub fn is_there(&self, uv: [f32; 2]) -> bool {
        let Some(cutoff) = self.alpha_cutoff else { return true };
        let alpha = self.texture.as_ref().map_or(1.0, |map| map.alpha(uv.map(f64::from)));
        f64::from(self.base_color[3]) * alpha >= f64::from(cutoff)
    }

    /// Linear colour of the surface at a texture coordinate, between 0 and 1.
    #[must_use]
    pub fn color(&self, uv: [f32; 2]) -> [f32; 3] {
        let texel = self.texture.as_ref().map_or([1.0; 3], |map| map.color(uv.map(f64::from)));
        [0, 1, 2].map(|channel| (f64::from(self.base_color[channel]) * texel[channel]).clamp(0.0, 1.0) as f32)
    }

    /// Adds what decides the bytes of a bake to a fingerprint: names do not, and two-sidedness only by the twins that the mesh has.
    #[cfg(feature = "trace")]
    pub(crate) fn add_to(&self, content: &mut Content) {
        let Self { name: _, base_color, texture, alpha_cutoff, two_sided: _ } = self;
        content.array(base_color, f32::to_le_bytes);
        content.array(alpha_cutoff.as_slice(), f32::to_le_bytes);
        content.array(&[u8::from(texture.is_some())], u8::to_le_bytes);
        if let Some(map) = texture {
            map.add_to(content);
        }
    }

    /// Whether no point of the surface has a hue.
    pub(crate) fn is_gray(&self) -> bool {
        let [red, green, blue, _] = self.base_color;
        red == green && green == blue && self.texture.as_ref().is_none_or(|map| map.texture.is_gray())
    }
}

/// Bytes of the textures of some materials, each texture counted once.
pub(crate) fn texture_bytes(materials: &[SurfaceMaterial]) -> usize {
    let textures = materials.iter().filter_map(|material| material.texture.as_ref());
    let mut seen = HashSet::new();
    textures.filter(|map| seen.insert(Arc::as_ptr(&map.texture))).map(|map| map.texture.memory_bytes()).sum()
}

#[cfg(test)]
mod tests;
