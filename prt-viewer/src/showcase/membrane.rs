//! The truth of thin membranes: both sides of the surface gather light, what hides it is opaque.

use glam::{DVec3, Vec3};
use prt_bake::{Mesh, MeshOptions, MeshSource, Scene, TransferVectors};
use sh_core::Order;

/// How far from the surface rays begin, as a part of the size of the model: far enough to leave the membrane itself.
const OFFSET: f64 = 1e-4;

/// Transfer `1/π ∫ V(s) g(n·s) y(s) ds` at each vertex, where `g(c)` is `c` in front and `−α c` behind the surface.
///
/// - `alphas`: transparency `[V]`
/// - `rays`: per vertex, over the whole sphere
///
/// # Errors
/// If the mesh cannot be traced.
///
/// Source: \[SLS05\] eq. 22.
pub(crate) fn trace(
    order: Order,
    source: &MeshSource,
    alphas: &[f32],
    rays: usize,
) -> Result<TransferVectors, prt_bake::Error> {
    let (mesh, _) = Mesh::new(source.clone(), &MeshOptions::default())?;
    let scene = Scene::new(&mesh);
    let [low, high] = mesh.bounds().map(DVec3::from_array);
    let offset = OFFSET * (high - low).length();
    let directions: Vec<Vec3> =
        sh_core::fibonacci(rays).into_iter().map(|direction| DVec3::from_array(direction).as_vec3()).collect();
    let basis: Vec<Vec<f64>> = directions.iter().map(|direction| basis(order, *direction)).collect();
    let mut transfer = TransferVectors::zero(source.positions.len(), 1, order);
    let rows = transfer.values.chunks_exact_mut(order.coeff_count());
    for (vertex, row) in rows.enumerate() {
        let normal = Vec3::from_array(source.normals[vertex]);
        let mut sum = vec![0.0; order.coeff_count()];
        for (side, response) in [(1.0, 1.0), (-1.0, f64::from(alphas[vertex]))] {
            let begin = DVec3::from_array(source.positions[vertex]) + offset * side * normal.as_dvec3();
            let towards: Vec<usize> =
                (0..rays).filter(|&i| f64::from(directions[i].dot(normal)) * side > 0.0).collect();
            let batch: Vec<Vec3> = towards.iter().map(|&i| directions[i]).collect();
            let mut occluded = vec![false; batch.len()];
            scene.occluded(begin.to_array(), &batch, &mut occluded);
            for (&i, _) in towards.iter().zip(&occluded).filter(|(_, occluded)| !**occluded) {
                let weight = response * f64::from(directions[i].dot(normal)).abs() * 4.0 / rays as f64;
                sum.iter_mut().zip(&basis[i]).for_each(|(sum, y)| *sum += weight * y);
            }
        }
        row.iter_mut().zip(&sum).for_each(|(value, sum)| *value = *sum as f32);
    }
    Ok(transfer)
}

fn basis(order: Order, direction: Vec3) -> Vec<f64> {
    let mut basis = vec![0.0; order.coeff_count()];
    sh_core::eval(order, direction.as_dvec3().to_array(), &mut basis);
    basis
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;

    #[test]
    fn a_free_membrane_is_its_closed_form() {
        let order = Order::new(6).unwrap();
        let source = MeshSource {
            positions: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            normals: vec![[0.0, 0.0, 1.0]; 3],
            triangles: vec![[0, 1, 2]],
            ..MeshSource::default()
        };
        let traced = trace(order, &source, &[0.5; 3], 20_000).unwrap();
        let lobes = sh_fit::membrane_lobes(order, &[0.5; 3], &source.normals).unwrap();
        let mut exact = vec![0.0; 36];
        lobes.reconstruct(0, 0, &mut exact);
        for (a, b) in traced.vector(0, 0).iter().zip(&exact) {
            assert!((a - b).abs() < 2e-4, "quadrature of 20,000 points: {a} {b}");
        }
    }
}
