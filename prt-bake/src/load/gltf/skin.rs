//! Skins in their rest pose.

use glam::DMat4;
use gltf::json::{Index, Skin};

use super::accessor::Accessor;
use super::document::Document;
use super::hierarchy::Hierarchy;
use crate::input::Fault;

/// What takes a vertex from the mesh's space to the world's if it follows one joint alone: `G_j · IBM_j`, for each joint.
///
/// The joints stand where their nodes' own transforms put them. The node that carries the mesh has no influence
/// (glTF 2.0, section 3.7.3.3).
pub(super) fn joint_matrices(
    document: &Document<'_>,
    hierarchy: &Hierarchy,
    index: Index<Skin>,
) -> Result<Vec<DMat4>, Fault> {
    let skin = document.get(index, "skin")?;
    let inverse_bind =
        skin.inverse_bind_matrices.map(|accessor| Accessor::new(document, accessor, &[16])).transpose()?;
    if let Some(matrices) = &inverse_bind
        && matrices.count() < skin.joints.len()
    {
        let (count, joints) = (matrices.count(), skin.joints.len());
        return Err(Fault::malformed(format!("skin {index} has {joints} joints and {count} inverse bind matrices")));
    }
    skin.joints
        .iter()
        .enumerate()
        .map(|(joint, &node)| {
            document.get(node, "node")?;
            let inverse_bind =
                inverse_bind.as_ref().map_or(DMat4::IDENTITY, |all| DMat4::from_cols_array(&all.get(joint)));
            Ok(hierarchy.world(node.value()) * inverse_bind)
        })
        .collect()
}
