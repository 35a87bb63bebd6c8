//! Environment maps.

use std::f32::consts::PI;

use prt_bake::{Environment, Error, Image};
use sh_core::{CubeMap, LatLong, Order, reconstruct};

use crate::scratch::{Scratch, assert_near};

const FACES: [&str; 6] = ["px", "nx", "py", "ny", "pz", "nz"];
const AXES: [[f32; 3]; 6] =
    [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];

/// An image whose pixels are a smooth function of their direction.
fn smooth([x, y, z]: [f64; 3]) -> [f32; 3] {
    [1.0 + 0.5 * x, 1.0 + 0.5 * y, 1.0 + 0.5 * z + 0.25 * x * y].map(|value| value as f32)
}

fn smooth_lat_long(width: usize, height: usize) -> Image {
    let map = LatLong { width, height };
    let at = |i: usize| smooth(map.direction((i % width) as f64 + 0.5, (i / width) as f64 + 0.5));
    Image { width, height, pixels: (0..width * height).map(at).collect() }
}

fn smooth_cube(size: usize) -> [Image; 6] {
    let map = CubeMap { size };
    [0, 1, 2, 3, 4, 5].map(|face| {
        let at = |i: usize| {
            let [x, y, z] = map.direction(face, (i % size) as f64 + 0.5, (i / size) as f64 + 0.5);
            smooth([-x, y, z])
        };
        Image { width: size, height: size, pixels: (0..size * size).map(at).collect() }
    })
}

fn directions() -> Vec<[f32; 3]> {
    sh_core::fibonacci(5000).into_iter().map(|direction| direction.map(|value| value as f32)).chain(AXES).collect()
}

/// Bilinear error of a function with second derivatives of about 1 on a grid of spacing π/64: h²/4 and as much again in
/// the other axis; nearest texels across the edges of a cube add half a texel, h/2.
#[test]
fn radiance_is_smooth_everywhere() {
    let spacing = PI / 64.0;
    for (environment, tolerance) in [
        (Environment::LatLong(smooth_lat_long(128, 64)), spacing * spacing / 2.0),
        (Environment::LatLong(smooth_lat_long(100, 64)), spacing * spacing),
        (Environment::Cube(Box::new(smooth_cube(41))), 0.5 * spacing),
    ] {
        for direction in directions() {
            let scaled = direction.map(|value| value * 7.0);
            assert_near(&environment.radiance(scaled), &smooth(direction.map(f64::from)), tolerance);
        }
    }
}

#[test]
fn light_projects_both_kinds_alike() {
    let order = Order::new(3).unwrap();
    for environment in [Environment::LatLong(smooth_lat_long(256, 128)), Environment::Cube(Box::new(smooth_cube(64)))] {
        let light = environment.light(order);
        assert_eq!(light.len(), 27);
        for direction in directions() {
            let channels = [0, 1, 2].map(|channel| reconstruct(order, &light[9 * channel..9 * channel + 9], direction));
            // The image is of order 3, so only the midpoint rule of the projection is left: (n / height)².
            assert_near(&channels, &smooth(direction.map(f64::from)), 2e-3);
        }
    }
}

fn save_faces(scratch: &Scratch, faces: &[Image; 6]) {
    for (name, face) in FACES.iter().zip(faces) {
        face.save(&scratch.path().join(format!("{name}.exr"))).unwrap();
    }
}

#[test]
fn folders_are_cube_maps() {
    let scratch = Scratch::new();
    let faces = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0].map(|value| Image { width: 4, height: 4, pixels: vec![[value; 3]; 16] });
    save_faces(&scratch, &faces);
    let environment = Environment::load(scratch.path()).unwrap();
    for (face, [x, y, z]) in AXES.into_iter().enumerate() {
        // Mirrored: the face px is seen towards −x.
        assert_eq!(environment.radiance([-x, y, z]), [face as f32 + 1.0; 3]);
    }
    assert_eq!(environment, Environment::Cube(Box::new(faces)));
}

#[test]
fn missing_and_mismatched_faces_are_named() {
    let scratch = Scratch::new();
    let message = |scratch: &Scratch| Environment::load(scratch.path()).unwrap_err().to_string();
    assert!(message(&scratch).contains("the folder has no px, nx, py, ny, pz, nz"), "{}", message(&scratch));
    save_faces(&scratch, &smooth_cube(4));
    std::fs::remove_file(scratch.path().join("ny.exr")).unwrap();
    assert!(message(&scratch).contains("the folder has no ny (as .hdr .exr .png .jpg .jpeg)"), "{}", message(&scratch));
    Image { width: 5, height: 5, pixels: vec![[0.0; 3]; 25] }.save(&scratch.path().join("ny.png")).unwrap();
    assert!(message(&scratch).contains("ny.png") && message(&scratch).contains("the face is 5 × 5, not 4 × 4"));
    Image { width: 4, height: 3, pixels: vec![[0.0; 3]; 12] }.save(&scratch.path().join("px.exr")).unwrap();
    assert!(message(&scratch).contains("px.exr") && message(&scratch).contains("the face is 4 × 3, not 4 × 4"));
    scratch.write("px.hdr", "nonsense");
    assert!(
        matches!(Environment::load(scratch.path()), Err(Error::Malformed { path, .. }) if path.ends_with("px.hdr"))
    );
}

#[test]
fn the_smallest_maps() {
    for (width, height) in [(1, 1), (2, 1), (1, 2), (3, 1)] {
        let environment = Environment::LatLong(Image { width, height, pixels: vec![[0.5; 3]; width * height] });
        for direction in directions() {
            assert_near(&environment.radiance(direction), &[0.5; 3], 1e-6);
        }
    }
    let faces = [0; 6].map(|_| Image { width: 1, height: 1, pixels: vec![[2.0; 3]] });
    let light = Environment::Cube(Box::new(faces)).light(Order::new(1).unwrap());
    assert_near(&light, &[2.0 * (4.0 * PI).sqrt(); 3], 1e-6);
}
