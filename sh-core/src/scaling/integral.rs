//! The integrals `∫ p_l(θ) p_l′(τ) η dθ` of all blocks, by Gauss-Legendre rules on intervals that are halved as needed.
//!
//! The curve `(θ, τ(θ))` is run through by a parameter `u` that resolves both ends of the map: for the cone, `θ` and `τ` are
//! `cot θ = v − cot α` and `cot τ = v/k − cot α` in one variable `v`, which is taken as `min(k, 1) sinh u`, so that fronts of
//! any steepness are wide in `u`.

use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::{FRAC_PI_2, PI};
use core::ops::Range;

use super::tau::{Preserve, Tau, mid_range, sphere_cosine};
use crate::sphere::gauss_legendre;
use crate::{Basis, Order, Real, index};

/// Largest difference, per band, between an interval's estimate and that of its halves. The halves are then right to far
/// less, as the rule's error falls by many digits from one to the other; a few roundings of the sum stay below it.
const TOLERANCE: f64 = 1e-15;

/// Halvings after which an interval is too small to matter, even if a jump is in it.
const DEPTH: usize = 50;

/// `ln v` at which the ends of the cone's curve are cut off: they are as small as `v⁻²`, that is 2e-18.
const TAIL: f64 = 20.0;

/// Width in `u` of the cone's intervals before any are halved: `sinh u` grows by about this many factors of e.
const STRIDE: f64 = 3.0;

/// Factor between neighbouring intervals on the way to a bend: a smaller one is more work, a larger one lets the rule step
/// over what is to be seen.
const GROWTH: f64 = 30.0;

/// A point of the curve.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    /// Sine and cosine of `θ`.
    pub(super) to: [f64; 2],
    /// Sine and cosine of `τ`.
    pub(super) from: [f64; 2],
    /// `η dθ/du`.
    pub(super) weight: f64,
}

/// The entries of the blocks `|m| = 0, 1, ...`: for each, the rows `l = m..n` over the columns `m..source`, and the range
/// of its entries in the whole.
pub(super) fn blocks(n: usize, source: usize) -> impl Iterator<Item = (usize, Range<usize>)> {
    let mut end = 0;
    (0..n.min(source)).map(move |m| {
        let start = end;
        end += (n - m) * (source - m);
        (m, start..end)
    })
}

/// How many entries all blocks have.
pub(super) fn entry_count(n: usize, source: usize) -> usize {
    blocks(n, source).last().map_or(0, |(_, range)| range.end)
}

/// The integrals of a known function.
pub(super) fn of_tau(n: Order, source: Order, tau: Tau, preserve: Preserve) -> Vec<f64> {
    match tau {
        Tau::Cone { k, alpha } => {
            let curve = |u| cone_node(k, alpha, preserve, u);
            Integral::new(n, source, curve).over(&cone_intervals(k, alpha, preserve))
        }
        Tau::MidRange { k } => {
            let curve = |theta| mid_range_node(k, preserve, theta);
            // The tangent plane at |k| = 1 is a bend half-way; inside, a curve as wide as the distance to the sphere's rim.
            let width = Real::sqrt((1.0 - k) * (1.0 + k)) / k.abs();
            let rising: Vec<f64> = towards_right_angle(width);
            let falling = rising.iter().rev().skip(1).map(|end| PI - end);
            let ends: Vec<f64> = rising.iter().copied().chain(falling).collect();
            Integral::new(n, source, curve).over(&ends)
        }
        Tau::Sphere { k } => {
            let curve = |u| sphere_node(k, preserve, u);
            let ratio = k.min(1.0 / k);
            let width = Real::sqrt((1.0 - ratio) * (1.0 + ratio)) / ratio;
            Integral::new(n, source, curve).over(&towards_right_angle(width))
        }
    }
}

/// The integrals of a function given by `τ` and `τ′`.
pub(super) fn of_function(n: Order, source: Order, tau: impl Fn(f64) -> [f64; 2], preserve: Preserve) -> Vec<f64> {
    /// Enough to notice a front that is a hundredth of a turn wide.
    const INTERVALS: usize = 16;
    let curve = |theta| {
        let [tau, slope] = tau(theta);
        let (to, from) = ([Real::sin(theta), Real::cos(theta)], [Real::sin(tau), Real::cos(tau)]);
        let weight = match preserve {
            Preserve::Value => to[0],
            Preserve::Energy => from[0] * slope,
        };
        Node { to, from, weight }
    };
    let ends: Vec<f64> = (0..=INTERVALS).map(|i| PI * i as f64 / INTERVALS as f64).collect();
    Integral::new(n, source, curve).over(&ends)
}

/// `v sin α = min(k, 1) sinh u`; `u` rises from `θ = π` to `θ = 0`.
fn cone_node(k: f64, alpha: f64, preserve: Preserve, u: f64) -> Node {
    let (sin_a, cos_a) = (Real::sin(alpha), Real::cos(alpha));
    let (up, down) = (Real::exp(u), Real::exp(-u));
    let inner = k.min(1.0);
    let (v, slope) = (inner * 0.5 * (up - down), inner * 0.5 * (up + down));
    // (sin α, v − cos α) and (k sin α, v − k cos α), each over its length
    let (to_length, from_length) = (Real::hypot(sin_a, v - cos_a), Real::hypot(k * sin_a, v - k * cos_a));
    let to = [sin_a / to_length, (v - cos_a) / to_length];
    let from = [k * sin_a / from_length, (v - k * cos_a) / from_length];
    let weight = match preserve {
        Preserve::Value => to[0] * to[0] * (slope / to_length),
        Preserve::Energy => from[0] * from[0] * (slope / from_length),
    };
    Node { to, from, weight }
}

/// Ends of intervals for [`cone_node`]: equally wide ones, and the places where either direction turns fastest.
fn cone_intervals(k: f64, alpha: f64, preserve: Preserve) -> Vec<f64> {
    let (inner, cos_a) = (k.min(1.0), Real::cos(alpha));
    let arsinh = |x: f64| Real::ln(x.abs() + Real::hypot(x, 1.0)).copysign(x);
    let range = match preserve {
        Preserve::Value => 1.0,
        Preserve::Energy => k,
    };
    let end = TAIL + Real::ln(range / inner) + core::f64::consts::LN_2;
    let count = (2.0 * end / STRIDE) as usize + 1;
    let mut ends: Vec<f64> = (0..=count).map(|i| end * (2.0 * i as f64 / count as f64 - 1.0)).collect();
    ends.extend([cos_a / inner, k * cos_a / inner].map(arsinh).into_iter().filter(|u| u.abs() < end));
    ends.sort_by(f64::total_cmp);
    ends
}

fn mid_range_node(k: f64, preserve: Preserve, theta: f64) -> Node {
    let to = [Real::sin(theta), Real::cos(theta)];
    let (from, slope) = mid_range(k, to);
    let weight = match preserve {
        Preserve::Value => to[0],
        Preserve::Energy => from[0] * slope,
    };
    Node { to, from, weight }
}

/// Ends of intervals from 0 to π/2 that grow by [`GROWTH`] from there, the shortest of them being `width`.
fn towards_right_angle(width: f64) -> Vec<f64> {
    // A bend narrower than a rounding is one at a point.
    let first = Some(width).filter(|&width| width > f64::EPSILON);
    let distances = core::iter::successors(first, |distance| Some(distance * GROWTH)).take_while(|&d| d < 1.0);
    let mut ends: Vec<f64> = distances.map(|distance| FRAC_PI_2 - distance).collect();
    ends.extend([0.0, FRAC_PI_2]);
    ends.sort_by(f64::total_cmp);
    ends
}

/// By the larger of both angles, which goes to a right angle: `θ` for `k ≤ 1`, `τ` otherwise.
fn sphere_node(k: f64, preserve: Preserve, u: f64) -> Node {
    let larger = [Real::sin(u), Real::cos(u)];
    let ratio = k.min(1.0 / k);
    let smaller = [ratio * larger[0], sphere_cosine(ratio, larger)];
    let (larger_area, smaller_area) = (larger[0], smaller[0] * ratio * larger[1] / smaller[1]);
    let (to, from, to_area, from_area) = if k <= 1.0 {
        (larger, smaller, larger_area, smaller_area)
    } else {
        (smaller, larger, smaller_area, larger_area)
    };
    let weight = match preserve {
        Preserve::Value => to_area,
        Preserve::Energy => from_area,
    };
    Node { to, from, weight }
}

/// The sum over nodes of all entries, interval by interval.
struct Integral<F> {
    n: usize,
    source: usize,
    curve: F,
    /// Nodes and weights on `−1..1`.
    rule: Vec<(f64, f64)>,
    to_basis: Basis<f64>,
    from_basis: Basis<f64>,
    /// The bases at a node: `[n²]` and `[source²]`.
    to_values: Vec<f64>,
    from_values: Vec<f64>,
}

impl<F: Fn(f64) -> Node> Integral<F> {
    fn new(n: Order, source: Order, curve: F) -> Self {
        // Exact for the product of both polynomials on half a circle, were the curve a line; halving does the rest.
        let count = 12 + (n.get() + source.get()) / 2;
        Self {
            n: n.get(),
            source: source.get(),
            curve,
            rule: gauss_legendre(count).collect(),
            to_basis: Basis::new(n),
            from_basis: Basis::new(source),
            to_values: vec![0.0; n.coeff_count()],
            from_values: vec![0.0; source.coeff_count()],
        }
    }

    /// The integral over the intervals between `ends`.
    fn over(mut self, ends: &[f64]) -> Vec<f64> {
        let mut total = vec![0.0; entry_count(self.n, self.source)];
        for pair in ends.windows(2) {
            let whole = self.estimate([pair[0], pair[1]]);
            self.add(&mut total, [pair[0], pair[1]], &whole, DEPTH);
        }
        total
    }

    /// Adds an interval whose estimate is `whole`.
    fn add(&mut self, total: &mut [f64], [a, b]: [f64; 2], whole: &[f64], depth: usize) {
        let middle = 0.5 * (a + b);
        let halves = [[a, middle], [middle, b]].map(|half| (half, self.estimate(half)));
        let [left, right] = [&halves[0].1, &halves[1].1];
        let difference = whole.iter().zip(left.iter().zip(right)).map(|(w, (l, r))| (w - (l + r)).abs());
        // NaN counts as no difference: it would be halved for ever.
        if depth > 0 && difference.fold(0.0, f64::max) > TOLERANCE * (self.n + self.source) as f64 {
            for (half, estimate) in &halves {
                self.add(total, *half, estimate, depth - 1);
            }
        } else {
            total.iter_mut().zip(left.iter().zip(right)).for_each(|(t, (l, r))| *t += l + r);
        }
    }

    /// The rule on one interval.
    fn estimate(&mut self, [a, b]: [f64; 2]) -> Vec<f64> {
        let mut sums = vec![0.0; entry_count(self.n, self.source)];
        let (centre, half) = (0.5 * (a + b), 0.5 * (b - a));
        for i in 0..self.rule.len() {
            let (x, w) = self.rule[i];
            let node = (self.curve)(centre + half * x);
            self.add_node(&mut sums, node, half * w * node.weight);
        }
        sums
    }

    /// Adds a node to all blocks: `y_lm` in the half-plane φ = 0 is `±p_l/√π`, for m = 0 `p_l/√(2π)`.
    fn add_node(&mut self, sums: &mut [f64], node: Node, weight: f64) {
        let at = |[s, c]: [f64; 2]| [s, 0.0, c];
        self.to_basis.eval(at(node.to), &mut self.to_values);
        self.from_basis.eval(at(node.from), &mut self.from_values);
        for (m, range) in blocks(self.n, self.source) {
            let around = weight * if m == 0 { 2.0 * PI } else { PI };
            for (l, row) in (m..self.n).zip(sums[range].chunks_exact_mut(self.source - m)) {
                let factor = around * self.to_values[index(l, m as isize)];
                for (l, sum) in (m..).zip(row) {
                    *sum += factor * self.from_values[index(l, m as isize)];
                }
            }
        }
    }
}
