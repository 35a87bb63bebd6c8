//! Writing a baked file.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::Path;

use safetensors::Dtype;
use serde_json::{Value, json};

use sh_core::Order;

use super::{
    BakedSurface, CONVENTION, FORMAT, Metadata, TEXTURE_ZONAL, VERTEX_TRANSFER, ZONAL, ZonalSurface, ZonalTexture,
};
use crate::atomic::write_atomically;
use crate::{Error, Geometry, ZonalTransfer};

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

pub(super) fn surface(surface: &BakedSurface, path: &Path) -> Result<u64, Error> {
    let (metadata, tensors) = surface_parts(surface);
    write(path, &metadata, &tensors)
}

/// The bytes that the file would have.
#[cfg(feature = "trace")]
pub(super) fn surface_bytes(surface: &BakedSurface) -> Vec<u8> {
    let (metadata, tensors) = surface_parts(surface);
    let mut bytes = Vec::new();
    put(&header(&metadata, &tensors), &tensors, &mut bytes).expect("memory takes everything");
    bytes
}

fn surface_parts(surface: &BakedSurface) -> (BTreeMap<&'static str, String>, Vec<Tensor<'_>>) {
    let mut tensors = geometry(&surface.geometry);
    let transfers = [("transfer", Some(&surface.transfer)), ("transfer_shadowed", surface.transfer_shadowed.as_ref())];
    for (name, transfer) in transfers.into_iter().filter_map(|(name, transfer)| Some((name, transfer?))) {
        let shape = vec![surface.geometry.vertex_count(), transfer.channels, transfer.order.coeff_count()];
        tensors.push(Tensor { name, shape, values: Values::F32(&transfer.values) });
    }
    tensors.extend(surface.validity.as_ref().map(|validity| Tensor {
        name: "validity",
        shape: vec![validity.len()],
        values: Values::F32(validity),
    }));
    (metadata(&surface.metadata, VERTEX_TRANSFER, surface.transfer.order), tensors)
}

pub(super) fn zonal_surface(surface: &ZonalSurface, path: &Path) -> Result<u64, Error> {
    let mut tensors = geometry(&surface.geometry);
    tensors.extend(lobes(&surface.transfer, &[surface.geometry.vertex_count()]));
    write(path, &zonal_metadata(&surface.metadata, ZONAL, &surface.transfer), &tensors)
}

pub(super) fn zonal_texture(texture: &ZonalTexture, path: &Path) -> Result<u64, Error> {
    let size = vec![texture.height, texture.width];
    let vectors = Values::F32(texture.normals.as_flattened());
    let mut tensors = lobes(&texture.transfer, &size);
    tensors.extend([
        Tensor { name: "albedo", shape: vec![3], values: Values::F32(&texture.albedo) },
        Tensor { name: "height", shape: size.clone(), values: Values::F32(&texture.heights) },
        Tensor { name: "normal", shape: [size.as_slice(), &[3]].concat(), values: vectors },
    ]);
    write(path, &texture_metadata(texture), &tensors)
}

/// Writes the file; returns its size.
fn write(path: &Path, metadata: &BTreeMap<&str, String>, tensors: &[Tensor]) -> Result<u64, Error> {
    let header = header(metadata, tensors);
    let size = 8 + header.len() + tensors.iter().map(|tensor| tensor.values.byte_count()).sum::<usize>();
    write_atomically(path, |file| {
        let mut out = io::BufWriter::with_capacity(1 << 20, file);
        put(&header, tensors, &mut out)?;
        out.flush()
    })?;
    Ok(size as u64)
}

fn put(header: &str, tensors: &[Tensor], out: &mut impl Write) -> io::Result<()> {
    out.write_all(&(header.len() as u64).to_le_bytes())?;
    out.write_all(header.as_bytes())?;
    tensors.iter().try_for_each(|tensor| tensor.values.write(out))
}

fn geometry(geometry: &Geometry) -> Vec<Tensor<'_>> {
    let vectors = |values| Values::F32(<[[f32; 3]]>::as_flattened(values));
    let vertex_count = geometry.vertex_count();
    let triangles = Values::U32(geometry.triangles.as_flattened());
    let mut tensors = vec![
        Tensor { name: "position", shape: vec![vertex_count, 3], values: vectors(&geometry.positions) },
        Tensor { name: "normal", shape: vec![vertex_count, 3], values: vectors(&geometry.normals) },
        Tensor { name: "albedo", shape: vec![vertex_count, 3], values: vectors(&geometry.albedo) },
        Tensor { name: "index", shape: vec![geometry.triangles.len(), 3], values: triangles },
    ];
    if let Some(uvs) = &geometry.uvs {
        tensors.push(Tensor { name: "uv", shape: vec![vertex_count, 2], values: Values::F32(uvs.as_flattened()) });
    }
    tensors
}

/// - `points`: the shape of the set of points, `[V]` or `[H, W]`
fn lobes<'a>(transfer: &'a ZonalTransfer, points: &[usize]) -> Vec<Tensor<'a>> {
    let [explicit, axis, coeff] = lobe_shapes(transfer, points);
    let mut tensors = vec![
        Tensor { name: "explicit", shape: explicit, values: Values::F32(&transfer.explicit) },
        Tensor { name: "lobe_axis", shape: axis, values: Values::F32(transfer.axes.as_flattened()) },
        Tensor { name: "lobe_coeff", shape: coeff, values: Values::F32(&transfer.coeffs) },
    ];
    if let Some(map) = &transfer.view_map {
        let shape = vec![map.size, map.size, transfer.rows];
        tensors.push(Tensor { name: "view_map", shape, values: Values::F32(&map.values) });
    }
    tensors
}

/// Shapes of `explicit`, `lobe_axis` and `lobe_coeff`: a single row and a single channel have no dimension of their own.
pub(super) fn lobe_shapes(transfer: &ZonalTransfer, points: &[usize]) -> [Vec<usize>; 3] {
    let several = |count: usize| if count > 1 { vec![count] } else { Vec::new() };
    let rows = [points, &several(transfer.rows)].concat();
    let channels = [rows.as_slice(), &several(transfer.channels)].concat();
    [
        [channels.as_slice(), &[transfer.explicit_count]].concat(),
        [rows.as_slice(), &[transfer.lobe_count, 3]].concat(),
        [channels.as_slice(), &[transfer.lobe_count, transfer.order.get()]].concat(),
    ]
}

/// What every kind of file says of itself.
pub(crate) fn metadata(metadata: &Metadata, kind: &str, order: Order) -> BTreeMap<&'static str, String> {
    let mut map = BTreeMap::from([
        ("format", FORMAT.to_owned()),
        ("kind", kind.to_owned()),
        ("order", order.to_string()),
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
    map.extend(metadata.identity.iter().map(|identity| ("identity", identity.clone())));
    let errors =
        [("error", metadata.error), ("fit_error", metadata.fit_error), ("target_error", metadata.target_error)];
    map.extend(errors.into_iter().filter_map(|(name, error)| Some((name, format!("{:e}", error?)))));
    map
}

/// Metadata of a texture.
pub(super) fn texture_metadata(texture: &ZonalTexture) -> BTreeMap<&'static str, String> {
    let mut map = zonal_metadata(&texture.metadata, TEXTURE_ZONAL, &texture.transfer);
    map.extend([("material", texture.material.name().to_owned()), ("coherent", texture.is_coherent.to_string())]);
    map
}

/// Metadata of a file with lobes. `rows` and `channels` tell dimensions of the same size apart.
fn zonal_metadata(from: &Metadata, kind: &str, transfer: &ZonalTransfer) -> BTreeMap<&'static str, String> {
    let mut map = metadata(from, kind, transfer.order);
    map.extend([
        ("lobes", transfer.lobe_count.to_string()),
        ("rows", transfer.rows.to_string()),
        ("channels", transfer.channels.to_string()),
    ]);
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
