//! The function to be fitted.

use sh_core::{Order, eval};

use super::generators::turn;

/// Numbers kept per coefficient for values and derivatives: 10, and 2 that round the row up to whole registers.
pub(super) const JET: usize = 12;
/// Where the second derivatives about two coordinate axes stand in a jet.
pub(super) const SECOND: [[usize; 3]; 3] = [[4, 5, 6], [5, 7, 8], [6, 8, 9]];

/// The vector to be fitted, at unit length, and what rotations by small angles make of it.
#[derive(Debug, Clone)]
pub(crate) struct Signal {
    pub(super) order: Order,
    pub(super) channels: usize,
    /// The bands below are stored explicitly.
    pub(super) first_band: usize,
    /// Length of the vector as given.
    length: f64,
    /// Squared length of the fitted bands, of at most 1.
    fitted: f64,
    /// `[C, n²]`: the vector over its length.
    target: Vec<f64>,
    /// `[C, n²]`: `f`, `D_a f`, and the symmetric part of `D_a D_b f` for coordinate axes `a`, `b`.
    jets: Vec<[f64; JET]>,
}

impl Signal {
    /// Room for vectors of `channels` channels; zero until one is loaded.
    pub(crate) fn new(order: Order, channels: usize, first_band: usize) -> Self {
        let count = channels * order.coeff_count();
        Self {
            order,
            channels,
            first_band,
            length: 0.0,
            fitted: 0.0,
            target: vec![0.0; count],
            jets: vec![[0.0; JET]; count],
        }
    }

    /// Takes a vector `[C, n²]` of finite numbers.
    pub(crate) fn load(&mut self, target: &[f64]) {
        // The largest one first: the square of neither huge nor tiny numbers is a number.
        let largest = target.iter().fold(0.0_f64, |max, t| max.max(t.abs()));
        self.target.fill(0.0);
        self.length = 0.0;
        if largest > 0.0 {
            self.target.iter_mut().zip(target).for_each(|(unit, t)| *unit = t / largest);
            let length = self.target.iter().map(|t| t * t).sum::<f64>().sqrt();
            self.target.iter_mut().for_each(|t| *t /= length);
            self.length = largest * length;
        }
        self.prepare();
    }

    /// The fitted length and the jets, from the target.
    fn prepare(&mut self) {
        let (order, count) = (self.order, self.order.coeff_count());
        self.fitted = 0.0;
        let mut first = [const { Vec::new() }; 3];
        let mut second = [const { [const { Vec::new() }; 3] }; 3];
        for (target, jets) in self.target.chunks_exact(count).zip(self.jets.chunks_exact_mut(count)) {
            self.fitted += target[self.first_band.pow(2).min(count)..].iter().map(|t| t * t).sum::<f64>();
            turn(order, target, &mut first);
            first.iter().zip(&mut second).for_each(|(first, second)| turn(order, first, second));
            for (i, jet) in jets.iter_mut().enumerate() {
                jet[0] = target[i];
                for a in 0..3 {
                    jet[1 + a] = first[a][i];
                    (a..3).for_each(|b| jet[SECOND[a][b]] = 0.5 * (second[a][b][i] + second[b][a][i]));
                }
            }
        }
    }

    /// Number of bands.
    pub(crate) fn order(&self) -> Order {
        self.order
    }

    /// The first band that lobes are fitted to.
    pub(crate) fn first_band(&self) -> usize {
        self.first_band
    }

    /// Length of the vector that was loaded.
    pub(crate) fn length(&self) -> f64 {
        self.length
    }

    /// Squared length of the part that lobes are fitted to, relative to that of the whole vector.
    pub(crate) fn fitted(&self) -> f64 {
        self.fitted
    }

    /// The vector over its length, `[C, n²]`.
    pub(crate) fn target(&self) -> &[f64] {
        &self.target
    }

    /// Sums `Σ_m y_lm(s) jet_lm` for each channel and band.
    ///
    /// - `sums`: `[C, n]`, overwritten from the first fitted band on
    pub(super) fn jets_at(&self, axis: [f64; 3], basis: &mut [f64], sums: &mut [[f64; JET]]) {
        let (n, count) = (self.order.get(), self.order.coeff_count());
        eval(self.order, axis, basis);
        for (jets, sums) in self.jets.chunks_exact(count).zip(sums.chunks_exact_mut(n)) {
            for (l, sum) in sums.iter_mut().enumerate().skip(self.first_band) {
                *sum = [0.0; JET];
                let band = l * l..(l + 1) * (l + 1);
                for (y, jet) in basis[band.clone()].iter().zip(&jets[band]) {
                    sum.iter_mut().zip(jet).for_each(|(sum, jet)| *sum += y * jet);
                }
            }
        }
    }
}
