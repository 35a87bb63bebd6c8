//! The window that makes an expansion smooth with the least change.

use crate::order::assert_length;
use crate::{Order, Real};

/// The Laplacian window, one weight per band.
///
/// `weights[l] = 1 / (1 + λ l²(l+1)²)`: the windowed `g` minimises `∫ (g − f)² + λ ∫ (Δg)²`.
///
/// - `lambda`: 0 keeps everything, infinity band 0 only; see [`laplacian_lambda`]. Below 0 and NaN are taken as 0.
/// - `weights`: `[n]`, overwritten; for [`scale_bands`](crate::scale_bands)
///
/// ```
/// # use sh_core::{Order, laplacian};
/// let mut weights = [0.0_f64; 3];
/// laplacian(Order::new(3)?, 0.25, &mut weights);
/// assert_eq!(weights, [1.0, 0.5, 0.1]);
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If `weights` is not `[n]`.
///
/// Source: [Slo08](crate#references), section "Windowing".
pub fn laplacian<T: Real>(order: Order, lambda: T, weights: &mut [T]) {
    assert_length("weights", weights.len(), order.get());
    let lambda = lambda.to_f64().max(0.0);
    for (l, weight) in weights.iter_mut().enumerate() {
        // 0 times infinity at band 0
        *weight = T::from_f64(if l == 0 { 1.0 } else { 1.0 / (1.0 + lambda * squared_eigenvalue(l)) });
    }
}

/// The `λ` of [`laplacian`] that leaves the fraction `left` of an expansion's squared Laplacian `∫ (Δf)²`.
///
/// Solves `Σ_l w_l² l²(l+1)² |f_l|² = left · Σ_l l²(l+1)² |f_l|²` by Newton's method on the inverse root of the fraction,
/// which is concave and nearly a line in `λ`: from 0 it rises to the answer and never passes it. Scaling the expansion does
/// not change it; for several channels, put their coefficients' lengths in one expansion.
///
/// - `coeffs`: `[n²]`
/// - `left`: in `0..=1`. At 1 and above, at NaN, and for an expansion that is constant or not finite, `λ` is 0; at 0 and
///   below it is infinite.
///
/// # Panics
/// If `coeffs` is not `[n²]`.
///
/// Source: [Slo08](crate#references), section "Windowing".
pub fn laplacian_lambda<T: Real>(order: Order, coeffs: &[T], left: T) -> T {
    /// More than Newton's method needs at any fraction that `f64` can hold.
    const STEPS: usize = 200;
    assert_length("coeffs", coeffs.len(), order.coeff_count());
    let largest = coeffs.iter().skip(1).map(|f| f.to_f64().abs()).fold(0.0, f64::max);
    let left = left.to_f64();
    if !(left < 1.0 && largest > 0.0 && coeffs.iter().all(|f| f.is_finite())) {
        return T::ZERO;
    }
    if left <= 0.0 {
        return T::from_f64(f64::INFINITY);
    }
    let squares = |l: usize| coeffs[l * l..(l + 1) * (l + 1)].iter().map(|f| f.to_f64() / largest).map(|f| f * f);
    let whole: f64 = (1..order.get()).map(|l| squared_eigenvalue(l) * squares(l).sum::<f64>()).sum();
    let target = 1.0 / Real::sqrt(left);
    let mut lambda = 0.0;
    for _ in 0..STEPS {
        // The fraction `r` and its derivative.
        let (mut r, mut slope) = (0.0, 0.0);
        for l in 1..order.get() {
            let q = squared_eigenvalue(l);
            let weight = 1.0 / (1.0 + lambda * q);
            let part = q * squares(l).sum::<f64>() / whole * weight * weight;
            r += part;
            slope -= 2.0 * q * weight * part;
        }
        let inverse_root = 1.0 / Real::sqrt(r);
        let step = (target - inverse_root) / (-0.5 * slope * inverse_root / r);
        // A fraction that has vanished in `f64` has no root: then this is far enough.
        if !step.is_finite() || step <= 1e-15 * lambda {
            break;
        }
        lambda += step;
    }
    T::from_f64(lambda)
}

/// `l²(l+1)²`
fn squared_eigenvalue(l: usize) -> f64 {
    let eigenvalue = (l * (l + 1)) as f64;
    eigenvalue * eigenvalue
}
