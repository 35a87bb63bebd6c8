//! How often values fall between edges.

use serde_json::{Value, json};

/// Counts between edges. Every value is counted once: in a bin, below, above, or as missing.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Histogram {
    /// `[B + 1]`, increasing.
    pub(super) edges: Vec<f64>,
    /// `[B]`; a bin holds its lower edge, the last one its upper edge too.
    pub(super) counts: Vec<u64>,
    pub(super) below: u64,
    pub(super) above: u64,
    /// Values that are not numbers.
    pub(super) missing: u64,
}

impl Histogram {
    /// `bins` bins of one width from `low` to `high`.
    pub(super) fn linear(values: impl IntoIterator<Item = f32>, [low, high]: [f64; 2], bins: usize) -> Self {
        let edges = (0..=bins).map(|i| low + (high - low) * i as f64 / bins as f64).collect();
        Self::count(values, edges)
    }

    /// Bins of one ratio from `10^first` to `10^last`, `per_decade` to a factor of ten.
    pub(super) fn logarithmic(
        values: impl IntoIterator<Item = f32>,
        [first, last]: [i32; 2],
        per_decade: usize,
    ) -> Self {
        let bins = (last - first) as usize * per_decade;
        let edges = (0..=bins).map(|i| 10_f64.powf(f64::from(first) + i as f64 / per_decade as f64)).collect();
        Self::count(values, edges)
    }

    fn count(values: impl IntoIterator<Item = f32>, edges: Vec<f64>) -> Self {
        let bins = edges.len() - 1;
        let mut histogram = Self { edges, counts: vec![0; bins], below: 0, above: 0, missing: 0 };
        values.into_iter().for_each(|value| histogram.add(f64::from(value)));
        histogram
    }

    fn add(&mut self, value: f64) {
        let bins = self.counts.len();
        let reached = self.edges.partition_point(|&edge| edge <= value);
        let count = match reached {
            _ if value.is_nan() => &mut self.missing,
            0 => &mut self.below,
            reached if reached <= bins => &mut self.counts[reached - 1],
            _ if value <= self.edges[bins] => &mut self.counts[bins - 1],
            _ => &mut self.above,
        };
        *count += 1;
    }

    /// The bins from the first to the last that hold something; at least one.
    pub(super) fn occupied(&self) -> std::ops::Range<usize> {
        let first = self.counts.iter().position(|&count| count > 0).unwrap_or(0);
        let last = self.counts.iter().rposition(|&count| count > 0).unwrap_or(0);
        first..last + 1
    }

    pub(super) fn json(&self) -> Value {
        let Self { edges, counts, below, above, missing } = self;
        json!({ "edges": edges, "counts": counts, "below": below, "above": above, "missing": missing })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn edges_belong_to_the_bin_above_and_the_last_to_the_last() {
        let values = [-0.1, 0.0, 0.24, 0.25, 0.99, 1.0, 1.1, f32::NAN, f32::INFINITY];
        let histogram = Histogram::linear(values, [0.0, 1.0], 4);
        assert_eq!(histogram.edges, [0.0, 0.25, 0.5, 0.75, 1.0]);
        assert_eq!(histogram.counts, [2, 1, 0, 2]);
        assert_eq!((histogram.below, histogram.above, histogram.missing), (1, 2, 1));
        assert_eq!(histogram.occupied(), 0..4);
    }

    #[test]
    fn decades_are_split_evenly() {
        let histogram = Histogram::logarithmic([0.0, 2e-3, 5e-2, 0.3], [-3, 0], 1);
        assert_eq!((histogram.below, histogram.counts.as_slice()), (1, &[1_u64, 1, 1] as &[u64]));
        assert_eq!(Histogram::logarithmic([5e-2], [-3, 0], 2).occupied(), 3..4);
    }

    proptest! {
        #[test]
        fn nothing_is_lost(values in prop::collection::vec(prop::num::f32::ANY, 0..50)) {
            let count = values.len() as u64;
            let histogram = Histogram::logarithmic(values, [-6, 0], 4);
            let counted = histogram.counts.iter().sum::<u64>() + histogram.below + histogram.above + histogram.missing;
            prop_assert_eq!(counted, count);
        }
    }
}
