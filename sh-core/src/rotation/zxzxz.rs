//! One expansion rotated at once: turns about z, and exchanges of y and z between them.

use super::cartesian;
use super::exchange::Rows;
use super::unrolled;
use super::values;
use super::zyz::{Turn, Zyz};
use crate::order::assert_length;
use crate::{Order, Real};

/// Rotates one expansion, exactly, without building a matrix.
///
/// `g(s) = f(R⁻¹ s)`, by `R = Z(α) Y(β) Z(γ)` and `Y(β) = E Z(−β) E`, where `E` exchanges y and z: the `ZXZXZ` method with
/// mirror images for the quarter turns about x. The angles come from the matrix without any trigonometry, see [`Zyz`].
///
/// - `matrix`: rows of `R`, orthogonal to rounding, a rotation or a mirror image. To n = 4 it is taken as it is: a length that
///   is off by `e` enters band `l` as `l·e`. Beyond, see [`Zyz::from_matrix`]; [`ShRotation`](crate::ShRotation) makes every
///   matrix orthogonal first. If an entry that is read is not finite, no coefficient but that of band 0 is.
/// - `coeffs`: `[n²]`
/// - `out`: `[n²]`, overwritten
///
/// Products with the matrix for n ≤ 3, and values at seven directions for band 3 of n = 4; straight-line kernels for n ≤ 10.
/// Beyond, the factors of `E` are computed on the way, in `f64`, with about `5n³` operations: [`Zxzxz`](crate::Zxzxz) keeps
/// them. For many expansions turned alike there is [`ShRotation`](crate::ShRotation). Does not allocate.
///
/// Accuracy, absolute, at every angle: in `f32` for coefficients up to 1, 2e-6 for n ≤ 6 and 4e-6 for n ≤ 10; in `f64` 1e-14 for
/// n ≤ 10; asserted by `tests/rotation_angles.rs`.
///
/// ```
/// use sh_core::{Order, eval, rotate};
///
/// let order = Order::new(4)?;
/// let (mut about_x, mut about_y, mut rotated) = ([0.0_f64; 16], [0.0; 16], [0.0; 16]);
/// eval(order, [1.0, 0.0, 0.0], &mut about_x);
/// eval(order, [0.0, 1.0, 0.0], &mut about_y);
/// // A quarter turn about z: +x goes to +y.
/// rotate(order, [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], &about_x, &mut rotated);
/// assert!(rotated.iter().zip(about_y).all(|(a, b)| (a - b).abs() < 1e-15));
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If a slice length does not match `order`.
///
/// Source: [SLS05](crate#references), "Digression on SH rotation"; [KKP05](crate#references) section 2.2.
pub fn rotate<T: Real>(order: Order, matrix: [[T; 3]; 3], coeffs: &[T], out: &mut [T]) {
    if order.get() > CARTESIAN_MAX_ORDER {
        return rotate_zyz(order, &Zyz::from_matrix(matrix), coeffs, out);
    }
    assert_length("coeffs", coeffs.len(), order.coeff_count());
    assert_length("out", out.len(), order.coeff_count());
    cartesian::rotate(&matrix, coeffs, out);
    if let (Some(coeffs), Some(out)) = (coeffs.first_chunk::<16>(), out.first_chunk_mut::<16>()) {
        let (Some(coeffs), Some(out)) = (coeffs.last_chunk(), out.last_chunk_mut()) else { return };
        values::rotate_band_3(&matrix, coeffs, out);
    }
}

/// The largest order that needs no angles.
const CARTESIAN_MAX_ORDER: usize = 4;

/// Rotates one expansion by a quaternion `[x, y, z, w]`, of any length but 0. Otherwise as [`rotate`].
///
/// ```
/// use sh_core::{Order, rotate_quaternion};
///
/// // Half a turn about x: y and z change their signs.
/// let mut out = [0.0_f32; 4];
/// rotate_quaternion(Order::new(2)?, [1.0, 0.0, 0.0, 0.0], &[7.0, 1.0, 2.0, 3.0], &mut out);
/// assert_eq!(out, [7.0, -1.0, -2.0, 3.0]);
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If a slice length does not match `order`.
pub fn rotate_quaternion<T: Real>(order: Order, quaternion: [T; 4], coeffs: &[T], out: &mut [T]) {
    rotate_zyz(order, &Zyz::from_quaternion(quaternion), coeffs, out);
}

/// Rotates one expansion by angles that are known already. Otherwise as [`rotate`].
///
/// # Panics
/// If a slice length does not match `order`.
#[inline(always)]
pub fn rotate_zyz<T: Real>(order: Order, zyz: &Zyz<T>, coeffs: &[T], out: &mut [T]) {
    assert_length("coeffs", coeffs.len(), order.coeff_count());
    assert_length("out", out.len(), order.coeff_count());
    if !unrolled::rotate(order, zyz, coeffs, out) {
        rotate_any(order, zyz, coeffs, out);
    }
    if zyz.inverted {
        invert(order, out);
    }
}

/// `s → −s`, which changes the sign of the odd bands.
#[cold]
pub(super) fn invert<T: Real>(order: Order, out: &mut [T]) {
    for (_, band) in order.bands().skip(1).step_by(2) {
        out[band].iter_mut().for_each(|f| *f = -*f);
    }
}

/// Every order, without tables. Leaves out `s → −s`.
fn rotate_any<T: Real>(order: Order, zyz: &Zyz<T>, coeffs: &[T], out: &mut [T]) {
    let wide = |[c, s]: Turn<T>| [c.to_f64(), s.to_f64()];
    let [cos_beta, sin_beta] = wide(zyz.beta);
    let turns = [wide(zyz.alpha), [cos_beta, -sin_beta], wide(zyz.gamma)].map(|turn| multiples(turn, order.get()));
    let (mut a, mut b) = ([[0.0; 2]; Order::MAX], [[0.0; 2]; Order::MAX]);
    for (l, band) in order.bands() {
        let (coeffs, out) = (&coeffs[band.clone()], &mut out[band]);
        for (m, pair) in a[..=l].iter_mut().enumerate() {
            *pair = [coeffs[l + m].to_f64(), if m == 0 { 0.0 } else { coeffs[l - m].to_f64() }];
        }
        turn(&turns[2], &mut a[..=l]);
        exchange(l, &a[..=l], &mut b[..=l]);
        turn(&turns[1], &mut b[..=l]);
        exchange(l, &b[..=l], &mut a[..=l]);
        turn(&turns[0], &mut a[..=l]);
        for (m, &[plus, minus]) in a[..=l].iter().enumerate() {
            // For m = 0, the first comes last.
            out[l - m] = T::from_f64(minus);
            out[l + m] = T::from_f64(plus);
        }
    }
}

/// Cosines and sines of the multiples of an angle, `count` from 0.
fn multiples([c, s]: Turn<f64>, count: usize) -> [[f64; 2]; Order::MAX] {
    let mut multiples = [[1.0, 0.0]; Order::MAX];
    for m in 1..count {
        let [cos, sin] = multiples[m - 1];
        multiples[m] = [cos * c - sin * s, sin * c + cos * s];
    }
    multiples
}

/// Turns the pairs `f_m, f_−m`.
fn turn(multiples: &[[f64; 2]], pairs: &mut [[f64; 2]]) {
    for ([cos, sin], pair) in multiples.iter().zip(pairs) {
        let [plus, minus] = *pair;
        *pair = [cos * plus - sin * minus, sin * plus + cos * minus];
    }
}

/// y and z change places: the entries of a row are for coefficients of the first and the second kind in turn.
fn exchange(l: usize, pairs: &[[f64; 2]], out: &mut [[f64; 2]]) {
    let mut rows = Rows::new(l);
    let mut row = [0.0; Order::MAX];
    for (k, out) in out.iter_mut().enumerate() {
        rows.next(&mut row[..=l]);
        let mut sums = [0.0; 2];
        for (m, (entry, pair)) in row.iter().zip(pairs).enumerate() {
            let second_kind = (l + m + k) % 2;
            // The first kind are cosines of even m and sines of odd m.
            sums[second_kind] += entry * pair[(m + second_kind) % 2];
        }
        *out = if k % 2 == 0 { sums } else { [sums[1], sums[0]] };
    }
    // There is no sine of m = 0.
    out[0][1] = 0.0;
}
