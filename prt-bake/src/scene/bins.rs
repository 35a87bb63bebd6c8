//! All directions of a point: bins of directions that meet nothing, or that one triangle covers, are not traced.
//!
//! [SKS02](sh_core#references) section 5 sorts directions into bins of a subdivided icosahedron, and leaves out the bins that are free. Here bins are
//! groups of consecutive packets: directions are ordered by bisection of the sphere, so that four packets are a compact part, four of these
//! again, bins nest, a packet lies in one bin, and all have the same number of directions. A list of nodes that a bin may meet is handed
//! down from a bin to its parts: each part starts from a shorter list, and an empty one proves that all of it is free.

use glam::Vec3;
use multiversion::multiversion;

use super::Answered;
use super::beam::{Beam, Culling, wide_children};
use super::lanes::{WIDTH, take_bit};
use super::occluded::{self, How};
use super::packet::Packet;
use super::ray;
use super::stack::{Entry, ROOT, Stack};
use super::tree::{Leaf, Tree};
use super::wedge::Wedges;
use crate::sampling::DirectionSet;

/// Parts of a bin.
const PARTS: usize = 4;

/// A bin opens the boxes that are wider than this many times their distance; its parts then test what is inside. Opening more proves more
/// directions free, and takes longer than it saves: on `dragon_100k` and `stanford_bunny` 0.5 is 5 to 15 % slower, 2 as fast, 3 slower.
const OPENING_RATIO: f32 = 1.0;

/// Bins over packets.
#[derive(Debug, Clone)]
pub(crate) struct Bins {
    /// Bins of 4 packets, of 16, and so on, up to bins that cover much of the sphere.
    levels: Vec<Vec<Beam>>,
}

impl Bins {
    /// For directions in packets of `packet_size`.
    pub(crate) fn new(directions: &[Vec3], packet_size: usize) -> Self {
        let mut levels = Vec::new();
        let mut size = PARTS * packet_size;
        while size <= directions.len() {
            let level: Vec<Beam> = directions.chunks(size).map(Beam::new).collect();
            if level.iter().all(|beam| !beam.is_narrow) {
                break;
            }
            levels.push(level);
            size *= PARTS;
        }
        Self { levels }
    }
}

/// Answers the directions of one point.
pub(super) struct Descent<'a> {
    pub(super) tree: &'a Tree,
    pub(super) directions: &'a DirectionSet,
    pub(super) origin: Vec3,
    /// No direction has a negative product with it; zero if there is no such vector.
    pub(super) normal: Vec3,
    /// A bit for each direction that is asked for, one word for each packet.
    pub(super) above: &'a [u64],
    pub(super) stack: &'a mut Stack,
    pub(super) occluded: &'a mut [u64],
    pub(super) answered: Answered,
}

impl Descent<'_> {
    pub(super) fn answer(mut self) -> Answered {
        self.stack.entries.clear();
        self.stack.entries.push(ROOT);
        let culling = Culling::new(None, self.normal, self.origin);
        refine(self.tree, self.origin, None, &culling, self.stack, 0);
        let levels = self.directions.bins.levels.len();
        let size = PARTS.pow(levels as u32);
        for number in 0..self.above.len().div_ceil(size) {
            // The first entry is the root, which has been opened.
            self.visit(levels, number, 1);
        }
        self.answered
    }

    /// Answers the directions of a bin. Level 0 is a packet. What it may meet are the stack's entries from `first` on.
    fn visit(&mut self, level: usize, number: usize, first: usize) {
        if level == 0 {
            return self.trace(number, first);
        }
        let size = PARTS.pow(level as u32);
        let packets = number * size..((number + 1) * size).min(self.above.len());
        let count = bits(&self.above[packets.clone()]);
        if count == 0 {
            return;
        }
        let beam = &self.directions.bins.levels[level - 1][number];
        let is_whole = count as usize == packets.len() * crate::sampling::PACKET_SIZE;
        let horizon = if is_whole { Vec3::ZERO } else { self.normal };
        let culling = Culling::new(Some(beam), horizon, self.origin);
        let end = self.stack.entries.len();
        let is_blocked = refine(self.tree, self.origin, Some(beam), &culling, self.stack, first);
        if is_blocked {
            self.occluded[packets.clone()].copy_from_slice(&self.above[packets]);
            self.answered.blocked += count;
        } else if self.stack.entries.len() == end {
            self.answered.free += count;
        } else {
            let parts = PARTS * number..(PARTS * (number + 1)).min(self.above.len().div_ceil(size / PARTS));
            parts.for_each(|part| self.visit(level - 1, part, end));
        }
        self.stack.entries.truncate(end);
    }

    /// Traces the rays of a packet.
    fn trace(&mut self, number: usize, first: usize) {
        let (packet, rays) = (&self.directions.packets[number], self.above[number]);
        if rays == 0 {
            return;
        }
        let horizon = if rays == packet.all() { Vec3::ZERO } else { self.normal };
        let (occluded, how) = occluded(self.tree, self.origin, horizon, packet, rays, self.stack, first);
        self.occluded[number] = occluded;
        self.answered.add(how, rays.count_ones());
    }
}

/// Of the `rays` of a packet, those that meet any triangle.
///
/// - `horizon`: no ray has a negative product with it; zero if there is no such vector
/// - `first`: what the packet may meet are the stack's entries from this one on
pub(super) fn occluded(
    tree: &Tree,
    origin: Vec3,
    horizon: Vec3,
    packet: &Packet,
    rays: u64,
    stack: &mut Stack,
    first: usize,
) -> (u64, How) {
    let end = stack.entries.len();
    let culling = Culling::new(Some(&packet.beam), horizon, origin);
    let answer = if refine(tree, origin, Some(&packet.beam), &culling, stack, first) {
        (rays, How::Blocked)
    } else if stack.entries.len() == end {
        (0, How::Free)
    } else if packet.is_worth_a_packet(rays) {
        occluded::occluded(tree, origin, horizon, packet, rays, stack, end)
    } else {
        let (mut left, mut found) = (rays, 0);
        while left != 0 {
            let ray = take_bit(&mut left);
            found |= u64::from(ray::occluded(tree, origin, packet.direction(ray), stack, end)) << ray;
        }
        (found, How::Traced)
    };
    stack.entries.truncate(end);
    answer
}

/// Appends what a bin may meet of the stack's entries from `first` on, opening large boxes. True if one triangle covers the bin.
#[multiversion(targets("x86_64+avx+avx2"))]
fn refine(tree: &Tree, origin: Vec3, beam: Option<&Beam>, culling: &Culling, stack: &mut Stack, first: usize) -> bool {
    let beam = beam.filter(|beam| beam.is_narrow);
    Refinement { tree, origin, beam, culling }.refine(stack, first)
}

struct Refinement<'a> {
    tree: &'a Tree,
    origin: Vec3,
    beam: Option<&'a Beam>,
    culling: &'a Culling,
}

impl Refinement<'_> {
    #[inline(always)]
    fn refine(&self, stack: &mut Stack, first: usize) -> bool {
        for number in first..stack.entries.len() {
            let entry = stack.entries[number];
            if entry.is_unopened() {
                stack.pending.push(entry.node);
            } else if self.refine_entry(entry, stack) {
                return true;
            }
            while let Some(number) = stack.pending.pop() {
                if self.open(number, stack) {
                    stack.pending.clear();
                    return true;
                }
            }
        }
        false
    }

    /// Appends what is left of an entry. True if a triangle covers the bin.
    #[inline(always)]
    fn refine_entry(&self, entry: Entry, stack: &mut Stack) -> bool {
        let node = &self.tree.nodes[entry.node as usize];
        let children = entry.children & self.culling.children(node);
        self.keep(entry.node, children, entry.near_leaves & children, stack)
    }

    /// Appends what is left of a node; those of its children that are wide and no leaves are still to be opened. True if a triangle
    /// covers the bin.
    #[inline(always)]
    fn open(&self, number: u32, stack: &mut Stack) -> bool {
        let node = &self.tree.nodes[number as usize];
        let children = self.culling.children(node);
        if children == 0 {
            return false;
        }
        let wide = children & wide_children(node, self.origin, OPENING_RATIO);
        let mut inner = wide & !node.leaves;
        let children = children & !inner;
        while inner != 0 {
            let slot = inner.trailing_zeros() as usize % WIDTH;
            inner &= inner - 1;
            stack.pending.push(node.child[slot]);
        }
        self.keep(number, children, wide & node.leaves, stack)
    }

    /// Appends children of a node, `near_leaves` only where the bin may meet their triangles. True if one of these covers the bin.
    #[inline(always)]
    fn keep(&self, number: u32, children: u32, near_leaves: u32, stack: &mut Stack) -> bool {
        let (mut kept, mut left) = (0, near_leaves);
        while left != 0 {
            let slot = left.trailing_zeros();
            left &= left - 1;
            let leaf = self.tree.nodes[number as usize].child[slot as usize % WIDTH];
            let Some(may_be_met) = self.may_meet(&self.tree.leaves[leaf as usize]) else { return true };
            kept |= u32::from(may_be_met) << slot;
        }
        let children = children & !near_leaves | kept;
        if children != 0 {
            stack.entries.push(Entry { node: number, children, near_leaves: kept });
        }
        false
    }

    /// Whether the bin may meet triangles of a leaf; nothing if one covers it.
    #[inline(always)]
    fn may_meet(&self, leaf: &Leaf) -> Option<bool> {
        let mut candidates = self.culling.triangles(leaf);
        if let Some(beam) = self.beam.filter(|_| candidates != 0) {
            let (may_meet, covering) = Wedges::new(leaf, self.origin).against(beam);
            if covering & !leaf.outline.holed != 0 {
                return None;
            }
            candidates &= may_meet;
        }
        Some(candidates != 0)
    }
}

/// How many bits are set.
fn bits(words: &[u64]) -> u32 {
    words.iter().map(|word| word.count_ones()).sum()
}
