//! Base colour textures, sampled at single points.

use gltf::json::texture::{Sampler, WrappingMode};
use gltf::json::validation::Checked;
use gltf::json::{Index, Texture as Json};

use super::document::Document;
use super::uri;
use crate::image::{decode_rgb8, srgb8_to_linear};
use crate::input::Fault;

/// An sRGB image and how it continues beyond its edges.
#[derive(Debug)]
pub(super) struct Texture {
    width: usize,
    height: usize,
    /// Rows from the top, as `v` runs.
    pixels: Vec<[u8; 3]>,
    wrap: [WrappingMode; 2],
}

impl Texture {
    pub(super) fn load(document: &Document<'_>, index: Index<Json>) -> Result<Self, Fault> {
        let texture = document.get(index, "texture")?;
        let image = document.get(texture.source, "image")?;
        let bytes = match (&image.uri, image.buffer_view) {
            (_, Some(view)) => document.view(view)?.0.to_vec(),
            (Some(uri), None) => uri::load(uri, document.folder)?,
            (None, None) => return Err(Fault::malformed(format!("image {} has no data", texture.source))),
        };
        let (width, height, pixels) = decode_rgb8(&bytes).map_err(|fault| in_image(fault, texture.source.value()))?;
        let sampler = texture.sampler.map(|sampler| document.get(sampler, "sampler")).transpose()?;
        Ok(Self { width, height, pixels, wrap: wrap_modes(sampler) })
    }

    /// Linear colour at a texture coordinate, bilinear between the centres of texels.
    pub(super) fn sample(&self, uv: [f64; 2]) -> [f64; 3] {
        if !uv.iter().all(|coordinate| coordinate.is_finite()) {
            return [1.0; 3];
        }
        let [x, y] = [uv[0] * self.width as f64 - 0.5, uv[1] * self.height as f64 - 0.5];
        let (left, top) = (x.floor(), y.floor());
        let (right_share, bottom_share) = (x - left, y - top);
        let mut color = [0.0; 3];
        for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
            let weight = (if dx == 0.0 { 1.0 - right_share } else { right_share })
                * (if dy == 0.0 { 1.0 - bottom_share } else { bottom_share });
            let texel = self.texel(left + dx, top + dy);
            for (sum, value) in color.iter_mut().zip(texel) {
                *sum += weight * f64::from(srgb8_to_linear(value));
            }
        }
        color
    }

    fn texel(&self, x: f64, y: f64) -> [u8; 3] {
        let column = wrap(x, self.width, self.wrap[0]);
        let row = wrap(y, self.height, self.wrap[1]);
        self.pixels[row * self.width + column]
    }
}

/// Brings a whole texel coordinate into `0..size`.
fn wrap(coordinate: f64, size: usize, mode: WrappingMode) -> usize {
    let period = size as f64;
    let inside = match mode {
        WrappingMode::Repeat => coordinate.rem_euclid(period),
        WrappingMode::ClampToEdge => coordinate,
        WrappingMode::MirroredRepeat => {
            let phase = coordinate.rem_euclid(2.0 * period);
            if phase < period { phase } else { 2.0 * period - 1.0 - phase }
        }
    };
    // The cast saturates, which is the clamping.
    (inside as usize).min(size - 1)
}

fn wrap_modes(sampler: Option<&Sampler>) -> [WrappingMode; 2] {
    let mode = |mode: Checked<WrappingMode>| match mode {
        Checked::Valid(mode) => mode,
        Checked::Invalid => WrappingMode::Repeat,
    };
    sampler.map_or([WrappingMode::Repeat; 2], |sampler| [mode(sampler.wrap_s), mode(sampler.wrap_t)])
}

fn in_image(fault: Fault, index: usize) -> Fault {
    match fault {
        Fault::Malformed(reason) => Fault::Malformed(format!("image {index}: {reason}")),
        Fault::Unsupported(what) => Fault::Unsupported(format!("image {index}: {what}")),
        elsewhere @ Fault::Elsewhere(_) => elsewhere,
    }
}
