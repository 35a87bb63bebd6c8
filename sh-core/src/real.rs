//! The scalar of the crate: `f32` or `f64`, with functions from the standard library or from `libm`.

use core::fmt::{Debug, Display};
use core::iter::Sum;
use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

mod sealed {
    #[cfg(feature = "alloc")]
    pub(crate) use crate::basis::Batches;

    /// There are batches with `alloc` only.
    #[cfg(not(feature = "alloc"))]
    pub trait Batches {}
    #[cfg(not(feature = "alloc"))]
    impl Batches for f32 {}
    #[cfg(not(feature = "alloc"))]
    impl Batches for f64 {}

    /// Closes [`Real`](super::Real), and holds what only this crate needs to know of a scalar.
    pub trait Sealed:
        crate::simd::Registers
        + crate::product::Sampled
        + crate::rotation::Quads
        + crate::rotation::BandValues
        + Batches
    {
        /// Largest order that the recurrence evaluates in this type; above it, it works in `f64` and rounds.
        ///
        /// Near a pole the recurrence multiplies the tiny `sin^m theta` by factors of up to `10^(0.21 n)`. Both must fit
        /// the range of the type without losing a value that matters: `10^(0.21·128) · 1e-38 < 1e-11` in `f32`, and
        /// `10^(0.21·512) · 1e-308 < 1e-200` in `f64`.
        const NATIVE_ORDER: usize;
        /// `2^k + 1` with half of the digits of the mantissa: splits a number into two halves whose products are exact.
        const SPLIT: Self;
    }
    impl Sealed for f32 {
        const NATIVE_ORDER: usize = 128;
        const SPLIT: Self = 4097.0;
    }
    impl Sealed for f64 {
        const NATIVE_ORDER: usize = crate::Order::MAX;
        const SPLIT: Self = 134_217_729.0;
    }
}

/// A floating-point type: `f32` or `f64`.
///
/// Sealed: the tables and the accuracy stated in this crate hold for these two.
pub trait Real:
    sealed::Sealed
    + Copy
    + Debug
    + Display
    + Default
    + PartialEq
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + Sum
    + Send
    + Sync
    + 'static
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// The distance from 1 to the next larger number.
    const EPSILON: Self;

    /// The nearest number of this type.
    fn from_f64(value: f64) -> Self;
    /// The same number in `f64`, exactly.
    fn to_f64(self) -> f64;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Sine of an angle in radians.
    fn sin(self) -> Self;
    /// Cosine of an angle in radians.
    fn cos(self) -> Self;
    /// Angle of the point `(x, self)` in `-π..=π`.
    fn atan2(self, x: Self) -> Self;
    /// `sqrt(self² + other²)` without overflow or underflow on the way.
    fn hypot(self, other: Self) -> Self;
    /// `e` to this power.
    fn exp(self) -> Self;
    /// `exp(self) − 1` without cancellation near zero.
    fn exp_m1(self) -> Self;
    /// Natural logarithm.
    fn ln(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool;
}

#[cfg(feature = "std")]
macro_rules! float {
    ($std:path, $libm:ident, $($argument:expr),+) => { $std($($argument),+) };
}
#[cfg(all(feature = "libm", not(feature = "std")))]
macro_rules! float {
    ($std:path, $libm:ident, $($argument:expr),+) => { libm::$libm($($argument),+) };
}
// Such a build is refused in `lib.rs`; this arm keeps that the only error.
#[cfg(not(any(feature = "std", feature = "libm")))]
macro_rules! float {
    ($std:path, $libm:ident, $($argument:expr),+) => { [$($argument),+][0] };
}

macro_rules! impl_real {
    ($float:ident, $sqrt:ident, $sin:ident, $cos:ident, $atan2:ident, $hypot:ident,
     $exp:ident, $exp_m1:ident, $ln:ident) => {
        impl Real for $float {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const EPSILON: Self = Self::EPSILON;

            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                value as Self
            }
            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                float!($float::sqrt, $sqrt, self)
            }
            #[inline]
            fn sin(self) -> Self {
                float!($float::sin, $sin, self)
            }
            #[inline]
            fn cos(self) -> Self {
                float!($float::cos, $cos, self)
            }
            #[inline]
            fn atan2(self, x: Self) -> Self {
                float!($float::atan2, $atan2, self, x)
            }
            #[inline]
            fn hypot(self, other: Self) -> Self {
                float!($float::hypot, $hypot, self, other)
            }
            #[inline]
            fn exp(self) -> Self {
                float!($float::exp, $exp, self)
            }
            #[inline]
            fn exp_m1(self) -> Self {
                float!($float::exp_m1, $exp_m1, self)
            }
            #[inline]
            fn ln(self) -> Self {
                float!($float::ln, $ln, self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                $float::abs(self)
            }
            #[inline(always)]
            fn is_finite(self) -> bool {
                $float::is_finite(self)
            }
        }
    };
}

impl_real!(f32, sqrtf, sinf, cosf, atan2f, hypotf, expf, expm1f, logf);
impl_real!(f64, sqrt, sin, cos, atan2, hypot, exp, expm1, log);
