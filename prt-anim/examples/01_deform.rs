//! Bends a strip by half a circle and turns a lobe with it.
//!
//! `cargo run --example 01_deform -p prt-anim`
#![expect(clippy::print_stdout, reason = "an example shows what it finds")]

use prt_anim::{Deformation, Deformed};

fn main() {
    // A strip of points along x whose lobes look up.
    let positions: Vec<[f32; 3]> = (0..=8).map(|i| [i as f32 / 4.0 - 1.0, 0.0, 0.0]).collect();
    let normals = vec![[0.0, 0.0, 1.0]; positions.len()];
    let bend = Deformation::bend([[-1.0, -0.1, 0.0], [1.0, 0.1, 0.0]], std::f64::consts::PI);

    let mut deformed = Deformed::default();
    bend.deform(&positions, &normals, &mut deformed);
    for (position, [c0, c1, c2]) in deformed.positions.iter().zip(&deformed.frames) {
        let rest_axis = [0.6, 0.0, 0.8];
        let axis: [f32; 3] =
            std::array::from_fn(|i| c0[i] * rest_axis[0] + c1[i] * rest_axis[1] + c2[i] * rest_axis[2]);
        println!("a lobe at {position:.3?} has the axis {axis:.3?}");
    }
}
