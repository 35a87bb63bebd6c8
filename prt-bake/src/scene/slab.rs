//! The space between two parallel planes that hold the triangles of a leaf.
//!
//! Boxes around a surface that is slanted to the axes are thick; most rays that pass such a box at a low angle to the surface stay on one
//! side of it, and so of its slab. It leaves out only what no ray meets, and the widened tips of
//! needles.

use glam::Vec3;

use super::lanes::{larger, smaller};
use super::tree::BOX_PADDING;

/// The space between two parallel planes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slab {
    normal: [f32; 3],
    lower: f32,
    upper: f32,
}

impl Slab {
    /// Across the mean normal of the triangles, wider than them by the padding of boxes.
    pub(super) fn new(triangles: impl Iterator<Item = [Vec3; 3]> + Clone) -> Self {
        let area = |[a, b, c]: [Vec3; 3]| (b - a).cross(c - a);
        let normal = triangles.clone().map(area).sum::<Vec3>().normalize_or_zero();
        let (mut lower, mut upper) = (f32::INFINITY, f32::NEG_INFINITY);
        for corner in triangles.flatten() {
            let height = normal.dot(corner);
            (lower, upper) = (lower.min(height), upper.max(height));
        }
        Self { normal: normal.to_array(), lower: lower - BOX_PADDING, upper: upper + BOX_PADDING }
    }

    /// As seen from the origin of rays.
    #[inline(always)]
    pub(super) fn from(&self, origin: Vec3) -> Self {
        let [x, y, z] = self.normal;
        let height = x * origin.x + y * origin.y + z * origin.z;
        Self { lower: self.lower - height, upper: self.upper - height, ..*self }
    }

    /// Whether a ray from the origin is in it anywhere from `near` to `far`.
    #[inline(always)]
    pub(super) fn holds_some_of(&self, direction: Vec3, [near, far]: [f32; 2]) -> bool {
        let [x, y, z] = self.normal;
        let slope = x * direction.x + y * direction.y + z * direction.z;
        let (first, last) = (near * slope, far * slope);
        (larger(first, last) >= self.lower) & (smaller(first, last) <= self.upper)
    }
}
