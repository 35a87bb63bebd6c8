//! Writing images.

use std::io;
use std::path::Path;

use exr::prelude::{
    Blocks, Compression, Encoding, Error as ExrError, Image as ExrImage, IntoSample, Layer, LayerAttributes, LineOrder,
    SpecificChannels, Vec2, WritableImage, f16,
};
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageError};

use super::Image;
use super::srgb::linear_to_srgb;
use crate::Error;
use crate::atomic::write_atomically;
use crate::input::extension;

/// How exactly radiance is stored in an OpenEXR file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ExrPrecision {
    /// 16 bits: 11 bits of precision, at most 65,504 (what is beyond is clamped).
    Half,
    /// 32 bits: exactly what is given.
    #[default]
    Float,
}

impl Image {
    /// Writes the image, chosen by the extension (in any case): `exr` as [`save_exr`](Self::save_exr) in full precision,
    /// `png` with the sRGB curve, 8 bits, clamped to 0..1 (no tone mapping).
    ///
    /// # Errors
    /// An unknown extension; what the system refuses. No partial file is left.
    pub fn save(&self, path: &Path) -> Result<(), Error> {
        match extension(path).as_str() {
            "exr" => self.save_exr(path, ExrPrecision::Float),
            "png" => {
                let to_byte = |value| (linear_to_srgb(value) * 255.0).round() as u8;
                let pixels: Vec<_> = self.pixels.iter().map(|pixel| pixel.map(to_byte)).collect();
                save_png(path, self.width, self.height, &pixels)
            }
            _ => Err(Error::UnknownExtension { path: path.to_owned(), what: "an image", accepted: "exr, png" }),
        }
    }

    /// Writes linear radiance as OpenEXR: scan lines, ZIP, channels R, G, B.
    ///
    /// # Errors
    /// What the system refuses, an image without pixels. No partial file is left.
    ///
    /// # Panics
    /// If `pixels` is not `[width * height]`.
    pub fn save_exr(&self, path: &Path, precision: ExrPrecision) -> Result<(), Error> {
        assert_eq!(
            self.pixels.len(),
            self.width * self.height,
            "pixels of an image of {} × {}",
            self.width,
            self.height
        );
        match precision {
            ExrPrecision::Float => self.write_exr(path, |value| value),
            ExrPrecision::Half => {
                let largest = f16::MAX.to_f32();
                self.write_exr(path, |value| f16::from_f32(value.clamp(-largest, largest)))
            }
        }
    }

    fn write_exr<S: IntoSample>(&self, path: &Path, to_sample: impl Fn(f32) -> S + Sync) -> Result<(), Error> {
        let channels = SpecificChannels::rgb(|Vec2(x, y): Vec2<usize>| {
            let [red, green, blue] = self.pixels[y * self.width + x];
            (to_sample(red), to_sample(green), to_sample(blue))
        });
        let encoding =
            Encoding { compression: Compression::ZIP16, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
        let layer = Layer::new((self.width, self.height), LayerAttributes::default(), encoding, channels);
        let file = ExrImage::from_layer(layer);
        write_atomically(path, |writer| {
            file.write().to_buffered(writer).map_err(|error| match error {
                ExrError::Io(error) => error,
                error => io::Error::other(error),
            })
        })
    }
}

/// Writes display-referred sRGB bytes as PNG.
///
/// - `pixels`: row after row from the top, `[width * height]`
///
/// # Errors
/// What the system refuses, an image without pixels. No partial file is left.
///
/// # Panics
/// If `pixels` is not `[width * height]`.
pub fn save_png(path: &Path, width: usize, height: usize, pixels: &[[u8; 3]]) -> Result<(), Error> {
    assert_eq!(pixels.len(), width * height, "pixels of an image of {width} × {height}");
    write_atomically(path, |writer| {
        let encoder = PngEncoder::new(writer);
        encoder.write_image(pixels.as_flattened(), width as u32, height as u32, ExtendedColorType::Rgb8).map_err(
            |error| match error {
                ImageError::IoError(error) => error,
                error => io::Error::other(error),
            },
        )
    })
}
