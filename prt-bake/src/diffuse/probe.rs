//! The error of a bake, estimated at some of its vertices.

use super::direct::{DirectPass, Scratch};
use super::ladder::Ladder;
use crate::BakeOptions;
use crate::transfer::unshadowed_vector;

/// Vertices at which the error is estimated.
const SAMPLES: usize = 64;

/// Bakes some vertices again with another rotation of the directions. Two independent results differ by √2 times the error of one.
#[derive(Debug)]
pub(crate) struct ErrorProbe {
    ladder: Ladder,
    /// One vertex out of so many.
    step: usize,
}

impl ErrorProbe {
    /// `None` where every vertex estimates its own error.
    pub(crate) fn new(options: &BakeOptions, vertex_count: usize) -> Option<Self> {
        let seed = options.seed.wrapping_add(0x5bd1_e995);
        let step = vertex_count.div_ceil(SAMPLES).max(1);
        let ladder = || Ladder::new(&BakeOptions { seed, ..options.clone() });
        options.target_error.is_none().then(|| Self { ladder: ladder(), step })
    }

    /// Whether the vertex of this number is one of those at which the error is estimated.
    pub(crate) fn samples(&self, number: usize) -> bool {
        number.is_multiple_of(self.step)
    }

    /// The estimated error of `row`, the shadowed vector of `vertex`, relative to the length of the unshadowed one.
    pub(crate) fn estimate(&self, direct: &DirectPass, scratch: &mut Scratch, vertex: usize, row: &[f32]) -> f32 {
        let again = DirectPass { ladder: &self.ladder, ..*direct };
        let mut second = vec![0.0; row.len()];
        again.shadowed_vector(scratch, vertex, &mut second);
        let mut unshadowed = vec![0.0; row.len()];
        unshadowed_vector(self.ladder.order, direct.normals[vertex], &mut unshadowed);
        let difference = row.iter().zip(&second).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>();
        let signal = unshadowed.iter().map(|value| value * value).sum::<f64>();
        (0.5 * difference / signal).sqrt() as f32
    }
}
