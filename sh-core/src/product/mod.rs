//! Products of expansions.

#[cfg(feature = "alloc")]
mod gaunt;
mod many;
#[cfg(feature = "alloc")]
mod matrix;
mod octahedral;
mod sampled;
mod straight;
#[cfg(feature = "alloc")]
mod transform;

#[cfg(feature = "alloc")]
pub use gaunt::{TripleTensor, gaunt};
#[cfg(feature = "alloc")]
pub use matrix::ProductMatrix;
pub(crate) use octahedral::Sampled;
#[cfg(feature = "alloc")]
pub use transform::ProductTransform;

use crate::order::assert_length;
use crate::simd::dispatch;
use crate::{Order, Real, dot};
use many::Batch;
use sampled::{Matrix, Products, Square};

/// The largest order with kernels that need neither tables built at run time nor memory.
const MAX_SAMPLED: usize = 6;

/// Coefficients of that order.
const MAX_COEFFS: usize = MAX_SAMPLED * MAX_SAMPLED;

/// `1/√(4π)`, the value of the first basis function.
const Y_00: f64 = 0.282_094_791_773_878_14;

/// Runs a kernel of [`sampled`] for every order that has samples; the last argument is for the others.
macro_rules! with_samples {
    ($order:expr, $T:ty, $kernel:ident { $($field:ident),+ }, $otherwise:expr) => {
        match $order.get() {
            3 => dispatch($kernel::<$T, 3, 9, 13, 16> { samples: <$T>::ORDER_3, $($field),+ }),
            4 => dispatch($kernel::<$T, 4, 16, 19, 32> { samples: <$T>::ORDER_4, $($field),+ }),
            5 => dispatch($kernel::<$T, 5, 36, 43, 48> { samples: <$T>::ORDER_6, $($field),+ }),
            6 => dispatch($kernel::<$T, 6, 36, 43, 48> { samples: <$T>::ORDER_6, $($field),+ }),
            _ => $otherwise,
        }
    };
}

/// The product of two expansions, projected to the same order.
///
/// `out_i = ∫ a(s) b(s) y_i(s) ds = Σ_jk a_j b_k ∫ y_i y_j y_k`, exactly: the product of two functions of order `n` has order
/// `2n − 1`, and its bands below `n` are returned. [`ProductTransform::with_orders`] returns the others too.
///
/// - `a`, `b`: `[n²]`
/// - `out`: `[n²]`, overwritten; its unit is that of `a` times that of `b`
///
/// For 3 ≤ n ≤ 6 both factors are sampled at 13 to 43 points, which is exact and, with several points in a register, 4 (n = 3)
/// to 20 (n = 6) times faster than the sparse sum over Gaunt coefficients of a [`TripleTensor`]. Does not allocate for n ≤ 6.
/// Beyond, it builds a [`ProductTransform`] and throws it away: keep one if there are several products.
///
/// Accuracy, absolute, for factors of unit length: 2e-7 in `f32` and 1e-15 in `f64` for n ≤ 6, asserted by
/// `tests/product.rs`. Coefficients that are not finite give results that are not finite; so do values of `a`, `b` or their
/// product, on the sphere, that are beyond the type.
///
/// ```
/// use sh_core::{Order, product};
///
/// // z · z = 1/3 + a function of band 2
/// let k = (4.0 * std::f64::consts::PI / 3.0).sqrt();
/// let z = [0.0, 0.0, k, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
/// let mut out = [0.0; 9];
/// product(Order::new(3)?, &z, &z, &mut out);
/// let one = (4.0 * std::f64::consts::PI).sqrt();
/// assert!((out[0] - one / 3.0).abs() < 1e-15);
/// assert!((out[6] - 2.0 / 3.0 * (4.0 * std::f64::consts::PI / 5.0).sqrt()).abs() < 1e-15);
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If a slice length does not match `order`. Without the feature `alloc`, if n > 6.
///
/// Source: [SKS02](crate#references) section 3, "product projection".
#[inline]
pub fn product<T: Real>(order: Order, a: &[T], b: &[T], out: &mut [T]) {
    assert_lengths(order, [("a", a.len()), ("b", b.len()), ("out", out.len())]);
    products(order, a, b, out);
}

/// Products of pairs of expansions: `out[d] = a[d] b[d]`, each as by [`product`].
///
/// - `a`, `b`: `[D, n²]`
/// - `out`: `[D, n²]`, overwritten
///
/// For n = 3 to 5 there is one pair of factors in each lane of a register, with the Gaunt coefficients written out: two to five
/// times faster than one by one. Does not allocate for n ≤ 6; beyond, once for all. If one factor is the same in all and n > 3,
/// [`ProductMatrix::apply_many`] is faster.
///
/// # Panics
/// If `out` is not whole vectors, or another slice has not its length. Without the feature `alloc`, if n > 6.
pub fn product_many<T: Real>(order: Order, a: &[T], b: &[T], out: &mut [T]) {
    let count = order.coeff_count();
    assert!(out.len().is_multiple_of(count), "out has {} elements, it needs a multiple of {count}", out.len());
    assert_length("a", a.len(), out.len());
    assert_length("b", b.len(), out.len());
    let done = order.coeff_count()
        * match order.get() {
            3 => dispatch(Batch::<T, 9> { a, b, out }),
            4 => dispatch(Batch::<T, 16> { a, b, out }),
            5 => dispatch(Batch::<T, 25> { a, b, out }),
            _ => 0,
        };
    products(order, &a[done..], &b[done..], &mut out[done..]);
}

/// One or more products; the lengths are checked.
#[inline]
fn products<T: Real>(order: Order, a: &[T], b: &[T], out: &mut [T]) {
    with_samples!(order, T, Products { a, b, out }, {
        if order.get() < 3 { products_linear(order, a, b, out) } else { products_large(order, a, b, out) }
    });
}

/// Orders 1 and 2: `∫ y_0 y_i y_i = 1/√(4π)` is all there is.
fn products_linear<T: Real>(order: Order, a: &[T], b: &[T], out: &mut [T]) {
    let y_0 = T::from_f64(Y_00);
    let count = order.coeff_count();
    let factors = a.chunks_exact(count).zip(b.chunks_exact(count));
    for ((a, b), out) in factors.zip(out.chunks_exact_mut(count)) {
        out[0] = y_0 * a.iter().zip(b).map(|(&a, &b)| a * b).sum::<T>();
        for i in 1..count {
            out[i] = y_0 * (a[0] * b[i] + a[i] * b[0]);
        }
    }
}

/// Orders without samples.
#[cfg(feature = "alloc")]
fn products_large<T: Real>(order: Order, a: &[T], b: &[T], out: &mut [T]) {
    let mut transform = ProductTransform::new(order);
    let count = order.coeff_count();
    let factors = a.chunks_exact(count).zip(b.chunks_exact(count));
    factors.zip(out.chunks_exact_mut(count)).for_each(|((a, b), out)| transform.product(a, b, out));
}

#[cfg(not(feature = "alloc"))]
fn products_large<T: Real>(order: Order, _: &[T], _: &[T], _: &mut [T]) {
    panic!("products of order {order} need the feature `alloc`");
}

/// The square of an expansion, projected to the same order: [`product`] of `a` with itself, up to a third faster.
///
/// - `a`: `[n²]`
/// - `out`: `[n²]`, overwritten
///
/// # Panics
/// As [`product`].
#[inline]
pub fn square<T: Real>(order: Order, a: &[T], out: &mut [T]) {
    assert_lengths(order, [("a", a.len()), ("out", out.len())]);
    with_samples!(order, T, Square { a, out }, products(order, a, a, out));
}

/// The integral of the product of three expansions, `∫ a(s) b(s) c(s) ds`.
///
/// - `a`, `b`, `c`: `[n²]`
///
/// Symmetric up to rounding. For a light, a visibility and a cosine lobe it is the shadowed irradiance. Accuracy, absolute, for
/// factors of unit length: 4e-7 in `f32`, 2e-15 in `f64` for n ≤ 6, asserted by `tests/product.rs`.
///
/// ```
/// use sh_core::{Order, triple_product};
///
/// // ∫ z² ds = 4π/3
/// let one = [(4.0 * std::f64::consts::PI).sqrt(), 0.0, 0.0, 0.0];
/// let z = [0.0, 0.0, (4.0 * std::f64::consts::PI / 3.0).sqrt(), 0.0];
/// let integral = triple_product(Order::new(2)?, &one, &z, &z);
/// assert!((integral - 4.0 * std::f64::consts::PI / 3.0).abs() < 1e-15);
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// As [`product`].
pub fn triple_product<T: Real>(order: Order, a: &[T], b: &[T], c: &[T]) -> T {
    assert_lengths(order, [("a", a.len()), ("b", b.len()), ("c", c.len())]);
    if order.get() <= MAX_SAMPLED {
        let mut product = [T::ZERO; MAX_COEFFS];
        let product = &mut product[..order.coeff_count()];
        products(order, a, b, product);
        dot(product, c)
    } else {
        triple_large(order, a, b, c)
    }
}

#[cfg(feature = "alloc")]
fn triple_large<T: Real>(order: Order, a: &[T], b: &[T], c: &[T]) -> T {
    let mut product = alloc::vec![T::ZERO; order.coeff_count()];
    products(order, a, b, &mut product);
    dot(&product, c)
}

#[cfg(not(feature = "alloc"))]
fn triple_large<T: Real>(order: Order, a: &[T], b: &[T], _: &[T]) -> T {
    products_large(order, a, b, &mut []);
    T::ZERO
}

/// The matrix of the product with a fixed expansion: `out_ij = Σ_k a_k ∫ y_i y_j y_k`, so that `(ab)_i = Σ_j out_ij b_j`.
///
/// - `a`: `[n²]`
/// - `out`: `[n², n²]` row-major, symmetric, overwritten
///
/// This is the transfer matrix of a point whose visibility is `a`, and `∫ y_i y_j` for the constant function 1. Exactly
/// symmetric. Accuracy, allocation and limits as of [`product`]. [`ProductMatrix`] holds one and applies it.
///
/// # Panics
/// If a slice length does not match `order`. Without the feature `alloc`, if n > 6.
pub fn product_matrix<T: Real>(order: Order, a: &[T], out: &mut [T]) {
    let count = order.coeff_count();
    assert_lengths(order, [("a", a.len())]);
    assert_length("out", out.len(), count * count);
    with_samples!(order, T, Matrix { a, out }, columns(order, a, out));
    // Rounding differs between row and column.
    for i in 0..count {
        for j in 0..i {
            out[j * count + i] = out[i * count + j];
        }
    }
}

/// The product with one basis function after the other.
fn columns<T: Real>(order: Order, a: &[T], out: &mut [T]) {
    if order.get() < 3 {
        for (j, column) in out.chunks_exact_mut(order.coeff_count()).enumerate() {
            let mut y_j = [T::ZERO; MAX_COEFFS];
            y_j[j] = T::ONE;
            products_linear(order, a, &y_j[..order.coeff_count()], column);
        }
    } else {
        columns_large(order, a, out);
    }
}

#[cfg(feature = "alloc")]
fn columns_large<T: Real>(order: Order, a: &[T], out: &mut [T]) {
    ProductTransform::new(order).product_matrix(a, out);
}

#[cfg(not(feature = "alloc"))]
fn columns_large<T: Real>(order: Order, a: &[T], out: &mut [T]) {
    products_large(order, a, a, out);
}

/// Panics with the name of a slice that is not `[n²]`.
#[inline]
#[track_caller]
pub(crate) fn assert_lengths<const COUNT: usize>(order: Order, slices: [(&str, usize); COUNT]) {
    for (what, given) in slices {
        assert_length(what, given, order.coeff_count());
    }
}

#[cfg(all(test, feature = "alloc"))]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    extern crate std;

    use std::vec;
    use std::vec::Vec;

    use super::*;
    use crate::simd::{Level, run_at};

    /// The best level is what tests of the public functions run; the others must agree.
    fn levels_agree<T: Real>(tolerance: f64) {
        for n in [3, 4, 5, 6, 7, 10, 17] {
            let (order, count) = (Order::new(n).unwrap(), n * n);
            let number = |i: usize| T::from_f64(Real::sin(1.7 * i as f64) / n as f64);
            let [a, b]: [Vec<T>; 2] = [0, 1].map(|k| (0..count).map(|i| number(i + 40 * k)).collect());
            let matrix = ProductMatrix::new(order, &a);
            let mut expected = vec![T::ZERO; count];
            TripleTensor::new(order).product(&a, &b, &mut expected);
            for level in Level::available() {
                batches_agree(level, n, [&a, &b], &expected, tolerance);
                for way in 0..3 {
                    let mut out = vec![T::from_f64(f64::NAN); count];
                    match (way, n) {
                        (0, 3) => run_at(level, sampled::<T, 3, 9, 13, 16>(T::ORDER_3, &a, &b, &mut out)),
                        (0, 4) => run_at(level, sampled::<T, 4, 16, 19, 32>(T::ORDER_4, &a, &b, &mut out)),
                        (0, 5) => run_at(level, sampled::<T, 5, 36, 43, 48>(T::ORDER_6, &a, &b, &mut out)),
                        (0, 6) => run_at(level, sampled::<T, 6, 36, 43, 48>(T::ORDER_6, &a, &b, &mut out)),
                        (1, _) => run_at(level, matrix.kernel(&b, &mut out)),
                        _ => run_at(level, ProductTransform::new(order).kernel([&a, &b], &mut out)),
                    }
                    let error = out.iter().zip(&expected).map(|(o, e)| (*o - *e).to_f64().abs());
                    let worst = error.fold(0.0, |worst, e| if e > worst || e.is_nan() { e } else { worst });
                    assert!(worst < tolerance, "n = {n}, {level:?}, {way}: {worst:e}");
                }
            }
        }
    }

    /// Enough copies for one full register of any level, and one more.
    fn batches_agree<T: Real>(level: Level, n: usize, factors: [&[T]; 2], expected: &[T], tolerance: f64) {
        let [a, b] = factors.map(|factor| factor.repeat(17));
        let mut out = vec![T::ZERO; a.len()];
        let (a, b, out) = (&a[..], &b[..], &mut out[..]);
        let done = match n {
            3 => run_at(level, Batch::<T, 9> { a, b, out }),
            4 => run_at(level, Batch::<T, 16> { a, b, out }),
            5 => run_at(level, Batch::<T, 25> { a, b, out }),
            _ => return,
        };
        assert_eq!(done, 16);
        for out in out.chunks_exact(n * n).take(done) {
            let error = out.iter().zip(expected).map(|(o, e)| (*o - *e).to_f64().abs());
            assert!(error.fold(0.0, f64::max) < tolerance, "n = {n}, {level:?}");
        }
    }

    fn sampled<'a, T: Real, const N: usize, const N2: usize, const PAIRS: usize, const ROOM: usize>(
        samples: &'a octahedral::Samples<T, N2, PAIRS, ROOM>,
        a: &'a [T],
        b: &'a [T],
        out: &'a mut [T],
    ) -> Products<'a, T, N, N2, PAIRS, ROOM> {
        Products { samples, a, b, out }
    }

    #[test]
    fn all_registers_multiply_alike() {
        // Factors of length below 1, against a sum over up to 10⁵ coefficients in the same precision.
        levels_agree::<f32>(3e-7);
        levels_agree::<f64>(2e-15);
    }
}
