//! Reading an atlas from an OpenEXR image.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use sh_core::Order;

use super::exr::{COVERAGE, KIND, WRAPS, channel_names};
use super::{Coverage, TexelTransfer};
use crate::file::{ATTRIBUTE_PREFIX, check_format, entry, read_metadata, read_order};
use crate::image::{PartInfo, decode_channels};
use crate::input::{Fault, read_file};
use crate::{Error, TransferVectors};

type Metadata = BTreeMap<String, String>;

pub(super) fn read(path: &Path) -> Result<TexelTransfer, Error> {
    decode(&read_file(path)?).map_err(|fault| fault.in_file(path, "texture-transfer OpenEXR"))
}

fn decode(bytes: &[u8]) -> Result<TexelTransfer, Fault> {
    let (info, values) = decode_channels(bytes, |info| {
        let layout = Channels::new(info)?;
        layout.names().iter().map(|name| number_of(info, name)).collect()
    })?;
    if let Some(place) = values.iter().position(|value| !value.is_finite()) {
        let slots = values.len() / (info.width * info.height);
        return Err(Fault::malformed(format!("texel {} has the value {} or none", place / slots, values[place])));
    }
    atlas(&info, &values)
}

/// Which channels an image must have.
struct Channels {
    order: Order,
    count: usize,
}

impl Channels {
    fn new(info: &PartInfo) -> Result<Self, Fault> {
        let metadata = metadata(info);
        check_format(&metadata).map_err(Fault::Malformed)?;
        match entry(&metadata, "kind").map_err(Fault::Malformed)? {
            KIND => {}
            other => return Err(Fault::malformed(format!("its kind is {other}; {KIND} is needed"))),
        }
        let order = read_order(&metadata).map_err(Fault::Malformed)?;
        let is_colored = info.channels.iter().any(|name| name.ends_with(".r"));
        Ok(Self { order, count: if is_colored { 3 } else { 1 } })
    }

    /// Those of transfer, and the coverage last.
    fn names(&self) -> Vec<String> {
        let mut names = channel_names(self.order, self.count);
        names.push(COVERAGE.to_owned());
        names
    }
}

fn number_of(info: &PartInfo, name: &str) -> Result<usize, Fault> {
    let numbers: HashMap<&str, usize> = info.channels.iter().map(String::as_str).zip(0..).collect();
    numbers.get(name).copied().ok_or_else(|| Fault::malformed(format!("it has no channel {name}")))
}

fn metadata(info: &PartInfo) -> Metadata {
    let own =
        |(name, value): (&String, &String)| Some((name.strip_prefix(ATTRIBUTE_PREFIX)?.to_owned(), value.clone()));
    info.texts.iter().filter_map(own).collect()
}

/// - `values`: `[H, W, C n² + 1]`
fn atlas(info: &PartInfo, values: &[f32]) -> Result<TexelTransfer, Fault> {
    let (metadata, channels) = (metadata(info), Channels::new(info)?);
    let length = channels.count * channels.order.coeff_count();
    let texels = || values.chunks_exact(length + 1);
    let coverage = |texel: &[f32]| {
        Coverage::of_value(texel[length])
            .ok_or_else(|| Fault::malformed(format!("a texel has the coverage {}", texel[length])))
    };
    Ok(TexelTransfer {
        metadata: read_metadata(&metadata).map_err(Fault::Malformed)?,
        width: info.width,
        height: info.height,
        wraps: one_of(&metadata, "wrap", WRAPS)?,
        v_up: one_of(&metadata, "v", [("up", true), ("down", false)])?,
        coverage: texels().map(coverage).collect::<Result<_, _>>()?,
        transfer: TransferVectors {
            order: channels.order,
            channels: channels.count,
            values: texels().flat_map(|texel| &texel[..length]).copied().collect(),
        },
    })
}

fn one_of<T, const N: usize>(metadata: &Metadata, key: &str, known: [(&str, T); N]) -> Result<T, Fault> {
    let text = entry(metadata, key).map_err(Fault::Malformed)?;
    let found = known.into_iter().find(|(name, _)| *name == text);
    found
        .map(|(_, value)| value)
        .ok_or_else(|| Fault::malformed(format!("its metadata entry \"{key}\" is \"{text}\", not a valid value")))
}
