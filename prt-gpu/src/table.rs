use crate::Error;
use crate::angle::turn;
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
        let top = place.texel as usize * block_count + block;
        let bottom = top + self.layout.columns() * block_count;
        let [a, b, c, d] = [top, top + block_count, bottom, bottom + block_count].map(|i| &self.texels[i]);
        let [p, q, r, s] = place.weights.map(f32x4::splat);
        std::array::from_fn(|k| (p * a[k] + q * b[k]) + (r * c[k] + s * d[k]))
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

    /// The place of a direction. The twin of `table_place` in `shaders/shared/lobes.wgsl`.
    pub(crate) fn place(&self, direction: [f32; 3]) -> Place {
        self.place_at(self.coordinates(direction))
    }

    /// The places of many directions.
    pub(crate) fn places(&self, directions: &[[f32; 3]], out: &mut Vec<Place>) {
        out.clear();
        let (whole, rest) = directions.as_chunks::<LANES>();
        for directions in whole {
            // Components beside each other: both loops are vectorised.
            let [x, y, z] = [0, 1, 2].map(|i| directions.map(|d| d[i]));
            let (mut columns, mut rows) = ([0.0; LANES], [0.0; LANES]);
            for k in 0..LANES {
                [columns[k], rows[k]] = self.coordinates([x[k], y[k], z[k]]);
            }
            out.extend((0..LANES).map(|k| self.place_at([columns[k], rows[k]])));
        }
        out.extend(rest.iter().map(|direction| self.place(*direction)));
    }

    /// Column and row in texels, border included, from the centre of the first texel.
    #[inline(always)]
    fn coordinates(&self, [x, y, z]: [f32; 3]) -> [f32; 2] {
        let (width, height) = (self.width as f32, self.height as f32);
        let column = turn(x, -z) * width - 0.5;
        let column = if column < 0.0 { column + width } else { column };
        // Half a turn from pole to pole.
        [column, turn((x * x + z * z).sqrt(), y) * (2.0 * height) + 0.5]
    }

    #[inline(always)]
    fn place_at(&self, [column, row]: [f32; 2]) -> Place {
        // Rounding may reach the end of a row or of the table: then the share is 1. NaN lands on texel 0.
        let (i, j) = ((column as i32).min(self.width as i32 - 1), (row as i32).min(self.height as i32));
        let (s, t) = (column - i as f32, row - j as f32);
        let weights = [(1.0 - s) * (1.0 - t), s * (1.0 - t), (1.0 - s) * t, s * t];
        Place { texel: (j * (self.width as i32 + 1) + i) as u32, weights }
    }
}
