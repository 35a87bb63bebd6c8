//! The order of an expansion and the index of its coefficients.

use core::fmt;
use core::ops::Range;

use crate::Error;

/// The order `n` of an expansion: the number of its bands `l = 0..n`.
///
/// An order is in `1..=`[`Order::MAX`], so functions that take one need not check it again.
///
/// ```
/// use sh_core::Order;
///
/// let order = Order::new(6)?;
/// assert_eq!(order.coeff_count(), 36);
/// assert_eq!(Order::new(0).unwrap_err().to_string(), "order 0 is not in 1..=512");
/// # Ok::<(), sh_core::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Order(usize);

impl Order {
    /// The largest order.
    ///
    /// The stability tests evaluate all bands up to here, in `f32` and `f64`, at the poles and elsewhere.
    pub const MAX: usize = 512;

    /// The order with `n` bands.
    ///
    /// # Errors
    /// [`Error::Order`] if `n` is zero or above [`Order::MAX`].
    pub const fn new(n: usize) -> Result<Self, Error> {
        if n == 0 || n > Self::MAX { Err(Error::Order { given: n }) } else { Ok(Self(n)) }
    }

    /// The number of bands `n`.
    #[inline]
    pub const fn get(self) -> usize {
        self.0
    }

    /// The number of coefficients, `n²`.
    #[inline]
    pub const fn coeff_count(self) -> usize {
        self.0 * self.0
    }

    /// Every band `l` with the range `l²..(l+1)²` of its coefficients.
    ///
    /// ```
    /// # use sh_core::Order;
    /// let bands: Vec<_> = Order::new(3)?.bands().collect();
    /// assert_eq!(bands, [(0, 0..1), (1, 1..4), (2, 4..9)]);
    /// # Ok::<(), sh_core::Error>(())
    /// ```
    pub fn bands(self) -> impl DoubleEndedIterator<Item = (usize, Range<usize>)> + ExactSizeIterator {
        (0..self.0).map(|l| (l, l * l..(l + 1) * (l + 1)))
    }
}

impl fmt::Display for Order {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl TryFrom<usize> for Order {
    type Error = Error;

    fn try_from(n: usize) -> Result<Self, Error> {
        Self::new(n)
    }
}

/// The index `l(l+1) + m` of the coefficient of band `l`, `m = -l..=l`.
///
/// ```
/// # use sh_core::index;
/// assert_eq!(index(1, -1), 1);
/// assert_eq!(index(2, 0), 6);
/// ```
///
/// # Panics
/// In debug builds, if `|m| > l`.
#[inline]
pub const fn index(l: usize, m: isize) -> usize {
    debug_assert!(m.unsigned_abs() <= l, "m is outside -l..=l");
    (l * (l + 1)).wrapping_add_signed(m)
}

/// Panics with the name of the slice if `given` is not `needed`.
#[inline]
#[track_caller]
pub(crate) fn assert_length(what: &str, given: usize, needed: usize) {
    assert!(given == needed, "{what} has {given} elements, it needs {needed}");
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    #[test]
    fn order_is_checked_once() {
        assert_eq!(Order::new(0), Err(Error::Order { given: 0 }));
        assert_eq!(Order::new(1).unwrap().coeff_count(), 1);
        assert_eq!(Order::new(Order::MAX).unwrap().get(), Order::MAX);
        assert_eq!(Order::new(Order::MAX + 1), Err(Error::Order { given: 513 }));
        assert_eq!(Order::try_from(7), Order::new(7));
    }

    #[test]
    fn indices_count_up_band_by_band() {
        let order = Order::new(20).unwrap();
        let mut expected = 0;
        for (l, range) in order.bands() {
            assert_eq!(range.start, expected);
            for m in -(l as isize)..=l as isize {
                assert_eq!(index(l, m), expected);
                expected += 1;
            }
            assert_eq!(range.end, expected);
        }
        assert_eq!(expected, order.coeff_count());
    }

    #[test]
    #[should_panic(expected = "light has 24 elements, it needs 25")]
    fn wrong_lengths_are_named() {
        assert_length("light", 24, 25);
    }
}
