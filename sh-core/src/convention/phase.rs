//! Real harmonics without the Condon-Shortley phase.

use crate::order::assert_length;
use crate::{Order, Real};

/// Changes the sign of every coefficient with odd `m`, in place: to and from real harmonics without the phase `(−1)^m`.
///
/// That is what sphericart, sphrs and three.js use, and what is usually made of SciPy's complex ones,
/// `√2 (−1)^m Re Y_l^m` and `√2 (−1)^m Im Y_l^|m|`: band 1 is `+y, +z, +x`. Normalisation and index are as here. It is its own
/// inverse, and exact.
///
/// - `coeffs`: `[n²]`, coefficients or values of the basis
///
/// ```
/// use sh_core::{Order, eval, toggle_condon_shortley};
///
/// let (order, mut y) = (Order::new(2)?, [0.0_f64; 4]);
/// eval(order, [0.6, 0.0, 0.8], &mut y);
/// toggle_condon_shortley(order, &mut y);
/// assert!((y[3] - 0.4886025119029199 * 0.6).abs() < 1e-15); // +x
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If `coeffs` is not `[n²]`.
pub fn toggle_condon_shortley<T: Real>(order: Order, coeffs: &mut [T]) {
    assert_length("coeffs", coeffs.len(), order.coeff_count());
    for (l, band) in order.bands() {
        // m = −l..=l: odd ones begin at −l or −l + 1.
        coeffs[band].iter_mut().skip((l + 1) % 2).step_by(2).for_each(|f| *f = -*f);
    }
}
