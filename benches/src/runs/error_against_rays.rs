//! The error of shadowed transfer against rays and against time, for fixed counts of rays and for target errors.

use anyhow::Result;
use prt_bake::{BakeOptions, Mesh, TransferVectors, VertexStats, bake_vertices};
use sh_core::Order;

use super::mesh;
use crate::output::{file, table};
use crate::plot::{Curve, log_log};

const NAME: &str = "prt/error-against-rays";

const MESHES: [&str; 5] = ["stanford_bunny.obj", "nefertiti.obj", "max_planck_5k.obj", "dragon_100k.ply", "lilium.obj"];

/// The truth is a bake with this many rays and another seed: its own error is about a third of that of 16,384 rays.
const RAYS_OF_TRUTH: usize = 65_536;

/// Vertices that are baked, with all of the mesh around them.
const VERTICES: usize = 1000;

const FIXED: [usize; 5] = [64, 256, 1024, 4096, 16384];
const TARGETS: [f64; 6] = [0.02, 0.01, 0.005, 0.002, 0.001, 0.0005];

/// Finest set of a vertex with a target error.
const MOST_RAYS: usize = 65_536;

/// One bake.
struct Point {
    mesh: String,
    /// Rays, or the error that was asked for.
    asked: String,
    is_adaptive: bool,
    /// Traced one by one.
    rays_per_vertex: f64,
    error: f64,
    estimate: f64,
    worst: f64,
    unconverged: usize,
    open: usize,
    microseconds: f64,
}

pub(super) fn run(asked: Option<&str>) -> Result<()> {
    let names: Vec<&str> = asked.map_or(MESHES.to_vec(), |name| vec![name]);
    let mut points = Vec::new();
    for name in names {
        let mesh = mesh(asked, &format!("meshes/{name}"))?;
        let short = name.rsplit('/').next().unwrap_or(name).split('.').next().unwrap_or(name);
        points.extend(points_of(short, &mesh)?);
    }
    let rows: Vec<Vec<String>> = points.iter().map(row).collect();
    let head = [
        "mesh",
        "rays or error asked for",
        "rays traced / vertex",
        "relative error, RMS",
        "as estimated",
        "worst vertex",
        "above the error asked for",
        "open",
        "µs / vertex, one thread",
    ];
    table(NAME, &head, &rows)?;
    goals(&points)?;
    plot(&points, "rays", "rays traced per vertex", |point| point.rays_per_vertex)?;
    plot(&points, "seconds", "microseconds per vertex, one thread", |point| point.microseconds)
}

/// What was asked of the baker, beside what it does.
fn goals(points: &[Point]) -> Result<()> {
    let mut rows = Vec::new();
    for point in points.iter().filter(|point| point.asked == "4096") {
        rows.push(vec![
            format!("{}: 4,096 rays", point.mesh),
            "error 2e-3 (bunny)".to_owned(),
            format!("{:.2e}", point.error),
        ]);
    }
    for point in points.iter().filter(|point| point.asked == "error 0.002") {
        let gain = |rays: fn(&Point) -> f64| {
            let fixed = fixed_rays(points, point, rays);
            fixed.map_or(String::new(), |fixed| format!("{:.1}", fixed / point.rays_per_vertex))
        };
        let goal = "2 (bunny)".to_owned();
        rows.push(vec![format!("{}: error 0.002, times fewer rays than a fixed count", point.mesh), goal, gain(asked)]);
        let traced = format!("{}: times fewer than a fixed count traces one by one, with bins", point.mesh);
        rows.push(vec![traced, String::new(), gain(|fixed| fixed.rays_per_vertex)]);
    }
    table(&format!("{NAME}-goals"), &["what", "goal", "found"], &rows)
}

/// The count that was asked for.
fn asked(fixed: &Point) -> f64 {
    fixed.asked.parse().unwrap_or(f64::NAN)
}

/// The rays of the fixed count that has the error of `point`: on a power law through the two counts around it.
fn fixed_rays(points: &[Point], point: &Point, rays: fn(&Point) -> f64) -> Option<f64> {
    let fixed: Vec<&Point> = points.iter().filter(|other| other.mesh == point.mesh && !other.is_adaptive).collect();
    let pair = fixed.windows(2).find(|pair| pair[1].error <= point.error && point.error <= pair[0].error)?;
    let share = (point.error / pair[0].error).ln() / (pair[1].error / pair[0].error).ln();
    let [first, second] = [rays(pair[0]), rays(pair[1])];
    Some(first * (second / first).powf(share))
}

fn row(point: &Point) -> Vec<String> {
    vec![
        point.mesh.clone(),
        point.asked.clone(),
        format!("{:.0}", point.rays_per_vertex),
        format!("{:.2e}", point.error),
        if point.is_adaptive { format!("{:.2e}", point.estimate) } else { String::new() },
        format!("{:.1e}", point.worst),
        point.unconverged.to_string(),
        point.open.to_string(),
        format!("{:.0}", point.microseconds),
    ]
}

/// All fixed counts and all target errors on one mesh.
fn points_of(name: &str, mesh: &Mesh) -> Result<Vec<Point>> {
    let all = mesh.positions().len();
    let count = VERTICES.min(all);
    let vertices: Vec<usize> = (0..count).map(|number| number * all / count).collect();
    let options = |rays_per_vertex, target_error, seed| BakeOptions {
        order: Order::new(5).expect("5 is an order"),
        rays_per_vertex,
        target_error,
        seed,
        threads: Some(1),
        ..BakeOptions::default()
    };
    let truth = bake_vertices(mesh, &BakeOptions { threads: None, ..options(RAYS_OF_TRUTH, None, 99) }, &vertices)?;
    let lengths: Vec<f64> = (0..count).map(|row| length(truth_unshadowed(mesh, &vertices, row))).collect();
    let mut points = Vec::new();
    for (rays, target) in
        FIXED.map(|rays| (rays, None)).into_iter().chain(TARGETS.map(|error| (MOST_RAYS, Some(error))))
    {
        let found = bake_vertices(mesh, &options(rays, target, 1), &vertices)?;
        let distance = |row| {
            let [a, b] = [&found, &truth].map(|sample| sample.transfer.vector(row, 0));
            length(a.iter().zip(b).map(|(a, b)| a - b)) / lengths[row]
        };
        let errors: Vec<f64> = (0..count).map(distance).collect();
        let mean = |of: &dyn Fn(&VertexStats) -> f64| found.stats.iter().map(of).sum::<f64>() / count as f64;
        points.push(Point {
            mesh: name.to_owned(),
            asked: target.map_or(rays.to_string(), |error| format!("error {error}")),
            is_adaptive: target.is_some(),
            rays_per_vertex: mean(&|stats| f64::from(stats.rays)),
            error: (errors.iter().map(|error| error * error).sum::<f64>() / count as f64).sqrt(),
            estimate: mean(&|stats| f64::from(stats.error).powi(2)).sqrt(),
            worst: errors.iter().copied().fold(0.0, f64::max),
            unconverged: found.stats.iter().filter(|stats| target.is_some_and(|e| f64::from(stats.error) > e)).count(),
            open: found.stats.iter().filter(|stats| stats.occluded == 0).count(),
            microseconds: found.trace.as_secs_f64() / count as f64 * 1e6,
        });
    }
    Ok(points)
}

fn truth_unshadowed(mesh: &Mesh, vertices: &[usize], row: usize) -> impl Iterator<Item = f32> {
    let normal = mesh.normals()[vertices[row]];
    TransferVectors::unshadowed(Order::new(5).expect("5 is an order"), &[normal]).values.into_iter()
}

fn length(values: impl Iterator<Item = f32>) -> f64 {
    values.map(|value| f64::from(value).powi(2)).sum::<f64>().sqrt()
}

/// One curve for each mesh and way.
fn plot(points: &[Point], suffix: &str, label: &str, x: impl Fn(&Point) -> f64) -> Result<()> {
    let mut curves: Vec<Curve> = Vec::new();
    for point in points {
        let name = format!(
            "{}{}",
            point.mesh.split('_').next().unwrap_or(&point.mesh),
            if point.is_adaptive { ", error" } else { "" }
        );
        if curves.last().is_none_or(|curve| curve.name != name) {
            curves.push(Curve { name, points: Vec::new() });
        }
        let at = [x(point), point.error];
        curves.last_mut().into_iter().for_each(|curve| curve.points.push(at));
    }
    let title = "Shadowed transfer, n = 5: fixed counts of rays, and target errors";
    file(&format!("{NAME}-{suffix}.svg"), &log_log(title, [label, "relative RMS error"], &curves))
}
