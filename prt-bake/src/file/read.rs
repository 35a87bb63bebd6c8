//! Reading a baked file. Errors are the reason alone; the caller adds the name of the file.

use std::collections::{BTreeMap, HashMap};

use safetensors::tensor::TensorView;
use safetensors::{Dtype, SafeTensors};
use sh_core::Order;

use super::{BakedSurface, CONVENTION, FORMAT, FileInfo, Metadata, Source, TensorInfo, VERTEX_TRANSFER};
use crate::{BakeOptions, TransferVectors};

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

pub(super) fn surface(bytes: &[u8]) -> Result<BakedSurface, Reason> {
    let map = info(bytes)?.metadata;
    check_kind(&map)?;
    let tensors = SafeTensors::deserialize(bytes).map_err(|error| error.to_string())?;
    let file = Tensors { tensors: tensors.tensors().into_iter().collect(), order: order(&map)? };
    let positions = file.vectors("position", None)?;
    let vertex_count = Some(positions.len());
    Ok(BakedSurface {
        metadata: metadata(&map)?,
        normals: file.vectors("normal", vertex_count)?,
        albedo: file.vectors("albedo", vertex_count)?,
        triangles: file.triangles(positions.len())?,
        uvs: file.has("uv").then(|| file.vectors("uv", vertex_count)).transpose()?,
        transfer: file.transfer("transfer", positions.len())?,
        transfer_shadowed: file
            .has("transfer_shadowed")
            .then(|| file.transfer("transfer_shadowed", positions.len()))
            .transpose()?,
        positions,
    })
}

fn check_kind(map: &BTreeMap<String, String>) -> Result<(), Reason> {
    let format = entry(map, "format")?;
    if format != FORMAT {
        let is_newer = version(format) > version(FORMAT);
        let relation = if is_newer { "newer than" } else { "not" };
        return Err(format!("its format is {format}, {relation} what this version reads, {FORMAT}"));
    }
    match (entry(map, "kind")?, entry(map, "convention")?) {
        (VERTEX_TRANSFER, CONVENTION) => Ok(()),
        (VERTEX_TRANSFER, other) => Err(format!("its convention is \"{other}\"; \"{CONVENTION}\" is read")),
        (other, _) => Err(format!("its kind is {other}; {VERTEX_TRANSFER} is read")),
    }
}

fn version(format: &str) -> Option<u32> {
    format.strip_prefix("prt/")?.parse().ok()
}

fn entry<'a>(map: &'a BTreeMap<String, String>, key: &str) -> Result<&'a str, Reason> {
    map.get(key).map(String::as_str).ok_or_else(|| format!("its metadata has no entry \"{key}\""))
}

fn number<T: std::str::FromStr>(map: &BTreeMap<String, String>, key: &str) -> Result<T, Reason> {
    let text = entry(map, key)?;
    text.parse().map_err(|_| format!("its metadata entry \"{key}\" is \"{text}\", not a valid value"))
}

fn order(map: &BTreeMap<String, String>) -> Result<Order, Reason> {
    let n: usize = number(map, "order")?;
    Order::new(n)
        .ok()
        .filter(|order| order.get() <= BakeOptions::MAX_ORDER)
        .ok_or_else(|| format!("its order is {n}; 1 to {} are read", BakeOptions::MAX_ORDER))
}

fn metadata(map: &BTreeMap<String, String>) -> Result<Metadata, Reason> {
    Ok(Metadata {
        rays: number(map, "rays")?,
        bounces: number(map, "bounces")?,
        seed: number(map, "seed")?,
        shadowed: number(map, "shadowed")?,
        source: map.get("source").and_then(|text| source(text)),
        error: map.contains_key("error").then(|| number(map, "error")).transpose()?,
    })
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
