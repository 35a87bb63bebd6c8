//! Bakes the texels of a mesh with texture coordinates: `cargo run --release -p prt-bake --example 03_texels -- spot.obj FOLDER [SIZE]`.
//!
//! Writes the atlas, a picture of it under a light from the upper left, and a picture of the mesh that looks it up.

use std::path::Path;

use glam::{DVec3, Vec3};
use prt_bake::{
    BakeOptions, Hit, Image, Mesh, MeshOptions, Scene, TexelOptions, TexelReport, TexelTransfer, bake_texels,
    load_mesh, save_png,
};

/// Towards the light: from the upper left, seen by the camera.
const LIGHT: DVec3 = DVec3::new(-0.6, 0.7, 0.39);

#[expect(clippy::print_stderr, reason = "the report of an example")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [scene, folder, size @ ..] = arguments.as_slice() else { return Err("give a mesh file and a folder".into()) };
    let size = size.first().map_or(Ok(512), |size| size.parse())?;

    // 1. A mesh with texture coordinates. Only in glTF v runs down, as the rows of an image do.
    let (mesh, _) = Mesh::new(load_mesh(Path::new(scene))?, &MeshOptions::default())?;
    let v_up = !scene.ends_with(".glb") && !scene.ends_with(".gltf");

    // 2. The bake, and what it says: overlaps and the differences across seams are faults of the atlas.
    let options = BakeOptions { bounces: 1, ..BakeOptions::preview() };
    let (atlas, report) = bake_texels(&mesh, &options, &TexelOptions { v_up, ..TexelOptions::square(size) }, &())?;
    eprintln!("{:?}", report.texels.map(|found| TexelReport { vertices: None, ..found }));

    // 3. One image with a channel for each coefficient, and pictures of it under a light.
    let path = |name: &str| Path::new(folder).join(name);
    atlas.write_exr(&path("atlas.exr"))?;
    let mut light = vec![0.0; atlas.transfer.order.coeff_count()];
    sh_core::directional_light(atlas.transfer.order, LIGHT.normalize().to_array(), &mut light);
    light.iter_mut().for_each(|value| *value *= 2.5);
    light[0] += 0.3 * (4.0 * std::f64::consts::PI).sqrt();
    let light: Vec<f32> = light.iter().map(|&value| value as f32).collect();
    save(&atlas.relit(&light.repeat(3)), &path("atlas.png"))?;
    save(&picture(&mesh, &atlas, &light), &path("mesh.png"))?;
    Ok(())
}

/// The mesh seen from the front, a little from above; lookups are bilinear.
fn picture(mesh: &Mesh, atlas: &TexelTransfer, light: &[f32]) -> Image {
    const SIZE: usize = 640;
    let [lower, upper] = mesh.bounds().map(DVec3::from_array);
    let (center, extent) = (0.5 * (lower + upper), (upper - lower).length());
    let eye = center + extent * DVec3::new(0.35, 0.5, 1.3);
    let forward = (center - eye).normalize();
    let right = forward.cross(DVec3::Y).normalize();
    let up = right.cross(forward);
    let pixel = |i: usize| (i as f64 + 0.5) / SIZE as f64 - 0.5;
    let rays: Vec<Vec3> = (0..SIZE)
        .flat_map(|row| (0..SIZE).map(move |column| (pixel(column), -pixel(row))))
        .map(|(x, y)| (forward + 0.8 * (x * right + y * up)).normalize().as_vec3())
        .collect();
    let mut hits = vec![None; rays.len()];
    Scene::new(mesh).closest(eye.to_array(), &rays, &mut hits);
    let pixels = hits.iter().map(|hit| hit.map_or([0.05; 3], |hit| shade(mesh, atlas, light, &hit))).collect();
    Image { width: SIZE, height: SIZE, pixels }
}

fn shade(mesh: &Mesh, atlas: &TexelTransfer, light: &[f32], hit: &Hit) -> [f32; 3] {
    let triangle = mesh.triangles()[hit.triangle as usize].map(|vertex| vertex as usize);
    let [b, c] = hit.barycentric;
    let weights = [1.0 - b - c, b, c];
    let blend = |value: &dyn Fn(usize) -> f32| (0..3).map(|k| weights[k] * value(triangle[k])).sum::<f32>();
    let uvs = mesh.uvs().unwrap_or_default();
    let uv = [0, 1].map(|axis| blend(&|vertex| uvs[vertex][axis]));
    let mut transfer = vec![0.0; light.len()];
    [0, 1, 2].map(|channel| {
        atlas.sample(uv, channel, &mut transfer);
        let radiance: f32 = transfer.iter().zip(light).map(|(transfer, light)| transfer * light).sum();
        radiance * blend(&|vertex| mesh.albedo()[vertex][channel])
    })
}

fn save(image: &Image, path: &Path) -> Result<(), prt_bake::Error> {
    let display = |value: f32| (255.0 * value.clamp(0.0, 1.0).powf(1.0 / 2.2)).round() as u8;
    let pixels: Vec<[u8; 3]> = image.pixels.iter().map(|pixel| pixel.map(display)).collect();
    save_png(path, image.width, image.height, &pixels)
}
