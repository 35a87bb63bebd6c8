//! The error of a sum of lobes, and its derivatives. Nothing about solvers.

mod generators;
mod legendre;
mod projected;
mod signal;

pub(crate) use projected::{Projected, lobe_norm};
pub(crate) use signal::Signal;

/// Components of the dot product of two directions and of sums along directions.
#[inline(always)]
pub(crate) fn dot3(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
