//! The parsed document and the bytes it refers to.

use std::borrow::Cow;
use std::path::Path;

use gltf::json::root::Get;
use gltf::json::{Index, Root, Value, buffer, deserialize};

use super::fault::Fault;
use super::uri;

/// Extensions that may be required: read here, or without influence on shape and motion.
const HANDLED: [&str; 3] = ["KHR_mesh_quantization", "KHR_lights_punctual", "KHR_xmp_json_ld"];
/// The same, by prefix.
const HANDLED_PREFIXES: [&str; 4] = ["KHR_materials_", "KHR_texture_", "EXT_texture_", "MSFT_texture_"];

/// A glTF document with its buffers loaded.
pub(super) struct Document<'a> {
    pub(super) root: Root,
    /// `None` for a buffer that names no data: a placeholder for compressed ones.
    buffers: Vec<Option<Cow<'a, [u8]>>>,
}

impl<'a> Document<'a> {
    pub(super) fn new(json: &[u8], binary: Option<&'a [u8]>, folder: &Path) -> Result<Self, Fault> {
        let root = Root::from_slice(json).map_err(|error| parse_fault(json, &error))?;
        check_version(&root.asset.version)?;
        check_extensions(&root.extensions_required)?;
        let buffers = root
            .buffers
            .iter()
            .enumerate()
            .map(|(index, buffer)| load_buffer(index, buffer, binary, folder))
            .collect::<Result<_, _>>()?;
        Ok(Self { root, buffers })
    }

    /// The item that an index refers to.
    pub(super) fn get<T>(&self, index: Index<T>, what: &str) -> Result<&T, Fault>
    where
        Root: Get<T>,
    {
        self.root.get(index).ok_or_else(|| Fault::malformed(format!("it refers to {what} {index}, which is not there")))
    }

    /// The bytes of a buffer view and their stride, if it states one.
    pub(super) fn view(&self, index: Index<buffer::View>) -> Result<(&[u8], Option<usize>), Fault> {
        let view = self.get(index, "buffer view")?;
        self.get(view.buffer, "buffer")?;
        let buffer = self.buffers[view.buffer.value()].as_deref().ok_or_else(|| self.no_data(view.buffer))?;
        let start = view.byte_offset.unwrap_or_default().0;
        let end = start.checked_add(view.byte_length.0).filter(|&end| end <= buffer.len() as u64).ok_or_else(|| {
            let (length, buffer_length) = (view.byte_length.0, buffer.len());
            Fault::malformed(format!(
                "buffer view {index} claims {length} bytes from byte {start} of a buffer of {buffer_length}"
            ))
        })?;
        Ok((
            &buffer[start as usize..end as usize],
            view.byte_stride.map(|stride| stride.0).filter(|&stride| stride > 0),
        ))
    }

    /// All bytes of all buffers: what the document's data can amount to.
    pub(super) fn data_bytes(&self) -> usize {
        self.buffers.iter().flatten().map(|buffer| buffer.len()).sum()
    }

    /// Whether the document names one of these extensions, required or not.
    pub(super) fn uses(&self, names: &[&'static str]) -> Option<&'static str> {
        names.iter().copied().find(|name| self.root.extensions_used.iter().any(|used| used == name))
    }

    fn no_data(&self, buffer: Index<buffer::Buffer>) -> Fault {
        match self.uses(&["EXT_meshopt_compression", "KHR_meshopt_compression"]) {
            Some(extension) => Fault::unsupported(format!("the glTF extension {extension} is")),
            None => Fault::malformed(format!("buffer {buffer} has no data")),
        }
    }
}

/// The reason why the JSON is refused; glTF 1.0 differs so much that it fails to parse.
fn parse_fault(json: &[u8], error: &gltf::json::Error) -> Fault {
    let version = deserialize::from_slice::<Value>(json)
        .ok()
        .and_then(|value| value.get("asset")?.get("version")?.as_str().map(str::to_owned));
    match version.as_deref().map(check_version) {
        Some(Err(fault)) => fault,
        _ => Fault::malformed(error.to_string()),
    }
}

fn check_version(version: &str) -> Result<(), Fault> {
    if version.split('.').next() == Some("2") {
        return Ok(());
    }
    Err(Fault::unsupported(format!("glTF version `{version}` is")))
}

fn check_extensions(required: &[String]) -> Result<(), Fault> {
    let has_prefix = |name: &str| HANDLED_PREFIXES.iter().any(|prefix| name.starts_with(prefix));
    let is_handled = |name: &str| HANDLED.contains(&name) || has_prefix(name);
    match required.iter().find(|name| !is_handled(name)) {
        Some(name) => Err(Fault::unsupported(format!("the glTF extension {name}, which the file requires, is"))),
        None => Ok(()),
    }
}

fn load_buffer<'a>(
    index: usize,
    buffer: &buffer::Buffer,
    binary: Option<&'a [u8]>,
    folder: &Path,
) -> Result<Option<Cow<'a, [u8]>>, Fault> {
    let data = match &buffer.uri {
        Some(uri) => Cow::Owned(uri::load(uri, folder)?),
        None => match binary.filter(|_| index == 0) {
            Some(binary) => Cow::Borrowed(binary),
            None => return Ok(None),
        },
    };
    if (data.len() as u64) < buffer.byte_length.0 {
        let (claimed, length) = (buffer.byte_length.0, data.len());
        return Err(Fault::malformed(format!("buffer {index} claims {claimed} bytes and has {length}")));
    }
    Ok(Some(data))
}
