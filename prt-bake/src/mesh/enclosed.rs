//! Faces whose back no light can reach.

use std::collections::HashMap;

use glam::DVec3;

use super::links::DisjointSets;
use super::{MeshSource, corners, weld_positions};

/// Marks the faces of every connected part that is closed, has no holes, and is turned outwards.
///
/// Closed: each edge, between positions, belongs to two faces that run along it in opposite senses. Turned outwards: its signed volume
/// `1/6 Σ a · (b × c)` is positive. A part that crosses itself may be turned outwards as a whole and inwards in places, which this does
/// not see.
pub(super) fn enclosed_faces(source: &MeshSource) -> Vec<bool> {
    let mut parts = Parts::new(source);
    (0..source.triangles.len()).map(|face| parts.encloses(face)).collect()
}

struct Parts {
    links: DisjointSets,
    /// By the root of a part: six times its volume; NaN if it is open.
    volume: Vec<f64>,
}

impl Parts {
    fn new(source: &MeshSource) -> Self {
        let mut parts =
            Self { links: DisjointSets::new(source.triangles.len()), volume: vec![0.0; source.triangles.len()] };
        let open = parts.link(source);
        for face in 0..source.triangles.len() {
            let root = parts.links.root(face);
            // About a corner of the part, so that little is lost far from the origin.
            let [origin, ..] = corners(&source.positions, source.triangles[root]);
            parts.volume[root] += volume(source, face, origin);
        }
        for face in (0..open.len()).filter(|&face| open[face] || may_have_holes(source, face)) {
            let root = parts.links.root(face);
            parts.volume[root] = f64::NAN;
        }
        parts
    }

    /// Joins faces at common edges; marks those with an edge that is not shared by exactly two in opposite senses.
    fn link(&mut self, source: &MeshSource) -> Vec<bool> {
        let welded = weld_positions(&source.positions);
        let mut edges: HashMap<(u32, u32), Vec<usize>> = HashMap::with_capacity(3 * source.triangles.len());
        for (face, triangle) in source.triangles.iter().enumerate() {
            let [a, b, c] = triangle.map(|vertex| welded[vertex as usize]);
            for edge in [(a, b), (b, c), (c, a)] {
                edges.entry(edge).or_default().push(face);
            }
        }
        let mut open = vec![false; source.triangles.len()];
        for (&(a, b), faces) in &edges {
            let others = edges.get(&(b, a)).map_or(&[][..], Vec::as_slice);
            faces.iter().chain(others).for_each(|&face| self.links.join(faces[0], face));
            if (faces.len(), others.len()) != (1, 1) {
                faces.iter().for_each(|&face| open[face] = true);
            }
        }
        open
    }

    fn encloses(&mut self, face: usize) -> bool {
        self.volume[self.links.root(face)] > 0.0
    }
}

fn volume(source: &MeshSource, face: usize, origin: DVec3) -> f64 {
    let [a, b, c] = corners(&source.positions, source.triangles[face]).map(|corner| corner - origin);
    a.dot(b.cross(c))
}

fn may_have_holes(source: &MeshSource, face: usize) -> bool {
    let material = source.face_material.get(face).and_then(|&material| source.materials.get(material as usize));
    material.is_some_and(|material| material.may_have_holes())
}
