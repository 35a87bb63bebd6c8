//! The weights of windows.

use core::f64::consts::PI;

use super::laplacian;
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

/// The Lanczos window, one weight per band.
///
/// `weights[l] = sin(π l / width) / (π l / width)` for `l < width`, and 0 beyond. It keeps more of the middle bands than
/// [`hanning`] of the same width.
///
/// - `width`: the band at which the window reaches zero; zero, less or NaN keeps band 0 only
/// - `weights`: `[n]`, overwritten; for [`scale_bands`](crate::scale_bands)
///
/// ```
/// # use sh_core::{Order, lanczos};
/// let mut weights = [0.0_f64; 4];
/// lanczos(Order::new(4)?, 4.0, &mut weights);
/// assert!((weights[2] - 2.0 / std::f64::consts::PI).abs() < 1e-15);
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If `weights` is not `[n]`.
///
/// Source: [Slo08](crate#references), section "Windowing".
pub fn lanczos<T: Real>(order: Order, width: T, weights: &mut [T]) {
    assert_length("weights", weights.len(), order.get());
    let width = width.to_f64();
    for (l, weight) in weights.iter_mut().enumerate() {
        let x = PI * l as f64 / width;
        let keeps_all = l == 0 || x == 0.0 && width > 0.0;
        let inside = (l as f64) < width;
        *weight = T::from_f64(if keeps_all {
            1.0
        } else if inside {
            Real::sin(x) / x
        } else {
            0.0
        });
    }
}

/// The Gaussian window, one weight per band: diffusion on the sphere.
///
/// `weights[l] = exp(−time · l(l+1))`: heat spreads for that time from the expansion, and a point becomes a Gaussian with the
/// standard deviation `√(2 time)` radians, while that is small. It is the convolution with a kernel that is nowhere
/// negative, so the minimum of an expansion rises, and its maximum falls, with every increase of `time`.
///
/// - `time`: 0 keeps everything, infinity band 0 only. Below 0 and NaN are taken as 0.
/// - `weights`: `[n]`, overwritten; for [`scale_bands`](crate::scale_bands)
///
/// ```
/// # use sh_core::{Order, gaussian};
/// let mut weights = [0.0_f64; 2];
/// gaussian(Order::new(2)?, 0.5, &mut weights);
/// assert!((weights[1] - (-1.0_f64).exp()).abs() < 1e-15);
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If `weights` is not `[n]`.
///
/// Source: the heat equation `∂f/∂t = Δf`, in which `y_lm` is an eigenfunction of `Δ` with the value `−l(l+1)`.
pub fn gaussian<T: Real>(order: Order, time: T, weights: &mut [T]) {
    assert_length("weights", weights.len(), order.get());
    let time = time.to_f64().max(0.0);
    for (l, weight) in weights.iter_mut().enumerate() {
        // 0 times infinity at band 0
        *weight = T::from_f64(if l == 0 { 1.0 } else { Real::exp(-time * (l * (l + 1)) as f64) });
    }
}

/// A family of windows, from one that keeps everything (strength 0) to one that keeps band 0 only (infinite strength).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(::serde::Serialize, ::serde::Deserialize))]
pub enum Window {
    /// [`hanning`] with `width = 1/strength`.
    Hanning,
    /// [`lanczos`] with `width = 1/strength`.
    Lanczos,
    /// [`laplacian`](crate::laplacian) with `lambda = strength`.
    Laplacian,
    /// [`gaussian`] with `time = strength`.
    Gaussian,
}

impl Window {
    /// The weights of the window of a strength.
    ///
    /// - `strength`: 0 or more; below 0 and NaN are taken as 0
    /// - `weights`: `[n]`, overwritten; for [`scale_bands`](crate::scale_bands)
    ///
    /// # Panics
    /// If `weights` is not `[n]`.
    pub fn weights<T: Real>(self, order: Order, strength: T, weights: &mut [T]) {
        let strength = if strength > T::ZERO { strength } else { T::ZERO };
        match self {
            Self::Hanning => hanning(order, T::ONE / strength, weights),
            Self::Lanczos => lanczos(order, T::ONE / strength, weights),
            Self::Laplacian => laplacian(order, strength, weights),
            Self::Gaussian => gaussian(order, strength, weights),
        }
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
