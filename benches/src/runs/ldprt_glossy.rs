//! Glossy transfer: the error of the factored BRDF by its rows, and of lobes fitted to them.

use anyhow::Result;
use glam::Vec3;
use prt_bake::{Mesh, Scene};
use sh_core::{Basis, Order, fibonacci};
use sh_fit::{
    Brdf, BrdfFactors, CookTorrance, FactorOptions, FitOptions, Fresnel, Ggx, Phong, factor_brdf, fit_lobes_many,
    square_to_hemisphere,
};

use super::mesh;
use crate::output::table;

/// Of the paper's figure 4.
const ORDER: usize = 4;
const ROWS: usize = 3;

/// Rays of each transfer matrix.
const RAYS: usize = 4096;

/// Every so many-th vertex gets a transfer matrix.
const STRIDE: usize = 10;

pub(super) fn run(asked: Option<&str>) -> Result<()> {
    let mesh = mesh(asked, "meshes/max_planck_5k.obj")?;
    let order = Order::new(ORDER)?;
    let matrices = transfer_matrices(&mesh, order);
    let mut errors = Vec::new();
    let mut lobes = Vec::new();
    for (name, brdf) in brdfs()? {
        let factors = factor_brdf(&*brdf, order, order.coeff_count(), &FactorOptions::default())?;
        let rows = rows_of_transfer(&factors, &matrices);
        errors.push(error_row(&name, "all views", |rows| factors.error(rows)));
        errors.push(error_row(&name, "views within 60°", |count| seen_from_above(&factors, count)));
        errors.push(error_row(&name, "all views, on the mesh", |count| left_after(&rows, &factors, count)));
        lobes.push(lobe_row(&name, order, &rows)?);
    }
    table("ldprt/fig4-rows", &["BRDF", "error of the SVD", "n_b = 1", "2", "3", "4", "6", "9", "12"], &errors)?;
    table("ldprt/fig4-lobes", &["BRDF, n_b = 3", "N = 1", "2", "3", "4", "6"], &lobes)
}

fn brdfs() -> Result<Vec<(String, Box<dyn Brdf>)>> {
    let mut brdfs: Vec<(String, Box<dyn Brdf>)> = Vec::new();
    for roughness in [0.1, 0.3, 0.5, 1.0] {
        let plain = CookTorrance::new(roughness, Fresnel::One)?;
        let glass = CookTorrance::new(roughness, Fresnel::Dielectric { index: 1.5 })?;
        brdfs.push((format!("Cook-Torrance {roughness}, F = 1"), Box::new(plain)));
        brdfs.push((format!("Cook-Torrance {roughness}, glass"), Box::new(glass)));
    }
    brdfs.push(("GGX 0.3, F = 1".into(), Box::new(Ggx::new(0.3, Fresnel::One)?)));
    brdfs.push(("Phong 20".into(), Box::new(Phong::new(20.0)?)));
    Ok(brdfs)
}

/// `T_ij = ∫ V(s) y_i(s) y_j(s) ds` in the frame of each chosen vertex.
fn transfer_matrices(mesh: &Mesh, order: Order) -> Vec<Vec<f64>> {
    let scene = Scene::new(mesh);
    let [low, high] = mesh.bounds();
    let size = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
    let directions = fibonacci(RAYS);
    let basis = Basis::new(order);
    let mut values = vec![0.0; order.coeff_count()];
    let rows: Vec<Vec<f64>> = directions
        .iter()
        .map(|direction| {
            basis.eval(*direction, &mut values);
            values.clone()
        })
        .collect();
    let points = mesh.positions().iter().zip(mesh.normals()).step_by(STRIDE);
    points
        .map(|(position, normal)| {
            let normal = Vec3::from_array(*normal);
            let (tangent, bitangent) = normal.any_orthonormal_pair();
            // A little above the surface.
            let origin = std::array::from_fn(|k| position[k] + 1e-4 * size * f64::from(normal[k]));
            let local = directions.iter().map(|s| Vec3::from_array(s.map(|x| x as f32)));
            let world: Vec<Vec3> = local.map(|s| tangent * s.x + bitangent * s.y + normal * s.z).collect();
            let mut occluded = vec![false; world.len()];
            scene.occluded(origin, &world, &mut occluded);
            visible_products(&rows, &occluded)
        })
        .collect()
}

fn visible_products(rows: &[Vec<f64>], occluded: &[bool]) -> Vec<f64> {
    let count = rows[0].len();
    let weight = 4.0 * std::f64::consts::PI / rows.len() as f64;
    let mut matrix = vec![0.0; count * count];
    for row in rows.iter().zip(occluded).filter(|(_, occluded)| !**occluded).map(|(row, _)| row) {
        for (matrix, a) in matrix.chunks_exact_mut(count).zip(row) {
            matrix.iter_mut().zip(row).for_each(|(m, b)| *m += weight * a * b);
        }
    }
    matrix
}

/// `M′` of all points, `[P][R, n²]`.
fn rows_of_transfer(factors: &BrdfFactors, matrices: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let rows = |matrix: &Vec<f64>| {
        let mut rows = vec![0.0; factors.light.len()];
        factors.transfer_rows(matrix, &mut rows);
        rows
    };
    matrices.iter().map(rows).collect()
}

fn energy(values: &[f64]) -> f64 {
    values.iter().map(|x| x * x).sum()
}

/// What the rows beyond the first ones hold. The functions of the view are orthonormal over the map, so squares add up.
fn left_after(rows: &[Vec<f64>], factors: &BrdfFactors, count: usize) -> f64 {
    let kept = count * factors.order.coeff_count();
    let left: f64 = rows.iter().map(|rows| energy(&rows[kept..])).sum();
    (left / rows.iter().map(|rows| energy(rows)).sum::<f64>()).sqrt()
}

/// The error over the views that are less than 60° from the normal. The rows for the light are orthogonal, with the singular
/// values as lengths.
fn seen_from_above(factors: &BrdfFactors, count: usize) -> f64 {
    let (size, rows) = (factors.map_size, factors.row_count);
    let at = |k: usize| (k as f64 + 0.5) / size as f64;
    let above = |texel: &usize| square_to_hemisphere([at(texel % size), at(texel / size)])[2] > 0.5;
    let from = |first: usize| -> f64 {
        let terms = (0..size * size).filter(above).flat_map(|texel| (first..rows).map(move |r| (texel * rows + r, r)));
        terms.map(|(u, r)| (f64::from(factors.view_map[u]) * factors.singular_values[r]).powi(2)).sum()
    };
    (from(count) / from(0)).sqrt()
}

fn error_row(name: &str, of: &str, error: impl Fn(usize) -> f64) -> Vec<String> {
    let errors = [1, 2, 3, 4, 6, 9, 12].map(|rows| format!("{:.4}", error(rows)));
    [name.to_owned(), of.to_owned()].into_iter().chain(errors).collect()
}

/// Lobes of each row on its own, relative to the length of all that was to be approximated.
fn lobe_row(name: &str, order: Order, rows: &[Vec<f64>]) -> Result<Vec<String>> {
    let kept = ROWS * order.coeff_count();
    let targets: Vec<f32> = rows.iter().flat_map(|rows| &rows[..kept]).map(|&x| x as f32).collect();
    let all: f64 = rows.iter().map(|rows| energy(rows)).sum();
    let part = (rows.iter().map(|rows| energy(&rows[..kept])).sum::<f64>() / all).sqrt();
    let mut out = vec![name.to_owned()];
    for lobe_count in [1, 2, 3, 4, 6] {
        let options = FitOptions { lobe_count, ..FitOptions::default() };
        let (_, report) = fit_lobes_many(order, 1, &targets, None, &options, &|_| ())?;
        out.push(format!("{:.4}", part * report.relative_error));
    }
    Ok(out)
}
