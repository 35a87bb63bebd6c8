//! Random walks in a translucent patch: plane slabs beside the adding-doubling method, then error against paths on relief.

mod doubling;

use anyhow::{Context, Result};
use prt_bake::{HeightField, Medium, PatchOptions, PatchReport, PatchTransfer, bake_patch};
use sh_core::Order;

use crate::output::table;
use doubling::Slab;

/// Paths for each slab: one standard deviation of a share is at most 1/(2 √paths) = 5e-4.
const PATHS: usize = 1 << 20;

/// Paths per texel of the truth on relief.
const PATHS_OF_TRUTH: usize = 32_768;

pub(super) fn run(_asked: Option<&str>) -> Result<()> {
    slabs()?;
    relief()
}

fn slabs() -> Result<()> {
    let mut rows = Vec::new();
    for (depth, albedo, g, ior) in [
        (0.01, 0.9, 0.0, 1.0),
        (1.0, 1.0, 0.0, 1.0),
        (2.0, 0.9, 0.75, 1.0),
        (2.0, 0.9, -0.5, 1.0),
        (2.0, 0.9, 0.0, 1.5),
        (10.0, 0.99, 0.5, 1.3),
        (50.0, 1.0, 0.0, 1.0),
        (50.0, 0.999, 0.7, 1.5),
    ] {
        let [back, through] = Slab { depth, albedo, g, ior }.shares();
        let (found, seconds) = walk(depth, albedo, g, ior)?;
        rows.push(vec![
            format!("{depth}, {albedo}, {g}, {ior}"),
            format!("{back:.4}"),
            format!("{:.4}", found[0]),
            format!("{through:.4}"),
            format!("{:.4}", found[1]),
            format!("{:.1e}", (back - found[0]).abs().max((through - found[1]).abs())),
            format!("{seconds:.1}"),
        ]);
    }
    let head = [
        "τ, albedo, g, index",
        "reflected: doubling",
        "walk",
        "transmitted: doubling",
        "walk",
        "larger difference",
        "seconds",
    ];
    table("ldprt/scattering-slabs", &head, &rows)
}

/// Reflectance and transmittance for uniform light, and the time.
fn walk(depth: f64, albedo: f64, g: f64, ior: f64) -> Result<([f64; 2], f64)> {
    let grey = Medium::grey((depth * albedo) as f32, (depth * (1.0 - albedo)) as f32);
    let options = PatchOptions {
        order: Order::new(1).expect("valid"),
        rays_per_texel: PATHS / 64,
        scattering: Some(Medium { g: g as f32, ior: ior as f32, ..grey }),
        thickness: Some(1.0),
        ..PatchOptions::default()
    };
    let (_, report) = bake_patch(&HeightField::new(8, 8, vec![0.0; 64])?, &options, &())?;
    let shares = report.scattering.context("a translucent patch reports its light")?;
    Ok(([shares.from_above[0], shares.from_below[0]], report.trace.as_secs_f64()))
}

fn relief() -> Result<()> {
    let field = HeightField::bumps(32, 0.15)?;
    let bake = |paths, seed| -> Result<(PatchTransfer, PatchReport)> {
        let options = PatchOptions { rays_per_texel: paths, seed, ..PatchOptions::thin() };
        Ok(bake_patch(&field, &options, &())?)
    };
    let (truth, _) = bake(PATHS_OF_TRUTH, 99)?;
    let mut rows = Vec::new();
    for paths in [64, 256, 1024, 4096] {
        let (found, report) = bake(paths, 1)?;
        let seconds = report.trace.as_secs_f64();
        let shares = report.scattering.clone().unwrap_or_default();
        rows.push(vec![
            paths.to_string(),
            format!("{:.2e}", relative_error(&found, &truth)),
            format!("{:.2e}", report.error.unwrap_or(0.0)),
            format!("{:.1e}", shares.given_up[0]),
            format!("{seconds:.2}"),
            format!("{:.2}", report.rays_traced as f64 / seconds / 1e6),
        ]);
    }
    let head =
        ["paths per texel", "relative error", "as the bake estimates it", "given up", "seconds", "million paths / s"];
    table("ldprt/scattering-relief", &head, &rows)
}

/// Root-mean-square error relative to the unshadowed transfer.
fn relative_error(found: &PatchTransfer, truth: &PatchTransfer) -> f64 {
    let unshadowed = prt_bake::TransferVectors::unshadowed(truth.order, &truth.normals);
    let length = |values: &mut dyn Iterator<Item = f32>| values.map(|v| f64::from(v).powi(2)).sum::<f64>().sqrt();
    let mut difference = found.values.iter().zip(&truth.values).map(|(a, b)| a - b);
    length(&mut difference) / length(&mut unshadowed.values.iter().copied())
}
