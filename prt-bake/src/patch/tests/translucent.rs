//! Translucent relief.

use super::*;
use crate::TransferVectors;

fn sheet(medium: Medium, thickness: f32, rays: usize) -> PatchOptions {
    PatchOptions { scattering: Some(medium), thickness: Some(thickness), ..options(3, rays) }
}

#[test]
fn clear_relief_of_index_one_is_not_there() {
    // Nothing scatters, absorbs or bends: each texel sees the light from below through its outgoing directions, cosine about the
    // true normals of its triangles.
    let field = rough(3, 3, 0.3, 6);
    let medium = Medium { ior: 1.0, ..Medium::grey(0.0, 0.0) };
    let (transfer, report) = bake_patch(&field, &sheet(medium, 0.1, 4096), &()).unwrap();
    let report = report.scattering.unwrap();
    assert!((report.from_above[0] + report.from_below[0] - 1.0).abs() < 1e-12, "{report:?}");
    // A path never turns: it leaves upwards only where its own direction, against the normal of a steep side, points up.
    let mut expected = vec![0.0; 9];
    let (mut sum, parts) = (vec![0.0; 9], 64);
    let surface = surface::Surface::new(&field);
    for (number, vector) in (0..9).map(|texel| (texel, transfer.vector(texel, 0, 0))) {
        expected.fill(0.0);
        for part in 0..parts * parts {
            let offset = [part % parts, part / parts].map(|k| (k as f64 + 0.5) / parts as f64 - 0.5);
            let normal = surface.point_of_texel(number, offset).1.normal;
            crate::transfer::unshadowed_vector(order(3), (-normal).as_vec3().to_array(), &mut sum);
            expected.iter_mut().zip(&sum).for_each(|(e, s)| *e += s / (parts * parts) as f64);
        }
        for (found, expected) in vector.iter().zip(&expected) {
            assert!((f64::from(*found) - expected).abs() < 0.01, "{number}: {found} {expected}");
        }
    }
}

#[test]
fn white_light_on_clear_relief_stays_white() {
    for field in [rough(4, 4, 0.6, 1), HeightField::waffle(16, 0.3).unwrap(), rough(1, 5, 2.0, 3)] {
        for (ior, thickness) in [(1.0, Some(0.02)), (1.5, Some(0.3)), (2.5, Some(0.02)), (1.4, None)] {
            let medium = Medium { ior, g: 0.5, ..Medium::grey(5.0, 0.0) };
            let options = PatchOptions { scattering: Some(medium), thickness, ..options(1, 64) };
            let (transfer, report) = bake_patch(&field, &options, &()).unwrap();
            let report = report.scattering.unwrap();
            assert!(report.given_up[0] < 1e-3, "{ior} {thickness:?}: {report:?}");
            // Each path that is not given up has weight 1; f32 stores it.
            let mean = transfer.values.iter().map(|&value| white(&[value])).sum::<f64>() / field.texel_count() as f64;
            assert!((mean + report.given_up[0] - 1.0).abs() < 1e-6, "{ior} {thickness:?}: {mean} {report:?}");
        }
    }
}

#[test]
fn an_endless_medium_gets_no_light_from_below() {
    let field = HeightField::bumps(8, 0.2).unwrap();
    let (transfer, report) =
        bake_patch(&field, &PatchOptions { order: order(2), rays_per_texel: 256, ..PatchOptions::thick() }, &())
            .unwrap();
    assert_eq!(report.scattering.unwrap().from_below, [0.0]);
    // The mean direction of the light that arrives is up.
    assert!((0..64).all(|texel| transfer.vector(texel, 0, 0)[2] > 0.1));
}

#[test]
fn the_bottom_of_a_waffle_lets_more_light_through_than_its_walls() {
    let field = HeightField::waffle(32, 0.3).unwrap();
    let medium = Medium::grey(20.0, 2.0);
    let (transfer, report) = bake_patch(&field, &sheet(medium, 0.02, 512), &()).unwrap();
    let mut below = vec![0.0; 9];
    sh_core::hemisphere_light(order(3), [0.0, 0.0, -1.0], 1.0, 0.0, &mut below);
    let through = |texel: usize| {
        let vector = transfer.vector(texel, 0, 0);
        vector.iter().zip(&below).map(|(&t, l)| f64::from(t) * l).sum::<f64>()
    };
    let mean = |is_wall: bool| {
        let texels: Vec<usize> = (0..1024).filter(|&texel| (field.heights()[texel] > 0.25) == is_wall).collect();
        texels.iter().map(|&texel| through(texel)).sum::<f64>() / texels.len() as f64
    };
    assert!(mean(false) > 2.0 * mean(true), "{} {}", mean(false), mean(true));
    assert!(report.scattering.unwrap().from_below[0] > 0.05);
}

#[test]
fn channels_are_those_of_their_own_coefficients() {
    let field = HeightField::bumps(4, 0.2).unwrap();
    let colored = Medium { sigma_s: [40.0, 20.0, 5.0], sigma_a: [0.1, 1.0, 5.0], ..Medium::default() };
    let all = bake(&field, &sheet(colored, 0.1, 512));
    assert_eq!(all.channels, 3);
    for channel in 0..3 {
        let own = Medium { ior: 1.3, ..Medium::grey(colored.sigma_s[channel], colored.sigma_a[channel]) };
        let grey = bake(&field, &sheet(own, 0.1, 512));
        assert_eq!(grey.channels, 1);
        for texel in 0..16 {
            assert_eq!(all.vector(texel, 0, channel), grey.vector(texel, 0, 0), "{texel} {channel}");
        }
    }
}

#[test]
fn the_halves_tell_the_error() {
    let field = HeightField::bumps(8, 0.2).unwrap();
    let run =
        |rays, seed| bake_patch(&field, &PatchOptions { seed, ..sheet(Medium::default(), 0.1, rays) }, &()).unwrap();
    let (truth, _) = run(8192, 5);
    let unshadowed = TransferVectors::unshadowed(order(3), &truth.normals);
    let length = |values: &[f32]| values.iter().map(|&v| f64::from(v).powi(2)).sum::<f64>().sqrt();
    for rays in [64, 256] {
        let (found, report) = run(rays, 0);
        let measured =
            relative_difference(&found.values, &truth.values) * length(&truth.values) / length(&unshadowed.values);
        let estimated = report.error.unwrap();
        assert!(measured > 0.8 * estimated && measured < 1.25 * estimated, "{rays}: {measured} {estimated}");
    }
    assert_eq!(run(1, 0).1.error, None);
}

#[test]
fn extreme_media_are_finite() {
    for (sigma_s, sigma_a) in [(0.0, 0.0), (1e6, 1e6), (1e-30, 0.0), (0.0, 1e6), (1e6, 1e-6), (1.0, 1e-30)] {
        for g in [-0.99, 0.0, 1e-8, 0.99] {
            for (ior, thickness) in [(1.0, None), (2.5, Some(1e-6)), (0.25, Some(1e3)), (4.0, None)] {
                let medium = Medium { g, ior, ..Medium::grey(sigma_s, sigma_a) };
                let field = rough(2, 1, 0.5, 1);
                let options = PatchOptions { thickness, scattering: Some(medium), ..options(2, 2) };
                let (transfer, report) = bake_patch(&field, &options, &()).unwrap();
                assert!(transfer.values.iter().all(|value| value.is_finite()), "{options:?}");
                let report = report.scattering.unwrap();
                let sum = report.from_above[0] + report.from_below[0] + report.given_up[0];
                assert!(sum.is_finite() && sum >= 0.0, "{options:?}: {report:?}");
            }
        }
    }
}
