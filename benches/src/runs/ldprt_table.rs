//! The light-specialised table of zonal lobes: error and time against its size.

use std::hint::black_box;
use std::time::Instant;

use anyhow::Result;
use prt_bake::Environment;
use prt_gpu::{Evaluation, LobeShape, LobeSurface, Lobes, cpu};
use sh_core::{Order, clamped_cosine, fibonacci, lobe_from_zonal};

use crate::output::{file, table};
use crate::plot::{Curve, log_log};

const ORDER: usize = 6;

const ENVIRONMENTS: [(&str, &str); 4] = [
    ("grace", "env/grace_256.hdr"),
    ("uffizi", "env/uffizi_256.hdr"),
    ("pisa", "env/pisa_256.hdr"),
    ("quarry", "env/quarry_01_1k.hdr"),
];

/// Widths; heights are half of them. The paper has 64.
const WIDTHS: [usize; 5] = [16, 32, 64, 128, 256];

/// Points that are shaded.
const POINTS: usize = 10_000;

pub(super) fn run(_asked: Option<&str>) -> Result<()> {
    let order = Order::new(ORDER)?;
    let mut lights = Vec::new();
    for (name, data_file) in ENVIRONMENTS {
        if let Some(path) = prt_tests::data_path("this run", data_file) {
            lights.push((name, Environment::load(&path)?.light(order)));
        }
    }
    let kinds = [("cosine", Points::cosine(order)), ("4 lobes", Points::four_lobes(order))];
    let mut rows: Vec<Vec<String>> = WIDTHS.iter().map(|w| vec![format!("{w} x {}", w / 2)]).collect();
    rows.push(vec!["direct".into()]);
    let mut curves = Vec::new();
    for (kind, points) in &kinds {
        for (name, light) in &lights {
            let truth = points.shade(light, order, Evaluation::Direct);
            let errors = WIDTHS.map(|width| relative_rms(&points.shade(light, order, sized(width)), &truth));
            rows.iter_mut().zip(&errors).for_each(|(row, error)| row.push(format!("{error:.1e}")));
            rows[WIDTHS.len()].push("exact".into());
            let points = WIDTHS.iter().zip(errors).map(|(width, error)| [*width as f64, error]).collect();
            curves.push(Curve { name: format!("{kind}, {name}"), points });
        }
    }
    let Some((_, light)) = lights.first() else { return Ok(()) };
    for (row, width) in rows.iter_mut().zip(WIDTHS) {
        let build = seconds(|| drop(cpu::build_table(black_box(light), order, 2, width, width / 2)));
        let shade = seconds(|| drop(kinds[1].1.shade(black_box(light), order, sized(width))));
        row.extend([format!("{:.0}", build * 1e6), format!("{:.0}", (shade - build) / POINTS as f64 * 1e9)]);
    }
    let direct = seconds(|| drop(kinds[1].1.shade(black_box(light), order, Evaluation::Direct)));
    rows[WIDTHS.len()].extend(["".into(), format!("{:.0}", direct / POINTS as f64 * 1e9)]);

    let names = kinds.iter().flat_map(|(kind, _)| lights.iter().map(move |(name, _)| format!("{kind}, {name}")));
    let head: Vec<String> =
        ["table".into()].into_iter().chain(names).chain(["build µs".into(), "shade ns/point".into()]).collect();
    let head: Vec<&str> = head.iter().map(String::as_str).collect();
    table("ldprt/table", &head, &rows)?;
    let title = "Relative RMS error of radiance from the table; n = 6";
    file("ldprt/table.svg", &log_log(title, ["texels around the equator", "error"], &curves))
}

fn sized(width: usize) -> Evaluation {
    Evaluation::Table { width, height: width / 2 }
}

/// Points with lobes.
struct Points {
    shape: LobeShape,
    explicit: Vec<f32>,
    axes: Vec<[f32; 3]>,
    coeffs: Vec<f32>,
}

impl Points {
    /// Unshadowed transfer: one lobe in every direction, DC explicit. What an irradiance map holds.
    fn cosine(order: Order) -> Self {
        let mut lobe = vec![0.0_f32; ORDER];
        clamped_cosine(&mut lobe);
        lobe_from_zonal(&mut lobe);
        let dc = lobe[0] * 0.282_094_8;
        lobe[0] = 0.0;
        Self {
            shape: LobeShape { order, rows: 1, channels: 1, lobe_count: 1, explicit_count: 1 },
            explicit: vec![dc; POINTS],
            axes: fibonacci(POINTS).into_iter().map(|d: [f64; 3]| d.map(|x| x as f32)).collect(),
            coeffs: lobe.repeat(POINTS),
        }
    }

    /// Four lobes in any direction with bands of equal size, DC and linear explicit and zero: the hardest case, all in high bands.
    fn four_lobes(order: Order) -> Self {
        let shape = LobeShape { order, rows: 1, channels: 1, lobe_count: 4, explicit_count: 4 };
        let directions = fibonacci(4 * POINTS);
        // A stride that is prime to the number of directions: the four of a point are far apart.
        let axis = |i: usize| directions[i * 15_013 % (4 * POINTS)].map(|x: f64| x as f32);
        let coeff = |i: usize| if i % ORDER < 2 { 0.0 } else { (0.7 * i as f32).sin() };
        Self {
            shape,
            explicit: vec![0.0; 4 * POINTS],
            axes: (0..4 * POINTS).map(axis).collect(),
            coeffs: (0..4 * POINTS * ORDER).map(coeff).collect(),
        }
    }

    fn shade(&self, light: &[f32], order: Order, evaluation: Evaluation) -> Vec<[f32; 3]> {
        let (positions, albedo) = (vec![[0.0; 3]; POINTS], vec![[1.0; 3]; POINTS]);
        let lobes = Lobes::new(self.shape, &self.explicit, &self.axes, &self.coeffs, None);
        let surface = lobes.and_then(|lobes| LobeSurface::new(&positions, &[], &albedo, lobes));
        let mut out = vec![[0.0; 3]; POINTS];
        if let Ok(surface) = surface {
            cpu::shade_lobes(&surface, &[], light, order, None, evaluation, &mut out);
        }
        out
    }
}

fn relative_rms(found: &[[f32; 3]], truth: &[[f32; 3]]) -> f64 {
    let square = |values: &mut dyn Iterator<Item = f32>| values.map(|value| f64::from(value).powi(2)).sum::<f64>();
    let difference = square(&mut found.as_flattened().iter().zip(truth.as_flattened()).map(|(a, b)| a - b));
    (difference / square(&mut truth.as_flattened().iter().copied())).sqrt()
}

/// The least of some runs, because other work only adds to it.
fn seconds(mut work: impl FnMut()) -> f64 {
    let mut once = || {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64()
    };
    (0..30).map(|_| once()).fold(f64::INFINITY, f64::min)
}
