//! OpenEXR. Files are written by the crate `exr`; that what it reads is what the OpenEXR library writes is checked on the
//! data folder's files (`data.rs`).

use std::io::Cursor;

use crate::scratch::{assert_near, assert_refused, image};
use exr::meta::attribute::Chromaticities;
use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image as ExrImage, ImageAttributes,
    IntegerBounds, Layer, LayerAttributes, LineOrder, SmallVec, Vec2, WritableImage, f16,
};

const SIZE: Vec2<usize> = Vec2(21, 13);

/// Ascending values that a half holds exactly.
fn ramp(start: usize) -> Vec<f32> {
    (0..SIZE.area()).map(|i| (start + i) as f32 * 0.25).collect()
}

fn encoding(compression: Compression, blocks: Blocks) -> Encoding {
    Encoding { compression, blocks, line_order: LineOrder::Increasing }
}

fn layer(
    name: Option<&str>,
    encoding: Encoding,
    channels: Vec<(&str, FlatSamples)>,
) -> Layer<AnyChannels<FlatSamples>> {
    let attributes = name.map_or_else(LayerAttributes::default, LayerAttributes::named);
    let channels = channels.into_iter().map(|(name, samples)| AnyChannel::new(name, samples)).collect::<SmallVec<_>>();
    Layer::new(SIZE, attributes, encoding, AnyChannels::sort(channels))
}

fn file(layers: Vec<Layer<AnyChannels<FlatSamples>>>) -> Vec<u8> {
    bytes_of(&ExrImage::from_layers(ImageAttributes::new(IntegerBounds::from_dimensions(SIZE)), layers))
}

fn bytes_of(image: &ExrImage<SmallVec<[Layer<AnyChannels<FlatSamples>>; 2]>>) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write().non_parallel().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

fn rgb(encoding: Encoding, samples: impl Fn(Vec<f32>) -> FlatSamples) -> Vec<u8> {
    file(vec![layer(
        None,
        encoding,
        ["R", "G", "B"].into_iter().zip([0, 700, 1400].map(|start| samples(ramp(start)))).collect(),
    )])
}

pub(crate) fn small_rgb(compression: Compression, blocks: Blocks) -> Vec<u8> {
    rgb(encoding(compression, blocks), FlatSamples::F32)
}

pub(crate) fn small_half(compression: Compression, blocks: Blocks) -> Vec<u8> {
    rgb(encoding(compression, blocks), half)
}

fn half(values: Vec<f32>) -> FlatSamples {
    FlatSamples::F16(values.into_iter().map(f16::from_f32).collect())
}

fn expected() -> Vec<[f32; 3]> {
    let [red, green, blue] = [0, 700, 1400].map(ramp);
    (0..SIZE.area()).map(|i| [red[i], green[i], blue[i]]).collect()
}

#[test]
fn scan_lines_and_tiles_of_every_sample_type_and_lossless_compression() {
    let compressions =
        [Compression::Uncompressed, Compression::RLE, Compression::ZIP1, Compression::ZIP16, Compression::PIZ];
    for compression in compressions {
        for blocks in [Blocks::ScanLines, Blocks::Tiles(Vec2(8, 5))] {
            let encoding = encoding(compression, blocks);
            for bytes in [rgb(encoding, FlatSamples::F32), rgb(encoding, half)] {
                let picture = image("exr", bytes).unwrap();
                assert_eq!((picture.width, picture.height), (SIZE.width(), SIZE.height()));
                assert!(picture.pixels == expected(), "{compression} {blocks:?}");
            }
        }
    }
    let whole = |values: Vec<f32>| FlatSamples::U32(values.into_iter().map(|value| (4.0 * value) as u32).collect());
    let picture = image("EXR", rgb(encoding(Compression::ZIP16, Blocks::ScanLines), whole)).unwrap();
    assert_eq!(picture.pixels[5], [5.0, 705.0, 1405.0]);
}

#[test]
fn channels_are_found_by_name() {
    let plain = encoding(Compression::Uncompressed, Blocks::ScanLines);
    let channel = |start| FlatSamples::F32(ramp(start));
    let first = |channels: Vec<(&str, usize)>| {
        let channels = channels.into_iter().map(|(name, start)| (name, channel(start))).collect();
        image("exr", file(vec![layer(None, plain, channels)])).map(|picture| picture.pixels[0])
    };
    let quarter = |values: [f32; 3]| values.map(|value| value * 0.25);
    let bare = first(vec![
        ("R", 4),
        ("G", 8),
        ("B", 12),
        ("A", 16),
        ("Z", 20),
        ("diffuse.R", 24),
        ("diffuse.G", 24),
        ("diffuse.B", 24),
    ]);
    assert_eq!(bare.unwrap(), quarter([4.0, 8.0, 12.0]));
    let named =
        first(vec![("a.Z", 1), ("b.r", 4), ("b.g", 8), ("b.b", 12), ("c.R", 1), ("c.G", 1), ("c.B", 1), ("Y", 3)]);
    assert_eq!(named.unwrap(), quarter([4.0, 8.0, 12.0]));
    assert_eq!(first(vec![("Y", 7), ("A", 1)]).unwrap(), quarter([7.0; 3]));
    assert_refused(
        first(vec![("R", 1), ("G", 1), ("Z", 1)]),
        "the channels G, R, Z (neither R, G, B nor Y) is not supported",
    );
}

#[test]
fn the_first_part_with_colour() {
    let zip = encoding(Compression::ZIP16, Blocks::ScanLines);
    let colors = |start| ["R", "G", "B"].map(|name| (name, FlatSamples::F32(ramp(start)))).into_iter().collect();
    let parts = vec![
        layer(Some("depth"), zip, vec![("Z", FlatSamples::F32(ramp(1)))]),
        layer(Some("beauty"), zip, colors(8)),
        layer(Some("other"), zip, colors(16)),
    ];
    assert_eq!(image("exr", file(parts)).unwrap().pixels[0], [2.0; 3]);
}

#[test]
fn the_data_window_is_the_image() {
    let mut part =
        layer(None, encoding(Compression::ZIP16, Blocks::Tiles(Vec2(8, 8))), vec![("Y", FlatSamples::F32(ramp(0)))]);
    part.attributes.layer_position = Vec2(-100, 77);
    let picture = image("exr", file(vec![part])).unwrap();
    assert_eq!((picture.width, picture.height, picture.pixels[22][0]), (21, 13, 5.5));
}

#[test]
fn chromaticities_are_converted() {
    let part = layer(None, encoding(Compression::ZIP16, Blocks::ScanLines), vec![("Y", FlatSamples::F32(ramp(4)))]);
    let mut attributes = ImageAttributes::new(IntegerBounds::from_dimensions(SIZE));
    attributes.chromaticities = Some(Chromaticities {
        red: Vec2(0.713, 0.293),
        green: Vec2(0.165, 0.830),
        blue: Vec2(0.128, 0.044),
        white: Vec2(0.32168, 0.33767),
    });
    let picture = image("exr", bytes_of(&ExrImage::from_layers(attributes, vec![part]))).unwrap();
    assert_near(&picture.pixels[0], &[1.0; 3], 1e-6);
}

#[test]
fn pixels_that_are_no_numbers_are_counted_and_placed() {
    let mut values = ramp(0);
    values[21 * 2 + 3] = f32::NAN;
    values[21 * 5] = f32::INFINITY;
    let part = layer(None, encoding(Compression::ZIP16, Blocks::ScanLines), vec![("Y", FlatSamples::F32(values))]);
    let words = "2 of 273 pixels are infinite, not a number, or missing; the first is in column 3, row 2";
    assert_refused(image("exr", file(vec![part])), words);
}

/// Where the value of an attribute begins.
fn value_of(bytes: &[u8], name: &str, kind: &str) -> usize {
    let head = [name.as_bytes(), b"\0", kind.as_bytes(), b"\0"].concat();
    bytes.windows(head.len()).position(|window| window == head).unwrap() + head.len() + 4
}

#[test]
fn lying_headers() {
    let good = small_rgb(Compression::ZIP16, Blocks::ScanLines);
    let window = value_of(&good, "dataWindow", "box2i");
    let with_window = |corners: [i32; 4]| {
        let mut bytes = good.clone();
        bytes[window..window + 16].copy_from_slice(corners.map(i32::to_le_bytes).as_flattened());
        image("exr", bytes)
    };
    assert_eq!(with_window([0, 0, 20, 12]).unwrap().pixels.len(), 273);
    for corners in [
        [0, 0, i32::MAX, 0],
        [0, 0, 0, i32::MAX],
        [0, 0, i32::MAX, i32::MAX],
        [i32::MIN, i32::MIN, i32::MAX, i32::MAX],
        [0, 0, 1 << 30, 1 << 30],
        [0, 0, 100_000, 100_000],
        [5, 5, 1, 1],
        [0, 0, 20, 200],
    ] {
        assert_refused(with_window(corners), "is not");
    }
}

#[test]
fn truncation_and_other_compressions() {
    for blocks in [Blocks::ScanLines, Blocks::Tiles(Vec2(8, 5))] {
        let good = small_rgb(Compression::ZIP1, blocks);
        for length in (0..good.len()).step_by(7) {
            assert_refused(image("exr", &good[..length]), "is not a valid OpenEXR file");
        }
    }
    let mut bytes = small_rgb(Compression::ZIP16, Blocks::ScanLines);
    let compression = value_of(&bytes, "compression", "compression");
    for (number, words) in [
        (10, "HTJ2K compression is not supported"),
        (11, "HTJ2K compression is not supported"),
        (99, "(unknown compression method) is not supported"),
    ] {
        bytes[compression] = number;
        assert_refused(image("exr", &bytes), words);
    }
    assert_refused(image("exr", b"not an image at all, but long enough to be read"), "is not a valid OpenEXR file");
}

/// The counters before a DWA chunk say how much to allocate.
#[test]
fn lying_dwa_chunks() {
    let good = small_rgb(Compression::DWAB(None), Blocks::ScanLines);
    image("exr", &good).unwrap();
    // One chunk, at the end of the file: line 0 and the number of bytes that follow.
    let word = |at: usize| u32::from_le_bytes(good[at..at + 4].try_into().unwrap()) as usize;
    let chunk = (0..good.len() - 8).find(|&at| word(at) == 0 && word(at + 4) == good.len() - at - 8).unwrap() + 8;
    for counter in 1..10 {
        let mut bytes = good.clone();
        bytes[chunk + 8 * counter..][..8].copy_from_slice(&(1_u64 << 40).to_le_bytes());
        assert_refused(image("exr", bytes), "a chunk claims 1099511627776 items");
    }
}

#[test]
fn subsampled_channels_are_refused() {
    let mut bytes = small_rgb(Compression::Uncompressed, Blocks::ScanLines);
    // The first channel: name "B", type, linear flag and padding, then the two rates.
    let rates = value_of(&bytes, "channels", "chlist") + 2 + 4 + 4;
    bytes[rates..rates + 8].copy_from_slice(&[3, 0, 0, 0, 1, 0, 0, 0]);
    assert_refused(image("exr", &bytes), "(channel subsampling not supported yet) is not supported");
}
