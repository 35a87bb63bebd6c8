//! Rays against a mesh. The only file that knows the crate that builds the tree.

mod mask;
mod packet;
mod twins;

use glam::{DVec3, Vec3};
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::triangle::Triangle;
use obvhs::{BvhBuildParams, bvh2::Bvh2};

use crate::Mesh;
use crate::sampling::DirectionSet;
use mask::Masks;
pub(crate) use packet::{Hits, Packet, Stack};
use twins::Twins;

/// Boxes of the tree are widened by this on every side, in units of the scene, which is 1 across: more than the rounding of the
/// box test for a ray of length 1 in `f32` (about 3e-7), so that a ray that touches a triangle never misses its box.
const BOX_PADDING: f32 = 1e-6;

/// A mesh prepared for tracing: recentred and scaled in `f64` to a cube of side 1, with a bounding-volume hierarchy.
///
/// The scale is a power of two, so that scaling a scene by a power of two changes no bit of what is traced.
#[derive(Debug)]
pub struct Scene {
    nodes: Vec<Node>,
    /// Corners in the order of the leaves.
    triangles: Vec<[Vec3; 3]>,
    /// For each of `triangles` its number in the mesh.
    numbers: Vec<u32>,
    masks: Masks,
    twins: Twins,
    center: DVec3,
    scale: f64,
}

/// A box of the tree and what is in it.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
struct Node {
    lower: Vec3,
    /// First triangle of a leaf, or first of two children.
    first: u32,
    upper: Vec3,
    /// Number of triangles; 0 in an inner node.
    count: u32,
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

impl Scene {
    /// Builds the tree. Costs about 0.03 s for 70,000 triangles.
    #[must_use]
    pub fn new(mesh: &Mesh) -> Self {
        let (center, scale) = unit_cube(mesh);
        let local = |&vertex: &u32| ((DVec3::from_array(mesh.positions()[vertex as usize]) - center) * scale).as_vec3();
        let given: Vec<[Vec3; 3]> =
            mesh.original_triangles().iter().map(|[a, b, c]| [local(a), local(b), local(c)]).collect();
        let tree = build_tree(&given);
        let triangles = tree.primitive_indices.iter().map(|&number| given[number as usize]).collect();
        let nodes = tree.nodes.iter().map(padded_node).collect();
        let masks = Masks::new(mesh, &tree.primitive_indices);
        Self { nodes, triangles, numbers: tree.primitive_indices, masks, twins: Twins::new(mesh), center, scale }
    }

    /// A point in the frame that is traced in, where the scene is 1 across.
    pub(crate) fn to_unit_cube(&self, position: DVec3) -> Vec3 {
        ((position - self.center) * self.scale).as_vec3()
    }

    /// Whether anything stands in the way, for each of `directions` (unit length) from `origin`, at any distance.
    ///
    /// Both sides of a triangle occlude; rays pass through the holes of its material. A triangle in whose plane the origin lies does not. `occluded` is overwritten.
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
    /// is overwritten. Returns the number of rays that were traced one by one.
    pub(crate) fn occluded_directions(
        &self,
        origin: Vec3,
        directions: &DirectionSet,
        above: &[u64],
        stack: &mut Stack,
        occluded: &mut Vec<u64>,
    ) -> u32 {
        occluded.clear();
        occluded.extend(directions.packets.iter().zip(above).map(|(packet, &rays)| match rays {
            0 => 0,
            _ => self.occluded_packet(origin, packet, rays, stack),
        }));
        above.iter().map(|rays| rays.count_ones()).sum()
    }

    fn tree(&self) -> packet::Tree<'_> {
        packet::Tree { nodes: &self.nodes, triangles: &self.triangles, masks: &self.masks }
    }

    /// Of the rays of `packet` whose bit is set in `rays`, those that meet anything.
    pub(crate) fn occluded_packet(&self, origin: Vec3, packet: &Packet, rays: u64, stack: &mut Stack) -> u64 {
        packet::occluded(self.tree(), origin, packet, rays, stack)
    }

    /// The nearest hit of the rays of `packet` whose bit is set in `rays`.
    pub(crate) fn closest_packet(&self, origin: Vec3, packet: &Packet, rays: u64, hits: &mut Hits, stack: &mut Stack) {
        packet::closest(self.tree(), origin, packet, rays, hits, stack);
    }

    /// What `closest_packet` found for one ray.
    pub(crate) fn hit(&self, hits: &Hits, lane: usize) -> Option<Hit> {
        let (slot, barycentric, distance, is_front) = hits.get(lane)?;
        let triangle = self.numbers[slot as usize];
        let hit = Hit { triangle, barycentric, distance: f64::from(distance) / self.scale, is_front };
        Some(self.twins.on_the_side_that_is_hit(hit))
    }

    /// Bytes held.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.nodes)
            + size_of_val(&*self.triangles)
            + size_of_val(&*self.numbers)
            + self.masks.memory_bytes()
    }
}

/// The centre of the mesh, and the power of two that makes its longest extent at most 1 and more than 1/2.
fn unit_cube(mesh: &Mesh) -> (DVec3, f64) {
    let [lower, upper] = mesh.bounds().map(DVec3::from_array);
    let extent = (upper - lower).max_element();
    (0.5 * (lower + upper), (-extent.log2().ceil()).exp2())
}

fn build_tree(triangles: &[[Vec3; 3]]) -> Bvh2 {
    let triangles: Vec<Triangle> =
        triangles.iter().map(|&[a, b, c]| Triangle { v0: a.into(), v1: b.into(), v2: c.into() }).collect();
    build_bvh2_from_tris(&triangles, BvhBuildParams::medium_build(), &mut std::time::Duration::default())
}

fn padded_node(node: &obvhs::bvh2::node::Bvh2Node) -> Node {
    Node {
        lower: Vec3::from(node.aabb().min) - BOX_PADDING,
        upper: Vec3::from(node.aabb().max) + BOX_PADDING,
        first: node.first_index,
        count: node.prim_count,
    }
}

#[cfg(test)]
mod tests;
