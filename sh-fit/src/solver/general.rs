//! Minimisers of any smooth function, from `argmin`: the paper's BFGS, and conjugate gradients.

use std::cell::{Cell, RefCell};

use argmin::core::{
    CostFunction, Error, Executor, Gradient, IterState, OptimizationResult, State, TerminationReason, TerminationStatus,
};
use argmin::solver::conjugategradient::NonlinearConjugateGradient;
use argmin::solver::conjugategradient::beta::PolakRibiere;
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::quasinewton::BFGS;

use super::{Limits, Outcome};
use crate::Stop;

/// Conjugate gradients have no test of convergence: they are stopped and asked after so many iterations per parameter.
const ROUND: usize = 2;

/// A function of a vector.
pub(crate) trait Smooth {
    fn value(&self, x: &[f64]) -> f64;
    /// Writes the gradient `[x.len()]`.
    fn gradient(&self, x: &[f64], gradient: &mut [f64]);
}

/// Remembers the best place: where a line search fails, `argmin` gives an error and not the way it came.
#[derive(Debug)]
struct Watched<'a, S> {
    function: &'a S,
    best: RefCell<(f64, Vec<f64>)>,
    evaluations: Cell<usize>,
}

impl<S: Smooth> CostFunction for &Watched<'_, S> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, x: &Vec<f64>) -> Result<f64, Error> {
        let value = self.function.value(x);
        self.evaluations.set(self.evaluations.get() + 1);
        let mut best = self.best.borrow_mut();
        if value < best.0 {
            *best = (value, x.clone());
        }
        Ok(value)
    }
}

impl<S: Smooth> Gradient for &Watched<'_, S> {
    type Param = Vec<f64>;
    type Gradient = Vec<f64>;

    fn gradient(&self, x: &Vec<f64>) -> Result<Vec<f64>, Error> {
        let mut gradient = vec![0.0; x.len()];
        self.function.gradient(x, &mut gradient);
        Ok(gradient)
    }
}

impl<'a, S: Smooth> Watched<'a, S> {
    fn new(function: &'a S, start: &[f64]) -> Self {
        let best = RefCell::new((function.value(start), start.to_vec()));
        Self { function, best, evaluations: Cell::new(1) }
    }

    fn best_value(&self) -> f64 {
        self.best.borrow().0
    }

    /// The best place, how the search ended, and its evaluations.
    fn end(self, stop: Stop, iterations: usize) -> (Vec<f64>, Outcome, usize) {
        (self.best.into_inner().1, Outcome { stop, iterations }, self.evaluations.get())
    }
}

type Found<O, S, H> = OptimizationResult<O, S, IterState<Vec<f64>, Vec<f64>, (), H, (), f64>>;

/// Iterations of a run, and whether it used all of them. A run that fails has found no way down: it has converged.
fn ending<O, S, H>(found: Result<Found<O, S, H>, Error>, limit: usize) -> (usize, bool)
where
    IterState<Vec<f64>, Vec<f64>, (), H, (), f64>: State,
{
    let Ok(OptimizationResult { state, .. }) = found else { return (limit, false) };
    let used_up = TerminationStatus::Terminated(TerminationReason::MaxItersReached);
    (state.get_iter() as usize, *state.get_termination_status() == used_up)
}

/// BFGS with the line search of Moré and Thuente.
pub(crate) fn quasi_newton(function: &impl Smooth, start: &[f64], limits: &Limits) -> (Vec<f64>, Outcome, usize) {
    let watched = Watched::new(function, start);
    let solver = BFGS::new(MoreThuenteLineSearch::new()).with_tolerance_cost(limits.tolerance * watched.best_value());
    let Ok(solver) = solver else { return watched.end(Stop::Converged, 0) };
    let unit = |i: usize| (0..start.len()).map(|j| if i == j { 1.0 } else { 0.0 }).collect();
    let identity: Vec<Vec<f64>> = (0..start.len()).map(unit).collect();
    let run = Executor::new(&watched, solver)
        .configure(|state| state.param(start.to_vec()).inv_hessian(identity).max_iters(limits.iterations as u64))
        .timer(false)
        .run();
    let (iterations, used_up) = ending(run, limits.iterations);
    watched.end(if used_up { Stop::Iterations } else { Stop::Converged }, iterations)
}

/// Conjugate gradients after Polak and Ribière.
pub(crate) fn conjugate_gradient(function: &impl Smooth, start: &[f64], limits: &Limits) -> (Vec<f64>, Outcome, usize) {
    let watched = Watched::new(function, start);
    let mut iterations = 0;
    while iterations < limits.iterations {
        let (value, from) = watched.best.borrow().clone();
        let round = (ROUND * start.len()).min(limits.iterations - iterations);
        let solver = NonlinearConjugateGradient::new(MoreThuenteLineSearch::new(), PolakRibiere::new());
        let run = Executor::new(&watched, solver.restart_iters(start.len() as u64))
            .configure(|state| state.param(from).max_iters(round as u64))
            .timer(false)
            .run();
        iterations += ending(run, round).0;
        if value - watched.best_value() <= limits.tolerance * value {
            return watched.end(Stop::Converged, iterations);
        }
    }
    watched.end(Stop::Iterations, iterations)
}
