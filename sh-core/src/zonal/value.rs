//! Zonal functions as functions of one cosine: their values, and their coefficients from a profile.

use core::f64::consts::PI;

use super::legendre::legendre;
use super::lobe_factor;
use crate::Real;
#[cfg(feature = "alloc")]
use crate::sphere::gauss_legendre;

/// The value of a zonal function at an angle to its axis: `Σ_l √((2l+1)/(4π)) zonal[l] P_l(cosine)`.
///
/// - `zonal`: `[n]`, any n
/// - `cosine`: of the angle to the axis; values outside of `[−1, 1]` count as the nearer end, as rounded dot products need
///
/// NaN for a NaN cosine. Summed in `f64`. Accuracy in `f64`: 4e-15 times `Σ √((2l+1)/(4π)) |zonal[l]|` for n = 512, asserted
/// by `values_hold_their_accuracy` in `tests/zonal.rs`.
///
/// ```
/// let mut zonal = [0.0_f64; 40];
/// sh_core::clamped_cosine(&mut zonal);
/// assert!((sh_core::zonal_value(&zonal, 0.5) - 0.5).abs() < 1e-3);
/// assert!(sh_core::zonal_value(&zonal, -0.5).abs() < 1e-3);
/// ```
///
/// Source: the [definition](crate#basis) of `y_l0`.
pub fn zonal_value<T: Real>(zonal: &[T], cosine: T) -> T {
    sum_of_legendre(zonal, cosine, |l| 1.0 / lobe_factor(l))
}

/// The value of a lobe at an angle to its axis: `Σ_l (2l+1)/(4π) lobe[l] P_l(cosine)`.
///
/// The same as [`zonal_value`], for lobe coefficients `g*_l`.
///
/// Source: [SLS05](crate#references) eq. 6 with the addition theorem.
pub fn lobe_value<T: Real>(lobe: &[T], cosine: T) -> T {
    sum_of_legendre(lobe, cosine, |l| (2 * l + 1) as f64 / (4.0 * PI))
}

fn sum_of_legendre<T: Real>(coeffs: &[T], cosine: T, factor: impl Fn(usize) -> f64) -> T {
    let z = cosine.to_f64().clamp(-1.0, 1.0);
    let terms = coeffs.iter().zip(legendre(z)).enumerate();
    T::from_f64(terms.map(|(l, (&g, p))| factor(l) * g.to_f64() * p).sum())
}

/// The zonal coefficients of a profile `f(cos theta)`: `zonal[l] = √(π(2l+1)) ∫ f(z) P_l(z) dz`.
///
/// Gauss-Legendre quadrature with `count` points between each two neighbours in `cuts`. Exact where `f` is a polynomial of
/// degree `d` between cuts and `2 count ≥ d + n`; for a smooth `f` the error falls faster than any power of `count`, as long
/// as kinks and jumps are at cuts.
///
/// - `cuts`: cosines, increasing, in `[−1, 1]`; the profile is 0 outside of the first and the last. `&[-1.0, 1.0]` is the
///   whole sphere, `&[0.0, 1.0]` the upper half, `&[-1.0, 0.3, 1.0]` the sphere with a kink at 0.3
/// - `f`: the value at a cosine; it is not asked at the cuts themselves
/// - `zonal`: `[n]`, overwritten
///
/// Sums in `f64`. Without points or without two cuts the result is 0.
///
/// # Panics
/// If the cuts are not as said.
///
/// ```
/// let mut zonal = [0.0_f64; 6];
/// sh_core::project_zonal(&[0.0, 1.0], 4, |z| z, &mut zonal);
/// let mut expected = [0.0; 6];
/// sh_core::clamped_cosine(&mut expected);
/// assert!(zonal.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15));
/// ```
#[cfg(feature = "alloc")]
pub fn project_zonal<T: Real>(cuts: &[f64], count: usize, mut f: impl FnMut(f64) -> f64, zonal: &mut [T]) {
    let ordered = cuts.iter().zip(cuts.iter().skip(1)).all(|(a, b)| a <= b);
    assert!(ordered && cuts.iter().all(|z| z.abs() <= 1.0), "cuts {cuts:?} do not grow within -1..=1");
    let mut integrals = alloc::vec![0.0; zonal.len()];
    for (node, weight) in gauss_legendre(count) {
        for (start, end) in cuts.iter().zip(cuts.iter().skip(1)) {
            let half = 0.5 * (end - start);
            let z = 0.5 * (end + start) + half * node;
            let value = half * weight * f(z);
            integrals.iter_mut().zip(legendre(z)).for_each(|(sum, p)| *sum += value * p);
        }
    }
    for (l, (g, integral)) in zonal.iter_mut().zip(integrals).enumerate() {
        *g = T::from_f64(2.0 * PI / lobe_factor(l) * integral);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_the_basis_functions_along_the_axis() {
        use crate::{Order, eval};
        for z in [-1.0_f64, -0.6, 0.0, 0.28, 1.0] {
            let mut y = [0.0; 49];
            eval(Order::new(7).expect("valid"), [Real::sqrt(1.0 - z * z), 0.0, z], &mut y);
            for l in 0..7 {
                let mut zonal = [0.0; 7];
                zonal[l] = 1.0;
                assert!((zonal_value(&zonal, z) - y[l * (l + 1)]).abs() < 1e-15, "band {l} at {z}");
                zonal[l] = lobe_factor(l);
                assert!((lobe_value(&zonal, z) - y[l * (l + 1)]).abs() < 1e-15, "lobe {l} at {z}");
            }
        }
    }

    #[test]
    fn odd_cosines_and_lengths_have_an_answer() {
        assert_eq!(zonal_value::<f32>(&[], 0.3), 0.0);
        assert_eq!(zonal_value(&[1.0_f32, 2.0], 1.5), zonal_value(&[1.0, 2.0], 1.0));
        assert_eq!(zonal_value(&[1.0_f32, 2.0], f32::NEG_INFINITY), zonal_value(&[1.0, 2.0], -1.0));
        assert!(zonal_value(&[1.0_f32, 2.0], f32::NAN).is_nan());
    }

    #[cfg(feature = "alloc")]
    #[test]
    fn profiles_without_points_are_zero() {
        let mut zonal = [9.0_f32; 3];
        for cuts in [&[][..], &[0.5], &[0.5, 0.5]] {
            project_zonal(cuts, 4, |_| 1.0, &mut zonal);
            assert_eq!(zonal, [0.0; 3]);
        }
        project_zonal(&[-1.0, 1.0], 0, |_| 1.0, &mut zonal);
        assert_eq!(zonal, [0.0; 3]);
    }
}
