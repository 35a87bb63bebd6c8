//! Edges of the mesh, whatever vertices its faces have there.

use std::collections::BTreeMap;

use glam::Vec3;

use super::layout::Layout;
use super::raster::NO_FACE;
use crate::mesh::weld_positions;

/// Normals whose cosine is above this are those of a smooth surface; transfer on the two sides of a crease differs by right.
const SMOOTH_COSINE: f32 = 0.9998;

/// A face at an edge.
#[derive(Debug, Clone, Copy)]
pub(super) struct Side {
    /// The vertices of the face at the ends of the edge, in the order of the welded numbers.
    pub(super) vertices: [u32; 2],
    face: u32,
    /// The corner of the face that is not on the edge.
    opposite: usize,
}

/// The sides of each edge, by the welded numbers of its ends.
pub(super) fn edges(layout: &Layout) -> BTreeMap<[u32; 2], Vec<Side>> {
    let welded = weld_positions(layout.mesh.positions());
    let mut edges = BTreeMap::<[u32; 2], Vec<Side>>::new();
    for (face, &triangle) in (0..).zip(layout.mesh.original_triangles()) {
        for opposite in 0..3 {
            let mut vertices = [triangle[(opposite + 1) % 3], triangle[(opposite + 2) % 3]];
            vertices.sort_by_key(|&vertex| welded[vertex as usize]);
            let ends = vertices.map(|vertex| welded[vertex as usize]);
            edges.entry(ends).or_default().push(Side { vertices, face, opposite });
        }
    }
    edges
}

/// Whether the surface goes on smoothly from one side of an edge to the other.
pub(super) fn is_smooth(layout: &Layout, first: &Side, second: &Side) -> bool {
    let normal = |vertex: u32| Vec3::from_array(layout.mesh.normals()[vertex as usize]);
    [0, 1].iter().all(|&end| normal(first.vertices[end]).dot(normal(second.vertices[end])) > SMOOTH_COSINE)
}

/// For each face and each of its corners the face across the opposite edge, if the surface goes on smoothly there; else [`NO_FACE`].
pub(super) fn smooth_neighbors(layout: &Layout) -> Vec<[u32; 3]> {
    let mut neighbors = vec![[NO_FACE; 3]; layout.face_count()];
    for sides in edges(layout).values() {
        if let [first, second] = sides.as_slice()
            && is_smooth(layout, first, second)
        {
            neighbors[first.face as usize][first.opposite] = second.face;
            neighbors[second.face as usize][second.opposite] = first.face;
        }
    }
    neighbors
}
