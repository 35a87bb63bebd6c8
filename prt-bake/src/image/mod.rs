//! Images: reading to linear radiance, and writing.

mod exr;
mod hdr;
mod primaries;
mod save;
mod srgb;
mod standard;

use std::path::Path;

#[cfg(feature = "trace")]
pub(crate) use exr::is_whole as is_whole_exr;
pub(crate) use exr::{PartInfo, decode_channels, is_exr, read_part_info};
pub use save::{ExrPrecision, save_png};
#[cfg(feature = "trace")]
pub(crate) use srgb::linear_to_srgb;
pub(crate) use srgb::{srgb_to_linear, srgb8_to_linear};
pub(crate) use standard::decode_rgba8;

use crate::Error;
use crate::input::{Fault, check_is_file, extension, read_file};

/// Most pixels of an image that is read: 16,384 × 16,384, which take 3.2 GB.
const MAX_PIXELS: usize = 1 << 28;

/// A picture of linear, scene-referred radiance.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green, blue; row after row from the top, `[width * height]`.
    pub pixels: Vec<[f32; 3]>,
}

/// From the bytes of a file to its pixels.
type Decoder = fn(&[u8]) -> Result<Image, Fault>;

impl Image {
    /// Reads an image, chosen by the file's extension (in any case).
    ///
    /// | extension | read | made linear how |
    /// |---|---|---|
    /// | `hdr`, `pic`, `rgbe` | Radiance RGBE and XYZE; flat, old and new run lengths; all eight orientations | value `m · 2^(e−136)` as in most readers (Radiance itself takes the middle, `m + ½`); divided by the product of the `EXPOSURE` lines and of the `COLORCORR` lines |
    /// | `exr` | OpenEXR: scan lines and tiles (level 0); half, float, uint; every compression but HTJ2K. The first part, and in it the first layer, that has R G B, or else Y; the data window alone | as stored |
    /// | `png`, `jpg`, `jpeg` | 8 and 16 bits, grey and colour; alpha and profiles ignored | the sRGB curve undone |
    ///
    /// The result has the primaries of Rec. 709 / sRGB: other `PRIMARIES` or `chromaticities` are converted so that the
    /// file's white stays neutral. XYZE is converted as Radiance does, with the sRGB primaries about the equal-energy
    /// white, so that X = Y = Z = 1 becomes R = G = B = 1. Values may be negative.
    ///
    /// # Errors
    /// Each names the file and the cause: what the system refuses, an unknown extension, data that break the format's
    /// rules, features that are not read, more than 2^28 pixels, more pixels than a file of its size can hold (before
    /// anything is allocated), and pixels that are infinite or not a number, with their count and the first one's place.
    pub fn load(path: &Path) -> Result<Self, Error> {
        check_is_file(path)?;
        let (format, decode): (_, Decoder) = match extension(path).as_str() {
            "hdr" | "pic" | "rgbe" => ("Radiance HDR", hdr::decode),
            "exr" => ("OpenEXR", exr::decode),
            "png" => ("PNG", standard::decode),
            "jpg" | "jpeg" => ("JPEG", standard::decode),
            _ => {
                let accepted = "hdr, pic, rgbe, exr, png, jpg, jpeg";
                return Err(Error::UnknownExtension { path: path.to_owned(), what: "an image", accepted });
            }
        };
        let bytes = read_file(path)?;
        let image = if bytes.is_empty() { Err(Fault::malformed("it is empty")) } else { decode(&bytes) };
        image.and_then(Self::check_finite).map_err(|fault| fault.in_file(path, format))
    }

    fn check_finite(self) -> Result<Self, Fault> {
        let is_bad = |pixel: &&[f32; 3]| !pixel.iter().all(|value| value.is_finite());
        let Some(first) = self.pixels.iter().position(|pixel| is_bad(&pixel)) else { return Ok(self) };
        let count = self.pixels[first..].iter().filter(is_bad).count();
        let (column, row) = (first % self.width, first / self.width);
        Err(Fault::malformed(format!(
            "{count} of {} pixels are infinite, not a number, or missing; the first is in column {column}, row {row} (from 0)",
            self.pixels.len()
        )))
    }
}

/// Checks a size that a header claims against what the file can hold, before anything is allocated.
///
/// - `pixels_per_byte`: the most pixels that one byte of the format can stand for
fn check_size(width: usize, height: usize, bytes: usize, pixels_per_byte: usize) -> Result<(), Fault> {
    if width == 0 || height == 0 {
        return Err(Fault::malformed(format!("its size is {width} × {height}")));
    }
    match width.checked_mul(height) {
        Some(pixels) if pixels / pixels_per_byte > bytes => Err(Fault::malformed(format!(
            "its header claims {width} × {height} pixels, more than its {bytes} bytes can hold"
        ))),
        Some(pixels) if pixels <= MAX_PIXELS => Ok(()),
        _ => Err(Fault::unsupported(format!("a size of {width} × {height} (more than {MAX_PIXELS} pixels) is"))),
    }
}
