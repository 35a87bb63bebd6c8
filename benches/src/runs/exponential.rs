//! Error of the exponential of expansions against its time.

use std::f64::consts::PI;
use std::hint::black_box;
use std::time::Instant;

use anyhow::Result;
use sh_core::{
    ExpOptions, ExpStart, Order, Quadrature, dot, eval, exp, expand_zonal, fibonacci, log, project_function,
    reconstruct,
};

use crate::output::table;

/// Blockers per set, and sets of each.
const COUNTS: [usize; 5] = [1, 2, 4, 8, 16];
const SETS: usize = 8;

/// The least visibility whose logarithm is taken.
const FLOOR: f64 = 0.02;

/// Directions for the true visibility.
const DIRECTIONS: usize = 5000;

/// Closer to the limit of many halvings than any method of the table.
const LIMIT: ExpOptions = ExpOptions { start: ExpStart::ProductSeries(8), longest: 0.25 };

/// The sum of the logarithms of some blockers, and what its exponential can be compared with.
struct Example {
    logarithm: Vec<f64>,
    /// The limit, the projection of the exponential of the values, and that of the true visibility.
    truths: [Vec<f64>; 3],
}

pub(super) fn run(_asked: Option<&str>) -> Result<()> {
    let mut rows = Vec::new();
    for n in [3, 4, 5, 6] {
        let order = Order::new(n)?;
        let examples = examples(order);
        for (name, options) in methods() {
            let errors = [0, 1, 2].map(|truth| mean_error(order, &options, &examples, truth));
            let mut row = vec![n.to_string(), name, format!("{:.0}", nanoseconds(order, &options, &examples))];
            row.extend(errors.iter().map(|error| format!("{error:.1e}")));
            rows.push(row);
        }
    }
    table(
        "sh/exponential",
        &["order", "method", "ns", "from the limit", "from e^f(s)", "from the true visibility"],
        &rows,
    )
}

/// Both ways to begin, from no halving to many.
fn methods() -> Vec<(String, ExpOptions)> {
    let starts = [
        ("linear", ExpStart::OptimalLinear),
        ("series 2", ExpStart::ProductSeries(2)),
        ("series 3", ExpStart::ProductSeries(3)),
        ("series 4", ExpStart::ProductSeries(4)),
        ("series 8", ExpStart::ProductSeries(8)),
    ];
    let lengths = [f64::INFINITY, 2.0, 1.0, 0.5, 0.25];
    let all = starts.into_iter().flat_map(|start| lengths.map(|longest| (start, longest)));
    all.map(|((name, start), longest)| (format!("{name} to {longest}"), ExpOptions { start, longest })).collect()
}

fn examples(order: Order) -> Vec<Example> {
    let directions = fibonacci(997);
    let sets = COUNTS.into_iter().flat_map(|count| (0..SETS).map(move |set| (count, set)));
    sets.map(|(count, set)| {
        // Axes from all over a lattice; half angles of 8 to 38 degrees.
        let blocker = |k: usize| {
            let at = 131 * set + 389 * k + 17 * count;
            (directions[at % 997], (8.0 + (at * 7 % 31) as f64).to_radians())
        };
        example(order, &(0..count).map(blocker).collect::<Vec<_>>())
    })
    .collect()
}

fn example(order: Order, blockers: &[([f64; 3], f64)]) -> Example {
    let mut logarithm = vec![0.0; order.coeff_count()];
    let mut one = logarithm.clone();
    for &(axis, half_angle) in blockers {
        log(order, &cap(order, axis, half_angle), FLOOR, &mut one);
        logarithm.iter_mut().zip(&one).for_each(|(sum, f)| *sum += f);
    }
    let (mut limit, mut by_values) = (one.clone(), one);
    exp(order, &LIMIT, &logarithm, &mut limit);
    let value = |s| reconstruct(order, &logarithm, s).exp();
    project_function(order, &Quadrature::new(60), value, &mut by_values);
    Example { logarithm, truths: [limit, by_values, visibility(order, blockers)] }
}

/// 0 within the half angle about the axis, 1 elsewhere.
fn cap(order: Order, axis: [f64; 3], half_angle: f64) -> Vec<f64> {
    let z = half_angle.cos();
    let (mut below, mut current, mut zonal) = (1.0, z, vec![(4.0 * PI).sqrt() - PI.sqrt() * (1.0 - z)]);
    for l in 1..order.get() {
        let above = ((2 * l + 1) as f64 * z * current - l as f64 * below) / (l + 1) as f64;
        zonal.push(-(PI / (2 * l + 1) as f64).sqrt() * (below - above));
        (below, current) = (current, above);
    }
    let mut out = vec![0.0; order.coeff_count()];
    expand_zonal(order, &zonal, axis, &mut out);
    out
}

fn visibility(order: Order, blockers: &[([f64; 3], f64)]) -> Vec<f64> {
    let (mut y, mut sum) = (vec![0.0; order.coeff_count()], vec![0.0; order.coeff_count()]);
    for s in fibonacci(DIRECTIONS) {
        if blockers.iter().all(|(axis, half_angle)| dot(axis, &s) < half_angle.cos()) {
            eval(order, s, &mut y);
            sum.iter_mut().zip(&y).for_each(|(sum, y)| *sum += y * 4.0 * PI / DIRECTIONS as f64);
        }
    }
    sum
}

/// The mean over the examples of the error relative to the length.
fn mean_error(order: Order, options: &ExpOptions, examples: &[Example], truth: usize) -> f64 {
    let mut found = vec![0.0; order.coeff_count()];
    let mut error = |example: &Example| {
        exp(order, options, &example.logarithm, &mut found);
        let truth = &example.truths[truth];
        let square: f64 = found.iter().zip(truth).map(|(f, t)| (f - t).powi(2)).sum();
        (square / dot(truth, truth)).sqrt()
    };
    examples.iter().map(&mut error).sum::<f64>() / examples.len() as f64
}

/// The least of some mean times over the examples, in `f32`.
fn nanoseconds(order: Order, options: &ExpOptions, examples: &[Example]) -> f64 {
    let inputs: Vec<Vec<f32>> =
        examples.iter().map(|example| example.logarithm.iter().map(|&f| f as f32).collect()).collect();
    let mut out = vec![0.0; order.coeff_count()];
    let mut once = || {
        let start = Instant::now();
        for f in inputs.iter().cycle().take(20 * inputs.len()) {
            exp(order, options, black_box(f), black_box(&mut out));
        }
        start.elapsed().as_secs_f64() * 1e9 / (20 * inputs.len()) as f64
    };
    (0..15).map(|_| once()).fold(f64::MAX, f64::min)
}
