//! Error of fits against their time: lobes, starts, and the methods.

use anyhow::Result;
use sh_fit::{FitOptions, FitReport, Method, fit_lobes_many};

use super::ldprt_fig3::{Transfer, transfer};
use crate::output::{file, table};
use crate::plot::{Curve, log_log};

const STARTS: [usize; 6] = [0, 2, 4, 8, 16, 32];
/// The paper's way is so slow that only some vertices are fitted by it; without neighbours, and so is what it is compared with.
const SOME: usize = 300;

pub(super) fn run(asked: Option<&str>) -> Result<()> {
    let transfer = transfer(asked, "meshes/max_planck_5k.obj")?;
    let mut rows = Vec::new();
    let mut curves = Vec::new();
    for lobe_count in 1..=6 {
        let mut points = Vec::new();
        for starts in STARTS {
            let report = fit(&transfer, &FitOptions { lobe_count, starts, ..FitOptions::default() })?;
            points.push([microseconds(&report), report.relative_error]);
            rows.push(row(lobe_count, &format!("{starts} starts"), &report));
        }
        curves.push(Curve { name: format!("N = {lobe_count}"), points });
        for (name, options) in settings() {
            rows.push(row(lobe_count, name, &fit(&transfer, &FitOptions { lobe_count, ..options })?));
        }
    }
    file(
        "ldprt/fit-trade.svg",
        &log_log(
            "fits of max_planck_5k, n = 6: 0 to 32 starts",
            ["µs per vertex, one thread", "relative error"],
            &curves,
        ),
    )?;
    let head = [
        "N",
        "setting",
        "relative error",
        "worst vertex",
        "µs per vertex",
        "iterations",
        "evaluations",
        "largest coefficient",
    ];
    table("ldprt/fit-trade", &head, &rows)?;
    methods(&transfer)
}

/// One setting of the default changed.
fn settings() -> Vec<(&'static str, FitOptions)> {
    let default = FitOptions::default;
    vec![
        ("fast", FitOptions::fast()),
        ("without neighbours", FitOptions { warm_start: false, ..default() }),
        ("tolerance 1e-2", FitOptions { tolerance: 1e-2, ..default() }),
        ("tolerance 1e-5", FitOptions { tolerance: 1e-5, ..default() }),
        ("5 iterations", FitOptions { max_iterations: 5, ..default() }),
        ("10 iterations", FitOptions { max_iterations: 10, ..default() }),
        ("regularisation 1e-3", FitOptions { regularisation: 1e-3, ..default() }),
        ("regularisation 1e-4", FitOptions { regularisation: 1e-4, ..default() }),
        ("regularisation 1e-7", FitOptions { regularisation: 1e-7, ..default() }),
    ]
}

/// Variable projection beside the methods of the paper, on some vertices.
fn methods(transfer: &Transfer) -> Result<()> {
    let count = transfer.order.coeff_count();
    let step = (transfer.points() / SOME).max(1);
    let values: Vec<f32> = transfer.values.chunks_exact(count).step_by(step).flatten().copied().collect();
    let some = Transfer { order: transfer.order, values, triangles: Vec::new() };
    let mut rows = Vec::new();
    for lobe_count in 1..=4 {
        for (name, method) in [
            ("variable projection", Method::VariableProjection),
            ("BFGS of everything", Method::QuasiNewton),
            ("conjugate gradients of everything", Method::ConjugateGradient),
        ] {
            let options = FitOptions { lobe_count, method, max_iterations: 1000, ..FitOptions::default() };
            rows.push(row(lobe_count, name, &fit(&some, &options)?));
        }
    }
    let head = [
        "N",
        "method",
        "relative error",
        "worst vertex",
        "µs per vertex",
        "iterations",
        "evaluations",
        "largest coefficient",
    ];
    table("ldprt/fit-methods", &head, &rows)
}

fn fit(transfer: &Transfer, options: &FitOptions) -> Result<FitReport> {
    let options = FitOptions { threads: Some(1), ..options.clone() };
    let neighbours = transfer.neighbours()?;
    Ok(fit_lobes_many(transfer.order, 1, &transfer.values, Some(&neighbours), &options, &|_| ())?.1)
}

fn microseconds(report: &FitReport) -> f64 {
    report.seconds / report.points as f64 * 1e6
}

fn row(lobe_count: usize, setting: &str, report: &FitReport) -> Vec<String> {
    let per_point = |count: u64| format!("{:.0}", count as f64 / report.points as f64);
    vec![
        lobe_count.to_string(),
        setting.to_owned(),
        format!("{:.5}", report.relative_error),
        format!("{:.4}", report.distribution.max),
        format!("{:.0}", microseconds(report)),
        per_point(report.iterations),
        per_point(report.evaluations),
        format!("{:.1}", report.largest_coefficient),
    ]
}
