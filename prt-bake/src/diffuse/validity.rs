//! Which vertices lie inside of solids.

use glam::{DVec3, Vec3};
use sh_core::Order;

use super::VertexStats;
use crate::sampling::{DirectionSet, PACKET_SIZE};
use crate::scene::{Hits, Stack};
use crate::{Mesh, Scene};

/// Directions over the sphere along which the nearest hit is looked up, about half of them above a vertex. They are the same for every
/// bake, so that validity depends on the mesh alone.
const DIRECTIONS: usize = 2 * PACKET_SIZE;

/// A vertex of which a smaller share of the directions is occluded is not looked at more closely: its validity is 1. Vertices inside
/// of closed solids are occluded all around; see [`VertexStats::VALID`] for what was measured.
const SUSPECT_OCCLUSION: f32 = 0.9;

/// Finds out on which sides of faces the directions of a vertex end.
#[derive(Debug)]
pub(crate) struct ValidityTest<'a> {
    scene: &'a Scene,
    mesh: &'a Mesh,
    directions: DirectionSet,
}

impl<'a> ValidityTest<'a> {
    pub(crate) fn new(scene: &'a Scene, mesh: &'a Mesh) -> Self {
        let order = Order::new(1).expect("1 is an order");
        Self { scene, mesh, directions: DirectionSet::new(DIRECTIONS, order, 0) }
    }

    /// Completes what was found at a point by its validity, and counts the rays that it took.
    ///
    /// - `normal`: the shading normal
    pub(crate) fn complete(&self, normal: [f32; 3], origin: Vec3, stats: &mut VertexStats) {
        if stats.occluded_share() >= SUSPECT_OCCLUSION {
            let (backs, rays) = self.backs(Vec3::from_array(normal), origin);
            stats.validity = 1.0 - backs as f32 / rays.max(1) as f32;
            stats.rays += rays;
        }
    }

    /// How many of the directions above the horizon end on the back of a face, and how many there are.
    fn backs(&self, normal: Vec3, origin: Vec3) -> (u32, u32) {
        let (mut hits, mut stack) = (Hits::default(), Stack::default());
        let (mut backs, mut rays) = (0, 0);
        for (packet, directions) in self.directions.packets.iter().zip(self.directions.directions.chunks(PACKET_SIZE)) {
            let is_above = |lane: &usize| normal.dot(directions[*lane]) > 0.0;
            let above = (0..directions.len()).filter(is_above).fold(0, |bits, lane| bits | 1_u64 << lane);
            self.scene.closest_packet(origin, packet, above, &mut hits, &mut stack);
            rays += above.count_ones();
            let found = (0..directions.len()).filter_map(|lane| self.scene.hit(&hits, lane));
            backs += found.filter(|hit| hit.is_front == is_turned(self.mesh, hit.triangle)).count() as u32;
        }
        (backs, rays)
    }
}

/// Whether the corners of a face run clockwise seen from the side that the normals of its vertices point to. Its outside is where they
/// point: so a part whose faces are turned inside out, but whose normals are right, is not taken for the inside of a solid.
fn is_turned(mesh: &Mesh, triangle: u32) -> bool {
    let corners = mesh.triangles()[triangle as usize];
    let [a, b, c] = corners.map(|vertex| DVec3::from_array(mesh.positions()[vertex as usize]));
    let outward: Vec3 = corners.map(|vertex| Vec3::from_array(mesh.normals()[vertex as usize])).iter().sum();
    (b - a).cross(c - a).dot(outward.as_dvec3()) < 0.0
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]

    use super::*;
    use crate::{BakeOptions, MeshOptions, MeshSource, bake_diffuse};

    /// Tetrahedra about the origin, each of a size, with normals that point away from it or not given; faces outwards or turned.
    fn tetrahedra(parts: &[(f64, bool, bool)]) -> Mesh {
        let mut source = MeshSource::default();
        for &(size, is_turned, has_normals) in parts {
            let first = source.positions.len() as u32;
            let corners = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
            source.positions.extend(corners.map(|corner: [f64; 3]| corner.map(|x| x * size)));
            source.normals.extend(corners.map(|corner| if has_normals { corner.map(|x| x as f32) } else { [0.0; 3] }));
            let faces = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
            let turn = |[a, b, c]: [u32; 3]| if is_turned { [a, c, b] } else { [a, b, c] };
            source.triangles.extend(faces.map(|face| turn(face.map(|vertex| vertex + first))));
        }
        Mesh::new(source, &MeshOptions::default()).unwrap().0
    }

    /// Of the vertices nearer to the origin than 5, and of the others.
    fn validities(mesh: &Mesh) -> [Vec<f32>; 2] {
        let options = BakeOptions { order: Order::new(1).unwrap(), rays_per_vertex: 64, ..BakeOptions::default() };
        let stats = bake_diffuse(mesh, &options, &()).unwrap().1.vertices;
        [true, false].map(|is_near| {
            let is_asked = |position: &[f64; 3]| (DVec3::from_array(*position).length() < 5.0) == is_near;
            let vertices = mesh.positions().iter().zip(&stats).filter(|(position, _)| is_asked(position));
            vertices.map(|(_, stats)| stats.validity).collect()
        })
    }

    fn are_all(validities: &[f32], expected: f32) -> bool {
        !validities.is_empty() && validities.iter().all(|&validity| validity == expected)
    }

    #[test]
    fn what_lies_in_a_solid_is_invalid_and_what_lies_in_a_room_is_not() {
        let solid = (8.0, false, false);
        for part in [(1.0, false, false), (1.0, false, true), (1.0, true, true)] {
            let [inner, outer] = validities(&tetrahedra(&[part, solid]));
            assert!(are_all(&inner, 0.0) && are_all(&outer, 1.0), "{part:?}: {inner:?} {outer:?}");
        }
        // Faces turned inwards without normals of their own: a room, which is dark and valid.
        let [inner, outer] = validities(&tetrahedra(&[(1.0, false, false), (8.0, true, false)]));
        assert!(are_all(&inner, 1.0) && are_all(&outer, 1.0), "{inner:?} {outer:?}");
        // Turned faces whose normals say where outside is: a solid again.
        let [inner, outer] = validities(&tetrahedra(&[(1.0, false, false), (8.0, true, true)]));
        assert!(are_all(&inner, 0.0) && are_all(&outer, 1.0), "{inner:?} {outer:?}");
    }

    #[test]
    fn open_meshes_are_valid() {
        // A leaf below another one sees its back, but past it as well.
        let mut source = MeshSource::default();
        for (size, z) in [(1.0, 0.0), (1.0, 0.5)] {
            let first = source.positions.len() as u32;
            source.positions.extend([[-size, -size, z], [size, -size, z], [size, size, z], [-size, size, z]]);
            source.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
        let (mesh, _) = Mesh::new(source, &MeshOptions::default()).unwrap();
        assert!(are_all(&validities(&mesh)[0], 1.0));
    }
}
