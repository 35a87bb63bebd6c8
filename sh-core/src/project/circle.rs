//! Fourier sums over the texels of a row, and rows from Fourier coefficients.
//!
//! Columns `k` and `width−1−k` have opposite longitudes: cosines agree there and sines differ in sign. In maps of even
//! width the longitudes of `k` and `width/2−1−k` add up to half a turn, where the sign depends on the parity of `m` too. So
//! four texels share one column of the tables.

use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::TAU;

use crate::{Order, Real, dot};

/// Waves on a circle of texels, for one width and order; and the Fourier coefficients of one row.
#[derive(Clone, Debug)]
pub(super) struct Circle {
    cosine_waves: Waves,
    sine_waves: Waves,
    /// `[n]`: sums of a row with `cos(m longitude)`, or the coefficients of a row.
    pub(super) cosines: Vec<f64>,
    /// `[n]`: the same with sines; 0 for m = 0.
    pub(super) sines: Vec<f64>,
    /// `[width]`: the row.
    row: Vec<f64>,
}

impl Circle {
    pub(super) fn new(order: Order, width: usize) -> Self {
        let n = order.get();
        Self {
            cosine_waves: Waves::new(order, width, 1.0, Real::cos),
            sine_waves: Waves::new(order, width, -1.0, Real::sin),
            cosines: vec![0.0; n],
            sines: vec![0.0; n],
            row: vec![0.0; width],
        }
    }

    /// Takes the sums of a row.
    pub(super) fn analyse(&mut self, row: impl Iterator<Item = f64>) {
        self.row.iter_mut().zip(row).for_each(|(to, from)| *to = from);
        self.cosine_waves.analyse(&self.row, &mut self.cosines);
        self.sine_waves.analyse(&self.row, &mut self.sines);
    }

    /// The row with the coefficients `cosines` and `sines`.
    pub(super) fn synthesise(&mut self) -> &[f64] {
        self.row.fill(0.0);
        self.cosine_waves.synthesise(&self.cosines, &mut self.row);
        self.sine_waves.synthesise(&self.sines, &mut self.row);
        &self.row
    }
}

/// Either the cosines or the sines.
#[derive(Clone, Debug)]
struct Waves {
    /// The sign of the waves at the opposite longitude: 1 for cosines, −1 for sines.
    mirror: f64,
    /// Columns that are left after folding: `width/4`, or `width/2` of odd widths, rounded up.
    folded: usize,
    /// `[n, folded]`: the waves; halved at a column that is its own partner, which is met twice.
    table: Vec<f64>,
    /// `[2, folded]`: the parts of a row that the waves of even and of odd `m` see.
    parts: Vec<f64>,
}

impl Waves {
    fn new(order: Order, width: usize, mirror: f64, wave: fn(f64) -> f64) -> Self {
        let folded_circle = if width.is_multiple_of(2) { width / 2 } else { width };
        let folded = folded_circle.div_ceil(2);
        let share = |k: usize| if 2 * k + 1 == folded_circle { 0.5 } else { 1.0 };
        // Longitudes are whole multiples of a full turn / (2 width): reduced before they are rounded.
        let turns = |m: usize, k: usize| (m * (2 * k + 1) % (2 * width)) as f64 / (2 * width) as f64;
        let table = (0..order.get()).flat_map(|m| (0..folded).map(move |k| share(k) * wave(TAU * turns(m, k))));
        Self { mirror, folded, table: table.collect(), parts: vec![0.0; 2 * folded] }
    }

    /// `sums[m] = Σ row · wave_m`.
    fn analyse(&mut self, row: &[f64], sums: &mut [f64]) {
        self.fold(row);
        let (even, odd) = self.parts.split_at(self.folded);
        for (m, (sum, wave)) in sums.iter_mut().zip(self.table.chunks_exact(self.folded)).enumerate() {
            *sum = dot(wave, if m % 2 == 0 { even } else { odd });
        }
    }

    /// `row += Σ sums[m] wave_m`.
    fn synthesise(&mut self, sums: &[f64], row: &mut [f64]) {
        self.parts.fill(0.0);
        let (even, odd) = self.parts.split_at_mut(self.folded);
        for (m, (&sum, wave)) in sums.iter().zip(self.table.chunks_exact(self.folded)).enumerate() {
            let part = if m % 2 == 0 { &mut *even } else { &mut *odd };
            part.iter_mut().zip(wave).for_each(|(part, wave)| *part += sum * wave);
        }
        self.unfold(row);
    }

    /// Adds up the columns that share an entry of the table, with the signs that the waves have there.
    fn fold(&mut self, row: &[f64]) {
        let (length, last) = (row.len(), row.len() - 1);
        let (even, odd) = self.parts.split_at_mut(self.folded);
        for (k, (even, odd)) in even.iter_mut().zip(odd).enumerate() {
            let near = row[k] + self.mirror * row[last - k];
            (*even, *odd) = (near, near);
            if length.is_multiple_of(2) {
                let far = self.mirror * row[last / 2 - k] + row[length / 2 + k];
                *even += far;
                *odd -= far;
            }
        }
    }

    /// The adjoint of [`Waves::fold`].
    fn unfold(&self, row: &mut [f64]) {
        let (length, last) = (row.len(), row.len() - 1);
        let (even, odd) = self.parts.split_at(self.folded);
        for (k, (even, odd)) in even.iter().zip(odd).enumerate() {
            row[k] += even + odd;
            row[last - k] += self.mirror * (even + odd);
            if length.is_multiple_of(2) {
                row[last / 2 - k] += self.mirror * (even - odd);
                row[length / 2 + k] += even - odd;
            }
        }
    }
}
