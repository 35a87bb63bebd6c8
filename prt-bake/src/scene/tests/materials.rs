//! Rays pass through holes, and meet the side of a two-sided face that is turned to them.

use std::sync::Arc;

use super::*;
use crate::{SurfaceMaterial, Texture, TextureMap, TextureWrap, TwoSided};

/// Two squares of side 4 at heights 0 and 1, facing up; the upper one has holes like a chessboard, four squares a side.
fn sieve_over_floor() -> Mesh {
    let square = |z: f64| [[-2.0, -2.0, z], [2.0, -2.0, z], [2.0, 2.0, z], [-2.0, 2.0, z]];
    let positions = [square(0.0), square(1.0)].concat();
    let chessboard = vec![[0, 0, 0, 255], [0; 4], [0; 4], [0, 0, 0, 255]];
    let texture = Arc::new(Texture::new(2, 2, chessboard, [TextureWrap::Repeat; 2]));
    let sieve = SurfaceMaterial {
        alpha_cutoff: Some(0.5),
        texture: Some(TextureMap { scale: [0.5; 2], ..TextureMap::new(texture) }),
        ..SurfaceMaterial::default()
    };
    let source = MeshSource {
        uvs: positions.iter().map(|&[x, y, _]| [x as f32, y as f32]).collect(),
        positions,
        triangles: vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]],
        materials: vec![SurfaceMaterial::default(), sieve],
        face_material: vec![0, 0, 1, 1],
        ..MeshSource::default()
    };
    Mesh::new(source, &MeshOptions::default()).unwrap().0
}

/// Whether the chessboard is there, by the bilinear formula written out.
fn is_there(x: f64, y: f64) -> bool {
    // Texel centres are at odd multiples of 1/2; between two of them alpha is linear.
    let share = |t: f64| {
        let phase = (t - 0.5).rem_euclid(2.0);
        if phase < 1.0 { phase } else { 2.0 - phase }
    };
    let (u, v) = (share(x), share(y));
    (1.0 - u) * (1.0 - v) + u * v >= 0.5
}

#[test]
fn rays_pass_through_holes_and_nothing_else() {
    let mesh = sieve_over_floor();
    let scene = Scene::new(&mesh);
    let mut random = Random::new(11);
    let (mut passed, mut blocked, mut differences) = (0, 0, 0);
    for _ in 0..100 {
        let origin = DVec3::new(random.unit() - 0.5, random.unit() - 0.5, 2.0 + random.unit());
        let directions: Vec<Vec3> = (0..64)
            .map(|_| {
                let target = DVec3::new(3.8 * random.unit() - 1.9, 3.8 * random.unit() - 1.9, 1.0);
                (target - origin).normalize().as_vec3()
            })
            .collect();
        let mut hits = vec![None; 64];
        scene.closest(origin.to_array(), &directions, &mut hits);
        // Of what lies above the floor only: the same rays from below the floor's plane would need another truth.
        for (direction, hit) in directions.iter().zip(hits) {
            let at = origin + direction.as_dvec3() * ((1.0 - origin.z) / f64::from(direction.z));
            let meets_sieve = hit.is_some_and(|hit| hit.triangle >= 2);
            differences += usize::from(meets_sieve != is_there(at.x, at.y));
            *(if meets_sieve { &mut blocked } else { &mut passed }) += 1;
        }
        // Upwards from below the sieve nothing else is in the way.
        let below = DVec3::new(origin.x, origin.y, 0.5);
        let directions: Vec<Vec3> =
            directions.iter().map(|direction| Vec3::new(direction.x, direction.y, -direction.z)).collect();
        let mut occluded = vec![false; 64];
        scene.occluded(below.to_array(), &directions, &mut occluded);
        for (direction, occluded) in directions.iter().zip(occluded) {
            let at = below + direction.as_dvec3() * (0.5 / f64::from(direction.z));
            if at.abs().max_element() < 1.9 {
                differences += usize::from(occluded != is_there(at.x, at.y));
            }
        }
    }
    assert!(passed > 2500 && blocked > 2500, "{passed} {blocked}");
    // A ray may fall on either side of an edge of a hole within the rounding of f32, 1e-6 of the length of edges in view.
    assert!(differences <= 2, "{differences}");
}

#[test]
fn a_scene_without_holes_keeps_nothing_for_them() {
    let opaque = Scene::new(&soup(3, 50));
    assert_eq!(opaque.tree.masks.memory_bytes(), 0);
    assert!(Scene::new(&sieve_over_floor()).tree.masks.memory_bytes() > 0);
}

#[test]
fn a_hit_from_behind_is_a_hit_on_the_twin() {
    let build = |two_sided| {
        let source = MeshSource {
            positions: vec![[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]],
            triangles: vec![[0, 1, 2]],
            ..MeshSource::default()
        };
        Mesh::new(source, &MeshOptions { two_sided, ..MeshOptions::default() }).unwrap().0
    };
    let leaf = build(TwoSided::Always);
    let scene = Scene::new(&leaf);
    for (z, direction, triangle) in [(3.0, Vec3::NEG_Z, 0), (-3.0, Vec3::Z, 1)] {
        let mut hits = [None];
        scene.closest([1.0, 2.0, z], &[direction], &mut hits);
        let hit = hits[0].unwrap();
        assert!(hit.triangle == triangle && hit.is_front, "{hit:?}");
        let [a, b, c] = leaf.triangles()[triangle as usize].map(|v| DVec3::from_array(leaf.positions()[v as usize]));
        let [u, v] = hit.barycentric.map(f64::from);
        let at = a + u * (b - a) + v * (c - a);
        assert!(at.distance(DVec3::new(1.0, 2.0, 0.0)) < 1e-5, "{at}");
    }
    let mut hits = [None];
    Scene::new(&build(TwoSided::Never)).closest([1.0, 2.0, -3.0], &[Vec3::Z], &mut hits);
    assert!(hits[0].is_some_and(|hit| hit.triangle == 0 && !hit.is_front));
}
