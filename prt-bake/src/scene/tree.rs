//! A tree of eight-fold nodes, collapsed from a binary one.

use glam::Vec3;

use super::lanes::{WIDTH, Wide, larger};
use super::mask::Masks;
use super::prefetch::prefetch;
use super::slab::Slab;

/// Boxes of the tree are widened by this on every side, in units of the scene, which is 1 across: more than the rounding of the
/// box test for a ray of length 1 in `f32` (about 4e-7) and than what the sides of triangles are widened by, so that a ray that touches
/// a triangle never misses its box. Only the tips of needles, which are widened by more, are cut off by it.
pub(super) const BOX_PADDING: f32 = 4e-6;

/// Boxes of up to eight children.
#[derive(Debug, Clone)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// `[side][axis]`, side 0 is the lower one.
    pub(super) bounds: [[Wide<f32>; 3]; 2],
    /// Number of a node, or of a leaf.
    pub(super) child: Wide<u32>,
    /// A bit for each child that there is.
    pub(super) used: u32,
    /// A bit for each child that is a leaf.
    pub(super) leaves: u32,
}

/// Up to eight triangles; those that there are not have no area.
#[derive(Debug, Clone)]
#[repr(C, align(64))]
pub(super) struct Leaf {
    pub(super) outline: Outline,
    /// `[corner][axis]`.
    pub(super) corners: [[Wide<f32>; 3]; 3],
}

/// What is asked first about a leaf, in one line of the cache.
#[derive(Debug, Clone)]
#[repr(C, align(64))]
pub(super) struct Outline {
    pub(super) slab: Slab,
    /// Middle of the box of all corners.
    center: [f32; 3],
    /// From a point farther from the middle than this along any axis, no corner is nearer than the longest extent of the box.
    near: f32,
    /// A bit for each triangle that may have holes.
    pub(super) holed: u32,
}

impl Outline {
    /// Whether each corner is at least as far from a point, along some axis, as from any other corner.
    #[inline(always)]
    pub(super) fn is_far_from(&self, origin: Vec3) -> bool {
        let [x, y, z] = self.center;
        larger(larger((x - origin.x).abs(), (y - origin.y).abs()), (z - origin.z).abs()) > self.near
    }
}

/// In place of the number of a triangle.
pub(super) const NO_TRIANGLE: u32 = u32::MAX;

/// The triangles of a scene.
#[derive(Debug, Clone)]
pub(super) struct Tree {
    /// The root is the first.
    pub(super) nodes: Vec<Node>,
    pub(super) leaves: Vec<Leaf>,
    /// For each slot, eight for each leaf, the number of the triangle as it was given.
    pub(super) numbers: Vec<u32>,
    pub(super) masks: Masks,
}

/// A box of a binary tree and what is in it.
#[derive(Debug, Clone, Copy)]
pub(super) struct BinaryNode {
    pub(super) lower: Vec3,
    pub(super) upper: Vec3,
    /// First triangle of a leaf in the list of triangles, or first of two children.
    pub(super) first: u32,
    /// Number of triangles; 0 in an inner node.
    pub(super) count: u32,
}

impl BinaryNode {
    fn children(&self) -> [u32; 2] {
        [self.first, self.first + 1]
    }

    /// Half of the surface.
    fn area(&self) -> f32 {
        let size = self.upper - self.lower;
        size.x * size.y + size.y * size.z + size.z * size.x
    }
}

impl Tree {
    /// Collapses a binary tree, whose root is its first node.
    ///
    /// - `order`: numbers of the triangles, in the order in which the leaves refer to them
    pub(super) fn new(nodes: &[BinaryNode], order: &[u32], triangles: &[[Vec3; 3]]) -> Self {
        let mut tree = Self { nodes: Vec::new(), leaves: Vec::new(), numbers: Vec::new(), masks: Masks::default() };
        Collapse { counts: counts(nodes), nodes, order, triangles }.add_to(&mut tree);
        tree
    }

    /// Replaces the numbers of the triangles by those in a list.
    pub(super) fn renumber(&mut self, numbers: &[u32]) {
        let used = self.numbers.iter_mut().filter(|number| **number != NO_TRIANGLE);
        used.for_each(|number| *number = numbers[*number as usize]);
    }

    pub(super) fn set_masks(&mut self, masks: Masks) {
        for (number, leaf) in self.leaves.iter_mut().enumerate() {
            let holed = |slot: usize| u32::from(masks.may_have_holes(number * WIDTH + slot)) << slot;
            leaf.outline.holed = (0..WIDTH).map(holed).sum();
        }
        self.masks = masks;
    }

    /// Begins to load children of a node.
    #[inline(always)]
    pub(super) fn prefetch(&self, node: &Node, mut children: u32) {
        while children != 0 {
            let slot = children.trailing_zeros();
            children &= children - 1;
            let child = node.child[slot as usize % WIDTH] as usize;
            if node.leaves >> slot & 1 == 1 {
                prefetch(&self.leaves[child]);
            } else {
                prefetch(&self.nodes[child]);
            }
        }
    }

    pub(super) fn memory_bytes(&self) -> usize {
        let triangles = size_of_val(&*self.leaves) + size_of_val(&*self.numbers);
        size_of_val(&*self.nodes) + triangles + self.masks.memory_bytes()
    }
}

/// Triangles below each node of a binary tree. Trees of nested triangles may be as deep as there are triangles.
fn counts(nodes: &[BinaryNode]) -> Vec<u32> {
    let mut order = vec![0_u32];
    let mut next = 0;
    while let Some(&number) = order.get(next) {
        let node = nodes[number as usize];
        if node.count == 0 {
            order.extend(node.children());
        }
        next += 1;
    }
    let mut counts: Vec<u32> = nodes.iter().map(|node| node.count).collect();
    // Parents come before their children.
    for &number in order.iter().rev() {
        let node = nodes[number as usize];
        if node.count == 0 {
            counts[number as usize] = node.children().map(|child| counts[child as usize]).iter().sum();
        }
    }
    counts
}

/// A binary tree that is being collapsed.
struct Collapse<'a> {
    nodes: &'a [BinaryNode],
    /// Triangles below each node.
    counts: Vec<u32>,
    order: &'a [u32],
    triangles: &'a [[Vec3; 3]],
}

/// A node that is still to be made, and which child of which node it is.
struct Pending {
    number: u32,
    parent: Option<(usize, usize)>,
}

impl Collapse<'_> {
    /// Everything below fits into one leaf.
    fn is_leaf(&self, number: u32) -> bool {
        self.counts[number as usize] as usize <= WIDTH
    }

    fn add_to(&self, tree: &mut Tree) {
        let mut pending = vec![Pending { number: 0, parent: None }];
        while let Some(Pending { number, parent }) = pending.pop() {
            let here = tree.nodes.len();
            if let Some((parent, slot)) = parent {
                tree.nodes[parent].child[slot] = here as u32;
            }
            tree.nodes.push(Node { bounds: [[[0.0; WIDTH]; 3]; 2], child: [0; WIDTH], used: 0, leaves: 0 });
            for (slot, child) in self.children(number).into_iter().enumerate() {
                self.set_bounds(&mut tree.nodes[here], slot, child);
                if self.is_leaf(child) {
                    let leaf = self.add_leaf(child, tree);
                    tree.nodes[here].child[slot] = leaf;
                    tree.nodes[here].leaves |= 1 << slot;
                } else {
                    pending.push(Pending { number: child, parent: Some((here, slot)) });
                }
            }
        }
    }

    fn set_bounds(&self, node: &mut Node, slot: usize, child: u32) {
        let from = &self.nodes[child as usize];
        for axis in 0..3 {
            node.bounds[0][axis][slot] = from.lower[axis] - BOX_PADDING;
            node.bounds[1][axis][slot] = from.upper[axis] + BOX_PADDING;
        }
        node.used |= 1 << slot;
    }

    /// Opens the largest boxes until there are eight.
    fn children(&self, number: u32) -> Vec<u32> {
        let mut children = vec![number];
        while children.len() < WIDTH {
            let area = |slot: &usize| self.nodes[children[*slot] as usize].area();
            let inner = (0..children.len()).filter(|&slot| !self.is_leaf(children[slot]));
            let Some(largest) = inner.max_by(|a, b| area(a).total_cmp(&area(b))) else { break };
            let [left, right] = self.nodes[children[largest] as usize].children();
            children[largest] = left;
            children.push(right);
        }
        children
    }

    fn add_leaf(&self, number: u32, tree: &mut Tree) -> u32 {
        let mut numbers = Vec::with_capacity(WIDTH);
        self.collect(number, &mut numbers);
        // What is left over lies in one corner.
        let first = self.triangles[numbers[0] as usize][0];
        let corners = [first.to_array().map(|component| [component; WIDTH]); 3];
        let from = self.nodes[number as usize];
        let center = (0.5 * (from.lower + from.upper)).to_array();
        // Half of the extent on this side of the middle, and all of it from there on.
        let near = 1.5 * (from.upper - from.lower).max_element();
        let slab = Slab::new(numbers.iter().map(|&triangle| self.triangles[triangle as usize]));
        let mut leaf = Leaf { outline: Outline { slab, center, near, holed: 0 }, corners };
        for (slot, &triangle) in numbers.iter().enumerate() {
            for (corner, position) in self.triangles[triangle as usize].iter().enumerate() {
                for axis in 0..3 {
                    leaf.corners[corner][axis][slot] = position[axis];
                }
            }
        }
        numbers.resize(WIDTH, NO_TRIANGLE);
        tree.numbers.extend(numbers);
        tree.leaves.push(leaf);
        (tree.leaves.len() - 1) as u32
    }

    /// The numbers of all triangles below a node that is a leaf here.
    fn collect(&self, number: u32, numbers: &mut Vec<u32>) {
        let node = self.nodes[number as usize];
        if node.count > 0 {
            numbers.extend(&self.order[node.first as usize..][..node.count as usize]);
        } else {
            node.children().into_iter().for_each(|child| self.collect(child, numbers));
        }
    }
}
