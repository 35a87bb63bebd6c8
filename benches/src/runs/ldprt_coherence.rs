//! Lobes between vertices: the error at the centres of faces, against smoothness.

use std::time::Instant;

use anyhow::Result;
use prt_bake::{BakeOptions, bake_diffuse};
use sh_core::Order;
use sh_fit::{
    CoherentOptions, FitOptions, LobeSet, Neighbours, fit_lobes_many, interpolation_error, make_coherent, match_lobes,
};

use super::mesh;
use crate::output::table;

pub(super) fn run(asked: Option<&str>) -> Result<()> {
    let mesh = mesh(asked, "meshes/max_planck_5k.obj")?;
    let options = BakeOptions { order: Order::new(6)?, rays_per_vertex: 4096, ..BakeOptions::default() };
    let baked = bake_diffuse(&mesh, &options, &())?.0;
    let (targets, triangles) = (&baked.transfer.values, &baked.triangles);
    let neighbours = Neighbours::from_triangles(baked.positions.len(), triangles)?;
    let mut rows = Vec::new();
    for lobe_count in [1, 2, 3, 4] {
        let mut add = |name: &str, set: &LobeSet, start: Instant| -> Result<()> {
            let seconds = start.elapsed().as_secs_f64();
            let error = interpolation_error(set, targets, triangles)?;
            let numbers = [error.at_vertices, error.at_faces, error.worst_face].map(|error| format!("{error:.4}"));
            let head = [lobe_count.to_string(), name.to_owned()];
            rows.push(head.into_iter().chain(numbers).chain([format!("{seconds:.1}")]).collect());
            Ok(())
        };
        let fit = FitOptions { lobe_count, ..FitOptions::default() };
        let start = Instant::now();
        let (set, _) =
            fit_lobes_many(options.order, baked.transfer.channels, targets, Some(&neighbours), &fit, &|_| ())?;
        add("fitted", &set, start)?;
        let (start, mut matched) = (Instant::now(), set.clone());
        match_lobes(&mut matched, &neighbours)?;
        add("matched", &matched, start)?;
        for (smoothness, between) in [(1e-2, 0.0), (1e-3, 1.0), (1e-2, 1.0), (1e-1, 1.0), (1.0, 1.0)] {
            let (start, mut coherent) = (Instant::now(), set.clone());
            let options = CoherentOptions { smoothness, between, ..CoherentOptions::default() };
            make_coherent(&mut coherent, targets, &neighbours, &options)?;
            add(&format!("smoothness {smoothness}, between {between}"), &coherent, start)?;
        }
    }
    table("ldprt/coherence", &["N", "lobes", "at vertices", "at face centres", "worst face", "seconds"], &rows)
}
