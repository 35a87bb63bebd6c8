//! 3D Gaussian splats.

use core::f64::consts::PI;

use crate::order::assert_length;
use crate::{Order, Real};

/// The order in which a splat's coefficients above band 0 lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(::serde::Serialize, ::serde::Deserialize))]
pub enum SplatLayout {
    /// All of red, then green, then blue, `[3, n² − 1]`: the properties `f_rest_0, f_rest_1, ...` of a PLY file.
    Planar,
    /// Red, green and blue of each coefficient together, `[n² − 1, 3]`: `features_rest` in memory, and the buffers of renderers.
    Interleaved,
}

/// Half a unit of colour, as the coefficient of band 0: `½ √(4π) = √π`.
fn half_grey() -> f64 {
    Real::sqrt(PI)
}

/// The colour of a splat as an expansion, from the coefficients of 3D Gaussian splatting.
///
/// Its basis is this crate's, signs and index included (`SH_C0` to `SH_C3`); but the colour is `½ + Σ_i f_i y_i(d)`, clamped
/// below at 0. The half becomes part of band 0 here, so that [`reconstruct`](crate::reconstruct) gives the colour before the
/// clamp, in the colours of the images that the splats were trained on, mostly sRGB.
///
/// The direction `d` goes from the camera to the splat, in the frame of the scene.
///
/// - `order`: `n`, the splat's degree plus 1; files mostly have degree 3
/// - `dc`: `f_dc_0, f_dc_1, f_dc_2`
/// - `rest`: `[3 (n² − 1)]` in the layout said
/// - `out`: `[3, n²]`, overwritten
///
/// ```
/// use sh_core::{Order, SplatLayout, from_splat};
///
/// let mut out = [0.0_f32; 3];
/// from_splat(Order::new(1)?, [0.0; 3], &[], SplatLayout::Planar, &mut out);
/// assert!((out[0] * 0.28209479 - 0.5).abs() < 1e-7); // grey
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If a slice length does not match `order`.
///
/// Source: [KKLD23](crate#references), `utils/sh_utils.py` and `scene/gaussian_model.py` of its code.
pub fn from_splat<T: Real>(order: Order, dc: [T; 3], rest: &[T], layout: SplatLayout, out: &mut [T]) {
    let rest_count = check(order, rest, out);
    for (channel, (coeffs, dc)) in out.chunks_exact_mut(order.coeff_count()).zip(dc).enumerate() {
        coeffs[0] = dc + T::from_f64(half_grey());
        for (i, f) in coeffs[1..].iter_mut().enumerate() {
            *f = rest[place(layout, rest_count, channel, i)];
        }
    }
}

/// The coefficients of 3D Gaussian splatting from the colour as an expansion: undoes [`from_splat`]. Returns `f_dc`.
///
/// - `coeffs`: `[3, n²]`
/// - `rest`: `[3 (n² − 1)]`, overwritten, in the layout said
///
/// # Panics
/// If a slice length does not match `order`.
pub fn to_splat<T: Real>(order: Order, coeffs: &[T], layout: SplatLayout, rest: &mut [T]) -> [T; 3] {
    let rest_count = check(order, rest, coeffs);
    let mut dc = [T::ZERO; 3];
    for (channel, (coeffs, dc)) in coeffs.chunks_exact(order.coeff_count()).zip(&mut dc).enumerate() {
        *dc = coeffs[0] - T::from_f64(half_grey());
        for (i, &f) in coeffs[1..].iter().enumerate() {
            rest[place(layout, rest_count, channel, i)] = f;
        }
    }
    dc
}

/// Where a coefficient lies, counted from band 1.
fn place(layout: SplatLayout, rest_count: usize, channel: usize, i: usize) -> usize {
    match layout {
        SplatLayout::Planar => channel * rest_count + i,
        SplatLayout::Interleaved => 3 * i + channel,
    }
}

/// Checks both lengths; returns `n² − 1`.
#[track_caller]
fn check<T>(order: Order, rest: &[T], coeffs: &[T]) -> usize {
    let rest_count = order.coeff_count() - 1;
    assert_length("rest", rest.len(), 3 * rest_count);
    assert_length("coeffs", coeffs.len(), 3 * order.coeff_count());
    rest_count
}
