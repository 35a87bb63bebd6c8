//! Colours of vertices, drawn to a picture with transparent surroundings, so that it suits a light page and a dark one.

use image::ImageEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use prt_gpu::{Frame, cpu};

use super::color::encode_srgb;
use super::stage::{Shot, Stage};

/// The backs of faces, linear: a blue grey that no scale has.
pub(super) const BACK: [f32; 3] = [0.10, 0.13, 0.19];

/// A picture for the display: sRGB and straight alpha.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Raster {
    pub(super) width: usize,
    /// `[width · height]`.
    pub(super) pixels: Vec<[u8; 4]>,
}

/// A view, and where fronts are seen in it.
#[derive(Debug)]
pub(super) struct Canvas<'a> {
    stage: &'a Stage<'a>,
    pub(super) shot: &'a Shot,
    /// The surface in white; backs are black in it.
    fronts: Frame,
}

impl<'a> Canvas<'a> {
    pub(super) fn new(stage: &'a Stage<'a>, shot: &'a Shot) -> Self {
        let white = vec![[1.0; 3]; stage.positions.len()];
        Self { stage, shot, fronts: cpu::rasterize(&stage.positions, &stage.geometry.triangles, &white, &shot.view) }
    }

    /// Share of what is seen of the surface that is backs of faces; 0 if nothing is seen.
    pub(super) fn back_share(&self) -> f64 {
        let sum = |channel: usize| self.fronts.pixels.iter().map(|pixel| f64::from(pixel[channel])).sum::<f64>();
        let (front, seen) = (sum(0), sum(3));
        if seen > 0.0 { 1.0 - front / seen } else { 0.0 }
    }

    /// Clip depth of the nearest surface, 1 where there is none.
    pub(super) fn depth(&self, x: usize, y: usize) -> f32 {
        self.fronts.depth[y * self.fronts.width + x]
    }

    /// Draws linear colours of vertices `[V]`, all finite.
    pub(super) fn paint(&self, colors: &[[f32; 3]]) -> Raster {
        let Stage { geometry, positions, .. } = self.stage;
        self.develop(&cpu::rasterize(positions, &geometry.triangles, colors, &self.shot.view), BACK, encode_srgb)
    }

    /// Paints the backs, and makes a frame of this view ready for the display.
    pub(super) fn develop(&self, frame: &Frame, back_color: [f32; 3], display: impl Fn(f32) -> u8) -> Raster {
        let pixels = frame.pixels.iter().zip(&self.fronts.pixels);
        let develop = |([r, g, b, a], front): (&[f32; 4], &[f32; 4])| {
            if *a <= 0.0 {
                return [0; 4];
            }
            let back = (front[3] - front[0]).max(0.0);
            let [r, g, b] = [0, 1, 2].map(|k| display(([*r, *g, *b][k] + back * back_color[k]) / a));
            [r, g, b, (255.0 * a).round() as u8]
        };
        Raster { width: frame.width, pixels: pixels.map(develop).collect() }
    }

    /// How squarely the surface at each vertex faces the eye, 0 to 1.
    pub(super) fn facing(&self) -> impl Iterator<Item = f32> {
        let vertices = self.stage.positions.iter().zip(&self.stage.geometry.normals);
        vertices.map(|(&position, &normal)| {
            let towards = (self.shot.eye - glam::Vec3::from_array(position)).normalize_or_zero();
            towards.dot(glam::Vec3::from_array(normal)).clamp(0.0, 1.0)
        })
    }
}

impl Raster {
    pub(super) fn png(&self) -> anyhow::Result<Vec<u8>> {
        let height = self.pixels.len() / self.width;
        let mut bytes = Vec::new();
        PngEncoder::new_with_quality(&mut bytes, CompressionType::Default, FilterType::Adaptive).write_image(
            self.pixels.as_flattened(),
            self.width as u32,
            height as u32,
            image::ExtendedColorType::Rgba8,
        )?;
        Ok(bytes)
    }

    /// Lays a colour over a pixel; `opacity` from 0 to 1.
    pub(super) fn blend(&mut self, x: usize, y: usize, color: [u8; 3], opacity: f32) {
        let pixel = &mut self.pixels[y * self.width + x];
        let under = f32::from(pixel[3]) / 255.0 * (1.0 - opacity);
        let alpha = opacity + under;
        if alpha > 0.0 {
            let mixed = |k: usize| (opacity * f32::from(color[k]) + under * f32::from(pixel[k])) / alpha;
            let [r, g, b] = [0, 1, 2].map(|k| mixed(k).round() as u8);
            *pixel = [r, g, b, (255.0 * alpha).round() as u8];
        }
    }

    pub(super) fn height(&self) -> usize {
        self.pixels.len() / self.width
    }

    /// A picture of nothing.
    #[cfg(test)]
    pub(super) fn empty() -> Self {
        Self { width: 560, pixels: vec![[0; 4]; 560 * 420] }
    }
}
