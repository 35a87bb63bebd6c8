//! The error of shadowed transfer against the number of rays and the time they take.

use anyhow::Result;
use prt_bake::{BakeOptions, TransferVectors, bake_diffuse};
use sh_core::Order;

use super::mesh;
use crate::output::table;

/// The truth is a bake with this many rays and another seed: its own error is about a fifth of that of the last row.
const RAYS_OF_TRUTH: usize = 65_536;

pub(super) fn run(asked: Option<&str>) -> Result<()> {
    let mesh = mesh(asked, "meshes/max_planck_5k.obj")?;
    let options = |rays, seed| BakeOptions {
        order: Order::new(6).expect("valid"),
        rays_per_vertex: rays,
        seed,
        ..BakeOptions::default()
    };
    let truth = bake_diffuse(&mesh, &options(RAYS_OF_TRUTH, 99), &())?.0;
    let mut rows = Vec::new();
    for rays in [64, 256, 1024, 4096, 16384] {
        let (found, report) = bake_diffuse(&mesh, &options(rays, 1), &())?;
        let seconds = report.trace.as_secs_f64();
        rows.push(vec![
            rays.to_string(),
            format!("{:.2e}", distance(&found.transfer, &truth.transfer) / length(&truth.unshadowed())),
            format!("{:.2e}", report.error.unwrap_or(0.0)),
            format!("{seconds:.2}"),
            format!("{:.1}", report.rays_traced as f64 / seconds / 1e6),
        ]);
    }
    let head = ["rays per vertex", "relative error", "as the bake estimates it", "seconds", "million rays / s"];
    table("prt/error-against-rays", &head, &rows)
}

fn distance(a: &TransferVectors, b: &TransferVectors) -> f64 {
    a.values.iter().zip(&b.values).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>().sqrt()
}

fn length(a: &TransferVectors) -> f64 {
    a.values.iter().map(|&a| f64::from(a).powi(2)).sum::<f64>().sqrt()
}
