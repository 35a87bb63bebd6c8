//! A sphere with the transfer of an open sky, lit from above, drawn on the GPU where there is one: prints the radiance down the middle.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

use prt_gpu::{Gpu, Surface, SurfaceRenderer, View, cpu};
use sh_core::Order;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let order = Order::new(3)?;
    // A sphere of radius 0.8 by latitude and longitude; its normals are its positions.
    let normal = |i: u32| {
        let (theta, phi) = ((i / 64) as f32 * 0.1, (i % 64) as f32 * std::f32::consts::TAU / 64.0);
        [theta.sin() * phi.cos(), theta.cos(), -theta.sin() * phi.sin()]
    };
    let normals: Vec<[f32; 3]> = (0..64 * 32).map(normal).collect();
    let positions: Vec<[f32; 3]> = normals.iter().map(|n| [0.8 * n[0], 0.8 * n[1], 0.5 - 0.4 * n[2]]).collect();
    let cell = |i: u32| [[i, i + 64, i + 65], [i, i + 65, i + 1]];
    let triangles: Vec<[u32; 3]> = (0..64 * 31 - 1).flat_map(cell).collect();

    // Open transfer: the cosine lobe about the normal, over π. Its factors of bands 0, 1, 2 are 1, 2/3, 1/4.
    let mut transfer = vec![0.0; normals.len() * 9];
    for (row, normal) in transfer.chunks_exact_mut(9).zip(&normals) {
        sh_core::eval(order, *normal, row);
        for (band, range) in order.bands() {
            row[range].iter_mut().for_each(|y| *y *= [1.0, 2.0 / 3.0, 0.25][band]);
        }
    }
    let albedo = vec![[0.8, 0.6, 0.4]; normals.len()];
    let surface = Surface::new(&positions, &triangles, &albedo, order, 1, &transfer)?;

    // A light from above, +y, in three equal channels.
    let mut channel = [0.0; 9];
    sh_core::eval(order, [0.0, 1.0, 0.0], &mut channel);
    let light = [channel; 3].concat();

    let identity = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
    let view = View::new(identity, 33, 33, 2)?;
    let frame = match Gpu::headless() {
        Ok(gpu) => {
            println!("{}", gpu.description());
            let mut renderer = SurfaceRenderer::new(&gpu, &surface)?;
            renderer.set_light(&light, order)?;
            renderer.render(&view)?
        }
        Err(error) => {
            println!("{error}: drawing on the CPU");
            cpu::render(&surface, &light, order, &view)?
        }
    };
    for row in frame.pixels.chunks_exact(33).step_by(4) {
        println!("{:.3?}", row[16]);
    }
    Ok(())
}
