//! What a fit says about itself.

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
