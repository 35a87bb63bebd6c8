//! Where the rays of a vertex start.

use glam::{DVec3, Vec3};

use crate::mesh::unit_vector;
use crate::{Mesh, Scene};

/// Rays start this far outside the surface, in units of the scene, which is between 1/2 and 1 across: 300 times the rounding of a
/// position in `f32`. The occluded share of the bunny is the same for all values from 1e-7 to 1e-5; 1e-4 loses 3 % of it.
const OFFSET: f64 = 1e-5;

/// ... and this far towards the faces of the vertex, so that a vertex at the foot of a wall does not stand in the wall's plane. Half
/// as far as outwards: no face that shares the vertex's smooth normal rises above the origin.
const INSET: f64 = 0.5 * OFFSET;

/// For each vertex the origin of its rays, in the frame that the scene is traced in.
pub(crate) fn ray_origins(mesh: &Mesh, scene: &Scene) -> Vec<Vec3> {
    let fans = Fan::of_vertices(mesh);
    let positions = mesh.positions().iter().map(|&position| scene.to_unit_cube(DVec3::from_array(position)));
    let offsets = fans.iter().zip(mesh.normals()).map(|(fan, &normal)| fan.offset(Vec3::from_array(normal).as_dvec3()));
    positions.zip(offsets).map(|(position, offset)| position + offset.as_vec3()).collect()
}

/// The faces around a vertex.
#[derive(Debug, Clone, Copy, Default)]
struct Fan {
    /// Sum of the unit normals, weighted by the faces' angle at the vertex.
    normal: DVec3,
    /// Sum of the unit vectors towards the faces' centres.
    inward: DVec3,
    face_count: u32,
}

impl Fan {
    fn of_vertices(mesh: &Mesh) -> Vec<Self> {
        let mut fans = vec![Self::default(); mesh.positions().len()];
        for triangle in mesh.triangles() {
            let at = triangle.map(|vertex| DVec3::from_array(mesh.positions()[vertex as usize]));
            for k in 0..3 {
                fans[triangle[k] as usize].add_face(at[k], at[(k + 1) % 3], at[(k + 2) % 3]);
            }
        }
        fans
    }

    fn add_face(&mut self, p: DVec3, q: DVec3, r: DVec3) {
        let (to_q, to_r) = (unit_vector(q - p), unit_vector(r - p));
        self.normal += unit_vector(to_q.cross(to_r)) * to_q.angle_between(to_r);
        self.inward += unit_vector((q - p) + (r - p));
        self.face_count += 1;
    }

    /// Out of the true surface, on the side that the shading normal is on.
    fn offset(&self, shading_normal: DVec3) -> DVec3 {
        let outward = self.normal.normalize_or(shading_normal);
        let outward = if outward.dot(shading_normal) < 0.0 { -outward } else { outward };
        let inward = self.inward.reject_from(outward) / f64::from(self.face_count.max(1));
        OFFSET * outward + INSET * inward
    }
}
