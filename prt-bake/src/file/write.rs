//! Writing a baked file.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::Path;

use safetensors::Dtype;
use serde_json::{Value, json};

use super::{BakedSurface, CONVENTION, FORMAT, VERTEX_TRANSFER};
use crate::Error;
use crate::atomic::write_atomically;

/// An array on its way into the file.
struct Tensor<'a> {
    name: &'static str,
    shape: Vec<usize>,
    values: Values<'a>,
}

enum Values<'a> {
    F32(&'a [f32]),
    U32(&'a [u32]),
}

impl Values<'_> {
    fn dtype(&self) -> Dtype {
        match self {
            Values::F32(_) => Dtype::F32,
            Values::U32(_) => Dtype::U32,
        }
    }

    fn byte_count(&self) -> usize {
        match self {
            Values::F32(values) => size_of_val(*values),
            Values::U32(values) => size_of_val(*values),
        }
    }

    fn write(&self, out: &mut impl Write) -> io::Result<()> {
        match self {
            Values::F32(values) => values.iter().try_for_each(|value| out.write_all(&value.to_le_bytes())),
            Values::U32(values) => values.iter().try_for_each(|value| out.write_all(&value.to_le_bytes())),
        }
    }
}

/// Writes the surface; returns the size of the file.
pub(super) fn surface(surface: &BakedSurface, path: &Path) -> Result<u64, Error> {
    let tensors = tensors(surface);
    let header = header(&metadata(surface), &tensors);
    let size = 8 + header.len() + tensors.iter().map(|tensor| tensor.values.byte_count()).sum::<usize>();
    write_atomically(path, |file| {
        let mut out = io::BufWriter::with_capacity(1 << 20, file);
        out.write_all(&(header.len() as u64).to_le_bytes())?;
        out.write_all(header.as_bytes())?;
        tensors.iter().try_for_each(|tensor| tensor.values.write(&mut out))?;
        out.flush()
    })?;
    Ok(size as u64)
}

fn tensors(surface: &BakedSurface) -> Vec<Tensor<'_>> {
    let vectors = |values| Values::F32(<[[f32; 3]]>::as_flattened(values));
    let vertex_count = surface.positions.len();
    let mut tensors = vec![
        Tensor { name: "position", shape: vec![vertex_count, 3], values: vectors(&surface.positions) },
        Tensor { name: "normal", shape: vec![vertex_count, 3], values: vectors(&surface.normals) },
        Tensor { name: "albedo", shape: vec![vertex_count, 3], values: vectors(&surface.albedo) },
        Tensor {
            name: "index",
            shape: vec![surface.triangles.len(), 3],
            values: Values::U32(surface.triangles.as_flattened()),
        },
    ];
    if let Some(uvs) = &surface.uvs {
        tensors.push(Tensor { name: "uv", shape: vec![vertex_count, 2], values: Values::F32(uvs.as_flattened()) });
    }
    let transfers = [("transfer", Some(&surface.transfer)), ("transfer_shadowed", surface.transfer_shadowed.as_ref())];
    for (name, transfer) in transfers.into_iter().filter_map(|(name, transfer)| Some((name, transfer?))) {
        let shape = vec![vertex_count, transfer.channels, transfer.order.coeff_count()];
        tensors.push(Tensor { name, shape, values: Values::F32(&transfer.values) });
    }
    tensors
}

fn metadata(surface: &BakedSurface) -> BTreeMap<&'static str, String> {
    let metadata = &surface.metadata;
    let mut map = BTreeMap::from([
        ("format", FORMAT.to_owned()),
        ("kind", VERTEX_TRANSFER.to_owned()),
        ("order", surface.transfer.order.to_string()),
        ("convention", CONVENTION.to_owned()),
        ("rays", metadata.rays.to_string()),
        ("bounces", metadata.bounces.to_string()),
        ("seed", metadata.seed.to_string()),
        ("shadowed", metadata.shadowed.to_string()),
        ("generator", concat!("prt-bake ", env!("CARGO_PKG_VERSION")).to_owned()),
    ]);
    if let Some(source) = &metadata.source {
        map.insert("source", format!("{} sha256:{}", source.name, source.sha256));
    }
    if let Some(error) = metadata.error {
        map.insert("error", format!("{error:e}"));
    }
    map
}

/// The safetensors header. The crate's own writer keeps metadata in an order that changes from run to run; sorted, the same bake is
/// the same bytes.
fn header(metadata: &BTreeMap<&str, String>, tensors: &[Tensor]) -> String {
    let mut entries: BTreeMap<&str, Value> = BTreeMap::from([("__metadata__", json!(metadata))]);
    let mut start = 0;
    for tensor in tensors {
        let end = start + tensor.values.byte_count();
        let dtype = tensor.values.dtype().to_string();
        entries.insert(tensor.name, json!({ "dtype": dtype, "shape": tensor.shape, "data_offsets": [start, end] }));
        start = end;
    }
    let mut header = json!(entries).to_string();
    while !header.len().is_multiple_of(8) {
        header.push(' ');
    }
    header
}
