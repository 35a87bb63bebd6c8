//! The nearest hit of each ray of a packet.

use glam::Vec3;
use multiversion::multiversion;

use super::bounds::Bounds;
use super::lanes::{WIDTH, take_bit, wide_bits};
use super::packet::Packet;
use super::stack::{Child, ROOT, Stack};
use super::tree::Tree;
use super::walk::Walk;
use super::wedge::Wedges;

/// The nearest hit of each ray of a packet.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Hits {
    nearest: [RayHit; Packet::SIZE],
}

impl Default for Hits {
    fn default() -> Self {
        Self { nearest: [RayHit::NONE; Packet::SIZE] }
    }
}

/// The nearest hit of a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RayHit {
    pub(super) slot: u32,
    /// Infinite where nothing is met.
    pub(super) distance: f32,
    /// Barycentric weights of the corners times a common factor.
    weights: [f32; 3],
    pub(super) is_front: bool,
}

impl RayHit {
    pub(super) const NONE: Self = Self { slot: u32::MAX, distance: f32::INFINITY, weights: [0.0; 3], is_front: false };

    pub(super) fn found(self) -> Option<Self> {
        self.distance.is_finite().then_some(self)
    }

    /// Weights of the second and the third corner.
    pub(super) fn barycentric(&self) -> [f32; 2] {
        // Where the triangle is seen edge on the weights may be small and negative.
        let [a, b, c] = self.weights.map(|weight| weight.max(0.0));
        let sum = (a + b + c).max(f32::MIN_POSITIVE);
        [b / sum, c / sum]
    }

    /// Of two hits at the same distance that in the lower slot counts, so that the order of traversal does not matter.
    fn is_nearer_than(&self, other: &Self) -> bool {
        self.distance < other.distance || self.distance == other.distance && self.slot < other.slot
    }

    /// Replaces the hit by one on a triangle of a leaf, if that is nearer.
    ///
    /// - `near`, `far`: where the ray passes the box of the leaf
    #[inline(always)]
    pub(super) fn meet_leaf(
        &mut self,
        wedges: &Wedges,
        tree: &Tree,
        child: Child<'_>,
        direction: Vec3,
        [near, far]: [f32; 2],
    ) {
        let (weights, inside) = wedges.meets_ray(direction);
        let mut inside = u64::from(wide_bits(&inside));
        while inside != 0 {
            let lane = take_bit(&mut inside) % WIDTH;
            let weights = [weights[0][lane], weights[1][lane], weights[2][lane]];
            let slot = child.triangle(lane);
            let distance = wedges.distance(lane, direction, near, far);
            let hit = Self { slot, distance, weights, is_front: wedges.is_front(lane) };
            if hit.is_nearer_than(self) && tree.masks.is_opaque(slot as usize, weights) {
                *self = hit;
            }
        }
    }
}

impl Hits {
    /// Asks for each of the `rays`; the other entries say that nothing was met.
    pub(super) fn find_each(&mut self, mut rays: u64, mut find: impl FnMut(usize) -> Option<RayHit>) {
        *self = Self::default();
        while rays != 0 {
            let ray = take_bit(&mut rays);
            self.nearest[ray] = find(ray).unwrap_or(RayHit::NONE);
        }
    }

    pub(super) fn get(&self, ray: usize) -> Option<RayHit> {
        self.nearest[ray].found()
    }
}

/// The nearest hit of each of the `rays`; the other entries of `hits` say that nothing was met.
#[multiversion(targets("x86_64+avx+avx2"))]
pub(super) fn closest(tree: &Tree, origin: Vec3, packet: &Packet, rays: u64, hits: &mut Hits, stack: &mut Stack) {
    closest_portable(tree, origin, packet, rays, hits, stack);
}

#[inline(always)]
pub(super) fn closest_portable(
    tree: &Tree,
    origin: Vec3,
    packet: &Packet,
    rays: u64,
    hits: &mut Hits,
    stack: &mut Stack,
) {
    *hits = Hits::default();
    let mut walk = Walk::new(tree, origin, Vec3::ZERO, packet);
    stack.entries.clear();
    stack.entries.push(ROOT);
    walk.start(0, stack);
    while let Some(item) = stack.pop() {
        let child = item.child(tree);
        let bounds = Bounds::new(child, origin);
        let met = walk.met(item, &bounds, rays);
        if met == 0 {
            continue;
        }
        if !child.is_leaf {
            walk.push_children(child.number, met, stack);
            continue;
        }
        let leaf = &tree.leaves[child.number as usize];
        let mut met = bounds.slab_rays(&leaf.outline.slab.from(origin), packet, met);
        if met == 0 {
            continue;
        }
        let wedges = Wedges::new(leaf, origin);
        while met != 0 {
            let ray = take_bit(&mut met) % Packet::SIZE;
            let passage = bounds.passage(packet.reciprocal(ray));
            let nearest = &mut hits.nearest[ray];
            // It may have been found since the box was put on the stack.
            if passage[0] <= nearest.distance {
                nearest.meet_leaf(&wedges, tree, child, packet.direction(ray), passage);
                walk.set_limit(ray, nearest.distance);
            }
        }
    }
}
