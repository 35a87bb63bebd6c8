//! The eight boxes of a node against one ray.

#![expect(clippy::needless_range_loop, reason = "plain loops over lanes are vectorised; see `lanes`")]

use glam::Vec3;

use super::lanes::{WIDTH, Wide, larger, mask, smaller};
use super::tree::Node;

/// The lower and the upper corners of the boxes of a node, relative to the origin of rays: `[side][axis]`.
pub(super) struct ChildBounds([[Wide<f32>; 3]; 2]);

impl ChildBounds {
    #[inline(always)]
    pub(super) fn new(node: &Node, origin: Vec3) -> Self {
        let (origin, mut bounds) = (origin.to_array(), node.bounds);
        for side in 0..2 {
            for axis in 0..3 {
                for lane in 0..WIDTH {
                    bounds[side][axis][lane] -= origin[axis];
                }
            }
        }
        Self(bounds)
    }

    /// Where a ray enters each box, and a mask of those that it meets nearer than `limit`.
    #[inline(always)]
    pub(super) fn meets(&self, reciprocal: [f32; 3], limit: f32) -> (Wide<f32>, Wide<u32>) {
        let Self([lower, upper]) = self;
        let (mut near, mut far) = ([0.0; WIDTH], [limit; WIDTH]);
        for axis in 0..3 {
            for lane in 0..WIDTH {
                let (a, b) = (lower[axis][lane] * reciprocal[axis], upper[axis][lane] * reciprocal[axis]);
                near[lane] = larger(near[lane], smaller(a, b));
                far[lane] = smaller(far[lane], larger(a, b));
            }
        }
        let mut meets = [0; WIDTH];
        for lane in 0..WIDTH {
            meets[lane] = mask(near[lane] <= far[lane]);
        }
        (near, meets)
    }
}
