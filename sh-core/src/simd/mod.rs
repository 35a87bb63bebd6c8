//! Several numbers at once: kernels written once, run with the widest registers of the machine.
//!
//! A [`Kernel`] is generic over [`Lanes`], which a scalar is too (of width 1). [`dispatch`] picks the implementation when
//! the program runs, so nothing has to be compiled for a given machine:
//!
//! | level | registers | where |
//! |---|---|---|
//! | portable | four numbers in an array, which compilers map to SSE2 or NEON | everywhere |
//! | AVX2 and FMA | 256 bits | x86-64, if detected (needs the feature `std`) |
//! | AVX-512F | 512 bits | the same |
//!
//! Results of the levels differ by rounding only: the x86 ones fuse `a·b + c`.
//!
//! # Soundness
//!
//! This is the one module with `unsafe` code, in two places. (1) The methods of the x86 registers call intrinsics that need
//! a CPU feature. Their types are private to this module; they reach a kernel only as the type parameter of
//! [`Kernel::run`], which only [`run_at`] names, after the feature was detected. (Elsewhere they could be named as the types
//! that belong to a scalar, but there is nothing to make a value of them with but [`Lanes`], which is private.) (2) Loads and stores go through pointers:
//! each is preceded by an assertion of the slice's length, or has an array reference of that length.

#[cfg(all(target_arch = "x86_64", feature = "std"))]
#[expect(unsafe_code, reason = "see the head of the module")]
mod x86;

use core::ops::{Add, Mul, Neg, Sub};

use crate::Real;

/// Numbers that are worked on at once.
#[cfg_attr(
    not(all(target_arch = "x86_64", feature = "std")),
    allow(
        unreachable_pub,
        reason = "public in name as the bound of the registers of a sealed trait, where there are some"
    )
)]
pub trait Lanes<T>:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self> + core::fmt::Debug
{
    /// How many.
    const WIDTH: usize;
    /// The same number in every lane.
    fn splat(value: T) -> Self;
    /// The first [`Self::WIDTH`] numbers. Panics if there are fewer.
    fn load(values: &[T]) -> Self;
    /// Writes the first [`Self::WIDTH`] numbers. Panics if there is less room.
    fn store(self, out: &mut [T]);
    /// `self · factor + summand`, fused where the machine can.
    fn mul_add(self, factor: Self, summand: Self) -> Self;
    /// `self / divisor`.
    fn div(self, divisor: Self) -> Self;
    /// In each lane `then` where `self < other`, else `otherwise`; a NaN is not less.
    fn select_less(self, other: Self, then: Self, otherwise: Self) -> Self;
    /// The components of the first [`Self::WIDTH`] directions. Panics if there are fewer.
    fn load_directions(directions: &[[T; 3]]) -> [Self; 3];
    /// Asks for memory that will be written soon.
    #[inline(always)]
    fn prefetch(_: &mut [T]) {}
    /// Writes lane `d` of `rows[j]` to `out[d · stride + j]`, for [`Self::WIDTH`] rows. Panics if there are fewer, or `out`
    /// ends before that.
    fn store_square(rows: &[Self], stride: usize, out: &mut [T]);
    /// The same for any number of rows.
    fn store_transposed(rows: &[Self], stride: usize, out: &mut [T]);
    /// Reads `values[d · stride + j]` into lane `d` of `rows[j]`. Panics if `values` ends before that.
    fn load_transposed(rows: &mut [Self], stride: usize, values: &[T]);
}

/// Work that can be done in lanes of any width. `run` and what it calls must be `#[inline(always)]`: a function that is not
/// inlined is compiled without the CPU features.
pub(crate) trait Kernel<T> {
    /// The result.
    type Output;
    /// Does the work.
    fn run<V: Lanes<T>>(self) -> Self::Output;
}

/// What [`dispatch`] can choose from, from the plainest to the widest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Level {
    Portable,
    #[cfg(all(target_arch = "x86_64", feature = "std"))]
    Avx2,
    #[cfg(all(target_arch = "x86_64", feature = "std"))]
    Avx512,
}

impl Level {
    /// The widest that this machine has.
    #[inline]
    fn best() -> Self {
        #[cfg(all(target_arch = "x86_64", feature = "std"))]
        if std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma") {
            return if std::is_x86_feature_detected!("avx512f") { Self::Avx512 } else { Self::Avx2 };
        }
        Self::Portable
    }

    /// The same without registers of 512 bits.
    #[inline]
    fn narrow(self) -> Self {
        match self {
            #[cfg(all(target_arch = "x86_64", feature = "std"))]
            Self::Avx512 => Self::Avx2,
            level => level,
        }
    }

    /// All that this machine has.
    #[cfg(test)]
    pub(crate) fn available() -> impl Iterator<Item = Self> {
        let levels = [
            Self::Portable,
            #[cfg(all(target_arch = "x86_64", feature = "std"))]
            Self::Avx2,
            #[cfg(all(target_arch = "x86_64", feature = "std"))]
            Self::Avx512,
        ];
        let count = levels.iter().position(|&level| level == Self::best()).map_or(1, |best| best + 1);
        levels.into_iter().take(count)
    }
}

/// Runs a kernel with the widest registers of this machine.
#[inline]
pub(crate) fn dispatch<T: Real, K: Kernel<T>>(kernel: K) -> K::Output {
    run_at(Level::best(), kernel)
}

/// Runs a kernel with registers of at most eight numbers.
#[inline]
pub(crate) fn dispatch_narrow<T: Real, K: Kernel<T>>(kernel: K) -> K::Output {
    run_at(Level::best().narrow(), kernel)
}

/// Runs a kernel at a level. One that the machine does not have is replaced by the portable one.
#[inline]
#[cfg_attr(all(target_arch = "x86_64", feature = "std"), expect(unsafe_code, reason = "see the head of this module"))]
pub(crate) fn run_at<T: Real, K: Kernel<T>>(level: Level, kernel: K) -> K::Output {
    match level {
        // SAFETY: the features that the function is compiled for are detected right here.
        #[cfg(all(target_arch = "x86_64", feature = "std"))]
        Level::Avx512 if Level::best() == Level::Avx512 => unsafe { x86::with_avx512::<T, K>(kernel) },
        // SAFETY: as above; every machine of a wider level has this one.
        #[cfg(all(target_arch = "x86_64", feature = "std"))]
        Level::Avx2 if Level::best() != Level::Portable => unsafe { x86::with_avx2::<T, K>(kernel) },
        _ => kernel.run::<Four<T>>(),
    }
}

/// The registers of a scalar type.
pub trait Registers: Sized {
    /// 256 bits.
    #[cfg(all(target_arch = "x86_64", feature = "std"))]
    type Avx2: Lanes<Self>;
    /// 512 bits.
    #[cfg(all(target_arch = "x86_64", feature = "std"))]
    type Avx512: Lanes<Self>;
}

#[cfg(not(all(target_arch = "x86_64", feature = "std")))]
impl Registers for f32 {}
#[cfg(not(all(target_arch = "x86_64", feature = "std")))]
impl Registers for f64 {}

/// A scalar is one lane. Not fused: without hardware for it, `mul_add` is a slow function call.
impl<T: Real> Lanes<T> for T {
    const WIDTH: usize = 1;

    #[inline(always)]
    fn splat(value: T) -> Self {
        value
    }
    #[inline(always)]
    fn load(values: &[T]) -> Self {
        values[0]
    }
    #[inline(always)]
    fn store(self, out: &mut [T]) {
        out[0] = self;
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, summand: Self) -> Self {
        self * factor + summand
    }
    #[inline(always)]
    fn div(self, divisor: Self) -> Self {
        self / divisor
    }
    #[inline(always)]
    fn select_less(self, other: Self, then: Self, otherwise: Self) -> Self {
        if self < other { then } else { otherwise }
    }
    #[inline(always)]
    fn load_directions(directions: &[[T; 3]]) -> [Self; 3] {
        directions[0]
    }
    #[inline(always)]
    fn store_square(rows: &[Self], _: usize, out: &mut [T]) {
        out[0] = rows[0];
    }
    #[inline(always)]
    fn store_transposed(rows: &[Self], _: usize, out: &mut [T]) {
        out[..rows.len()].copy_from_slice(rows);
    }
    #[inline(always)]
    fn load_transposed(rows: &mut [Self], _: usize, values: &[T]) {
        rows.copy_from_slice(&values[..rows.len()]);
    }
}

/// Four numbers, for every machine.
#[derive(Clone, Copy, Debug)]
#[repr(align(16))]
struct Four<T>([T; 4]);

impl<T: Real> Four<T> {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(T, T) -> T) -> Self {
        let ([a, b, c, d], [e, g, h, i]) = (self.0, other.0);
        Self([f(a, e), f(b, g), f(c, h), f(d, i)])
    }
}

impl<T: Real> Add for Four<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl<T: Real> Sub for Four<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl<T: Real> Mul for Four<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl<T: Real> Neg for Four<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0.map(|a| -a))
    }
}

impl<T: Real> Lanes<T> for Four<T> {
    const WIDTH: usize = 4;

    #[inline(always)]
    fn splat(value: T) -> Self {
        Self([value; 4])
    }
    #[inline(always)]
    fn load(values: &[T]) -> Self {
        Self([values[0], values[1], values[2], values[3]])
    }
    #[inline(always)]
    fn store(self, out: &mut [T]) {
        out[..4].copy_from_slice(&self.0);
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, summand: Self) -> Self {
        self * factor + summand
    }
    #[inline(always)]
    fn div(self, divisor: Self) -> Self {
        self.zip(divisor, |a, b| a / b)
    }
    #[inline(always)]
    fn select_less(self, other: Self, then: Self, otherwise: Self) -> Self {
        Self(core::array::from_fn(|d| if self.0[d] < other.0[d] { then.0[d] } else { otherwise.0[d] }))
    }
    #[inline(always)]
    fn load_directions(directions: &[[T; 3]]) -> [Self; 3] {
        let directions = &directions[..4];
        core::array::from_fn(|axis| Self(core::array::from_fn(|d| directions[d][axis])))
    }
    #[inline(always)]
    fn store_square(rows: &[Self], stride: usize, out: &mut [T]) {
        Self::store_transposed(&rows[..4], stride, out);
    }
    #[inline(always)]
    fn store_transposed(rows: &[Self], stride: usize, out: &mut [T]) {
        for d in 0..4 {
            out[d * stride..][..rows.len()].iter_mut().zip(rows).for_each(|(out, row)| *out = row.0[d]);
        }
    }
    #[inline(always)]
    fn load_transposed(rows: &mut [Self], stride: usize, values: &[T]) {
        assert!(values.len() >= 3 * stride + rows.len(), "a value for every lane");
        for d in 0..4 {
            rows.iter_mut().zip(&values[d * stride..]).for_each(|(row, &value)| row.0[d] = value);
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec;
    use std::vec::Vec;

    use super::*;

    /// Every operation on some numbers, lane by lane against the scalar; returns the width.
    struct Everything;

    impl<T: Real> Kernel<T> for Everything {
        type Output = usize;

        fn run<V: Lanes<T>>(self) -> usize {
            let width = V::WIDTH;
            let numbers = |from: f64| -> Vec<T> {
                (0..width).map(|d| T::from_f64(from + 1.5 * d as f64 + 0.1 * (d * d) as f64)).collect()
            };
            let (a, b, c) = (numbers(-3.0), numbers(2.0), numbers(0.7));
            let [va, vb, vc] = [&a, &b, &c].map(|values| V::load(values));
            let lanes = |value: V| {
                let mut out = vec![T::ZERO; width];
                value.store(&mut out);
                out
            };
            let each = |f: &dyn Fn(usize) -> T| (0..width).map(f).collect::<Vec<T>>();
            assert_eq!(lanes(V::splat(a[0])), vec![a[0]; width]);
            assert_eq!(lanes(va + vb), each(&|d| a[d] + b[d]));
            assert_eq!(lanes(va - vb), each(&|d| a[d] - b[d]));
            assert_eq!(lanes(va * vb), each(&|d| a[d] * b[d]));
            assert_eq!(lanes(-va), each(&|d| -a[d]));
            assert_eq!(lanes(va.div(vb)), each(&|d| a[d] / b[d]));
            assert_eq!(lanes(va.select_less(vc, va, vb)), each(&|d| if a[d] < c[d] { a[d] } else { b[d] }));
            for (fused, d) in lanes(va.mul_add(vb, vc)).into_iter().zip(0..) {
                let bound = T::EPSILON * ((a[d] * b[d]).abs() + c[d].abs());
                assert!((fused - (a[d] * b[d] + c[d])).abs() <= bound);
            }
            directions::<T, V>();
            transposes::<T, V>();
            width
        }
    }

    fn directions<T: Real, V: Lanes<T>>() {
        let numbers: Vec<[T; 3]> =
            (0..V::WIDTH).map(|d| core::array::from_fn(|axis| T::from_f64((10 * d + axis) as f64))).collect();
        for (axis, values) in V::load_directions(&numbers).into_iter().enumerate() {
            let mut out = vec![T::ZERO; V::WIDTH];
            values.store(&mut out);
            assert!(out.iter().zip(&numbers).all(|(out, direction)| *out == direction[axis]), "{out:?}");
        }
    }

    fn transposes<T: Real, V: Lanes<T>>() {
        for (count, stride) in [(1, 1), (4, 4), (9, 9), (16, 16), (16, 20), (36, 36), (37, 40)] {
            let rows: Vec<V> = (0..count)
                .map(|j| V::load(&(0..V::WIDTH).map(|d| T::from_f64((100 * d + j) as f64)).collect::<Vec<T>>()))
                .collect();
            let mut out = vec![T::from_f64(-1.0); (V::WIDTH - 1) * stride + count];
            V::store_transposed(&rows, stride, &mut out);
            for (at, value) in out.iter().enumerate() {
                let (d, j) = (at / stride, at % stride);
                let expected = if j < count { (100 * d + j) as f64 } else { -1.0 };
                assert_eq!(value.to_f64(), expected, "{count} {stride} {d} {j}");
            }
            let mut back = vec![V::splat(T::ZERO); count];
            V::load_transposed(&mut back, stride, &out);
            for (j, row) in back.iter().enumerate() {
                let mut lanes = vec![T::ZERO; V::WIDTH];
                row.store(&mut lanes);
                assert!(lanes.iter().enumerate().all(|(d, lane)| lane.to_f64() == (100 * d + j) as f64));
            }
        }
    }

    #[test]
    fn every_level_computes_the_same() {
        assert_eq!((Kernel::<f32>::run::<f32>(Everything), Kernel::<f64>::run::<f64>(Everything)), (1, 1));
        for level in Level::available() {
            let widths = (run_at::<f32, _>(level, Everything), run_at::<f64, _>(level, Everything));
            let expected = match level {
                Level::Portable => (4, 4),
                #[cfg(all(target_arch = "x86_64", feature = "std"))]
                Level::Avx2 => (8, 4),
                #[cfg(all(target_arch = "x86_64", feature = "std"))]
                Level::Avx512 => (16, 8),
            };
            assert_eq!(widths, expected, "{level:?}");
        }
    }

    #[test]
    fn the_widest_level_is_chosen() {
        assert_eq!(Some(Level::best()), Level::available().last());
    }
}
