//! Rays where they are needed: finer directions until the estimated error of a vertex is small enough.
//!
//! Sets of directions are looked along from coarse to fine. Where neighbouring coarse directions agree, a finer one is taken to agree
//! with them; rays go to the outlines of what occludes, where the error is made, and follow them to where the coarse directions did not
//! see them. The number of rays then grows as the square root of the number of directions `N`, and the error falls as `N^-3/4`.
//!
//! Of [SKS02](sh_core#references)'s kind of set, the same for all vertices, 3.4 to 5.1 times as many rays have the error that a target of 0.002
//! reaches, on five meshes (`repro -- prt/error-against-rays`). Time falls less, or not at all: rays at outlines are dear, and packets
//! of rays that all end alike are cheap.
//!
//! What slips between the directions of both sets that are compared is not guessed right by either: on `dragon_100k` the error at a target of
//! 0.001 is 9.7e-4, but estimated as 7.0e-4. Tracing one guessed direction in sixteen too leaves 7.6e-4, for 6 to 24 % more rays and half as
//! much time again, since such rays share no packets; tracing all takes 2 to 5 times as many rays, and no more time (7.4e-4).

use super::VertexStats;
use super::direct::{DirectPass, Scratch};
use crate::transfer::unshadowed_vector;

/// The variance of a set of N directions falls as `N^-1.5`: outlines cross `√N` of N cells, and each such cell errs by its own area,
/// `1/N`. Measured on five meshes from 64 to 16,384 directions, the error falls with a power of 0.73 to 0.77.
const VARIANCE_POWER: f64 = 1.5;

/// How much a comparison of two sets counts beside the next one: one pair alone can agree by chance.
const MEMORY: f64 = 0.5;

/// A vertex stops where its estimate is small enough, and so rather where it is too small by chance; and guesses err alike in all sets.
/// The error of what stops was 1.2 to 1.5 times the bare estimate, on five meshes with target errors of 0.02 to 0.001.
const SELECTION: f64 = 1.25;

/// Estimates of a vertex, weighted by their variance.
#[derive(Debug, Default)]
struct Estimate {
    /// Sum of the weights `N^1.5` of the sets: the inverse of the variance, in units of that of one direction.
    precision: f64,
    /// Weighted sum of the estimates of the variance of one direction, and of their weights.
    variance: [f64; 2],
}

impl DirectPass<'_> {
    /// Leaves the transfer vector of a vertex in `scratch.vector`.
    pub(super) fn refine(&self, scratch: &mut Scratch, vertex: usize, target_error: f64) -> VertexStats {
        let first = self.ladder.first;
        scratch.last = first;
        let mut rays = self.look(scratch, vertex, first, None);
        self.project(scratch, vertex, first);
        if scratch.seen[first].is_open() || scratch.seen[first].is_blocked() {
            return scratch.seen[first].stats(rays, 0.0);
        }
        let length = self.unshadowed_length(scratch, vertex);
        let mut estimate = Estimate { precision: self.precision(first), ..Estimate::default() };
        let mut step = 2;
        loop {
            let rung = (scratch.last + step).min(self.ladder.rungs.len() - 1);
            rays += self.look(scratch, vertex, rung, Some(scratch.last));
            std::mem::swap(&mut scratch.vector, &mut scratch.before);
            scratch.vector.resize(scratch.before.len(), 0.0);
            self.project(scratch, vertex, rung);
            scratch.last = rung;
            let error = (estimate.combine(scratch, self.precision(rung)) / length) as f32;
            if f64::from(error) <= target_error || rung + 1 == self.ladder.rungs.len() {
                return scratch.seen[rung].stats(rays, error);
            }
            step = step_for(f64::from(error) / target_error);
        }
    }

    /// Inverse of the variance of a rung, in units of that of one direction.
    fn precision(&self, rung: usize) -> f64 {
        (self.ladder.rungs[rung].directions.directions.len() as f64).powf(VARIANCE_POWER)
    }

    fn unshadowed_length(&self, scratch: &mut Scratch, vertex: usize) -> f64 {
        scratch.before.resize(scratch.vector.len(), 0.0);
        unshadowed_vector(self.ladder.order, self.normals[vertex], &mut scratch.before);
        scratch.before.iter().map(|value| value * value).sum::<f64>().sqrt()
    }
}

impl Estimate {
    /// Makes the weighted mean of `before` and `vector`, which are independent; returns its estimated error.
    ///
    /// With precisions p and q the squared difference of the two is `c² (1/p + 1/q)` on average, and the variance of their mean
    /// `c² / (p + q)`.
    fn combine(&mut self, scratch: &mut Scratch, precision: f64) -> f64 {
        let (p, q) = (self.precision, precision);
        let mut difference = 0.0;
        for (value, before) in scratch.vector.iter_mut().zip(&scratch.before) {
            difference += (*value - before).powi(2);
            *value = (p * before + q * *value) / (p + q);
        }
        self.precision = p + q;
        let [sum, weight] = self.variance;
        self.variance = [MEMORY * sum + difference / (1.0 / p + 1.0 / q), MEMORY * weight + 1.0];
        SELECTION * (self.variance[0] / self.variance[1] / self.precision).sqrt()
    }
}

/// Rungs to go on by where the error is this many times too large: two, but one if that is enough.
fn step_for(excess: f64) -> usize {
    let needed = excess.powf(2.0 / VARIANCE_POWER);
    if needed <= 2.0 { 1 } else { 2 }
}

#[cfg(test)]
mod tests;
