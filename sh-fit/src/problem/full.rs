//! The error as a function of the axes and the coefficients, which the paper minimises.

use sh_core::BasisGradient;

use super::{Projected, Signal, lobe_norm};
use crate::solver::Smooth;

/// `ψ = |t̃ − t|² + μ Σ (2l+1)/(4π) g*_l²`, of parameters `[N, 3 + C (n − n₀)]`: for each lobe its axis, of any length but 0, and
/// its coefficients in the fitted bands, channel by channel.
///
/// Source: [SLS05](sh_core#references) eq. 17, with our penalty.
#[derive(Debug)]
pub(crate) struct Full<'a> {
    signal: &'a Signal,
    ridge: f64,
    tables: &'a BasisGradient<f64>,
}

/// One lobe's parameters.
struct Lobe<'a> {
    /// At unit length: `h(s) = s/|s|`.
    axis: [f64; 3],
    /// `|s|`.
    length: f64,
    /// `[C, n − n₀]`.
    coeffs: &'a [f64],
}

impl<'a> Full<'a> {
    pub(crate) fn new(signal: &'a Signal, ridge: f64, tables: &'a BasisGradient<f64>) -> Self {
        Self { signal, ridge, tables }
    }

    fn fitted_bands(&self) -> usize {
        self.signal.order.get().saturating_sub(self.signal.first_band)
    }

    /// Parameters of one lobe.
    fn stride(&self) -> usize {
        3 + self.signal.channels * self.fitted_bands()
    }

    /// The axes and the best coefficients about them.
    pub(crate) fn parameters(&self, projected: &Projected) -> Vec<f64> {
        let mut x = Vec::new();
        for (lobe, axis) in projected.axes().iter().enumerate() {
            x.extend(axis);
            for c in 0..self.signal.channels {
                x.extend((self.signal.first_band..self.signal.order.get()).map(|l| projected.lobe(l, c, lobe)));
            }
        }
        x
    }

    /// The axes, at unit length.
    pub(crate) fn axes(&self, x: &[f64]) -> Vec<[f64; 3]> {
        self.lobes(x).map(|lobe| lobe.axis).collect()
    }

    fn lobes<'b>(&self, x: &'b [f64]) -> impl Iterator<Item = Lobe<'b>> {
        x.chunks_exact(self.stride()).map(|lobe| {
            let s = [lobe[0], lobe[1], lobe[2]];
            let length = super::dot3(s, s).sqrt();
            Lobe { axis: s.map(|s| s / length), length, coeffs: &lobe[3..] }
        })
    }

    /// `t̃ − t`, 0 in the explicit bands.
    fn difference(&self, x: &[f64]) -> Vec<f64> {
        let (order, count) = (self.signal.order, self.signal.order.coeff_count());
        let first = (self.signal.first_band * self.signal.first_band).min(count);
        let mut difference: Vec<f64> = self.signal.target().iter().map(|t| -t).collect();
        difference.chunks_exact_mut(count).for_each(|channel| channel[..first].fill(0.0));
        let mut y = vec![0.0; count];
        for lobe in self.lobes(x) {
            sh_core::eval(order, lobe.axis, &mut y);
            for (channel, coeffs) in difference.chunks_exact_mut(count).zip(lobe.coeffs.chunks(self.fitted_bands())) {
                for ((_, band), g) in order.bands().skip(self.signal.first_band).zip(coeffs) {
                    channel[band.clone()].iter_mut().zip(&y[band]).for_each(|(d, y)| *d += g * y);
                }
            }
        }
        difference
    }
}

impl Smooth for Full<'_> {
    fn value(&self, x: &[f64]) -> f64 {
        let bands = self.fitted_bands();
        let penalty = |lobe: Lobe<'_>| {
            let squares = lobe.coeffs.iter().enumerate();
            squares.map(|(i, g)| lobe_norm(self.signal.first_band + i % bands) * g * g).sum::<f64>()
        };
        self.difference(x).iter().map(|d| d * d).sum::<f64>() + self.ridge * self.lobes(x).map(penalty).sum::<f64>()
    }

    /// Eq. 19: `∂ψ/∂g*_l = 2 Σ_m y_lm (t̃ − t)_lm`, and eq. 20, 21: `∂ψ/∂s = 2 Σ_lm Jᵀ∇y_lm g*_l (t̃ − t)_lm`, where
    /// [`BasisGradient`] tells `∇(y ∘ h)` at unit length, and `1/|s|` of it is that at `s`.
    fn gradient(&self, x: &[f64], gradient: &mut [f64]) {
        let (count, bands) = (self.signal.order.coeff_count(), self.fitted_bands());
        let difference = self.difference(x);
        let (mut y, mut slopes) = (vec![0.0; count], vec![0.0; 3 * count]);
        gradient.fill(0.0);
        for (lobe, gradient) in self.lobes(x).zip(gradient.chunks_exact_mut(self.stride())) {
            self.tables.eval(lobe.axis, &mut y, &mut slopes);
            for (i, g) in lobe.coeffs.iter().enumerate() {
                let (c, l) = (i / bands, self.signal.first_band + i % bands);
                let band = l * l..(l + 1) * (l + 1);
                let difference = &difference[c * count..][band.clone()];
                let along = |y: &[f64]| difference.iter().zip(y).map(|(d, y)| d * y).sum::<f64>();
                gradient[3 + i] = 2.0 * (along(&y[band.clone()]) + self.ridge * lobe_norm(l) * g);
                for (a, slopes) in slopes.chunks_exact(count).enumerate() {
                    gradient[a] += 2.0 * g * along(&slopes[band.clone()]) / lobe.length;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use sh_core::Order;

    use super::*;
    use crate::solver::Landscape;

    #[test]
    fn eq_19_to_21_are_central_differences_and_the_best_coefficients_have_the_projected_error() {
        let order = Order::new(5).expect("valid");
        let f: Vec<f64> = (0..50).map(|i| (i * 7919 % 101) as f64 / 50.0 - 1.0).collect();
        let mut signal = Signal::new(order, 2, 1);
        signal.load(&f);
        let mut projected = Projected::new(signal, 1e-3);
        projected.set_axes(&[[0.48, -0.6, 0.64], [0.0, 0.0, 1.0], [-0.6, 0.8, 0.0]]);
        let tables = BasisGradient::new(order);
        let full = Full::new(projected.signal(), 1e-3, &tables);
        let mut x = full.parameters(&projected);
        assert!((full.value(&x) - projected.value()).abs() < 1e-13);

        // Axes of other lengths: only their directions count.
        for (lobe, scale) in x.chunks_exact_mut(11).zip([0.5, 2.0, 3.0]) {
            lobe[..3].iter_mut().for_each(|s| *s *= scale);
        }
        assert!((full.value(&x) - projected.value()).abs() < 1e-13);
        x[5] += 0.1;
        let mut gradient = vec![0.0; x.len()];
        full.gradient(&x, &mut gradient);
        for (p, given) in gradient.iter().enumerate() {
            let h = 1e-5;
            let at =
                |by: f64| full.value(&(0..x.len()).map(|q| x[q] + if p == q { by } else { 0.0 }).collect::<Vec<_>>());
            let slope = (at(h) - at(-h)) / (2.0 * h);
            // 1e-10 times a third derivative, and 1e-16/1e-5 from rounding.
            assert!((given - slope).abs() < 1e-8, "{p}: {given} {slope}");
        }
    }
}
