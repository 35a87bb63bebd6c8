//! Arithmetic on vectors of coefficients.

use crate::order::assert_length;
use crate::{Order, Real};

/// Partial sums that [`dot`] keeps side by side, so that the compiler can use vector registers.
const LANES: usize = 8;

/// The dot product of two vectors of the same length.
///
/// For two expansions it is the integral of their product over the sphere (the basis is orthonormal); for a transfer vector
/// and a light it is the transferred radiance. Eight partial sums, always in the same order.
///
/// # Panics
/// If the lengths differ.
#[inline]
pub fn dot<T: Real>(a: &[T], b: &[T]) -> T {
    assert_length("the second vector", b.len(), a.len());
    let (a_blocks, a_rest) = a.as_chunks::<LANES>();
    let (b_blocks, b_rest) = b.as_chunks::<LANES>();
    let mut sums = [T::ZERO; LANES];
    for (a, b) in a_blocks.iter().zip(b_blocks) {
        for ((sum, &a), &b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    let rest = a_rest.iter().zip(b_rest).map(|(&a, &b)| a * b).sum::<T>();
    let [s0, s1, s2, s3, s4, s5, s6, s7] = sums;
    (((s0 + s4) + (s2 + s6)) + ((s1 + s5) + (s3 + s7))) + rest
}

/// Multiplies each band by its weight, in place: `f_lm *= weights[l]`.
///
/// - `weights`: `[n]`, for instance from [`hanning`](crate::hanning)
/// - `coeffs`: `[n²]`
///
/// # Panics
/// If a slice length does not match `order`.
pub fn scale_bands<T: Real>(order: Order, weights: &[T], coeffs: &mut [T]) {
    assert_length("weights", weights.len(), order.get());
    assert_length("coeffs", coeffs.len(), order.coeff_count());
    for ((_, band), &weight) in order.bands().zip(weights) {
        coeffs[band].iter_mut().for_each(|f| *f *= weight);
    }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    #[test]
    fn dot_equals_the_plain_sum_at_every_length() {
        for count in 0..40_usize {
            let a: [f64; 40] = core::array::from_fn(|i| if i < count { 1.0 + i as f64 } else { 0.0 });
            let squares = (count * (count + 1) * (2 * count + 1) / 6) as f64;
            assert_eq!(dot(&a[..count], &a[..count]), squares);
        }
    }

    #[test]
    #[should_panic(expected = "the second vector has 3 elements, it needs 4")]
    fn dot_refuses_different_lengths() {
        dot(&[1.0_f32; 4], &[1.0; 3]);
    }

    #[test]
    fn each_band_gets_its_own_weight() {
        let mut coeffs = [1.0_f32; 9];
        scale_bands(Order::new(3).unwrap(), &[2.0, 3.0, 5.0], &mut coeffs);
        assert_eq!(coeffs, [2.0, 3.0, 3.0, 3.0, 5.0, 5.0, 5.0, 5.0, 5.0]);
    }
}
