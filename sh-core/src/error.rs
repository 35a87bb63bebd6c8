//! The error of this crate.

use crate::Order;

/// What can be wrong with a value from outside.
///
/// Slices of the wrong length are broken contracts and panic instead.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The number of bands is zero or above [`Order::MAX`].
    #[error("order {given} is not in 1..={}", Order::MAX)]
    Order {
        /// The number of bands asked for.
        given: usize,
    },
    /// A number that describes a scaling has no meaning there.
    #[error("{what} is {given}, it must be {accepted}")]
    Scaling {
        /// Which number.
        what: &'static str,
        /// Its value.
        given: f64,
        /// The values that have a meaning.
        accepted: &'static str,
    },
}
