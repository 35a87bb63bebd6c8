//! Expansions of fixed order that own their coefficients.

use core::array;
use core::ops::{Add, AddAssign, Deref, DerefMut, Mul, MulAssign, Neg, Sub, SubAssign};

use crate::{Order, Real, convolve, dot, eval, product, reconstruct, rotate};

/// An expansion of fixed order: `LEN = n²` coefficients, without allocation.
///
/// A length that is not a square does not compile. The aliases [`Sh1`] … [`Sh10`] are named by the order. Dereferences to the
/// slice of its coefficients, so every function on slices takes it.
///
/// ```
/// use sh_core::{Sh, Sh3};
///
/// let lobe = Sh3::basis([0.0_f64, 0.6, 0.8]); // a delta function, cut off at three bands
/// let light = lobe * 2.0 + Sh::constant(0.5);
/// assert!((light.value([0.0, 0.6, 0.8]) - (2.0 * lobe.dot(&lobe) + 0.5)).abs() < 1e-14);
/// assert_eq!(light.truncate::<4>()[3], light[3]);
/// ```
///
/// ```compile_fail
/// let none = sh_core::Sh::<f32, 10>::ZERO; // 10 is not a square
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(transparent)]
pub struct Sh<T, const LEN: usize>([T; LEN]);

/// Order 1: a constant.
pub type Sh1<T> = Sh<T, 1>;
/// Order 2.
pub type Sh2<T> = Sh<T, 4>;
/// Order 3: irradiance.
pub type Sh3<T> = Sh<T, 9>;
/// Order 4: Gaussian splats.
pub type Sh4<T> = Sh<T, 16>;
/// Order 5.
pub type Sh5<T> = Sh<T, 25>;
/// Order 6.
pub type Sh6<T> = Sh<T, 36>;
/// Order 7.
pub type Sh7<T> = Sh<T, 49>;
/// Order 8.
pub type Sh8<T> = Sh<T, 64>;
/// Order 9.
pub type Sh9<T> = Sh<T, 81>;
/// Order 10.
pub type Sh10<T> = Sh<T, 100>;

impl<T: Real, const LEN: usize> Sh<T, LEN> {
    /// The order. Evaluated when the program is compiled, which stops if `LEN` is not `n²`.
    pub const ORDER: Order = {
        let n = LEN.isqrt();
        assert!(n * n == LEN, "the number of coefficients is not a square");
        match Order::new(n) {
            Ok(order) => order,
            Err(_) => panic!("the order is not in 1..=Order::MAX"),
        }
    };

    /// All coefficients 0.
    pub const ZERO: Self = {
        let _ = Self::ORDER;
        Self([T::ZERO; LEN])
    };

    /// The expansion with these coefficients.
    #[inline]
    pub const fn new(coeffs: [T; LEN]) -> Self {
        const { _ = Self::ORDER };
        Self(coeffs)
    }

    /// The constant function.
    #[inline]
    pub fn constant(value: T) -> Self {
        let mut sh = Self::ZERO;
        // √(4π)
        sh.0[0] = value * T::from_f64(3.544_907_701_811_032);
        sh
    }

    /// The basis functions at a unit direction, see [`eval`].
    #[inline]
    pub fn basis(direction: [T; 3]) -> Self {
        let mut sh = Self::ZERO;
        eval(Self::ORDER, direction, &mut sh.0);
        sh
    }

    /// The value at a unit direction, see [`reconstruct`].
    #[inline]
    pub fn value(&self, direction: [T; 3]) -> T {
        reconstruct(Self::ORDER, &self.0, direction)
    }

    /// The integral of the product with another function, see [`dot`](crate::dot).
    #[inline]
    pub fn dot(&self, other: &Self) -> T {
        dot(&self.0, &other.0)
    }

    /// The expansion turned by a matrix of rows, see [`rotate`].
    #[must_use]
    pub fn rotated(&self, matrix: [[T; 3]; 3]) -> Self {
        let mut out = Self::ZERO;
        rotate(Self::ORDER, matrix, &self.0, &mut out.0);
        out
    }

    /// The product with another function, cut off at this order, see [`product`].
    ///
    /// # Panics
    /// Without the feature `alloc`, if the order is above 6.
    #[must_use]
    pub fn product(&self, other: &Self) -> Self {
        let mut out = Self::ZERO;
        product(Self::ORDER, &self.0, &other.0, &mut out.0);
        out
    }

    /// The convolution with a zonal kernel `[n]`, see [`convolve`].
    ///
    /// # Panics
    /// If `zonal` is not `[n]`.
    #[must_use]
    pub fn convolved(mut self, zonal: &[T]) -> Self {
        convolve(Self::ORDER, zonal, &mut self.0);
        self
    }

    /// The first `M` coefficients, with zeros where `M` is the larger one.
    #[inline]
    pub fn truncate<const M: usize>(&self) -> Sh<T, M> {
        let _ = Sh::<T, M>::ORDER;
        Sh(array::from_fn(|i| self.0.get(i).copied().unwrap_or(T::ZERO)))
    }

    /// The coefficients.
    #[inline]
    pub fn into_array(self) -> [T; LEN] {
        self.0
    }
}

impl<T: Real, const LEN: usize> Default for Sh<T, LEN> {
    fn default() -> Self {
        Self::ZERO
    }
}

impl<T: Real, const LEN: usize> From<[T; LEN]> for Sh<T, LEN> {
    fn from(coeffs: [T; LEN]) -> Self {
        Self::new(coeffs)
    }
}

impl<T, const LEN: usize> Deref for Sh<T, LEN> {
    type Target = [T];
    #[inline]
    fn deref(&self) -> &[T] {
        &self.0
    }
}

impl<T, const LEN: usize> DerefMut for Sh<T, LEN> {
    #[inline]
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.0
    }
}

impl<T: Real, const LEN: usize> Add for Sh<T, LEN> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self(array::from_fn(|i| self.0[i] + other.0[i]))
    }
}

impl<T: Real, const LEN: usize> Sub for Sh<T, LEN> {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self(array::from_fn(|i| self.0[i] - other.0[i]))
    }
}

impl<T: Real, const LEN: usize> Neg for Sh<T, LEN> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self(self.0.map(|c| -c))
    }
}

/// Scaled by a number.
impl<T: Real, const LEN: usize> Mul<T> for Sh<T, LEN> {
    type Output = Self;
    #[inline]
    fn mul(self, factor: T) -> Self {
        Self(self.0.map(|c| c * factor))
    }
}

impl<T: Real, const LEN: usize> AddAssign for Sh<T, LEN> {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Real, const LEN: usize> SubAssign for Sh<T, LEN> {
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<T: Real, const LEN: usize> MulAssign<T> for Sh<T, LEN> {
    #[inline]
    fn mul_assign(&mut self, factor: T) {
        *self = *self * factor;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arithmetic_is_that_of_functions() {
        let (a, b) = (Sh4::basis([0.0_f64, 0.6, 0.8]), Sh4::basis([0.48, -0.64, 0.6]));
        let mut c = a * 2.0 - b + Sh::constant(1.0);
        c += a;
        c -= -b;
        c *= 0.5;
        let s = [0.36, 0.48, -0.8];
        let expected = 0.5 * (3.0 * a.value(s) + 1.0);
        assert!((c.value(s) - expected).abs() < 1e-15);
        assert_eq!(a.dot(&b), dot(&a, &b));
        assert_eq!(Sh4::<f32>::ORDER.get(), 4);
    }

    #[test]
    fn methods_are_the_functions_on_slices() {
        let quarter_turn_about_z = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
        let a = Sh3::basis([0.36_f64, 0.48, 0.8]);
        let turned = a.rotated(quarter_turn_about_z);
        assert!((turned - Sh3::basis([-0.48, 0.36, 0.8])).iter().all(|c| c.abs() < 1e-15));
        assert!((a.product(&Sh::constant(2.0)) - a * 2.0).iter().all(|c| c.abs() < 1e-15));
        // Only band 0 of the kernel: the mean, times the kernel's integral.
        let mean = a.convolved(&[1.0, 0.0, 0.0]);
        assert!((mean[0] - (4.0 * core::f64::consts::PI).sqrt() * a[0]).abs() < 1e-15 && mean[5] == 0.0);
    }

    #[test]
    fn truncation_cuts_and_fills() {
        let a: Sh2<f32> = [1.0, 2.0, 3.0, 4.0].into();
        assert_eq!(a.truncate::<9>().into_array(), [1.0, 2.0, 3.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(a.truncate::<1>().into_array(), [1.0]);
        assert_eq!(Sh2::<f32>::default(), Sh::ZERO);
    }

    #[test]
    fn every_order_has_an_alias() {
        fn order<T: Real, const LEN: usize>(_: Sh<T, LEN>) -> usize {
            Sh::<T, LEN>::ORDER.get()
        }
        let orders = [
            order(Sh1::<f32>::ZERO),
            order(Sh2::<f32>::ZERO),
            order(Sh3::<f32>::ZERO),
            order(Sh4::<f32>::ZERO),
            order(Sh5::<f32>::ZERO),
            order(Sh6::<f32>::ZERO),
            order(Sh7::<f32>::ZERO),
            order(Sh8::<f32>::ZERO),
            order(Sh9::<f32>::ZERO),
            order(Sh10::<f32>::ZERO),
        ];
        assert!(orders.into_iter().eq(1..=10));
    }
}
