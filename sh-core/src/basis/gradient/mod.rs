//! Gradients and Hessians of the basis functions on the sphere.
//!
//! They follow from the solid harmonics `r^l y_lm`, which are homogeneous polynomials. Their derivatives are solid harmonics
//! of the band below, for m > 0:
//!
//! ```text
//! ∂x y_l±m =    a y_l−1,±(m+1) − b y_l−1,±(m−1)     a = ½ √((2l+1)/(2l−1)) √((l−m)(l−m−1))
//! ∂y y_l±m = ±( a y_l−1,∓(m+1) + b y_l−1,∓(m−1) )   b = ½ √((2l+1)/(2l−1)) √((l+m)(l+m−1))
//! ∂z y_l±m =    c y_l−1,±m                          c =   √((2l+1)/(2l−1)) √((l−m)(l+m))
//! ```
//!
//! where `y_l−1,±0` on the right counts √2-fold with the upper sign and not at all with the lower; for m = 0, `(∂x, ∂y) y_l0 =
//! √2 a y_l−1,±1`. From there, with `s` the unit direction and `y = r^−l (r^l y)`:
//!
//! ```text
//! ∂i  y = ∂i (r^l y) − l s_i y
//! ∂ij y = ∂ij(r^l y) − l (s_i ∂j + s_j ∂i)(r^l y) + l ((l+2) s_i s_j − δ_ij) y
//! ```
//!
//! There is no division: the poles are ordinary points.

#[cfg(feature = "alloc")]
mod tabled;

#[cfg(feature = "alloc")]
pub use tabled::BasisGradient;

use super::{Sink, Source, Values, eval};
use crate::order::assert_length;
use crate::simd::Lanes;
use crate::{Order, Real};

/// Evaluates all basis functions and their gradients at a direction.
///
/// A basis function is meant on the sphere and continued as a constant along rays, `y(s/|s|)`. So its gradient is tangent to
/// the sphere: `gradients[a, i] = ∂y_i/∂s_a`, per radian.
///
/// - `direction`: unit length
/// - `values`: `[n²]`, overwritten, as by [`eval`]
/// - `gradients`: `[3, n²]`, overwritten: the components x, y, z
///
/// Accuracy: `n` times that of [`eval`], asserted by `tests/gradient.rs`; for a direction of another length, and for what is
/// not finite, as said there. Does not allocate. For many directions, and for n > 10, [`BasisGradient`](crate::BasisGradient)
/// keeps the factors.
///
/// ```
/// use sh_core::{Order, eval_gradient};
///
/// let (mut y, mut gradient) = ([0.0_f64; 4], [0.0; 12]);
/// eval_gradient(Order::new(2)?, [0.6, 0.0, 0.8], &mut y, &mut gradient);
/// // y_2 = k z: its gradient is k times the part of (0, 0, 1) that is tangent to the sphere.
/// let (k, [_, x, z]) = (0.4886025119029199, [0.0, 0.6, 0.8]);
/// assert!((gradient[2] - k * -z * x).abs() < 1e-15 && (gradient[8 + 2] - k * (1.0 - z * z)).abs() < 1e-15);
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If a slice length does not match `order`.
pub fn eval_gradient<T: Real>(order: Order, direction: [T; 3], values: &mut [T], gradients: &mut [T]) {
    assert_length("gradients", gradients.len(), 3 * order.coeff_count());
    eval(order, direction, values);
    tangent_gradient(order, direction, &&*values, Computed, &mut Values(gradients));
}

/// Evaluates all basis functions with their gradients and Hessians at a direction.
///
/// The Hessian is that of the function continued as a constant along rays, see [`eval_gradient`]: it holds the derivatives
/// on the sphere, and `H s = −∇y` along the ray.
///
/// - `direction`: unit length
/// - `values`: `[n²]`, `gradients`: `[3, n²]`, as by [`eval_gradient`]
/// - `hessians`: `[6, n²]`, overwritten: xx, xy, xz, yy, yz, zz
///
/// Accuracy: `2n²` times that of [`eval`], asserted by `tests/gradient.rs`. Does not allocate.
///
/// ```
/// use sh_core::{Order, eval_hessian};
///
/// let (mut y, mut gradient, mut hessian) = ([0.0_f64; 16], [0.0; 48], [0.0; 96]);
/// eval_hessian(Order::new(4)?, [0.36, 0.48, 0.8], &mut y, &mut gradient, &mut hessian);
/// // Harmonics are eigenfunctions of the Laplacian on the sphere: −l(l+1).
/// let laplacian = hessian[13] + hessian[3 * 16 + 13] + hessian[5 * 16 + 13];
/// assert!((laplacian + 12.0 * y[13]).abs() < 1e-13);
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If a slice length does not match `order`.
pub fn eval_hessian<T: Real>(
    order: Order,
    direction: [T; 3],
    values: &mut [T],
    gradients: &mut [T],
    hessians: &mut [T],
) {
    assert_length("gradients", gradients.len(), 3 * order.coeff_count());
    assert_length("hessians", hessians.len(), 6 * order.coeff_count());
    eval(order, direction, values);
    hessian_from_values(order, direction, Computed, values, gradients, hessians);
}

/// The gradients and Hessians, given the values.
fn hessian_from_values<T: Real>(
    order: Order,
    direction: [T; 3],
    factors: impl Factors<T>,
    values: &[T],
    gradients: &mut [T],
    hessians: &mut [T],
) {
    solid_gradient(order, values, factors, gradients);
    solid_hessian(order, gradients, factors, hessians);
    turn_tangent_hessian(order, direction, values, gradients, hessians);
    tangent_gradient(order, direction, &values, factors, &mut Values(gradients));
}

/// Where `a`, `b`, `c` of the head of the module come from, with the √2 of `y_l−1,0` in them.
trait Factors<T>: Copy {
    fn get(self, l: usize, m: usize) -> [T; 3];
}

/// Factors computed when they are asked for.
#[derive(Clone, Copy, Debug)]
struct Computed;

impl<T: Real> Factors<T> for Computed {
    #[inline]
    fn get(self, l: usize, m: usize) -> [T; 3] {
        use core::f64::consts::SQRT_2;
        let ([l, m], [at_0, at_1]) = ([l as f64, m as f64], [m == 0, m == 1].map(|at| if at { SQRT_2 } else { 1.0 }));
        let root = |number: f64| Real::sqrt(number.max(0.0) * (2.0 * l + 1.0) / (2.0 * l - 1.0));
        let a = 0.5 * at_0 * root((l - m) * (l - m - 1.0));
        let b = 0.5 * at_1 * root((l + m) * (l + m - 1.0));
        [a, b, root((l - m) * (l + m))].map(T::from_f64)
    }
}

/// The gradients `[3, n²]` of the solid harmonics, from their values `[n²]`.
fn solid_gradient<T: Real>(order: Order, values: &[T], factors: impl Factors<T>, gradients: &mut [T]) {
    let count = order.coeff_count();
    for l in 0..order.get() {
        band_gradient::<T, T>(l, count, &values, factors, &mut Values(gradients), [T::ZERO; 3]);
    }
}

/// The gradients `[3, n²]` of functions on the sphere, from their values `[n²]`.
#[inline(always)]
fn tangent_gradient<T: Real, V: Lanes<T>>(
    order: Order,
    direction: [V; 3],
    values: &impl Source<V>,
    factors: impl Factors<T>,
    gradients: &mut impl Sink<V>,
) {
    let count = order.coeff_count();
    for l in 0..order.get() {
        let [x, y, z] = direction;
        let factor = V::splat(T::from_f64(-(l as f64)));
        band_gradient(l, count, values, factors, gradients, [factor * x, factor * y, factor * z]);
    }
}

/// [`tangent_gradient`] of order `N`, with constants for everything that depends on the band.
#[cfg(feature = "alloc")]
#[inline(always)]
fn small_tangent_gradient<T: Real, V: Lanes<T>, const N: usize>(
    [x, y, z]: [V; 3],
    values: &impl Source<V>,
    factors: impl Factors<T>,
    gradients: &mut impl Sink<V>,
) {
    macro_rules! bands {
        ($($l:literal)+) => {
            $(if N > $l {
                let factor = V::splat(T::from_f64(-$l as f64));
                band_gradient($l, N * N, values, factors, gradients, [factor * x, factor * y, factor * z]);
            })+
        };
    }
    bands!(0 1 2 3);
}

/// Band `l` of `∇(r^l y) + radial y`.
#[inline(always)]
fn band_gradient<T: Real, V: Lanes<T>>(
    l: usize,
    count: usize,
    values: &impl Source<V>,
    factors: impl Factors<T>,
    gradients: &mut impl Sink<V>,
    radial: [V; 3],
) {
    let centre = l * (l + 1);
    for m in 0..=l {
        let [plus, minus] = if l == 0 { [[V::splat(T::ZERO); 3]; 2] } else { raise(values, l, m, factors.get(l, m)) };
        put_gradient(centre + m, count, values, plus, radial, gradients);
        if m > 0 {
            put_gradient(centre - m, count, values, minus, radial, gradients);
        }
    }
}

#[inline(always)]
fn put_gradient<T: Real, V: Lanes<T>>(
    i: usize,
    count: usize,
    values: &impl Source<V>,
    solid: [V; 3],
    radial: [V; 3],
    gradients: &mut impl Sink<V>,
) {
    let value = values.get(i);
    for axis in 0..3 {
        gradients.put(axis * count + i, radial[axis].mul_add(value, solid[axis]));
    }
}

/// The derivatives of the solid harmonics `±m` of band `l` by x, y, z, from the values of band `l − 1`.
#[inline(always)]
fn raise<T: Real, V: Lanes<T>>(values: &impl Source<V>, l: usize, m: usize, [a, b, c]: [T; 3]) -> [[V; 3]; 2] {
    let ([a, b, c], zero) = ([V::splat(a), V::splat(b), V::splat(c)], V::splat(T::ZERO));
    let below = l * (l - 1);
    let [same, same_minus] = pair(values, below, l, m, zero);
    let [up, up_minus] = pair(values, below, l, m + 1, zero);
    if m == 0 {
        return [[a * up, a * up_minus, c * same], [zero; 3]];
    }
    let [down, down_minus] = if m == 1 { [values.get(below), zero] } else { pair(values, below, l, m - 1, zero) };
    let [up, up_minus, down, down_minus] = [a * up, a * up_minus, b * down, b * down_minus];
    [[up - down, up_minus + down_minus, c * same], [up_minus - down_minus, -(up + down), c * same_minus]]
}

/// `y_l−1,±k` about the centre of the band, and nothing beyond its ends.
#[inline(always)]
fn pair<V: Copy>(values: &impl Source<V>, below: usize, l: usize, k: usize, zero: V) -> [V; 2] {
    if k < l { [values.get(below + k), values.get(below - k)] } else { [zero; 2] }
}

/// The second derivatives `[6, n²]` of the solid harmonics, from their gradients `[3, n²]`.
fn solid_hessian<T: Real>(order: Order, gradients: &[T], factors: impl Factors<T>, hessians: &mut [T]) {
    // Of the derivatives by x, y, z of ∂x, ∂y, ∂z those that are not there by symmetry, and their places.
    const NEW: [&[(usize, usize)]; 3] = [&[(0, 0), (1, 1), (2, 2)], &[(1, 3), (2, 4)], &[(2, 5)]];
    let count = order.coeff_count();
    hessians.iter_mut().step_by(count).for_each(|h| *h = T::ZERO);
    for (gradient, new) in gradients.chunks_exact(count).zip(NEW) {
        for l in 1..order.get() {
            let centre = l * (l + 1);
            for m in 0..=l {
                let [plus, minus] = raise::<T, T>(&gradient, l, m, factors.get(l, m));
                for &(axis, place) in new {
                    // For m = 0 the first of the two is overwritten by the second.
                    hessians[place * count + centre - m] = minus[axis];
                    hessians[place * count + centre + m] = plus[axis];
                }
            }
        }
    }
}

/// Hessians of solid harmonics into those of functions on the sphere; `gradients` are those of the solid harmonics.
fn turn_tangent_hessian<T: Real>(order: Order, s: [T; 3], values: &[T], gradients: &[T], hessians: &mut [T]) {
    const AXES: [[usize; 2]; 6] = [[0, 0], [0, 1], [0, 2], [1, 1], [1, 2], [2, 2]];
    let count = order.coeff_count();
    for ([a, b], hessian) in AXES.into_iter().zip(hessians.chunks_exact_mut(count)) {
        let delta = if a == b { T::ONE } else { T::ZERO };
        let (by_a, by_b) = (&gradients[a * count..], &gradients[b * count..]);
        for (l, band) in order.bands() {
            let l = T::from_f64(l as f64);
            let factor = (l + T::ONE + T::ONE) * s[a] * s[b] - delta;
            for i in band {
                hessian[i] += l * (factor * values[i] - (s[a] * by_b[i] + s[b] * by_a[i]));
            }
        }
    }
}
