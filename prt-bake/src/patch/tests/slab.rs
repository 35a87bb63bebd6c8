//! Random walks in plane slabs, beside exact and published results.

use glam::DVec3;

use super::*;
use crate::patch::surface::Surface;
use crate::patch::walk::{End, Walk};
use crate::sampling::Random;
use crate::transfer::unshadowed_vector;

/// Uniform light on a plane slab: what comes back, what comes through, what was given up.
fn slab(medium: Medium, thickness: Option<f32>, paths: usize) -> [f64; 3] {
    // Height 0, so that the thickness is that of the slab.
    let field = HeightField::new(1, 1, vec![0.0]).unwrap();
    let options = PatchOptions { scattering: Some(medium), thickness, ..options(1, paths) };
    let report = bake_patch(&field, &options, &()).unwrap().1.scattering.unwrap();
    [report.from_above[0], report.from_below[0], report.given_up[0]]
}

/// What comes back and through of a beam that falls on a plane slab at right angles, and what was given up.
fn beam(medium: Medium, thickness: Option<f32>, paths: usize) -> [f64; 3] {
    let field = HeightField::new(1, 1, vec![0.0]).unwrap();
    let surface = Surface::new(&field);
    let walk = Walk::new(&surface, &medium, 0, thickness, 1 << 20);
    let mut random = Random::new(1);
    let mut sums = [0.0; 3];
    for _ in 0..paths {
        let (position, point) = surface.point_of_texel(0, [0.2, 0.1]);
        let path = walk.follow(position, &point, DVec3::NEG_Z, &mut random);
        match path.end {
            End::Above(_) => sums[0] += path.weight,
            End::Below(_) => sums[1] += path.weight,
            End::GivenUp => sums[2] += path.weight,
            End::Lost => (),
        }
    }
    sums.map(|sum| sum / paths as f64)
}

fn medium(sigma_s: f32, sigma_a: f32, g: f32, ior: f32) -> Medium {
    Medium { g, ior, ..Medium::grey(sigma_s, sigma_a) }
}

/// Mean over directions of uniform incident light, `2 ∫ f(μ) μ dμ`, by the midpoint rule.
fn flux(f: impl Fn(f64) -> f64) -> f64 {
    let count = 4000;
    (0..count).map(|k| (f64::from(k) + 0.5) / f64::from(count)).map(|mu| 2.0 * f(mu) * mu / f64::from(count)).sum()
}

/// Chandrasekhar's H function for isotropic scattering of the given albedo: `R(μ) = 1 − √(1−a) H(μ)` of a half space.
///
/// Source: S. Chandrasekhar, Radiative Transfer, 1950, chapter V: `1/H(μ) = √(1−a) + a/2 ∫ μ′ H(μ′)/(μ + μ′) dμ′`.
fn h_function(albedo: f64) -> impl Fn(f64) -> f64 {
    const COUNT: usize = 400;
    // Nodes squeezed towards 0, where H is steep.
    let nodes: Vec<(f64, f64)> =
        (0..COUNT).map(|k| (k as f64 + 0.5) / COUNT as f64).map(|t| (t * t, 2.0 * t / COUNT as f64)).collect();
    let mut values = vec![1.0; COUNT];
    let next = move |values: &[f64], mu: f64| {
        let integral: f64 = nodes.iter().zip(values).map(|(&(node, weight), h)| weight * node * h / (mu + node)).sum();
        1.0 / ((1.0 - albedo).sqrt() + 0.5 * albedo * integral)
    };
    for _ in 0..200 {
        values = (0..COUNT).map(|k| next(&values, ((k as f64 + 0.5) / COUNT as f64).powi(2))).collect();
    }
    move |mu| next(&values, mu)
}

#[test]
fn the_h_function_has_its_known_integral() {
    // Chandrasekhar, chapter V, theorem 1: a/2 ∫ H = 1 − √(1−a).
    for albedo in [0.5, 0.9, 0.99] {
        let h = h_function(albedo);
        let integral: f64 = (0..2000).map(|k| h((f64::from(k) + 0.5) / 2000.0) / 2000.0).sum();
        assert!((0.5 * albedo * integral - 1.0 + f64::sqrt(1.0 - albedo)).abs() < 1e-4, "{albedo}: {integral}");
    }
}

#[test]
fn a_half_space_reflects_what_the_h_function_says() {
    // 0.999 and 0.99 jump, 0.9 and 0.5 do not.
    for (albedo, paths) in [(0.5, 50_000), (0.9, 50_000), (0.99, 50_000), (0.999, 50_000)] {
        let h = h_function(albedo);
        let reflectance = |mu: f64| 1.0 - (1.0 - albedo).sqrt() * h(mu);
        let medium = medium(50.0 * albedo as f32, 50.0 * (1.0 - albedo) as f32, 0.0, 1.0);
        let [diffuse, ..] = slab(medium, None, paths);
        // One standard deviation is 2e-3 at most.
        assert!((diffuse - flux(reflectance)).abs() < 5e-3, "{albedo}: {diffuse} {}", flux(reflectance));
        let [straight, ..] = beam(medium, None, paths);
        assert!((straight - reflectance(1.0)).abs() < 5e-3, "{albedo}: {straight} {}", reflectance(1.0));
    }
}

#[test]
fn slabs_agree_with_printed_tables() {
    // H. C. van de Hulst, Multiple Light Scattering, 1980, table 35: τ = 2, a = 0.9, g = 0.75, no boundaries.
    let [back, through, _] = beam(medium(90.0, 10.0, 0.75, 1.0), Some(0.02), 150_000);
    // One standard deviation is 8e-4 and 1.2e-3.
    assert!((back - 0.09739).abs() < 2.5e-3 && (through - 0.66096).abs() < 4e-3, "{back} {through}");
    // R. G. Giovanelli, Optica Acta 2, 1955: half space, a = 0.9, isotropic, index 1.5: 0.2600 with the surface's own reflection.
    let [back, ..] = beam(medium(90.0, 10.0, 0.0, 1.5), None, 150_000);
    assert!((back - 0.26).abs() < 4e-3, "{back}");
}

#[test]
fn nothing_is_lost_without_absorption() {
    for ior in [1.0, 1.5, 2.5, 0.7] {
        for g in [-0.99, 0.0, 0.99] {
            for (sigma_s, thickness) in [(1e-4, Some(0.01)), (20.0, Some(0.2)), (1e3, Some(1.0)), (50.0, None)] {
                let parts = slab(medium(sigma_s, 0.0, g, ior), thickness, 64);
                // Weights stay exactly 1, and sums of 64 are exact.
                assert_eq!(parts.iter().sum::<f64>(), 1.0, "{ior} {g} {sigma_s} {thickness:?}: {parts:?}");
                assert_eq!(parts[2], 0.0, "{ior} {g} {sigma_s} {thickness:?}");
                assert!(thickness.is_some() || parts[1] == 0.0);
            }
        }
    }
}

#[test]
fn a_half_space_that_does_not_absorb_is_a_white_diffuser() {
    // All that arrives from any direction leaves, so the transfer to uniformly seen radiance is the cosine over π: for every index of
    // refraction and g, by reciprocity.
    let field = HeightField::new(2, 1, vec![0.1; 2]).unwrap();
    let mut expected = vec![0.0; 16];
    unshadowed_vector(order(4), [0.0, 0.0, 1.0], &mut expected);
    for (g, ior) in [(0.0, 1.0), (0.0, 1.5), (0.8, 1.3), (-0.5, 2.5)] {
        let options = PatchOptions { scattering: Some(medium(100.0, 0.0, g, ior)), ..options(4, 16_384) };
        let (transfer, report) = bake_patch(&field, &options, &()).unwrap();
        for (found, expected) in transfer.vector(0, 0, 0).iter().zip(&expected) {
            // One standard deviation of a coefficient is about 0.4/√16384 = 3e-3.
            assert!((f64::from(*found) - expected).abs() < 0.01, "{g} {ior}: {found} {expected}");
        }
        assert!(report.error.unwrap() < 0.05, "{g} {ior}: {report:?}");
    }
}

#[test]
fn without_scattering_light_passes_by_beer_and_fresnel() {
    // Slab of absorption only: reflections to and fro between the two boundaries sum up to a geometric series.
    let (sigma_a, thickness) = (3.0, 0.25);
    for ior in [1.0, 1.5, 2.5] {
        let n = f64::from(ior);
        let parts = |mu: f64| {
            let sin_t = (1.0 - mu * mu).sqrt() / n;
            let cos_t = (1.0 - sin_t * sin_t).sqrt();
            let across = ((mu - n * cos_t) / (mu + n * cos_t)).powi(2);
            let along = ((n * mu - cos_t) / (n * mu + cos_t)).powi(2);
            let f = 0.5 * (across + along);
            let a = f64::exp(-sigma_a * thickness / cos_t);
            let through = (1.0 - f).powi(2) * a / (1.0 - (f * a).powi(2));
            [f + f * a * through, through, f]
        };
        let [back, through, given_up] = slab(medium(0.0, sigma_a as f32, 0.0, ior), Some(thickness as f32), 100_000);
        let expected = [flux(|mu| parts(mu)[0]), flux(|mu| parts(mu)[1])];
        assert!(
            (back - expected[0]).abs() < 4e-3 && (through - expected[1]).abs() < 4e-3,
            "{ior}: {back} {through} {expected:?}"
        );
        assert_eq!(given_up, 0.0);
        // Without an end below, all that enters stays.
        let [back, through, _] = slab(medium(0.0, sigma_a as f32, 0.0, ior), None, 100_000);
        assert!(through == 0.0 && (back - flux(|mu| parts(mu)[2])).abs() < 4e-3, "{ior}: {back}");
    }
}

#[test]
fn optical_thickness_from_nothing_to_ten_thousand() {
    let slab_of = |depth: f32, g, paths| slab(medium(depth, 0.0, g, 1.0), Some(1.0), paths);
    for g in [-0.99, 0.0, 0.99] {
        let [back, through, _] = slab_of(1e-6, g, 20_000);
        // A path as long as 1/μ is scattered with 2e-6 μ⁻¹ probability; one in 20,000 is by chance.
        assert!(back <= 1.01 / 20_000.0 && through > 0.999, "{g}: {back} {through}");
    }
    // Thick: diffusion with Milne's extrapolation length. At 10 this is good to about a percent.
    for (depth, g, paths) in [(10.0, 0.0, 50_000), (100.0, 0.0, 50_000), (100.0, 0.9, 20_000)] {
        let expected = 4.0 / 3.0 / (f64::from(depth) * (1.0 - f64::from(g)) + 2.0 * 0.7104);
        let [_, through, _] = slab_of(depth, g, paths);
        let deviation = (expected / paths as f64).sqrt();
        assert!((through - expected).abs() < 4.0 * deviation + 0.01 * expected, "{depth} {g}: {through} {expected}");
    }
    let [back, through, given_up] = slab_of(1e4, 0.0, 5_000);
    assert!(back > 0.998 && through < 2e-3 && given_up < 1e-3, "{back} {through} {given_up}");
}
