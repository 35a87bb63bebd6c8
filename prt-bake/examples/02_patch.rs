//! Bakes the paper's patterns and paints them: `cargo run --release -p prt-bake --example 02_patch -- FOLDER`.
//!
//! For each pattern three pictures: all the light there is (the first coefficient), a light from the left (u = 0), and from the upper
//! right (u and v grow to the right and upwards).

use std::path::Path;

use prt_bake::{HeightField, Image, Medium, PatchOptions, PatchTransfer, bake_patch};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).ok_or("give a folder to write pictures to")?;
    // 1. Relief as a function; `HeightField::from_image` reads it from a file.
    let patterns = [
        ("bumps", HeightField::bumps(64, 0.15)?),
        ("weave", HeightField::weave(64, 0.12)?),
        ("waffle", HeightField::waffle(64, 0.15)?),
        ("swirl", HeightField::swirl(64, 0.15)?),
    ];
    // 2. What it is made of: stone, with one bounce; and wax, a thin sheet that light comes through.
    let stone = PatchOptions { bounces: 1, ..PatchOptions::preview() };
    let wax = PatchOptions { scattering: Some(Medium::default()), thickness: Some(0.03), ..PatchOptions::preview() };
    for (name, field) in patterns {
        for (material, options) in [("stone", &stone), ("wax", &wax)] {
            // 3. Transfer in tangent space: its dot product with a light in that frame is the radiance.
            let (transfer, _) = bake_patch(&field, options, &())?;
            for (light, direction) in
                [("left", [-0.8, 0.0, 0.6]), ("right", [0.48, 0.48, 0.734]), ("below", [0.0, 0.0, -1.0])]
            {
                let file = format!("{name}-{material}-{light}.png");
                picture(&transfer, direction).save(&Path::new(&folder).join(file))?;
            }
        }
    }
    Ok(())
}

/// Two by two tiles, row 0 at the bottom, lit from one direction as bright as white paper would be at right angles, and 0.2 from all.
fn picture(transfer: &PatchTransfer, direction: [f64; 3]) -> Image {
    let mut light = vec![0.0; transfer.order.coeff_count()];
    sh_core::directional_light(transfer.order, direction, &mut light);
    light.iter_mut().for_each(|value| *value *= std::f64::consts::PI);
    light[0] += 0.2 * (4.0 * std::f64::consts::PI).sqrt();
    let (width, height) = (2 * transfer.width, 2 * transfer.height);
    let pixel = |column: usize, row: usize| {
        let texel = (height - 1 - row) % transfer.height * transfer.width + column % transfer.width;
        [0, 1, 2].map(|channel| {
            transfer.vector(texel, 0, channel).iter().zip(&light).map(|(&t, l)| f64::from(t) * l).sum::<f64>() as f32
        })
    };
    let pixels = (0..height).flat_map(|row| (0..width).map(move |column| pixel(column, row))).collect();
    Image { width, height, pixels }
}
