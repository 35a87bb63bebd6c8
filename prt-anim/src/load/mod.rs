//! Reading characters.

use std::path::Path;

use crate::{Clip, Error, Skeleton, SkinnedMesh};

/// A model that can be posed.
#[derive(Debug, Clone, PartialEq)]
pub struct Character {
    /// Its joints: all nodes of the file, in the file's order.
    pub skeleton: Skeleton,
    /// Its motions.
    pub clips: Vec<Clip>,
    /// Its surface.
    pub mesh: SkinnedMesh,
    /// What was changed or left out.
    pub report: LoadReport,
}

/// What reading a character changed or left out.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct LoadReport {
    /// Vertices whose weights did not sum to one and were made to.
    pub weights_normalized: usize,
    /// Weights beyond the eighth of a vertex, the smallest ones, which were dropped.
    pub weights_dropped: usize,
    /// Vertices that follow their node because no skin moves them.
    pub rigid_vertices: usize,
    /// Vertices whose normal was computed from their faces.
    pub normals_computed: usize,
    /// Primitives with morph targets: those stand still as the file's default weights leave them.
    pub morphed_primitives: usize,
    /// Channels of clips that were left out because they move morph targets.
    pub morph_channels: usize,
    /// Primitives with a texture or with colours at their vertices, which are left out.
    pub textured_primitives: usize,
    /// Primitives of points or lines, which are left out.
    pub other_primitives: usize,
}

/// Reads a character from a `.glb` or `.gltf` file.
///
/// # Errors
/// Each names the file and the cause.
pub fn load_character(path: &Path) -> Result<Character, Error> {
    let _ = path;
    unimplemented!()
}
