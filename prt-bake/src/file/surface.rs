//! Surfaces with a transfer vector at each vertex.

use std::path::Path;

use super::{BakedFile, Metadata, VERTEX_TRANSFER, malformed, read, write};
use crate::input::read_file;
use crate::{Error, Geometry, TransferVectors};

/// A surface with its baked transfer: all that shading needs, and how it was made.
///
/// In the file: `position`, `normal`, `albedo` `[V, 3]` f32, `index` `[T, 3]` u32, `transfer` `[V, C, n²]` f32, and where they
/// exist `uv` `[V, 2]`, `transfer_shadowed` `[V, 1, n²]` and `validity` `[V]`. All are row-major and little-endian.
#[derive(Debug, Clone, PartialEq)]
pub struct BakedSurface {
    /// How the transfer was made.
    pub metadata: Metadata,
    /// The surface.
    pub geometry: Geometry,
    /// Transfer of all light, direct and reflected.
    pub transfer: TransferVectors,
    /// Transfer of direct light alone, if `transfer` has interreflections and this was kept beside it. One channel.
    pub transfer_shadowed: Option<TransferVectors>,
    /// For each vertex the share of its directions that do not end on the back of a face: near 1 outside of all solids, near 0 inside one,
    /// where the transfer is not to be relied on. `None` for transfer without shadows.
    pub validity: Option<Vec<f32>>,
}

impl BakedSurface {
    /// The unshadowed transfer of the surface, from its normals.
    #[must_use]
    pub fn unshadowed(&self) -> TransferVectors {
        TransferVectors::unshadowed(self.transfer.order, &self.geometry.normals)
    }

    /// Reads a baked file of this kind. Shapes are checked against the metadata, and indices and values looked through, before
    /// anything is used.
    ///
    /// # Errors
    /// If the file cannot be read, is not a baked file, is of a newer format or another kind, or contradicts itself.
    pub fn read(path: &Path) -> Result<Self, Error> {
        Self::from_bytes(&read_file(path)?, path)
    }

    /// As [`BakedSurface::read`], from the content of a file, or of a part of the file `path`.
    pub(crate) fn from_bytes(bytes: &[u8], path: &Path) -> Result<Self, Error> {
        match read::file(bytes).map_err(|reason| malformed(path, reason))? {
            BakedFile::Vectors(surface) => Ok(surface),
            other => Err(other.unexpected(path, VERTEX_TRANSFER)),
        }
    }

    /// The content of the file that [`BakedSurface::write`] makes.
    #[cfg(feature = "trace")]
    pub(crate) fn to_bytes(&self) -> Result<Vec<u8>, Error> {
        self.check()?;
        Ok(write::surface_bytes(self))
    }

    /// Writes a baked file; returns its size in bytes. The file appears under its name only when it is complete.
    ///
    /// # Errors
    /// If the file cannot be written, or the arrays have different lengths.
    pub fn write(&self, path: &Path) -> Result<u64, Error> {
        self.check()?;
        write::surface(self, path)
    }

    fn check(&self) -> Result<(), Error> {
        self.geometry.check_lengths()?;
        self.geometry.check_count("transfer vectors", self.transfer.vertex_count())?;
        if let Some(validity) = &self.validity {
            self.geometry.check_count("validities", validity.len())?;
        }
        if let Some(shadowed) = &self.transfer_shadowed {
            self.geometry.check_count("shadowed transfer vectors", shadowed.vertex_count())?;
        }
        Ok(())
    }
}
