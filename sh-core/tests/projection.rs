//! Maps to lights and back, against plain sums over texels, at sizes that are odd, tiny and lopsided.
#![cfg(feature = "alloc")]
#![expect(clippy::unwrap_used, clippy::print_stdout, reason = "tests")]

use std::f64::consts::PI;

use sh_core::{
    Basis, CubeMap, LatLong, Order, Quadrature, Real, project_cube, project_function, project_lat_long, reconstruct,
    reconstruct_cube, reconstruct_lat_long,
};

/// Something without symmetry, different in each channel, with a sun of 1e4.
fn pixels(count: usize) -> Vec<[f32; 3]> {
    let noise = |i: usize| (i as f32 * 12.9898).sin() * 0.5 + 0.6;
    (0..count).map(|i| [noise(i), noise(i + 7) * 2.0, if i % 97 == 13 { 1e4 } else { 0.1 }]).collect()
}

/// The definition: a sum over texels of radiance times the basis at the centre times the solid angle.
fn plain_sum(order: Order, texels: impl Iterator<Item = ([f32; 3], [f64; 3], f64)>) -> Vec<f64> {
    let basis = Basis::<f64>::new(order);
    let count = order.coeff_count();
    let (mut y, mut light) = (vec![0.0; count], vec![0.0; 3 * count]);
    for (pixel, direction, solid_angle) in texels {
        basis.eval(direction, &mut y);
        for (light, radiance) in light.chunks_exact_mut(count).zip(pixel) {
            light.iter_mut().zip(&y).for_each(|(f, y)| *f += f64::from(radiance) * solid_angle * y);
        }
    }
    light
}

/// Equal to rounding of the result to f32, in relation to the largest of its channel; the sums are in f64.
#[track_caller]
fn assert_equal(what: &str, light: &[f32], expected: &[f64]) {
    let channels = light.chunks_exact(light.len() / 3).zip(expected.chunks_exact(light.len() / 3));
    for (light, expected) in channels {
        let size = expected.iter().map(|f| f.abs()).fold(0.0, f64::max);
        for (i, (f, e)) in light.iter().zip(expected).enumerate() {
            assert!((f64::from(*f) - e).abs() < 1e-7 * size, "{what}, coefficient {i}: {f} {e}");
        }
    }
}

fn centres(width: usize, height: usize) -> impl Iterator<Item = (f64, f64, usize, usize)> {
    (0..height).flat_map(move |y| (0..width).map(move |x| (x as f64 + 0.5, y as f64 + 0.5, x, y)))
}

#[test]
fn lat_long_is_the_plain_sum() {
    let sizes = [(1, 1), (2, 1), (3, 2), (4, 3), (5, 4), (6, 1), (7, 7), (8, 4), (10, 5), (12, 31), (64, 32)];
    for (width, height) in sizes {
        let map = LatLong { width, height };
        let pixels = pixels(width * height);
        for n in [1, 2, 6, 12, 19] {
            let order = Order::new(n).unwrap();
            let texels = centres(width, height)
                .map(|(x, y, column, row)| (pixels[row * width + column], map.direction(x, y), map.solid_angle(row)));
            let mut light = vec![f32::NAN; 3 * n * n];
            project_lat_long(order, map, &pixels, &mut light);
            assert_equal(&format!("{width}x{height}, n = {n}"), &light, &plain_sum(order, texels));
        }
    }
}

#[test]
fn cube_is_the_plain_sum() {
    for size in [1, 2, 3, 4, 7, 16] {
        let map = CubeMap { size };
        let faces: [Vec<_>; 6] = std::array::from_fn(|face| pixels(6 * size * size)[face * size * size..].to_vec());
        let faces = faces.each_ref().map(|face| &face[..size * size]);
        for n in [1, 2, 6, 12, 19] {
            let order = Order::new(n).unwrap();
            let texels = (0..6).flat_map(|face| {
                centres(size, size).map(move |(x, y, column, row)| {
                    (faces[face][row * size + column], map.direction(face, x, y), map.solid_angle(column, row))
                })
            });
            let mut light = vec![f32::NAN; 3 * n * n];
            project_cube(order, map, faces, &mut light);
            assert_equal(&format!("{size}, n = {n}"), &light, &plain_sum(order, texels));
        }
    }
}

#[test]
fn maps_without_texels_are_black() {
    let order = Order::new(3).unwrap();
    for (width, height) in [(0, 0), (0, 5), (5, 0)] {
        let mut light = [1.0; 27];
        project_lat_long(order, LatLong { width, height }, &[], &mut light);
        assert_eq!(light, [0.0; 27]);
        reconstruct_lat_long(order, &light, LatLong { width, height }, &mut []);
    }
    let mut light = [1.0; 27];
    project_cube(order, CubeMap { size: 0 }, [&[]; 6], &mut light);
    assert_eq!(light, [0.0; 27]);
}

#[test]
fn drawing_a_light_gives_its_values_at_the_texels() {
    for (width, height) in [(1, 1), (2, 2), (5, 3), (6, 3), (16, 8)] {
        let map = LatLong { width, height };
        for n in [1, 2, 5, 11] {
            let order = Order::new(n).unwrap();
            let light: Vec<f32> = (0..3 * n * n).map(|i| (i as f32 * 0.7).cos()).collect();
            let mut pixels = vec![[f32::NAN; 3]; map.texel_count()];
            reconstruct_lat_long(order, &light, map, &mut pixels);
            for (x, y, column, row) in centres(width, height) {
                for (channel, coeffs) in light.chunks_exact(n * n).enumerate() {
                    let coeffs: Vec<f64> = coeffs.iter().map(|&f| f64::from(f)).collect();
                    let expected = reconstruct(order, &coeffs, map.direction(x, y));
                    let value = f64::from(pixels[row * width + column][channel]);
                    // Values are up to n/√(4π) · n; they are rounded once.
                    assert!(
                        (value - expected).abs() < 1e-6 * n as f64,
                        "{width}x{height}, n = {n}: {value} {expected}"
                    );
                }
            }
        }
    }
}

#[test]
fn drawing_a_cube_gives_the_values_at_the_texels() {
    for (size, n) in [(1, 2), (3, 5), (4, 11)] {
        let (map, order) = (CubeMap { size }, Order::new(n).unwrap());
        let light: Vec<f32> = (0..3 * n * n).map(|i| (i as f32 * 0.7).cos()).collect();
        let mut faces: [Vec<[f32; 3]>; 6] = std::array::from_fn(|_| vec![[f32::NAN; 3]; size * size]);
        reconstruct_cube(order, &light, map, faces.each_mut().map(Vec::as_mut_slice));
        for (face, pixels) in faces.iter().enumerate() {
            for (x, y, column, row) in centres(size, size) {
                for (channel, coeffs) in light.chunks_exact(n * n).enumerate() {
                    let coeffs: Vec<f64> = coeffs.iter().map(|&f| f64::from(f)).collect();
                    let expected = reconstruct(order, &coeffs, map.direction(face, x, y));
                    let value = f64::from(pixels[row * size + column][channel]);
                    assert!((value - expected).abs() < 1e-6 * n as f64, "face {face}, n = {n}: {value} {expected}");
                }
            }
        }
    }
    reconstruct_cube(Order::new(1).unwrap(), &[0.0; 3], CubeMap { size: 0 }, std::array::from_fn(|_| &mut [][..]));
}

/// The relative error of a light that is drawn as a map and projected again.
fn round_trip_error(n: usize, project: impl Fn(Order, &[f32], &mut [f32])) -> f64 {
    let order = Order::new(n).unwrap();
    let light: Vec<f32> = (0..3 * n * n).map(|i| (i as f32 * 0.7).cos()).collect();
    let mut back = vec![0.0; 3 * n * n];
    project(order, &light, &mut back);
    let squares = |light: &[f32]| light.iter().map(|f| f64::from(f * f)).sum::<f64>();
    let difference: Vec<f32> = light.iter().zip(&back).map(|(a, b)| a - b).collect();
    (squares(&difference) / squares(&light)).sqrt()
}

fn lat_long_round_trip(n: usize, height: usize) -> f64 {
    let map = LatLong { width: 2 * height, height };
    round_trip_error(n, |order, light, back| {
        let mut pixels = vec![[0.0; 3]; map.texel_count()];
        reconstruct_lat_long(order, light, map, &mut pixels);
        project_lat_long(order, map, &pixels, back);
    })
}

fn cube_round_trip(n: usize, size: usize) -> f64 {
    let map = CubeMap { size };
    round_trip_error(n, |order, light, back| {
        let mut faces: [Vec<[f32; 3]>; 6] = std::array::from_fn(|_| vec![[f32::NAN; 3]; size * size]);
        reconstruct_cube(order, light, map, faces.each_mut().map(Vec::as_mut_slice));
        project_cube(order, map, faces.each_ref().map(Vec::as_slice), back);
    })
}

#[test]
fn a_light_comes_back_to_the_error_of_one_sample_per_texel() {
    // Taking the basis at the centre of a texel is the midpoint rule: an error of second order in the texel's size.
    for (n, size) in [(3, 16), (6, 32), (6, 64), (6, 128), (6, 256), (10, 64), (10, 128)] {
        let limit = (n as f64 / size as f64).powi(2) / 10.0;
        let (lat_long, cube) = (lat_long_round_trip(n, size), cube_round_trip(n, size));
        println!("n = {n}, {size}: {lat_long:.1e}, {cube:.1e}, stated {limit:.1e}");
        assert!(lat_long < limit && cube < limit);
    }
    let halved = lat_long_round_trip(6, 32) / lat_long_round_trip(6, 64);
    assert!((3.8..4.2).contains(&halved), "{halved}");
}

#[test]
fn a_constant_map_is_band_0() {
    check_constant_maps::<f32>(6e-8);
    check_constant_maps::<f64>(1e-14);
}

/// `rounding`: of band 0, relative.
fn check_constant_maps<T: Real>(rounding: f64) {
    let (order, radiance) = (Order::new(6).unwrap(), [1.0, 0.5, 3.0]);
    let (map, cube) = (LatLong { width: 256, height: 128 }, CubeMap { size: 128 });
    let pixels = vec![radiance.map(T::from_f64); map.texel_count()];
    let [mut light, mut from_cube] = [[T::ZERO; 108]; 2];
    project_lat_long(order, map, &pixels, &mut light);
    project_cube(order, cube, [&pixels[..cube.size * cube.size]; 6], &mut from_cube);
    for channels in [light, from_cube] {
        for (channel, radiance) in channels.chunks_exact(36).zip(radiance) {
            // Solid angles are exact, so band 0 is; the others are the error of the midpoint rule.
            assert!((channel[0].to_f64() / (radiance * (4.0 * PI).sqrt()) - 1.0).abs() < rounding);
            assert!(channel[1..].iter().all(|f| f.to_f64().abs() < 3e-4 * radiance), "{channel:?}");
        }
    }
}

#[test]
fn both_kinds_of_map_agree_on_a_scene() {
    // A sky that is asymmetric in every axis, sampled at the texels of each map.
    let sky = |[x, y, z]: [f64; 3]| {
        [(1.0 + x + 0.3 * y * z) as f32, (z * z + 0.2 * x * y) as f32, (y + 2.0 * z * x * y) as f32]
    };
    let order = Order::new(4).unwrap();
    let (lat_long, cube) = (LatLong { width: 512, height: 256 }, CubeMap { size: 128 });
    let pixels: Vec<_> = centres(512, 256).map(|(x, y, ..)| sky(lat_long.direction(x, y))).collect();
    let face = |face| centres(128, 128).map(|(x, y, ..)| sky(cube.direction(face, x, y))).collect::<Vec<_>>();
    let faces: [Vec<_>; 6] = std::array::from_fn(face);
    let (mut from_lat_long, mut from_cube) = (vec![0.0; 48], vec![0.0; 48]);
    project_lat_long(order, lat_long, &pixels, &mut from_lat_long);
    project_cube(order, cube, faces.each_ref().map(Vec::as_slice), &mut from_cube);
    for channel in 0..3 {
        let mut exact = [0.0_f64; 16];
        project_function(order, &Quadrature::new(8), |d| f64::from(sky(d)[channel]), &mut exact);
        for i in 0..16 {
            // Functions of size 3 and order 4 at most: 3 · (4/256)², 3 · (4/128)²; f32 in the sky.
            assert!((f64::from(from_lat_long[16 * channel + i]) - exact[i]).abs() < 8e-4);
            assert!((f64::from(from_cube[16 * channel + i]) - exact[i]).abs() < 3e-3);
        }
    }
}

#[test]
fn large_orders_project_too() {
    let (order, map) = (Order::new(100).unwrap(), LatLong { width: 400, height: 200 });
    let mut coeffs = vec![0.0_f32; 3 * order.coeff_count()];
    coeffs[9_900] = 1.0; // l = 99, m = 0
    let mut pixels = vec![[0.0; 3]; map.texel_count()];
    reconstruct_lat_long(order, &coeffs, map, &mut pixels);
    let mut back = vec![0.0; coeffs.len()];
    project_lat_long(order, map, &pixels, &mut back);
    // Two rows per half wave: far from exact, but the function is found, and its f64 sums hold.
    assert!((back[9_900] - 1.0).abs() < 0.25, "{}", back[9_900]);
    assert!(back[order.coeff_count()..].iter().all(|f| *f == 0.0));
}

#[test]
#[should_panic(expected = "pixels has 7 elements, it needs 8")]
fn wrong_lengths_are_named() {
    let map = LatLong { width: 4, height: 2 };
    project_lat_long(Order::new(1).unwrap(), map, &[[0.0; 3]; 7], &mut [0.0; 3]);
}
