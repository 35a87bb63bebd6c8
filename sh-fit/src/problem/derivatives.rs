//! Gradient and Hessian of half the projected error; the formulas stand in `projected.rs`.

use super::projected::{Scratch, State};
use super::signal::Signal;
use super::{dot3, lobe_norm};
use crate::solver::cholesky::solve_lower;

/// One band of a state with `n` lobes.
struct Band<'a> {
    state: &'a State,
    n: usize,
    /// Number of bands.
    bands: usize,
    l: usize,
    /// `(2l+1)/(4π)`.
    norm: f64,
    /// `∂_a y_j·∂_a y_j = (2l+1)/(4π) P_l'(1)`.
    slope_at_one: f64,
}

impl State {
    /// Adds the gradient `[2N]` and the lower triangle of the Hessian `[2N, 2N]`. `FIXED` is the number of lobes, or 0 if it is
    /// known at run time only.
    #[inline(always)]
    pub(super) fn differentiate<const FIXED: usize>(
        &self,
        signal: &Signal,
        scratch: &mut Scratch,
        gradient: &mut [f64],
        hessian: &mut [f64],
        lobes: usize,
    ) {
        let n = if FIXED > 0 { FIXED } else { lobes };
        let (bands, channels, size) = (signal.order.get(), signal.channels, 2 * n);
        let (gradient, hessian) = (&mut gradient[..size], &mut hessian[..size * size]);
        let (first, mixed) = (&mut scratch.first[..size * n], &mut scratch.mixed[..size * n]);
        for l in signal.first_band..bands {
            let norm = lobe_norm(l);
            let slope_at_one = norm * (l * (l + 1)) as f64 * 0.5;
            let band = Band { state: self, n, bands, l, norm, slope_at_one };
            band.cross_slopes(first);
            for c in 0..channels {
                let g = &self.lobes[(l * channels + c) * n..][..n];
                for j in 0..n {
                    let local = &self.local[(j * channels + c) * bands + l];
                    let (slope, curve) = band.of_residual(j, g, local);
                    band.add_own(j, g, slope, curve, gradient, hessian);
                    band.add_pairs(j, g, hessian);
                    band.mix(j, g, slope, first, mixed);
                }
                band.subtract_projection(mixed, hessian);
            }
        }
    }
}

impl Band<'_> {
    /// `P_l, P_l', P_l''` of `s_j·s_k`.
    #[inline(always)]
    fn pair(&self, j: usize, k: usize) -> [f64; 3] {
        let (j, k) = if j > k { (j, k) } else { (k, j) };
        self.state.pairs[(j * self.n + k) * self.bands + self.l]
    }

    /// `∂_a y_j·y_k`, `[N, 2, N]`.
    #[inline(always)]
    fn cross_slopes(&self, first: &mut [f64]) {
        let (n, state) = (self.n, self.state);
        for j in 0..n {
            for a in 0..2 {
                for k in 0..n {
                    let along = || self.norm * self.pair(j, k)[1] * dot3(state.frames[j][a], state.axes[k]);
                    first[(2 * j + a) * n + k] = if j == k { 0.0 } else { along() };
                }
            }
        }
    }

    /// `∂_a y_j·r`, and `∂_a∂_b y_j·r` for 11, 12, 22.
    #[inline(always)]
    fn of_residual(&self, j: usize, g: &[f64], local: &[f64; 6]) -> ([f64; 2], [f64; 3]) {
        let state = self.state;
        let own = g[j] * self.slope_at_one;
        let mut slope = [local[1], local[2]];
        let mut curve = [local[3] + own, local[4], local[5] + own];
        for k in (0..self.n).filter(|&k| k != j) {
            let [_, p1, p2] = self.pair(j, k);
            let t = dot3(state.axes[j], state.axes[k]);
            let [d1, d2] = state.frames[j].map(|e| dot3(e, state.axes[k]));
            let g = g[k] * self.norm;
            slope[0] -= g * p1 * d1;
            slope[1] -= g * p1 * d2;
            curve[0] -= g * (p2 * d1 * d1 - t * p1);
            curve[1] -= g * p2 * d1 * d2;
            curve[2] -= g * (p2 * d2 * d2 - t * p1);
        }
        (slope, curve)
    }

    /// The gradient, and the Hessian for one lobe and itself.
    #[inline(always)]
    fn add_own(
        &self,
        j: usize,
        g: &[f64],
        slope: [f64; 2],
        curve: [f64; 3],
        gradient: &mut [f64],
        hessian: &mut [f64],
    ) {
        let (row, size) = (2 * j, 2 * self.n);
        gradient[row] -= g[j] * slope[0];
        gradient[row + 1] -= g[j] * slope[1];
        let own = g[j] * g[j] * self.slope_at_one;
        hessian[row * size + row] += own - g[j] * curve[0];
        hessian[(row + 1) * size + row] -= g[j] * curve[1];
        hessian[(row + 1) * size + row + 1] += own - g[j] * curve[2];
    }

    /// `g_j g_k ∂_a y_j·∂_b y_k` for two lobes, `k < j`.
    #[inline(always)]
    fn add_pairs(&self, j: usize, g: &[f64], hessian: &mut [f64]) {
        let (state, size) = (self.state, 2 * self.n);
        for k in 0..j {
            let [_, p1, p2] = self.pair(j, k);
            let weight = g[j] * g[k] * self.norm;
            for a in 0..2 {
                let (ej, d) = (state.frames[j][a], dot3(state.frames[j][a], state.axes[k]));
                for b in 0..2 {
                    let ek = state.frames[k][b];
                    hessian[(2 * j + a) * size + 2 * k + b] +=
                        weight * (p2 * d * dot3(ek, state.axes[j]) + p1 * dot3(ej, ek));
                }
            }
        }
    }

    /// The rows of `M` for one lobe.
    #[inline(always)]
    fn mix(&self, j: usize, g: &[f64], slope: [f64; 2], first: &[f64], mixed: &mut [f64]) {
        let n = self.n;
        for (a, slope) in slope.into_iter().enumerate() {
            let row = (2 * j + a) * n;
            (0..n).for_each(|k| mixed[row + k] = g[j] * first[row + k]);
            mixed[row + j] -= slope;
        }
    }

    /// `M (G + μD)⁻¹ Mᵀ`, by `M L⁻ᵀ`.
    #[inline(always)]
    fn subtract_projection(&self, mixed: &mut [f64], hessian: &mut [f64]) {
        let (n, size) = (self.n, 2 * self.n);
        let factor = &self.state.factors[self.l * n * n..][..n * n];
        for p in 0..size {
            solve_lower(factor, n, &mut mixed[p * n..][..n]);
            for q in 0..=p {
                let dot: f64 = (0..n).map(|k| mixed[p * n + k] * mixed[q * n + k]).sum();
                hessian[p * size + q] -= dot / self.norm;
            }
        }
    }
}
