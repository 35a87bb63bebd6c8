//! The baked file `*.prt`: safetensors with metadata, so that NumPy, PyTorch and any engine can map it into memory.

mod exr;
mod read;
mod sorted_head;
mod surface;
mod write;
mod zonal;

use std::collections::BTreeMap;
use std::path::Path;

use sh_core::Order;

use crate::Error;
use crate::image::is_exr;
use crate::input::read_file;

pub(crate) use exr::{ATTRIBUTE_PREFIX, planes, write_planes};
pub(crate) use read::{check_format, entry, metadata as read_metadata, order as read_order};
pub use surface::BakedSurface;
pub(crate) use write::metadata as metadata_entries;
pub use zonal::{Material, ZonalSurface, ZonalTexture};

/// The version of the format that is written, and the newest that is read.
const FORMAT: &str = "prt/1";
/// The kind of file that holds one transfer vector for each vertex and channel.
const VERTEX_TRANSFER: &str = "vertex-transfer";
/// The kind of file that holds zonal lobes for each vertex.
const ZONAL: &str = "zonal";
/// The kind of file that holds zonal lobes for each texel of a texture that tiles.
const TEXTURE_ZONAL: &str = "texture-zonal";
/// The basis and the order of its functions.
const CONVENTION: &str = "real, condon-shortley, i=l(l+1)+m";

/// How a surface was baked.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Metadata {
    /// Rays per vertex, over the hemisphere; 0 for unshadowed transfer.
    pub rays: usize,
    /// Interreflections that were followed.
    pub bounces: usize,
    /// Seed of the directions.
    pub seed: u64,
    /// Whether surfaces shadow one another.
    pub shadowed: bool,
    /// Name and content of the file that was baked.
    pub source: Option<Source>,
    /// Estimated error of the shadowed transfer vectors: root mean square of their error over root mean square of the unshadowed
    /// vectors' length, from baking some vertices twice with different directions. It does not contain the error of bounces.
    pub error: Option<f64>,
    /// SHA-256, in hexadecimal, of the mesh and the options that it was baked with: equal for equal bakes.
    pub identity: Option<String>,
    /// Error at which vertices stopped, if the bake was asked for one.
    pub target_error: Option<f64>,
    /// Error of zonal lobes: root mean square of what they leave over root mean square of the vectors that they were fitted to.
    pub fit_error: Option<f64>,
}

/// The file that a surface was baked from.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "trace", derive(serde::Serialize, serde::Deserialize))]
pub struct Source {
    /// File name without folders.
    pub name: String,
    /// SHA-256 of its bytes, in hexadecimal.
    pub sha256: String,
}

impl Source {
    /// Reads a file and takes down its name and content.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn of_file(path: &Path) -> Result<Self, Error> {
        let bytes = read_file(path)?;
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        Ok(Self { name, sha256: crate::hash::hex(&bytes) })
    }
}

/// What a baked file says of itself.
#[derive(Debug, Clone, PartialEq)]
pub struct FileInfo {
    /// The metadata map, as written.
    pub metadata: BTreeMap<String, String>,
    /// The tensors, by name.
    pub tensors: Vec<TensorInfo>,
    /// Size of the file in bytes.
    pub bytes: u64,
}

/// One tensor of a baked file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TensorInfo {
    /// Its name.
    pub name: String,
    /// Its scalar type, as safetensors spells it: `F32`.
    pub dtype: String,
    /// Its shape, row-major.
    pub shape: Vec<usize>,
}

/// A baked file of any kind.
#[derive(Debug, Clone, PartialEq)]
pub enum BakedFile {
    /// A transfer vector for each vertex.
    Vectors(BakedSurface),
    /// Zonal lobes for each vertex.
    Zonal(ZonalSurface),
    /// Zonal lobes for each texel.
    Texture(ZonalTexture),
}

impl BakedFile {
    /// Reads a baked file, whatever its kind. Shapes are checked against the metadata, and indices and values looked through, before
    /// anything is used.
    ///
    /// # Errors
    /// If the file cannot be read, is not a baked file, is of a newer format or an unknown kind, or contradicts itself.
    pub fn read(path: &Path) -> Result<Self, Error> {
        read::file(&read_file(path)?).map_err(|reason| malformed(path, reason))
    }

    /// The order of the transfer.
    #[must_use]
    pub fn order(&self) -> Order {
        match self {
            Self::Vectors(surface) => surface.transfer.order,
            Self::Zonal(surface) => surface.transfer.order,
            Self::Texture(texture) => texture.transfer.order,
        }
    }

    /// How the transfer was made.
    #[must_use]
    pub fn metadata(&self) -> &Metadata {
        match self {
            Self::Vectors(surface) => &surface.metadata,
            Self::Zonal(surface) => &surface.metadata,
            Self::Texture(texture) => &texture.metadata,
        }
    }

    fn kind(&self) -> &'static str {
        match self {
            Self::Vectors(_) => VERTEX_TRANSFER,
            Self::Zonal(_) => ZONAL,
            Self::Texture(_) => TEXTURE_ZONAL,
        }
    }

    fn unexpected(&self, path: &Path, wanted: &'static str) -> Error {
        Error::Kind { path: path.to_owned(), given: self.kind(), wanted }
    }
}

/// What a baked file of any kind says of itself. Of an image only the head is read, and its channels count as tensors.
///
/// # Errors
/// If the file cannot be read, or is neither a safetensors file with metadata nor an OpenEXR image that was baked ([`Error::Unsupported`]).
pub fn file_info(path: &Path) -> Result<FileInfo, Error> {
    if is_exr(path)? {
        return exr::info(path);
    }
    read::info(&read_file(path)?).map_err(|reason| malformed(path, reason))
}

fn malformed(path: &Path, reason: String) -> Error {
    Error::Malformed { path: path.to_owned(), format: "PRT", reason }
}

#[cfg(test)]
mod tests;
