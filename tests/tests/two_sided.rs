//! A two-sided leaf, from the material to the picture: each side shows its own light, and the two do not fight.
#![expect(clippy::unwrap_used, reason = "tests")]

use prt_bake::{BakeOptions, Geometry, Mesh, MeshOptions, MeshSource, SurfaceMaterial, bake_diffuse};
use prt_gpu::{Surface, View, cpu};
use sh_core::Order;

/// How steep the leaf is: at depth of its own in every pixel.
const SLOPE: f64 = 0.3;

fn leaf() -> Mesh {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let source = MeshSource {
        positions: corners.map(|[x, y]| [x, y, SLOPE * x]).to_vec(),
        albedo: vec![[0.8; 3]; 4],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        materials: vec![SurfaceMaterial { two_sided: true, ..SurfaceMaterial::default() }],
        face_material: vec![0; 2],
        ..MeshSource::default()
    };
    Mesh::new(source, &MeshOptions::default()).unwrap().0
}

/// From above (`side` 1) or below (−1), without perspective.
fn view(side: f32) -> View {
    View::new(
        [[0.9 * side, 0.0, 0.0, 0.0], [0.0, 0.9, 0.0, 0.0], [0.0, 0.0, -0.1 * side, 0.0], [0.01, 0.02, 0.5, 1.0]],
        32,
        32,
        2,
    )
    .unwrap()
}

#[test]
fn each_side_of_a_leaf_shows_the_light_that_falls_on_it() {
    let order = Order::new(2).unwrap();
    let options = BakeOptions { order, rays_per_vertex: 64, ..BakeOptions::default() };
    let (baked, _) = bake_diffuse(&leaf(), &options, &()).unwrap();
    let Geometry { positions, triangles, albedo, .. } = &baked.geometry;
    let surface = Surface::new(positions, triangles, albedo, order, 1, &baked.transfer.values).unwrap();
    // Radiance 1 + z/2: on a surface of normal n the mean under the cosine is 1 + n_z/3.
    let constant = (4.0 * std::f32::consts::PI).sqrt();
    let light = [constant, 0.0, 0.5 * constant / 3.0_f32.sqrt(), 0.0].repeat(3);
    for side in [1.0, -1.0] {
        let normal_z = f64::from(side) / (1.0 + SLOPE * SLOPE).sqrt();
        let expected = (0.8 * (1.0 + normal_z / 3.0)) as f32;
        let frame = cpu::render(&surface, &light, order, &view(side)).unwrap();
        let covered: Vec<_> = frame.pixels.iter().filter(|pixel| pixel[3] == 1.0).collect();
        assert!(covered.len() > 700, "{}", covered.len());
        for pixel in covered {
            assert!(pixel[..3].iter().all(|channel| (channel - expected).abs() < 1e-5), "{pixel:?} {expected}");
        }
    }
}
