//! Figure 2 of [SLS05]: sums of lobes for random vectors, and what more starts are worth.

use std::f64::consts::TAU;
use std::time::Instant;

use anyhow::{Context, Result};
use sh_core::Order;
use sh_fit::{FitOptions, FitReport, fit_lobes_many};

use crate::output::table;

/// RMS errors that the paper prints for one vector, and those of its lobe counts it leaves out.
const PAPER: [&str; 6] = ["0.751", "0.517", "–", "0.116", "–", "0.00908"];
const STARTS: [usize; 6] = [0, 4, 10, 30, 100, 300];
/// Vectors of the table of starts, and of the comparison with very many starts.
const FEW: usize = 50;
const VERY_MANY_STARTS: usize = 500;

pub(super) fn run(asked: Option<&str>) -> Result<()> {
    let count = asked.map_or(Ok(1000), str::parse).context("the number of vectors")?;
    let vectors = random_vectors(count);
    presets(&vectors)?;
    against_starts(&vectors[..FEW.min(count)])
}

/// The mean error and the time for each number of lobes.
fn presets(vectors: &[[f32; 36]]) -> Result<()> {
    let mut rows = Vec::new();
    for lobe_count in 1..=6 {
        let mut row = vec![lobe_count.to_string(), PAPER[lobe_count - 1].to_owned()];
        for preset in [FitOptions::fast(), FitOptions::default(), FitOptions::thorough()] {
            let fitted = fit(vectors, &FitOptions { lobe_count, ..preset })?;
            row.extend([format!("{:.3e}", mean(&fitted.errors)), format!("{:.0}", fitted.microseconds)]);
        }
        rows.push(row);
    }
    let head = ["N", "paper, one vector", "fast", "µs", "default", "µs", "thorough", "µs"];
    table("ldprt/fig2", &head, &rows)
}

/// The mean error against the number of starts, and how many thorough fits are within 1 % of very many starts.
fn against_starts(vectors: &[[f32; 36]]) -> Result<()> {
    let mut rows = Vec::new();
    for lobe_count in 1..=4 {
        let by = |starts, seed| fit(vectors, &FitOptions { lobe_count, starts, seed, ..FitOptions::thorough() });
        let mut row = vec![lobe_count.to_string()];
        for starts in STARTS {
            let fitted = by(starts, 0)?;
            row.push(format!("{:.4} ({:.0})", mean(&fitted.errors), fitted.microseconds));
        }
        let (thorough, best) = (by(FitOptions::thorough().starts, 0)?, by(VERY_MANY_STARTS, 1)?);
        let near = thorough.errors.iter().zip(&best.errors).filter(|(found, best)| **found <= 1.01 * **best).count();
        row.push(format!("{:.4}", mean(&thorough.errors) / mean(&best.errors)));
        row.push(format!("{near} of {}", vectors.len()));
        rows.push(row);
    }
    let starts: Vec<String> = STARTS.iter().map(|starts| format!("{starts} starts (µs)")).collect();
    let head = std::iter::once("N").chain(starts.iter().map(String::as_str));
    let head: Vec<&str> = head.chain(["thorough / 500 starts", "within 1 %"]).collect();
    table("ldprt/fig2-starts", &head, &rows)
}

struct Fitted {
    errors: Vec<f64>,
    /// On one thread, for each vector.
    microseconds: f64,
}

/// Fits on one thread; times of several would depend on the machine's other work.
fn fit(vectors: &[[f32; 36]], options: &FitOptions) -> Result<Fitted> {
    let order = Order::new(6)?;
    let options = FitOptions { threads: Some(1), ..options.clone() };
    let start = Instant::now();
    let (set, _) = fit_lobes_many(order, 1, vectors.as_flattened(), None, &options, &|_| ())?;
    let microseconds = start.elapsed().as_secs_f64() / vectors.len() as f64 * 1e6;
    let mut one = set.clone();
    let mut errors = Vec::new();
    for (point, vector) in vectors.iter().enumerate() {
        one.explicit = set.explicit_of(point, 0).to_vec();
        one.axes = set.axes_of(point).to_vec();
        one.coeffs = set.coeffs_of(point, 0).to_vec();
        errors.push(FitReport::measure(&one, vector).relative_error);
    }
    Ok(Fitted { errors, microseconds })
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// 36 independent normal numbers, at unit length: Box and Muller's transform of SplitMix64.
pub(crate) fn random_vectors(count: usize) -> Vec<[f32; 36]> {
    let mut state = 0_u64;
    let mut uniform = move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut normal = move || (-2.0 * (1.0 - uniform()).ln()).sqrt() * (TAU * uniform()).cos();
    let unit = |_| {
        let f: [f64; 36] = std::array::from_fn(|_| normal());
        let length = f.iter().map(|f| f * f).sum::<f64>().sqrt();
        f.map(|f| (f / length) as f32)
    };
    (0..count).map(unit).collect()
}
