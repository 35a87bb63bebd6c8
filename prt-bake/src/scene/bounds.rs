//! Boxes as seen from the origin of rays.

use glam::Vec3;

use super::lanes::{BLOCKS, LANES, Lanes, any_ray, block_bits, larger, mask, ray_bits, smaller, take_bit};
use super::packet::Packet;
use super::slab::Slab;
use super::stack::Child;

/// If no more rays than this meet the box of a leaf, each is tested against all of its triangles, otherwise each triangle against all rays.
pub(super) const FEW_RAYS: u32 = 12;

/// The lower and the upper corner of a box, relative to the origin.
#[derive(Clone, Copy)]
pub(super) struct Bounds([[f32; 3]; 2]);

impl Bounds {
    #[inline(always)]
    pub(super) fn new(child: Child<'_>, origin: Vec3) -> Self {
        let origin = origin.to_array();
        let mut bounds = child.bounds();
        for side in &mut bounds {
            for axis in 0..3 {
                side[axis] -= origin[axis];
            }
        }
        Self(bounds)
    }

    /// Where a ray enters and leaves; it misses the box if it leaves before it enters.
    #[inline(always)]
    pub(super) fn passage(&self, reciprocal: [f32; 3]) -> [f32; 2] {
        let [lower, upper] = self.0;
        let (mut near, mut far) = (0.0, f32::INFINITY);
        for axis in 0..3 {
            let (a, b) = (lower[axis] * reciprocal[axis], upper[axis] * reciprocal[axis]);
            near = larger(near, smaller(a, b));
            far = smaller(far, larger(a, b));
        }
        [near, far]
    }

    /// Of the `rays`, those that meet the box nearer than their limit. Blocks without a ray of `rays` are left out.
    #[inline(always)]
    pub(super) fn meets(&self, packet: &Packet, rays: u64, limit: &[Lanes<f32>; BLOCKS]) -> u64 {
        let mut meets = [[0; LANES]; BLOCKS];
        match packet.entrance {
            Some(entrance) => {
                let Self(bounds) = self;
                let (mut first, mut last) = ([0.0; 3], [0.0; 3]);
                for axis in 0..3 {
                    first[axis] = bounds[entrance[axis] & 1][axis];
                    last[axis] = bounds[1 - (entrance[axis] & 1)][axis];
                }
                for block in 0..BLOCKS {
                    if block_bits(rays, block) != 0 {
                        meets[block] = meets_in_octant(first, last, &packet.reciprocal[block], &limit[block]);
                    }
                }
            }
            None => {
                for block in 0..BLOCKS {
                    if block_bits(rays, block) != 0 {
                        meets[block] = self.meets_anyhow(&packet.reciprocal[block], &limit[block]);
                    }
                }
            }
        }
        if any_ray(&meets) { ray_bits(&meets) & rays } else { 0 }
    }

    /// Of the `rays`, which all meet the box, those that pass the slab of its leaf in it. That is asked only where they are few: it costs more
    /// than it saves for many.
    #[inline(always)]
    pub(super) fn slab_rays(&self, slab: &Slab, packet: &Packet, rays: u64) -> u64 {
        if rays.count_ones() > FEW_RAYS {
            return rays;
        }
        let (mut left, mut passing) = (rays, 0);
        while left != 0 {
            let ray = take_bit(&mut left) % Packet::SIZE;
            let passage = self.passage(packet.reciprocal(ray));
            passing |= u64::from(slab.holds_some_of(packet.direction(ray), passage)) << ray;
        }
        passing
    }

    #[inline(always)]
    fn meets_anyhow(&self, reciprocal: &[Lanes<f32>; 3], limit: &Lanes<f32>) -> Lanes<u32> {
        let ([x, y, z], mut meets) = (reciprocal, [0; LANES]);
        for lane in 0..LANES {
            let [near, far] = self.passage([x[lane], y[lane], z[lane]]);
            meets[lane] = mask(near <= smaller(far, limit[lane]));
        }
        meets
    }
}

/// The same for rays that all enter at `first` and leave at `last`.
#[inline(always)]
fn meets_in_octant(first: [f32; 3], last: [f32; 3], reciprocal: &[Lanes<f32>; 3], limit: &Lanes<f32>) -> Lanes<u32> {
    let ([x, y, z], mut meets) = (reciprocal, [0; LANES]);
    for lane in 0..LANES {
        let near = larger(larger(larger(0.0, first[0] * x[lane]), first[1] * y[lane]), first[2] * z[lane]);
        let far = smaller(smaller(smaller(limit[lane], last[0] * x[lane]), last[1] * y[lane]), last[2] * z[lane]);
        meets[lane] = mask(near <= far);
    }
    meets
}
