//! PNG and JPEG.

use std::io::Cursor;

use image::error::{ImageError, LimitErrorKind};
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader};

use super::{Image, check_size, srgb_to_linear, srgb8_to_linear};
use crate::input::Fault;

/// Most pixels that a byte of these formats can stand for: deflate expands 1032 times at most, and a PNG pixel may be one
/// bit; a JPEG's end-of-band runs stay below that.
const PIXELS_PER_BYTE: usize = 8 * 1032;

/// Either format, recognised by its first bytes.
pub(super) fn decode(bytes: &[u8]) -> Result<Image, Fault> {
    let image = decode_any(bytes)?;
    let (width, height) = (image.width() as usize, image.height() as usize);
    let pixels = match image {
        DynamicImage::ImageLuma16(_)
        | DynamicImage::ImageLumaA16(_)
        | DynamicImage::ImageRgb16(_)
        | DynamicImage::ImageRgba16(_) => {
            let linear = |value: u16| srgb_to_linear(f32::from(value) / 65535.0);
            image.into_rgb16().pixels().map(|pixel| pixel.0.map(linear)).collect()
        }
        _ => image.into_rgb8().pixels().map(|pixel| pixel.0.map(srgb8_to_linear)).collect(),
    };
    Ok(Image { width, height, pixels })
}

/// Width, height and sRGB pixels with alpha of either format; 16-bit images lose their lower bits.
pub(crate) fn decode_rgba8(bytes: &[u8]) -> Result<(usize, usize, Vec<[u8; 4]>), Fault> {
    let image = decode_any(bytes)?.into_rgba8();
    let (width, height) = (image.width() as usize, image.height() as usize);
    Ok((width, height, image.pixels().map(|pixel| pixel.0).collect()))
}

fn decode_any(bytes: &[u8]) -> Result<DynamicImage, Fault> {
    let format = match image::guess_format(bytes) {
        Ok(format @ (ImageFormat::Png | ImageFormat::Jpeg)) => format,
        Ok(format) => return Err(Fault::unsupported(format!("the image format {format:?} is"))),
        Err(_) => return Err(Fault::malformed("it begins neither as a PNG nor as a JPEG image")),
    };
    if format == ImageFormat::Jpeg && !is_complete_jpeg(bytes) {
        return Err(Fault::malformed("it ends before its end-of-image marker"));
    }
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    // The sizes are checked below, against the file, which is stricter.
    reader.no_limits();
    let decoder = reader.into_decoder().map_err(|error| fault(&error))?;
    let (width, height) = decoder.dimensions();
    check_size(width as usize, height as usize, bytes.len(), PIXELS_PER_BYTE)?;
    DynamicImage::from_decoder(decoder).map_err(|error| fault(&error))
}

/// Whether an end-of-image marker follows the last start of a scan; the decoder fills in grey where it does not.
///
/// Neither marker can occur within a scan, and a thumbnail's stand before the image's own.
fn is_complete_jpeg(bytes: &[u8]) -> bool {
    let last = |marker: [u8; 2]| bytes.windows(2).rposition(|pair| pair == marker);
    last([0xff, 0xd9]) > last([0xff, 0xda])
}

fn fault(error: &ImageError) -> Fault {
    match error {
        ImageError::Unsupported(error) => Fault::unsupported(format!("a feature of it ({error}) is")),
        ImageError::Limits(error) if !matches!(error.kind(), LimitErrorKind::Unsupported { .. }) => {
            Fault::unsupported(format!("its size ({error}) is"))
        }
        error => Fault::malformed(error.to_string().split_whitespace().collect::<Vec<_>>().join(" ")),
    }
}
