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
    /// A number among samples that cannot be fitted.
    #[error("{what} {item} of the samples is {given}")]
    Sample {
        /// What it belongs to.
        what: &'static str,
        /// The index of the sample.
        item: usize,
        /// The number.
        given: f64,
    },
    /// The weight of the smoothness of a fit is not a finite number from 0.
    #[error("smoothing {given} is not a finite number from 0")]
    Smoothing {
        /// The number.
        given: f64,
    },
    /// Samples leave a coefficient open.
    #[error("{samples} samples do not determine all {} coefficients of order {order}: the first that is open is {index}", .order * .order)]
    Undetermined {
        /// The number of bands asked for.
        order: usize,
        /// The number of samples.
        samples: usize,
        /// The index of the first coefficient that follows from none of the samples and the coefficients before it.
        index: usize,
    },
    /// There is no such sky in the CIE standard.
    #[error("sky type {given} is not in 1..=15")]
    SkyType {
        /// The type asked for.
        given: u8,
    },
}
