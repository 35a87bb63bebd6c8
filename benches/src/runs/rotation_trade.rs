//! Exact and approximate rotation: error against time.

use std::hint::black_box;
use std::time::Instant;

use anyhow::Result;
use sh_core::{Order, Taylor, TaylorDegree, Zxzxz, Zyz, rotate};

use crate::output::{file, table};
use crate::plot::{Curve, log_log};

/// Of the paper's table 1 and figure 3, and beyond: there, tables are all that is exact.
const ORDERS: [usize; 11] = [3, 4, 5, 6, 7, 8, 9, 10, 16, 32, 64];

/// Degrees of arc at which the error is told.
const ANGLES: [f64; 4] = [1.0, 5.0, 10.0, 25.0];

/// The angle of the plot.
const PLOTTED: usize = 2;

/// The largest order with straight-line kernels.
const LAST_UNROLLED: usize = 10;

/// What `f32` leaves of an exact rotation, for the plot's axis.
const EXACT_ERROR: f64 = 1e-6;

const DEGREES: [(&str, TaylorDegree); 3] =
    [("Taylor 1", TaylorDegree::One), ("Taylor 1.5", TaylorDegree::OneAndHalf), ("Taylor 2", TaylorDegree::Two)];

/// A way to rotate, measured.
struct Measured {
    name: &'static str,
    seconds: f64,
    /// Worst error of a unit vector at [`ANGLES`]; 0 for an exact way.
    errors: [f64; 4],
}

pub(super) fn run(_asked: Option<&str>) -> Result<()> {
    let mut rows = Vec::new();
    let mut curves = Vec::new();
    for n in ORDERS {
        let ways = measure(Order::new(n)?);
        // The fastest exact way.
        let exact = ways.iter().filter(|way| way.errors[0] == 0.0).map(|way| way.seconds).fold(f64::INFINITY, f64::min);
        rows.extend(ways.iter().map(|way| row(n, way, exact)));
        if n <= LAST_UNROLLED {
            curves.push(curve(n, &ways));
        }
    }
    table("kkp/trade", &["n", "way", "ns", "exact / this", "1°", "5°", "10°", "25°"], &rows)?;
    let title = "Worst error of a unit vector at β = 10° against time; n = 3 to 10";
    file("kkp/trade.svg", &log_log(title, ["nanoseconds per rotation (f32, angles included)", "error"], &curves))
}

fn row(n: usize, way: &Measured, exact: f64) -> Vec<String> {
    let head =
        [n.to_string(), way.name.into(), format!("{:.1}", way.seconds * 1e9), format!("{:.2}", exact / way.seconds)];
    let error = |&error: &f64| if error == 0.0 { "exact".into() } else { format!("{error:.1e}") };
    head.into_iter().chain(way.errors.iter().map(error)).collect()
}

fn curve(n: usize, ways: &[Measured]) -> Curve {
    let point = |way: &Measured| [way.seconds * 1e9, way.errors[PLOTTED].max(EXACT_ERROR)];
    let mut points: Vec<[f64; 2]> = ways.iter().filter(|way| way.name != "tables").map(point).collect();
    points.sort_by(|a, b| b[1].total_cmp(&a[1]));
    Curve { name: format!("n = {n}"), points }
}

fn measure(order: Order) -> Vec<Measured> {
    let coeffs: Vec<f32> = (0..order.coeff_count()).map(|i| (1.0 + i as f32).sin()).collect();
    let mut out = vec![0.0_f32; coeffs.len()];
    let exact = |name, seconds| Measured { name, seconds, errors: [0.0; 4] };
    let mut ways = Vec::new();
    let without_tables = seconds(|matrix| rotate(order, matrix, black_box(&coeffs), black_box(&mut out)));
    ways.push(exact(if order.get() <= LAST_UNROLLED { "unrolled" } else { "no tables" }, without_tables));
    let tables = Zxzxz::new(order);
    let tabled = |matrix| tables.rotate(&Zyz::from_matrix(matrix), black_box(&coeffs), black_box(&mut out));
    ways.push(exact("tables", seconds(tabled)));
    for (name, degree) in DEGREES {
        let taylor = Taylor::new(order, degree);
        let approximate = |matrix| taylor.rotate(&Zyz::from_matrix(matrix), black_box(&coeffs), black_box(&mut out));
        let errors = ANGLES.map(|angle| worst_error(order, degree, angle.to_radians()));
        ways.push(Measured { name, seconds: seconds(approximate), errors });
    }
    ways
}

/// Time of one rotation: the least of many, because other work only adds to it.
fn seconds(mut rotate: impl FnMut([[f32; 3]; 3])) -> f64 {
    let matrices: Vec<[[f32; 3]; 3]> =
        (0..64).map(|i| i as f32).map(|i| Zyz::from_angles([1.1 * i, 0.01 + 0.004 * i, -0.7 * i]).matrix()).collect();
    let mut once = || {
        let start = Instant::now();
        matrices.iter().for_each(|matrix| rotate(*black_box(matrix)));
        start.elapsed().as_secs_f64() / matrices.len() as f64
    };
    let first = once();
    // About 20 ms.
    let times = (0.02 / (first * 64.0)).clamp(20.0, 20_000.0) as usize;
    (0..times).map(|_| once()).fold(first, f64::min)
}

/// The largest error of a unit vector: the largest singular value of the difference of the matrices, which is in the last
/// band, by power iteration.
fn worst_error(order: Order, degree: TaylorDegree, beta: f64) -> f64 {
    let (taylor, zyz) = (Taylor::new(order, degree), Zyz::from_angles([0.0, beta, 0.0]));
    let last = order.bands().last().map_or(0..1, |(_, band)| band);
    let tables = Zxzxz::new(order);
    let (mut unit, mut exact, mut rough) = (vec![0.0; last.end], vec![0.0; last.end], vec![0.0; last.end]);
    let columns: Vec<Vec<f64>> = last
        .clone()
        .map(|i| {
            unit.fill(0.0);
            unit[i] = 1.0;
            tables.rotate(&zyz, &unit, &mut exact);
            taylor.rotate_y(beta, &unit, &mut rough);
            last.clone().map(|i| exact[i] - rough[i]).collect()
        })
        .collect();
    largest_singular_value(&columns)
}

fn largest_singular_value(columns: &[Vec<f64>]) -> f64 {
    let size = columns.len();
    let mut vector: Vec<f64> = (0..size).map(|i| (1.0 + i as f64).sin()).collect();
    let mut value = 0.0;
    for _ in 0..500 {
        let mut image = vec![0.0; size];
        for (column, v) in columns.iter().zip(&vector) {
            image.iter_mut().zip(column).for_each(|(image, c)| *image += c * v);
        }
        let back = columns.iter().map(|column| column.iter().zip(&image).map(|(a, b)| a * b).sum::<f64>());
        let back: Vec<f64> = back.collect();
        let length = back.iter().map(|b| b * b).sum::<f64>().sqrt();
        if length == 0.0 {
            return 0.0;
        }
        value = length.sqrt();
        vector = back.into_iter().map(|b| b / length).collect();
    }
    value
}
