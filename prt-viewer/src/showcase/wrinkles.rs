//! Wrinkles around a cylinder: the parametric model of a groove, whose depth changes along it.

use std::f64::consts::PI;

use prt_bake::{Material, Metadata, ZonalTexture};
use sh_core::Order;
use sh_fit::{LobeSet, WrinkleModel, WrinkleOptions};

use crate::lobes;

/// Deepest place of a wrinkle, in its widths.
const DEPTH: f64 = 0.7;
/// What the walls reflect.
const ALBEDO: f64 = 0.8;
/// Bounces of the truth.
const BOUNCES: usize = 3;
/// Texels across a wrinkle and along it.
const SIZE: [usize; 2] = [32, 96];

/// One wrinkle from end to end, deepest in the middle, as a texture that tiles across.
///
/// The walls reflect one another as far as light goes, which ray tracing follows for [`BOUNCES`] bounces.
pub(super) fn texture(order: Order) -> anyhow::Result<ZonalTexture> {
    let options = WrinkleOptions { order, max_depth: DEPTH, albedo: ALBEDO, ..WrinkleOptions::default() };
    let model = WrinkleModel::fit(&options)?;
    let [width, height] = SIZE;
    let LobeSet { channels, lobe_count, explicit_count, .. } = model.map;
    let mut set = LobeSet::zeros(order, channels, lobe_count, explicit_count, 0);
    let (mut heights, mut normals) = (Vec::new(), Vec::new());
    for row in 0..height {
        let depth = DEPTH * (PI * (row as f64 + 0.5) / height as f64).sin().powi(2);
        for column in 0..width {
            let x = (column as f64 + 0.5) / width as f64;
            let place = model.sample(x, depth);
            set.explicit.extend(place.explicit);
            set.axes.extend(place.axes);
            set.coeffs.extend(place.coeffs);
            let (height, normal) = model.surface(x, depth)?;
            heights.push(height as f32);
            normals.push(normal.map(|x| x as f32));
        }
    }
    Ok(ZonalTexture {
        metadata: Metadata {
            bounces: BOUNCES,
            shadowed: true,
            fit_error: Some(model.report.fit.relative_error),
            ..Metadata::default()
        },
        width,
        height,
        heights,
        normals,
        albedo: [ALBEDO as f32; 3],
        material: Material::Diffuse,
        is_coherent: true,
        transfer: lobes::stored(set),
    })
}
