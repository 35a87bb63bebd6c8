//! A sphere that is squeezed: its lobes follow the surface. Lit from above, shaded directly and from tables of several sizes, on the GPU
//! where there is one: prints the radiance down the middle, and how far each table is off.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

use prt_gpu::{Evaluation, Gpu, LobeRenderer, LobeShape, LobeSurface, Lobes, PoseFrames, Skin, View, cpu};
use sh_core::Order;

type Matrix = [[f32; 4]; 4];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let order = Order::new(4)?;
    // A sphere by latitude and longitude; its normals are its positions.
    let normal = |i: u32| {
        let (theta, phi) = ((i / 64) as f32 * 0.1, (i % 64) as f32 * std::f32::consts::TAU / 64.0);
        [theta.sin() * phi.cos(), theta.cos(), -theta.sin() * phi.sin()]
    };
    let normals: Vec<[f32; 3]> = (0..64 * 32).map(normal).collect();
    let cell = |i: u32| [[i, i + 64, i + 65], [i, i + 65, i + 1]];
    let triangles: Vec<[u32; 3]> = (0..64 * 31 - 1).flat_map(cell).collect();

    // Open transfer is one lobe about the normal: the clamped cosine over π, with DC explicit.
    let mut lobe = [0.0_f32; 4];
    sh_core::clamped_cosine(&mut lobe);
    sh_core::lobe_from_zonal(&mut lobe);
    lobe.iter_mut().for_each(|g| *g /= std::f32::consts::PI);
    let dc = lobe[0] * 0.5 / std::f32::consts::PI.sqrt();
    lobe[0] = 0.0;
    let shape = LobeShape { order, rows: 1, channels: 1, lobe_count: 1, explicit_count: 1 };
    let (explicit, coeffs) = (vec![dc; normals.len()], lobe.repeat(normals.len()));
    let lobes = Lobes::new(shape, &explicit, &normals, &coeffs, None)?;
    let albedo = vec![[0.8, 0.6, 0.4]; normals.len()];

    // One joint squeezes everything; the camera is parallel.
    let squeeze: Matrix = [[0.8, 0.0, 0.0, 0.0], [0.0, 0.3, 0.0, 0.0], [0.0, 0.0, 0.4, 0.0], [0.0, 0.0, 0.0, 1.0]];
    let (joints, weights) = (vec![[0; 4]; normals.len()], vec![[1.0, 0.0, 0.0, 0.0]; normals.len()]);
    let rest: Vec<_> = normals.iter().map(|n| tangent_frame(*n)).collect();
    let skin = Skin::new(&normals, &rest, &joints, &weights)?;
    let camera: Matrix = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0], [0.0, 0.0, 0.5, 1.0]];
    let view = View::new(camera, 33, 33, 2)?;

    let mut channel = [0.0; 16];
    sh_core::eval(order, [0.0, 1.0, 0.0], &mut channel);
    let light = [channel; 3].concat();

    let (mut positions, mut turned) = (normals.clone(), rest.clone());
    cpu::skin(&skin, &[squeeze], PoseFrames::FromRest, &mut positions, &mut turned);
    let surface = LobeSurface::new(&positions, &triangles, &albedo, lobes)?;
    let exact = cpu::render_lobes(&surface, &turned, &light, order, None, Evaluation::Direct, &view)?;
    for row in exact.pixels.chunks_exact(33).step_by(4) {
        println!("{:.3?}", row[16]);
    }

    let mut gpu = Gpu::headless().and_then(|gpu| {
        println!("{}", gpu.description());
        let mut renderer = LobeRenderer::new(&gpu, &surface)?;
        renderer.set_light(&light, order)?;
        renderer.set_skin(&skin)?;
        renderer.set_joints(&[squeeze])?;
        Ok(renderer)
    });
    for width in [16, 32, 64, 128] {
        let evaluation = Evaluation::Table { width, height: width / 2 };
        let frame = match &mut gpu {
            Ok(renderer) => {
                renderer.set_evaluation(evaluation)?;
                renderer.render(&view, None)?
            }
            Err(_) => cpu::render_lobes(&surface, &turned, &light, order, None, evaluation, &view)?,
        };
        let pairs = frame.pixels.as_flattened().iter().zip(exact.pixels.as_flattened());
        let worst = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        println!("table of {width} x {}: off by at most {worst:.1e}", width / 2);
    }
    Ok(())
}

/// Any tangent, the bitangent and the normal.
fn tangent_frame(n: [f32; 3]) -> [[f32; 3]; 3] {
    let axis = if n[1].abs() < 0.9 { [0.0, 1.0, 0.0] } else { [1.0, 0.0, 0.0] };
    let cross =
        |a: [f32; 3], b: [f32; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let t = cross(axis, n);
    let length = t.iter().map(|x| x * x).sum::<f32>().sqrt();
    let t = t.map(|x| x / length);
    [t, cross(n, t), n]
}
