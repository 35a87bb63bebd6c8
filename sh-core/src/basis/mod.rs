//! The basis functions at a direction.

/// Calls with a constant `$N` where the order has a straight-line kernel.
macro_rules! small_order {
    ($order:expr, $N:ident => $small:expr, else $large:expr) => {
        small_order!(@arms $order, $N => $small, else $large, 1 2 3 4 5 6 7 8 9 10)
    };
    (@arms $order:expr, $N:ident => $small:expr, else $large:expr, $($n:literal)+) => {
        match $order.get() {
            $($n => {
                const $N: usize = $n;
                $small
            })+
            _ => $large,
        }
    };
}

#[cfg(feature = "alloc")]
mod batch;
mod gradient;
mod recurrence;
mod unrolled;

use crate::order::assert_length;
use crate::{Order, Real};
#[cfg(feature = "alloc")]
pub use batch::BLOCK;
#[cfg(feature = "alloc")]
pub(crate) use batch::Batches;
#[cfg(feature = "alloc")]
pub use gradient::BasisGradient;
pub use gradient::{eval_gradient, eval_hessian};
use recurrence::Computed;
#[cfg(feature = "alloc")]
use recurrence::Tabled;

/// Where values go.
///
/// Not a closure: `put` has to be inlined wherever it is called, hundreds of times in one kernel, to be compiled with the
/// CPU features of the kernel.
pub(crate) trait Sink<V> {
    /// Takes `y_i`.
    fn put(&mut self, i: usize, value: V);
}

/// Where values come from.
pub(crate) trait Source<V> {
    /// Gives `y_i`.
    fn get(&self, i: usize) -> V;
}

/// `[n²]` values.
struct Values<'a, V>(&'a mut [V]);

impl<V: Copy> Source<V> for &[V] {
    #[inline(always)]
    fn get(&self, i: usize) -> V {
        self[i]
    }
}

impl<V> Sink<V> for Values<'_, V> {
    #[inline(always)]
    fn put(&mut self, i: usize, value: V) {
        self.0[i] = value;
    }
}

/// Evaluates all basis functions at a direction.
///
/// `out[i] = y_i(direction)` with `i = l(l+1) + m`; signs as on the [crate's page](crate#basis).
///
/// - `direction`: unit length, in the frame of the expansion
/// - `out`: `[n²]`, overwritten
///
/// Straight-line kernels for n ≤ 10, recurrences beyond; does not allocate. For many directions at n > 10, [`Basis`] keeps
/// the factors of the recurrence and is three to five times faster.
///
/// Accuracy, absolute, at every direction: in `f32` 4e-7 for n ≤ 6, 8e-7 for n ≤ 10, 4e-6 for n ≤ 65, 6e-6 beyond; in `f64`
/// 2e-15 for n ≤ 10 and 5e-14 for n = 512; asserted by `tests/accuracy.rs` against 32 digits.
///
/// The direction is not normalised, but that its length is rounded does no harm. Of quite another length than 1 the result
/// is that of some polynomials in `x, y, z` which are the harmonics on the unit sphere only, other ones for n > 10 than below:
/// finite for the zero vector; infinite or NaN, but for the constant `y_0`, where the input or a power of it is. There is no
/// panic.
///
/// ```
/// let mut y = [0.0_f64; 4];
/// sh_core::eval(sh_core::Order::new(2)?, [0.6, 0.0, 0.8], &mut y);
/// let k = 0.4886025119029199; // √(3/(4π))
/// assert_eq!(y, [0.28209479177387814, 0.0, k * 0.8, -k * 0.6]);
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If `out` is not `[n²]`.
#[inline]
pub fn eval<T: Real>(order: Order, direction: [T; 3], out: &mut [T]) {
    assert_length("out", out.len(), order.coeff_count());
    let [x, y, z] = direction;
    small_order!(order, N => eval_small::<T, N>(x, y, z, out), else eval_computed(order, direction, out));
}

/// The straight-line kernel of order `N`. Not inlined, so that what calls it by the order stays short and is; the components
/// come in registers, since three numbers that were stored one by one are slow to load as a pair.
#[inline(never)]
fn eval_small<T: Real, const N: usize>(x: T, y: T, z: T, out: &mut [T]) {
    assert!(out.len() == N * N, "length checked by the caller");
    unrolled::kernel::<T, T, N>([x, y, z], &mut Values(out));
}

/// [`eval`] for an order that is known when the program is compiled: `LEN = n²`.
#[inline(always)]
pub(crate) fn eval_fixed<T: Real, const LEN: usize>(order: Order, direction: [T; 3], out: &mut [T; LEN]) {
    macro_rules! kernels {
        ($($n:literal)+) => {
            $(if LEN == $n * $n {
                return unrolled::kernel::<T, T, $n>(direction, &mut Values(out));
            })+
        };
    }
    kernels!(1 2 3 4 5 6 7 8 9 10);
    eval(order, direction, out);
}

/// The value of an expansion at a direction: `Σ coeffs[i] y_i(direction)`.
///
/// - `coeffs`: `[n²]`
/// - `direction`: unit length
///
/// Does not allocate.
///
/// # Panics
/// If `coeffs` is not `[n²]`.
#[inline]
pub fn reconstruct<T: Real>(order: Order, coeffs: &[T], direction: [T; 3]) -> T {
    assert_length("coeffs", coeffs.len(), order.coeff_count());
    let [x, y, z] = direction;
    small_order!(order, N => reconstruct_small::<T, N>(coeffs, x, y, z), else {
        if order.get() <= T::NATIVE_ORDER {
            recurrence::reconstruct(order, direction, coeffs)
        } else {
            recurrence::reconstruct(order, widen(direction), coeffs)
        }
    })
}

/// The sum of order `N`.
#[inline(never)]
fn reconstruct_small<T: Real, const N: usize>(coeffs: &[T], x: T, y: T, z: T) -> T {
    assert!(coeffs.len() == N * N, "length checked by the caller");
    let mut terms = Terms { coeffs, sums: [T::ZERO; 4] };
    unrolled::kernel::<T, T, N>([x, y, z], &mut terms);
    let [s0, s1, s2, s3] = terms.sums;
    (s0 + s2) + (s1 + s3)
}

/// Adds up `coeffs[i] y_i`, in four sums, so that an addition need not wait for the one before.
struct Terms<'a, T> {
    coeffs: &'a [T],
    sums: [T; 4],
}

impl<T: Real> Sink<T> for Terms<'_, T> {
    #[inline(always)]
    fn put(&mut self, i: usize, value: T) {
        self.sums[i % 4] += self.coeffs[i] * value;
    }
}

/// The recurrence with factors computed on the way, in the type that has the range for this order.
fn eval_computed<T: Real>(order: Order, direction: [T; 3], out: &mut [T]) {
    if order.get() <= T::NATIVE_ORDER {
        recurrence::eval(order, direction, &Computed, out);
    } else {
        recurrence::eval(order, widen(direction), &Computed, out);
    }
}

/// A unit direction in `f64`: its length is corrected, which enters as the `m`-th power.
fn widen<T: Real>(direction: [T; 3]) -> [f64; 3] {
    let direction = direction.map(T::to_f64);
    let length2: f64 = direction.iter().map(|d| d * d).sum();
    // Zero stays zero.
    let scale = 1.0 / Real::sqrt(length2.max(f64::MIN_POSITIVE));
    direction.map(|d| d * scale)
}

/// The basis of one order, with the factors of its recurrence in tables.
///
/// The same values as [`eval`], bit for bit; three to five times faster for n > 10. The tables take about `1.5 n²` numbers.
///
/// ```
/// use sh_core::{Basis, Order};
///
/// let order = Order::new(32)?;
/// let basis = Basis::<f32>::new(order);
/// let mut y = vec![0.0; order.coeff_count()];
/// basis.eval([0.6, 0.0, 0.8], &mut y);
/// // Addition theorem: the squares of a band add up to (2l+1)/(4π), everywhere.
/// let sum: f32 = y[31 * 31..].iter().map(|y| y * y).sum();
/// assert!((sum - 63.0 / (4.0 * std::f32::consts::PI)).abs() < 1e-4);
/// # Ok::<(), sh_core::Error>(())
/// ```
#[cfg(feature = "alloc")]
#[derive(Clone, Debug)]
pub struct Basis<T> {
    order: Order,
    tables: Tables<T>,
}

#[cfg(feature = "alloc")]
#[derive(Clone, Debug)]
enum Tables<T> {
    /// Small orders have straight-line kernels.
    Unrolled,
    Native(Tabled<T>),
    /// The order is beyond the range of `T`.
    Wide(Tabled<f64>),
}

#[cfg(feature = "alloc")]
impl<T: Real> Basis<T> {
    /// Builds the tables: one square root and one division per coefficient.
    pub fn new(order: Order) -> Self {
        let tables = match order.get() {
            n if n <= unrolled::MAX_ORDER => Tables::Unrolled,
            n if n <= T::NATIVE_ORDER => Tables::Native(Tabled::new(order)),
            _ => Tables::Wide(Tabled::new(order)),
        };
        Self { order, tables }
    }

    /// The order of the basis.
    pub fn order(&self) -> Order {
        self.order
    }

    /// Evaluates all basis functions at a unit direction, as [`eval`] does. Does not allocate.
    ///
    /// - `out`: `[n²]`, overwritten
    ///
    /// # Panics
    /// If `out` is not `[n²]`.
    pub fn eval(&self, direction: [T; 3], out: &mut [T]) {
        assert_length("out", out.len(), self.order.coeff_count());
        match &self.tables {
            Tables::Unrolled => eval(self.order, direction, out),
            Tables::Native(tables) => recurrence::eval(self.order, direction, tables, out),
            Tables::Wide(tables) => recurrence::eval(self.order, widen(direction), tables, out),
        }
    }
}

#[cfg(all(test, feature = "alloc"))]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    extern crate std;

    use std::vec;
    use std::vec::Vec;

    use super::*;
    use crate::{fibonacci, index};

    /// Bands 0 to 2 as polynomials, from the crate's page.
    fn closed_forms([x, y, z]: [f64; 3]) -> [f64; 9] {
        use core::f64::consts::PI;
        let linear = (3.0 / (4.0 * PI)).sqrt();
        let quadratic = (15.0 / PI).sqrt() / 2.0;
        [
            0.5 / PI.sqrt(),
            -linear * y,
            linear * z,
            -linear * x,
            quadratic * x * y,
            -quadratic * y * z,
            (5.0 / PI).sqrt() / 4.0 * (3.0 * z * z - 1.0),
            -quadratic * x * z,
            quadratic / 2.0 * (x * x - y * y),
        ]
    }

    fn directions() -> Vec<[f64; 3]> {
        let mut directions = fibonacci(50);
        directions.extend([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.6, 0.0, -0.8]]);
        directions
    }

    #[test]
    fn bands_0_to_2_are_the_closed_forms_with_their_signs() {
        for direction in directions() {
            for n in [3, 6, 10, 11, 20] {
                let mut y = vec![0.0; n * n];
                eval(Order::new(n).unwrap(), direction, &mut y);
                for (i, (y, expected)) in y.iter().zip(closed_forms(direction)).enumerate() {
                    assert!((y - expected).abs() < 4e-16, "n = {n}, y_{i} {direction:?}: {y} {expected}");
                }
            }
        }
    }

    /// `(l, m)` and the function in angles, from the definition with `P_l^m` written out.
    #[test]
    fn some_functions_of_bands_3_to_5_are_their_definition() {
        use core::f64::consts::PI;
        let (theta, phi) = (0.7_f64, 2.1_f64);
        let (s, c) = theta.sin_cos();
        let expected = [
            (3, -3, -(35.0 / (32.0 * PI)).sqrt() * s.powi(3) * (3.0 * phi).sin()),
            (3, 1, -(21.0 / (32.0 * PI)).sqrt() * s * (5.0 * c * c - 1.0) * phi.cos()),
            (4, 2, (45.0 / (64.0 * PI)).sqrt() * s * s * (7.0 * c * c - 1.0) * (2.0 * phi).cos()),
            (5, -4, (3465.0 / (256.0 * PI)).sqrt() * s.powi(4) * c * (4.0 * phi).sin()),
            (5, 5, -(693.0 / (512.0 * PI)).sqrt() * s.powi(5) * (5.0 * phi).cos()),
        ];
        let mut y = [0.0; 36];
        eval(Order::new(6).unwrap(), [s * phi.cos(), s * phi.sin(), c], &mut y);
        for (l, m, expected) in expected {
            assert!((y[index(l, m)] - expected).abs() < 1e-15, "{l} {m}: {} {expected}", y[index(l, m)]);
        }
    }

    #[track_caller]
    fn assert_unrolled_equals_recurrence<T: Real>(tolerance: f64) {
        for (n, direction) in (1..=unrolled::MAX_ORDER).flat_map(|n| directions().into_iter().map(move |d| (n, d))) {
            let (order, direction) = (Order::new(n).unwrap(), direction.map(T::from_f64));
            let (mut fast, mut plain) = (vec![T::ZERO; n * n], vec![T::ZERO; n * n]);
            eval(order, direction, &mut fast);
            eval_computed(order, direction, &mut plain);
            for (i, (fast, plain)) in fast.iter().zip(&plain).enumerate() {
                let difference = (*fast - *plain).to_f64().abs();
                assert!(difference < tolerance, "n = {n}, y_{i} {direction:?}: {fast} {plain}");
            }
        }
    }

    #[test]
    fn unrolled_kernels_equal_the_recurrence() {
        // Both are within the accuracy that `eval` states, so they differ by twice that at most.
        assert_unrolled_equals_recurrence::<f64>(4e-15);
        assert_unrolled_equals_recurrence::<f32>(1.6e-6);
    }

    #[test]
    fn tables_hold_what_is_computed() {
        for n in [1, 5, 10, 11, 15, 16, 17, 24, 65, 130] {
            let order = Order::new(n).unwrap();
            let (mut tabled, mut computed) = (vec![0.0_f32; n * n], vec![0.0; n * n]);
            for direction in directions() {
                let direction = direction.map(|d| d as f32);
                Basis::new(order).eval(direction, &mut tabled);
                eval(order, direction, &mut computed);
                assert_eq!(tabled, computed, "n = {n} {direction:?}");
            }
        }
    }

    #[test]
    fn odd_directions_have_an_answer() {
        for n in [1, 4, 10, 11, 40, 140] {
            let order = Order::new(n).unwrap();
            let mut y = vec![f32::NAN; n * n];
            eval(order, [0.0; 3], &mut y);
            assert!(y.iter().all(|y| y.is_finite()), "n = {n}");
            // No panic, and every element is written.
            for d in [[f32::NAN; 3], [f32::INFINITY, 0.0, 0.0], [1e30, -1e30, 1e30], [f32::MIN_POSITIVE; 3]] {
                eval(order, d, &mut y);
                assert_eq!(y[0], 0.282_094_8);
            }
        }
    }
}
