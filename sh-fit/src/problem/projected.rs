//! Variable projection: the error as a function of the axes alone.
//!
//! With the axes fixed, bands decouple, and the coefficients of each follow by least squares: `(G + μD) g = b` with the Gram
//! matrix `G_jk = (2l+1)/(4π) P_l(s_j·s_k)`, its diagonal `D`, and `b_j = f_l(s_j) = Σ_m f_lm y_lm(s_j)`. The error that is left
//! is `ψ = |f|² − Σ b·g`, and half of it has closed derivatives with respect to the axes. With `r = f − Σ g_k y(s_k)`:
//!
//! ```text
//! gradient_ja   = −g_j ∂_a y_j·r
//! Hessian_ja,kb = g_j g_k ∂_a y_j·∂_b y_k − δ_jk g_j ∂_a∂_b y_j·r − (M (G + μD)⁻¹ Mᵀ)_ja,kb
//! M_ja,k        = g_j ∂_a y_j·y_k − δ_jk ∂_a y_j·r
//! ```
//!
//! summed over bands and channels, where `y_j·y_k` and its derivatives are Legendre polynomials of `s_j·s_k`, and those of
//! `y_j·f` are values of `f` rotated by small angles.

use std::f64::consts::PI;

use sh_core::eval;

use super::dot3;
use super::legendre::legendre;
use super::signal::{JET, SECOND, Signal};
use crate::solver::Landscape;
use crate::solver::cholesky::{decompose, solve_lower, solve_upper};

/// Value, first derivatives along two tangents, second derivatives 11, 12, 22.
pub(super) type Local = [f64; 6];

/// The axes at one place, and what was computed there.
#[derive(Debug, Clone, Default)]
pub(super) struct State {
    pub(super) axes: Vec<[f64; 3]>,
    /// Two tangents per axis.
    pub(super) frames: Vec<[[f64; 3]; 2]>,
    /// `[N, C, n]`: the signal at each axis.
    pub(super) local: Vec<Local>,
    /// `[N, N, n]`, for `j > k`: Legendre polynomials of `s_j·s_k`.
    pub(super) pairs: Vec<[f64; 3]>,
    /// `[n, N, N]`: lower triangles of the Cholesky factors of the Gram matrices over `(2l+1)/(4π)`.
    pub(super) factors: Vec<f64>,
    /// `[n, C, N]`: lobe coefficients.
    pub(super) lobes: Vec<f64>,
    /// `ψ`.
    value: f64,
}

/// The error of the best lobes about axes, as a function of the axes.
#[derive(Debug)]
pub(crate) struct Projected {
    signal: Signal,
    /// `μ`.
    ridge: f64,
    here: State,
    there: State,
    scratch: Scratch,
    evaluations: usize,
}

#[derive(Debug, Default)]
pub(super) struct Scratch {
    basis: Vec<f64>,
    sums: Vec<[f64; JET]>,
    /// `[N, 2, N]`: `∂_a y_j·y_k`.
    pub(super) first: Vec<f64>,
    /// `[2N, N]`: `M`, and then `M L⁻ᵀ`.
    pub(super) mixed: Vec<f64>,
}

impl Projected {
    pub(crate) fn new(signal: Signal, ridge: f64) -> Self {
        let (count, sums) = (signal.order.coeff_count(), signal.channels * signal.order.get());
        let scratch = Scratch { basis: vec![0.0; count], sums: vec![[0.0; JET]; sums], ..Scratch::default() };
        Self { signal, ridge, here: State::default(), there: State::default(), scratch, evaluations: 0 }
    }

    pub(crate) fn signal(&self) -> &Signal {
        &self.signal
    }

    pub(crate) fn signal_mut(&mut self) -> &mut Signal {
        &mut self.signal
    }

    /// Evaluations since it was asked last.
    pub(crate) fn take_evaluations(&mut self) -> usize {
        std::mem::take(&mut self.evaluations)
    }

    pub(crate) fn axes(&self) -> &[[f64; 3]] {
        &self.here.axes
    }

    /// The coefficients of the lobes about the current axes, of the signal at unit length.
    pub(crate) fn lobe(&self, band: usize, channel: usize, lobe: usize) -> f64 {
        let n = self.here.axes.len();
        self.here.lobes[(band * self.signal.channels + channel) * n + lobe]
    }

    /// The squared error without the penalty on coefficients.
    pub(crate) fn unpenalised(&self) -> f64 {
        let per_band = self.signal.channels * self.here.axes.len();
        let squares = |l: usize| self.here.lobes[l * per_band..][..per_band].iter().map(|g| g * g).sum::<f64>();
        let bands = self.signal.first_band..self.signal.order.get();
        self.here.value - self.ridge * bands.map(|l| lobe_norm(l) * squares(l)).sum::<f64>()
    }

    /// Removes most of what the penalty takes from the coefficients, by one step of refinement: `g += (G + μD)⁻¹ (b − G g)`,
    /// where `b − G g = μ D g`. What was too small by a part `ε` is too small by `ε²` then, and no coefficient is doubled.
    pub(crate) fn refine(&mut self) {
        let (n, channels) = (self.here.axes.len(), self.signal.channels);
        let mut rest = vec![0.0; n];
        for l in self.signal.first_band..self.signal.order.get() {
            let factor = &self.here.factors[l * n * n..][..n * n];
            for g in self.here.lobes[l * channels * n..][..channels * n].chunks_exact_mut(n.max(1)) {
                rest.iter_mut().zip(&*g).for_each(|(rest, g)| *rest = self.ridge * g);
                solve_lower(factor, n, &mut rest);
                solve_upper(factor, n, &mut rest);
                g.iter_mut().zip(&rest).for_each(|(g, rest)| *g += rest);
            }
        }
    }

    /// Goes to other axes, of any number.
    pub(crate) fn set_axes(&mut self, axes: &[[f64; 3]]) {
        self.there.axes.clear();
        self.there.axes.extend_from_slice(axes);
        self.evaluate_there();
        std::mem::swap(&mut self.here, &mut self.there);
    }

    /// What the lobes leave of the signal at unit length: `[C, n²]`, 0 in the explicit bands. `lobe` is room for `[n²]`.
    pub(crate) fn residual(&self, residual: &mut Vec<f64>, lobe: &mut Vec<f64>) {
        let (order, count) = (self.signal.order, self.signal.order.coeff_count());
        residual.clear();
        residual.extend_from_slice(self.signal.target());
        lobe.resize(count, 0.0);
        let first = self.signal.first_band;
        residual.chunks_exact_mut(count).for_each(|residual| residual[..(first * first).min(count)].fill(0.0));
        for (j, &axis) in self.here.axes.iter().enumerate() {
            eval(order, axis, lobe);
            for (c, residual) in residual.chunks_exact_mut(count).enumerate() {
                for (l, band) in order.bands().skip(first) {
                    let g = self.lobe(l, c, j);
                    residual[band.clone()].iter_mut().zip(&lobe[band]).for_each(|(r, y)| *r -= g * y);
                }
            }
        }
    }

    fn evaluate_there(&mut self) {
        self.evaluations += 1;
        let Self { signal, ridge, there, scratch, .. } = self;
        there.resize(signal);
        there.measure(signal, scratch);
        // Loops of known length are unrolled: two to three times faster than those of unknown length.
        match there.axes.len() {
            1 => there.project::<1>(signal, *ridge, 1),
            2 => there.project::<2>(signal, *ridge, 2),
            3 => there.project::<3>(signal, *ridge, 3),
            4 => there.project::<4>(signal, *ridge, 4),
            n => there.project::<0>(signal, *ridge, n),
        }
    }
}

impl State {
    fn resize(&mut self, signal: &Signal) {
        let (lobes, bands, channels) = (self.axes.len(), signal.order.get(), signal.channels);
        self.frames.resize(lobes, [[0.0; 3]; 2]);
        self.local.resize(lobes * channels * bands, [0.0; 6]);
        self.pairs.resize(lobes * lobes * bands, [0.0; 3]);
        self.factors.resize(bands * lobes * lobes, 0.0);
        self.lobes.resize(bands * channels * lobes, 0.0);
    }

    /// The signal and its derivatives at each axis, and the polynomials of each pair.
    fn measure(&mut self, signal: &Signal, scratch: &mut Scratch) {
        let (lobes, bands) = (self.axes.len(), signal.order.get());
        for j in 0..lobes {
            let axis = self.axes[j];
            self.frames[j] = tangents(axis);
            signal.jets_at(axis, &mut scratch.basis, &mut scratch.sums);
            let local = &mut self.local[j * signal.channels * bands..][..signal.channels * bands];
            local.iter_mut().zip(&scratch.sums).for_each(|(local, jet)| *local = along(self.frames[j], jet));
            for k in 0..j {
                let t = dot3(axis, self.axes[k]).clamp(-1.0, 1.0);
                legendre(t, &mut self.pairs[(j * lobes + k) * bands..][..bands]);
            }
        }
    }

    /// The coefficients and the error. `FIXED` is the number of lobes, or 0 if it is known at run time only.
    #[inline(always)]
    fn project<const FIXED: usize>(&mut self, signal: &Signal, ridge: f64, lobes: usize) {
        let n = if FIXED > 0 { FIXED } else { lobes };
        let (bands, channels) = (signal.order.get(), signal.channels);
        self.value = signal.fitted();
        for l in signal.first_band..bands {
            let factor = &mut self.factors[l * n * n..][..n * n];
            for j in 0..n {
                (0..j).for_each(|k| factor[j * n + k] = self.pairs[(j * n + k) * bands + l][0]);
                factor[j * n + j] = 1.0 + ridge;
            }
            decompose(factor, n);
            let norm = lobe_norm(l);
            for c in 0..channels {
                let g = &mut self.lobes[(l * channels + c) * n..][..n];
                (0..n).for_each(|j| g[j] = self.local[(j * channels + c) * bands + l][0]);
                solve_lower(factor, n, g);
                self.value -= g.iter().map(|g| g * g).sum::<f64>() / norm;
                solve_upper(factor, n, g);
                g.iter_mut().for_each(|g| *g /= norm);
            }
        }
    }
}

/// `(2l+1)/(4π)`: squared length of `y_l(s)`.
pub(crate) fn lobe_norm(l: usize) -> f64 {
    (2 * l + 1) as f64 / (4.0 * PI)
}

/// Two tangents `e_1, e_2` with `e_1 × e_2 = s`, without a branch that a small change of `s` would cross but at `s_z = 0`.
///
/// Source: Duff, Burgess, Christensen, Hery, Kensler, Liani, Villemin, *Building an Orthonormal Basis, Revisited*, JCGT 6(1), 2017.
#[inline(always)]
fn tangents([x, y, z]: [f64; 3]) -> [[f64; 3]; 2] {
    let sign = 1.0_f64.copysign(z);
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    [[1.0 + sign * x * x * a, sign * b, -sign * x], [b, sign + y * y * a, -y]]
}

/// The derivatives along the tangents, from those along rotations about the coordinate axes: the rotation about `s × e_1 = e_2`
/// moves `s` along `e_1`, that about `s × e_2 = −e_1` along `e_2`.
#[inline(always)]
fn along([e1, e2]: [[f64; 3]; 2], jet: &[f64; JET]) -> Local {
    let first = [jet[1], jet[2], jet[3]];
    let rows = SECOND.map(|row| row.map(|i| jet[i]));
    let times = |v: [f64; 3]| [dot3(rows[0], v), dot3(rows[1], v), dot3(rows[2], v)];
    let (w1, w2) = (times(e1), times(e2));
    [jet[0], dot3(e2, first), -dot3(e1, first), dot3(e2, w2), -dot3(e2, w1), dot3(e1, w1)]
}

impl Landscape for Projected {
    fn dimension(&self) -> usize {
        2 * self.here.axes.len()
    }

    fn value(&self) -> f64 {
        self.here.value
    }

    fn derivatives(&mut self, gradient: &mut [f64], hessian: &mut [f64]) {
        let Self { signal, here, scratch, .. } = self;
        let n = here.axes.len();
        scratch.first.resize(2 * n * n, 0.0);
        scratch.mixed.resize(2 * n * n, 0.0);
        gradient.fill(0.0);
        hessian.fill(0.0);
        match n {
            1 => here.differentiate::<1>(signal, scratch, gradient, hessian, 1),
            2 => here.differentiate::<2>(signal, scratch, gradient, hessian, 2),
            3 => here.differentiate::<3>(signal, scratch, gradient, hessian, 3),
            4 => here.differentiate::<4>(signal, scratch, gradient, hessian, 4),
            _ => here.differentiate::<0>(signal, scratch, gradient, hessian, n),
        }
        for p in 0..2 * n {
            (0..p).for_each(|q| hessian[q * 2 * n + p] = hessian[p * 2 * n + q]);
        }
    }

    fn try_step(&mut self, step: &[f64]) -> f64 {
        let Self { here, there, .. } = self;
        there.axes.clear();
        for ((axis, frame), step) in here.axes.iter().zip(&here.frames).zip(step.chunks_exact(2)) {
            let moved = [0, 1, 2].map(|a| axis[a] + step[0] * frame[0][a] + step[1] * frame[1][a]);
            let length = dot3(moved, moved).sqrt();
            there.axes.push(moved.map(|x| x / length));
        }
        self.evaluate_there();
        self.there.value
    }

    fn accept(&mut self) {
        std::mem::swap(&mut self.here, &mut self.there);
    }
}

#[cfg(test)]
mod tests {
    use sh_core::{Order, fit_lobe_about_axis};

    use super::*;
    use crate::random::Random;

    const RIDGE: f64 = 1e-5;

    fn problem(n: usize, channels: usize, first_band: usize) -> Projected {
        penalised(n, channels, first_band, RIDGE)
    }

    fn penalised(n: usize, channels: usize, first_band: usize, ridge: f64) -> Projected {
        let order = Order::new(n).expect("valid");
        let f: Vec<f64> = (0..channels * n * n).map(|i| (i * 7919 % 101) as f64 / 50.0 - 1.0).collect();
        let mut signal = Signal::new(order, channels, first_band);
        signal.load(&f);
        Projected::new(signal, ridge)
    }

    fn random_axes(count: usize) -> Vec<[f64; 3]> {
        let mut random = Random::for_stream(5, 0);
        (0..count).map(|_| random.direction()).collect()
    }

    #[test]
    fn derivatives_are_central_differences() {
        // Opposite axes need the larger penalty: without it the error changes within an angle of √μ.
        let poles = vec![[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.6, 0.0, 0.8]];
        for (n, channels, ridge, axes) in [
            (6, 1, RIDGE, random_axes(1)),
            (6, 3, RIDGE, random_axes(2)),
            (5, 1, 0.1, poles),
            (6, 2, RIDGE, random_axes(4)),
            (7, 1, RIDGE, random_axes(6)),
        ] {
            let mut problem = penalised(n, channels, 1, ridge);
            problem.set_axes(&axes);
            let d = problem.dimension();
            let (mut gradient, mut hessian) = (vec![0.0; d], vec![0.0; d * d]);
            problem.derivatives(&mut gradient, &mut hessian);
            // A step of 1e-4 leaves errors of 1e-8 times a fourth derivative, and 1e-16/1e-8 from rounding.
            let h = 1e-4;
            let mut half_value = |moves: &[(usize, f64)]| {
                let mut step = vec![0.0; d];
                moves.iter().for_each(|&(p, by)| step[p] += by);
                0.5 * problem.try_step(&step)
            };
            for p in 0..d {
                let slope = (half_value(&[(p, h)]) - half_value(&[(p, -h)])) / (2.0 * h);
                assert!((gradient[p] - slope).abs() < 1e-5, "gradient {p}: {} {slope}", gradient[p]);
                for q in 0..d {
                    let [pp, pm, mp, mm] =
                        [[h, h], [h, -h], [-h, h], [-h, -h]].map(|[a, b]| half_value(&[(p, a), (q, b)]));
                    let curve = (pp - pm - mp + mm) / (4.0 * h * h);
                    let given = hessian[p * d + q];
                    assert!((given - curve).abs() < 1e-4 * (1.0 + given.abs()), "Hessian {p} {q}: {given} {curve}");
                }
            }
        }
    }

    #[test]
    fn one_lobe_is_the_closed_fit() {
        let mut problem = problem(6, 1, 0);
        let axis = [0.48, -0.6, 0.64];
        problem.set_axes(&[axis]);
        problem.refine();
        let order = Order::new(6).expect("valid");
        let (mut lobe, mut remainder) = (vec![0.0; 6], vec![0.0; 36]);
        let squared = fit_lobe_about_axis(order, problem.signal().target(), axis, &mut lobe, &mut remainder);
        for (l, g) in lobe.iter().enumerate() {
            // The refined penalty leaves μ² of a coefficient.
            assert!((problem.lobe(l, 0, 0) - g).abs() < 2.0 * RIDGE * RIDGE * g.abs() + 1e-15);
        }
        let (mut residual, mut room) = (Vec::new(), Vec::new());
        problem.residual(&mut residual, &mut room);
        let left: f64 = residual.iter().map(|r| r * r).sum();
        assert!((left - squared).abs() < 1e-12, "{left} {squared}");
    }

    #[test]
    fn the_error_is_that_of_the_residual() {
        let mut problem = problem(6, 3, 2);
        problem.set_axes(&random_axes(4));
        let (mut residual, mut room) = (Vec::new(), Vec::new());
        problem.residual(&mut residual, &mut room);
        let left: f64 = residual.iter().map(|r| r * r).sum();
        assert!((left - problem.unpenalised()).abs() < 1e-12, "{left} {}", problem.unpenalised());
        assert!(problem.value() > left);
    }

    #[test]
    fn coincident_and_opposite_lobes_share_one() {
        let (mut one, mut three) = (problem(6, 1, 1), problem(6, 1, 1));
        let axis = [0.48, -0.6, 0.64];
        one.set_axes(&[axis]);
        three.set_axes(&[axis, axis.map(|x| -x), axis]);
        // The penalty of a lobe in three parts is a third.
        assert!((one.unpenalised() - three.unpenalised()).abs() < 4.0 * RIDGE, "no part is lost");
        for l in 1..6 {
            let sign = if l % 2 == 1 { -1.0 } else { 1.0 };
            let sum = three.lobe(l, 0, 0) + sign * three.lobe(l, 0, 1) + three.lobe(l, 0, 2);
            assert!((sum - one.lobe(l, 0, 0)).abs() < 2.0 * RIDGE * one.lobe(l, 0, 0).abs() + 1e-12, "band {l}");
            assert!(three.lobe(l, 0, 0).abs() <= one.lobe(l, 0, 0).abs() + 1e-9, "nothing cancels");
        }
    }
}
