//! Nodes and their transforms.

use glam::{DMat4, DQuat, DVec3, DVec4};
use gltf::json::Node;

use super::document::Document;
use crate::input::Fault;

/// Deepest chain of nodes; beyond any skeleton, and short enough that a product of transforms still means something.
const MAX_DEPTH: usize = 4096;

/// The world transform of every node.
pub(super) struct Hierarchy {
    world_from_local: Vec<DMat4>,
    children: Vec<Vec<usize>>,
    roots: Vec<usize>,
}

impl Hierarchy {
    /// Checks that the nodes form trees, and multiplies their transforms.
    pub(super) fn new(document: &Document<'_>) -> Result<Self, Fault> {
        let nodes = &document.root.nodes;
        let children = children(nodes)?;
        let roots = roots(&children)?;
        let mut hierarchy = Self { world_from_local: vec![DMat4::IDENTITY; nodes.len()], children, roots };
        hierarchy.multiply(nodes)?;
        Ok(hierarchy)
    }

    /// Walks down from the roots; a node that is not reached lies on a cycle, for every node has one parent at most.
    fn multiply(&mut self, nodes: &[Node]) -> Result<(), Fault> {
        let mut reached = vec![false; nodes.len()];
        let mut open: Vec<_> = self.roots.iter().map(|&root| (root, DMat4::IDENTITY, 1)).collect();
        while let Some((node, world_from_parent, depth)) = open.pop() {
            if depth > MAX_DEPTH {
                return Err(Fault::unsupported(format!(
                    "a hierarchy of more than {MAX_DEPTH} nodes one below the other is"
                )));
            }
            reached[node] = true;
            let world_from_local = world_from_parent * parent_from_local(node, &nodes[node])?;
            self.world_from_local[node] = world_from_local;
            open.extend(self.children[node].iter().map(|&child| (child, world_from_local, depth + 1)));
        }
        match reached.iter().position(|reached| !reached) {
            Some(node) => Err(Fault::malformed(format!("node {node} is its own ancestor"))),
            None => Ok(()),
        }
    }

    /// World transform of a node.
    pub(super) fn world(&self, node: usize) -> DMat4 {
        self.world_from_local[node]
    }

    /// The nodes of the scene to be read, each once, parents first.
    pub(super) fn scene_nodes(&self, document: &Document<'_>) -> Result<Vec<usize>, Fault> {
        let scene = match document.root.scene {
            Some(index) => Some(document.get(index, "scene")?),
            None => document.root.scenes.first(),
        };
        let mut open = match scene {
            Some(scene) => scene
                .nodes
                .iter()
                .map(|&index| document.get(index, "node").map(|_| index.value()))
                .collect::<Result<_, _>>()?,
            None => self.roots.clone(),
        };
        open.reverse();
        let mut seen = vec![false; self.children.len()];
        let mut nodes = Vec::new();
        while let Some(node) = open.pop() {
            if !std::mem::replace(&mut seen[node], true) {
                nodes.push(node);
                open.extend(self.children[node].iter().rev());
            }
        }
        Ok(nodes)
    }
}

fn children(nodes: &[Node]) -> Result<Vec<Vec<usize>>, Fault> {
    nodes
        .iter()
        .enumerate()
        .map(|(index, node)| {
            let children = node.children.iter().flatten().map(|child| child.value());
            children
                .map(|child| {
                    let missing = || Fault::malformed(format!("node {index} has a child {child}, which is not there"));
                    nodes.get(child).map(|_| child).ok_or_else(missing)
                })
                .collect()
        })
        .collect()
}

/// Nodes without a parent.
fn roots(children: &[Vec<usize>]) -> Result<Vec<usize>, Fault> {
    let mut has_parent = vec![false; children.len()];
    for &child in children.iter().flatten() {
        if std::mem::replace(&mut has_parent[child], true) {
            return Err(Fault::malformed(format!("node {child} has two parents")));
        }
    }
    Ok((0..children.len()).filter(|&node| !has_parent[node]).collect())
}

/// A node's own transform: its matrix, or translation × rotation × scale.
fn parent_from_local(index: usize, node: &Node) -> Result<DMat4, Fault> {
    if let Some(matrix) = node.matrix {
        return Ok(DMat4::from_cols_array(&matrix.map(f64::from)));
    }
    let rotation = node.rotation.map_or(DVec4::W, |rotation| DVec4::from(rotation.0.map(f64::from)));
    if rotation == DVec4::ZERO {
        return Err(Fault::malformed(format!("node {index} has a rotation of length zero")));
    }
    Ok(DMat4::from_scale_rotation_translation(
        node.scale.map_or(DVec3::ONE, |scale| DVec3::from(scale.map(f64::from))),
        DQuat::from_vec4(rotation.normalize()),
        node.translation.map_or(DVec3::ZERO, |translation| DVec3::from(translation.map(f64::from))),
    ))
}
