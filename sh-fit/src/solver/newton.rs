//! Newton's method with damping.

use super::Landscape;
use super::cholesky::{decompose, solve_lower, solve_upper};
use crate::Stop;

/// Longest change of one coordinate in one step: half a radian, an angle over which low bands are nearly quadratic.
const LONGEST_STEP: f64 = 0.5;
/// Damping of the first step that needs one, relative to the largest entry of the Hessian.
const FIRST_DAMPING: f64 = 1e-2;
/// Factor by which damping rises and falls.
const DAMPING_FACTOR: f64 = 4.0;
/// Decrease of the value that is rounding, for values of about 1 at the start.
const ROUNDING: f64 = 1e-16;
/// Damping that makes steps of rounding: no way down is left.
const MOST_DAMPING: f64 = 1e12;

/// When to end.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits {
    pub(crate) iterations: usize,
    /// Expected decrease of the value, relative to it.
    pub(crate) tolerance: f64,
    /// Value that another start has reached.
    pub(crate) beat: f64,
    /// Gives up when the value would stay above `beat` if it fell by so many times the decrease that is expected next.
    pub(crate) reach: f64,
}

/// How it ended.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Outcome {
    pub(crate) stop: Stop,
    pub(crate) iterations: usize,
}

/// Room for one minimisation after the other.
#[derive(Debug, Default)]
pub(crate) struct Newton {
    gradient: Vec<f64>,
    hessian: Vec<f64>,
    factor: Vec<f64>,
    step: Vec<f64>,
}

impl Newton {
    /// Walks downhill from the current place.
    pub(crate) fn minimise(&mut self, landscape: &mut impl Landscape, limits: &Limits) -> Outcome {
        let d = landscape.dimension();
        if d == 0 {
            return Outcome { stop: Stop::Converged, iterations: 0 };
        }
        for (buffer, len) in
            [(&mut self.gradient, d), (&mut self.hessian, d * d), (&mut self.factor, d * d), (&mut self.step, d)]
        {
            buffer.resize(len, 0.0);
        }
        let mut damping = 0.0;
        for iterations in 0..limits.iterations {
            let value = landscape.value();
            landscape.derivatives(&mut self.gradient, &mut self.hessian);
            loop {
                let expected = self.find_step(d, &mut damping);
                let hopeless = limits.reach.is_finite() && value - limits.reach * expected > limits.beat;
                if hopeless || expected <= limits.tolerance * value + ROUNDING {
                    return Outcome { stop: Stop::Converged, iterations };
                }
                let found = landscape.try_step(&self.step);
                let ratio = (value - found) / expected;
                if ratio > 0.75 {
                    damping = if damping < 1e-3 * self.scale() { 0.0 } else { damping / DAMPING_FACTOR };
                } else if ratio < 0.25 {
                    damping = (DAMPING_FACTOR * damping).max(FIRST_DAMPING * self.scale());
                }
                if found < value {
                    landscape.accept();
                    break;
                }
                if damping > MOST_DAMPING * self.scale() {
                    return Outcome { stop: Stop::Converged, iterations };
                }
            }
        }
        Outcome { stop: Stop::Iterations, iterations: limits.iterations }
    }

    /// Largest diagonal entry of the Hessian.
    fn scale(&self) -> f64 {
        let d = self.gradient.len();
        (0..d).map(|i| self.hessian[i * d + i].abs()).fold(f64::MIN_POSITIVE, f64::max)
    }

    /// The step `−(H + λ)⁻¹ g`, with the least damping `λ` from `damping` on that makes the matrix positive, and the decrease of
    /// the value to be expected from it.
    fn find_step(&mut self, d: usize, damping: &mut f64) -> f64 {
        loop {
            self.factor.copy_from_slice(&self.hessian);
            (0..d).for_each(|i| self.factor[i * d + i] += *damping);
            if decompose(&mut self.factor, d).is_none() {
                break;
            }
            *damping = (DAMPING_FACTOR * *damping).max(FIRST_DAMPING * self.scale());
        }
        self.step.iter_mut().zip(&self.gradient).for_each(|(step, g)| *step = -g);
        solve_lower(&self.factor, d, &mut self.step);
        solve_upper(&self.factor, d, &mut self.step);
        let longest = self.step.iter().fold(0.0_f64, |max, s| max.max(s.abs()));
        if longest > LONGEST_STEP {
            self.step.iter_mut().for_each(|s| *s *= LONGEST_STEP / longest);
        }
        self.expected_decrease(d)
    }

    /// `−2 (g·p + ½ p·H p)`.
    fn expected_decrease(&self, d: usize) -> f64 {
        let rows = self.hessian.chunks_exact(d).zip(&self.step).zip(&self.gradient);
        rows.map(|((row, p), g)| {
            let curved: f64 = row.iter().zip(&self.step).map(|(h, q)| h * q).sum();
            -2.0 * p * (g + 0.5 * curved)
        })
        .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::{Smooth, conjugate_gradient, quasi_newton};

    /// Rosenbrock's valley `(1 − x)² + 100 (y − x²)²`, its minimum 0 at (1, 1), indefinite for `y > x² + 1/200`.
    struct Valley {
        here: [f64; 2],
        there: [f64; 2],
    }

    fn height([x, y]: [f64; 2]) -> f64 {
        (1.0 - x).powi(2) + 100.0 * (y - x * x).powi(2)
    }

    impl Landscape for Valley {
        fn dimension(&self) -> usize {
            2
        }
        fn value(&self) -> f64 {
            height(self.here)
        }
        fn derivatives(&mut self, gradient: &mut [f64], hessian: &mut [f64]) {
            let [x, y] = self.here;
            gradient.copy_from_slice(&[x - 1.0 - 200.0 * x * (y - x * x), 100.0 * (y - x * x)]);
            hessian.copy_from_slice(&[1.0 - 200.0 * (y - 3.0 * x * x), -200.0 * x, -200.0 * x, 100.0]);
        }
        fn try_step(&mut self, step: &[f64]) -> f64 {
            self.there = [self.here[0] + step[0], self.here[1] + step[1]];
            height(self.there)
        }
        fn accept(&mut self) {
            self.here = self.there;
        }
    }

    impl Smooth for Valley {
        fn value(&self, x: &[f64]) -> f64 {
            height([x[0], x[1]])
        }
        fn gradient(&self, x: &[f64], gradient: &mut [f64]) {
            let steep = x[1] - x[0] * x[0];
            gradient.copy_from_slice(&[2.0 * (x[0] - 1.0) - 400.0 * x[0] * steep, 200.0 * steep]);
        }
    }

    const LIMITS: Limits = Limits { iterations: 400, tolerance: 1e-9, beat: f64::INFINITY, reach: f64::INFINITY };

    #[test]
    fn the_valley_is_walked_to_its_end_by_every_method() {
        // The second start lies where the Hessian is indefinite.
        for start in [[-1.2, 1.0], [0.5, 3.0], [1.0, 1.0]] {
            let mut valley = Valley { here: start, there: start };
            let (bfgs, _, _) = quasi_newton(&valley, &start, &LIMITS);
            let (cg, _, _) = conjugate_gradient(&valley, &start, &LIMITS);
            let outcome = Newton::default().minimise(&mut valley, &LIMITS);
            assert_eq!(outcome.stop, Stop::Converged, "from {start:?}");
            assert!(outcome.iterations < 60, "{outcome:?} from {start:?}");
            // Newton's method ends with a step of rounding; the others when a step lowers the value by less than 1e-9 of its start.
            let nearness = [(valley.here, 1e-7), ([bfgs[0], bfgs[1]], 1e-4), ([cg[0], cg[1]], 1e-3)];
            for (found, near) in nearness {
                assert!(
                    (found[0] - 1.0).abs() < near && (found[1] - 1.0).abs() < 3.0 * near,
                    "{found:?} from {start:?}"
                );
            }
        }
    }

    #[test]
    fn limits_end_the_walk() {
        let mut valley = Valley { here: [-1.2, 1.0], there: [0.0; 2] };
        let few = Newton::default().minimise(&mut valley, &Limits { iterations: 3, ..LIMITS });
        assert_eq!((few.stop, few.iterations), (Stop::Iterations, 3));
        assert!(height(valley.here) < height([-1.2, 1.0]));
        let mut valley = Valley { here: [-1.2, 1.0], there: [0.0; 2] };
        let hopeless = Newton::default().minimise(&mut valley, &Limits { beat: -100.0, reach: 1.0, ..LIMITS });
        assert_eq!((hopeless.iterations, valley.here), (0, [-1.2, 1.0]));
    }
}
