//! One lobe, about the axis of the linear band.

use sh_core::{Order, index};

/// A zonal lobe: a function that depends only on the angle to an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct ZonalLobe {
    /// Unit length, in the frame of the function that was fitted.
    pub axis: [f64; 3],
    /// Lobe coefficients `g*_l` `[n]`: the lobe has the coefficients `g*_l y_lm(axis)`. Source: [SLS05](sh_core#references) eq. 6.
    pub coeffs: Vec<f64>,
}

/// Fits one zonal lobe about the axis of the linear band, each band by least squares.
///
/// With the axis `s` fixed the coefficients are `g*_l = 4π/(2l+1) Σ_m f_lm y_lm(s)`: what the band is worth at the axis. For
/// diffuse transfer the relative error is about 0.29 at order 6 [SLS05, section 4.1].
///
/// - `coeffs`: `[n²]`, a function in the convention of `sh-core`
///
/// A function without a linear band has no such axis; +z is taken.
///
/// # Panics
/// If `coeffs` does not have `n²` entries.
///
/// Source: [SLS05](sh_core#references) eq. 18 and section 3.2.
#[must_use]
pub fn optimal_linear_lobe(order: Order, coeffs: &[f64]) -> ZonalLobe {
    assert_eq!(coeffs.len(), order.coeff_count(), "order {order} has n² coefficients");
    let axis = linear_axis(coeffs);
    let mut basis = vec![0.0; order.coeff_count()];
    sh_core::eval(order, axis, &mut basis);
    let band = |l: usize| {
        let range = l * l..(l + 1) * (l + 1);
        let value: f64 = coeffs[range.clone()].iter().zip(&basis[range]).map(|(f, y)| f * y).sum();
        value * 4.0 * std::f64::consts::PI / (2 * l + 1) as f64
    };
    ZonalLobe { axis, coeffs: (0..order.get()).map(band).collect() }
}

/// `(−f₁₁, −f₁₋₁, f₁₀)`, normalised.
fn linear_axis(coeffs: &[f64]) -> [f64; 3] {
    if coeffs.len() < 4 {
        return [0.0, 0.0, 1.0];
    }
    let axis = [-coeffs[index(1, 1)], -coeffs[index(1, -1)], coeffs[index(1, 0)]];
    let largest = axis.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    if !(largest > 0.0 && largest.is_finite()) {
        return [0.0, 0.0, 1.0];
    }
    let axis = axis.map(|x| x / largest);
    let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    axis.map(|x| x / length)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn order(n: usize) -> Order {
        Order::new(n).expect("valid")
    }

    fn expand(order: Order, lobe: &ZonalLobe) -> Vec<f64> {
        let mut basis = vec![0.0; order.coeff_count()];
        sh_core::eval(order, lobe.axis, &mut basis);
        let coeff = |i: usize| lobe.coeffs[i.isqrt()] * basis[i];
        (0..order.coeff_count()).map(coeff).collect()
    }

    #[test]
    fn a_lobe_is_found_again() {
        let lobe = ZonalLobe { axis: [0.48, -0.6, 0.64], coeffs: vec![1.0, 0.7, 0.3, -0.1, 0.05, 0.02] };
        let found = optimal_linear_lobe(order(6), &expand(order(6), &lobe));
        for (a, b) in found.axis.iter().zip(lobe.axis) {
            assert!((a - b).abs() < 1e-14);
        }
        for (a, b) in found.coeffs.iter().zip(&lobe.coeffs) {
            assert!((a - b).abs() < 1e-14, "{found:?}");
        }
    }

    #[test]
    fn no_coefficient_can_be_changed_to_the_better() {
        let f: Vec<f64> = (0..25).map(|i| f64::from(i * 7919 % 101) / 50.0 - 1.0).collect();
        let best = optimal_linear_lobe(order(5), &f);
        let error = |lobe: &ZonalLobe| expand(order(5), lobe).iter().zip(&f).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        for l in 0..5 {
            for step in [-1e-3, 1e-3] {
                let mut changed = best.clone();
                changed.coeffs[l] += step;
                assert!(error(&changed) > error(&best), "band {l}");
            }
        }
    }

    #[test]
    fn functions_without_a_direction_get_one() {
        for f in [vec![0.0; 9], vec![1.0; 1], vec![f64::MAX; 4], vec![f64::MIN_POSITIVE; 4]] {
            let lobe = optimal_linear_lobe(order(f.len().isqrt()), &f);
            let length: f64 = lobe.axis.iter().map(|x| x * x).sum();
            assert!((length - 1.0).abs() < 1e-12, "{lobe:?}");
        }
    }
}
