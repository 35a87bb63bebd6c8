//! From starts to the best axes of one vector.

use sh_core::BasisGradient;

use crate::problem::{Full, Projected};
use crate::random::Random;
use crate::solver::{Landscape, Limits, Newton, Outcome, conjugate_gradient, quasi_newton};
use crate::start::{Directions, Gains};
use crate::{FitOptions, Method, Stop};

/// A lobe that is added to others is moved, with them, until this decrease is expected of the next iteration: what follows
/// from the next lobe is larger.
const GREEDY_TOLERANCE: f64 = 0.1;
/// Starts are compared after they have come this near to their minima; only the best is followed to the end.
const COMPARE_TOLERANCE: f64 = 0.03;
/// Iterations that tell whether anything is left: convergence is quadratic where nothing is.
const SETTLING: usize = 6;
/// A neighbour's axes are left when the value cannot fall below the best one by so many times the decrease that the next
/// iteration expects.
const REACH: f64 = 4.0;
/// Relative squared error that is rounding once numbers are stored in `f32`.
const ROUNDING: f64 = 1e-14;
/// Relative squared error in units of `μ²` that exact lobes leave under the penalty `μ`: an error of `4 μ`, most of which the
/// last refinement removes.
const LEFT_BY_PENALTY: f64 = 16.0;

/// Axes of one vector.
#[derive(Debug, Clone)]
pub(crate) struct Found {
    pub(crate) axes: Vec<[f64; 3]>,
    /// The penalised squared error, relative to the squared length of the vector.
    pub(crate) value: f64,
    pub(crate) stop: Stop,
}

impl Default for Found {
    fn default() -> Self {
        Self { axes: Vec::new(), value: f64::INFINITY, stop: Stop::Exact }
    }
}

/// What was done.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Counts {
    pub(crate) starts: usize,
    pub(crate) iterations: usize,
    pub(crate) evaluations: usize,
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.starts += other.starts;
        self.iterations += other.iterations;
        self.evaluations += other.evaluations;
    }
}

/// A search for the axes of one vector after the other.
#[derive(Debug)]
pub(crate) struct Search<'a> {
    options: &'a FitOptions,
    directions: &'a Directions,
    problem: Projected,
    newton: Newton,
    /// For the methods that need gradients of the basis.
    tables: BasisGradient<f64>,
    gains: Gains,
    axes: Vec<[f64; 3]>,
    counts: Counts,
}

impl<'a> Search<'a> {
    pub(crate) fn new(options: &'a FitOptions, directions: &'a Directions, problem: Projected) -> Self {
        let (newton, gains) = (Newton::default(), Gains::default());
        let tables = BasisGradient::new(problem.signal().order());
        Self { options, directions, problem, newton, tables, gains, axes: Vec::new(), counts: Counts::default() }
    }

    pub(crate) fn problem_mut(&mut self) -> &mut Projected {
        &mut self.problem
    }

    /// What was done since it was asked last.
    pub(crate) fn take_counts(&mut self) -> Counts {
        self.counts.evaluations += self.problem.take_evaluations();
        std::mem::take(&mut self.counts)
    }

    /// The best axes that the starts lead to.
    ///
    /// - `stream`: numbers the vector; each has its own random starts
    pub(crate) fn run(&mut self, lobes: usize, stream: u64) -> Found {
        let mut best = Found::default();
        self.problem.set_axes(&[]);
        self.greedy(lobes);
        self.compare(&mut best);
        // Without a lobe, or with fewer that leave nothing, there is nothing to search for.
        if lobes == 0 || best.axes.len() < lobes {
            return best;
        }
        for first in Random::for_stream(self.options.seed, stream).even_directions(self.options.starts) {
            self.problem.set_axes(&[first]);
            self.greedy(lobes);
            self.compare(&mut best);
        }
        self.finish(&mut best);
        best
    }

    /// The error that the best lobes about axes leave, relative to the length of the vector.
    pub(crate) fn relative_error(&mut self, axes: &[[f64; 3]]) -> f64 {
        self.problem.set_axes(axes);
        self.problem.unpenalised().max(0.0).sqrt()
    }

    /// Tries other axes, those of a neighbour.
    pub(crate) fn try_axes(&mut self, axes: &[[f64; 3]], best: &mut Found) {
        self.problem.set_axes(axes);
        let limits = Limits { beat: best.value, reach: REACH, ..self.limits(self.options.tolerance) };
        let outcome = self.minimise(&limits);
        self.keep_better(best, outcome.stop);
    }

    /// Adds one lobe after the other, each where it takes most of what is left.
    fn greedy(&mut self, lobes: usize) {
        self.counts.starts += 1;
        while self.problem.axes().len() < lobes && !self.is_exact() {
            if !self.problem.axes().is_empty() {
                self.minimise(&self.limits(GREEDY_TOLERANCE));
                self.settle();
                if self.is_exact() {
                    break;
                }
            }
            self.axes.clear();
            self.axes.extend_from_slice(self.problem.axes());
            self.axes.push(self.directions.best_for_residual(&self.problem, &mut self.gains));
            self.problem.set_axes(&self.axes);
        }
    }

    /// Moves the axes of a start near to their minimum, and keeps them if they are better.
    fn compare(&mut self, best: &mut Found) {
        let outcome = self.minimise(&self.limits(COMPARE_TOLERANCE.max(self.options.tolerance)));
        self.keep_better(best, outcome.stop);
    }

    /// Moves the best axes to their minimum.
    fn finish(&mut self, best: &mut Found) {
        self.problem.set_axes(&best.axes);
        let outcome = self.minimise(&self.limits(self.options.tolerance));
        self.settle();
        self.keep_better(best, outcome.stop);
    }

    /// Where less is left than the penalty, tolerances that are relative to both stop too early to see whether anything is left:
    /// a few more iterations tell.
    fn settle(&mut self) {
        let left = self.problem.unpenalised();
        if left < self.problem.value() - left && !self.is_exact() {
            self.minimise(&Limits { iterations: SETTLING, ..self.limits(0.0) });
        }
    }

    fn keep_better(&self, best: &mut Found, stop: Stop) {
        if self.problem.value() <= best.value {
            best.value = self.problem.value();
            best.stop = if self.is_exact() { Stop::Exact } else { stop };
            best.axes.clear();
            best.axes.extend_from_slice(self.problem.axes());
        }
    }

    fn minimise(&mut self, limits: &Limits) -> Outcome {
        let outcome = match self.options.method {
            Method::VariableProjection => self.newton.minimise(&mut self.problem, limits),
            Method::QuasiNewton => self.minimise_all(|full, x| quasi_newton(full, x, limits)),
            Method::ConjugateGradient => self.minimise_all(|full, x| conjugate_gradient(full, x, limits)),
        };
        self.counts.iterations += outcome.iterations;
        outcome
    }

    /// Moves axes and coefficients at once. They start from the best coefficients for the axes as they are, which the paper
    /// finds by freezing the axes first.
    fn minimise_all(&mut self, minimise: impl Fn(&Full<'_>, &[f64]) -> (Vec<f64>, Outcome, usize)) -> Outcome {
        let full = Full::new(self.problem.signal(), self.options.regularisation, &self.tables);
        let start = full.parameters(&self.problem);
        if start.is_empty() {
            return Outcome { stop: Stop::Converged, iterations: 0 };
        }
        let (found, outcome, evaluations) = minimise(&full, &start);
        let axes = full.axes(&found);
        self.counts.evaluations += evaluations;
        self.problem.set_axes(&axes);
        outcome
    }

    fn limits(&self, tolerance: f64) -> Limits {
        Limits { iterations: self.options.max_iterations, tolerance, beat: f64::INFINITY, reach: f64::INFINITY }
    }

    /// Whether no lobe is needed any more.
    fn is_exact(&self) -> bool {
        self.problem.unpenalised() <= ROUNDING.max(LEFT_BY_PENALTY * self.options.regularisation.powi(2))
    }
}
