//! Turns about z alone.

use super::zyz::Turn;
use crate::order::assert_length;
use crate::{Order, Real};

/// Turns an expansion about z: `g_m = cos(mα) f_m − sin(mα) f_−m`, `g_−m = sin(mα) f_m + cos(mα) f_−m`.
///
/// - `turn`: cosine and sine of α, of a circle with length 1; positive from +x towards +y
/// - `coeffs`: `[n²]`
/// - `out`: `[n²]`, overwritten
///
/// `2n(n−1)` multiplications; the multiples of the angle by recurrence, in `T`. Does not allocate.
///
/// Accuracy: `2e-7 n` in `f32` for coefficients up to 1, `4e-16 n + 1e-15` in `f64`; asserted by `tests/rotation_angles.rs`. A cosine and
/// sine whose length is `1 + e` scale the coefficients of `m` by `1 + me`. NaN in, NaN out.
///
/// ```
/// use sh_core::{Order, rotate_z};
///
/// let mut out = [0.0_f32; 4];
/// // A quarter turn: the lobe about +x (in band 1: −y, +z, −x) is about +y then.
/// rotate_z(Order::new(2)?, [0.0, 1.0], &[1.0, 0.0, 0.0, -0.5], &mut out);
/// assert_eq!(out, [1.0, -0.5, 0.0, 0.0]);
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If a slice length does not match `order`.
///
/// Source: [KKP05](crate#references) Appendix C.
pub fn rotate_z<T: Real>(order: Order, turn: [T; 2], coeffs: &[T], out: &mut [T]) {
    assert_length("coeffs", coeffs.len(), order.coeff_count());
    assert_length("out", out.len(), order.coeff_count());
    out.copy_from_slice(coeffs);
    turn_in_place(order, turn, out);
}

/// The same in place.
#[inline]
pub(super) fn turn_in_place<T: Real>(order: Order, turn: Turn<T>, coeffs: &mut [T]) {
    let mut multiple = turn;
    for m in 1..order.get() {
        turn_column(m, multiple, coeffs);
        multiple = sum(multiple, turn);
    }
}

/// All bands of `±m`.
#[inline]
fn turn_column<T: Real>(m: usize, [cos, sin]: Turn<T>, coeffs: &mut [T]) {
    let mut l = m;
    // From −m to m there are 2m + 1 coefficients, and from one band's to the next one's 2l + 2.
    let mut rest = &mut coeffs[m * m..];
    while rest.len() > 2 * m {
        let (minus, plus) = (rest[0], rest[2 * m]);
        rest[2 * m] = cos * plus - sin * minus;
        rest[0] = sin * plus + cos * minus;
        let step = rest.len().min(2 * l + 2);
        rest = &mut rest[step..];
        l += 1;
    }
}

/// Cosine and sine of the sum of two angles.
fn sum<T: Real>([a, b]: Turn<T>, [c, s]: Turn<T>) -> Turn<T> {
    [a * c - b * s, b * c + a * s]
}
