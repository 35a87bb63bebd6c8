//! A packet on its way through the tree.
//!
//! A node is first met by most rays of a packet, and farther down by two or three. While the rays are many its boxes are tested against the
//! beam that encloses them all, and one box after another against all rays. Where they are few, all eight boxes are tested against one ray
//! after another: then it is known which rays meet a child, and none is visited in vain.

use glam::Vec3;

use super::beam::{Culling, distances_along};
use super::bounds::Bounds;
use super::children::ChildBounds;
use super::lanes::{BLOCKS, LANES, Lanes, WIDTH, mask, take_bit, wide_bits};
use super::packet::Packet;
use super::stack::{Entry, Item, Stack};
use super::tree::Tree;

/// If no more rays than this meet a node, each is tested against all of its boxes. On `dragon_100k` and `stanford_bunny` 8 is 5 to 10 %
/// slower, 12 to 64 are the same.
const SOME_RAYS: u32 = 20;

/// A packet from an origin.
pub(super) struct Walk<'a> {
    tree: &'a Tree,
    origin: Vec3,
    packet: &'a Packet,
    culling: Culling,
    /// How far each ray counts.
    limit: [Lanes<f32>; BLOCKS],
}

impl<'a> Walk<'a> {
    /// `horizon`: no ray has a negative product with it; zero if there is no such vector
    #[inline(always)]
    pub(super) fn new(tree: &'a Tree, origin: Vec3, horizon: Vec3, packet: &'a Packet) -> Self {
        let culling = Culling::new(Some(&packet.beam), horizon, origin);
        Self { tree, origin, packet, culling, limit: [[f32::INFINITY; LANES]; BLOCKS] }
    }

    /// Forgets what is on the stack, and pushes its entries from `first` on, the nearest child of all last.
    #[inline(always)]
    pub(super) fn start(&self, first: usize, stack: &mut Stack) {
        stack.clear();
        for number in first..stack.entries.len() {
            let Entry { node, children, .. } = stack.entries[number];
            let used = self.tree.nodes[node as usize].used;
            self.push(node, children & used, &[Item::ANY_RAY; WIDTH], stack);
        }
        stack.sort();
    }

    /// Of the `rays`, those that meet a child before their limit.
    #[inline(always)]
    pub(super) fn met(&self, item: Item, bounds: &Bounds, rays: u64) -> u64 {
        if item.rays == Item::ANY_RAY { bounds.meets(self.packet, rays, &self.limit) } else { item.rays & rays }
    }

    #[inline(always)]
    pub(super) fn set_limit(&mut self, ray: usize, distance: f32) {
        self.limit[ray / LANES % BLOCKS][ray % LANES] = distance;
    }

    /// Pushes the children of a node that the `rays` may meet, the nearest last.
    #[inline(always)]
    pub(super) fn push_children(&self, number: u32, rays: u64, stack: &mut Stack) {
        if rays.count_ones() > SOME_RAYS {
            let children = self.culling.children(&self.tree.nodes[number as usize]);
            self.push(number, children, &[Item::ANY_RAY; WIDTH], stack);
        } else {
            let (children, rays) = self.met_children(number, rays);
            self.push(number, children, &rays, stack);
        }
    }

    /// A bit for each child of a node that any of the `rays` meets before its limit, and for each child those that do.
    #[inline(always)]
    fn met_children(&self, number: u32, mut rays: u64) -> (u32, [u64; WIDTH]) {
        let node = &self.tree.nodes[number as usize];
        let bounds = ChildBounds::new(node, self.origin);
        let mut met = [0; WIDTH];
        while rays != 0 {
            let ray = take_bit(&mut rays) % Packet::SIZE;
            let limit = self.limit[ray / LANES][ray % LANES];
            let (_, meets) = bounds.meets(self.packet.reciprocal(ray), limit);
            for lane in 0..WIDTH {
                met[lane] |= if meets[lane] != 0 { 1 << ray } else { 0 };
            }
        }
        let mut children = [0; WIDTH];
        for lane in 0..WIDTH {
            children[lane] = mask(met[lane] != 0);
        }
        (wide_bits(&children) & node.used, met)
    }

    #[inline(always)]
    fn push(&self, number: u32, children: u32, rays: &[u64; WIDTH], stack: &mut Stack) {
        if children != 0 {
            let node = &self.tree.nodes[number as usize];
            self.tree.prefetch(node, children);
            stack.push(number, children, &distances_along(node, self.packet.beam.mean), rays);
        }
    }
}
