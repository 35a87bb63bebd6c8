//! Four numbers at once, and the order in which they hold a band.
//!
//! Quad `i` of a band holds the coefficients of `m = 2i, 2i+1, −2i−1, −2i`. Then the partners `±m` of a plane rotation are each
//! other's mirror image, and [exchanging y and z](super::exchange) keeps the lanes, but for one swap of two of them: all bands
//! are rotated four coefficients at a time. There are no intrinsics: four equal operations on an array, written to memory,
//! become SSE2 or NEON instructions. Two things keep compilers from that, and are avoided here: constants they know (they
//! treat the lanes with 1, 0 or a negative number differently), and trees of operations that are too deep.

use core::ops::{Add, Mul, Sub};

use super::unrolled::{EXCHANGE, FACTOR_COUNT};
use crate::Real;

/// Four numbers.
#[derive(Clone, Copy, Debug)]
#[repr(align(16))]
pub(crate) struct Quad<T>(pub(super) [T; 4]);

impl<T: Real> Add for Quad<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(core::array::from_fn(|lane| self.0[lane] + other.0[lane]))
    }
}

impl<T: Real> Sub for Quad<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(core::array::from_fn(|lane| self.0[lane] - other.0[lane]))
    }
}

impl<T: Real> Mul for Quad<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(core::array::from_fn(|lane| self.0[lane] * other.0[lane]))
    }
}

impl<T: Real> Quad<T> {
    pub(super) const ZERO: Self = Self([T::ZERO; 4]);

    #[inline(always)]
    pub(super) fn splat(value: T) -> Self {
        Self([value; 4])
    }

    /// Lanes 3, 2, 1, 0.
    #[inline(always)]
    pub(super) fn reversed(self) -> Self {
        let [a, b, c, d] = self.0;
        Self([d, c, b, a])
    }

    /// Lanes 2, 1, 0, 3: what follows the factors of an odd band.
    #[inline(always)]
    pub(super) fn after_odd_band(self) -> Self {
        let [a, b, c, d] = self.0;
        Self([c, b, a, d])
    }

    /// Lanes 0, 3, 2, 1: what follows the factors of an even band.
    #[inline(always)]
    pub(super) fn after_even_band(self) -> Self {
        let [a, b, c, d] = self.0;
        Self([a, d, c, b])
    }

    /// Quad `i` from the coefficients of band `l`. Lane 3 of quad 0 is not used; lanes 1 and 2 neither, where there is no m.
    #[inline(always)]
    pub(super) fn load(l: usize, i: usize, band: &[T]) -> Self {
        let (even, odd) = (2 * i, 2 * i + 1);
        if odd > l {
            return Self([band[l + even], T::ZERO, T::ZERO, band[l - even]]);
        }
        Self([band[l + even], band[l + odd], band[l - odd], band[l - even]])
    }

    /// The inverse of [`Quad::load`].
    #[inline(always)]
    pub(super) fn store(self, l: usize, i: usize, band: &mut [T]) {
        let (even, odd) = (2 * i, 2 * i + 1);
        // For m = 0, lane 0 comes last.
        band[l - even] = self.0[3];
        band[l + even] = self.0[0];
        if odd <= l {
            band[l - odd] = self.0[2];
            band[l + odd] = self.0[1];
        }
    }
}

/// Constants that the compiler must not see through.
#[derive(Debug)]
pub struct Constants<T: 'static> {
    /// The exchange of y and z for bands 1 to 9.
    pub(super) exchange: [Quad<T>; FACTOR_COUNT],
    /// 1 where a lane of quad 0 depends on the angle, for cosines.
    pub(super) turning: Quad<T>,
    /// 1 where it does not.
    pub(super) fixed: Quad<T>,
    /// The same for sines; negative in the lanes of cosines.
    pub(super) turning_sine: Quad<T>,
    /// −1 in the lanes of cosines, 1 in those of sines.
    pub(super) sign: Quad<T>,
}

macro_rules! constants {
    ($float:ident) => {
        Constants {
            exchange: {
                let mut factors = [Quad([0.0; 4]); FACTOR_COUNT];
                let mut i = 0;
                while i < FACTOR_COUNT {
                    let [a, b, c, d] = EXCHANGE[i];
                    factors[i] = Quad([a as $float, b as $float, c as $float, d as $float]);
                    i += 1;
                }
                factors
            },
            turning: Quad([0.0, 1.0, 1.0, 0.0]),
            fixed: Quad([1.0, 0.0, 0.0, 1.0]),
            turning_sine: Quad([0.0, -1.0, 1.0, 0.0]),
            sign: Quad([-1.0, -1.0, 1.0, 1.0]),
        }
    };
}

static F32: Constants<f32> = constants!(f32);
static F64: Constants<f64> = constants!(f64);

/// A scalar with [`Constants`].
pub trait Quads: Sized {
    /// They.
    fn constants() -> &'static Constants<Self>;
}

impl Quads for f32 {
    #[inline(always)]
    fn constants() -> &'static Constants<Self> {
        core::hint::black_box(&F32)
    }
}

impl Quads for f64 {
    #[inline(always)]
    fn constants() -> &'static Constants<Self> {
        core::hint::black_box(&F64)
    }
}
