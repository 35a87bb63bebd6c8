//! Surfaces and textures with zonal lobes.

use std::path::Path;

use super::{BakedFile, Metadata, TEXTURE_ZONAL, ZONAL, exr, write};
use crate::{Error, Geometry, ZonalTransfer};

/// A surface whose transfer is a sum of zonal lobes at each vertex, so that it can follow a deformation.
///
/// In the file: the tensors of the surface as for [`BakedSurface`](crate::BakedSurface), `explicit` `[V, k]`, `lobe_axis` `[V, N, 3]`, `lobe_coeff` `[V, N, n]`.
/// With `C` = 3 channels or `R` > 1 rows these have their own dimensions after the first, rows before channels; `view_map` is
/// `[size, size, R]`. The lobes are in the frame of the scene in the pose that was baked.
#[derive(Debug, Clone, PartialEq)]
pub struct ZonalSurface {
    /// How the transfer was made.
    pub metadata: Metadata,
    /// The surface.
    pub geometry: Geometry,
    /// Lobes of each vertex.
    pub transfer: ZonalTransfer,
}

impl ZonalSurface {
    /// Reads a baked file of this kind, checked as [`BakedSurface::read`](crate::BakedSurface::read) does.
    ///
    /// # Errors
    /// As [`BakedSurface::read`](crate::BakedSurface::read).
    pub fn read(path: &Path) -> Result<Self, Error> {
        match BakedFile::read(path)? {
            BakedFile::Zonal(surface) => Ok(surface),
            other => Err(other.unexpected(path, ZONAL)),
        }
    }

    /// Writes a baked file; returns its size in bytes. The file appears under its name only when it is complete.
    ///
    /// # Errors
    /// If the file cannot be written, or the arrays have different lengths.
    pub fn write(&self, path: &Path) -> Result<u64, Error> {
        self.geometry.check_lengths()?;
        self.transfer.check_shape(self.geometry.vertex_count())?;
        write::zonal_surface(self, path)
    }
}

/// Zonal lobes of a texture that tiles, to be laid over any surface.
///
/// In the file: `explicit`, `lobe_axis`, `lobe_coeff` as for [`ZonalSurface`] with `[H, W, …]` in place of `[V, …]`, `normal` `[H, W, 3]`,
/// `height` `[H, W]` in units of the tile's width, and `albedo` `[3]`; the metadata have `material` and `coherent` too. The lobes are in tangent space: x along u (columns), y along v (rows), z out of
/// the surface.
#[derive(Debug, Clone, PartialEq)]
pub struct ZonalTexture {
    /// How the transfer was made.
    pub metadata: Metadata,
    /// Columns `W`.
    pub width: usize,
    /// Rows `H`.
    pub height: usize,
    /// Heights of the relief `[H, W]`, in units of the tile's width.
    pub heights: Vec<f32>,
    /// Normals of the relief `[H, W]`, in tangent space.
    pub normals: Vec<[f32; 3]>,
    /// Albedo that the transfer is to be shaded with: that of the relief, or 1 where the transfer includes scattering in the material.
    pub albedo: [f32; 3],
    /// What the relief is made of.
    pub material: Material,
    /// Whether the lobes of neighbouring texels correspond, so that they can be interpolated.
    pub is_coherent: bool,
    /// Lobes of each texel.
    pub transfer: ZonalTransfer,
}

/// What a relief is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Material {
    /// Opaque and diffuse.
    #[default]
    Diffuse,
    /// Opaque and glossy: the transfer has rows, and a map of the view that weighs them.
    Glossy,
    /// Light is scattered inside: the transfer includes what comes out.
    Translucent,
}

impl Material {
    const NAMES: [(Self, &str); 3] =
        [(Self::Diffuse, "diffuse"), (Self::Glossy, "glossy"), (Self::Translucent, "translucent")];

    pub(super) fn name(self) -> &'static str {
        Self::NAMES.into_iter().find(|(material, _)| *material == self).map_or("diffuse", |(_, name)| name)
    }

    pub(super) fn of_name(name: &str) -> Option<Self> {
        Self::NAMES.into_iter().find(|(_, own)| *own == name).map(|(material, _)| material)
    }
}

impl ZonalTexture {
    /// Reads a baked file of this kind, checked as [`BakedSurface::read`](crate::BakedSurface::read) does.
    ///
    /// # Errors
    /// As [`BakedSurface::read`](crate::BakedSurface::read).
    pub fn read(path: &Path) -> Result<Self, Error> {
        match BakedFile::read(path)? {
            BakedFile::Texture(texture) => Ok(texture),
            other => Err(other.unexpected(path, TEXTURE_ZONAL)),
        }
    }

    /// Writes a baked file; returns its size in bytes. The file appears under its name only when it is complete.
    ///
    /// # Errors
    /// If the file cannot be written, or the arrays have different lengths.
    pub fn write(&self, path: &Path) -> Result<u64, Error> {
        self.check_lengths()?;
        write::zonal_texture(self, path)
    }

    /// Writes the texture as an OpenEXR image of 32 bits with named channels, for programs that read those; returns its size in bytes.
    ///
    /// Channels: `explicit.0` …, `lobe0.axis.x` …, `lobe0.coeff.0` … (the band), `normal.x` …, `height`. With several rows the names begin
    /// with `row0.`; with three channels coefficients end with `.r`, `.g`, `.b`. The metadata are attributes of the image, as `prt.kind`.
    ///
    /// # Errors
    /// If the file cannot be written, or the arrays have different lengths.
    pub fn write_exr(&self, path: &Path) -> Result<u64, Error> {
        self.check_lengths()?;
        exr::write(self, path)
    }

    fn check_lengths(&self) -> Result<(), Error> {
        let texels = self.width * self.height;
        let counts = [("heights", self.heights.len()), ("normals", self.normals.len())];
        if let Some((what, count)) = counts.into_iter().find(|&(_, count)| count != texels) {
            return Err(Error::InconsistentMesh(format!("{count} {what} for {texels} texels")));
        }
        self.transfer.check_shape(texels)
    }
}
