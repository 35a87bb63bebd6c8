//! Reading characters from glTF 2.0.
//!
//! The crate `gltf` supplies the document's structure only. Its iterators index without checks and its validation refuses files in daily
//! use, so every reference is resolved here. The lowest layers (container, document, URIs, accessors) are those of `prt-bake`'s reader of
//! meshes, on which this crate does not depend.

mod accessor;
mod attributes;
mod clips;
mod container;
mod document;
mod fault;
mod nodes;
mod surface;
mod uri;

use std::path::Path;

use document::Document;
use fault::{Fault, read_file};
use surface::Surface;

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
/// - All nodes are joints. The meshes of the default scene (or the first one, or all nodes where there is none) become one
///   [`SkinnedMesh`], vertices in the order of the nodes and primitives; points and lines are left out.
/// - A vertex of a skin follows up to eight joints, the ones with the largest weights; the others hang from their node alone. Weights are made to sum to one.
/// - Morph targets stand still at the file's default weights. Textures are not read: a baked mesh brings its albedo.
/// - Missing normals are the sums of the normals of the faces that share the vertex, weighted by area.
/// - A clip is an animation; channels that move morph targets are left out.
///
/// What was changed or left out is counted in [`Character::report`].
///
/// Memory is at most some hundred times the file's size, whatever its numbers claim.
///
/// # Errors
/// Each names the file and the cause: what the system refuses, data that break the rules of glTF 2.0 (numbers past the end, cycles of
/// nodes, times that decrease, values that are not finite), features that are not handled (required extensions, shear, scenes that repeat
/// their data beyond measure), a file without faces.
pub fn load_character(path: &Path) -> Result<Character, Error> {
    let bytes = read_file(path)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let character = parse(&bytes, folder).map_err(|fault| fault.in_file(path))?;
    if character.mesh.triangles.is_empty() {
        let vertices = character.mesh.positions().len();
        return Err(Error::NoFaces { path: path.to_owned(), vertices });
    }
    Ok(character)
}

fn parse(bytes: &[u8], folder: &Path) -> Result<Character, Fault> {
    let (json, binary) = container::split(bytes)?;
    let document = Document::new(json, binary, folder)?;
    let mut report = LoadReport::default();
    let skeleton = nodes::skeleton(&document)?;
    let clips = clips::clips(&document, &mut report)?;
    let mut surface = Surface::new(&document, &mut report);
    for node in nodes::scene_nodes(&document, &skeleton)? {
        surface.add_node(node)?;
    }
    let mesh = surface.finish(&skeleton)?;
    Ok(Character { skeleton, clips, mesh, report })
}
