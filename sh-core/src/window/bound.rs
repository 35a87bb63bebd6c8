//! Value, slope and curvature of an expansion at a direction, and what they say of its neighbourhood.

use alloc::vec;
use alloc::vec::Vec;

use super::turning::turned;
use crate::{Basis, Order, Real, dot};

/// An expansion with what is needed to take two derivatives anywhere.
pub(super) struct Surface {
    order: Order,
    basis: Basis<f64>,
    y: Vec<f64>,
    /// The expansion, its derivatives by turning about x, y, z, and the second ones xx, yy, zz, xy, yz, zx.
    derivatives: [Vec<f64>; 10],
    /// No less than any value minus the mean.
    pub(super) swing: f64,
    /// No less than any third derivative along a great circle.
    third: f64,
}

/// What is known at a direction: the quadratic along two great circles at right angles, which have no mixed term.
#[derive(Clone, Copy, Debug)]
pub(super) struct Local {
    pub(super) direction: [f64; 3],
    pub(super) value: f64,
    tangents: [[f64; 3]; 2],
    slopes: [f64; 2],
    curvatures: [f64; 2],
}

impl Surface {
    /// - `coeffs`: `[n²]`, finite
    pub(super) fn new(order: Order, coeffs: Vec<f64>) -> Self {
        // sup |f_l| ≤ √((2l+1)/4π) |f_l|, and on a great circle f_l is a trigonometric polynomial of degree l, whose third
        // derivative is at most l³ times that: Bernstein's inequality, [Zyg02] chapter X.
        let sup = |l: usize| {
            let band = &coeffs[l * l..(l + 1) * (l + 1)];
            Real::sqrt((2 * l + 1) as f64 / (4.0 * core::f64::consts::PI) * dot(band, band))
        };
        let swing = (1..order.get()).map(sup).sum();
        let third = (1..order.get()).map(|l| (l * l * l) as f64 * sup(l)).sum();
        let [x, y, z] = turned(order, &coeffs);
        let [[xx, yx, zx], [xy, yy, zy], [xz, yz, zz]] = [&x, &y, &z].map(|first| turned(order, first));
        let mean = |a: Vec<f64>, b: Vec<f64>| a.iter().zip(&b).map(|(a, b)| 0.5 * (a + b)).collect();
        let derivatives = [coeffs, x, y, z, xx, yy, zz, mean(xy, yx), mean(yz, zy), mean(zx, xz)];
        Self { order, basis: Basis::new(order), y: vec![0.0; order.coeff_count()], derivatives, swing, third }
    }

    /// The value alone.
    pub(super) fn value(&mut self, direction: [f64; 3]) -> f64 {
        self.basis.eval(direction, &mut self.y);
        dot(&self.derivatives[0], &self.y)
    }

    /// - `direction`: unit length
    pub(super) fn at(&mut self, direction: [f64; 3]) -> Local {
        self.basis.eval(direction, &mut self.y);
        let [value, x, y, z, xx, yy, zz, xy, yz, zx] = self.derivatives.each_ref().map(|d| dot(d, &self.y));
        let tangents = tangents(direction);
        // Turning about direction × t moves the direction towards t.
        let axes = tangents.map(|t| cross(direction, t));
        let slopes = axes.map(|[a, b, c]| a * x + b * y + c * z);
        let second = |[a, b, c]: [f64; 3], [d, e, f]: [f64; 3]| {
            a * d * xx + b * e * yy + c * f * zz + (a * e + b * d) * xy + (b * f + c * e) * yz + (c * d + a * f) * zx
        };
        let hessian = [second(axes[0], axes[0]), second(axes[0], axes[1]), second(axes[1], axes[1])];
        Local { direction, value, tangents, slopes, curvatures: [0.0; 2] }.turned_to_axes(hessian)
    }

    /// No more than any value within the angle `radius` of a direction.
    ///
    /// Taylor's formula along great circles: the quadratic, bounded over a square that holds the disk, and the third
    /// derivative's bound.
    pub(super) fn lower_bound(&self, local: &Local, radius: f64) -> f64 {
        let along = |(slope, curvature): (f64, f64)| {
            let slope = slope.abs();
            if curvature * radius > slope {
                -0.5 * slope * slope / curvature
            } else {
                (0.5 * curvature * radius - slope) * radius
            }
        };
        let quadratic: f64 = local.slopes.into_iter().zip(local.curvatures).map(along).sum();
        local.value + quadratic - self.third * radius * radius * radius / 6.0
    }

    /// Goes down from a direction to a minimum, by Newton's method with steps that are only taken if they go down.
    pub(super) fn descend(&mut self, start: Local) -> Local {
        /// Newton's method doubles the digits, from a start within a fraction of a wave; a flat valley may take these.
        const STEPS: usize = 60;
        let longest = 0.5 / self.order.get() as f64;
        let mut here = start;
        for _ in 0..STEPS {
            let step = here.newton_step(longest);
            match self.first_below(&here, step) {
                Some(next) => here = next,
                None => break,
            }
        }
        here
    }

    /// The end of the step, or of the first of its halves, quarters, ... that is lower than where it began.
    fn first_below(&mut self, here: &Local, step: [f64; 2]) -> Option<Local> {
        /// The last is 1e-6 of the step.
        const HALVINGS: i32 = 20;
        let mut step = step;
        for _ in 0..HALVINGS {
            let there = here.moved(step);
            if there != here.direction && self.value(there) < here.value {
                return Some(self.at(there));
            }
            step = step.map(|s| 0.5 * s);
        }
        None
    }
}

impl Local {
    /// Turns the tangents so that the Hessian `[h₀₀, h₀₁, h₁₁]` becomes diagonal.
    fn turned_to_axes(mut self, [h00, h01, h11]: [f64; 3]) -> Self {
        let angle = 0.5 * Real::atan2(2.0 * h01, h00 - h11);
        let (s, c) = (Real::sin(angle), Real::cos(angle));
        let [t0, t1] = self.tangents;
        let [g0, g1] = self.slopes;
        self.tangents =
            [core::array::from_fn(|i| c * t0[i] + s * t1[i]), core::array::from_fn(|i| c * t1[i] - s * t0[i])];
        self.slopes = [c * g0 + s * g1, c * g1 - s * g0];
        let cross = 2.0 * c * s * h01;
        self.curvatures = [c * c * h00 + cross + s * s * h11, s * s * h00 - cross + c * c * h11];
        self
    }

    /// `−g/|h|` along each great circle, downhill whatever the sign of `h`, and no longer than `longest`.
    fn newton_step(&self, longest: f64) -> [f64; 2] {
        let along = |i: usize| {
            let (slope, curvature) = (self.slopes[i], self.curvatures[i].abs());
            if slope.abs() < longest * curvature { -slope / curvature } else { (-slope).signum() * longest }
        };
        [along(0), along(1)]
    }

    /// The direction after a step along the tangents.
    fn moved(&self, [a, b]: [f64; 2]) -> [f64; 3] {
        let [t, u] = self.tangents;
        let moved: [f64; 3] = core::array::from_fn(|i| self.direction[i] + a * t[i] + b * u[i]);
        normalized(moved)
    }
}

/// Two unit vectors at right angles to a unit vector and to one another.
fn tangents(s: [f64; 3]) -> [[f64; 3]; 2] {
    // The axis that is farthest from it.
    let smallest = (0..3).fold(0, |a, b| if s[b].abs() < s[a].abs() { b } else { a });
    let axis = core::array::from_fn(|i| if i == smallest { 1.0 } else { 0.0 });
    let first = normalized(cross(s, axis));
    [first, cross(s, first)]
}

pub(super) fn normalized(v: [f64; 3]) -> [f64; 3] {
    let length = Real::sqrt(v.iter().map(|v| v * v).sum::<f64>());
    v.map(|v| v / length)
}

fn cross([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    [b * z - c * y, c * x - a * z, a * y - b * x]
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    extern crate std;

    use super::*;
    use crate::fibonacci;

    /// No value within the angle is below the bound, and the bound is within the cubic term and the corners of the square.
    #[test]
    fn bounds_hold_and_are_near() {
        let mut tightest = f64::INFINITY;
        for n in 2..9 {
            let coeffs: Vec<f64> = (1..=n * n).map(|i| (1.3 * (i * i) as f64).sin()).collect();
            let mut surface = Surface::new(Order::new(n).unwrap(), coeffs);
            for (direction, radius) in fibonacci(40).into_iter().flat_map(|d| [0.3, 0.03, 0.003].map(|r| (d, r))) {
                let local = surface.at(direction);
                let bound = surface.lower_bound(&local, radius);
                for turn in (0..64).map(|i| f64::from(i) * core::f64::consts::TAU / 64.0) {
                    let step = [radius * turn.cos(), radius * turn.sin()];
                    // The chord of a step is a little shorter than its angle.
                    for part in [0.25, 0.5, 0.75, 1.0] {
                        let value = surface.value(local.moved(step.map(|s| part * s)));
                        assert!(value >= bound - 1e-13, "n = {n}, {direction:?}, {radius}: {value} {bound}");
                        tightest = tightest.min((value - bound) / (radius * radius));
                    }
                }
            }
        }
        // It is touched, but for the third power, somewhere among so many.
        assert!(tightest < 0.05, "{tightest}");
    }

    #[test]
    fn the_quadratic_is_the_function_nearby() {
        let coeffs: Vec<f64> = (1..=36).map(|i| (1.3 * f64::from(i * i)).sin()).collect();
        let mut surface = Surface::new(Order::new(6).unwrap(), coeffs);
        for direction in fibonacci(50) {
            let local = surface.at(direction);
            for [a, b] in [[1e-3, 0.0], [0.0, 1e-3], [-1e-3, 1e-3]] {
                let along = |i: usize, t: f64| (local.slopes[i] + 0.5 * local.curvatures[i] * t) * t;
                let value = surface.value(local.moved([a, b]));
                let expected = local.value + along(0, a) + along(1, b);
                // Third derivatives are up to 5³ times the swing, here about 15, and a chord is 3e-10 shorter than its angle.
                assert!((value - expected).abs() < 1e-6, "{direction:?}: {value} {expected}");
            }
        }
    }
}
