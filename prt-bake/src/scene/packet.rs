//! Up to 64 rays from one origin, traced together.
//!
//! With a common origin a triangle is three planes through it, one for each edge: a ray meets the triangle if it lies on the inner
//! side of all three. That is three dot products a ray and no division. It is watertight: neighbours compute the plane of their
//! common edge with the same operations and opposite sign, and triangles are wider by the rounding of these planes, so that no
//! gap opens where many of them meet in a corner. Boxes are first tested against the beam that encloses all rays, then ray by
//! ray.
//!
//! All loops run over blocks of eight lanes with the same operations in the same order whatever the instruction set, and
//! multiplications and additions are never contracted, so that every machine finds the same hits. They are written as plain loops:
//! closures inside iterators may be left out of line, and then miss the instruction set that their caller is compiled for.

#![expect(
    clippy::needless_range_loop,
    clippy::manual_find,
    reason = "see above: plain loops over lanes are vectorised"
)]

use glam::Vec3;
use multiversion::multiversion;

use super::Node;
use super::mask::Masks;

const LANES: usize = 8;
const BLOCKS: usize = 8;

/// One number for each of the eight rays of a block.
type Lanes<T> = [T; LANES];

/// Directions of up to 64 rays, and the beam that encloses them.
#[derive(Debug, Clone)]
pub(crate) struct Packet {
    /// Components of the directions: `[x, y, z]` of each block.
    direction: [[Lanes<f32>; 3]; BLOCKS],
    /// Their reciprocals, finite.
    reciprocal: [[Lanes<f32>; 3]; BLOCKS],
    beam: Beam,
    /// Mean of the directions.
    mean: Vec3,
    count: usize,
}

/// Four planes through the origin between which all rays lie, as x, y and z of their inner normals; zero if the rays spread too far
/// for that.
type Beam = [[f32; 4]; 3];

/// A component smaller than this is replaced before it is inverted, so that `0 · ∞` never appears in the box test.
const SMALLEST_COMPONENT: f32 = 1e-20;

/// Rays that leave the mean direction by more than the angle with this cosine get no beam: its planes would not cull.
const WIDEST_BEAM_COSINE: f32 = 0.3;

/// A box outside a plane of the beam by less than this is kept: above the rounding of the test for a scene 1 across.
const BEAM_TOLERANCE: f32 = 1e-6;

/// A plane through the origin and an edge is computed with an error of at most about four roundings of `f32` of the product of the
/// distances of its two corners, and the sign of its product with a direction with four more.
const PLANE_TOLERANCE: f32 = 8.0 * f32::EPSILON;

impl Packet {
    pub(crate) const SIZE: usize = LANES * BLOCKS;

    /// # Panics
    /// If there are no directions or more than [`Packet::SIZE`].
    pub(crate) fn new(directions: &[Vec3]) -> Self {
        assert!((1..=Self::SIZE).contains(&directions.len()), "1 to 64 directions");
        let mut packet = Self {
            direction: [[[0.0; LANES]; 3]; BLOCKS],
            reciprocal: [[[0.0; LANES]; 3]; BLOCKS],
            beam: enclosing_beam(directions),
            mean: directions.iter().sum::<Vec3>() / directions.len() as f32,
            count: directions.len(),
        };
        for ray in 0..Self::SIZE {
            // Lanes without a ray repeat the last one; their answers are masked away.
            let direction = directions[ray.min(directions.len() - 1)];
            for axis in 0..3 {
                packet.direction[ray / LANES][axis][ray % LANES] = direction[axis];
                packet.reciprocal[ray / LANES][axis][ray % LANES] = finite_reciprocal(direction[axis]);
            }
        }
        packet
    }

    /// A set bit for each ray.
    pub(crate) fn all(&self) -> u64 {
        u64::MAX >> (Self::SIZE - self.count)
    }
}

fn finite_reciprocal(component: f32) -> f32 {
    1.0 / component.abs().max(SMALLEST_COMPONENT).copysign(component)
}

/// Four planes around the directions, seen as points on a plane at distance 1 along their mean.
fn enclosing_beam(directions: &[Vec3]) -> Beam {
    let mean = directions.iter().sum::<Vec3>().normalize_or_zero();
    if mean == Vec3::ZERO || directions.iter().any(|direction| direction.dot(mean) < WIDEST_BEAM_COSINE) {
        return Beam::default();
    }
    let (u, v) = mean.any_orthonormal_pair();
    let (mut lower, mut upper) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
    for direction in directions {
        for (k, axis) in [u, v].into_iter().enumerate() {
            let slope = direction.dot(axis) / direction.dot(mean);
            lower[k] = lower[k].min(slope);
            upper[k] = upper[k].max(slope);
        }
    }
    let planes = [u - lower[0] * mean, upper[0] * mean - u, v - lower[1] * mean, upper[1] * mean - v];
    [planes.map(|plane| plane.x), planes.map(|plane| plane.y), planes.map(|plane| plane.z)]
}

/// Nodes still to visit, each with the first block of which a ray may meet it. Kept by the caller to be reused.
#[derive(Debug, Default)]
pub(crate) struct Stack(Vec<(u32, u32)>);

/// What rays are traced against.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tree<'a> {
    pub(super) nodes: &'a [Node],
    /// Corners in the order of the leaves.
    pub(super) triangles: &'a [[Vec3; 3]],
    pub(super) masks: &'a Masks,
}

/// Rays that still look for a hit: all bits set or none.
type Alive = [Lanes<u32>; BLOCKS];

#[inline(always)]
fn alive_from_bits(bits: u64) -> Alive {
    std::array::from_fn(|block| {
        std::array::from_fn(|lane| 0_u32.wrapping_sub((bits >> (block * LANES + lane) & 1) as u32))
    })
}

#[inline(always)]
fn bits_from_alive(alive: &Alive) -> u64 {
    let mut bits = 0;
    for (ray, &lane) in alive.iter().flatten().enumerate() {
        bits |= u64::from(lane & 1) << ray;
    }
    bits
}

#[inline(always)]
fn any(lanes: &Lanes<u32>) -> bool {
    let mut any = 0;
    for lane in lanes {
        any |= lane;
    }
    any != 0
}

/// The box as seen from the origin.
#[derive(Clone, Copy)]
struct RelativeBox {
    lower: [f32; 3],
    upper: [f32; 3],
}

impl RelativeBox {
    #[inline(always)]
    fn new(node: &Node, origin: Vec3) -> Self {
        Self { lower: (node.lower - origin).to_array(), upper: (node.upper - origin).to_array() }
    }

    /// Whether the box lies outside one of the planes of the beam.
    #[inline(always)]
    fn misses_beam(&self, beam: &Beam) -> bool {
        let mut reach = [0.0; 4];
        for (axis, normal) in beam.iter().enumerate() {
            let (lower, upper) = (self.lower[axis], self.upper[axis]);
            for plane in 0..4 {
                reach[plane] += larger(normal[plane] * lower, normal[plane] * upper);
            }
        }
        let mut misses = 0;
        for reach in reach {
            misses |= mask(reach < -BEAM_TOLERANCE);
        }
        misses != 0
    }

    /// The first block, from `first` on, of which a ray that is alive meets the box nearer than its `limit`.
    #[inline(always)]
    fn first_block(&self, packet: &Packet, first: usize, alive: &Alive, limit: &[Lanes<f32>; BLOCKS]) -> Option<usize> {
        for block in first..BLOCKS {
            if any(&self.meets(&packet.reciprocal[block], &alive[block], &limit[block])) {
                return Some(block);
            }
        }
        None
    }

    #[inline(always)]
    fn meets(&self, reciprocal: &[Lanes<f32>; 3], alive: &Lanes<u32>, limit: &Lanes<f32>) -> Lanes<u32> {
        let mut near = [0.0_f32; LANES];
        let mut far = *limit;
        for axis in 0..3 {
            for lane in 0..LANES {
                let a = self.lower[axis] * reciprocal[axis][lane];
                let b = self.upper[axis] * reciprocal[axis][lane];
                near[lane] = larger(near[lane], smaller(a, b));
                far[lane] = smaller(far[lane], larger(a, b));
            }
        }
        let mut meets = [0; LANES];
        for lane in 0..LANES {
            meets[lane] = mask(near[lane] <= far[lane]) & alive[lane];
        }
        meets
    }
}

// `f32::min` and `max` treat NaN specially and cost more; no NaN reaches these.
#[inline(always)]
fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[inline(always)]
fn mask(condition: bool) -> u32 {
    0_u32.wrapping_sub(u32::from(condition))
}

/// A triangle as seen from the origin: the planes through the origin and each edge.
struct Wedge {
    /// Inner normals of the planes opposite to corner 0, 1, 2.
    planes: [Vec3; 3],
    /// Six times the volume of the tetrahedron of origin and triangle, not negative.
    volume: f32,
    /// A ray is inside if none of its weights is below these: a little less than zero.
    thresholds: [f32; 3],
    is_front: bool,
}

impl Wedge {
    /// `None` if the origin lies in the plane of the triangle.
    #[inline(always)]
    fn new(corners: &[Vec3; 3], origin: Vec3) -> Option<Self> {
        let (a, b, c) = (corners[0] - origin, corners[1] - origin, corners[2] - origin);
        let across_a = b.cross(c);
        let volume = a.dot(across_a);
        if volume == 0.0 {
            return None;
        }
        // Negative if the triangle turns its front, from which corners run counter-clockwise, to the origin.
        let is_front = volume < 0.0;
        let sign = 1.0_f32.copysign(volume);
        // By the distances of the two corners of each edge: a face next to the origin, which starts beside it, must not reach beyond its
        // edges by more than the others.
        let [to_a, to_b, to_c] = [a.length(), b.length(), c.length()];
        let thresholds = [to_b * to_c, to_c * to_a, to_a * to_b].map(|product| -PLANE_TOLERANCE * product);
        let planes = [across_a * sign, c.cross(a) * sign, a.cross(b) * sign];
        Some(Self { planes, volume: volume * sign, thresholds, is_front })
    }

    /// For each ray the products with the three planes: the barycentric weights, times a common factor.
    #[inline(always)]
    fn weights(&self, direction: &[Lanes<f32>; 3]) -> [Lanes<f32>; 3] {
        let [x, y, z] = direction;
        let mut weights = [[0.0; LANES]; 3];
        for (weights, plane) in weights.iter_mut().zip(self.planes) {
            for lane in 0..LANES {
                weights[lane] = plane.x * x[lane] + plane.y * y[lane] + plane.z * z[lane];
            }
        }
        weights
    }
}

#[inline(always)]
fn is_inside(weights: &[Lanes<f32>; 3], lane: usize, [a, b, c]: [f32; 3]) -> u32 {
    mask(weights[0][lane] >= a) & mask(weights[1][lane] >= b) & mask(weights[2][lane] >= c)
}

/// Leaves out of the rays that meet a triangle those that meet it in a hole.
#[inline(never)]
fn pass_through_holes(meets: &mut Lanes<u32>, weights: &[Lanes<f32>; 3], masks: &Masks, slot: usize) {
    for lane in 0..LANES {
        let weights = [weights[0][lane], weights[1][lane], weights[2][lane]];
        if meets[lane] != 0 && !masks.is_opaque(slot, weights) {
            meets[lane] = 0;
        }
    }
}

/// Of the `rays`, those that meet any triangle.
#[multiversion(targets("x86_64+avx+avx2"))]
pub(super) fn occluded(tree: Tree, origin: Vec3, packet: &Packet, rays: u64, stack: &mut Stack) -> u64 {
    const NO_LIMIT: [Lanes<f32>; BLOCKS] = [[f32::INFINITY; LANES]; BLOCKS];
    let mut alive = alive_from_bits(rays);
    stack.start();
    while let Some((node, first)) = stack.next_leaf(tree.nodes, origin, packet, &alive, &NO_LIMIT) {
        for slot in node.first as usize..(node.first + node.count) as usize {
            let Some(wedge) = Wedge::new(&tree.triangles[slot], origin) else { continue };
            let may_have_holes = tree.masks.may_have_holes(slot);
            for block in first..BLOCKS {
                if !any(&alive[block]) {
                    continue;
                }
                let weights = wedge.weights(&packet.direction[block]);
                let mut meets = alive[block];
                for lane in 0..LANES {
                    meets[lane] &= is_inside(&weights, lane, wedge.thresholds);
                }
                if may_have_holes {
                    pass_through_holes(&mut meets, &weights, tree.masks, slot);
                }
                for lane in 0..LANES {
                    alive[block][lane] &= !meets[lane];
                }
            }
        }
        if !alive.iter().any(any) {
            break;
        }
    }
    rays & !bits_from_alive(&alive)
}

impl Stack {
    /// Puts the root on the stack.
    #[inline(always)]
    fn start(&mut self) {
        self.0.clear();
        self.0.push((0, 0));
    }

    /// The next leaf, near ones first, that a ray which is alive meets nearer than its `limit`, and the first block with such a ray.
    #[inline(always)]
    fn next_leaf<'a>(
        &mut self,
        nodes: &'a [Node],
        origin: Vec3,
        packet: &Packet,
        alive: &Alive,
        limit: &[Lanes<f32>; BLOCKS],
    ) -> Option<(&'a Node, usize)> {
        while let Some((number, first)) = self.0.pop() {
            let node = &nodes[number as usize];
            let bounds = RelativeBox::new(node, origin);
            if bounds.misses_beam(&packet.beam) {
                continue;
            }
            let Some(first) = bounds.first_block(packet, first as usize, alive, limit) else { continue };
            if node.count > 0 {
                return Some((node, first));
            }
            let (near, far) = nearer_child(nodes, node.first, packet.mean);
            self.0.push((far, first as u32));
            self.0.push((near, first as u32));
        }
        None
    }
}

/// The two children of a node, first the one that rays along the beam reach first.
#[inline(always)]
fn nearer_child(nodes: &[Node], first: u32, along: Vec3) -> (u32, u32) {
    let (left, right) = (&nodes[first as usize], &nodes[first as usize + 1]);
    let is_left_nearer = along.dot(left.lower + left.upper) <= along.dot(right.lower + right.upper);
    if is_left_nearer { (first, first + 1) } else { (first + 1, first) }
}

/// The nearest hit of each ray of a packet.
#[derive(Debug, Clone)]
pub(crate) struct Hits {
    /// Infinite where nothing is met.
    distance: [Lanes<f32>; BLOCKS],
    /// Number of the triangle, in the order of the leaves.
    slot: [Lanes<u32>; BLOCKS],
    barycentric: [[Lanes<f32>; 2]; BLOCKS],
    is_front: [Lanes<u32>; BLOCKS],
}

impl Default for Hits {
    fn default() -> Self {
        Self {
            distance: [[f32::INFINITY; LANES]; BLOCKS],
            slot: [[0; LANES]; BLOCKS],
            barycentric: [[[0.0; LANES]; 2]; BLOCKS],
            is_front: [[0; LANES]; BLOCKS],
        }
    }
}

impl Hits {
    /// Slot, barycentric weights, distance and whether the front was hit.
    pub(super) fn get(&self, ray: usize) -> Option<(u32, [f32; 2], f32, bool)> {
        let (block, lane) = (ray / LANES, ray % LANES);
        let distance = self.distance[block][lane];
        let barycentric = [self.barycentric[block][0][lane], self.barycentric[block][1][lane]];
        distance.is_finite().then(|| (self.slot[block][lane], barycentric, distance, self.is_front[block][lane] != 0))
    }

    #[inline(always)]
    fn keep_nearer(
        &mut self,
        block: usize,
        alive: &Lanes<u32>,
        weights: &[Lanes<f32>; 3],
        wedge: &Wedge,
        slot: u32,
        masks: &Masks,
    ) {
        let (mut sum, mut is_nearer) = ([0.0; LANES], [0; LANES]);
        for lane in 0..LANES {
            sum[lane] = weights[0][lane] + weights[1][lane] + weights[2][lane];
            // The distance is volume / sum; nothing is divided before a ray is known to hit.
            let is_less = mask(wedge.volume < self.distance[block][lane] * sum[lane]) & mask(sum[lane] > 0.0);
            is_nearer[lane] = is_less & is_inside(weights, lane, wedge.thresholds) & alive[lane];
        }
        if !any(&is_nearer) {
            return;
        }
        if masks.may_have_holes(slot as usize) {
            pass_through_holes(&mut is_nearer, weights, masks, slot as usize);
        }
        for lane in 0..LANES {
            if is_nearer[lane] != 0 {
                self.distance[block][lane] = wedge.volume / sum[lane];
                self.slot[block][lane] = slot;
                self.barycentric[block][0][lane] = weights[1][lane] / sum[lane];
                self.barycentric[block][1][lane] = weights[2][lane] / sum[lane];
                self.is_front[block][lane] = mask(wedge.is_front);
            }
        }
    }
}

/// The nearest hit of each of the `rays`; the other entries of `hits` say that nothing was met.
#[multiversion(targets("x86_64+avx+avx2"))]
pub(super) fn closest(tree: Tree, origin: Vec3, packet: &Packet, rays: u64, hits: &mut Hits, stack: &mut Stack) {
    *hits = Hits::default();
    let alive = alive_from_bits(rays);
    stack.start();
    while let Some((node, first)) = stack.next_leaf(tree.nodes, origin, packet, &alive, &hits.distance) {
        for slot in node.first..node.first + node.count {
            let Some(wedge) = Wedge::new(&tree.triangles[slot as usize], origin) else { continue };
            for block in first..BLOCKS {
                if !any(&alive[block]) {
                    continue;
                }
                let weights = wedge.weights(&packet.direction[block]);
                hits.keep_nearer(block, &alive[block], &weights, &wedge, slot, tree.masks);
            }
        }
    }
}
