//! What a fit says about itself.

use crate::LobeSet;

/// Why a minimisation ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stop {
    /// There was nothing to fit, or nothing is left: the error is that of rounding.
    Exact,
    /// The error could not be lowered by more than the tolerance.
    Converged,
    /// The error reached the target.
    Target,
    /// All iterations were used.
    Iterations,
}

/// How many minimisations ended for which reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct StopCounts {
    /// [`Stop::Exact`].
    pub exact: usize,
    /// [`Stop::Converged`].
    pub converged: usize,
    /// [`Stop::Target`].
    pub target: usize,
    /// [`Stop::Iterations`].
    pub iterations: usize,
}

impl StopCounts {
    /// Counts one more.
    pub(crate) fn add(&mut self, stop: Stop) {
        *match stop {
            Stop::Exact => &mut self.exact,
            Stop::Converged => &mut self.converged,
            Stop::Target => &mut self.target,
            Stop::Iterations => &mut self.iterations,
        } += 1;
    }
}

/// How the errors of the points are distributed. The error of a point is the L2 length of `t̃ − t` over all channels, relative
/// to the root mean square of the lengths of all `t`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Distribution {
    /// Half of the points are better.
    pub median: f64,
    /// Nine tenths of the points are better.
    pub p90: f64,
    /// 99 of 100 points are better.
    pub p99: f64,
    /// The error of the worst point.
    pub max: f64,
    /// The worst point.
    pub worst_point: usize,
}

/// What a fit of many points says about itself.
#[derive(Debug, Clone, PartialEq)]
pub struct FitReport {
    /// Number of points.
    pub points: usize,
    /// Lobes that are stored per point.
    pub lobes: usize,
    /// L2 error over all points and channels, relative to the L2 length of the signal; 0 if the signal is zero. It is that of
    /// the numbers as stored, in `f32`.
    pub relative_error: f64,
    /// The same for each band alone, `[n]`, relative to the length of the whole signal: the squares add up to that of
    /// `relative_error`.
    pub band_errors: Vec<f64>,
    /// How the errors of the points are distributed.
    pub distribution: Distribution,
    /// How many points use how many lobes, `[N + 1]`.
    pub lobes_used: Vec<usize>,
    /// The largest lobe coefficient, in absolute value, relative to the length of the transfer of its point.
    pub largest_coefficient: f64,
    /// Starts from which axes were searched for, over all points.
    pub starts: u64,
    /// Iterations, over all starts.
    pub iterations: u64,
    /// Evaluations of the error, over all starts.
    pub evaluations: u64,
    /// Why the best minimisation of each point ended.
    pub stops: StopCounts,
    /// Points with a coefficient that is not finite; they were skipped and are zero.
    pub not_finite: Vec<usize>,
    /// Wall clock time.
    pub seconds: f64,
}

impl FitReport {
    /// Compares lobes with what they were fitted to. What was done to find them is left to the caller to fill in.
    ///
    /// - `targets`: `[P, C, n²]`
    ///
    /// # Panics
    /// If `targets` is not as large as the set.
    #[must_use]
    pub fn measure(set: &LobeSet, targets: &[f32]) -> Self {
        let (points, count) = (set.point_count(), set.order.coeff_count());
        let size = set.channels * count;
        assert!(targets.len() == points * size, "targets has {} elements, it needs {}", targets.len(), points * size);
        let mut bands = vec![0.0; set.order.get()];
        let (mut errors, mut signal) = (Vec::with_capacity(points), 0.0);
        let (mut not_finite, mut largest_coefficient) = (Vec::new(), 0.0_f64);
        let mut approximation = vec![0.0; count];
        for (point, target) in targets.chunks_exact(size).enumerate() {
            if target.iter().any(|t| !t.is_finite()) {
                not_finite.push(point);
                continue;
            }
            let length: f64 = target.iter().map(|&t| f64::from(t).powi(2)).sum();
            let mut error = 0.0;
            for (channel, target) in target.chunks_exact(count).enumerate() {
                set.reconstruct(point, channel, &mut approximation);
                for (l, band) in set.order.bands() {
                    let pairs = target[band.clone()].iter().zip(&approximation[band]);
                    let squared: f64 = pairs.map(|(&t, &a)| (f64::from(t) - f64::from(a)).powi(2)).sum();
                    bands[l] += squared;
                    error += squared;
                }
                let largest = set.coeffs_of(point, channel).iter().fold(0.0_f32, |max, g| max.max(g.abs()));
                if length > 0.0 {
                    largest_coefficient = largest_coefficient.max(f64::from(largest) / length.sqrt());
                }
            }
            signal += length;
            errors.push((error, point));
        }
        let relative = |squared: f64| if signal > 0.0 { (squared / signal).sqrt() } else { 0.0 };
        let unit = signal / errors.len().max(1) as f64;
        Self {
            points,
            lobes: set.lobe_count,
            relative_error: relative(bands.iter().sum()),
            band_errors: bands.iter().map(|&band| relative(band)).collect(),
            distribution: Distribution::new(errors, unit),
            lobes_used: vec![0; set.lobe_count + 1],
            largest_coefficient,
            starts: 0,
            iterations: 0,
            evaluations: 0,
            stops: StopCounts::default(),
            not_finite,
            seconds: 0.0,
        }
    }
}

impl Distribution {
    /// From squared errors with their points, and the square of what they are relative to.
    fn new(mut errors: Vec<(f64, usize)>, unit: f64) -> Self {
        errors.sort_by(|a, b| a.0.total_cmp(&b.0));
        let Some(&(_, worst_point)) = errors.last() else { return Self::default() };
        let quantile = |part: f64| {
            let squared = errors[((errors.len() - 1) as f64 * part).round() as usize].0;
            if unit > 0.0 { (squared / unit).sqrt() } else { 0.0 }
        };
        Self { median: quantile(0.5), p90: quantile(0.9), p99: quantile(0.99), max: quantile(1.0), worst_point }
    }
}
