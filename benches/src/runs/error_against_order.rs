//! How much of the light of real environments transfer of finite order misses.

use anyhow::Result;
use prt_bake::{BakeOptions, Environment, TransferVectors, bake_diffuse};
use prt_gpu::{Surface, cpu};
use sh_core::Order;

use super::mesh;
use crate::output::table;

/// Order that stands for all.
const FULL: usize = 20;

const ENVIRONMENTS: [&str; 3] = ["env/grace_256.hdr", "env/uffizi_256.hdr", "env/pisa_256.hdr"];

pub(super) fn run(asked: Option<&str>) -> Result<()> {
    let mesh = mesh(asked, "meshes/max_planck_5k.obj")?;
    let full = Order::new(FULL)?;
    let options = BakeOptions { order: full, rays_per_vertex: 8192, ..BakeOptions::default() };
    let baked = bake_diffuse(&mesh, &options, &())?.0;
    let TransferVectors { order, channels, values } = &baked.transfer;
    let surface = Surface::new(
        &baked.geometry.positions,
        &baked.geometry.triangles,
        &baked.geometry.albedo,
        *order,
        *channels,
        values,
    )?;
    let mut curves = Vec::new();
    for file in ENVIRONMENTS {
        let Some(path) = prt_tests::data_path("this curve", file) else { continue };
        let environment = Environment::load(&path)?;
        let shade = |order| {
            let mut radiance = vec![[0.0; 3]; baked.geometry.positions.len()];
            cpu::shade_vector(&surface, &environment.light(order), order, &mut radiance);
            radiance
        };
        let truth = shade(full);
        let orders = (1..=10).map(Order::new).collect::<Result<Vec<_>, _>>()?;
        curves.push(orders.into_iter().map(|order| relative_rms(&shade(order), &truth)).collect::<Vec<f64>>());
    }
    let rows: Vec<Vec<String>> = (0..10)
        .map(|i| {
            std::iter::once((i + 1).to_string()).chain(curves.iter().map(|curve| format!("{:.2e}", curve[i]))).collect()
        })
        .collect();
    let head: Vec<&str> = std::iter::once("order").chain(ENVIRONMENTS).take(1 + curves.len()).collect();
    table("prt/error-against-order", &head, &rows)
}

fn relative_rms(found: &[[f32; 3]], truth: &[[f32; 3]]) -> f64 {
    let square = |values: &mut dyn Iterator<Item = f32>| values.map(|value| f64::from(value).powi(2)).sum::<f64>();
    let difference = square(&mut found.as_flattened().iter().zip(truth.as_flattened()).map(|(a, b)| a - b));
    (difference / square(&mut truth.as_flattened().iter().copied())).sqrt()
}
