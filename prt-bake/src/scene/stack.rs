//! What is still to visit.

#![expect(clippy::needless_range_loop, reason = "closures may be left out of line; see `lanes`")]

use std::cmp::Reverse;

use super::lanes::WIDTH;
use super::tree::{Node, Tree};

/// Memory that is used again: what is still to visit.
#[derive(Debug, Clone, Default)]
pub(crate) struct Stack {
    /// The first `len` count.
    items: Vec<Item>,
    len: usize,
    /// Where traversal starts, for each level of bins.
    pub(super) entries: Vec<Entry>,
    /// Nodes that a bin opens.
    pub(super) pending: Vec<u32>,
}

/// A child of a node that rays may meet.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Item {
    /// The high half grows with its distance, the low half is the number of the node and of the child.
    key: u64,
    /// The rays of a packet that meet it, or [`Item::ANY_RAY`] if that is not known.
    pub(super) rays: u64,
}

/// Children of a node, a bit for each.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    pub(super) node: u32,
    pub(super) children: u32,
    /// Those of them that are leaves wider than their distance.
    pub(super) near_leaves: u32,
}

/// Where traversal of the whole tree starts.
pub(super) const ROOT: Entry = Entry::unopened(0);

impl Entry {
    /// All children of a node.
    pub(super) const fn unopened(node: u32) -> Self {
        Self { node, children: u32::MAX, near_leaves: 0 }
    }

    #[inline(always)]
    pub(super) fn is_unopened(self) -> bool {
        self.children == u32::MAX
    }
}

/// A child of a node.
#[derive(Clone, Copy)]
pub(super) struct Child<'a> {
    node: &'a Node,
    slot: usize,
    /// Number of the node or of the leaf.
    pub(super) number: u32,
    pub(super) is_leaf: bool,
}

impl Stack {
    #[inline(always)]
    pub(super) fn clear(&mut self) {
        self.len = 0;
    }

    /// Pushes children of a node, the nearest last.
    ///
    /// - `distances`: numbers that grow with the distance
    /// - `rays`: of a packet, those that meet each child
    #[inline(always)]
    pub(super) fn push(&mut self, node: u32, mut children: u32, distances: &[u32; WIDTH], rays: &[u64; WIDTH]) {
        if self.len + WIDTH > self.items.len() {
            self.items.resize(2 * self.items.len() + WIDTH, Item::default());
        }
        let Some(items) = self.items[self.len..].first_chunk_mut::<WIDTH>() else { return };
        let (mut nearest, mut count) = (Item::default(), 0);
        while children != 0 {
            let slot = children.trailing_zeros() as usize % WIDTH;
            children &= children - 1;
            let item = Item::new(node, slot as u32, distances[slot], rays[slot]);
            if count > 0 {
                items[(count - 1) % WIDTH] = if nearest.key > item.key { nearest } else { item };
            }
            nearest = if count > 0 && nearest.key < item.key { nearest } else { item };
            count += 1;
        }
        if count > 0 {
            items[(count - 1) % WIDTH] = nearest;
        }
        self.len += count;
    }

    /// Puts all in order, the nearest last.
    #[inline(always)]
    pub(super) fn sort(&mut self) {
        self.items[..self.len].sort_unstable_by_key(|item| Reverse(item.key));
    }

    #[inline(always)]
    pub(super) fn pop(&mut self) -> Option<Item> {
        self.len = self.len.checked_sub(1)?;
        Some(self.items[self.len])
    }
}

impl Item {
    /// More rays than are ever listed.
    pub(super) const ANY_RAY: u64 = u64::MAX;

    #[inline(always)]
    fn new(node: u32, slot: u32, distance: u32, rays: u64) -> Self {
        Self { key: u64::from(distance) << 32 | u64::from(node * WIDTH as u32 + slot), rays }
    }

    #[inline(always)]
    pub(super) fn distance(self) -> u32 {
        (self.key >> 32) as u32
    }

    #[inline(always)]
    pub(super) fn child(self, tree: &Tree) -> Child<'_> {
        let (number, slot) = (self.key as u32 as usize / WIDTH, self.key as usize % WIDTH);
        let node = &tree.nodes[number];
        Child { node, slot, number: node.child[slot], is_leaf: node.leaves >> slot & 1 == 1 }
    }
}

impl Child<'_> {
    /// The slot of a triangle of the leaf.
    #[inline(always)]
    pub(super) fn triangle(&self, lane: usize) -> u32 {
        self.number * WIDTH as u32 + lane as u32
    }

    /// The lower and the upper corner of its box.
    #[inline(always)]
    pub(super) fn bounds(&self) -> [[f32; 3]; 2] {
        let mut bounds = [[0.0; 3]; 2];
        for side in 0..2 {
            for axis in 0..3 {
                bounds[side][axis] = self.node.bounds[side][axis][self.slot % WIDTH];
            }
        }
        bounds
    }
}
