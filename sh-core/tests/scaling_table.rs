//! Tables of scaling matrices: their nodes, and the error between them.
#![cfg(feature = "alloc")]
#![expect(clippy::unwrap_used, reason = "tests")]

use sh_core::{Error, Interpolation, Order, Preserve, ScalingMatrix, ScalingTable, Tau, geometric_nodes};

fn order(n: usize) -> Order {
    Order::new(n).unwrap()
}

fn table(n: usize, nodes: &[f64], interpolation: Interpolation) -> ScalingTable<f64> {
    ScalingTable::new(order(n), order(n), nodes, Tau::cone, Preserve::Value, interpolation).unwrap()
}

fn exact(n: usize, tau: Tau) -> ScalingMatrix<f64> {
    ScalingMatrix::new(order(n), order(n), tau, Preserve::Value).unwrap()
}

/// The spectral norm of the difference of two matrices, by power iteration on `DᵀD`.
fn distance(a: &ScalingMatrix<f64>, b: &ScalingMatrix<f64>) -> f64 {
    let entries: Vec<_> = a.entries().zip(b.entries()).map(|(a, b)| (a.0, a.1, a.2 - b.2)).collect();
    let count = a.order().coeff_count();
    let mut vector: Vec<f64> = (0..count).map(|i| 1.0 + (i as f64).sin()).collect();
    let mut norm = 0.0;
    for _ in 0..200 {
        let (mut image, mut back) = (vec![0.0; count], vec![0.0; count]);
        entries.iter().for_each(|&(i, j, d)| image[i] += d * vector[j]);
        entries.iter().for_each(|&(i, j, d)| back[j] += d * image[i]);
        let length = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
        norm = length(&image);
        let scale = 1.0 / length(&back).max(f64::MIN_POSITIVE);
        vector = back.iter().map(|b| b * scale).collect();
    }
    norm
}

fn worst(table: &ScalingTable<f64>, n: usize, ks: impl Iterator<Item = f64>, tau: impl Fn(f64) -> Tau) -> f64 {
    ks.map(|k| distance(&table.matrix(k), &exact(n, tau(k)))).fold(0.0, f64::max)
}

#[test]
fn interpolation_errors_of_the_paper_sized_table() {
    let nodes = geometric_nodes(0.2, 16.0, 40).unwrap();
    for (interpolation, n, limit, documented) in [
        (Interpolation::Linear, 4, 1.5e-2, 1.4e-2),
        (Interpolation::Linear, 6, 3.5e-2, 3.4e-2),
        (Interpolation::CubicLog, 4, 5e-4, 4.3e-4),
        (Interpolation::CubicLog, 6, 2.5e-3, 2.4e-3),
    ] {
        // Five places in each interval.
        let between = nodes.windows(2).flat_map(|p| (1..6).map(move |i| p[0] * (p[1] / p[0]).powf(f64::from(i) / 6.0)));
        let error = worst(&table(n, &nodes, interpolation), n, between, Tau::cone);
        assert!(error <= limit, "{interpolation:?}, n = {n}: {error}");
        // What the documentation says, to two digits.
        assert!((error / documented - 1.0).abs() < 0.05, "{interpolation:?}, n = {n}: {error}");
    }
}

#[test]
fn the_cone_table_is_the_paper_sized_one() {
    let nodes = geometric_nodes(0.2, 16.0, 40).unwrap();
    assert_eq!(
        ScalingTable::cone(order(4), order(4), Preserve::Value).unwrap(),
        table(4, &nodes, Interpolation::CubicLog)
    );
}

#[test]
fn nodes_are_the_computed_matrices() {
    let nodes = geometric_nodes(0.2, 16.0, 40).unwrap();
    for interpolation in [Interpolation::Linear, Interpolation::CubicLog, Interpolation::Cubic] {
        let table = table(5, &nodes, interpolation);
        for &k in &nodes {
            assert!(distance(&table.matrix(k), &exact(5, Tau::cone(k))) < 1e-14, "{interpolation:?} at {k}");
        }
        for (i, j, entry) in table.matrix(1.0).entries() {
            assert!((entry - f64::from(u8::from(i == j))).abs() < 1e-13);
        }
    }
}

#[test]
fn geometric_nodes_have_a_one() {
    let nodes = geometric_nodes(0.2, 16.0, 40).unwrap();
    assert_eq!((nodes.len(), nodes[0], nodes[39]), (40, 0.2, 16.0));
    assert!(nodes.contains(&1.0));
    let steps: Vec<f64> = nodes.windows(2).map(|pair| (pair[1] / pair[0]).ln()).collect();
    assert!(steps.iter().all(|step| (step / (80.0_f64.ln() / 39.0) - 1.0).abs() < 0.04), "{steps:?}");
    assert_eq!(geometric_nodes(2.0, 8.0, 2).unwrap(), [2.0, 8.0]);
    assert_eq!(geometric_nodes(0.99, 50.0, 3).unwrap(), [0.99, 1.0, 50.0]);
    for (first, last, count) in [(0.0, 1.0, 5), (2.0, 1.0, 5), (0.5, f64::NAN, 5), (0.5, 2.0, 2), (2.0, 3.0, 1)] {
        assert!(matches!(geometric_nodes(first, last, count), Err(Error::Scaling { .. })), "{first} {last} {count}");
    }
}

#[test]
fn beyond_the_ends_the_nearest_node_is_taken() {
    let nodes = geometric_nodes(0.5, 2.0, 6).unwrap();
    for interpolation in [Interpolation::Linear, Interpolation::CubicLog, Interpolation::Cubic] {
        let table = table(3, &nodes, interpolation);
        for k in [0.5, 0.1, 0.0, -3.0, f64::NEG_INFINITY, f64::NAN] {
            assert!(distance(&table.matrix(k), &exact(3, Tau::cone(0.5))) < 1e-14, "{interpolation:?}, {k}");
        }
        for k in [2.0, 7.0, f64::INFINITY] {
            assert!(distance(&table.matrix(k), &exact(3, Tau::cone(2.0))) < 1e-14, "{interpolation:?}, {k}");
        }
    }
}

#[test]
fn mid_range_is_tabled_in_k() {
    let nodes: Vec<f64> = (-9..=9).map(|i| 0.1 * f64::from(i)).collect();
    let tau = |k| Tau::MidRange { k };
    let table =
        ScalingTable::<f64>::new(order(4), order(6), &nodes, tau, Preserve::Value, Interpolation::Cubic).unwrap();
    let mut matrix = table.matrix(0.0);
    for k in [-0.55, 0.05, 0.43] {
        table.interpolate(k, &mut matrix);
        let exact = ScalingMatrix::<f64>::new(order(4), order(6), tau(k), Preserve::Value).unwrap();
        let worst = matrix.entries().zip(exact.entries()).map(|(a, b)| f64::abs(a.2 - b.2)).fold(0.0, f64::max);
        assert!(worst < 2e-3, "k = {k}: {worst}");
    }
}

#[test]
fn few_nodes_lower_the_degree() {
    // Through two nodes a cubic is linear in ln k.
    let table = table(2, &[0.5, 2.0], Interpolation::CubicLog);
    let middle = table.matrix(1.0);
    let ends = [0.5, 2.0].map(|k| exact(2, Tau::cone(k)));
    for ((m, a), b) in middle.entries().zip(ends[0].entries()).zip(ends[1].entries()) {
        assert!((m.2 - 0.5 * (a.2 + b.2)).abs() < 1e-15);
    }
}

#[test]
fn nodes_without_meaning_are_refused() {
    let new = |nodes: &[f64], interpolation| {
        ScalingTable::<f32>::new(order(2), order(2), nodes, Tau::cone, Preserve::Value, interpolation).unwrap_err()
    };
    assert!(matches!(new(&[1.0], Interpolation::Linear), Error::Scaling { what: "the number of nodes", .. }));
    assert!(matches!(new(&[1.0, 1.0], Interpolation::Linear), Error::Scaling { what: "a node", given: 1.0, .. }));
    assert!(matches!(new(&[0.0, 1.0], Interpolation::CubicLog), Error::Scaling { what: "a node", .. }));
    assert!(matches!(new(&[1.0, f64::NAN], Interpolation::Linear), Error::Scaling { what: "a node", .. }));
    // Finite nodes, but no cone.
    assert!(matches!(new(&[-1.0, 1.0], Interpolation::Linear), Error::Scaling { what: "k", given: -1.0, .. }));
}

#[test]
#[should_panic(expected = "matrix (rows) has 3 elements, it needs 2")]
fn a_matrix_of_other_orders_is_refused() {
    let table = table(2, &[0.5, 2.0], Interpolation::Linear);
    table.interpolate(1.0, &mut exact(3, Tau::cone(1.0)));
}
