use crate::Error;
use crate::angle::turn;
use sh_core::LatLong;

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
            (4..=Self::MAX_SIDE).contains(&width) && width % 2 == 0 && (2..=Self::MAX_SIDE).contains(&height);
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
/// Oriented as [`LatLong`] (y up). A border of one texel goes on around the seam and over the poles, where the longitude turns by half,
/// so that bilinear sampling needs no cases. Made by [`crate::cpu::build_table`], each time that the light changes.
#[derive(Debug, Clone, PartialEq)]
pub struct LobeTable {
    pub(crate) layout: TableLayout,
    /// `[H + 2, W + 1, bands]`, radiance in the first three components.
    pub(crate) texels: Vec<[f32; 4]>,
}

impl LobeTable {
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
    /// - `out`: `[band_count]`, overwritten; the fourth component is 0
    ///
    /// # Panics
    /// If the length of `out` does not match.
    pub fn sample(&self, axis: [f32; 3], out: &mut [[f32; 4]]) {
        assert_eq!(out.len(), self.layout.band_count, "bands of the table");
        self.sample_at(self.layout.place(axis), out);
    }

    /// The bands at a place found before.
    pub(crate) fn sample_at(&self, place: Place, out: &mut [[f32; 4]]) {
        let bands = self.layout.band_count;
        let below = self.layout.columns() * bands;
        let [s, t] = place.share;
        let start = place.texel as usize * bands;
        let [top, bottom] = [start, start + below].map(|row| &self.texels[row..row + 2 * bands]);
        let (top_left, top_right) = top.split_at(bands);
        let (bottom_left, bottom_right) = bottom.split_at(bands);
        let weights = [(1.0 - s) * (1.0 - t), s * (1.0 - t), (1.0 - s) * t, s * t];
        for (l, out) in out.iter_mut().enumerate() {
            let taps = [top_left[l], top_right[l], bottom_left[l], bottom_right[l]];
            *out = std::array::from_fn(|c| {
                (weights[0] * taps[0][c] + weights[1] * taps[1][c])
                    + (weights[2] * taps[2][c] + weights[3] * taps[3][c])
            });
        }
    }
}

/// Where a direction lies in a table: its upper left texel, border included, and how far it is towards the right and the lower one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Place {
    pub(crate) texel: u32,
    pub(crate) share: [f32; 2],
}

/// Size of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct TableLayout {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) band_count: usize,
}

impl TableLayout {
    /// Texels in a row, the border's one included.
    pub(crate) fn columns(&self) -> usize {
        self.width + 1
    }

    /// Texels, the border's included.
    pub(crate) fn texel_count(&self) -> usize {
        self.columns() * (self.height + 2)
    }

    /// Directions of all texels, row by row, border included.
    ///
    /// The border needs no case: a latitude above the pole comes down on the other side.
    pub(crate) fn directions(&self) -> impl Iterator<Item = [f32; 3]> {
        let (map, columns) = (LatLong { width: self.width, height: self.height }, self.columns());
        (0..self.texel_count()).map(move |i| {
            // The border's column is the first one, bit by bit.
            let (column, row) = (i % columns % map.width, i / columns);
            map.direction(column as f64 + 0.5, row as f64 - 0.5).map(|x| x as f32)
        })
    }

    /// The place of a direction. The twin of `place` in `shaders/shared/table.wgsl`.
    pub(crate) fn place(&self, [x, y, z]: [f32; 3]) -> Place {
        let (width, height) = (self.width as f32, self.height as f32);
        let column = turn(x, -z) * width - 0.5;
        let column = if column < 0.0 { column + width } else { column };
        // Half a turn from pole to pole.
        let row = turn((x * x + z * z).sqrt(), y) * (2.0 * height) + 0.5;
        // Rounding may reach the end of a row or of the table: then the share is 1. NaN lands on texel 0.
        let (i, j) = ((column as u32).min(self.width as u32 - 1), (row as u32).min(self.height as u32));
        Place { texel: j * (self.width as u32 + 1) + i, share: [column - i as f32, row - j as f32] }
    }
}
