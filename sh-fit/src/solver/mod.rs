//! The minimisers. They know nothing about harmonics.

pub(crate) mod cholesky;
mod general;
mod newton;

pub(crate) use general::{Smooth, conjugate_gradient, quasi_newton};
pub(crate) use newton::{Limits, Newton, Outcome};

/// A function that can be walked on. Steps are taken in coordinates that begin at 0 at the current place.
pub(crate) trait Landscape {
    /// Number of coordinates.
    fn dimension(&self) -> usize;
    /// The value at the current place: twice the function whose derivatives are told, as it is for squared errors.
    fn value(&self) -> f64;
    /// Writes the gradient `[d]` and the Hessian `[d, d]` of half the value.
    fn derivatives(&mut self, gradient: &mut [f64], hessian: &mut [f64]);
    /// The value after a step `[d]` from the current place.
    fn try_step(&mut self, step: &[f64]) -> f64;
    /// Goes where the last step led.
    fn accept(&mut self);
}
