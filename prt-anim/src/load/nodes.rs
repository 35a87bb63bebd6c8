//! Nodes as joints.

use glam::{DMat3, DMat4, DQuat, DVec3};
use gltf::json::Node;

use super::document::Document;
use super::fault::Fault;
use crate::{Joint, Skeleton, Transform};

/// Largest cosine between two axes of a matrix that still counts as free of shear: rounding to `f32` and exporters' own errors.
const SHEAR: f64 = 1e-4;

/// All nodes as the joints of a skeleton.
pub(super) fn skeleton(document: &Document<'_>) -> Result<Skeleton, Fault> {
    let nodes = &document.root.nodes;
    let parents = parents(nodes)?;
    let joints = nodes
        .iter()
        .zip(parents)
        .enumerate()
        .map(|(index, (node, parent))| Ok(Joint { name: node.name.clone(), parent, rest: rest(index, node)? }))
        .collect::<Result<_, Fault>>()?;
    Skeleton::new(joints).map_err(|error| Fault::inconsistent(&error))
}

fn parents(nodes: &[Node]) -> Result<Vec<Option<usize>>, Fault> {
    let mut parents = vec![None; nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        for child in node.children.iter().flatten().map(|child| child.value()) {
            let parent = parents
                .get_mut(child)
                .ok_or_else(|| Fault::malformed(format!("node {index} has a child {child}, which is not there")))?;
            if parent.replace(index).is_some() {
                return Err(Fault::malformed(format!("node {child} has two parents")));
            }
        }
    }
    Ok(parents)
}

/// The nodes of the default scene, or the first one, or all where there is no scene; each once, parents first.
pub(super) fn scene_nodes(document: &Document<'_>, skeleton: &Skeleton) -> Result<Vec<usize>, Fault> {
    let scene = match document.root.scene {
        Some(index) => Some(document.get(index, "scene")?),
        None => document.root.scenes.first(),
    };
    let mut open: Vec<usize> = match scene {
        Some(scene) => scene
            .nodes
            .iter()
            .map(|&index| document.get(index, "node").map(|_| index.value()))
            .collect::<Result<_, _>>()?,
        None => (0..skeleton.joints().len()).filter(|&node| skeleton.joints()[node].parent.is_none()).collect(),
    };
    open.reverse();
    let mut seen = vec![false; skeleton.joints().len()];
    let mut nodes = Vec::new();
    while let Some(node) = open.pop() {
        if !std::mem::replace(&mut seen[node], true) {
            nodes.push(node);
            open.extend(document.root.nodes[node].children.iter().flatten().rev().map(|child| child.value()));
        }
    }
    Ok(nodes)
}

fn rest(index: usize, node: &Node) -> Result<Transform, Fault> {
    if let Some(matrix) = node.matrix {
        let matrix = DMat4::from_cols_array(&matrix.map(f64::from));
        return decompose(matrix)
            .ok_or_else(|| Fault::unsupported(format!("the shear in the matrix of node {index} is")));
    }
    let rotation = node.rotation.map_or([0.0, 0.0, 0.0, 1.0], |rotation| rotation.0.map(f64::from));
    if rotation == [0.0; 4] {
        return Err(Fault::malformed(format!("node {index} has a rotation of length zero")));
    }
    Ok(Transform {
        translation: node.translation.map_or([0.0; 3], |translation| translation.map(f64::from)),
        rotation,
        scale: node.scale.map_or([1.0; 3], |scale| scale.map(f64::from)),
    })
}

/// Translation, rotation and scale of a matrix; `None` if its axes are not orthogonal. A mirror is a negative scale along x.
fn decompose(matrix: DMat4) -> Option<Transform> {
    let linear = DMat3::from_mat4(matrix);
    let columns = [linear.x_axis, linear.y_axis, linear.z_axis];
    let mut scale = columns.map(DVec3::length);
    let [x, y, z] = complete(columns)?;
    let is_orthogonal = [x.dot(y), y.dot(z), z.dot(x)].iter().all(|cosine| cosine.abs() <= SHEAR);
    let mirror = if x.cross(y).dot(z) < 0.0 { -1.0 } else { 1.0 };
    scale[0] *= mirror;
    let rotation = DQuat::from_mat3(&DMat3::from_cols(x * mirror, y, z)).normalize();
    (is_orthogonal && rotation.is_finite()).then(|| Transform {
        translation: matrix.w_axis.truncate().to_array(),
        rotation: rotation.to_array(),
        scale,
    })
}

/// The axes made unit, with those of length zero chosen to be orthogonal to the others.
fn complete(axes: [DVec3; 3]) -> Option<[DVec3; 3]> {
    if axes.iter().any(|axis| !axis.is_finite()) {
        return None;
    }
    let mut units = axes.map(DVec3::try_normalize);
    for i in 0..3 {
        if units[i].is_none() {
            units[i] = Some(match (units[(i + 1) % 3], units[(i + 2) % 3]) {
                (Some(a), Some(b)) => a.cross(b).try_normalize()?,
                (Some(only), None) | (None, Some(only)) => only.any_orthonormal_vector(),
                (None, None) => DVec3::AXES[i],
            });
        }
    }
    let [x, y, z] = units;
    Some([x?, y?, z?])
}
