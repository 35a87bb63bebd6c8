//! Reading a baked file. Errors are the reason alone; the caller adds the name of the file.

use std::collections::{BTreeMap, HashMap};

use safetensors::tensor::TensorView;
use safetensors::{Dtype, SafeTensors};
use sh_core::Order;

use super::{
    BakedFile, BakedSurface, CONVENTION, FORMAT, FileInfo, Material, Metadata, Source, TEXTURE_ZONAL, TensorInfo,
    VERTEX_TRANSFER, ZONAL, ZonalSurface, ZonalTexture, write,
};
use crate::{BakeOptions, Geometry, TransferVectors, ViewMap, ZonalTransfer};

/// A reason why a file is refused.
type Reason = String;

pub(super) fn info(bytes: &[u8]) -> Result<FileInfo, Reason> {
    let (_, header) = SafeTensors::read_metadata(bytes).map_err(|error| error.to_string())?;
    let metadata = header.metadata().clone().unwrap_or_default().into_iter().collect();
    let tensor = |(name, info): (String, &safetensors::tensor::TensorInfo)| TensorInfo {
        name,
        dtype: info.dtype.to_string(),
        shape: info.shape.clone(),
    };
    let mut tensors: Vec<TensorInfo> = header.tensors().into_iter().map(tensor).collect();
    tensors.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(FileInfo { metadata, tensors, bytes: bytes.len() as u64 })
}

pub(super) fn file(bytes: &[u8]) -> Result<BakedFile, Reason> {
    let map = info(bytes)?.metadata;
    check_format(&map)?;
    let tensors = SafeTensors::deserialize(bytes).map_err(|error| error.to_string())?;
    let file = Tensors { tensors: tensors.tensors().into_iter().collect(), order: order(&map)? };
    match entry(&map, "kind")? {
        VERTEX_TRANSFER => surface(&map, &file).map(BakedFile::Vectors),
        ZONAL => zonal_surface(&map, &file).map(BakedFile::Zonal),
        TEXTURE_ZONAL => zonal_texture(&map, &file).map(BakedFile::Texture),
        other => Err(format!("its kind is {other}; {VERTEX_TRANSFER}, {ZONAL} and {TEXTURE_ZONAL} are read")),
    }
}

fn surface(map: &BTreeMap<String, String>, file: &Tensors) -> Result<BakedSurface, Reason> {
    let geometry = file.geometry()?;
    let transfer = |name| file.transfer(name, geometry.vertex_count());
    Ok(BakedSurface {
        metadata: metadata(map)?,
        transfer: transfer("transfer")?,
        transfer_shadowed: file.has("transfer_shadowed").then(|| transfer("transfer_shadowed")).transpose()?,
        validity: file
            .has("validity")
            .then(|| file.floats("validity", &[Some(geometry.vertex_count())]))
            .transpose()?,
        geometry,
    })
}

fn zonal_surface(map: &BTreeMap<String, String>, file: &Tensors) -> Result<ZonalSurface, Reason> {
    let geometry = file.geometry()?;
    let transfer = file.lobes(map, &[geometry.vertex_count()])?;
    Ok(ZonalSurface { metadata: metadata(map)?, geometry, transfer })
}

fn zonal_texture(map: &BTreeMap<String, String>, file: &Tensors) -> Result<ZonalTexture, Reason> {
    let &[height, width] = file.shape("height")? else { return Err("tensor height is not [H, W]".to_owned()) };
    let normals = file.floats("normal", &[Some(height), Some(width), Some(3)])?;
    let albedo = file.floats("albedo", &[Some(3)])?;
    Ok(ZonalTexture {
        metadata: metadata(map)?,
        width,
        height,
        heights: file.floats("height", &[None, None])?,
        normals: normals.as_chunks().0.to_vec(),
        albedo: std::array::from_fn(|channel| albedo[channel]),
        material: material(map)?,
        is_coherent: number(map, "coherent")?,
        transfer: file.lobes(map, &[height, width])?,
    })
}

pub(crate) fn check_format(map: &BTreeMap<String, String>) -> Result<(), Reason> {
    let format = entry(map, "format")?;
    if format != FORMAT {
        let is_newer = version(format) > version(FORMAT);
        let relation = if is_newer { "newer than" } else { "not" };
        return Err(format!("its format is {format}, {relation} what this version reads, {FORMAT}"));
    }
    match entry(map, "convention")? {
        CONVENTION => Ok(()),
        other => Err(format!("its convention is \"{other}\"; \"{CONVENTION}\" is read")),
    }
}

fn version(format: &str) -> Option<u32> {
    format.strip_prefix("prt/")?.parse().ok()
}

pub(crate) fn entry<'a>(map: &'a BTreeMap<String, String>, key: &str) -> Result<&'a str, Reason> {
    map.get(key).map(String::as_str).ok_or_else(|| format!("its metadata has no entry \"{key}\""))
}

fn number<T: std::str::FromStr>(map: &BTreeMap<String, String>, key: &str) -> Result<T, Reason> {
    let text = entry(map, key)?;
    text.parse().map_err(|_| format!("its metadata entry \"{key}\" is \"{text}\", not a valid value"))
}

/// Most rows of glossy transfer that are read.
const MAX_ROWS: usize = 1024;
/// How far the length of a lobe's axis may be from 1. Axes are rounded to `f32`; anything beyond this was not one.
const AXIS_TOLERANCE: f32 = 1e-3;

fn in_range(
    map: &BTreeMap<String, String>,
    key: &str,
    range: std::ops::RangeInclusive<usize>,
) -> Result<usize, Reason> {
    let value = number(map, key)?;
    if range.contains(&value) {
        return Ok(value);
    }
    Err(format!("its metadata entry \"{key}\" is {value}; {} to {} are read", range.start(), range.end()))
}

fn check_unit(axes: &[[f32; 3]]) -> Result<(), Reason> {
    let is_unit = |axis: &[f32; 3]| (axis.iter().map(|x| x * x).sum::<f32>().sqrt() - 1.0).abs() <= AXIS_TOLERANCE;
    match axes.iter().position(|axis| !is_unit(axis)) {
        Some(place) => {
            Err(format!("lobe {place} of tensor lobe_axis has the axis {:?}, not of unit length", axes[place]))
        }
        None => Ok(()),
    }
}

pub(crate) fn order(map: &BTreeMap<String, String>) -> Result<Order, Reason> {
    let n: usize = number(map, "order")?;
    Order::new(n)
        .ok()
        .filter(|order| order.get() <= BakeOptions::MAX_ORDER)
        .ok_or_else(|| format!("its order is {n}; 1 to {} are read", BakeOptions::MAX_ORDER))
}

pub(crate) fn metadata(map: &BTreeMap<String, String>) -> Result<Metadata, Reason> {
    Ok(Metadata {
        rays: number(map, "rays")?,
        bounces: number(map, "bounces")?,
        seed: number(map, "seed")?,
        shadowed: number(map, "shadowed")?,
        source: map.get("source").and_then(|text| source(text)),
        identity: map.get("identity").cloned(),
        error: error(map, "error")?,
        target_error: error(map, "target_error")?,
        fit_error: error(map, "fit_error")?,
    })
}

fn material(map: &BTreeMap<String, String>) -> Result<Material, Reason> {
    let name = entry(map, "material")?;
    Material::of_name(name).ok_or_else(|| format!("its material is {name}; diffuse, glossy and translucent are read"))
}

/// An error of what is in the file.
fn error(map: &BTreeMap<String, String>, key: &str) -> Result<Option<f64>, Reason> {
    let error = map.contains_key(key).then(|| number(map, key)).transpose()?;
    match error.filter(|error: &f64| !(0.0..=f64::MAX).contains(error)) {
        Some(error) => Err(format!("its metadata entry \"{key}\" is {error}; a number from 0 on is needed")),
        None => Ok(error),
    }
}

fn source(text: &str) -> Option<Source> {
    let (name, sha256) = text.rsplit_once(" sha256:")?;
    Some(Source { name: name.to_owned(), sha256: sha256.to_owned() })
}

/// The arrays of a file whose header was found in order.
struct Tensors<'a> {
    tensors: HashMap<String, TensorView<'a>>,
    order: Order,
}

impl Tensors<'_> {
    fn has(&self, name: &str) -> bool {
        self.tensors.contains_key(name)
    }

    fn shape(&self, name: &str) -> Result<&[usize], Reason> {
        self.tensors.get(name).map(|tensor| tensor.shape()).ok_or_else(|| format!("tensor {name} is missing"))
    }

    fn geometry(&self) -> Result<Geometry, Reason> {
        let positions = self.vectors("position", None)?;
        let vertex_count = Some(positions.len());
        Ok(Geometry {
            normals: self.vectors("normal", vertex_count)?,
            albedo: self.vectors("albedo", vertex_count)?,
            triangles: self.triangles(positions.len())?,
            uvs: self.has("uv").then(|| self.vectors("uv", vertex_count)).transpose()?,
            positions,
        })
    }

    /// Lobes of a set of points of the given shape. Sizes come from the tensors themselves, whose bytes are there.
    fn lobes(&self, map: &BTreeMap<String, String>, points: &[usize]) -> Result<ZonalTransfer, Reason> {
        let last = |name: &str, from_end: usize| -> Result<usize, Reason> {
            let shape = self.shape(name)?;
            shape
                .len()
                .checked_sub(from_end)
                .map(|i| shape[i])
                .ok_or_else(|| format!("tensor {name} has shape {shape:?}"))
        };
        let explicit_count = match last("explicit", 1)? {
            count @ (1 | 4) if count <= self.order.coeff_count() => count,
            other => return Err(format!("tensor explicit has {other} coefficients a row; 1 and 4 are read")),
        };
        let mut lobes = ZonalTransfer {
            order: self.order,
            rows: in_range(map, "rows", 1..=MAX_ROWS)?,
            channels: in_range(map, "channels", 1..=3)?,
            lobe_count: last("lobe_axis", 2)?,
            explicit_count,
            explicit: Vec::new(),
            axes: Vec::new(),
            coeffs: Vec::new(),
            view_map: None,
        };
        let [explicit, axis, coeff] =
            write::lobe_shapes(&lobes, points).map(|shape| shape.into_iter().map(Some).collect::<Vec<_>>());
        lobes.explicit = self.floats("explicit", &explicit)?;
        lobes.axes = self.floats("lobe_axis", &axis)?.as_chunks().0.to_vec();
        lobes.coeffs = self.floats("lobe_coeff", &coeff)?;
        check_unit(&lobes.axes)?;
        lobes.view_map = self.view_map(lobes.rows)?;
        Ok(lobes)
    }

    fn view_map(&self, rows: usize) -> Result<Option<ViewMap>, Reason> {
        if !self.has("view_map") {
            return if rows == 1 {
                Ok(None)
            } else {
                Err(format!("tensor view_map is missing; there are {rows} rows"))
            };
        }
        let size = self.shape("view_map")?.first().copied().unwrap_or_default();
        Ok(Some(ViewMap { size, values: self.floats("view_map", &[Some(size), Some(size), Some(rows)])? }))
    }

    /// The bytes of a tensor of the given type and shape; `None` in the shape allows any size.
    fn bytes(&self, name: &str, dtype: Dtype, shape: &[Option<usize>]) -> Result<&[u8], Reason> {
        let tensor = self.tensors.get(name).ok_or_else(|| format!("tensor {name} is missing"))?;
        if tensor.dtype() != dtype {
            return Err(format!("tensor {name} has type {}; {dtype} is needed", tensor.dtype()));
        }
        let is_right = tensor.shape().len() == shape.len()
            && tensor.shape().iter().zip(shape).all(|(&size, needed)| needed.is_none_or(|needed| size == needed));
        if !is_right {
            return Err(format!("tensor {name} has shape {:?}; {} is needed", tensor.shape(), describe(shape)));
        }
        Ok(tensor.data())
    }

    fn floats(&self, name: &str, shape: &[Option<usize>]) -> Result<Vec<f32>, Reason> {
        let bytes = self.bytes(name, Dtype::F32, shape)?;
        let values: Vec<f32> = bytes.as_chunks().0.iter().map(|&bytes| f32::from_le_bytes(bytes)).collect();
        match values.iter().position(|value| !value.is_finite()) {
            Some(place) => Err(format!("tensor {name} has the value {} at element {place}", values[place])),
            None => Ok(values),
        }
    }

    fn vectors<const N: usize>(&self, name: &str, count: Option<usize>) -> Result<Vec<[f32; N]>, Reason> {
        Ok(self.floats(name, &[count, Some(N)])?.as_chunks().0.to_vec())
    }

    fn triangles(&self, vertex_count: usize) -> Result<Vec<[u32; 3]>, Reason> {
        let bytes = self.bytes("index", Dtype::U32, &[None, Some(3)])?;
        let numbers: Vec<u32> = bytes.as_chunks().0.iter().map(|&bytes| u32::from_le_bytes(bytes)).collect();
        match numbers.iter().position(|&vertex| vertex as usize >= vertex_count) {
            Some(place) => {
                Err(format!("face {} of tensor index uses vertex {} of {vertex_count}", place / 3, numbers[place]))
            }
            None => Ok(numbers.as_chunks().0.to_vec()),
        }
    }

    fn transfer(&self, name: &str, vertex_count: usize) -> Result<TransferVectors, Reason> {
        let channels = match self.tensors.get(name).map(|tensor| tensor.shape()) {
            Some(&[_, 3, _]) => 3,
            _ => 1,
        };
        let shape = [Some(vertex_count), Some(channels), Some(self.order.coeff_count())];
        Ok(TransferVectors { order: self.order, channels, values: self.floats(name, &shape)? })
    }
}

fn describe(shape: &[Option<usize>]) -> String {
    let sizes: Vec<String> = shape.iter().map(|size| size.map_or("any".to_owned(), |size| size.to_string())).collect();
    format!("[{}]", sizes.join(", "))
}
