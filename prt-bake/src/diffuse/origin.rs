//! Where the rays of a vertex start.
//!
//! A vertex lies in the planes of its own faces, so its rays start a little outside of them: far enough that no rounding puts the origin
//! behind a face, and no farther, so that nothing thin is jumped over. In the frame that is traced in coordinates are at most 1/2,
//! and rounding one to `f32` moves it by at most [`ROUNDING`]. The side of a face is taken from its rounded corners, in `f64`: seen from
//! them the vertex is exact, and what is left is the rounding of the origin itself.
//!
//! Measured: the occluded share of meshes against [`CLEARANCE`] in units of [`ROUNDING`], with half of it as [`INSET`] and 512 directions.
//! Above it are self-shadows, below it what was jumped over.
//!
//! | mesh | 1 | 4 | 16 | 64 | 256 | 2,048 |
//! |---|---|---|---|---|---|---|
//! | `stanford_bunny` | 0.15926 | 0.15926 | 0.15925 | 0.15922 | 0.15910 | 0.15799 |
//! | `camelhead` | 0.17599 | 0.17599 | 0.17598 | 0.17597 | 0.17576 | 0.17537 |
//! | `utah_teapot` | 0.20011 | 0.20028 | 0.20027 | 0.20025 | 0.20021 | 0.19985 |
//! | `lilium` | 0.05826 | 0.05827 | 0.05827 | 0.05827 | 0.05825 | 0.05814 |

use glam::{DVec3, Vec3};

use crate::mesh::unit_vector;
use crate::{Mesh, Scene};

/// Largest error of a coordinate that is rounded to `f32` in a cube of side 1 around the origin: half a unit in the last place below 1/2.
const ROUNDING: f64 = 1.0 / (1 << 26) as f64;

/// The origin is this far outside of the planes of the faces of its vertex: 2.4e-7. Position, origin and a coplanar neighbour are each off by
/// at most `√3 ROUNDING` = 2.6e-8, together 5.2 `ROUNDING`; three times that. Gaps narrower than this are jumped over.
const CLEARANCE: f64 = 16.0 * ROUNDING;

/// ... and up to this far towards the faces of the vertex, so that a vertex at the foot of a wall does not stand in the wall's plane: more
/// than the roundings of the wall, the vertex and the origin.
const INSET: f64 = 0.5 * CLEARANCE;

/// Where faces are so steep about the vertex that no direction leaves all of them at a larger sine than this, the origin goes out as far as
/// for this one: at most `8 (CLEARANCE + INSET)` = 2.9e-6.
const FLATTEST_EXIT: f64 = 0.125;

/// A direction that leaves all faces at this sine is good enough.
const STEEP_EXIT: f64 = 0.5;

/// Steps towards the direction that leaves the faces most steeply; it is needed for few vertices.
const EXIT_STEPS: u32 = 32;

/// For each vertex the origin of its rays, in the frame of [`Scene::to_unit_cube`].
#[must_use]
pub fn ray_origins(mesh: &Mesh, scene: &Scene) -> Vec<Vec3> {
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

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]

    use proptest::prelude::*;

    use super::*;
    use crate::{MeshOptions, MeshSource};

    /// Faces from a vertex to points around it, in the corner of a scene where rounding is largest.
    fn fan(tip: DVec3, around: &[DVec3]) -> Mesh {
        let mut positions = vec![tip.to_array(), [-0.5; 3], [-0.5, -0.5, -0.49], [-0.5, -0.49, -0.5]];
        positions.extend(around.iter().map(|point| point.to_array()));
        let mut triangles: Vec<[u32; 3]> = (4..positions.len() as u32 - 1).map(|k| [0, k, k + 1]).collect();
        triangles.push([1, 2, 3]);
        // One smooth vertex, however the faces turn about it.
        let mut normals = vec![[0.0; 3]; positions.len()];
        normals[0] = [0.0, 0.0, 1.0];
        Mesh::new(MeshSource { positions, normals, triangles, ..MeshSource::default() }, &MeshOptions::default())
            .unwrap()
            .0
    }

    proptest! {
        #[test]
        fn the_origin_is_outside_of_all_faces_and_near(
            at in prop::array::uniform3(0.4..0.499_f64),
            size in (-20..-4).prop_map(|exponent| 2.0_f64.powi(exponent)),
            points in prop::collection::vec((0.1..1.0_f64, -0.9..0.9_f64), 3..9),
        ) {
            // Points run around the tip once, at any height: up to 42 degrees above and below.
            let tip = DVec3::from_array(at);
            let count = points.len() as f64 - 1.0;
            let around: Vec<DVec3> = points.iter().zip(0..).map(|(&(radius, slope), k)| {
                let angle = std::f64::consts::TAU * f64::from(k) / count;
                tip + size * radius * DVec3::new(angle.cos(), angle.sin(), slope)
            }).collect();
            let mesh = fan(tip, &around);
            let scene = Scene::new(&mesh);
            let origin = ray_origins(&mesh, &scene)[0].as_dvec3();
            let rounded = |vertex: u32| scene.to_unit_cube(DVec3::from_array(mesh.positions()[vertex as usize])).as_dvec3();
            let offset = origin - rounded(0);
            prop_assert!(offset.length() <= (CLEARANCE + INSET) / FLATTEST_EXIT + INSET + 2.0 * ROUNDING);
            let normals = mesh.triangles().iter().filter(|triangle| triangle[0] == 0).map(|&[a, b, c]| {
                (rounded(b) - rounded(a)).cross(rounded(c) - rounded(a)).normalize()
            });
            let mut fan = Fan { normals: normals.clone().filter(|normal| normal.is_finite()).collect(), ..Fan::default() };
            let exit = fan.exit(normals.clone().filter(|normal| normal.is_finite()).sum::<DVec3>().normalize_or(DVec3::Z));
            let sine = fan.sine(exit);
            fan.normals.retain(|normal| normal.dot(offset) < CLEARANCE - 2.0 * ROUNDING);
            // Where a direction leaves all faces, the origin keeps its distance from all of their planes but for its own rounding.
            prop_assert!(sine < 0.2 || fan.normals.is_empty(), "{} {:?}", sine, fan.normals);
        }
    }

    #[test]
    fn the_foot_of_a_wall_is_left_on_the_side_of_the_floor() {
        // A strip of floor that ends at x = 0: its end goes up and inwards, its middle only up.
        let mut source = MeshSource::default();
        for i in 0..3_u32 {
            source.positions.extend([[f64::from(i), 0.0, 0.0], [f64::from(i), 1.0, 0.0]]);
        }
        source.triangles = vec![[0, 2, 3], [0, 3, 1], [2, 4, 5], [2, 5, 3]];
        let mesh = Mesh::new(source, &MeshOptions::default()).unwrap().0;
        let scene = Scene::new(&mesh);
        let offsets: Vec<DVec3> = ray_origins(&mesh, &scene)
            .iter()
            .zip(mesh.positions())
            .map(|(origin, &position)| origin.as_dvec3() - scene.to_unit_cube(DVec3::from_array(position)).as_dvec3())
            .collect();
        assert!(offsets[..2].iter().all(|offset| offset.x > 0.25 * INSET), "{offsets:?}");
        assert!(offsets[4..].iter().all(|offset| offset.x < -0.25 * INSET), "{offsets:?}");
        assert!(offsets.iter().all(|offset| offset.z >= CLEARANCE - ROUNDING), "{offsets:?}");
    }
}
