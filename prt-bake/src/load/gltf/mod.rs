//! glTF 2.0, as `.gltf` with its files or as `.glb`.
//!
//! The crate `gltf` supplies the document's structure only. Its iterators index without checks and its validation
//! refuses files in daily use (positions without bounds, unknown attributes), so every reference is resolved here.

mod accessor;
mod attributes;
mod base_color;
mod container;
mod document;
mod hierarchy;
mod primitive;
mod skin;
mod texture;
mod uri;

use std::path::Path;

use document::Document;
use hierarchy::Hierarchy;
use primitive::{Placement, Scene};

use crate::input::Fault;
use crate::mesh::MeshSource;

/// Reads the default scene, or the first one, or all nodes where there is no scene.
///
/// - `folder`: where buffers and images in files of their own are looked for
pub(super) fn parse(bytes: &[u8], folder: &Path) -> Result<MeshSource, Fault> {
    let (json, binary) = container::split(bytes)?;
    let document = Document::new(json, binary, folder)?;
    let hierarchy = Hierarchy::new(&document)?;
    let mut scene = Scene::new(&document);
    for node in hierarchy.scene_nodes(&document)? {
        add_node(&document, &hierarchy, node, &mut scene)?;
    }
    Ok(scene.finish())
}

fn add_node(document: &Document<'_>, hierarchy: &Hierarchy, index: usize, scene: &mut Scene<'_>) -> Result<(), Fault> {
    let node = &document.root.nodes[index];
    let Some(mesh) = node.mesh else { return Ok(()) };
    let mesh = document.get(mesh, "mesh")?;
    let rigid = Placement::Rigid(hierarchy.world(index));
    let skin = node.skin.map(|skin| skin::joint_matrices(document, hierarchy, skin)).transpose()?;
    scene.start_part(node.name.clone().or_else(|| mesh.name.clone()).unwrap_or_else(|| format!("node {index}")));
    let weights = node.weights.as_deref().or(mesh.weights.as_deref()).unwrap_or_default();
    for primitive in &mesh.primitives {
        match &skin {
            Some(joints) if primitive::has_joints(primitive) => {
                scene.add(primitive, weights, &Placement::Skinned(joints))?;
            }
            _ => scene.add(primitive, weights, &rigid)?,
        }
    }
    Ok(())
}
