//! PNG and JPEG.

use std::io::Cursor;

use image::{DynamicImage, ImageFormat};

use crate::scratch::{assert_near, assert_refused, image, srgb};

pub(crate) fn encoded(picture: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

#[test]
fn eight_and_sixteen_bits_in_colour_and_grey() {
    let color = image::RgbaImage::from_raw(2, 1, vec![255, 128, 0, 7, 1, 2, 3, 0]).unwrap();
    let picture = image("png", encoded(&color.into(), ImageFormat::Png)).unwrap();
    assert_eq!((picture.width, picture.height), (2, 1));
    assert_near(&picture.pixels[0], &[1.0, srgb(128.0 / 255.0), 0.0], 1e-6);
    assert_near(&picture.pixels[1], &[1.0, 2.0, 3.0].map(|value| srgb(value / 255.0)), 1e-7);

    let deep = image::ImageBuffer::<image::Rgb<u16>, _>::from_raw(1, 1, vec![65535, 32768, 1]).unwrap();
    let picture = image("PNG", encoded(&DynamicImage::ImageRgb16(deep), ImageFormat::Png)).unwrap();
    assert_near(&picture.pixels[0], &[1.0, srgb(32768.0 / 65535.0), srgb(1.0 / 65535.0)], 1e-7);

    let gray = image::GrayImage::from_raw(1, 2, vec![0, 128]).unwrap();
    let picture = image("png", encoded(&gray.into(), ImageFormat::Png)).unwrap();
    assert_near(&picture.pixels[1], &[srgb(128.0 / 255.0); 3], 1e-6);
}

#[test]
fn jpeg_by_either_extension() {
    let flat = image::RgbImage::from_pixel(16, 16, image::Rgb([200, 100, 50]));
    let bytes = encoded(&flat.into(), ImageFormat::Jpeg);
    for extension in ["jpg", "JPEG"] {
        let picture = image(extension, &bytes).unwrap();
        // Three display values for the quantisation of the default quality.
        assert_near(&picture.pixels[40], &[200.0, 100.0, 50.0].map(|value| srgb(value / 255.0)), 0.025);
    }
}

#[test]
fn bad_input() {
    let color = image::RgbImage::from_fn(40, 30, |x, y| image::Rgb([x as u8, y as u8, (x * y) as u8]));
    let png = encoded(&color.clone().into(), ImageFormat::Png);
    assert_refused(image("png", &png[..png.len() / 2]), "is not a valid PNG file");
    assert_refused(image("png", &png[..20]), "is not a valid PNG file");
    assert_refused(image("png", b"text"), "begins neither as a PNG nor as a JPEG");
    assert_refused(image("png", b"GIF89a......"), "the image format Gif is not supported");
    assert_refused(image("jpg", b""), "it is empty");
    let jpeg = encoded(&color.into(), ImageFormat::Jpeg);
    for length in (0..jpeg.len()).step_by(13).chain([jpeg.len() - 1]) {
        assert_refused(image("jpg", &jpeg[..length]), "is not a valid JPEG file");
    }
    image("jpg", [&jpeg, b"trailing".as_slice()].concat()).unwrap();
}

/// A PNG header that claims 2^31 pixels along an edge, with a right checksum.
#[test]
fn lying_header() {
    for (width, height, words) in [
        (0x7fff_ffff_u32, 0x7fff_ffff_u32, "its size (Memory limit exceeded) is not supported"),
        (60_000, 60_000, "more than its"),
        (0, 5, "is not a valid PNG file"),
    ] {
        let mut chunk = b"IHDR".to_vec();
        chunk.extend(width.to_be_bytes());
        chunk.extend(height.to_be_bytes());
        chunk.extend([8, 2, 0, 0, 0]);
        let mut bytes = b"\x89PNG\r\n\x1a\n\0\0\0\x0d".to_vec();
        bytes.extend(&chunk);
        bytes.extend(crc32(&chunk).to_be_bytes());
        bytes.extend(b"\0\0\0\0IDAT\x35\xaf\x06\x1e");
        assert_refused(image("png", bytes), words);
    }
}

/// The checksum of PNG, bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0_u32, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 })
    })
}
