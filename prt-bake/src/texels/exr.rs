//! An atlas as an OpenEXR image.

use std::path::Path;

use sh_core::Order;

use super::TexelTransfer;
use crate::Error;
use crate::file::{metadata_entries, planes, write_planes};

/// The kind of image, in its metadata.
pub(super) const KIND: &str = "texture-transfer";
/// The channel that tells what texels hold.
pub(super) const COVERAGE: &str = "coverage";
/// How the axes that wrap round are written.
pub(super) const WRAPS: [(&str, [bool; 2]); 4] =
    [("none", [false, false]), ("u", [true, false]), ("v", [false, true]), ("uv", [true, true])];

/// Writes the image; returns its size.
pub(super) fn write(atlas: &TexelTransfer, path: &Path) -> Result<u64, Error> {
    let transfer = &atlas.transfer;
    let mut metadata = metadata_entries(&atlas.metadata, KIND, transfer.order);
    let wrap = WRAPS.into_iter().find(|(_, wraps)| *wraps == atlas.wraps).map_or("none", |(name, _)| name);
    metadata.extend([("wrap", wrap.to_owned()), ("v", if atlas.v_up { "up" } else { "down" }.to_owned())]);
    let mut channels = planes(channel_names(transfer.order, transfer.channels), &transfer.values);
    channels.push((COVERAGE.to_owned(), atlas.coverage.iter().map(|coverage| coverage.value()).collect()));
    write_planes((atlas.width, atlas.height), &metadata, channels, path)
}

/// Names of the channels of transfer, in the order of `[C, n²]`.
pub(super) fn channel_names(order: Order, channels: usize) -> Vec<String> {
    let digits = (order.coeff_count() - 1).to_string().len();
    let colors: &[&str] = if channels == 3 { &[".r", ".g", ".b"] } else { &[""] };
    let name = |(color, i): (&str, usize)| format!("transfer.{i:0digits$}{color}");
    colors.iter().flat_map(|&color| (0..order.coeff_count()).map(move |i| (color, i))).map(name).collect()
}
