//! Where the rays of a vertex start.
//!
//! A vertex lies in the planes of its own faces, so its rays start a little outside of them: far enough that no rounding puts the origin
//! behind a face, and no farther, so that nothing thin is jumped over. In the frame that is traced in coordinates are at most 1/2,
//! and rounding one to `f32` moves it by at most [`ROUNDING`]. The side of a face is taken from its rounded corners, in `f64`: seen from
//! them the vertex is exact, and what is left is the rounding of the origin itself.
//!
//! Measured: the occluded share of meshes against [`CLEARANCE`] in units of [`ROUNDING`] (with half of it as [`INSET`]; 512 directions):
//!
//! | mesh | 1 | 4 | 16 | 64 | 80 | 256 | 2048 |
//! |---|---|---|---|---|---|---|---|
//! TABLE
//!
//! What is above the plateau is the self-shadowing of faces far longer than wide, which the tracer widens by `8 f32::EPSILON` of their length.

use glam::{DVec3, Vec3};

use crate::mesh::unit_vector;
use crate::{Mesh, Scene};

/// Largest error of a coordinate that is rounded to `f32` in a cube of side 1 around the origin: half a unit in the last place below 1/2.
const ROUNDING: f64 = 1.0 / (1 << 26) as f64;

/// The origin is this far outside of the planes of the faces of its vertex: 1.2e-6. Position, origin and a coplanar neighbour are each off by
/// at most `√3 ROUNDING`, so `5.2 ROUNDING` would do for exact rays; the tracer widens boxes by 1e-6, and a plane that no box reaches above
/// cannot shadow itself. Gaps narrower than this are jumped over.
const CLEARANCE: f64 = 80.0 * ROUNDING;

/// ... and up to this far towards the faces of the vertex, so that a vertex at the foot of a wall does not stand in the wall's plane. Half as
/// far as outwards.
const INSET: f64 = 0.5 * CLEARANCE;

/// Where faces are so steep about the vertex that no direction leaves all of them at a larger sine than this, the origin goes out as far as
/// for this one: at most `8 (CLEARANCE + INSET)` = 1.4e-5.
const FLATTEST_EXIT: f64 = 0.125;

/// A direction that leaves all faces at this sine is good enough.
const STEEP_EXIT: f64 = 0.5;

/// Steps towards the direction that leaves the faces most steeply; it is needed for few vertices.
const EXIT_STEPS: u32 = 32;

/// For each vertex the origin of its rays, in the frame that the scene is traced in.
pub(crate) fn ray_origins(mesh: &Mesh, scene: &Scene) -> Vec<Vec3> {
    let rounded: Vec<Vec3> =
        mesh.positions().iter().map(|&position| scene.to_unit_cube(DVec3::from_array(position))).collect();
    let corners = Corners::new(mesh);
    let mut fan = Fan::default();
    let origin = |(vertex, normal): (usize, &[f32; 3])| {
        fan.collect(corners.of(vertex), mesh.triangles(), &rounded);
        (rounded[vertex].as_dvec3() + fan.offset(Vec3::from_array(*normal).as_dvec3())).as_vec3()
    };
    mesh.normals().iter().enumerate().map(origin).collect()
}

/// The corners of faces at each vertex.
#[derive(Debug)]
struct Corners {
    /// Where those of each vertex begin in `corners`, and the end of the last.
    starts: Vec<usize>,
    /// `3 * face + k`.
    corners: Vec<usize>,
}

impl Corners {
    fn new(mesh: &Mesh) -> Self {
        let mut starts = vec![0; mesh.positions().len() + 1];
        let vertices = mesh.triangles().as_flattened();
        vertices.iter().for_each(|&vertex| starts[vertex as usize + 1] += 1);
        (1..starts.len()).for_each(|vertex| starts[vertex] += starts[vertex - 1]);
        let (mut next, mut corners) = (starts.clone(), vec![0; vertices.len()]);
        for (corner, &vertex) in vertices.iter().enumerate() {
            corners[next[vertex as usize]] = corner;
            next[vertex as usize] += 1;
        }
        Self { starts, corners }
    }

    fn of(&self, vertex: usize) -> &[usize] {
        &self.corners[self.starts[vertex]..self.starts[vertex + 1]]
    }
}

/// A point of a face keeps this far from its edges, or from all three alike if the face is smaller: 1e-5. So a point on the edge of a fold
/// with as little as 8° of air between the faces still lies in front of both.
const EDGE_INSET: f64 = 8.0 * CLEARANCE;

/// Where the rays of a point of a face start, in the frame that the scene is traced in.
///
/// - `weights`: of the corners, at the point
pub(crate) fn face_origin(scene: &Scene, corners: [DVec3; 3], weights: [f64; 3], shading_normal: DVec3) -> Vec3 {
    let [a, b, c] = corners.map(|corner| scene.to_unit_cube(corner).as_dvec3());
    let normal = unit_vector(unit_vector(b - a).cross(unit_vector(c - a)));
    let outward = if normal.dot(shading_normal) < 0.0 { -normal } else { normal };
    let doubled_area = (b - a).cross(c - a).length();
    let heights = [c - b, a - c, b - a].map(|edge| doubled_area / edge.length());
    let kept = [0, 1, 2].map(|k| weights[k].max((EDGE_INSET / heights[k]).min(1.0 / 3.0)));
    let point = (kept[0] * a + kept[1] * b + kept[2] * c) / kept.iter().sum::<f64>();
    (point + CLEARANCE * outward).as_vec3()
}

/// The faces around a vertex.
#[derive(Debug, Default)]
struct Fan {
    /// Unit normals.
    normals: Vec<DVec3>,
    /// Sum of the normals, weighted by the faces' angle at the vertex.
    mean: DVec3,
    /// Mean of the unit vectors towards the faces' centres.
    inward: DVec3,
}

impl Fan {
    fn collect(&mut self, corners: &[usize], triangles: &[[u32; 3]], rounded: &[Vec3]) {
        self.normals.clear();
        (self.mean, self.inward) = (DVec3::ZERO, DVec3::ZERO);
        for &corner in corners {
            let (k, triangle) = (corner % 3, triangles[corner / 3]);
            let [p, q, r] = [k, (k + 1) % 3, (k + 2) % 3].map(|k| rounded[triangle[k] as usize].as_dvec3());
            self.add_face(q - p, r - p);
        }
        self.inward /= corners.len().max(1) as f64;
    }

    /// A face whose edges leave the vertex along `q` and `r`. Without area it has no side, and occludes nothing.
    fn add_face(&mut self, q: DVec3, r: DVec3) {
        let normal = unit_vector(unit_vector(q).cross(unit_vector(r)));
        if normal != DVec3::ZERO {
            self.normals.push(normal);
            self.mean += normal * q.angle_between(r);
        }
        self.inward += unit_vector(q + r);
    }

    /// Out of the faces, on the side that the shading normal is on.
    fn offset(&mut self, shading_normal: DVec3) -> DVec3 {
        if self.mean.dot(shading_normal) < 0.0 {
            self.mean = -self.mean;
            self.normals.iter_mut().for_each(|normal| *normal = -*normal);
        }
        let outward = self.exit(self.mean.normalize_or(shading_normal));
        let inset = INSET * (2.0 * self.inward.reject_from(outward)).clamp_length_max(1.0);
        let height = (CLEARANCE + inset.length()) / self.sine(outward).max(FLATTEST_EXIT);
        height * outward + inset
    }

    /// Least sine of the angle between a direction and the faces; negative if it leads behind one.
    fn sine(&self, direction: DVec3) -> f64 {
        self.normals.iter().map(|normal| normal.dot(direction)).fold(1.0, f64::min)
    }

    /// A direction that leaves all faces steeply, if there is one: the start, unless it is too flat; then the centre of the smallest cap
    /// around the normals, approached by steps towards the farthest of them (Bădoiu and Clarkson 2003).
    fn exit(&self, start: DVec3) -> DVec3 {
        let (mut center, mut best) = (start, start);
        for step in 0..EXIT_STEPS {
            let Some(farthest) = self.normals.iter().copied().min_by(|a, b| a.dot(center).total_cmp(&b.dot(center)))
            else {
                break;
            };
            if farthest.dot(center) >= STEEP_EXIT {
                return center;
            }
            center = (center + (farthest - center) / f64::from(step + 2)).normalize_or(start);
            best = if self.sine(center) > self.sine(best) { center } else { best };
        }
        best
    }
}
