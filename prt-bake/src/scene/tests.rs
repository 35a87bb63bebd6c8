#![expect(clippy::unwrap_used, reason = "tests")]

use glam::{DVec3, Vec3};

use super::*;
use crate::sampling::Random;
use crate::{MeshOptions, MeshSource};

mod materials;
mod same_answers;
mod slabs;

fn mesh(positions: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> Mesh {
    Mesh::new(MeshSource { positions, triangles, ..MeshSource::default() }, &MeshOptions::default()).unwrap().0
}

fn random_direction(random: &mut Random) -> Vec3 {
    loop {
        let v = DVec3::new(random.unit(), random.unit(), random.unit()) * 2.0 - 1.0;
        if (0.01..1.0).contains(&v.length_squared()) {
            return v.normalize().as_vec3();
        }
    }
}

/// Small triangles in all positions, and the tests that no tree can spoil.
fn soup(seed: u64, count: u32) -> Mesh {
    let mut random = Random::new(seed);
    let mut positions = Vec::new();
    for _ in 0..count {
        let center = DVec3::new(random.unit(), random.unit(), random.unit());
        for _ in 0..3 {
            positions.push((center + 0.2 * random_direction(&mut random).as_dvec3()).to_array());
        }
    }
    mesh(positions, (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

/// Möller and Trumbore's test in `f64`, on every triangle: another formula and no tree.
fn brute_force(mesh: &Mesh, origin: DVec3, direction: DVec3) -> Option<(u32, f64)> {
    let hit = |(number, triangle): (u32, &[u32; 3])| {
        let [a, b, c] = triangle.map(|vertex| DVec3::from_array(mesh.positions()[vertex as usize]));
        let p = direction.cross(c - a);
        let determinant = p.dot(b - a);
        let u = p.dot(origin - a) / determinant;
        let q = (origin - a).cross(b - a);
        let (v, t) = (q.dot(direction) / determinant, q.dot(c - a) / determinant);
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some((number, t))
    };
    (0..).zip(mesh.triangles()).filter_map(hit).min_by(|a, b| a.1.total_cmp(&b.1))
}

#[test]
fn packets_find_what_brute_force_finds() {
    let mesh = soup(1, 300);
    let scene = Scene::new(&mesh);
    let mut random = Random::new(2);
    let (mut rays, mut differences, mut hits) = (0, 0, 0);
    for _ in 0..200 {
        let origin = DVec3::new(random.unit(), random.unit(), random.unit());
        // Wide packets, narrow ones, and ones that are not full.
        let axis = random_direction(&mut random);
        let spread = random.unit() as f32;
        let count = 1 + (random.next() % 64) as usize;
        let directions: Vec<Vec3> =
            (0..count).map(|_| (axis + spread * random_direction(&mut random)).normalize()).collect();
        let mut occluded = vec![false; count];
        let mut closest = vec![None; count];
        scene.occluded(origin.to_array(), &directions, &mut occluded);
        scene.closest(origin.to_array(), &directions, &mut closest);
        for ((direction, occluded), closest) in directions.iter().zip(occluded).zip(closest) {
            let truth = brute_force(&mesh, origin, direction.as_dvec3().normalize());
            rays += 1;
            hits += usize::from(truth.is_some());
            let is_same = match (truth, closest) {
                (Some((number, t)), Some(hit)) => {
                    occluded && hit.triangle == number && (hit.distance - t).abs() <= 1e-4 * t.max(0.01)
                }
                (None, None) => !occluded,
                _ => false,
            };
            differences += usize::from(!is_same);
        }
    }
    // A ray within the rounding of f32, about 1e-6, of an edge may fall on either side of it: with edges of 300 triangles in view,
    // of the order of 1e-4 of all rays.
    assert!(hits > rays / 5 && hits < rays, "{hits} of {rays}");
    assert!(differences as f64 <= 1e-3 * rays as f64, "{differences} of {rays}");
}

#[test]
fn no_ray_leaves_a_closed_box_at_any_scale() {
    let corner = |i: u32| [f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)];
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles: Vec<[u32; 3]> = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    for (scale, offset) in [(1.0, 0.0), (1e-6, 0.0), (1e6, 0.0), (1.0, 1e6), (3.7e-5, 11.0)] {
        let positions = (0..8).map(|i| corner(i).map(|x| x * scale + offset)).collect();
        let scene = Scene::new(&mesh(positions, triangles.clone()));
        let mut random = Random::new(3);
        for _ in 0..100 {
            let origin = [0; 3].map(|_| (0.01 + 0.98 * random.unit()) * scale + offset);
            // Through the very edges and corners as well as anywhere.
            let targets = (0..12).map(|k| corner(k % 8).map(|x| x * scale + offset));
            let mut directions: Vec<Vec3> = targets
                .map(|target| (DVec3::from_array(target) - DVec3::from_array(origin)).normalize().as_vec3())
                .collect();
            directions.extend((0..200).map(|_| random_direction(&mut random)));
            directions.extend([Vec3::X, Vec3::NEG_Y, Vec3::Z, Vec3::new(0.0, -0.0, -1.0)]);
            let mut occluded = vec![false; directions.len()];
            scene.occluded(origin, &directions, &mut occluded);
            let mut hits = vec![None; directions.len()];
            scene.closest(origin, &directions, &mut hits);
            for ((direction, occluded), hit) in directions.iter().zip(occluded).zip(hits) {
                assert!(occluded, "scale {scale} offset {offset}: light along {direction} from {origin:?}");
                assert!(!hit.unwrap().is_front, "the inside of the box is the back of its faces");
            }
        }
    }
}

#[test]
fn hits_say_where_and_on_which_side() {
    let scene = Scene::new(&mesh(vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]], vec![[0, 1, 2]]));
    let mut hits = [None; 2];
    scene.closest([1.0, 2.0, 3.0], &[Vec3::NEG_Z, Vec3::Z], &mut hits);
    let hit = hits[0].unwrap();
    assert!((hit.distance - 3.0).abs() < 1e-6 && hit.is_front && hit.triangle == 0, "{hit:?}");
    assert!((hit.barycentric[0] - 0.25).abs() < 1e-6 && (hit.barycentric[1] - 0.5).abs() < 1e-6, "{hit:?}");
    assert_eq!(hits[1], None);
    scene.closest([1.0, 2.0, -3.0], &[Vec3::Z], &mut hits[..1]);
    assert!(!hits[0].unwrap().is_front);
}

#[test]
fn a_plane_does_not_occlude_itself() {
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..=20_u32 {
        for j in 0..=20_u32 {
            positions.push([f64::from(i) * 0.37, f64::from(j) * 0.37, 0.0]);
            if i < 20 && j < 20 {
                let a = i * 21 + j;
                triangles.extend([[a, a + 21, a + 22], [a, a + 22, a + 1]]);
            }
        }
    }
    let mesh = mesh(positions, triangles);
    let scene = Scene::new(&mesh);
    let mut random = Random::new(5);
    let directions: Vec<Vec3> = (0..64).map(|_| random_direction(&mut random)).collect();
    for &position in mesh.positions() {
        let mut occluded = [true; 64];
        scene.occluded(position, &directions, &mut occluded);
        assert_eq!(occluded, [false; 64], "at {position:?}");
    }
}

#[test]
fn scaling_by_a_power_of_two_changes_no_bit() {
    let mesh_at = |scale: f64| {
        let source = soup(7, 100);
        let positions = source.positions().iter().map(|p| p.map(|x| x * scale)).collect();
        mesh(positions, source.triangles().to_vec())
    };
    let mut random = Random::new(8);
    let directions: Vec<Vec3> = (0..64).map(|_| random_direction(&mut random)).collect();
    let answers = |scale: f64| {
        let scene = Scene::new(&mesh_at(scale));
        let mut hits = vec![None; 64];
        scene.closest([0.5 * scale; 3], &directions, &mut hits);
        hits.into_iter()
            .map(|hit| hit.map(|hit| (hit.triangle, hit.barycentric, hit.distance / scale)))
            .collect::<Vec<_>>()
    };
    let reference = answers(1.0);
    assert!(reference.iter().flatten().count() > 10);
    for exponent in [-40, -3, 1, 30] {
        assert_eq!(answers(2.0_f64.powi(exponent)), reference, "2^{exponent}");
    }
}
