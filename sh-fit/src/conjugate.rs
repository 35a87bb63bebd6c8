//! Nonlinear conjugate gradients with a convergence test.

/// When to stop.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits {
    pub(crate) iterations: usize,
    /// An iteration that lowers the cost by less than this part of it counts as still; [`STILL`] of them end the search.
    pub(crate) tolerance: f64,
}

/// How the search went.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Search {
    pub(crate) cost: f64,
    pub(crate) iterations: usize,
    pub(crate) evaluations: usize,
    pub(crate) converged: bool,
}

/// Still iterations in a row that end the search: one alone may be a bad direction, which the next restart mends.
const STILL: usize = 3;

/// The Wolfe conditions: a step must lower the cost by at least this part of what the slope promises …
const DECREASE: f64 = 1e-4;
/// … and the slope to this part of what it was. Conjugate directions want it below ½; Nocedal and Wright give 0.1.
const CURVATURE: f64 = 0.1;

/// Evaluations of one line search.
const MAX_TRIALS: usize = 20;

/// Minimises `cost` from `x`, by the method of Polak and Ribière with restarts, scaled by `scale`.
///
/// - `x`: the start; at the end the best point that was found
/// - `scale`: `[len of x]`, the inverse of the expected curvature along each variable; positive
/// - `cost`: returns the value at its first argument and writes the gradient into its second
///
/// Stops with its best point; a cost that is not finite counts as infinitely high.
///
/// Source: Nocedal and Wright, *Numerical Optimization*, second edition, algorithm 5.4 with β = max(0, β_PR), algorithms 3.5 and
/// 3.6. The paper uses [Press et al. 1992], which is the same method with an exact line search.
pub(crate) fn minimise(
    x: &mut [f64],
    scale: &[f64],
    mut cost: impl FnMut(&[f64], &mut [f64]) -> f64,
    limits: Limits,
) -> Search {
    let mut state = State::new(x, scale, &mut cost);
    let mut still = 0;
    while state.search.iterations < limits.iterations {
        let before = state.search.cost;
        if !state.step(x, scale, &mut cost) {
            state.search.converged = true;
            break;
        }
        state.search.iterations += 1;
        let stands = before - state.search.cost <= limits.tolerance * before;
        still = if stands { still + 1 } else { 0 };
        if still == STILL {
            state.search.converged = true;
            break;
        }
    }
    state.search
}

/// Where the search is.
struct State {
    search: Search,
    gradient: Vec<f64>,
    direction: Vec<f64>,
    /// `g · scale · g` of the point before.
    energy: f64,
    /// Slope and length of the last step, for the first length to try.
    last: Option<[f64; 2]>,
    trial: Trial,
}

/// A point on the line that is searched.
struct Trial {
    x: Vec<f64>,
    gradient: Vec<f64>,
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `Σ a s b`.
fn scaled_dot(a: &[f64], scale: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(scale).zip(b).map(|((a, s), b)| a * s * b).sum()
}

impl State {
    fn new(x: &[f64], scale: &[f64], cost: &mut impl FnMut(&[f64], &mut [f64]) -> f64) -> Self {
        let mut gradient = vec![0.0; x.len()];
        let value = cost(x, &mut gradient);
        let direction: Vec<f64> = gradient.iter().zip(scale).map(|(g, s)| -s * g).collect();
        Self {
            search: Search { cost: value, iterations: 0, evaluations: 1, converged: false },
            energy: scaled_dot(&gradient, scale, &gradient),
            gradient,
            direction,
            last: None,
            trial: Trial { x: x.to_vec(), gradient: vec![0.0; x.len()] },
        }
    }

    /// One search along a line. False if there is nowhere lower to go.
    fn step(&mut self, x: &mut [f64], scale: &[f64], cost: &mut impl FnMut(&[f64], &mut [f64]) -> f64) -> bool {
        let moved = self.search_line(x, cost) || (self.restart(scale) && self.search_line(x, cost));
        if moved {
            self.turn(scale);
        }
        moved
    }

    /// Back to steepest descent. False if that is where the search already looked.
    fn restart(&mut self, scale: &[f64]) -> bool {
        self.last = None;
        let mut changed = false;
        for ((d, g), s) in self.direction.iter_mut().zip(&self.gradient).zip(scale) {
            changed |= *d != -s * g;
            *d = -s * g;
        }
        changed
    }

    /// The next direction: conjugate to the last one.
    fn turn(&mut self, scale: &[f64]) {
        // trial.gradient holds the old gradient by now.
        let energy = scaled_dot(&self.gradient, scale, &self.gradient);
        let overlap = scaled_dot(&self.gradient, scale, &self.trial.gradient);
        let beta = if self.energy > 0.0 { ((energy - overlap) / self.energy).max(0.0) } else { 0.0 };
        self.energy = energy;
        for ((d, g), s) in self.direction.iter_mut().zip(&self.gradient).zip(scale) {
            *d = beta * *d - s * g;
        }
        if dot(&self.direction, &self.gradient) >= 0.0 {
            self.restart(scale);
        }
    }

    /// Finds a step that meets the strong Wolfe conditions, or at least the first, and goes there.
    fn search_line(&mut self, x: &mut [f64], cost: &mut impl FnMut(&[f64], &mut [f64]) -> f64) -> bool {
        let start = Point { length: 0.0, cost: self.search.cost, slope: dot(&self.direction, &self.gradient) };
        if !(start.slope < 0.0 && start.cost.is_finite()) {
            return false;
        }
        let first = self.last.map_or(1.0, |[slope, length]| (slope * length / start.slope).min(10.0 * length));
        let mut bracket = Bracket::new(start, first);
        let mut best: Option<Point> = None;
        for _ in 0..MAX_TRIALS {
            let point = self.evaluate(x, bracket.next, cost);
            if point.cost < best.map_or(start.cost, |best| best.cost) {
                best = Some(point);
            }
            if bracket.accepts(&point) || !bracket.narrow(point) {
                break;
            }
        }
        best.is_some_and(|best| {
            // The last trial is nearly always the best.
            if best.length != bracket.last {
                self.evaluate(x, best.length, cost);
            }
            self.last = Some([start.slope, best.length]);
            self.search.cost = best.cost;
            x.copy_from_slice(&self.trial.x);
            std::mem::swap(&mut self.gradient, &mut self.trial.gradient);
            true
        })
    }

    fn evaluate(&mut self, x: &[f64], length: f64, cost: &mut impl FnMut(&[f64], &mut [f64]) -> f64) -> Point {
        let moved = x.iter().zip(&self.direction).map(|(x, d)| x + length * d);
        self.trial.x.iter_mut().zip(moved).for_each(|(to, from)| *to = from);
        self.search.evaluations += 1;
        let value = cost(&self.trial.x, &mut self.trial.gradient);
        let value = if value.is_finite() { value } else { f64::INFINITY };
        Point { length, cost: value, slope: dot(&self.direction, &self.trial.gradient) }
    }
}

/// The cost along a line.
#[derive(Clone, Copy, Debug)]
struct Point {
    length: f64,
    cost: f64,
    slope: f64,
}

/// The interval in which a good step must be: from the best end to the other one, once that is known.
#[derive(Debug)]
struct Bracket {
    start: Point,
    low: Point,
    high: Option<Point>,
    next: f64,
    last: f64,
}

impl Bracket {
    fn new(start: Point, first: f64) -> Self {
        Self { start, low: start, high: None, next: first, last: 0.0 }
    }

    fn descends(&self, point: &Point) -> bool {
        point.cost <= self.start.cost + DECREASE * point.length * self.start.slope
    }

    fn accepts(&mut self, point: &Point) -> bool {
        self.last = point.length;
        self.descends(point) && point.slope.abs() <= -CURVATURE * self.start.slope
    }

    /// Takes in a trial and chooses the next one. False if there is no room left.
    fn narrow(&mut self, point: Point) -> bool {
        if !self.descends(&point) || point.cost >= self.low.cost {
            self.high = Some(point);
        } else {
            let outwards = self.high.map_or(point.length - self.low.length, |high| high.length - self.low.length);
            if point.slope * outwards >= 0.0 {
                self.high = Some(self.low);
            }
            self.low = point;
        }
        self.next = match self.high {
            Some(high) => interpolated(&self.low, &high),
            None => 4.0 * self.low.length,
        };
        self.next != self.low.length && self.next.is_finite()
    }
}

/// The minimum of the parabola through the low end, its slope and the high end, kept away from both.
fn interpolated(low: &Point, high: &Point) -> f64 {
    /// The part of the interval next to its ends that is not tried.
    const MARGIN: f64 = 0.1;
    let width = high.length - low.length;
    let curvature = high.cost - low.cost - low.slope * width;
    let at = if curvature > 0.0 && curvature.is_finite() { -0.5 * low.slope * width / curvature } else { 0.5 };
    low.length + width * at.clamp(MARGIN, 1.0 - MARGIN)
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    use std::cell::RefCell;
    use std::rc::Rc;

    use argmin::core::{CostFunction, Executor, Gradient};
    use argmin::solver::conjugategradient::{NonlinearConjugateGradient, beta::PolakRibiere};
    use argmin::solver::linesearch::MoreThuenteLineSearch;

    use super::*;

    const LIMITS: Limits = Limits { iterations: 2000, tolerance: 1e-15 };

    fn rosenbrock(x: &[f64], gradient: &mut [f64]) -> f64 {
        gradient.fill(0.0);
        let mut sum = 0.0;
        for i in 0..x.len() - 1 {
            let (a, b) = (1.0 - x[i], x[i + 1] - x[i] * x[i]);
            sum += a * a + 100.0 * b * b;
            gradient[i] += -2.0 * a - 400.0 * b * x[i];
            gradient[i + 1] += 200.0 * b;
        }
        sum
    }

    /// Remembers the best point: argmin's solver may end with an error once it has converged, and keep the point to itself.
    #[derive(Clone)]
    struct Rosenbrock(Rc<RefCell<(f64, Vec<f64>)>>);

    impl CostFunction for Rosenbrock {
        type Param = Vec<f64>;
        type Output = f64;
        fn cost(&self, x: &Vec<f64>) -> Result<f64, argmin::core::Error> {
            let cost = rosenbrock(x, &mut vec![0.0; x.len()]);
            if cost < self.0.borrow().0 {
                *self.0.borrow_mut() = (cost, x.clone());
            }
            Ok(cost)
        }
    }

    impl Gradient for Rosenbrock {
        type Param = Vec<f64>;
        type Gradient = Vec<f64>;
        fn gradient(&self, x: &Vec<f64>) -> Result<Vec<f64>, argmin::core::Error> {
            let mut gradient = vec![0.0; x.len()];
            rosenbrock(x, &mut gradient);
            Ok(gradient)
        }
    }

    #[test]
    fn the_minimum_is_that_of_argmin() {
        let start = vec![-1.2, 1.0, -0.5, 0.8];
        let problem = Rosenbrock(Rc::new(RefCell::new((f64::INFINITY, Vec::new()))));
        let line_search = MoreThuenteLineSearch::new().with_c(1e-4, 0.1).unwrap();
        let solver = NonlinearConjugateGradient::new(line_search, PolakRibiere::new()).restart_iters(10);
        // It ends with an error or after all iterations, whatever it has found.
        let _ =
            Executor::new(problem.clone(), solver).configure(|state| state.param(start.clone()).max_iters(2000)).run();
        let theirs = problem.0.borrow().1.clone();
        let mut x = start;
        let search = minimise(&mut x, &[1.0; 4], rosenbrock, LIMITS);
        assert!(search.converged && search.cost < 1e-15, "{search:?}");
        for (a, b) in x.iter().zip(theirs) {
            assert!((a - b).abs() < 1e-6, "{a} {b}");
        }
        assert!(search.evaluations < 1000, "{search:?}");
    }

    #[test]
    fn a_quadratic_takes_as_many_steps_as_it_has_dimensions() {
        let curvatures: Vec<f64> = (1..=10).map(f64::from).collect();
        let quadratic = |x: &[f64], gradient: &mut [f64]| {
            let mut sum = 0.0;
            for ((g, x), c) in gradient.iter_mut().zip(x).zip(&curvatures) {
                *g = c * (x - 1.0);
                sum += 0.5 * c * (x - 1.0) * (x - 1.0);
            }
            sum
        };
        let mut x = vec![0.0; 10];
        let plain = minimise(&mut x, &[1.0; 10], quadratic, Limits { iterations: 15, tolerance: 0.0 });
        assert!(plain.cost < 1e-8, "{plain:?}");
        // The right scale makes it round: one step.
        let scale: Vec<f64> = curvatures.iter().map(|c| 1.0 / c).collect();
        let mut x = vec![0.0; 10];
        let scaled = minimise(&mut x, &scale, quadratic, Limits { iterations: 1, tolerance: 0.0 });
        assert!(scaled.cost < 1e-25, "{scaled:?}");
    }

    #[test]
    fn extremes_end_quietly() {
        let flat = |_: &[f64], gradient: &mut [f64]| {
            gradient.fill(0.0);
            3.0
        };
        assert_eq!(minimise(&mut [1.0], &[1.0], flat, LIMITS).iterations, 0);
        assert_eq!(minimise(&mut [], &[], flat, LIMITS).cost, 3.0);
        let undefined = |_: &[f64], gradient: &mut [f64]| {
            gradient.fill(f64::NAN);
            f64::NAN
        };
        assert_eq!(minimise(&mut [1.0], &[1.0], undefined, LIMITS).iterations, 0);
        // A wall beside the minimum: −log(x) + x is not finite for x ≤ 0, minimum 1 at 1.
        let wall = |x: &[f64], gradient: &mut [f64]| {
            gradient[0] = 1.0 - 1.0 / x[0];
            x[0] - x[0].ln()
        };
        let mut x = [0.001];
        let search = minimise(&mut x, &[1.0], wall, LIMITS);
        assert!((x[0] - 1.0).abs() < 1e-6 && search.converged, "{x:?} {search:?}");
    }
}
