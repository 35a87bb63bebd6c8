//! Pictures against Mitsuba 3.
//!
//! The lights are expansions of finite order that are nowhere negative. Such a light has nothing above its last band, so transfer of
//! that order gives the exact answer, and what is left is the noise of both sides and the interpolation between vertices.
#![expect(clippy::unwrap_used, reason = "tests")]
#![expect(clippy::print_stderr, reason = "the numbers go into the log of the tests")]

use std::path::PathBuf;

use glam::{DVec3, Vec3};
use prt_bake::{BakeOptions, BakedSurface, Environment, Image, Mesh, MeshOptions, MeshSource, bake_diffuse, load_mesh};
use prt_gpu::{Surface, View, cpu};
use prt_tests::{Comparison, Reference, References, compare_inside, data_path};
use sh_core::Order;

/// Relative mean squared error that is allowed with shadows alone, and with two bounces.
const LIMITS: [f64; 3] = [1e-4, f64::NAN, 3e-4];

/// Distances of neighbouring pixels on one surface differ by less than this share: a surface seen at 10 degrees at this resolution
/// stays below it, the depth edges of the scenes are above.
const DEPTH_STEP: f32 = 0.05;

const NEAR: f32 = 0.1;
const FAR: f32 = 100.0;

fn load(reference: &Reference) -> Option<Mesh> {
    let path = match (&reference.mesh, &reference.data_mesh) {
        (Some(mesh), _) => References::path(mesh),
        (None, Some(mesh)) => data_path("the comparison with Mitsuba on a real mesh", mesh)?,
        (None, None) => panic!("{} names no mesh", reference.name),
    };
    let mut source = load_mesh(&path).unwrap();
    let albedo = reference.albedo.unwrap_or([0.8; 3]);
    if reference.data_mesh.is_some() {
        source = welded_with_area_normals(&source);
    }
    for _ in 0..reference.subdivisions {
        source = split_faces(&source);
    }
    Some(Mesh::new(source, &MeshOptions { albedo, ..MeshOptions::default() }).unwrap().0)
}

/// The mesh as `references/meshes.py` prepares it: vertices at equal positions are one, normals are weighted by the area of the faces.
fn welded_with_area_normals(source: &MeshSource) -> MeshSource {
    let mut welded = MeshSource::default();
    let mut number_at = std::collections::HashMap::new();
    let mut number = |position: [f64; 3]| {
        let rounded = position.map(|coordinate| coordinate as f32);
        *number_at.entry(rounded.map(f32::to_bits)).or_insert_with(|| {
            welded.positions.push(rounded.map(f64::from));
            u32::try_from(welded.positions.len() - 1).unwrap()
        })
    };
    let triangles: Vec<[u32; 3]> =
        source.triangles.iter().map(|triangle| triangle.map(|v| number(source.positions[v as usize]))).collect();
    let mut normals = vec![DVec3::ZERO; welded.positions.len()];
    for &triangle in &triangles {
        let [a, b, c] = triangle.map(|vertex| DVec3::from_array(welded.positions[vertex as usize]));
        triangle.iter().for_each(|&vertex| normals[vertex as usize] += (b - a).cross(c - a));
    }
    welded.normals = normals.iter().map(|normal| normal.normalize().as_vec3().to_array()).collect();
    MeshSource { triangles, ..welded }
}

/// Each face split into four at the middles of its edges, without smoothing; normals are averaged and normalised.
fn split_faces(source: &MeshSource) -> MeshSource {
    let mut split = MeshSource { uvs: Vec::new(), triangles: Vec::new(), ..source.clone() };
    let mut middles = std::collections::HashMap::new();
    for &[a, b, c] in &source.triangles {
        let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(a, b)| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let (a, b) = (a as usize, b as usize);
                let middle = 0.5 * (DVec3::from_array(split.positions[a]) + DVec3::from_array(split.positions[b]));
                let normal = (Vec3::from_array(split.normals[a]) + Vec3::from_array(split.normals[b])).normalize();
                split.positions.push(middle.to_array());
                split.normals.push(normal.to_array());
                u32::try_from(split.positions.len() - 1).unwrap()
            })
        });
        split.triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    split
}

fn bake(mesh: &Mesh, reference: &Reference, n: usize) -> BakedSurface {
    let options = BakeOptions {
        order: Order::new(n).unwrap(),
        rays_per_vertex: 2048,
        bounces: reference.bounces,
        ..BakeOptions::default()
    };
    bake_diffuse(mesh, &options, &()).unwrap().0
}

/// The picture that the reference shows, and the distance of each pixel.
fn render(baked: &BakedSurface, light: &[f32], order: Order, reference: &Reference) -> (Image, Vec<f32>) {
    let transfer = &baked.transfer;
    let (triangles, positions) = (&baked.geometry.triangles, &baked.geometry.positions);
    let surface =
        Surface::new(positions, triangles, &baked.geometry.albedo, transfer.order, transfer.channels, &transfer.values)
            .unwrap();
    let (width, height) = (reference.width, reference.height);
    let clip_from_world = reference.camera.clip_from_world(width as f32 / height as f32, NEAR, FAR);
    let view = View::new(clip_from_world, width as u32, height as u32, 4).unwrap();
    let frame = cpu::render(&surface, light, order, &view).unwrap();
    let pixels = frame.pixels.iter().map(|&[r, g, b, _]| [r, g, b]).collect();
    let distance = frame
        .depth
        .iter()
        .map(|&depth| if depth < 1.0 { NEAR * FAR / (FAR - depth * (FAR - NEAR)) } else { f32::INFINITY });
    (Image { width, height, pixels }, distance.collect())
}

fn compare(reference: &Reference, light: &[f32], n: usize, baked: &BakedSurface) -> Comparison {
    let (image, distance) = render(baked, light, Order::new(n).unwrap(), reference);
    let truth = Image::load(&References::path(&reference.image)).unwrap();
    save_for_a_look(reference, &image, &truth);
    compare_inside(&image, &truth, &distance, DEPTH_STEP)
}

/// With `PRT_TEST_IMAGES=FOLDER` the pictures are written there.
fn save_for_a_look(reference: &Reference, image: &Image, truth: &Image) {
    if let Some(folder) = std::env::var_os("PRT_TEST_IMAGES").map(PathBuf::from) {
        image.save(&folder.join(format!("{}-ours.exr", reference.name))).unwrap();
        truth.save(&folder.join(format!("{}-mitsuba.exr", reference.name))).unwrap();
    }
}

#[test]
fn the_lights_are_what_their_coefficients_say() {
    for light in References::load().unwrap().lights {
        let order = Order::new(light.order).unwrap();
        for check in &light.checks {
            for channel in 0..3 {
                let coeffs: Vec<f64> = light.light[channel].iter().map(|&value| f64::from(value)).collect();
                let radiance = sh_core::reconstruct(order, &coeffs, check.direction);
                assert!((radiance - check.radiance[channel]).abs() < 1e-6 * (1.0 + radiance.abs()), "{}", light.name);
            }
        }
    }
}

/// All references of one number of bounces under band-limited light.
fn check_band_limited(bounces: usize) {
    let references = References::load().unwrap();
    let mut compared = Vec::new();
    for reference in references.images.iter().filter(|reference| reference.bounces == bounces) {
        let Some(light) = reference.light.as_ref().and_then(|name| references.light(name)) else { continue };
        let Some(mesh) = load(reference) else { continue };
        let baked = bake(&mesh, reference, light.order);
        let found = compare(reference, &light.light.concat(), light.order, &baked);
        eprintln!(
            "{}: relative MSE {:.2e}, pixel by pixel {:.2e}, over {:.0} % of the picture; noise of the reference {:.1e}",
            reference.name,
            found.relative_mse,
            found.mean_relative_square,
            100.0 * found.share,
            reference.noise_relmse
        );
        compared.push((reference.name.clone(), found));
    }
    assert!(compared.len() >= 3, "{} references with {bounces} bounces", compared.len());
    for (name, found) in compared {
        assert!(found.share > 0.1, "{name}: only {:.3} of the picture was compared", found.share);
        assert!(found.relative_mse.max(found.mean_relative_square) <= LIMITS[bounces], "{name}: {found:?}");
    }
}

#[test]
fn shadowed_pictures_agree_with_mitsuba() {
    check_band_limited(0);
}

#[test]
fn pictures_with_two_bounces_agree_with_mitsuba() {
    check_band_limited(2);
}

#[test]
fn the_error_under_real_light_falls_with_the_order() {
    for reference in References::load().unwrap().images {
        let Some(env) = &reference.environment else { continue };
        let Some(path) = data_path("the curve of error against order", env) else { continue };
        let environment = Environment::load(&path).unwrap();
        let Some(mesh) = load(&reference) else { continue };
        let baked = bake(&mesh, &reference, 10);
        let curve: Vec<f64> = (1..=10)
            .map(|n| compare(&reference, &environment.light(Order::new(n).unwrap()), n, &baked).relative_mse)
            .collect();
        eprintln!("{}: relative MSE for order 1 to 10: {curve:?}", reference.name);
        assert!(curve[5] < 0.5 * curve[1], "{}: order 6 is no better than order 2: {curve:?}", reference.name);
        assert!(curve[9] < curve[2], "{curve:?}");
    }
}
