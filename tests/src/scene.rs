//! Scenes built from patches whose normals are exact.

use glam::DVec3;
use prt_bake::{Error, Mesh, MeshOptions, MeshSource};

/// Collects patches into one mesh.
#[derive(Debug, Clone, Default)]
pub struct SceneBuilder {
    source: MeshSource,
}

impl SceneBuilder {
    /// Adds vertices and faces of one albedo. `vertices` are position and normal; `triangles` count from the first of them.
    #[must_use]
    pub fn add(mut self, (vertices, triangles): (Vec<[DVec3; 2]>, Vec<[u32; 3]>), albedo: [f32; 3]) -> Self {
        let first = u32::try_from(self.source.positions.len()).expect("small scenes");
        for [position, normal] in vertices {
            self.source.positions.push(position.to_array());
            self.source.normals.push(normal.as_vec3().to_array());
            self.source.albedo.push(albedo);
        }
        self.source.triangles.extend(triangles.iter().map(|triangle| triangle.map(|vertex| vertex + first)));
        self
    }

    /// The mesh of all patches.
    ///
    /// # Errors
    /// If nothing usable was added.
    pub fn build(self) -> Result<Mesh, Error> {
        Ok(Mesh::new(self.source, &MeshOptions::default())?.0)
    }
}

/// A parallelogram of `cells²` cells from `corner` along `u` and `v`; it faces along `u × v`.
#[must_use]
pub fn grid(corner: DVec3, u: DVec3, v: DVec3, cells: u32) -> (Vec<[DVec3; 2]>, Vec<[u32; 3]>) {
    let normal = u.cross(v).normalize();
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..=cells {
        for j in 0..=cells {
            let [s, t] = [i, j].map(|k| f64::from(k) / f64::from(cells));
            vertices.push([corner + s * u + t * v, normal]);
            if i < cells && j < cells {
                let a = i * (cells + 1) + j;
                triangles.extend([[a, a + cells + 1, a + cells + 2], [a, a + cells + 2, a + 1]]);
            }
        }
    }
    (vertices, triangles)
}

/// A disk around `center` that faces along the unit vector `normal`: `rings` rings of six times their number of vertices. Its rim is
/// moved outwards so that the polygon has the area of the disk.
#[must_use]
pub fn disk(center: DVec3, normal: DVec3, radius: f64, rings: u32) -> (Vec<[DVec3; 2]>, Vec<[u32; 3]>) {
    let (u, v) = normal.any_orthonormal_pair();
    let sides = f64::from(6 * rings);
    let polygon_area = 0.5 * sides * (std::f64::consts::TAU / sides).sin();
    let radius = radius * (std::f64::consts::PI / polygon_area).sqrt();
    let mut vertices = vec![[center, normal]];
    let mut triangles = Vec::new();
    let first_of = |ring: u32| if ring == 0 { 0 } else { 1 + 3 * ring * (ring - 1) };
    for ring in 1..=rings {
        for k in 0..6 * ring {
            let angle = std::f64::consts::TAU * f64::from(k) / f64::from(6 * ring);
            let r = radius * f64::from(ring) / f64::from(rings);
            vertices.push([center + r * (angle.cos() * u + angle.sin() * v), normal]);
            triangles.extend(ring_triangles(ring, k, first_of(ring - 1), first_of(ring)));
        }
    }
    (vertices, triangles)
}

/// The faces between vertex `k` of a ring, the next one, and the ring inside it.
fn ring_triangles(ring: u32, k: u32, inner: u32, outer: u32) -> Vec<[u32; 3]> {
    let inner_count = (6 * (ring - 1)).max(1);
    let (sector, along) = (k / ring, k % ring);
    let inside = |step: u32| inner + (sector * (ring - 1) + step) % inner_count;
    let next = outer + (k + 1) % (6 * ring);
    let mut triangles = vec![[inside(along), outer + k, next]];
    if along + 1 < ring {
        triangles.push([inside(along), next, inside(along + 1)]);
    }
    triangles
}

/// A sphere from an icosahedron whose faces are split in four `splits` times; normals point outwards.
#[must_use]
pub fn icosphere(center: DVec3, radius: f64, splits: u32) -> (Vec<[DVec3; 2]>, Vec<[u32; 3]>) {
    let (mut directions, mut triangles) = icosahedron();
    for _ in 0..splits {
        triangles = split_faces(&mut directions, &triangles);
    }
    (directions.iter().map(|&direction| [center + radius * direction, direction]).collect(), triangles)
}

fn icosahedron() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let g = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut directions = Vec::new();
    for (a, b) in [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)] {
        directions.extend([DVec3::new(a, b, 0.0), DVec3::new(0.0, a, b), DVec3::new(b, 0.0, a)].map(DVec3::normalize));
    }
    // Neighbours are at an angle of about 63 degrees; three of them that are wound outwards are a face.
    let is_edge = |a: usize, b: usize| directions[a].dot(directions[b]) > 0.4 && a != b;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if is_edge(a, b) && is_edge(b, c) && is_edge(c, a) {
                    let is_outward = directions[a].dot(directions[b].cross(directions[c])) > 0.0;
                    let [b, c] = if is_outward { [b, c] } else { [c, b] };
                    triangles.push([a, b, c].map(|vertex| vertex as u32));
                }
            }
        }
    }
    (directions, triangles)
}

fn split_faces(directions: &mut Vec<DVec3>, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut middles = std::collections::HashMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            directions.push((directions[a as usize] + directions[b as usize]).normalize());
            directions.len() as u32 - 1
        })
    };
    let split = |&[a, b, c]: &[u32; 3]| {
        let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    };
    triangles.iter().flat_map(split).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn face_normal(vertices: &[[DVec3; 2]], triangle: [u32; 3]) -> glam::Vec3 {
        let [a, b, c] = triangle.map(|vertex| vertices[vertex as usize][0]);
        (b - a).cross(c - a).normalize().as_vec3()
    }

    #[test]
    fn patches_have_their_area_and_face_the_right_way() {
        use std::f64::consts::PI;
        let area = |vertices: &[[DVec3; 2]], triangles: &[[u32; 3]]| -> f64 {
            let area = |triangle: &[u32; 3]| {
                let [a, b, c] = triangle.map(|vertex| vertices[vertex as usize][0]);
                0.5 * (b - a).cross(c - a).length()
            };
            triangles.iter().map(area).sum()
        };
        let patches = [
            (grid(DVec3::ZERO, 2.0 * DVec3::X, 3.0 * DVec3::Y, 4), 6.0, 1e-12),
            (disk(DVec3::ONE, DVec3::NEG_Y, 2.0, 5), 4.0 * PI, 1e-12),
            // A polyhedron inside the sphere: its area is less by a share of the order of the edge length squared.
            (icosphere(DVec3::ONE, 1.0, 4), 4.0 * PI, 0.03),
        ];
        for ((vertices, triangles), expected, tolerance) in patches {
            assert!((area(&vertices, &triangles) - expected).abs() < tolerance, "{expected}");
            for triangle in triangles {
                let normal = vertices[triangle[0] as usize][1].as_vec3();
                assert!(face_normal(&vertices, triangle).dot(normal) > 0.9);
            }
        }
    }
}
