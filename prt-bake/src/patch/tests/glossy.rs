//! Glossy rows beside the diffuse one, and beside sums over many directions.

use std::f64::consts::PI;

use glam::DVec3;

use super::*;

/// `cos θ/π` as an expansion of order 2: on the upper hemisphere it is the diffuse response.
fn cosine() -> Vec<f64> {
    vec![0.0, 0.0, (4.0 * PI / 3.0).sqrt() / PI, 0.0]
}

#[test]
fn the_cosine_as_a_response_is_diffuse_transfer() {
    let field = rough(5, 4, 0.3, 8);
    for (shadowed, bounces) in [(false, 0), (true, 0), (true, 1), (true, 3)] {
        let diffuse = PatchOptions { shadowed, bounces, albedo: [0.9, 0.5, 0.2], ..options(5, 2048) };
        let glossy = PatchOptions { responses: vec![cosine(), vec![0.1], cosine()], ..diffuse.clone() };
        let (expected, found) = (bake(&field, &diffuse), bake(&field, &glossy));
        assert_eq!((found.rows, found.channels), (3, expected.channels));
        for texel in 0..field.texel_count() {
            for (row, channel) in [(0, 0), (0, 2), (2, 1)] {
                let (a, b) = (found.vector(texel, row, channel), expected.vector(texel, 0, channel));
                // Without shadows both are exact; with them the weights of the rays are scaled to add up to 1 in one of the two.
                let limit = if shadowed { 2e-3 } else { 1e-6 };
                assert!(
                    relative_difference(a, b) < limit,
                    "{shadowed} {bounces} {texel}: {}",
                    relative_difference(a, b)
                );
            }
        }
    }
}

#[test]
fn rows_are_integrals_over_the_hemisphere_of_the_micro_surface() {
    let field = rough(3, 2, 0.3, 21);
    let response: Vec<f64> = (0..16).map(|i| 0.3 - 0.05 * f64::from(i)).collect();
    let options = PatchOptions { responses: vec![vec![0.5], response.clone()], shadowed: false, ..options(6, 16) };
    let transfer = bake(&field, &options);
    let directions = sh_core::fibonacci(100_000);
    for texel in 0..field.texel_count() {
        let normal = glam::Vec3::from_array(field.normal(texel)).as_dvec3();
        let x = (DVec3::X - normal * normal.x).normalize();
        let y = normal.cross(x);
        let (mut local, mut basis) = (vec![0.0; 16], vec![0.0; 36]);
        let mut expected = vec![0.0; 36];
        for s in directions.iter().map(|&s| DVec3::from_array(s)).filter(|s| s.dot(normal) > 0.0) {
            sh_core::eval(order(4), [s.dot(x), s.dot(y), s.dot(normal)], &mut local);
            sh_core::eval(order(6), s.to_array(), &mut basis);
            let weight = 4.0 * PI / 100_000.0 * sh_core::dot(&response, &local);
            expected.iter_mut().zip(&basis).for_each(|(sum, y)| *sum += weight * y);
        }
        for (found, expected) in transfer.vector(texel, 1, 0).iter().zip(&expected) {
            // The sum of 100,000 directions over a cut hemisphere; measured 3.1e-4.
            assert!((f64::from(*found) - expected).abs() < 1e-3, "{found} {expected}");
        }
    }
}

#[test]
fn shadows_take_from_a_row_what_the_relief_covers() {
    // A constant response counts the open solid angle: beside other directions against the mesh of 9 × 9 tiles.
    let field = rough(4, 4, 0.4, 2);
    let transfer = bake(&field, &PatchOptions { responses: vec![vec![1.0 / (4.0 * PI).sqrt()]], ..options(1, 8192) });
    let scene = crate::Scene::new(&crate::Mesh::new(field.mesh([9, 9]), &crate::MeshOptions::default()).unwrap().0);
    let directions: Vec<_> =
        sh_core::fibonacci(16_384).into_iter().map(|s| DVec3::from_array(s).as_vec3()).filter(|s| s.z > 0.0).collect();
    let mut occluded = vec![false; directions.len()];
    for texel in 0..16 {
        let normal = glam::Vec3::from_array(field.normal(texel));
        let [x, y, z] = field.position(texel);
        scene.occluded([x + 4.0, y + 4.0, z + 1e-4], &directions, &mut occluded);
        let open = directions.iter().zip(&occluded).filter(|(s, occluded)| s.dot(normal) > 0.0 && !**occluded).count();
        // ψ = 1/(4π): white light gives the open share of the sphere.
        let (expected, found) = (open as f64 / 16_384.0, white(transfer.vector(texel, 0, 0)));
        assert!((found - expected).abs() < 2e-3, "{texel}: {found} {expected}");
    }
}
