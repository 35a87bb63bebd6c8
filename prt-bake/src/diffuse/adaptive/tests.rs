#![expect(clippy::unwrap_used, reason = "tests")]

use proptest::prelude::*;
use sh_core::Order;

use crate::diffuse::{HitRecord, Ladder, ray_origins};
use crate::{
    BakeOptions, BakeReport, BakedSurface, Mesh, MeshOptions, MeshSource, Scene, TransferVectors, bake_diffuse,
};

use super::super::DirectPass;

/// Adds a square of `cells²` cells with a corner and two sides; the normal is that of the sides.
fn add_square(source: &mut MeshSource, corner: [f64; 3], [u, v]: [[f64; 3]; 2], cells: u32) {
    let [u, v, corner] = [u, v, corner].map(glam::DVec3::from_array);
    let normal = u.cross(v).normalize().as_vec3().to_array();
    let first = u32::try_from(source.positions.len()).unwrap();
    for i in 0..=cells {
        for j in 0..=cells {
            let [a, b] = [i, j].map(|k| f64::from(k) / f64::from(cells));
            source.positions.push((corner + a * u + b * v).to_array());
            source.normals.push(normal);
            if i < cells && j < cells {
                let k = first + i * (cells + 1) + j;
                source.triangles.extend([[k, k + cells + 1, k + cells + 2], [k, k + cells + 2, k + 1]]);
            }
        }
    }
}

fn mesh(source: MeshSource) -> Mesh {
    Mesh::new(source, &MeshOptions::default()).unwrap().0
}

/// A floor, a smaller plate above it that faces down, and a thin post beside.
fn plates() -> Mesh {
    let mut source = MeshSource::default();
    add_square(&mut source, [-1.0, -1.0, 0.0], [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0]], 12);
    add_square(&mut source, [-0.4, -0.5, 0.6], [[0.0, 1.1, 0.0], [0.9, 0.0, 0.0]], 4);
    add_square(&mut source, [0.7, 0.7, 0.0], [[0.0, 0.06, 0.0], [0.0, 0.0, 1.0]], 1);
    mesh(source)
}

/// A cube seen from within; each face has its middle at number 4 of its 9 vertices.
fn closed_box() -> Mesh {
    let mut source = MeshSource::default();
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    for [u, v] in [[x, y], [y, z], [z, x]] {
        add_square(&mut source, [0.0; 3], [u, v], 2);
        let [a, b] = [u, v].map(glam::DVec3::from_array);
        add_square(&mut source, a.cross(b).to_array(), [v, u], 2);
    }
    mesh(source)
}

fn options(order: usize, rays_per_vertex: usize, target_error: f64) -> BakeOptions {
    let order = Order::new(order).unwrap();
    BakeOptions { order, rays_per_vertex, target_error: Some(target_error), ..BakeOptions::default() }
}

fn bake(mesh: &Mesh, options: &BakeOptions) -> (BakedSurface, BakeReport) {
    bake_diffuse(mesh, options, &()).unwrap()
}

/// Relative error of each vertex.
fn errors(found: &TransferVectors, truth: &TransferVectors, unshadowed: &TransferVectors) -> Vec<f64> {
    let square = |row: &mut dyn Iterator<Item = f32>| row.map(|value| f64::from(value).powi(2)).sum::<f64>();
    let error = |vertex| {
        let [a, b, u] = [found, truth, unshadowed].map(|transfer| transfer.vector(vertex, 0));
        (square(&mut a.iter().zip(b).map(|(a, b)| a - b)) / square(&mut u.iter().copied())).sqrt()
    };
    (0..found.vertex_count()).map(error).collect()
}

fn rms(errors: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = errors.len() as f64;
    (errors.map(|error| error * error).sum::<f64>() / count).sqrt()
}

#[test]
fn the_error_asked_for_is_reached_and_estimated_with_fewer_rays() {
    let mesh = plates();
    let truth =
        bake(&mesh, &BakeOptions { rays_per_vertex: 1 << 17, seed: 77, target_error: None, ..options(5, 1, 0.1) }).0;
    let mut before = 0;
    for error in [0.02, 0.005, 0.00125] {
        // With 32,768 directions at most, 0 to 7 vertices do not reach the smallest error, by the seed (ten were tried, with two orders of the
        // directions).
        let (found, report) = bake(&mesh, &options(5, 1 << 16, error));
        let errors = errors(&found.transfer, &truth.transfer, &found.unshadowed());
        let (reached, estimated) = (rms(errors.into_iter()), report.error.unwrap());
        // Measured 0.71 to 0.98 of the error asked for; on real meshes 0.5 to 1. What bounds it is the post: seen edge on it slips between
        // the coarsest directions. With other seeds the smallest error is reached 0.86 to 1.41 times.
        assert!(reached < error, "{error}: {reached}");
        assert!(estimated < error && estimated > 0.5 * reached && estimated < 2.0 * reached, "{reached} {estimated}");
        assert_eq!(report.savings.unconverged_vertices, 0);
        // A smaller error takes more rays, and less than half of its directions.
        assert!(report.savings.rays > before && error > 0.01 || 2 * report.savings.rays < report.savings.directions);
        before = report.savings.rays;
    }
}

#[test]
fn the_same_bytes_for_any_number_of_threads_and_again_for_each_vertex() {
    let mesh = plates();
    let options = BakeOptions { bounces: 1, ..options(4, 4096, 0.01) };
    let reference = bake(&mesh, &BakeOptions { threads: Some(1), ..options.clone() });
    for threads in [Some(2), Some(3)] {
        let again = bake(&mesh, &BakeOptions { threads, ..options.clone() });
        assert_eq!(again.0, reference.0);
        assert_eq!(again.1.savings, reference.1.savings);
    }
    // In reverse order, with memory that other vertices have used.
    let (scene, ladder) = (Scene::new(&mesh), Ladder::new(&options));
    let origins = ray_origins(&mesh, &scene);
    let pass = DirectPass { mesh: &mesh, scene: &scene, ladder: &ladder, normals: mesh.normals(), origins: &origins };
    let mut scratch = pass.scratch();
    let direct = bake(&mesh, &BakeOptions { bounces: 0, ..options.clone() }).0.transfer;
    let mut row = vec![0.0; 16];
    for vertex in (0..mesh.positions().len()).rev() {
        pass.shadowed_vector(&mut scratch, vertex, &mut row);
        assert_eq!(row, direct.vector(vertex, 0), "vertex {vertex}");
    }
}

#[test]
fn an_open_vertex_is_exact_and_costs_the_coarsest_set() {
    let mut source = MeshSource::default();
    add_square(&mut source, [0.0; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], 3);
    let mesh = mesh(source);
    for n in [1, 6, 32] {
        let (baked, report) = bake(&mesh, &options(n, 16384, 0.01));
        assert_eq!(baked.transfer, baked.unshadowed(), "order {n}");
        assert_eq!((report.error, report.savings.open_vertices), (Some(0.0), 16));
        assert!(report.vertices.iter().all(|stats| (60..=68).contains(&stats.rays) && stats.error == 0.0));
        assert_eq!((report.savings.levels[0].directions, report.savings.levels[0].vertices), (64, 16));
        assert_eq!(report.savings.fixed_directions, 16 * 16384);
    }
}

#[test]
fn a_blocked_vertex_is_black_exactly() {
    let mesh = closed_box();
    for target_error in [Some(0.01), None] {
        let (baked, report) = bake(&mesh, &BakeOptions { target_error, ..options(5, 2048, 0.01) });
        for middle in (4..54).step_by(9) {
            assert!(baked.transfer.vector(middle, 0).iter().all(|&value| value == 0.0), "vertex {middle}");
            let stats = &report.vertices[middle];
            assert_eq!(stats.occluded, stats.directions);
            assert!(target_error.is_none() || stats.error == 0.0);
        }
        assert!(report.savings.blocked_vertices >= 6);
    }
}

#[test]
fn the_weights_of_hits_add_up_to_the_share_that_is_occluded() {
    for mesh in [plates(), closed_box()] {
        let options = options(3, 4096, 0.01);
        let (scene, ladder) = (Scene::new(&mesh), Ladder::new(&options));
        let origins = ray_origins(&mesh, &scene);
        let pass =
            DirectPass { mesh: &mesh, scene: &scene, ladder: &ladder, normals: mesh.normals(), origins: &origins };
        let (mut scratch, mut row) = (pass.scratch(), vec![0.0; 9]);
        for vertex in 0..mesh.positions().len() {
            pass.shadowed_vector(&mut scratch, vertex, &mut row);
            let mut hits: Vec<HitRecord> = Vec::new();
            pass.nearest_hits(&mut scratch, vertex, &mut hits);
            let sum: f64 = hits.iter().map(|hit| f64::from(hit.weights()[0]) / 0.8).sum();
            // The albedo of a mesh without material is 0.8. y_00 = 1/√(4π): coefficient 0 is the open share over √(4π). Sets differ by the error.
            let open = f64::from(row[0]) * (4.0 * std::f64::consts::PI).sqrt();
            assert!(sum <= 1.0 + 1e-6 && sum <= 1.0 - open + 0.03, "vertex {vertex}: {sum} {open}");
            assert!(mesh.positions().len() != 54 || vertex % 9 != 4 || sum > 1.0 - 1e-6, "vertex {vertex}: {sum}");
        }
    }
}

#[test]
fn tables_change_no_byte() {
    let mesh = plates();
    let (scene, options) = (Scene::new(&mesh), options(6, 2048, 0.005));
    let origins = ray_origins(&mesh, &scene);
    let [tabulated, some, evaluated] = [usize::MAX, 1 << 17, 0].map(|bytes| {
        let ladder = Ladder::with_tables(&options, bytes);
        let pass =
            DirectPass { mesh: &mesh, scene: &scene, ladder: &ladder, normals: mesh.normals(), origins: &origins };
        let (mut scratch, mut rows) = (pass.scratch(), vec![0.0; 36 * mesh.positions().len()]);
        rows.chunks_exact_mut(36).enumerate().for_each(|(vertex, row)| {
            pass.shadowed_vector(&mut scratch, vertex, row);
        });
        rows
    });
    assert_eq!(tabulated, some);
    assert_eq!(tabulated, evaluated);
}

#[test]
fn what_cannot_be_reached_is_counted() {
    let (_, report) = bake(&plates(), &options(5, 256, 1e-4));
    let savings = report.savings;
    assert!(savings.unconverged_vertices > 100 && report.error.unwrap() > 1e-4, "{savings:?}");
    assert_eq!(savings.levels.iter().map(|level| level.vertices).sum::<usize>(), report.vertices.len());
    // Those that are not open went to the end.
    let at_end = savings.levels.last().unwrap();
    assert_eq!((at_end.directions, at_end.vertices + savings.open_vertices >= report.vertices.len()), (256, true));
}

/// What a target error cannot see: a post that is thinner than the coarsest directions are apart. The RMS error over all vertices was 0.99 of
/// the one asked for, where elsewhere it is 0.5 to 0.9 of it.
#[test]
fn a_thin_post_is_missed_by_no_more_than_the_error_on_average() {
    let mut source = MeshSource::default();
    add_square(&mut source, [-1.0, -1.0, 0.0], [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0]], 10);
    // 0.01 wide, 1 high, seen from around: weights of up to 1e-3.
    for side in [[0.01, 0.0, 0.0], [0.0, 0.01, 0.0]] {
        add_square(&mut source, [0.013, 0.017, 0.0], [side, [0.0, 0.0, 1.0]], 1);
    }
    let mesh = mesh(source);
    let truth = bake(&mesh, &BakeOptions { target_error: None, ..options(5, 1 << 17, 0.1) }).0;
    let mut all = Vec::new();
    for seed in 0..8 {
        let (found, _) = bake(&mesh, &BakeOptions { seed, ..options(5, 1 << 15, 0.005) });
        all.extend(errors(&found.transfer, &truth.transfer, &found.unshadowed()));
    }
    let reached = rms(all.into_iter());
    assert!(reached < 1.1 * 0.005, "{reached}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn any_options_bake(order in 1_usize..=32, rays in 1_usize..2000, exponent in -6.0_f64..0.0, bounces in 0_usize..2) {
        let mut source = MeshSource::default();
        add_square(&mut source, [0.0; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], 2);
        add_square(&mut source, [0.0, 0.0, 0.3], [[0.0, 0.5, 0.0], [0.5, 0.0, 0.0]], 1);
        let options = BakeOptions { bounces, ..options(order, rays, 10_f64.powf(exponent)) };
        let (baked, report) = bake(&mesh(source), &options);
        prop_assert!(baked.transfer.values.iter().all(|value| value.is_finite()));
        prop_assert!(report.vertices.iter().all(|stats| stats.error >= 0.0 && stats.occluded <= stats.directions));
        prop_assert_eq!(report.savings.levels.iter().map(|level| level.vertices).sum::<usize>(), 13);
    }
}

#[test]
fn target_errors_out_of_range_are_refused() {
    for error in [0.0, -0.1, 1.5, f64::NAN, f64::INFINITY] {
        let result = bake_diffuse(&plates(), &options(3, 64, error), &());
        assert!(result.unwrap_err().to_string().contains("target error"), "{error}");
    }
}
