//! A lobe, turned step by step: `cargo run -p sh-core --example 2_rotate`.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

use sh_core::{Error, Order, ShRotation, expand_zonal};

fn main() -> Result<(), Error> {
    let order = Order::new(4)?;

    // 1. A lobe about +x.
    let mut lobe = vec![0.0_f64; order.coeff_count()];
    expand_zonal(order, &[1.0, 0.8, 0.4, 0.1], [1.0, 0.0, 0.0], &mut lobe);

    // 2. A rotation by 30° about z, built once.
    let (sin, cos) = 30_f64.to_radians().sin_cos();
    let rotation = ShRotation::new(order, [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]);

    // 3. Apply it again and again; the axis is in band 1, with our signs (−f_11, −f_1−1, f_10).
    let mut turned = vec![0.0; order.coeff_count()];
    for step in 0..=3 {
        let azimuth = (-lobe[1]).atan2(-lobe[3]).to_degrees();
        println!("after {step} steps the axis is at {azimuth:5.1}°");
        rotation.apply(&lobe, &mut turned);
        std::mem::swap(&mut lobe, &mut turned);
    }
    Ok(())
}
