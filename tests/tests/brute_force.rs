//! Baked transfer against random directions and no tree, and its error against the number of rays.
#![expect(clippy::unwrap_used, reason = "tests")]

use glam::DVec3;
use prt_bake::{BakeOptions, Mesh, bake_diffuse};
use prt_tests::{SceneBuilder, brute_force_transfer, disk, grid, icosphere};
use sh_core::Order;

/// No vertex lies in the plane of a face that it does not belong to: there the answer depends on which side of it the vertex is, and
/// only the baker takes a side.
fn scene() -> Mesh {
    SceneBuilder::default()
        .add(grid(DVec3::new(-2.0, -2.0, -0.05), 4.0 * DVec3::X, 4.0 * DVec3::Y, 12), [0.8; 3])
        .add(icosphere(DVec3::new(0.3, 0.2, 0.8), 0.7, 2), [0.8; 3])
        .add(grid(DVec3::new(-1.5, -1.5, 0.0), 3.0 * DVec3::Y, 1.2 * DVec3::Z, 6), [0.8; 3])
        .add(disk(DVec3::new(0.9, -0.8, 1.1), DVec3::new(0.6, 0.0, -0.8), 0.6, 4), [0.8; 3])
        .build()
        .unwrap()
}

#[test]
fn two_hundred_vertices_agree_within_three_standard_errors() {
    let mesh = scene();
    let order = Order::new(6).unwrap();
    let options = BakeOptions { order, rays_per_vertex: 16384, ..BakeOptions::default() };
    let (baked, _) = bake_diffuse(&mesh, &options, &()).unwrap();
    let step = mesh.positions().len() / 200;
    let mut worst: f64 = 0.0;
    for k in 0..200 {
        let vertex = k * step;
        let truth = brute_force_transfer(&mesh, vertex, order, 2000, 77);
        let difference: f64 =
            baked.transfer.vector(vertex, 0).iter().zip(&truth.mean).map(|(a, b)| (f64::from(*a) - b).powi(2)).sum();
        let ratio = difference.sqrt() / truth.standard_error;
        worst = worst.max(ratio);
        assert!(ratio < 3.0, "vertex {vertex}: {ratio} standard errors");
    }
    assert!(worst > 0.5, "the worst of 200 is {worst} standard errors: the estimate of the error is wrong");
}

#[test]
fn the_error_falls_faster_than_one_over_the_root_of_the_rays() {
    let mesh = scene();
    let order = Order::new(6).unwrap();
    let bake = |rays, seed| {
        let options = BakeOptions { order, rays_per_vertex: rays, seed, ..BakeOptions::default() };
        bake_diffuse(&mesh, &options, &()).unwrap().0.transfer.values
    };
    let truth = bake(1 << 17, 1);
    let error = |rays| {
        let found = bake(rays, 2);
        found.iter().zip(&truth).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>().sqrt()
    };
    let (few, more, many) = (error(256), error(1024), error(4096));
    // Random directions would gain a factor of 2 for 4 times the rays; a spherical Fibonacci set gains about 2.8 at an edge.
    assert!(more < few / 2.2 && many < more / 2.2, "{few} {more} {many}");
}
