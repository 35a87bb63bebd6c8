//! OpenEXR.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufReader, Cursor};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use exr::block::chunk::{Chunk, CompressedBlock};
use exr::block::lines::LineIndex;
use exr::block::reader::Reader;
use exr::block::{self, UncompressedBlock};
use exr::compression::Compression;
use exr::error::Error as ExrError;
use exr::math::Vec2;
use exr::meta::attribute::{AttributeValue, ChannelList, SampleType, Text};
use exr::meta::header::Header;
use half::f16;

use super::primaries;
use super::{Image, check_size};
use crate::Error;
use crate::input::{Fault, check_is_file};

/// Most times that a compression expands: deflate's 1032, which PIZ, RLE, B44 and PXR24 stay below.
const MAX_EXPANSION: usize = 1032;

/// Reads an image. A panic in the crate `exr` becomes an error: with overflow checks, its B44 decoder overflows on damaged
/// data (found by random damage to files; nothing else has been).
pub(super) fn decode(bytes: &[u8]) -> Result<Image, Fault> {
    catch_unwind(|| decode_image(bytes))
        .unwrap_or_else(|_| Err(Fault::malformed("its compressed data make the decoder fail")))
}

fn decode_image(bytes: &[u8]) -> Result<Image, Fault> {
    let reader = block::read(Cursor::new(bytes), false).map_err(fault)?;
    let (part, channels) = choose_part(reader.headers())?;
    let header = reader.headers()[part].clone();
    check_header(&header, bytes.len())?;
    let Vec2(width, height) = header.layer_size;
    // Every pixel that the file leaves out stays NaN, which the caller refuses.
    let mut image = Image { width, height, pixels: vec![[f32::NAN; 3]; width * height] };
    for_each_block(reader, part, |block| copy_block(block, &header.channels, channels, &mut image))?;
    convert_primaries(&header, &mut image);
    Ok(image)
}

/// Hands over the blocks of the full resolution of one part.
fn for_each_block<R: io::Read + io::Seek>(
    reader: Reader<R>,
    part: usize,
    mut take: impl FnMut(&UncompressedBlock),
) -> Result<(), Fault> {
    let meta_data = reader.meta_data().clone();
    let chunks = reader
        .filter_chunks(true, |_, tile, block| block.layer == part && tile.level_index == Vec2(0, 0))
        .map_err(fault)?;
    // One thread: the crate's own pool would abort the program if a decoder panicked.
    for chunk in chunks {
        let chunk = chunk.map_err(fault)?;
        check_chunk(&chunk, &meta_data.headers[part])?;
        take(&UncompressedBlock::decompress_chunk(chunk, &meta_data, false).map_err(fault)?);
    }
    Ok(())
}

/// What the first part of an image says of itself.
#[derive(Debug)]
pub(crate) struct PartInfo {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Attributes that are text and no part of the format.
    pub(crate) texts: BTreeMap<String, String>,
    /// Names of the channels.
    pub(crate) channels: Vec<String>,
    /// Their types, as safetensors spells them.
    pub(crate) dtypes: Vec<&'static str>,
}

/// What the first part of an image says of itself; its pixels are not read.
pub(crate) fn read_part_info(path: &Path) -> Result<PartInfo, Fault> {
    let fail = |cause| Error::Io { action: "read", path: path.to_owned(), cause };
    check_is_file(path)?;
    let file = BufReader::new(File::open(path).map_err(fail)?);
    let read = || block::read(file, false).map(|reader| part_info(&reader.headers()[0])).map_err(fault);
    catch_unwind(AssertUnwindSafe(read)).unwrap_or_else(|_| Err(Fault::malformed("its head makes the decoder fail")))
}

/// Whether the first part of an image can be read to its end, and has all of its pixels. They are not kept.
#[cfg(feature = "trace")]
pub(crate) fn is_whole(path: &Path) -> bool {
    let read = || {
        let file = File::open(path).ok()?;
        let bytes = file.metadata().ok()?.len() as usize;
        let reader = block::read(BufReader::new(file), false).ok()?;
        let header = reader.headers()[0].clone();
        check_header(&header, bytes).ok()?;
        let mut missing = header.layer_size.area();
        for_each_block(reader, 0, |block| missing -= block.index.pixel_size.area().min(missing)).ok()?;
        Some(missing == 0)
    };
    check_is_file(path).is_ok() && catch_unwind(AssertUnwindSafe(read)).is_ok_and(|is_whole| is_whole == Some(true))
}

/// Whether a file begins as an image of this format does.
pub(crate) fn is_exr(path: &Path) -> Result<bool, Error> {
    check_is_file(path)?;
    let mut magic = [0; 4];
    let read = File::open(path).and_then(|mut file| io::Read::read_exact(&mut file, &mut magic));
    Ok(read.is_ok() && magic == [0x76, 0x2f, 0x31, 0x01])
}

/// Reads chosen channels of the first part of an image, `[H, W, slots]`; what the file leaves out is NaN.
///
/// - `choose`: the numbers of the channels that go to the slots
pub(crate) fn decode_channels(
    bytes: &[u8],
    choose: impl FnOnce(&PartInfo) -> Result<Vec<usize>, Fault>,
) -> Result<(PartInfo, Vec<f32>), Fault> {
    catch_unwind(AssertUnwindSafe(|| read_channels(bytes, choose)))
        .unwrap_or_else(|_| Err(Fault::malformed("its compressed data make the decoder fail")))
}

fn read_channels(
    bytes: &[u8],
    choose: impl FnOnce(&PartInfo) -> Result<Vec<usize>, Fault>,
) -> Result<(PartInfo, Vec<f32>), Fault> {
    let reader = block::read(Cursor::new(bytes), false).map_err(fault)?;
    let header = reader.headers()[0].clone();
    if header.deep {
        return Err(Fault::unsupported("deep data is"));
    }
    check_header(&header, bytes.len())?;
    let info = part_info(&header);
    let slots = choose(&info)?;
    let mut slot_of = vec![None; info.channels.len()];
    slots.iter().enumerate().for_each(|(slot, &channel)| slot_of[channel] = Some(slot));
    let mut values = vec![f32::NAN; info.width * info.height * slots.len()];
    for_each_block(reader, 0, |block| {
        for_each_line(block, &header.channels, |channel, row, left, samples| {
            let (Some(slot), start) = (slot_of[channel], row * info.width + left) else { return };
            let targets = values.iter_mut().skip(start * slots.len() + slot).step_by(slots.len());
            copy_samples(samples, header.channels.list[channel].sample_type, targets);
        });
    })?;
    Ok((info, values))
}

fn part_info(header: &Header) -> PartInfo {
    let Vec2(width, height) = header.layer_size;
    let text = |(name, value): (&Text, &AttributeValue)| match value {
        AttributeValue::Text(value) => Some((name.to_string(), value.to_string())),
        _ => None,
    };
    PartInfo {
        width,
        height,
        texts: header.own_attributes.other.iter().filter_map(text).collect(),
        channels: header.channels.list.iter().map(|channel| channel.name.to_string()).collect(),
        dtypes: header.channels.list.iter().map(|channel| dtype(channel.sample_type)).collect(),
    }
}

fn dtype(samples: SampleType) -> &'static str {
    match samples {
        SampleType::F32 => "F32",
        SampleType::F16 => "F16",
        SampleType::U32 => "U32",
    }
}

/// The numbers of the channels that become red, green and blue.
type Rgb = [usize; 3];

/// The first part with colour, and its channels.
fn choose_part(headers: &[Header]) -> Result<(usize, Rgb), Fault> {
    let found = headers.iter().enumerate().filter(|(_, header)| !header.deep).find_map(|(part, header)| {
        let names: Vec<_> = header.channels.list.iter().map(|channel| channel.name.to_string()).collect();
        Some((part, choose_channels(&names)?))
    });
    found.ok_or_else(|| {
        if headers.iter().all(|header| header.deep) {
            return Fault::unsupported("deep data is");
        }
        let names = headers.iter().flat_map(|header| &header.channels.list).map(|channel| channel.name.to_string());
        Fault::unsupported(format!(
            "an image of the channels {} (neither R, G, B nor Y) is",
            names.collect::<Vec<_>>().join(", ")
        ))
    })
}

/// R, G, B, or else Y; of the layer without a name (`R`) or else the first that has them (`diffuse.R`).
fn choose_channels(names: &[String]) -> Option<Rgb> {
    let mut layers: Vec<&str> = names.iter().map(|name| name.rsplit_once('.').map_or("", |(layer, _)| layer)).collect();
    layers.sort_by_key(|layer| !layer.is_empty());
    let find = |layer: &str, channel: &str| {
        names.iter().position(|name| match name.rsplit_once('.') {
            Some((prefix, last)) => prefix == layer && last.eq_ignore_ascii_case(channel),
            None => layer.is_empty() && name.eq_ignore_ascii_case(channel),
        })
    };
    let rgb = |layer: &&str| Some([find(layer, "R")?, find(layer, "G")?, find(layer, "B")?]);
    let gray = |layer: &&str| find(layer, "Y").map(|y| [y; 3]);
    layers.iter().find_map(rgb).or_else(|| layers.iter().find_map(gray))
}

/// Refuses what is not read, and sizes beyond what the file can hold.
fn check_header(header: &Header, bytes: usize) -> Result<(), Fault> {
    if matches!(header.compression, Compression::HTJ2K32 | Compression::HTJ2K256) {
        return Err(Fault::unsupported("HTJ2K compression is"));
    }
    let bytes_per_pixel = header.channels.bytes_per_pixel.max(1);
    let Vec2(width, height) = header.layer_size;
    check_size(width, height, bytes, (MAX_EXPANSION / bytes_per_pixel).max(1))
}

/// Refuses a DWAA or DWAB chunk whose eleven counters claim more than its pixels can need: the decoder allocates by them.
fn check_chunk(chunk: &Chunk, header: &Header) -> Result<(), Fault> {
    let bytes = match &chunk.compressed_block {
        CompressedBlock::ScanLine(block) => &block.compressed_pixels_le,
        CompressedBlock::Tile(block) => &block.compressed_pixels_le,
        _ => return Ok(()),
    };
    if !matches!(header.compression, Compression::DWAA(_) | Compression::DWAB(_)) {
        return Ok(());
    }
    let location = header.get_block_data_indices(&chunk.compressed_block).map_err(fault)?;
    let Vec2(width, height) = header.get_absolute_block_pixel_coordinates(location).map_err(fault)?.size;
    if bytes.len() == width * height * header.channels.bytes_per_pixel {
        return Ok(()); // stored as it is
    }
    let padded = width.next_multiple_of(8) * height.next_multiple_of(8) * header.channels.bytes_per_pixel;
    // Run lengths may double the bytes, and a coefficient has two of them.
    let limit = (4 * padded).min(MAX_EXPANSION * bytes.len()) as u64;
    let counters = bytes.as_chunks::<8>().0.iter().take(11).map(|&counter| u64::from_le_bytes(counter));
    match counters.max() {
        Some(largest) if largest > limit => Err(Fault::malformed(format!(
            "a chunk claims {largest} items, more than its pixels need or its bytes can hold"
        ))),
        _ => Ok(()),
    }
}

fn copy_block(block: &UncompressedBlock, channels: &ChannelList, rgb: Rgb, image: &mut Image) {
    for_each_line(block, channels, |channel, row, left, samples| {
        let Some(pixels) = image.pixels.get_mut(row * image.width + left..) else { return };
        for target in (0..3).filter(|&target| rgb[target] == channel) {
            let targets = pixels.iter_mut().map(|pixel| &mut pixel[target]);
            copy_samples(samples, channels.list[channel].sample_type, targets);
        }
    });
}

/// Calls `take(channel, row, first column, samples)` for each line of a block: it holds its lines from the top, and of each line the
/// channels in turn.
fn for_each_line(block: &UncompressedBlock, channels: &ChannelList, mut take: impl FnMut(usize, usize, usize, &[u8])) {
    let left = block.index.pixel_position.x();
    for (bytes, LineIndex { channel, position: Vec2(_, row), .. }) in LineIndex::lines_in_block(block.index, channels) {
        let Some(samples) = block.data.get(bytes) else { return };
        take(channel, row, left, samples);
    }
}

/// Samples are in the byte order of this machine. An unsigned integer counts as its value.
fn copy_samples<'a>(samples: &[u8], sample_type: SampleType, targets: impl Iterator<Item = &'a mut f32>) {
    match sample_type {
        SampleType::F16 => {
            for (target, &sample) in targets.zip(samples.as_chunks().0) {
                *target = f16::from_ne_bytes(sample).to_f32();
            }
        }
        SampleType::F32 => {
            for (target, &sample) in targets.zip(samples.as_chunks().0) {
                *target = f32::from_ne_bytes(sample);
            }
        }
        SampleType::U32 => {
            for (target, &sample) in targets.zip(samples.as_chunks().0) {
                *target = u32::from_ne_bytes(sample) as f32;
            }
        }
    }
}

fn convert_primaries(header: &Header, image: &mut Image) {
    let Some(all) = header.shared_attributes.chromaticities else { return };
    let xy = [all.red, all.green, all.blue, all.white].map(|Vec2(x, y)| [x, y].map(f64::from));
    if let Some(matrix) = primaries::to_srgb(xy) {
        image.pixels.iter_mut().for_each(|pixel| *pixel = primaries::convert(matrix, *pixel));
    }
}

fn fault(error: ExrError) -> Fault {
    match error {
        ExrError::NotSupported(what) => Fault::unsupported(format!("a feature of it ({what}) is")),
        ExrError::Invalid(what) => Fault::malformed(what.into_owned()),
        ExrError::Io(error) => Fault::malformed(error.to_string()),
        ExrError::Aborted => Fault::malformed("reading stopped"),
    }
}
