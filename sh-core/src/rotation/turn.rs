//! Turns about z, four coefficients at a time.

use super::quad::{Constants, Quad};
use super::zyz::Turn;
use crate::Real;

/// Cosines and sines of the multiples of one angle, for `K` quads.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turns<T, const K: usize> {
    cos: [Quad<T>; K],
    /// Negative in the lanes of cosines.
    sin: [Quad<T>; K],
}

impl<T: Real, const K: usize> Turns<T, K> {
    pub(super) const ZERO: Self = Self { cos: [Quad::ZERO; K], sin: [Quad::ZERO; K] };

    /// From the cosine and sine of the angle: quad `i + 1` is quad `i` turned by twice the angle.
    #[inline(always)]
    fn fill(&mut self, [c, s]: Turn<T>, constants: &Constants<T>) {
        let mut cos = Quad::splat(c) * constants.turning + constants.fixed;
        let mut sin = Quad::splat(s) * constants.turning_sine;
        let step_cos = Quad::splat(c * c - s * s);
        let step_sin = Quad::splat((c + c) * s) * constants.sign;
        (self.cos[0], self.sin[0]) = (cos, sin);
        for i in 1..K {
            // The signs in `sin` and `step_sin` cancel.
            (cos, sin) = (cos * step_cos - sin * step_sin, sin * step_cos + cos * step_sin);
            (self.cos[i], self.sin[i]) = (cos, sin);
        }
    }

    /// `cos mα f_m − sin mα f_−m` and `sin mα f_m + cos mα f_−m` for quad `i`.
    #[inline(always)]
    pub(super) fn turn(&self, i: usize, quad: Quad<T>) -> Quad<T> {
        self.cos[i] * quad + self.sin[i] * quad.reversed()
    }
}

/// Fills all three at once; not inlined, see `quad.rs`. The angles are in registers here.
#[inline(never)]
pub(super) fn fill<T: Real, const K: usize>(
    turns: &mut [Turns<T, K>; 3],
    alpha: Turn<T>,
    beta: Turn<T>,
    gamma: Turn<T>,
    constants: &Constants<T>,
) {
    turns[2].fill(gamma, constants);
    turns[1].fill(beta, constants);
    turns[0].fill(alpha, constants);
}
