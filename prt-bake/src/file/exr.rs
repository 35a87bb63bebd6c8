//! Zonal textures as OpenEXR images with named channels.

use std::collections::BTreeMap;
use std::io;
use std::path::Path;

use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Blocks, Compression, Encoding, Error as ExrError, FlatSamples, Image,
    Layer, LayerAttributes, LineOrder, Text, WritableImage,
};

use super::sorted_head::SortedHead;
use super::{FileInfo, TensorInfo, ZonalTexture, check_format, write};
use crate::Error;
use crate::atomic::write_atomically;
use crate::image::{PartInfo, read_part_info};
use crate::input::Fault;

/// What the names of our attributes begin with.
pub(crate) const ATTRIBUTE_PREFIX: &str = "prt.";

/// Writes the image; returns its size.
pub(super) fn write(texture: &ZonalTexture, path: &Path) -> Result<u64, Error> {
    write_planes((texture.width, texture.height), &write::texture_metadata(texture), channels(texture), path)
}

/// What a baked image says of itself: its channels count as tensors.
pub(super) fn info(path: &Path) -> Result<FileInfo, Error> {
    let fail = |cause| Error::Io { action: "read", path: path.to_owned(), cause };
    let bytes = std::fs::metadata(path).map_err(fail)?.len();
    let read = || {
        let PartInfo { width, height, texts, channels, dtypes } = read_part_info(path)?;
        let own = |(name, value): (String, String)| Some((name.strip_prefix(ATTRIBUTE_PREFIX)?.to_owned(), value));
        let metadata: BTreeMap<String, String> = texts.into_iter().filter_map(own).collect();
        if metadata.is_empty() {
            return Err(Fault::unsupported("an image that was not baked is"));
        }
        check_format(&metadata).map_err(Fault::Malformed)?;
        let tensor =
            |(name, dtype): (String, &str)| TensorInfo { name, dtype: dtype.to_owned(), shape: vec![height, width] };
        Ok(FileInfo { metadata, tensors: channels.into_iter().zip(dtypes).map(tensor).collect(), bytes })
    };
    read().map_err(|fault: Fault| fault.in_file(path, "PRT OpenEXR"))
}

/// Writes an image of 32 bits with named channels; returns its size.
///
/// - `size`: columns and rows
/// - `metadata`: become attributes
/// - `channels`: name and values `[H, W]` of each
pub(crate) fn write_planes(
    size: (usize, usize),
    metadata: &BTreeMap<&str, String>,
    channels: Vec<(String, Vec<f32>)>,
    path: &Path,
) -> Result<u64, Error> {
    let channels =
        channels.into_iter().map(|(name, values)| AnyChannel::new(Text::new_or_panic(name), FlatSamples::F32(values)));
    let encoding =
        Encoding { compression: Compression::ZIP16, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
    let channels = AnyChannels::sort(channels.collect());
    let layer = Layer::new(size, attributes(metadata), encoding, channels);
    let image = Image::from_layer(layer);
    write_atomically(path, |writer| {
        let mut writer = SortedHead::new(writer);
        image.write().to_buffered(&mut writer).map_err(|error| match error {
            ExrError::Io(error) => error,
            error => io::Error::other(error),
        })?;
        writer.finish()
    })?;
    std::fs::metadata(path).map(|file| file.len()).map_err(|cause| Error::Io {
        action: "read",
        path: path.to_owned(),
        cause,
    })
}

/// The metadata as text, under names of our own: `channels` and others belong to the format.
fn attributes(metadata: &BTreeMap<&str, String>) -> LayerAttributes {
    let mut attributes = LayerAttributes::default();
    for (key, value) in metadata {
        let name = Text::new_or_panic(format!("{ATTRIBUTE_PREFIX}{key}"));
        attributes.other.insert(name, AttributeValue::Text(Text::new_or_panic(value)));
    }
    attributes
}

/// Name and values `[H, W]` of every channel.
fn channels(texture: &ZonalTexture) -> Vec<(String, Vec<f32>)> {
    const XYZ: [&str; 3] = ["x", "y", "z"];
    let transfer = &texture.transfer;
    let colors: &[&str] = if transfer.channels == 3 { &[".r", ".g", ".b"] } else { &[""] };
    let row_prefixes =
        (0..transfer.rows).map(|row| if transfer.rows > 1 { format!("row{row}.") } else { String::new() });
    let (mut explicit, mut axes, mut coeffs) = (Vec::new(), Vec::new(), Vec::new());
    for row in row_prefixes {
        for color in colors {
            explicit.extend((0..transfer.explicit_count).map(|i| format!("{row}explicit.{i}{color}")));
            for lobe in 0..transfer.lobe_count {
                coeffs.extend((0..transfer.order.get()).map(|l| format!("{row}lobe{lobe}.coeff.{l}{color}")));
            }
        }
        axes.extend((0..transfer.lobe_count).flat_map(|lobe| XYZ.map(|axis| format!("{row}lobe{lobe}.axis.{axis}"))));
    }
    let mut channels = planes(vec!["height".to_owned()], &texture.heights);
    channels.extend(planes(XYZ.map(|axis| format!("normal.{axis}")).to_vec(), texture.normals.as_flattened()));
    channels.extend(planes(explicit, &transfer.explicit));
    channels.extend(planes(axes, transfer.axes.as_flattened()));
    channels.extend(planes(coeffs, &transfer.coeffs));
    channels
}

/// Values `[H, W, names]` as one plane for each name.
pub(crate) fn planes(names: Vec<String>, values: &[f32]) -> Vec<(String, Vec<f32>)> {
    let count = names.len();
    let plane = |(i, name): (usize, String)| (name, values.iter().skip(i).step_by(count).copied().collect());
    names.into_iter().enumerate().map(plane).collect()
}
