//! Rays against a mesh. The only file that knows the crate that builds the tree.

mod beam;
mod bins;
mod bounds;
mod children;
mod closest;
mod distinct;
mod lanes;
mod mask;
mod occluded;
mod packet;
mod prefetch;
mod ray;
mod rectangle;
mod slab;
mod stack;
mod tracer;
mod tree;
mod twins;
mod walk;
mod wedge;

use glam::{DVec3, Vec3};
use obvhs::BvhBuildParams;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::triangle::Triangle;

use crate::Mesh;
use crate::sampling::DirectionSet;
pub(crate) use bins::Bins;
use bins::Descent;
pub(crate) use closest::Hits;
use closest::RayHit;
use mask::Masks;
use occluded::How;
pub(crate) use packet::Packet;
pub(crate) use rectangle::Rectangle;
pub(crate) use stack::Stack;
pub use tracer::DirectionTracer;
use tree::{BinaryNode, Tree};
use twins::Twins;

/// A mesh prepared for tracing: recentred and scaled in `f64` to a cube of side 1, with a bounding-volume hierarchy.
///
/// The scale is a power of two, so that scaling a scene by a power of two changes no bit of what is traced.
#[derive(Debug)]
pub struct Scene {
    tree: Tree,
    twins: Twins,
    center: DVec3,
    scale: f64,
}

/// Where a ray meets the scene first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Number of the triangle in the mesh.
    pub triangle: u32,
    /// Weights of the second and the third corner; the first has `1 - u - v`.
    pub barycentric: [f32; 2],
    /// Distance, scene units.
    pub distance: f64,
    /// Whether the ray comes from the side from which the corners run counter-clockwise. A face with a twin is never hit from behind: then
    /// it is the twin that is hit, from its front.
    pub is_front: bool,
}

/// How the directions of a point were answered: their sum is the number of directions.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Answered {
    /// Rays that were traced one by one.
    pub traced: u32,
    /// Directions in bins that meet nothing.
    pub free: u32,
    /// Directions in bins that one triangle covers.
    pub blocked: u32,
}

impl Answered {
    fn add(&mut self, how: How, count: u32) {
        *match how {
            How::Free => &mut self.free,
            How::Blocked => &mut self.blocked,
            How::Traced => &mut self.traced,
        } += count;
    }
}

impl std::ops::AddAssign for Answered {
    fn add_assign(&mut self, other: Self) {
        self.traced += other.traced;
        self.free += other.free;
        self.blocked += other.blocked;
    }
}

impl Scene {
    /// Builds the tree. Costs about 0.03 s for 70,000 triangles.
    #[must_use]
    pub fn new(mesh: &Mesh) -> Self {
        let (center, scale) = unit_cube(mesh);
        let local = |vertex: u32| ((DVec3::from_array(mesh.positions()[vertex as usize]) - center) * scale).as_vec3();
        let corners = |face: u32| mesh.original_triangles()[face as usize].map(local);
        let faces = distinct::faces(mesh, corners);
        let given: Vec<[Vec3; 3]> = faces.iter().map(|&face| corners(face)).collect();
        let mut tree = build_tree(&given);
        tree.renumber(&faces);
        tree.set_masks(Masks::new(mesh, &tree.numbers));
        Self { tree, twins: Twins::new(mesh), center, scale }
    }

    /// A point in the frame that is traced in: the centre of the mesh is its origin, and the scene is more than 1/2 and at most 1 across.
    #[must_use]
    pub fn to_unit_cube(&self, position: DVec3) -> Vec3 {
        ((position - self.center) * self.scale).as_vec3()
    }

    /// Whether anything stands in the way, for each of `directions` (unit length) from `origin`, at any distance.
    ///
    /// Both sides of a triangle occlude; rays pass through the holes of its material. A triangle in whose plane the origin lies does not. `occluded` is overwritten.
    /// Rounding grows with the distance of the origin: within the scene and up to its size beside it rays are as exact as those of a bake.
    ///
    /// # Panics
    /// If the slices differ in length.
    pub fn occluded(&self, origin: [f64; 3], directions: &[Vec3], occluded: &mut [bool]) {
        assert_eq!(directions.len(), occluded.len(), "one answer for each direction");
        let origin = self.to_unit_cube(DVec3::from_array(origin));
        let chunks = directions.chunks(Packet::SIZE).zip(occluded.chunks_mut(Packet::SIZE));
        for (directions, answers) in chunks {
            let packet = Packet::new(directions);
            let mask = self.occluded_packet(origin, &packet, packet.all(), &mut Stack::default());
            answers.iter_mut().enumerate().for_each(|(lane, answer)| *answer = mask >> lane & 1 == 1);
        }
    }

    /// The nearest hit of each of `directions` (unit length) from `origin`. `hits` is overwritten.
    ///
    /// # Panics
    /// If the slices differ in length.
    pub fn closest(&self, origin: [f64; 3], directions: &[Vec3], hits: &mut [Option<Hit>]) {
        assert_eq!(directions.len(), hits.len(), "one answer for each direction");
        let origin = self.to_unit_cube(DVec3::from_array(origin));
        let mut found = Hits::default();
        for (directions, answers) in directions.chunks(Packet::SIZE).zip(hits.chunks_mut(Packet::SIZE)) {
            let packet = Packet::new(directions);
            self.closest_packet(origin, &packet, packet.all(), &mut found, &mut Stack::default());
            answers.iter_mut().enumerate().for_each(|(lane, answer)| *answer = self.hit(&found, lane));
        }
    }

    /// Of the `directions` whose bit is set in `above` (one word for each packet), those that meet anything from `origin`. `occluded`
    /// is overwritten.
    ///
    /// `normal`: all directions of `above` have a product with it that is not negative; zero if there is no such vector.
    pub(crate) fn occluded_directions(
        &self,
        origin: Vec3,
        normal: Vec3,
        directions: &DirectionSet,
        above: &[u64],
        stack: &mut Stack,
        occluded: &mut Vec<u64>,
    ) -> Answered {
        occluded.clear();
        occluded.resize(above.len(), 0);
        let (tree, answered) = (&self.tree, Answered::default());
        Descent { tree, directions, origin, normal, above, stack, occluded, answered }.answer()
    }

    /// Of the rays of `packet` whose bit is set in `rays`, those that meet anything.
    pub(crate) fn occluded_packet(&self, origin: Vec3, packet: &Packet, rays: u64, stack: &mut Stack) -> u64 {
        stack.entries.clear();
        stack.entries.push(stack::ROOT);
        bins::occluded(&self.tree, origin, Vec3::ZERO, packet, rays, stack, 0).0
    }

    /// The nearest hit of the rays of `packet` whose bit is set in `rays`.
    pub(crate) fn closest_packet(&self, origin: Vec3, packet: &Packet, rays: u64, hits: &mut Hits, stack: &mut Stack) {
        if packet.is_worth_a_packet(rays) {
            closest::closest(&self.tree, origin, packet, rays, hits, stack);
        } else {
            hits.find_each(rays, |ray| ray::closest(&self.tree, origin, packet.direction(ray), stack));
        }
    }

    /// What `closest_packet` found for one ray.
    pub(crate) fn hit(&self, hits: &Hits, lane: usize) -> Option<Hit> {
        hits.get(lane).map(|hit| self.scaled(hit))
    }

    /// The nearest hit of one ray.
    pub(crate) fn closest_ray(&self, origin: Vec3, direction: Vec3, stack: &mut Stack) -> Option<Hit> {
        ray::closest(&self.tree, origin, direction, stack).map(|hit| self.scaled(hit))
    }

    fn scaled(&self, hit: RayHit) -> Hit {
        self.twins.on_the_side_that_is_hit(Hit {
            triangle: self.tree.numbers[hit.slot as usize],
            barycentric: hit.barycentric(),
            distance: f64::from(hit.distance) / self.scale,
            is_front: hit.is_front,
        })
    }

    /// Bytes held.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        self.tree.memory_bytes()
    }
}

/// The centre of the mesh, and the power of two that makes its longest extent at most 1 and more than 1/2.
fn unit_cube(mesh: &Mesh) -> (DVec3, f64) {
    let [lower, upper] = mesh.bounds().map(DVec3::from_array);
    let extent = (upper - lower).max_element();
    (0.5 * (lower + upper), (-extent.log2().ceil()).exp2())
}

fn build_tree(given: &[[Vec3; 3]]) -> Tree {
    let triangles: Vec<Triangle> =
        given.iter().map(|&[a, b, c]| Triangle { v0: a.into(), v1: b.into(), v2: c.into() }).collect();
    let params = BvhBuildParams { max_prims_per_leaf: lanes::WIDTH as u32, ..BvhBuildParams::medium_build() };
    let binary = build_bvh2_from_tris(&triangles, params, &mut std::time::Duration::default());
    let nodes: Vec<BinaryNode> = binary.nodes.iter().map(binary_node).collect();
    Tree::new(&nodes, &binary.primitive_indices, given)
}

fn binary_node(node: &obvhs::bvh2::node::Bvh2Node) -> BinaryNode {
    BinaryNode {
        lower: node.aabb().min.into(),
        upper: node.aabb().max.into(),
        first: node.first_index,
        count: node.prim_count,
    }
}

#[cfg(test)]
mod tests;
