//! Hits on the back of two-sided faces.

use super::Hit;
use crate::Mesh;

/// The faces that have a twin: of both only the original is in the tree, so that they never compete for a ray.
#[derive(Debug, Clone, Copy)]
pub(super) struct Twins {
    /// Number of the first face with a twin.
    first: u32,
    /// How many there are; the twin of a face is as many further on.
    count: u32,
}

impl Twins {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let count = mesh.twin_count();
        Self { first: (mesh.triangles().len() - 2 * count) as u32, count: count as u32 }
    }

    /// The hit, if it is on the back of a face with a twin, as one on the front of the twin, whose corners are `a, c, b`.
    pub(super) fn on_the_side_that_is_hit(self, hit: Hit) -> Hit {
        if hit.is_front || self.count == 0 || hit.triangle < self.first {
            return hit;
        }
        let [b, c] = hit.barycentric;
        Hit { triangle: hit.triangle + self.count, barycentric: [c, b], is_front: true, ..hit }
    }
}
