//! The wrinkle model: how well a map of three lobes fits a simulated groove.

use std::time::Instant;

use anyhow::Result;
use sh_fit::{
    FitOptions, Grid, GridOptions, Groove, LobeSet, Neighbours, WrinkleModel, WrinkleOptions, fit_grid, fit_lobes_many,
    groove_transfer, match_lobes, relative_error,
};

use crate::output::table;

pub(super) fn run(_asked: Option<&str>) -> Result<()> {
    let mut rows = Vec::new();
    for max_depth in [0.25, 0.5, 1.0, 2.0] {
        for max_iterations in [0, 100, 500, 2000] {
            rows.push(joint(max_depth, max_iterations)?);
        }
        rows.extend(apart(max_depth)?);
    }
    table("ldprt/wrinkle", &["depth up to", "fit", "at fitted samples", "between samples", "seconds"], &rows)
}

fn options(max_depth: f64, max_iterations: usize) -> WrinkleOptions {
    let fit = GridOptions { max_iterations, tolerance: 0.0, ..GridOptions::default() };
    WrinkleOptions { max_depth, fit, ..WrinkleOptions::default() }
}

/// The paper's way: all nodes at once.
fn joint(max_depth: f64, max_iterations: usize) -> Result<Vec<String>> {
    let start = Instant::now();
    let report = WrinkleModel::fit(&options(max_depth, max_iterations))?.report;
    let name = if max_iterations == 0 { "start".into() } else { format!("joint, {max_iterations} iterations") };
    Ok(row(max_depth, &name, report.fit.relative_error, report.between_error, start))
}

/// Each node for itself, and what comes of it between nodes, as they are and with matched lobes.
fn apart(max_depth: f64) -> Result<Vec<Vec<String>>> {
    let options = options(max_depth, 0);
    let start = Instant::now();
    let grid = Grid::new(options.sizes, [true, false])?;
    let [width, height] = options.sizes;
    let row_of = |row: usize, count: usize| {
        let depth = max_depth * row as f64 / (height - 1) as f64;
        groove_transfer(options.order, &Groove::new(depth)?, options.albedo, count)
    };
    // Points of 256: nodes at the odd multiples of 4, samples in the middle between them.
    let (mut nodes, mut places, mut samples) = (Vec::new(), Vec::new(), Vec::new());
    for row in 0..height {
        let transfer: Vec<f32> = row_of(row, 8 * width)?.into_iter().map(|t| t as f32).collect();
        let points = transfer.chunks_exact(options.order.coeff_count()).enumerate();
        for (k, transfer) in points.filter(|(k, _)| k % 4 == 0) {
            if k % 8 == 4 {
                nodes.extend_from_slice(transfer);
            } else {
                places.push([k as f64 / (8 * width) as f64, row as f64 / (height - 1) as f64]);
                samples.extend_from_slice(transfer);
            }
        }
    }
    let fit = FitOptions { lobe_count: 3, ..FitOptions::default() };
    let (mut set, _) = fit_lobes_many(options.order, 1, &nodes, None, &fit, &|_| ())?;
    let measure = |set: &LobeSet| -> Result<f64> {
        let keep = GridOptions { max_iterations: 0, ..GridOptions::default() };
        Ok(fit_grid(set, &grid, &places, &samples, &keep)?.1.relative_error)
    };
    let apart = row(max_depth, "each node alone", relative_error(&set, &nodes), measure(&set)?, start);
    match_lobes(&mut set, &Neighbours::grid(width, height, false))?;
    Ok(vec![apart, row(max_depth, "the same, matched", relative_error(&set, &nodes), measure(&set)?, start)])
}

fn row(max_depth: f64, name: &str, at: f64, between: f64, start: Instant) -> Vec<String> {
    let seconds = start.elapsed().as_secs_f64();
    vec![max_depth.to_string(), name.into(), format!("{at:.4}"), format!("{between:.4}"), format!("{seconds:.1}")]
}
