//! Single rays through the tree: eight boxes or eight triangles at a time. Answers are those of packets, bit for bit.

use glam::Vec3;
use multiversion::multiversion;

use super::bounds::Bounds;
use super::children::ChildBounds;
use super::closest::RayHit;
use super::lanes::{WIDTH, wide_bits};
use super::occluded::is_hidden;
use super::packet::finite_reciprocal;
use super::stack::{Child, Entry, Stack};
use super::tree::Tree;
use super::wedge::Wedges;

/// A ray, ready to be tested against boxes.
struct Ray {
    origin: Vec3,
    reciprocal: [f32; 3],
}

impl Ray {
    #[inline(always)]
    fn new(origin: Vec3, direction: Vec3) -> Self {
        let [x, y, z] = direction.to_array();
        Self { origin, reciprocal: [finite_reciprocal(x), finite_reciprocal(y), finite_reciprocal(z)] }
    }

    /// Pushes the children that the ray meets nearer than `limit`, the nearest last.
    #[inline(always)]
    fn push(&self, tree: &Tree, entry: Entry, limit: f32, stack: &mut Stack) {
        let node = &tree.nodes[entry.node as usize];
        let (near, meets) = ChildBounds::new(node, self.origin).meets(self.reciprocal, limit);
        let children = wide_bits(&meets) & node.used & entry.children;
        let mut distances = [0; WIDTH];
        for lane in 0..WIDTH {
            // No distance is negative, and bits are in the order of such numbers.
            distances[lane] = near[lane].to_bits();
        }
        stack.push(entry.node, children, &distances, &[1; WIDTH]);
    }

    /// The triangles of a leaf whose box the ray meets, and where it passes that; nothing if it stays beside the slab.
    #[inline(always)]
    fn enter_leaf(&self, tree: &Tree, child: Child<'_>, direction: Vec3) -> Option<(Wedges, [f32; 2])> {
        let leaf = &tree.leaves[child.number as usize];
        let passage = Bounds::new(child, self.origin).passage(self.reciprocal);
        let is_in_slab = leaf.outline.slab.from(self.origin).holds_some_of(direction, passage);
        if is_in_slab { Some((Wedges::new(leaf, self.origin), passage)) } else { None }
    }
}

/// Whether a ray meets anything. Traversal starts at the stack's entries from `first` on.
#[multiversion(targets("x86_64+avx+avx2"))]
pub(super) fn occluded(tree: &Tree, origin: Vec3, direction: Vec3, stack: &mut Stack, first: usize) -> bool {
    occluded_portable(tree, origin, direction, stack, first)
}

#[inline(always)]
pub(super) fn occluded_portable(tree: &Tree, origin: Vec3, direction: Vec3, stack: &mut Stack, first: usize) -> bool {
    let ray = Ray::new(origin, direction);
    stack.clear();
    for number in first..stack.entries.len() {
        let entry = stack.entries[number];
        ray.push(tree, entry, f32::INFINITY, stack);
    }
    while let Some(item) = stack.pop() {
        let child = item.child(tree);
        if !child.is_leaf {
            ray.push(tree, Entry::unopened(child.number), f32::INFINITY, stack);
            continue;
        }
        if let Some((wedges, _)) = ray.enter_leaf(tree, child, direction)
            && is_hidden(&wedges, tree, child, direction)
        {
            return true;
        }
    }
    false
}

/// The nearest hit of a ray.
#[multiversion(targets("x86_64+avx+avx2"))]
pub(super) fn closest(tree: &Tree, origin: Vec3, direction: Vec3, stack: &mut Stack) -> Option<RayHit> {
    closest_portable(tree, origin, direction, stack)
}

#[inline(always)]
pub(super) fn closest_portable(tree: &Tree, origin: Vec3, direction: Vec3, stack: &mut Stack) -> Option<RayHit> {
    let ray = Ray::new(origin, direction);
    let mut nearest = RayHit::NONE;
    stack.clear();
    ray.push(tree, Entry::unopened(0), f32::INFINITY, stack);
    while let Some(item) = stack.pop() {
        if f32::from_bits(item.distance()) > nearest.distance {
            continue;
        }
        let child = item.child(tree);
        if !child.is_leaf {
            ray.push(tree, Entry::unopened(child.number), nearest.distance, stack);
            continue;
        }
        if let Some((wedges, passage)) = ray.enter_leaf(tree, child, direction) {
            nearest.meet_leaf(&wedges, tree, child, direction, passage);
        }
    }
    nearest.found()
}
