//! Figure 3 of [SLS05]: sums of lobes for diffuse transfer of real meshes.

use anyhow::Result;
use prt_bake::{BakeOptions, bake_diffuse};
use sh_core::Order;
use sh_fit::{FitOptions, LobeSet, Neighbours, fit_lobes_many, optimal_linear_lobe};

use super::mesh;
use crate::output::table;

/// Relative errors that the paper prints: the optimal linear lobe, and N = 1, 2, 3, 4.
const PAPER: [&str; 5] = ["0.292", "0.264", "0.123", "0.045", "0.016"];
const MESHES: [&str; 4] = ["stanford_bunny", "armadillo", "nefertiti", "max_planck_5k"];

pub(super) fn run(asked: Option<&str>) -> Result<()> {
    let mut rows = vec![paper()];
    match asked {
        Some(path) => rows.push(errors(path, &transfer(Some(path), "")?)?),
        None => {
            for name in MESHES {
                rows.push(errors(name, &transfer(None, &format!("meshes/{name}.obj"))?)?);
            }
        }
    }
    let head = [
        "mesh",
        "vertices",
        "optimal linear",
        "N = 1",
        "N = 2",
        "N = 3",
        "N = 4",
        "at face centres",
        "largest coefficient",
        "seconds, N = 4",
    ];
    table("ldprt/fig3", &head, &rows)
}

fn paper() -> Vec<String> {
    let mut row = vec!["[SLS05]".to_owned(), "–".to_owned()];
    row.extend(PAPER.map(str::to_owned));
    row.extend(["–", "–", "< 1800 (17,575 vertices)"].map(str::to_owned));
    row
}

/// Transfer of a mesh.
pub(super) struct Transfer {
    pub(super) order: Order,
    pub(super) values: Vec<f32>,
    pub(super) triangles: Vec<[u32; 3]>,
}

impl Transfer {
    pub(super) fn points(&self) -> usize {
        self.values.len() / self.order.coeff_count()
    }

    pub(super) fn neighbours(&self) -> Result<Neighbours> {
        Ok(Neighbours::from_triangles(self.points(), &self.triangles)?)
    }
}

/// Bakes a mesh: order 6, 4,096 rays.
pub(super) fn transfer(asked: Option<&str>, data_file: &str) -> Result<Transfer> {
    let baked = bake_diffuse(&mesh(asked, data_file)?, &BakeOptions::default(), &())?.0;
    let order = baked.transfer.order;
    Ok(Transfer { order, values: baked.transfer.values, triangles: baked.geometry.triangles })
}

fn errors(name: &str, transfer: &Transfer) -> Result<Vec<String>> {
    let neighbours = transfer.neighbours()?;
    let mut row = vec![name.to_owned(), transfer.points().to_string(), format!("{:.4}", optimal_linear(transfer))];
    for lobe_count in 1..=4 {
        let options = FitOptions { lobe_count, ..FitOptions::default() };
        let (set, report) = fit_lobes_many(transfer.order, 1, &transfer.values, Some(&neighbours), &options, &|_| ())?;
        row.push(format!("{:.4}", report.relative_error));
        if lobe_count == 4 {
            row.push(format!("{:.3}", interpolated(transfer, &set)));
            row.push(format!("{:.1}", report.largest_coefficient));
            row.push(format!("{:.2}", report.seconds));
        }
    }
    Ok(row)
}

/// The relative error of one lobe about the axis of the linear band, band 0 included, as the paper measures it.
fn optimal_linear(transfer: &Transfer) -> f64 {
    let count = transfer.order.coeff_count();
    let (mut error, mut signal) = (0.0, 0.0);
    let mut expanded = vec![0.0; count];
    for target in transfer.values.chunks_exact(count) {
        let target: Vec<f64> = target.iter().map(|&t| f64::from(t)).collect();
        let lobe = optimal_linear_lobe(transfer.order, &target);
        sh_core::expand_lobe(transfer.order, &lobe.coeffs, lobe.axis, &mut expanded);
        error += target.iter().zip(&expanded).map(|(t, e)| (t - e) * (t - e)).sum::<f64>();
        signal += target.iter().map(|t| t * t).sum::<f64>();
    }
    (error / signal).sqrt()
}

/// The relative error at face centres when axes and coefficients are interpolated lobe by lobe, against interpolated transfer.
/// Lobes of independent fits do not correspond between neighbours, so this is large: shading interpolates radiance instead.
fn interpolated(transfer: &Transfer, set: &LobeSet) -> f64 {
    let (order, count) = (transfer.order, transfer.order.coeff_count());
    let mut centre = LobeSet::zeros(order, 1, set.lobe_count, set.explicit_count, 1);
    let mut found = vec![0.0; count];
    let (mut error, mut signal) = (0.0, 0.0);
    for corners in &transfer.triangles {
        let corners = corners.map(|corner| corner as usize);
        let mean = |of: &dyn Fn(usize) -> f32| corners.iter().map(|&corner| of(corner)).sum::<f32>() / 3.0;
        for (j, axis) in centre.axes.iter_mut().enumerate() {
            let sum = [0, 1, 2].map(|a| mean(&|corner| set.axes_of(corner)[j][a]));
            let length = sum.iter().map(|x| x * x).sum::<f32>().sqrt();
            *axis = if length > 0.0 { sum.map(|x| x / length) } else { [0.0, 0.0, 1.0] };
        }
        for (i, g) in centre.coeffs.iter_mut().enumerate() {
            *g = mean(&|corner| set.coeffs_of(corner, 0)[i]);
        }
        for (i, explicit) in centre.explicit.iter_mut().enumerate() {
            *explicit = mean(&|corner| set.explicit_of(corner, 0)[i]);
        }
        centre.reconstruct(0, 0, &mut found);
        for (i, found) in found.iter().enumerate() {
            let target = mean(&|corner| transfer.values[corner * count + i]);
            error += f64::from(target - found).powi(2);
            signal += f64::from(target).powi(2);
        }
    }
    (error / signal).sqrt()
}
