#![expect(clippy::unwrap_used, reason = "tests")]

use proptest::prelude::*;
use sh_core::Order;

use super::*;
use crate::{BakeOptions, Mesh, MeshOptions, MeshSource, bake_diffuse};

/// A strip of squares along x, with corners at distances that grow.
fn strip(cells: u32) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let positions = (0..=cells).flat_map(|i| [[f64::from(i * i), 0.0, 0.0], [f64::from(i * i), 1.0, 0.0]]).collect();
    let triangles = (0..cells).map(|i| 2 * i).flat_map(|a| [[a, a + 2, a + 3], [a, a + 3, a + 1]]).collect();
    (positions, triangles)
}

fn plan(positions: &[[f64; 3]], triangles: &[[u32; 3]], is_valid: &[bool]) -> InsidePlan {
    InsidePlan::new(InsidePolicy::Fill, triangles, positions, is_valid)
}

#[test]
fn a_buried_end_takes_the_last_vertices_outside() {
    let (positions, triangles) = strip(4);
    let is_valid: Vec<bool> = (0..10).map(|vertex| vertex < 4).collect();
    let plan = plan(&positions, &triangles, &is_valid);
    assert_eq!(plan.vertices(), [4, 5, 6, 7, 8, 9]);
    assert_eq!(plan.sources(3), None);
    // Vertex 4 at (4, 0) has one neighbour outside, 2 at (1, 0); vertex 5 at (4, 1) has 2 at distance √10 and 3 at distance 3.
    assert_eq!(plan.sources(4).unwrap(), [(2, 1.0)]);
    let [(first, near), (second, far)] = *plan.sources(5).unwrap() else { panic!("two sources") };
    assert_eq!((first, second), (3, 2));
    assert!((near / far - (10.0_f32).sqrt() / 3.0).abs() < 1e-6);
    // Farther rings have no other sources.
    assert!((6..10).all(|vertex| plan.sources(vertex).unwrap().iter().all(|(source, _)| (2..4).contains(source))));
}

#[test]
fn what_no_edge_leads_to_is_filled_across_copies_and_then_from_the_nearest() {
    let (mut positions, mut triangles) = strip(1);
    // Vertices 4 to 6 are a face that touches the strip at a copy of vertex 0, though vertex 6 is nearer to 1; 7 to 9 are a face of their own, nearest to vertex 2.
    positions.extend([[0.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.5, 0.0]]);
    positions.extend([[5.0, -1.0, 1.0], [6.0, -1.0, 1.0], [6.0, -2.0, 1.0]]);
    triangles.extend([[4, 5, 6], [7, 8, 9]]);
    let is_valid: Vec<bool> = (0..10).map(|vertex| vertex < 4).collect();
    let plan = plan(&positions, &triangles, &is_valid);
    for vertex in 4..7 {
        assert_eq!(plan.sources(vertex).unwrap(), [(0, 1.0)]);
    }
    for vertex in 7..10 {
        assert_eq!(plan.sources(vertex).unwrap(), [(2, 1.0)]);
    }
}

#[test]
fn policies_decide() {
    let (positions, triangles) = strip(1);
    let is_valid = [true, false, true, true];
    let plan = |policy| InsidePlan::new(policy, &triangles, &positions, &is_valid);
    let mut transfer =
        TransferVectors { order: Order::new(1).unwrap(), channels: 1, values: vec![1.0, 0.25, 3.0, 5.0] };
    let original = transfer.values.clone();
    plan(InsidePolicy::Keep).apply(&mut transfer);
    assert_eq!(transfer.values, original);
    plan(InsidePolicy::Black).apply(&mut transfer);
    assert_eq!(transfer.values, [1.0, 0.0, 3.0, 5.0]);
    plan(InsidePolicy::Fill).apply(&mut transfer);
    // Of the neighbours 0 and 3 of vertex 1 both are at distance 1.
    assert_eq!(transfer.values, [1.0, 3.0, 3.0, 5.0]);
    assert_eq!(plan(InsidePolicy::Black).sources(1), Some(&[][..]));
    for policy in [InsidePolicy::Fill, InsidePolicy::Keep] {
        assert_eq!(InsidePlan::new(policy, &triangles, &positions, &[false; 4]), InsidePlan::default());
    }
    for name in InsidePolicy::NAMES {
        assert_eq!(name.parse::<InsidePolicy>().unwrap().to_string(), name);
    }
    assert!("Fill".parse::<InsidePolicy>().unwrap_err().to_string().contains("fill, keep, black"));
}

proptest! {
    #[test]
    fn sources_are_few_and_valid_and_weights_add_up_to_one(
        positions in prop::collection::vec(prop::array::uniform3((-4..4).prop_map(f64::from)), 3..40),
        corners in prop::collection::vec(prop::array::uniform3(0..1000_u32), 1..60),
        draws in prop::collection::vec(0..3, 40),
    ) {
        let count = positions.len() as u32;
        let triangles: Vec<[u32; 3]> = corners.iter().map(|corners| corners.map(|corner| corner % count)).collect();
        let is_valid: Vec<bool> = draws[..positions.len()].iter().map(|&draw| draw == 0).collect();
        let plan = plan(&positions, &triangles, &is_valid);
        let any_valid = is_valid.contains(&true);
        for (vertex, &is_valid_here) in is_valid.iter().enumerate() {
            let Some(sources) = plan.sources(vertex) else {
                prop_assert!(is_valid_here || !any_valid);
                continue;
            };
            prop_assert!(!is_valid_here && (1..=MAX_SOURCES).contains(&sources.len()));
            prop_assert!(sources.iter().all(|&(source, weight)| is_valid[source as usize] && weight > 0.0));
            let sum: f32 = sources.iter().map(|(_, weight)| weight).sum();
            prop_assert!((sum - 1.0).abs() <= 4.0 * f32::EPSILON, "{}", sum);
        }
        // What is the same at all valid vertices is the same everywhere, and doing it twice changes nothing.
        let values = is_valid.iter().flat_map(|&valid| if valid { [2.0, -3.0] } else { [9.0; 2] }).collect();
        let mut transfer = TransferVectors { order: Order::new(1).unwrap(), channels: 2, values };
        plan.apply(&mut transfer);
        let once = transfer.clone();
        plan.apply(&mut transfer);
        prop_assert_eq!(&once, &transfer);
        if any_valid {
            prop_assert!(once.values.chunks(2).all(|row| (row[0] - 2.0).abs() < 1e-5 && (row[1] + 3.0).abs() < 1e-5));
        }
    }
}

/// A closed box with quads of `cells²` on each side.
fn box_source(lower: [f64; 3], size: [f64; 3], cells: u32) -> MeshSource {
    let mut source = MeshSource::default();
    for (axis, is_upper) in (0..3).flat_map(|axis| [(axis, false), (axis, true)]) {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let first = source.positions.len() as u32;
        for i in 0..=cells {
            for j in 0..=cells {
                let mut position = lower;
                position[axis] += if is_upper { size[axis] } else { 0.0 };
                position[u] += size[u] * f64::from(i) / f64::from(cells);
                position[v] += size[v] * f64::from(j) / f64::from(cells);
                source.positions.push(position);
                if i < cells && j < cells {
                    let a = first + i * (cells + 1) + j;
                    let [b, c, d] = [a + cells + 1, a + cells + 2, a + 1];
                    source.triangles.extend(if is_upper { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] });
                }
            }
        }
    }
    source
}

fn joined(parts: Vec<MeshSource>) -> Mesh {
    let mut all = MeshSource::default();
    for part in parts {
        let first = all.positions.len() as u32;
        all.positions.extend(part.positions);
        all.triangles.extend(part.triangles.iter().map(|triangle| triangle.map(|vertex| vertex + first)));
    }
    Mesh::new(all, &MeshOptions::default()).unwrap().0
}

/// A box that stands half-way in another.
fn intersecting_boxes() -> Mesh {
    joined(vec![box_source([-1.0; 3], [2.0, 2.0, 1.0], 4), box_source([-0.3, -0.3, -0.5], [0.61, 0.62, 1.0], 5)])
}

fn bake(mesh: &Mesh, inside: InsidePolicy, bounces: usize) -> (Vec<f32>, usize) {
    let order = Order::new(1).unwrap();
    let options = BakeOptions { order, rays_per_vertex: 256, bounces, inside, ..BakeOptions::default() };
    let (baked, report) = bake_diffuse(mesh, &options, &()).unwrap();
    // Under constant light 1.
    (
        baked
            .transfer
            .values
            .chunks(baked.transfer.channels)
            .map(|row| row[0] * (4.0 * std::f32::consts::PI).sqrt())
            .collect(),
        report.invalid_vertices,
    )
}

/// Whether a vertex of [`intersecting_boxes`] lies strictly inside of the other box.
fn is_buried(mesh: &Mesh, vertex: usize) -> bool {
    let [x, y, z] = mesh.positions()[vertex];
    let is_of_small_box = vertex >= 6 * 25;
    if is_of_small_box { z < -1e-9 } else { z > -1e-9 && -0.3 < x && x < 0.31 && -0.3 < y && y < 0.32 }
}

#[test]
fn vertices_of_intersecting_boxes_that_lie_in_the_other_box_are_found() {
    let mesh = intersecting_boxes();
    let (kept, count) = bake(&mesh, InsidePolicy::Keep, 0);
    let buried: Vec<usize> = (0..mesh.positions().len()).filter(|&vertex| is_buried(&mesh, vertex)).collect();
    assert_eq!(count, buried.len());
    assert!(count > 50 && buried.iter().all(|&vertex| kept[vertex].abs() < 1e-6), "{count}");
}

#[test]
fn filling_removes_the_dark_seam_where_boxes_intersect() {
    let mesh = intersecting_boxes();
    let darkest_corner = |values: &[f32]| {
        let is_visible = |triangle: &&[u32; 3]| triangle.iter().any(|&vertex| !is_buried(&mesh, vertex as usize));
        let least = |triangle: &[u32; 3]| {
            triangle.map(|vertex| values[vertex as usize]).into_iter().fold(f32::INFINITY, f32::min)
        };
        // The floor below the large box is not looked at: it is in the open.
        mesh.triangles().iter().filter(is_visible).map(least).fold(f32::INFINITY, f32::min)
    };
    for bounces in [0, 2] {
        let [kept, filled] = [InsidePolicy::Keep, InsidePolicy::Fill].map(|policy| bake(&mesh, policy, bounces).0);
        assert!(darkest_corner(&kept).abs() < 1e-6);
        // At the foot of a wall half of the sky is seen, and more of it at the corners of the foot.
        assert!(darkest_corner(&filled) > 0.45, "{bounces} bounces: {}", darkest_corner(&filled));
        // Vertices in the open never lose by it: buried ones reflect no less than the black ones did.
        for vertex in (0..kept.len()).filter(|&vertex| !is_buried(&mesh, vertex)) {
            assert!(filled[vertex] >= kept[vertex] && filled[vertex] <= 1.0 + 1e-6);
            assert!(bounces > 0 || filled[vertex] == kept[vertex]);
        }
    }
}
