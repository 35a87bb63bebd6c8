//! The error of a sum of lobes, and its derivatives. Nothing about solvers.

mod derivatives;
mod full;
mod generators;
mod legendre;
mod projected;
mod signal;

pub(crate) use full::Full;
pub(crate) use projected::{Projected, lobe_norm};
pub(crate) use signal::Signal;

/// The dot product of two directions.
#[inline(always)]
pub(crate) fn dot3(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
