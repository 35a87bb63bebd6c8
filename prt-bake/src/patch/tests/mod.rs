#![expect(clippy::unwrap_used, reason = "tests")]

mod field;
mod glossy;
mod opaque;
mod rays;
mod slab;
mod translucent;

use sh_core::Order;

use super::*;

fn order(n: usize) -> Order {
    Order::new(n).unwrap()
}

fn options(n: usize, rays: usize) -> PatchOptions {
    PatchOptions { order: order(n), rays_per_texel: rays, ..PatchOptions::default() }
}

fn bake(field: &HeightField, options: &PatchOptions) -> PatchTransfer {
    bake_patch(field, options, &()).unwrap().0
}

fn flat(width: usize, height: usize) -> HeightField {
    HeightField::new(width, height, vec![0.25; width * height]).unwrap()
}

/// Heights from 0 to `top`, with neither symmetry nor smoothness.
fn rough(width: usize, height: usize, top: f32, seed: u64) -> HeightField {
    let mut random = crate::sampling::Random::new(seed);
    HeightField::new(width, height, (0..width * height).map(|_| top * random.unit() as f32).collect()).unwrap()
}

/// The field moved by whole texels.
fn shifted(field: &HeightField, by: [usize; 2]) -> HeightField {
    let heights = (0..field.texel_count()).map(|texel| field.heights()[moved(field, texel, by)]).collect();
    HeightField::new(field.width(), field.height(), heights).unwrap()
}

/// The texel that stands at `texel` once a field is moved.
fn moved(field: &HeightField, texel: usize, by: [usize; 2]) -> usize {
    let (column, row) = (texel % field.width() + by[0], texel / field.width() + by[1]);
    row % field.height() * field.width() + column % field.width()
}

/// Root-mean-square difference, relative to `b`.
fn relative_difference(a: &[f32], b: &[f32]) -> f64 {
    let square = |values: &mut dyn Iterator<Item = f64>| values.map(|value| value * value).sum::<f64>();
    let difference = square(&mut a.iter().zip(b).map(|(a, b)| f64::from(a - b)));
    (difference / square(&mut b.iter().map(|&b| f64::from(b)))).sqrt()
}

/// The value of a uniform light of radiance 1 for a transfer vector.
fn white(vector: &[f32]) -> f64 {
    f64::from(vector[0]) * (4.0 * std::f64::consts::PI).sqrt()
}
