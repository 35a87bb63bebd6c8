//! Textures, sampled at single points.

use std::sync::Arc;

#[cfg(feature = "trace")]
use crate::hash::Content;
use crate::image::srgb8_to_linear;

/// How a texture continues beyond its edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TextureWrap {
    /// It repeats.
    #[default]
    Repeat,
    /// It repeats, every other time turned over.
    MirroredRepeat,
    /// Its edge goes on for ever.
    ClampToEdge,
}

/// An image of base colours: sRGB and alpha.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    width: usize,
    height: usize,
    pixels: Vec<[u8; 4]>,
    wrap: [TextureWrap; 2],
    least_alpha: u8,
    is_gray: bool,
}

/// A texture in use: shared by the materials that show it, each with its own way of getting from the coordinates of a vertex to those
/// of the image, `offset + rotation · scale · uv` (KHR_texture_transform).
#[derive(Debug, Clone, PartialEq)]
pub struct TextureMap {
    /// The image.
    pub texture: Arc<Texture>,
    /// First step.
    pub scale: [f32; 2],
    /// Second step: counter-clockwise as seen with v running down, radians.
    pub rotation: f32,
    /// Third step.
    pub offset: [f32; 2],
}

/// The four texels around a point and their weights.
type Taps = [(usize, f64); 4];

impl Texture {
    /// - `pixels`: `[width * height]`, red, green and blue in sRGB, and alpha; rows from the top, as v runs
    /// - `wrap`: along u and along v
    ///
    /// # Panics
    /// If there are no pixels, or not as many as the size says.
    #[must_use]
    pub fn new(width: usize, height: usize, pixels: Vec<[u8; 4]>, wrap: [TextureWrap; 2]) -> Self {
        assert!(!pixels.is_empty() && width.checked_mul(height) == Some(pixels.len()), "{width} × {height} pixels");
        let least_alpha = pixels.iter().map(|pixel| pixel[3]).min().unwrap_or(u8::MAX);
        let is_gray = pixels.iter().all(|[red, green, blue, _]| red == green && green == blue);
        Self { width, height, pixels, wrap, least_alpha, is_gray }
    }

    /// Columns and rows.
    #[must_use]
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// Linear colour at a texture coordinate, bilinear between the centres of texels; white where the coordinate is not finite.
    #[must_use]
    pub fn color(&self, uv: [f64; 2]) -> [f64; 3] {
        let Some(taps) = self.taps(uv) else { return [1.0; 3] };
        let mut color = [0.0; 3];
        for (texel, weight) in taps {
            let [red, green, blue, _] = self.pixels[texel];
            for (sum, value) in color.iter_mut().zip([red, green, blue]) {
                *sum += weight * f64::from(srgb8_to_linear(value));
            }
        }
        color
    }

    /// Alpha at a texture coordinate, 0 to 1, sampled likewise; 1 where the coordinate is not finite.
    #[must_use]
    pub fn alpha(&self, uv: [f64; 2]) -> f64 {
        let Some(taps) = self.taps(uv) else { return 1.0 };
        taps.iter().map(|&(texel, weight)| weight * f64::from(self.pixels[texel][3])).sum::<f64>() / 255.0
    }

    /// Bytes held.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.pixels)
    }

    pub(crate) fn least_alpha(&self) -> f32 {
        f32::from(self.least_alpha) / 255.0
    }

    pub(crate) fn is_gray(&self) -> bool {
        self.is_gray
    }

    fn taps(&self, uv: [f64; 2]) -> Option<Taps> {
        if !uv.iter().all(|coordinate| coordinate.is_finite()) {
            return None;
        }
        let [x, y] = [uv[0] * self.width as f64 - 0.5, uv[1] * self.height as f64 - 0.5];
        let (left, top) = (x.floor(), y.floor());
        let (right_share, bottom_share) = (x - left, y - top);
        let columns = [left, left + 1.0].map(|column| wrapped(column, self.width, self.wrap[0]));
        let rows = [top, top + 1.0].map(|row| wrapped(row, self.height, self.wrap[1]) * self.width);
        Some([
            (rows[0] + columns[0], (1.0 - right_share) * (1.0 - bottom_share)),
            (rows[0] + columns[1], right_share * (1.0 - bottom_share)),
            (rows[1] + columns[0], (1.0 - right_share) * bottom_share),
            (rows[1] + columns[1], right_share * bottom_share),
        ])
    }
}

impl TextureMap {
    /// A texture whose coordinates are those of the vertices.
    #[must_use]
    pub fn new(texture: Arc<Texture>) -> Self {
        Self { texture, scale: [1.0; 2], rotation: 0.0, offset: [0.0; 2] }
    }

    /// See [`Texture::color`].
    #[must_use]
    pub fn color(&self, uv: [f64; 2]) -> [f64; 3] {
        self.texture.color(self.transform(uv))
    }

    /// See [`Texture::alpha`].
    #[must_use]
    pub fn alpha(&self, uv: [f64; 2]) -> f64 {
        self.texture.alpha(self.transform(uv))
    }

    /// Adds the image and its place to a fingerprint.
    #[cfg(feature = "trace")]
    pub(crate) fn add_to(&self, content: &mut Content) {
        let Self { texture, scale, rotation, offset } = self;
        content.array(&[scale[0], scale[1], *rotation, offset[0], offset[1]], f32::to_le_bytes);
        content.array(&[texture.width as u64, texture.height as u64], u64::to_le_bytes);
        content.array(&texture.wrap.map(|wrap| wrap as u8), u8::to_le_bytes);
        content.bytes(texture.pixels.as_flattened());
    }

    /// The rotation is as the extension's words, Khronos's sample viewer and three.js have it (its GLSL sample turns the other way).
    fn transform(&self, uv: [f64; 2]) -> [f64; 2] {
        let [u, v] = [0, 1].map(|axis| uv[axis] * f64::from(self.scale[axis]));
        let [x, y] = self.offset.map(f64::from);
        if self.rotation == 0.0 {
            return [u + x, v + y];
        }
        let (sin, cos) = f64::from(self.rotation).sin_cos();
        [cos * u + sin * v + x, cos * v - sin * u + y]
    }
}

/// Brings a whole texel coordinate into `0..size`.
fn wrapped(coordinate: f64, size: usize, wrap: TextureWrap) -> usize {
    let period = size as f64;
    let inside = match wrap {
        TextureWrap::Repeat => coordinate.rem_euclid(period),
        TextureWrap::ClampToEdge => coordinate,
        TextureWrap::MirroredRepeat => {
            let phase = coordinate.rem_euclid(2.0 * period);
            if phase < period { phase } else { 2.0 * period - 1.0 - phase }
        }
    };
    // The cast saturates, which is the clamping.
    (inside as usize).min(size - 1)
}
