//! Axes to start from.

use sh_core::{Order, eval, fibonacci};

use crate::problem::{Projected, lobe_norm};

/// Candidate axes over a half of the sphere; opposite axes carry the same lobes.
#[derive(Debug)]
pub(crate) struct Directions {
    order: Order,
    axes: Vec<[f64; 3]>,
    /// `[n², D]`.
    basis: Vec<f64>,
}

/// What is left of a signal, and how much of it a lobe about each candidate would take.
#[derive(Debug, Default)]
pub(crate) struct Gains {
    residual: Vec<f64>,
    lobe: Vec<f64>,
    at_axes: Vec<f64>,
    gains: Vec<f64>,
}

impl Directions {
    /// So many that lobes of the highest band are not missed: its half width is about `π/n`.
    pub(crate) fn new(order: Order) -> Self {
        let count = (2 * order.coeff_count()).clamp(32, 512);
        let axes: Vec<[f64; 3]> = fibonacci(2 * count).into_iter().filter(|axis| axis[2] >= 0.0).collect();
        let mut basis = vec![0.0; order.coeff_count() * axes.len()];
        let mut y = vec![0.0; order.coeff_count()];
        for (d, &axis) in axes.iter().enumerate() {
            eval(order, axis, &mut y);
            y.iter().enumerate().for_each(|(i, y)| basis[i * axes.len() + d] = *y);
        }
        Self { order, axes, basis }
    }

    /// The axis about which one lobe takes most of what the lobes of the problem leave.
    pub(crate) fn best_for_residual(&self, problem: &Projected, gains: &mut Gains) -> [f64; 3] {
        let signal = problem.signal();
        let count = self.axes.len();
        gains.gains.clear();
        gains.gains.resize(count, 0.0);
        gains.at_axes.resize(count, 0.0);
        problem.residual(&mut gains.residual, &mut gains.lobe);
        for residual in gains.residual.chunks_exact(self.order.coeff_count()) {
            for (l, band) in self.order.bands().skip(signal.first_band()) {
                gains.at_axes.fill(0.0);
                for i in band {
                    let row = &self.basis[i * count..][..count];
                    gains.at_axes.iter_mut().zip(row).for_each(|(sum, y)| *sum += residual[i] * y);
                }
                let weight = 1.0 / lobe_norm(l);
                gains.gains.iter_mut().zip(&gains.at_axes).for_each(|(gain, value)| *gain += weight * value * value);
            }
        }
        let best = (0..count).max_by(|&a, &b| gains.gains[a].total_cmp(&gains.gains[b])).unwrap_or(0);
        self.axes[best]
    }
}
