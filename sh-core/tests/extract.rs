//! What is extracted from a light, against its definitions, and from lights that hold nothing.
#![cfg(feature = "alloc")]
#![expect(clippy::unwrap_used, reason = "tests")]

use std::f64::consts::PI;

use proptest::prelude::*;
use sh_core::{
    Order, Quadrature, Real, ShRotation, ambient_light, band_energy, directional_light_normalised, disk_light,
    dominant_direction, dominant_light, dot, fibonacci, hemisphere_light, irradiance, irradiance_from_radiance,
    irradiance_matrices, linear_axis, reconstruct,
};

fn order(n: usize) -> Order {
    Order::new(n).unwrap()
}

/// Three channels without symmetry.
fn light(n: usize) -> Vec<f64> {
    (0..3 * n * n).map(|i| (i * 7919 % 101) as f64 / 50.0 - 1.0).collect()
}

/// ∫ f(s) max(n·s, 0) ds over the hemisphere about the normal.
fn irradiance_by_quadrature(n: usize, coeffs: &[f64], normal: [f64; 3]) -> f64 {
    // Points of the half z > 0: the rings of a quadrature, squeezed; exact for polynomials of degree n.
    let to_half = |([x, y, z], w): ([f64; 3], f64)| {
        let half = 0.5 * (z + 1.0);
        let r = ((1.0 - half) * (1.0 + half) / ((1.0 - z) * (1.0 + z))).sqrt();
        ([x * r, y * r, half], 0.5 * w)
    };
    let (a, b) = if normal[0].abs() < 0.5 { ([1.0, 0.0, 0.0], normal) } else { ([0.0, 1.0, 0.0], normal) };
    let e1 = unit(cross(a, b));
    let e2 = cross(normal, e1);
    let value = |&(s, w): &([f64; 3], f64)| {
        let ([x, y, z], w) = to_half((s, w));
        let direction = std::array::from_fn(|k| x * e1[k] + y * e2[k] + z * normal[k]);
        w * z * reconstruct(order(n), coeffs, direction)
    };
    Quadrature::new(2 * n + 2).points().iter().map(value).sum()
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    v.map(|x| x / length)
}

#[test]
fn irradiance_is_its_integral() {
    for n in [1, 2, 3, 6, 11] {
        let light = light(n);
        let mut everywhere = light[..n * n].to_vec();
        irradiance_from_radiance(order(n), &mut everywhere);
        for normal in fibonacci(20) {
            let value = irradiance(order(n), &light[..n * n], normal);
            let expected = irradiance_by_quadrature(n, &light[..n * n], normal);
            assert!((value - expected).abs() < 1e-13, "n = {n}, {normal:?}: {value} {expected}");
            assert_eq!(value, reconstruct(order(n), &everywhere, normal));
        }
    }
}

#[test]
fn irradiance_matrices_are_the_irradiance_of_three_bands() {
    for n in [1, 2, 3, 5] {
        let light = light(n);
        let matrices = irradiance_matrices(order(n), &light);
        let bands = n.min(3);
        for (matrix, channel) in matrices.iter().zip(light.chunks_exact(n * n)) {
            for [x, y, z] in fibonacci(30) {
                let v = [x, y, z, 1.0];
                let value: f64 =
                    matrix.iter().zip(v).map(|(row, a)| a * row.iter().zip(v).map(|(m, b)| m * b).sum::<f64>()).sum();
                let expected = irradiance(order(bands), &channel[..bands * bands], [x, y, z]);
                assert!((value - expected).abs() < 1e-14, "n = {n}: {value} {expected}");
            }
            for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
                assert_eq!(matrix[i][j], matrix[j][i]);
            }
        }
    }
    // The constants as the paper prints them: one coefficient each.
    let one = |i: usize| {
        let mut light = [0.0; 27];
        light[i] = 1.0;
        irradiance_matrices(order(3), &light)[0]
    };
    let printed = [
        (one(8)[0][0], 0.429043),
        (one(8)[1][1], -0.429043),
        (one(2)[2][3], 0.511664),
        (one(3)[0][3], -0.511664),
        (one(6)[2][2], 0.743125),
        (one(0)[3][3], 0.886227),
        (one(6)[3][3], -0.247708),
    ];
    for (value, printed) in printed {
        // The paper multiplied constants of six digits: 3π/4 times half a unit of 0.315392, and its own rounding.
        assert!((value - printed).abs() < 1.7e-6, "{value} {printed}");
    }
}

#[test]
fn a_directional_light_is_found_with_its_colour() {
    for n in [2, 3, 6, 20] {
        for direction in fibonacci(10) {
            let mut rgb = vec![0.0; 3 * n * n];
            for (channel, colour) in rgb.chunks_exact_mut(n * n).zip([3.0, 0.5, 0.0]) {
                directional_light_normalised(order(n), direction, channel);
                channel.iter_mut().for_each(|f| *f *= colour);
            }
            let found = dominant_light(order(n), &rgb);
            assert!(found.direction.iter().zip(direction).all(|(a, b)| (a - b).abs() < 1e-14));
            assert!(found.colour.iter().zip([3.0, 0.5, 0.0]).all(|(a, b)| (a - b).abs() < 1e-13), "{found:?}");
        }
    }
}

#[test]
fn luminance_weighs_the_channels() {
    // Red from +x, green from +y, blue from +z: the direction has the weights of Rec. 709.
    let n = 4;
    let mut rgb = vec![0.0; 3 * n * n];
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for (channel, axis) in rgb.chunks_exact_mut(n * n).zip(axes) {
        disk_light(order(n), axis, 0.3, channel);
    }
    let expected = unit([0.2126, 0.7152, 0.0722]);
    let found = dominant_direction(order(n), &rgb);
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?}");
}

#[test]
fn no_other_colour_is_nearer() {
    let n = 4;
    let mut rgb = light(n);
    // Something in front, so that two channels are positive and one is not.
    for (channel, strength) in rgb.chunks_exact_mut(n * n).zip([2.0, 3.0, -2.0]) {
        channel[2] += strength;
        channel[6] += strength;
    }
    let found = dominant_light(order(n), &rgb);
    let mut one = vec![0.0; n * n];
    directional_light_normalised(order(n), found.direction, &mut one);
    for (channel, colour) in rgb.chunks_exact(n * n).zip(found.colour) {
        let error = |colour: f64| channel.iter().zip(&one).map(|(f, b)| (f - colour * b).powi(2)).sum::<f64>();
        assert!(error(colour) < error(colour + 1e-4));
        assert!(colour == 0.0 || error(colour) < error(colour - 1e-4));
    }
    assert!(found.colour[0] > 0.0 && found.colour[1] > 0.0 && found.colour[2] == 0.0, "{found:?}");
}

#[test]
fn lights_without_a_direction_have_an_answer() {
    for n in [1, 2, 3, 6, 64] {
        let black = vec![0.0_f32; 3 * n * n];
        let found = dominant_light(order(n), &black);
        assert_eq!((found.direction, found.colour), ([0.0, 0.0, 1.0], [0.0; 3]), "n = {n}");
        let mut uniform = black.clone();
        uniform.chunks_exact_mut(n * n).for_each(|channel| ambient_light(order(n), channel));
        let found = dominant_light(order(n), &uniform);
        assert!(found.direction == [0.0, 0.0, 1.0] && found.colour.iter().all(|c| *c > 0.0 && c.is_finite()));
        for bad in [f32::NAN, f32::INFINITY, f32::MAX, -f32::MAX, 1e-45] {
            let mut light = black.clone();
            light[0] = bad;
            light[n * n - 1] = bad;
            let found = dominant_light(order(n), &light);
            assert!(found.direction.iter().all(|d| d.is_finite()), "{bad}");
            assert!(found.colour.iter().all(|c| *c >= 0.0 && c.is_finite()), "{bad}: {found:?}");
        }
    }
}

#[test]
fn energies_are_those_of_known_functions() {
    let mut energy = [9.0_f64; 6];
    let mut halves = [0.0; 36];
    hemisphere_light(order(6), [0.6, 0.0, 0.8], 1.0, -1.0, &mut halves);
    band_energy(order(6), &halves, &mut energy);
    // sign(z): (2l+1)/(4π) (4π ∫_0^1 P_l)² for odd l
    let expected = [0.0, 3.0 * PI, 0.0, 7.0 * PI / 16.0, 0.0, 11.0 * PI / 64.0];
    assert!(energy.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{energy:?}");
    let mut energy = [0.0_f32];
    band_energy(order(1), &[-1e-30_f32], &mut energy);
    assert_eq!(energy, [0.0]);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Rotation moves the direction with the light, and nothing between bands.
    #[test]
    fn rotation_commutes(angle in 0.0..7.0_f64, coeffs in prop::collection::vec(-1.0..1.0_f64, 25)) {
        let (s, c) = angle.sin_cos();
        // about (0.6, 0, 0.8)
        let k = [0.6, 0.0, 0.8];
        let matrix: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| {
            let cross = [[0.0, -k[2], k[1]], [k[2], 0.0, -k[0]], [-k[1], k[0], 0.0]];
            f64::from(u8::from(i == j)) * c + s * cross[i][j] + (1.0 - c) * k[i] * k[j]
        }));
        let mut turned = vec![0.0; 25];
        ShRotation::new(order(5), matrix).apply(&coeffs, &mut turned);
        let axis = linear_axis(&coeffs);
        let expected = matrix.map(|row| row.iter().zip(axis).map(|(m, a)| m * a).sum::<f64>());
        prop_assume!(coeffs[1..4].iter().any(|f| f.abs() > 0.01));
        prop_assert!(linear_axis(&turned).iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12));
        let (mut before, mut after) = ([0.0; 5], [0.0; 5]);
        band_energy(order(5), &coeffs, &mut before);
        band_energy(order(5), &turned, &mut after);
        prop_assert!(before.iter().zip(after).all(|(a, b)| (a - b).abs() < 1e-13));
        prop_assert!((before.iter().sum::<f64>() - dot(&coeffs, &coeffs)).abs() < 1e-13);
    }

    /// Any bits at all: no NaN.
    #[test]
    fn the_dominant_light_is_finite(light in prop::collection::vec(any::<f32>(), 27)) {
        let found = dominant_light(order(3), &light);
        prop_assert!(found.direction.iter().all(|d| d.to_f64().is_finite()));
        prop_assert!(found.colour.iter().all(|c| *c >= 0.0 && c.is_finite()));
    }
}
