//! Filling the texels around charts.

use super::grid::Grid;
use super::{Coverage, TexelTransfer};

/// Steps of columns and rows.
type Step = (i64, i64);

/// Gives empty texels up to `gutter` texels from a baked one the mean of the nearest baked ones, which are all equally far.
pub(super) fn fill(atlas: &mut TexelTransfer, gutter: usize) {
    let grid = atlas.grid();
    let rings = rings(gutter);
    for texel in 0..grid.texel_count() {
        if atlas.coverage[texel] == Coverage::Empty && fill_texel(atlas, grid, &rings, texel) {
            atlas.coverage[texel] = Coverage::Filled;
        }
    }
}

/// Steps to all texels at most `radius` away, in groups of equal distance, the nearest first.
fn rings(radius: usize) -> Vec<Vec<Step>> {
    let radius = radius as i64;
    let mut rings = std::collections::BTreeMap::<i64, Vec<Step>>::new();
    for step in (-radius..=radius).flat_map(|y| (-radius..=radius).map(move |x| (x, y))) {
        let distance_squared = step.0 * step.0 + step.1 * step.1;
        if (1..=radius * radius).contains(&distance_squared) {
            rings.entry(distance_squared).or_default().push(step);
        }
    }
    rings.into_values().collect()
}

/// Whether a baked texel was near enough.
fn fill_texel(atlas: &mut TexelTransfer, grid: Grid, rings: &[Vec<Step>], texel: usize) -> bool {
    let (column, row) = ((texel % grid.width) as i64, (texel / grid.width) as i64);
    let near = |ring: &Vec<Step>| -> Vec<usize> {
        let around = ring.iter().filter_map(|(x, y)| grid.texel(column + x, row + y));
        around.filter(|&other| atlas.coverage[other].is_baked()).collect()
    };
    let Some(sources) = rings.iter().map(near).find(|sources| !sources.is_empty()) else { return false };
    let length = atlas.transfer.channels * atlas.transfer.order.coeff_count();
    for k in 0..length {
        let sum: f64 = sources.iter().map(|&source| f64::from(atlas.transfer.values[source * length + k])).sum();
        atlas.transfer.values[texel * length + k] = (sum / sources.len() as f64) as f32;
    }
    true
}
