//! Windows that fade the high bands out, against ringing.

use core::f64::consts::PI;

use crate::order::assert_length;
use crate::{Order, Real};

/// The Hanning window, one weight per band.
///
/// `weights[l] = (1 + cos(π l / width)) / 2` for `l < width`, and 0 beyond.
///
/// - `width`: the band at which the window reaches zero; `n` fades over all bands and keeps a little of the last one, a large
///   width leaves the expansion almost as it is. Zero or less keeps band 0 only.
/// - `weights`: `[n]`, overwritten; for [`scale_bands`](crate::scale_bands)
///
/// ```
/// # use sh_core::{Order, hanning};
/// let mut weights = [0.0_f64; 4];
/// hanning(Order::new(4)?, 4.0, &mut weights);
/// assert_eq!(weights[0], 1.0);
/// assert!((weights[2] - 0.5).abs() < 1e-15);
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If `weights` is not `[n]`.
///
/// Source: [Slo08](crate#references), section "Windowing".
pub fn hanning<T: Real>(order: Order, width: T, weights: &mut [T]) {
    assert_length("weights", weights.len(), order.get());
    let width = width.to_f64();
    for (l, weight) in weights.iter_mut().enumerate() {
        *weight = T::from_f64(hanning_at(l as f64, width));
    }
}

fn hanning_at(l: f64, width: f64) -> f64 {
    if l == 0.0 {
        1.0
    } else if l < width {
        0.5 * (1.0 + Real::cos(PI * l / width))
    } else {
        0.0
    }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    #[test]
    fn falls_from_one_to_zero_at_the_width() {
        let mut weights = [9.0_f64; 6];
        hanning(Order::new(6).unwrap(), 4.0, &mut weights);
        let half = core::f64::consts::FRAC_1_SQRT_2 / 2.0;
        let expected = [1.0, 0.5 + half, 0.5, 0.5 - half, 0.0, 0.0];
        for (weight, expected) in weights.iter().zip(expected) {
            assert!((weight - expected).abs() < 1e-15, "{weights:?}");
        }
    }

    #[test]
    fn odd_widths_have_an_answer() {
        for width in [0.0_f32, -3.0, f32::NAN, f32::NEG_INFINITY] {
            let mut weights = [9.0; 3];
            hanning(Order::new(3).unwrap(), width, &mut weights);
            assert_eq!(weights, [1.0, 0.0, 0.0]);
        }
        let mut weights = [9.0; 3];
        hanning(Order::new(3).unwrap(), f32::INFINITY, &mut weights);
        assert_eq!(weights, [1.0; 3]);
    }
}
