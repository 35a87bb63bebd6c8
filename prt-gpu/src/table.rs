use crate::Error;
use crate::angle::turn;
use multiversion::multiversion;
use std::f64::consts::{PI, TAU};
use wide::f32x4;

/// How the bands of a light are evaluated along a lobe's axis: speed against accuracy.
///
/// Errors and times of all sizes: `cargo run --release -p prt-benches --bin repro -- ldprt/table`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Evaluation {
    /// All `n²` basis functions at each axis (eq. 13 of \[SLS05\]): exact.
    Direct,
    /// A [`LobeTable`] of the light (eq. 24-25): `n` interpolated numbers per axis and channel.
    Table {
        /// Texels around the equator: even, 4 to 1024.
        width: usize,
        /// Texels from pole to pole: 2 to 1024.
        height: usize,
    },
}

impl Default for Evaluation {
    /// The paper's table of 64 by 32.
    fn default() -> Self {
        Self::Table { width: 64, height: 32 }
    }
}

impl Evaluation {
    const MAX_SIDE: usize = 1024;

    /// Checks the size of the table.
    ///
    /// # Errors
    /// [`Error::Lobes`].
    pub fn check(&self) -> Result<(), Error> {
        let Self::Table { width, height } = *self else { return Ok(()) };
        let is_valid =
            (4..=Self::MAX_SIDE).contains(&width) && width.is_multiple_of(2) && (2..=Self::MAX_SIDE).contains(&height);
        match is_valid {
            true => Ok(()),
            false => Err(Error::Lobes(format!(
                "a table of {width} x {height} was asked for; an even width of 4 to {0} and a height of 2 to {0} are accepted",
                Self::MAX_SIDE
            ))),
        }
    }
}

/// A light by bands, in latitude and longitude: `ê_l(s) = Σ_m y_lm(s) e_lm` for three channels (eq. 24 of \[SLS05\]).
///
/// Oriented as [`sh_core::LatLong`] (y up). A border of one texel goes on around the seam and over the poles, where the longitude turns by half,
/// so that bilinear sampling needs no cases. Made by [`crate::cpu::build_table`], each time that the light changes.
#[derive(Debug, Clone, PartialEq)]
pub struct LobeTable {
    pub(crate) layout: TableLayout,
    /// `[H + 2, W + 1, ⌈bands/4⌉]`.
    pub(crate) texels: Vec<Block>,
}

/// Four bands of three channels; zeros beyond the last band.
pub(crate) type Block = [f32x4; 3];

impl LobeTable {
    /// From the order of the GPU, `[texels, bands]` with radiance in the first three components.
    pub(crate) fn from_bands(layout: TableLayout, bands: &[[f32; 4]]) -> Self {
        let blocks = layout.block_count();
        let mut texels = vec![[f32x4::ZERO; 3]; layout.texel_count() * blocks];
        for (i, band) in bands.iter().enumerate() {
            let (texel, l) = (i / layout.band_count, i % layout.band_count);
            (0..3).for_each(|c| texels[texel * blocks + l / 4][c].as_mut_array()[l % 4] = band[c]);
        }
        Self { layout, texels }
    }

    /// Texels around the equator.
    pub fn width(&self) -> usize {
        self.layout.width
    }

    /// Texels from pole to pole.
    pub fn height(&self) -> usize {
        self.layout.height
    }

    /// Number of bands held.
    pub fn band_count(&self) -> usize {
        self.layout.band_count
    }

    /// The bands at an axis, bilinear: `out[l]` is red, green and blue of `ê` in the `l`-th band held.
    ///
    /// - `axis`: unit length
    /// - `out`: `[band_count]`, overwritten
    ///
    /// # Panics
    /// If the length of `out` does not match.
    pub fn sample(&self, axis: [f32; 3], out: &mut [[f32; 3]]) {
        assert_eq!(out.len(), self.layout.band_count, "bands of the table");
        let place = self.layout.place(axis);
        for (block, out) in out.chunks_mut(4).enumerate() {
            let bands = self.block(&place, block, self.layout.block_count()).map(f32x4::to_array);
            out.iter_mut().enumerate().for_each(|(l, out)| *out = bands.map(|channel| channel[l]));
        }
    }

    /// The `block`-th of `block_count` blocks at a place, bilinear.
    #[inline(always)]
    pub(crate) fn block(&self, place: &Place, block: usize, block_count: usize) -> Block {
        let upper = &self.texels[place.texel as usize * block_count + block..];
        let lower = &upper[self.layout.columns() * block_count..];
        let (a, b, c, d) = (&upper[0], &upper[block_count], &lower[0], &lower[block_count]);
        let [p, q, r, s] = place.weights.map(f32x4::splat);
        let mix = |k: usize| (p * a[k] + q * b[k]) + (r * c[k] + s * d[k]);
        [mix(0), mix(1), mix(2)]
    }
}

/// Where a direction lies in a table: its upper left texel, border included, and the weights of that, the right, and the two below.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Place {
    pub(crate) texel: u32,
    pub(crate) weights: [f32; 4],
}

/// Directions that are placed at once, in registers.
const LANES: usize = 8;

/// The places of up to eight directions, each number beside its like.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Places {
    texels: [u32; LANES],
    weights: [[f32; LANES]; 4],
}

impl Places {
    /// How many hold the places of some directions.
    pub(crate) fn count(directions: usize) -> usize {
        directions.div_ceil(LANES)
    }

    /// The place of a direction.
    #[inline(always)]
    pub(crate) fn nth(places: &[Self], i: usize) -> Place {
        let (Self { texels, weights: [a, b, c, d] }, lane) = (&places[i / LANES], i % LANES);
        Place { texel: texels[lane], weights: [a[lane], b[lane], c[lane], d[lane]] }
    }
}

/// Size of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct TableLayout {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) band_count: usize,
}

impl TableLayout {
    /// Blocks of a texel.
    pub(crate) fn block_count(&self) -> usize {
        self.band_count.div_ceil(4)
    }

    /// Texels in a row, the border's one included.
    pub(crate) fn columns(&self) -> usize {
        self.width + 1
    }

    /// Texels, the border's included.
    pub(crate) fn texel_count(&self) -> usize {
        self.columns() * (self.height + 2)
    }

    /// Sines and cosines of the longitudes of columns and the latitudes of rows, border included.
    ///
    /// The border needs no case: a latitude above the pole comes down on the other side. Its column is the first one, bit by bit.
    pub(crate) fn angles(&self) -> Vec<[f32; 2]> {
        let sine_cosine = |angle: f64| [angle.sin() as f32, angle.cos() as f32];
        let columns = (0..self.columns()).map(|i| TAU * ((i % self.width) as f64 + 0.5) / self.width as f64);
        let rows = (0..self.height + 2).map(|j| PI * (j as f64 - 0.5) / self.height as f64);
        columns.chain(rows).map(sine_cosine).collect()
    }

    /// Directions of all texels, row by row, border included.
    pub(crate) fn directions(&self) -> Vec<[f32; 3]> {
        let angles = self.angles();
        let (columns, rows) = angles.split_at(self.columns());
        let direction = |row: &[f32; 2], column: &[f32; 2]| [row[0] * column[0], row[1], -row[0] * column[1]];
        rows.iter().flat_map(|row| columns.iter().map(move |column| direction(row, column))).collect()
    }

    /// The place of a direction.
    pub(crate) fn place(&self, direction: [f32; 3]) -> Place {
        let mut places = [Places::default()];
        self.places(&[direction], &mut places);
        Places::nth(&places, 0)
    }

    /// The places of directions, `⌈D/8⌉`. The twin of `table_place` in `shaders/shared/lobes.wgsl`.
    pub(crate) fn places(&self, directions: &[[f32; 3]], out: &mut [Places]) {
        place_all([self.width as f32, self.height as f32], directions, out);
    }
}

/// The places of directions in a table of some width and height.
#[multiversion(targets("x86_64+avx+avx2"))]
fn place_all(size: [f32; 2], directions: &[[f32; 3]], out: &mut [Places]) {
    let (whole, rest) = directions.as_chunks::<LANES>();
    let mut out = out.iter_mut();
    for (directions, out) in whole.iter().zip(&mut out) {
        *out = place_lanes(size, directions);
    }
    if let (false, Some(out)) = (rest.is_empty(), out.next()) {
        let mut directions = [[0.0; 3]; LANES];
        directions[..rest.len()].copy_from_slice(rest);
        *out = place_lanes(size, &directions);
    }
}

/// The places of eight directions: loops over arrays, which compilers turn into registers.
#[inline(always)]
fn place_lanes([width, height]: [f32; 2], directions: &[[f32; 3]; LANES]) -> Places {
    let mut places = Places::default();
    for (k, &[x, y, z]) in directions.iter().enumerate() {
        // Column and row in texels, border included, from the centre of the first texel.
        let column = turn(x, -z) * width - 0.5;
        let column = if column < 0.0 { column + width } else { column };
        // Half a turn from pole to pole.
        let row = turn((x * x + z * z).sqrt(), y) * (2.0 * height) + 0.5;
        let (i, j) = (floor_within(column, width - 1.0), floor_within(row, height));
        let (s, t) = (column - i, row - j);
        let (right, below) = (s * (1.0 - t), s * t);
        places.texels[k] = integer(j * (width + 1.0) + i);
        places.weights[0][k] = (1.0 - t) - right;
        places.weights[1][k] = right;
        places.weights[2][k] = t - below;
        places.weights[3][k] = below;
    }
    places
}

/// Added to a number from 0 to 2²³, it leaves the nearest integer in the 23 low bits.
const INTEGERS: f32 = 8_388_608.0;

/// The integer below `x`, between 0 and `last`; 0 for NaN. Integers may count as the end of the interval before them.
#[inline(always)]
fn floor_within(x: f32, last: f32) -> f32 {
    let centre = x - 0.5;
    let centre = if centre > 0.0 { centre } else { 0.0 };
    let centre = if centre < last { centre } else { last };
    (centre + INTEGERS) - INTEGERS
}

/// An integer below 2²³ that is held by a float.
#[inline(always)]
fn integer(x: f32) -> u32 {
    (x + INTEGERS).to_bits() & 0x7f_ffff
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Column and row in texels, border included, in `f64`.
    fn exact_place(layout: &TableLayout, direction: [f32; 3]) -> [f64; 2] {
        let ([x, y, z], width) = (direction.map(f64::from), layout.width as f64);
        let column = (x.atan2(-z) / TAU * width - 0.5).rem_euclid(width);
        [column, x.hypot(z).atan2(y) / PI * layout.height as f64 + 0.5]
    }

    proptest! {
        /// Eight at a time, and a few left over: the weights of each place add up to 1 and have their centre in the direction.
        #[test]
        fn directions_have_their_places(
            directions in prop::collection::vec(prop::array::uniform3(-1.0_f32..1.0), 1..20),
            half_width in 2_usize..=512,
            height in 2_usize..=1024,
        ) {
            let layout = TableLayout { width: 2 * half_width, height, band_count: 1 };
            let mut places = vec![Places::default(); Places::count(directions.len())];
            layout.places(&directions, &mut places);
            for (i, direction) in directions.iter().enumerate() {
                let Place { texel, weights } = Places::nth(&places, i);
                prop_assert!(weights.iter().all(|w| (-1e-6..1.000_001).contains(w)), "{weights:?}");
                prop_assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-6);
                let (column, row) = (texel as usize % layout.columns(), texel as usize / layout.columns());
                prop_assert!(column < layout.width && row <= height);
                let [exact_column, exact_row] = exact_place(&layout, *direction);
                let across = (column as f64 + f64::from(weights[1] + weights[3]) - exact_column).abs();
                let down = (row as f64 + f64::from(weights[2] + weights[3]) - exact_row).abs();
                // A turn is 1e-7 off at most, and as much is lost when the half texel is taken off.
                prop_assert!(across.min(layout.width as f64 - across) < 3e-4, "{across}");
                prop_assert!(down < 6e-4, "{down}");
            }
        }
    }
}
