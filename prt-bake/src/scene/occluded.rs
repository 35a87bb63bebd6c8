//! Whether the rays of a packet meet anything.
//!
//! The triangles of a leaf are tested against the few rays that meet its box, or against the beam, all together: most are missed, and one
//! may cover it.
//!
//! A ray meets a triangle if it passes the box of its leaf and lies inside its wedge. All else leaves out only what no ray meets, so that
//! answers depend neither on the order of nodes nor on the other rays of a packet nor on where traversal starts; but for the widened tips of
//! needles (1:10,000), which one way may cut off sooner than another, by less than a ray in 100,000.

#![expect(clippy::needless_range_loop, reason = "plain loops over lanes are vectorised; see `lanes`")]

use glam::Vec3;
use multiversion::multiversion;

use super::bounds::{Bounds, FEW_RAYS};
use super::lanes::{BLOCKS, LANES, WIDTH, any, block_bits, ray_bits, take_bit, wide_bits};
use super::packet::Packet;
use super::stack::{Child, Stack};
use super::tree::Tree;
use super::walk::Walk;
use super::wedge::Wedges;

/// How all rays of a packet were answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum How {
    /// No triangle is in the beam.
    Free,
    /// One triangle covers the beam.
    Blocked,
    /// Rays were tested one by one.
    Traced,
}

/// Of the `rays`, those that meet any triangle, and how that was found.
///
/// - `horizon`: no ray has a negative product with it; zero if there is no such vector
/// - `first`: traversal starts at the stack's entries from this one on
#[multiversion(targets("x86_64+avx+avx2"))]
pub(super) fn occluded(
    tree: &Tree,
    origin: Vec3,
    horizon: Vec3,
    packet: &Packet,
    rays: u64,
    stack: &mut Stack,
    first: usize,
) -> (u64, How) {
    occluded_portable(tree, origin, horizon, packet, rays, stack, first)
}

#[inline(always)]
pub(super) fn occluded_portable(
    tree: &Tree,
    origin: Vec3,
    horizon: Vec3,
    packet: &Packet,
    rays: u64,
    stack: &mut Stack,
    first: usize,
) -> (u64, How) {
    let walk = Walk::new(tree, origin, horizon, packet);
    walk.start(first, stack);
    let mut how = How::Free;
    let mut left = rays;
    while let Some(item) = stack.pop() {
        let child = item.child(tree);
        let bounds = Bounds::new(child, origin);
        let met = walk.met(item, &bounds, left);
        if met == 0 {
            continue;
        }
        if !child.is_leaf {
            walk.push_children(child.number, met, stack);
            continue;
        }
        let slab = tree.leaves[child.number as usize].outline.slab.from(origin);
        let met = bounds.slab_rays(&slab, packet, met);
        if met == 0 {
            continue;
        }
        let Some(hidden) = hidden_by_leaf(tree, child, origin, packet, met, &mut how) else {
            return (rays, if how == How::Free { How::Blocked } else { how });
        };
        left &= !hidden;
        if left == 0 {
            break;
        }
    }
    (rays & !left, how)
}

/// Of the `rays`, which pass the box of a leaf, those that meet one of its triangles; nothing if one covers the whole beam.
#[inline(always)]
fn hidden_by_leaf(
    tree: &Tree,
    child: Child<'_>,
    origin: Vec3,
    packet: &Packet,
    rays: u64,
    how: &mut How,
) -> Option<u64> {
    let leaf = &tree.leaves[child.number as usize];
    let wedges = Wedges::new(leaf, origin);
    if leaf.outline.holed != 0 || !packet.beam.is_narrow || rays.count_ones() <= FEW_RAYS {
        *how = How::Traced;
        return Some(hidden_ray_by_ray(&wedges, tree, child, packet, rays));
    }
    let (candidates, covering) = wedges.against(&packet.beam);
    if covering != 0 {
        return None;
    }
    if candidates != 0 {
        *how = How::Traced;
    }
    Some(hidden_by_candidates(&wedges, candidates, packet, rays))
}

#[inline(always)]
fn hidden_ray_by_ray(wedges: &Wedges, tree: &Tree, child: Child<'_>, packet: &Packet, mut rays: u64) -> u64 {
    let mut hidden = 0;
    while rays != 0 {
        let ray = take_bit(&mut rays);
        hidden |= u64::from(is_hidden(wedges, tree, child, packet.direction(ray))) << ray;
    }
    hidden
}

/// Whether a ray meets a triangle of a leaf.
#[inline(always)]
pub(super) fn is_hidden(wedges: &Wedges, tree: &Tree, child: Child<'_>, direction: Vec3) -> bool {
    let (weights, inside) = wedges.meets_ray(direction);
    let leaf = &tree.leaves[child.number as usize];
    if leaf.outline.holed == 0 {
        return any(&inside);
    }
    let mut inside = u64::from(wide_bits(&inside));
    while inside != 0 {
        let lane = take_bit(&mut inside) % WIDTH;
        if tree.masks.is_opaque(child.triangle(lane) as usize, [weights[0][lane], weights[1][lane], weights[2][lane]]) {
            return true;
        }
    }
    false
}

/// Rays that meet any of the candidates.
#[inline(always)]
fn hidden_by_candidates(wedges: &Wedges, candidates: u32, packet: &Packet, rays: u64) -> u64 {
    let (mut hidden, mut candidates) = ([[0; LANES]; BLOCKS], u64::from(candidates));
    while candidates != 0 {
        let wedge = wedges.get(take_bit(&mut candidates) % WIDTH);
        for block in 0..BLOCKS {
            if block_bits(rays, block) != 0 {
                wedge.hide(&packet.direction[block], &mut hidden[block]);
            }
        }
    }
    ray_bits(&hidden) & rays
}
