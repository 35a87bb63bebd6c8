//! One lobe, about the axis of the linear band.

use sh_core::{Order, fit_lobe_about_axis, linear_axis};

/// A zonal lobe: a function that depends only on the angle to an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct ZonalLobe {
    /// Unit length, in the frame of the function that was fitted.
    pub axis: [f64; 3],
    /// Lobe coefficients `g*_l` `[n]`: the lobe has the coefficients `g*_l y_lm(axis)`. Source: [SLS05](sh_core#references) eq. 6.
    pub coeffs: Vec<f64>,
}

/// Fits one zonal lobe about the axis of the linear band, each band by least squares: [`linear_axis`] and
/// [`fit_lobe_about_axis`].
///
/// - `coeffs`: `[n²]`, a function in the convention of `sh-core`
///
/// For diffuse transfer the relative error is about 0.29 at order 6 [SLS05, section 4.1]. A function without a linear band has
/// no such axis; +z is taken.
///
/// # Panics
/// If `coeffs` does not have `n²` entries.
///
/// Source: [SLS05](sh_core#references) eq. 18 and section 3.3.
#[must_use]
pub fn optimal_linear_lobe(order: Order, coeffs: &[f64]) -> ZonalLobe {
    let axis = linear_axis(coeffs);
    let (mut lobe, mut remainder) = (vec![0.0; order.get()], vec![0.0; order.coeff_count()]);
    fit_lobe_about_axis(order, coeffs, axis, &mut lobe, &mut remainder);
    ZonalLobe { axis, coeffs: lobe }
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
    fn functions_without_a_direction_get_one() {
        for f in [vec![0.0; 9], vec![1.0; 1], vec![f64::MAX; 4], vec![f64::MIN_POSITIVE; 4]] {
            let lobe = optimal_linear_lobe(order(f.len().isqrt()), &f);
            let length: f64 = lobe.axis.iter().map(|x| x * x).sum();
            assert!((length - 1.0).abs() < 1e-12, "{lobe:?}");
        }
    }
}
