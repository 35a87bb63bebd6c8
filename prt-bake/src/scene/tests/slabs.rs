//! Slabs leave out no ray that meets a triangle, and leave out others.

use glam::Vec3;

use super::{Random, random_direction};
use crate::scene::slab::Slab;

/// Triangles near a tilted plane, about as far from it as the leaf of a scanned surface.
fn patch(random: &mut Random, normal: Vec3) -> Vec<[Vec3; 3]> {
    let center = 0.3 * random_direction(random);
    let (u, v) = normal.any_orthonormal_pair();
    let mut corner = || {
        let [x, y, z] = [0; 3].map(|_| random.unit() as f32 - 0.5);
        center + 0.1 * x * u + 0.1 * y * v + 0.005 * z * normal
    };
    (0..8)
        .map(|_| {
            let [a, b, c] = [corner(), corner(), corner()];
            if (b - a).cross(c - a).dot(normal) < 0.0 { [a, c, b] } else { [a, b, c] }
        })
        .collect()
}

#[test]
fn a_slab_holds_every_point_of_its_triangles_for_rays_that_end_there() {
    let mut random = Random::new(51);
    for _ in 0..200 {
        let normal = random_direction(&mut random);
        let triangles = patch(&mut random, normal);
        let slab = Slab::new(triangles.iter().copied());
        for [a, b, c] in triangles {
            let (s, t) = (random.unit() as f32, random.unit() as f32);
            for target in [a, b, a.lerp(b, s), a.lerp(b, s).lerp(c, t)] {
                let origin = 0.8 * random_direction(&mut random);
                let (direction, distance) = ((target - origin).normalize(), target.distance(origin));
                // The point alone, and with what lies around it in a box.
                assert!(slab.from(origin).holds_some_of(direction, [distance, distance]));
                assert!(slab.from(origin).holds_some_of(direction, [0.9 * distance, 1.1 * distance]));
            }
        }
    }
}

#[test]
fn rays_beside_a_slab_are_left_out() {
    let mut random = Random::new(52);
    for _ in 0..200 {
        let normal = random_direction(&mut random);
        let triangles = patch(&mut random, normal);
        let middle = triangles.iter().flatten().sum::<Vec3>() / 24.0;
        let slab = Slab::new(triangles.into_iter());
        let (along, _) = normal.any_orthonormal_pair();
        for side in [-1.0, 1.0] {
            // The mean normal leaves that of the plane by about the roughness, 0.05, over a patch of 0.1.
            let origin = middle - 0.2 * along + 0.06 * side * normal;
            assert!(!slab.from(origin).holds_some_of(along, [0.1, 0.3]));
            assert!(slab.from(origin).holds_some_of((middle - origin).normalize(), [0.1, 0.3]));
        }
    }
}
