//! A sky to coefficients, and the irradiance that it gives to surfaces: `cargo run -p sh-core --example 1_irradiance`.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

use sh_core::{Error, Order, Quadrature, clamped_cosine, convolve, project_function, reconstruct};

/// Radiance: a soft sun about +x, and a sky that is brighter towards +z.
fn radiance([x, _, z]: [f64; 3]) -> f64 {
    5.0 * x.max(0.0).powi(16) + 0.5 * (1.0 + z)
}

fn main() -> Result<(), Error> {
    let order = Order::new(5)?;

    // 1. Expand the radiance. The quadrature's degree is far above the order, because the sun is sharp.
    let mut light = vec![0.0; order.coeff_count()];
    project_function(order, &Quadrature::new(60), radiance, &mut light);

    // 2. Radiance becomes irradiance, as a function of the normal.
    let mut kernel = vec![0.0; order.get()];
    clamped_cosine(&mut kernel);
    convolve(order, &kernel, &mut light);

    // 3. Evaluate it.
    for normal in [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [0.0, 0.0, -1.0]] {
        println!("normal {normal:4.1?}: irradiance {:.3}", reconstruct::<f64>(order, &light, normal));
    }
    Ok(())
}
