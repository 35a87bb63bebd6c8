//! Exponential and logarithm of expansions.

mod linear;
mod linear_table;
#[cfg(feature = "alloc")]
mod logarithm;

#[cfg(feature = "alloc")]
pub use logarithm::log;

use crate::product::{assert_lengths, product, square};
use crate::{Order, Real};

/// `√(4π)`: the first coefficient of the function 1.
const ONE: f64 = 3.544_907_701_811_032;

/// The largest order that needs no memory.
const MAX_FIXED: usize = 6;

/// Coefficients of that order.
const MAX_COEFFS: usize = MAX_FIXED * MAX_FIXED;

/// How [`exp`] begins, before anything is squared.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ExpStart {
    /// `a 1 + b f̂`, with `a` and `b` tabulated over the length of `f̂`: no product.
    ///
    /// For n = 2 to 6 they are fitted to sets of blockers, by `tests/exponential_source.rs`. For other orders they are the best
    /// ones for `f̂` of random direction, in closed form. The tables end at the length 4; a longer `f̂` is halved until it fits.
    OptimalLinear,
    /// `1 + f̂ + f̂²/2 + ...` to this degree: one product less than the degree. Degree 0 is the constant 1.
    ProductSeries(u32),
}

/// What [`exp`] trades: products for accuracy.
///
/// One [`square`] per halving, and one [`product`] per degree above 1. Error and time of every choice are printed by the run
/// `sh/exponential` of the program `repro`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExpOptions {
    /// What is done with the halved expansion.
    pub start: ExpStart,
    /// The expansion is halved until its length without the first coefficient is at most this, and the result squared as often.
    /// Infinite: never.
    pub longest: f64,
}

impl ExpOptions {
    /// The optimal linear start alone: no product at all.
    pub const fn linear() -> Self {
        Self { start: ExpStart::OptimalLinear, longest: f64::INFINITY }
    }

    /// The optimal linear start, halved to the length ½ and squared: the hybrid method of the paper.
    pub const fn hybrid() -> Self {
        Self { start: ExpStart::OptimalLinear, longest: 0.5 }
    }

    /// The product series to degree 2, halved to the length 1 and squared: as many products as [`Self::hybrid`], and closer.
    pub const fn balanced() -> Self {
        Self { start: ExpStart::ProductSeries(2), longest: 1.0 }
    }

    /// The product series to degree 4, halved to the length 1 and squared: indistinguishable from the limit for blockers.
    pub const fn accurate() -> Self {
        Self { start: ExpStart::ProductSeries(4), longest: 1.0 }
    }
}

impl Default for ExpOptions {
    /// [`ExpOptions::accurate`].
    fn default() -> Self {
        Self::accurate()
    }
}

/// The exponential of an expansion, by products of the same order.
///
/// For the accumulation of blockers: the logarithm of a product of visibilities is the sum of their logarithms, so with
/// [`log`] of each blocker tabulated, many are multiplied by adding vectors and one exponential at the end.
///
/// With `f̂` the expansion without its first coefficient `f_0` ("DC isolation") and `p` halvings,
///
/// ```text
/// exp f = (exp(f_0/√(4π) 2^−p) · e(2^−p f̂))^(2^p),   e(h) = a 1 + b h   or   1 + h + h²/2 + ... + h^d/d!
/// ```
///
/// where powers are repeated products, each cut off to order `n`. More halvings and a higher degree come to a limit, the
/// exponential in the algebra of those truncated products. This is not the projection of `e^f(s)`: it is what [`log`] inverts,
/// and for blockers it is nearer to the true visibility than that projection. See the table below.
///
/// - `coeffs`: `[n²]`, dimensionless
/// - `out`: `[n²]`, overwritten
///
/// Error relative to the length of the result, for n = 4: mean over sets of 1 to 16 blockers (caps of half angles of 8° to 38°,
/// logarithms with a floor of 0.02), and for random vectors of length 2. "Limit" is against the limit of many halvings,
/// "values" against the projection of `e^f(s)`, "truth" against the projection of the true product of visibilities, of which
/// the remaining 5 % are what the order cannot follow. Asserted by `tests/exponential.rs`, with n = 3 and 6:
///
/// | options | products | blockers: limit | values | truth | random: limit | values |
/// |---|---|---|---|---|---|---|
/// | [`linear`](ExpOptions::linear) | 0 | 9.4e-2 | 9.1e-2 | 1.0e-1 | 1.5e-1 | 1.6e-1 |
/// | linear, halved to 1 | p | 3.6e-2 | 4.5e-2 | 6.3e-2 | 1.0e-1 | 1.2e-1 |
/// | [`hybrid`](ExpOptions::hybrid) | p | 2.0e-2 | 3.3e-2 | 5.6e-2 | 6.1e-2 | 7.8e-2 |
/// | series 4, never halved | 3 | 1.8e-2 | 3.6e-2 | 6.3e-2 | 2.6e-3 | 2.5e-2 |
/// | series 8, never halved | 7 | 1.2e-3 | 2.2e-2 | 5.4e-2 | 5.0e-4 | 2.3e-2 |
/// | [`balanced`](ExpOptions::balanced) | 1 + p | 5.7e-3 | 2.7e-2 | 5.6e-2 | 1.5e-2 | 3.7e-2 |
/// | [`accurate`](ExpOptions::accurate) | 3 + p | 1.0e-4 | 2.2e-2 | 5.4e-2 | 2.0e-4 | 2.3e-2 |
///
/// A series that is not halved fails for long vectors: at n = 6 its error is 0.8 for the same blockers.
///
/// Extremes: zero gives 1. `f_0` so low (−∞ too) that the exponential underflows gives zeros. If a power overflows the type,
/// the first coefficient is +∞ and the others are 0. A NaN in gives NaN, an infinite coefficient beside the first (or one whose
/// square is beyond `f64`) too.
///
/// Does not allocate for n ≤ 6. For n = 1 it is exact for every option.
///
/// ```
/// use sh_core::{ExpOptions, Order, exp};
///
/// let one = (4.0 * std::f64::consts::PI).sqrt();
/// let (f, mut out) = ([-0.5 * one, 0.0, 0.1, 0.0], [0.0; 4]);
/// exp(Order::new(2)?, &ExpOptions::default(), &f, &mut out);
/// assert!((out[0] / one - (-0.5_f64).exp()).abs() < 1e-3);
/// assert!((out[2] - 0.1 * (-0.5_f64).exp()).abs() < 2e-3);
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If a slice length does not match `order`. Without the feature `alloc`, if n > 6.
///
/// Source: [RWS06](crate#references); the tables of `a` and `b` are our own.
pub fn exp<T: Real>(order: Order, options: &ExpOptions, coeffs: &[T], out: &mut [T]) {
    assert_lengths(order, [("coeffs", coeffs.len()), ("out", out.len())]);
    if order.get() <= MAX_FIXED {
        let mut scratch = [[T::ZERO; MAX_COEFFS]; 2];
        let [varying, spare] = scratch.each_mut().map(|buffer| &mut buffer[..order.coeff_count()]);
        let multiply = |a: &[T], b: &[T], out: &mut [T]| {
            if core::ptr::eq(a, b) { square(order, a, out) } else { product(order, a, b, out) }
        };
        exponential(order, options, coeffs, [varying, spare, out], multiply);
    } else {
        exp_large(order, options, coeffs, out);
    }
}

#[cfg(feature = "alloc")]
fn exp_large<T: Real>(order: Order, options: &ExpOptions, coeffs: &[T], out: &mut [T]) {
    let mut transform = crate::ProductTransform::new(order);
    let mut scratch = [(); 2].map(|()| alloc::vec![T::ZERO; order.coeff_count()]);
    let [varying, spare] = scratch.each_mut().map(|buffer| buffer.as_mut_slice());
    let multiply = |a: &[T], b: &[T], out: &mut [T]| transform.product(a, b, out);
    exponential(order, options, coeffs, [varying, spare, out], multiply);
}

#[cfg(not(feature = "alloc"))]
fn exp_large<T: Real>(order: Order, _: &ExpOptions, _: &[T], _: &mut [T]) {
    panic!("the exponential of order {order} needs the feature `alloc`");
}

/// The exponential with any way to multiply. The buffers are for `f̂`, for powers, and for the result.
fn exponential<T: Real>(
    order: Order,
    options: &ExpOptions,
    coeffs: &[T],
    [varying, spare, out]: [&mut [T]; 3],
    mut multiply: impl FnMut(&[T], &[T], &mut [T]),
) {
    let length = Real::sqrt(coeffs[1..].iter().map(|f| f.to_f64() * f.to_f64()).sum::<f64>());
    let mean = coeffs[0].to_f64() / ONE;
    if mean.is_nan() || !length.is_finite() {
        out.fill(T::from_f64(f64::NAN));
        return;
    }
    let halvings = halvings(options, length);
    let scale = Real::exp(-(f64::from(halvings)) * core::f64::consts::LN_2);
    let factor = T::from_f64(Real::exp(mean * scale));
    if factor == T::ZERO {
        out.fill(T::ZERO);
        return;
    }
    varying.iter_mut().zip(coeffs).for_each(|(h, &f)| *h = T::from_f64(f.to_f64() * scale));
    varying[0] = T::ZERO;
    match options.start {
        ExpStart::OptimalLinear => {
            let [a, b] = linear::coefficients(order, length * scale);
            out.iter_mut().zip(&*varying).for_each(|(out, &h)| *out = T::from_f64(b) * h);
            out[0] = T::from_f64(a * ONE);
        }
        ExpStart::ProductSeries(degree) => series(degree, varying, spare, out, &mut multiply),
    }
    out.iter_mut().for_each(|f| *f *= factor);
    for _ in 0..halvings {
        multiply(out, out, spare);
        out.copy_from_slice(spare);
    }
    if out.iter().any(|f| !f.is_finite()) {
        out.fill(T::ZERO);
        out[0] = T::from_f64(f64::INFINITY);
    }
}

/// How often a vector of this length is halved.
fn halvings(options: &ExpOptions, length: f64) -> u32 {
    let table_end = match options.start {
        ExpStart::OptimalLinear => linear::TABLE_END,
        ExpStart::ProductSeries(_) => f64::INFINITY,
    };
    // A limit that makes no sense means the least one that does.
    let longest = options.longest.max(f64::EPSILON).min(table_end);
    let (mut count, mut length) = (0, length);
    while length > longest {
        length *= 0.5;
        count += 1;
    }
    count
}

/// `1 + h (1 + h/2 (1 + ... (1 + h/d)))`.
fn series<T: Real>(
    degree: u32,
    h: &[T],
    spare: &mut [T],
    out: &mut [T],
    multiply: &mut impl FnMut(&[T], &[T], &mut [T]),
) {
    let one = T::from_f64(ONE);
    out.fill(T::ZERO);
    out[0] = one;
    for k in (1..=degree).rev() {
        if k == degree {
            spare.copy_from_slice(h);
        } else {
            multiply(h, out, spare);
        }
        let inverse = T::from_f64(1.0 / f64::from(k));
        out.iter_mut().zip(&*spare).for_each(|(out, &s)| *out = s * inverse);
        out[0] += one;
    }
}
