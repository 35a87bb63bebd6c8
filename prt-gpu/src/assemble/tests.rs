#![expect(clippy::unwrap_used, reason = "tests")]
use super::*;
use proptest::prelude::*;

/// Clip space is world space: x and y in -1..1 are the image, z in 0..1 the depth.
const IDENTITY: [[f32; 4]; 4] =
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
/// w = z: a pinhole at the origin that looks along +z, 90 degrees wide, near plane at 0.5, far plane at infinity.
const PINHOLE: [[f32; 4]; 4] =
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 1.0], [0.0, 0.0, -0.5, 0.0]];

fn view(clip_from_world: [[f32; 4]; 4], side: u32) -> View {
    View::new(clip_from_world, side, side, 1).unwrap()
}

/// The screen position of every corner, triangle by triangle.
fn points(assembly: &Assembly) -> Vec<[[i32; 2]; 3]> {
    let point = |v: u32| [assembly.vertices[v as usize].x, assembly.vertices[v as usize].y];
    assembly.triangles.iter().map(|corners| corners.map(point)).collect()
}

#[test]
fn vertices_are_snapped_to_the_grid() {
    let positions = [[-1.0, 1.0, 0.25], [1.0, 1.0, 0.5], [0.0, -0.5, 1.0]];
    let assembly = assemble(&positions, &[[0, 2, 1]], &view(IDENTITY, 4));
    let expected = [(0, 0, 0.25), (1024, 0, 0.5), (512, 768, 1.0)];
    for (vertex, (x, y, z)) in assembly.vertices.iter().zip(expected) {
        assert_eq!((vertex.x, vertex.y, vertex.z, vertex.inverse_w), (x, y, z, 1.0));
    }
    assert_eq!(assembly.triangles, [[0, 1, 2]]);
    assert_eq!(assembly.front_count, 1);
}

#[test]
fn winding_decides_the_side_and_fronts_come_first() {
    let positions = [[-0.5, -0.5, 0.5], [0.5, -0.5, 0.5], [0.0, 0.5, 0.5]];
    let assembly = assemble(&positions, &[[0, 2, 1], [0, 1, 2], [1, 0, 2]], &view(IDENTITY, 8));
    assert_eq!(assembly.front_count, 1, "counterclockwise with y up is the front");
    // The same three points give the same corners from both sides: their depths are equal bit by bit.
    assert_eq!(assembly.triangles, [[2, 1, 0]; 3]);
}

#[test]
fn triangles_that_cannot_be_seen_are_left_out() {
    let nan = [f32::NAN, 0.0, 0.5];
    let positions =
        [[-0.5, -0.5, 0.5], [0.5, -0.5, 0.5], [0.0, 0.5, 0.5], [2.0, 0.0, 0.5], [3.0, 1.0, 0.5], [2.0, 1.0, 0.5], nan];
    let left_out = [[3, 4, 5], [0, 1, 6], [0, 0, 1], [0, 1, 1]];
    assert_eq!(assemble(&positions, &left_out, &view(IDENTITY, 8)).triangles, Vec::<[u32; 3]>::new());
    let between_samples = [[0.0, 0.0, 0.5], [0.1, 0.0, 0.5], [0.0, 0.1, 0.5]];
    assert!(assemble(&between_samples, &[[0, 1, 2]], &view(IDENTITY, 8)).triangles.is_empty());
    assert!(assemble(&[], &[], &view(IDENTITY, 8)).triangles.is_empty());
}

#[test]
fn huge_triangles_are_cut_to_the_image() {
    let cover = |size: f32| {
        let positions = [[-size, -size, 0.5], [size, -size, 0.5], [0.0, size, 0.5]];
        let assembly = assemble(&positions, &[[0, 1, 2]], &view(IDENTITY, 4));
        points(&assembly).into_iter().map(area).sum::<i32>()
    };
    for size in [4.0, 1e3, 1e9] {
        assert_eq!(cover(size), 2 * 1024 * 1024, "the whole image is covered, once");
    }
    // Positions are cut with 16 digits: from here on they are lost, and what is left is merely on the image.
    for size in [1e20, f32::MAX] {
        assert!((0..=2 * 1024 * 1024).contains(&cover(size)));
    }
}

fn area([a, b, c]: [[i32; 2]; 3]) -> i32 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[test]
fn sample_centres_are_half_a_sample_in() {
    assert_eq!(sample_range(0, 127), 0..0);
    assert_eq!(sample_range(0, 128), 0..1);
    assert_eq!(sample_range(128, 128), 0..1);
    assert_eq!(sample_range(129, 383), 1..1);
    assert_eq!(sample_range(129, 384), 1..2);
    assert_eq!(sample_range(0, 1024), 0..4);
}

#[test]
fn a_triangle_behind_the_camera_does_not_come_back_mirrored() {
    let behind = [[-1.0, -1.0, -3.0], [1.0, -1.0, -3.0], [0.0, 1.0, -3.0]];
    assert!(assemble(&behind, &[[0, 1, 2], [0, 2, 1]], &view(PINHOLE, 64)).triangles.is_empty());
}

/// A floor from in front of the camera to behind it: only what lies below the horizon is seen.
#[test]
fn a_floor_that_crosses_the_near_plane_ends_below_the_horizon() {
    let positions = [[-9.0, -1.0, 40.0], [9.0, -1.0, 40.0], [0.0, -1.0, -40.0]];
    let assembly = assemble(&positions, &[[0, 1, 2]], &view(PINHOLE, 64));
    assert!(assembly.clips.len() > 2);
    // At z = 40 the floor is seen 1/40 of half the image below the horizon.
    let horizon = 32 * 256 + 32 * 256 / 40;
    let highest = points(&assembly).into_iter().flatten().map(|p| p[1]).min().unwrap();
    assert!((highest - horizon).abs() <= 1, "{highest} is not {horizon}");
}

/// A corner coordinate: mostly near the view volume, sometimes far outside.
fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![-1.5_f32..1.5, -40.0_f32..40.0]
}

fn corner() -> impl Strategy<Value = [f32; 3]> {
    [coordinate(), coordinate(), coordinate()]
}

proptest! {
    #[test]
    fn clipped_vertices_lie_on_their_triangle(triangle in [corner(), corner(), corner()]) {
        let view = view(PINHOLE, 512);
        let assembly = assemble(&triangle, &[[0, 1, 2]], &view);
        for (clip, vertex) in assembly.clips.iter().zip(&assembly.vertices[3..]) {
            let source = clip.source.map(|v| triangle[v as usize]);
            let [x, y, z]: [f64; 3] = std::array::from_fn(|i| (0..3).map(|k| f64::from(clip.weight[k] * source[k][i])).sum());
            // Weights are rounded to f32: 1e-7 of the largest coordinate, 40, seen from at least 0.5.
            let expected = [256.0 + 256.0 * x / z, 256.0 - 256.0 * y / z].map(|p| p * 256.0);
            prop_assert!((f64::from(vertex.x) - expected[0]).abs() < 5.0, "{} is not {}", vertex.x, expected[0]);
            prop_assert!((f64::from(vertex.y) - expected[1]).abs() < 5.0, "{} is not {}", vertex.y, expected[1]);
            prop_assert!((clip.weight.iter().sum::<f32>() - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn all_corners_are_on_the_image_with_positive_area(triangle in [corner(), corner(), corner()]) {
        let assembly = assemble(&triangle, &[[0, 1, 2]], &view(PINHOLE, 512));
        for corners in points(&assembly) {
            prop_assert!(corners.as_flattened().iter().all(|c| (0..=512 * 256).contains(c)));
            let [a, b, c] = corners.map(|p| p.map(i64::from));
            prop_assert!((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0);
            prop_assert!([a[1], a[0]] < [b[1], b[0]] && [a[1], a[0]] < [c[1], c[0]], "topmost first");
        }
    }

    #[test]
    fn both_sides_of_a_sheet_are_cut_alike(triangle in [corner(), corner(), corner()]) {
        let front = assemble(&triangle, &[[0, 1, 2]], &view(PINHOLE, 512));
        let back = assemble(&triangle, &[[2, 1, 0]], &view(PINHOLE, 512));
        prop_assert_eq!((&front.vertices, &front.triangles), (&back.vertices, &back.triangles));
        prop_assert!(front.triangles.is_empty() || front.front_count + back.front_count == front.triangles.len());
    }

    #[test]
    fn a_shared_edge_is_cut_at_the_same_points(quad in [corner(), corner(), corner(), corner()]) {
        let edge_points = |triangle: [u32; 3], outer: u32| -> Vec<[i32; 2]> {
            let assembly = assemble(&quad, &[triangle], &view(PINHOLE, 512));
            let on_edge = assembly.clips.iter().zip(&assembly.vertices[4..]).filter(|(clip, _)| clip.weight[clip.source.iter().position(|&v| v == outer).unwrap()] == 0.0);
            let mut points: Vec<_> = on_edge.map(|(_, vertex)| [vertex.x, vertex.y]).collect();
            points.sort_unstable();
            points
        };
        // Both triangles have the edge from 0 to 1, in opposite directions.
        prop_assert_eq!(edge_points([0, 1, 2], 2), edge_points([3, 1, 0], 3));
    }
}

#[test]
fn the_result_does_not_depend_on_threads() {
    let ring = |i: u32| f64::from(i).mul_add(0.37, 0.1).sin() as f32;
    let positions: Vec<[f32; 3]> = (0..30_000).map(|i| [2.0 * ring(i), 2.0 * ring(i + 7), ring(i + 3) + 0.7]).collect();
    let triangles: Vec<[u32; 3]> = (0..29_990).map(|i| [i, i + 1, i + 5]).collect();
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| assemble(&positions, &triangles, &view(PINHOLE, 256)))
    };
    let alone = run(1);
    assert!(!alone.clips.is_empty() && alone.triangles.len() > alone.front_count);
    assert_eq!(alone, run(5));
}
