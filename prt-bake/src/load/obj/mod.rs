//! Wavefront OBJ.

mod assemble;
mod material;
mod statements;
mod texture;

use std::path::Path;

use crate::input::Fault;
use crate::mesh::MeshSource;

/// Reads the polygons of an OBJ file.
///
/// A vertex of the result is a distinct combination of `v`, `vt`, `vn` and material, in the order of first use.
/// If no face names a `vt` or `vn`, the vertices are those of the file, all of them and in its order (and, behind them,
/// copies of those that materials of different colour share).
///
/// Albedo is the material's `Kd` (linear) times its `map_Kd` at the vertex where a material library gives one, else the colour written
/// behind the position (sRGB, 0..1, or 0..255 where a value is above 1). Where `map_d` is below one half there are holes; `d` is
/// ignored. Objects and groups are parts. Libraries that are not there, points, lines and free-form surfaces are ignored;
/// textures that cannot be read too, with a warning.
///
/// - `folder`: where material libraries are looked for
pub(super) fn parse(bytes: &[u8], folder: &Path) -> Result<MeshSource, Fault> {
    let statements = statements::read(super::text::decode(bytes, 0)?, folder)?;
    assemble::mesh(&statements)
}
