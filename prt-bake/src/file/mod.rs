//! The baked file `*.prt`: safetensors with metadata, so that NumPy, PyTorch and any engine can map it into memory.

mod read;
mod write;

use std::collections::BTreeMap;
use std::path::Path;

use crate::input::read_file;
use crate::{Error, TransferVectors};

/// The version of the format that is written, and the newest that is read.
const FORMAT: &str = "prt/1";
/// The kind of file that holds one transfer vector for each vertex and channel.
const VERTEX_TRANSFER: &str = "vertex-transfer";
/// The basis and the order of its functions.
const CONVENTION: &str = "real, condon-shortley, i=l(l+1)+m";

/// A surface with its baked transfer: all that shading needs, and how it was made.
///
/// In the file: `position`, `normal`, `albedo` `[V, 3]` f32, `index` `[T, 3]` u32, `transfer` `[V, C, n²]` f32, and where they
/// exist `uv` `[V, 2]` and `transfer_shadowed` `[V, 1, n²]`. All are row-major and little-endian.
#[derive(Debug, Clone, PartialEq)]
pub struct BakedSurface {
    /// How the transfer was made.
    pub metadata: Metadata,
    /// Positions `[V]`, scene units.
    pub positions: Vec<[f32; 3]>,
    /// Shading normals `[V]`, unit length.
    pub normals: Vec<[f32; 3]>,
    /// Three vertex numbers a face.
    pub triangles: Vec<[u32; 3]>,
    /// Diffuse albedo `[V]`, linear. It is not part of the transfer of its own vertex.
    pub albedo: Vec<[f32; 3]>,
    /// Texture coordinates `[V]`.
    pub uvs: Option<Vec<[f32; 2]>>,
    /// Transfer of all light, direct and reflected.
    pub transfer: TransferVectors,
    /// Transfer of direct light alone, if `transfer` has interreflections and this was kept beside it. One channel.
    pub transfer_shadowed: Option<TransferVectors>,
}

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
}

/// The file that a surface was baked from.
#[derive(Debug, Clone, PartialEq, Eq)]
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
        use sha2::Digest;
        let bytes = read_file(path)?;
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let sha256 = sha2::Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(Self { name, sha256 })
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

impl BakedSurface {
    /// The unshadowed transfer of the surface, from its normals.
    #[must_use]
    pub fn unshadowed(&self) -> TransferVectors {
        TransferVectors::unshadowed(self.transfer.order, &self.normals)
    }

    /// Reads a baked file. Shapes are checked against the metadata, and indices and values looked through, before anything is used.
    ///
    /// # Errors
    /// If the file cannot be read, is not a baked file, is of a newer format or another kind, or contradicts itself.
    pub fn read(path: &Path) -> Result<Self, Error> {
        read::surface(&read_file(path)?).map_err(|reason| malformed(path, reason))
    }

    /// Writes a baked file; returns its size in bytes. The file appears under its name only when it is complete.
    ///
    /// # Errors
    /// If the file cannot be written, or the arrays have different lengths.
    pub fn write(&self, path: &Path) -> Result<u64, Error> {
        self.check_lengths()?;
        write::surface(self, path)
    }

    fn check_lengths(&self) -> Result<(), Error> {
        let vertex_count = self.positions.len();
        let uv_count = self.uvs.as_ref().map_or(vertex_count, Vec::len);
        let shadowed_count = self.transfer_shadowed.as_ref().map_or(vertex_count, TransferVectors::vertex_count);
        let counts = [
            ("normals", self.normals.len()),
            ("albedo", self.albedo.len()),
            ("uvs", uv_count),
            ("transfer vectors", self.transfer.vertex_count()),
            ("shadowed transfer vectors", shadowed_count),
        ];
        match counts.into_iter().find(|&(_, count)| count != vertex_count) {
            Some((what, count)) => Err(Error::InconsistentMesh(format!("{count} {what} for {vertex_count} vertices"))),
            None => Ok(()),
        }
    }
}

/// What a baked file of any kind says of itself.
///
/// # Errors
/// If the file cannot be read or is not a safetensors file with metadata.
pub fn file_info(path: &Path) -> Result<FileInfo, Error> {
    read::info(&read_file(path)?).map_err(|reason| malformed(path, reason))
}

fn malformed(path: &Path, reason: String) -> Error {
    Error::Malformed { path: path.to_owned(), format: "PRT", reason }
}

#[cfg(test)]
mod tests;
