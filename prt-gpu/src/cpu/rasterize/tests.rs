#![expect(clippy::unwrap_used, reason = "tests")]
use super::*;
use proptest::prelude::*;

const IDENTITY: [[f32; 4]; 4] =
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
/// w = z: a pinhole at the origin that looks along +z, 90 degrees wide, near plane at 0.5.
const PINHOLE: [[f32; 4]; 4] =
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 1.0], [0.0, 0.0, -0.5, 0.0]];

fn view(matrix: [[f32; 4]; 4], width: u32, height: u32, samples: u32) -> View {
    View::new(matrix, width, height, samples).unwrap()
}

fn coverage(frame: &Frame) -> Vec<f32> {
    frame.pixels.iter().map(|p| p[3]).collect()
}

/// A position on the image plane of [`IDENTITY`], from sample coordinates of a 16 x 16 image.
fn at(x: f32, y: f32) -> [f32; 3] {
    [x / 8.0 - 1.0, 1.0 - y / 8.0, 0.5]
}

proptest! {
    /// A jittered grid with random diagonals over the whole image: every sample belongs to exactly one triangle. Positions are
    /// multiples of half a sample as often as not, so that edges and corners pass through sample centres.
    #[test]
    fn shared_edges_neither_overlap_nor_leave_gaps(
        jitter in proptest::collection::vec((-2_i32..=2, -2_i32..=2, any::<bool>(), -1e-3_f32..1e-3), 25)
    ) {
        let inner = |i: usize| (1..4).contains(&(i % 5)) && (1..4).contains(&(i / 5));
        let position = |i: usize| {
            let (dx, dy, exact, extra) = jitter[i];
            let [dx, dy] = [dx, dy].map(|d| if inner(i) { d as f32 * 0.5 + if exact { 0.0 } else { extra } } else { 0.0 });
            at((i % 5) as f32 * 4.0 + dx, (i / 5) as f32 * 4.0 + dy)
        };
        let positions: Vec<[f32; 3]> = (0..25).map(position).collect();
        let cells = (0..16_u32).map(|c| c % 4 + c / 4 * 5).zip(&jitter);
        let triangles: Vec<[u32; 3]> = cells
            .flat_map(|(a, &(.., flip, _))| match flip {
                true => [[a, a + 5, a + 6], [a, a + 6, a + 1]],
                false => [[a, a + 5, a + 1], [a + 1, a + 5, a + 6]],
            })
            .collect();
        let view = view(IDENTITY, 16, 16, 1);
        let mut times = vec![0.0; 256];
        for triangle in &triangles {
            let one = coverage(&rasterize(&positions, &[*triangle], &[[1.0; 3]; 25], &view));
            times.iter_mut().zip(one).for_each(|(t, c)| *t += c);
        }
        prop_assert_eq!(times, vec![1.0; 256]);
    }

    /// Away from its edges, a triangle covers the sample centres that lie inside it.
    #[test]
    fn coverage_is_the_inside(corners in [[0.0_f32..16.0, 0.0_f32..16.0], [0.0_f32..16.0, 0.0_f32..16.0], [0.0_f32..16.0, 0.0_f32..16.0]]) {
        let positions = corners.map(|[x, y]| at(x, y));
        let drawn = coverage(&rasterize(&positions, &[[0, 1, 2]], &[[1.0; 3]; 3], &view(IDENTITY, 16, 16, 1)));
        for (i, drawn) in drawn.into_iter().enumerate() {
            let centre = [(i % 16) as f64 + 0.5, (i / 16) as f64 + 0.5];
            let distance = (0..3).map(|k| edge_distance(corners[k], corners[(k + 1) % 3], centre));
            let distances: Vec<f64> = distance.collect();
            // Snapping moves corners by at most 1/512 along each axis, so an edge by at most 1/362.
            if distances.iter().all(|d| d.abs() > 1.0 / 362.0) {
                let inside = distances.iter().all(|d| *d > 0.0) || distances.iter().all(|d| *d < 0.0);
                prop_assert_eq!(drawn, f32::from(u8::from(inside)), "sample {}", i);
            }
        }
    }

    /// The colours are the positions: what a sample sees must be seen at that sample. Corners lie in front of the camera, beside
    /// and behind it.
    #[test]
    fn interpolation_is_perspective_correct(corners in [[-6.0_f32..6.0, -6.0_f32..6.0, -2.0_f32..9.0], [-6.0_f32..6.0, -6.0_f32..6.0, -2.0_f32..9.0], [-6.0_f32..6.0, -6.0_f32..6.0, 1.0_f32..9.0]]) {
        let frame = rasterize(&corners, &[[0, 1, 2], [0, 2, 1]], &corners, &view(PINHOLE, 32, 32, 1));
        for (i, pixel) in frame.pixels.iter().enumerate().filter(|(_, p)| p[3] == 1.0) {
            let [x, y, z, _] = pixel.map(f64::from);
            prop_assert!(z > 0.49, "in front of the near plane");
            let seen = [16.0 + 16.0 * x / z, 16.0 - 16.0 * y / z];
            let centre = [(i % 32) as f64 + 0.5, (i / 32) as f64 + 0.5];
            // Snapping moves corners by at most 1/512 along each axis, and what is between them by no more. Weights are off by
            // 6e-7 at most, of coordinates up to 9, seen from 0.5 or farther, 16 pixels per unit: 2e-4.
            let limit = 1.0 / 512.0 + 2e-4;
            prop_assert!((seen[0] - centre[0]).abs() < limit && (seen[1] - centre[1]).abs() < limit, "{seen:?} is not {centre:?}");
            prop_assert!((f64::from(frame.depth[i]) - (1.0 - 0.5 / z)).abs() < 1e-5);
        }
    }
}

fn edge_distance(a: [f32; 2], b: [f32; 2], p: [f64; 2]) -> f64 {
    let (a, b) = (a.map(f64::from), b.map(f64::from));
    let d = [b[0] - a[0], b[1] - a[1]];
    (d[0] * (p[1] - a[1]) - d[1] * (p[0] - a[0])) / d[0].hypot(d[1]).max(1e-9)
}

/// Two triangles that fill the image, at clip depth `z`, counterclockwise.
fn screen(z: f32) -> ([[f32; 3]; 4], [[u32; 3]; 2]) {
    ([[-1.0, -1.0, z], [1.0, -1.0, z], [1.0, 1.0, z], [-1.0, 1.0, z]], [[0, 1, 2], [0, 2, 3]])
}

/// Equal within the rounding of three weights that add up to 1.
fn is_near(pixel: [f32; 4], expected: [f32; 4]) -> bool {
    pixel.iter().zip(expected).all(|(p, e)| (p - e).abs() <= 4.0 * f32::EPSILON * e)
}

#[test]
fn the_image_is_covered_to_its_last_pixel() {
    let (positions, triangles) = screen(0.5);
    for (width, height, samples) in [(1, 1, 1), (1, 1, 4), (5, 3, 3), (3, 70, 2), (33, 17, 1)] {
        let frame = rasterize(&positions, &triangles, &[[0.25; 3]; 4], &view(IDENTITY, width, height, samples));
        assert_eq!((frame.width, frame.height), (width as usize, height as usize));
        assert!(frame.pixels.iter().all(|p| is_near(*p, [0.25, 0.25, 0.25, 1.0])), "{width} x {height} x {samples}");
        assert!(frame.depth.iter().all(|&d| d == 0.5));
    }
}

#[test]
fn no_triangles_give_an_empty_image() {
    let frame = rasterize(&[[0.0; 3]], &[], &[[1.0; 3]], &view(IDENTITY, 2, 2, 2));
    assert_eq!((frame.pixels, frame.depth), (vec![[0.0; 4]; 4], vec![1.0; 4]));
}

#[test]
fn samples_are_averaged() {
    // The left 3/8 of a pixel: of 4 x 4 samples, the column at 1/8 is covered, and that at 3/8 lies on the edge, outside.
    let positions = [[-1.0, -1.0, 0.5], [-0.25, -1.0, 0.5], [-0.25, 1.0, 0.5], [-1.0, 1.0, 0.5]];
    let frame = rasterize(&positions, &[[0, 1, 2], [0, 2, 3]], &[[8.0, 4.0, 0.0]; 4], &view(IDENTITY, 1, 1, 4));
    assert!(is_near(frame.pixels[0], [2.0, 1.0, 0.0, 0.25]));
}

#[test]
fn the_nearest_surface_is_seen_whatever_the_order() {
    // Two squares that pass through each other along x = 0.
    let rising = [[-1.0, -1.0, 0.1], [1.0, -1.0, 0.9], [1.0, 1.0, 0.9], [-1.0, 1.0, 0.1]];
    let falling = rising.map(|[x, y, z]| [x, y, 1.0 - z]);
    let positions = [rising, falling].concat();
    let colors: Vec<[f32; 3]> = (0..8).map(|v| if v < 4 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] }).collect();
    let first = [[0, 1, 2], [0, 2, 3]];
    let second = first.map(|corners: [u32; 3]| corners.map(|v| v + 4));
    let view = view(IDENTITY, 4, 1, 1);
    let frame = rasterize(&positions, &[first, second].concat(), &colors, &view);
    assert_eq!(frame, rasterize(&positions, &[second, first].concat(), &colors, &view));
    let reds: Vec<f32> = frame.pixels.iter().map(|p| p[0].round()).collect();
    assert_eq!(reds, [1.0, 1.0, 0.0, 0.0]);
}

#[test]
fn backs_are_black_and_hide_and_fronts_win_ties() {
    let (positions, front) = screen(0.5);
    let back = front.map(|[a, b, c]| [a, c, b]);
    let view = view(IDENTITY, 2, 2, 1);
    let color = [[0.5, 0.25, 0.125]; 4];
    let black = rasterize(&positions, &back, &color, &view);
    assert!(black.pixels.iter().all(|p| *p == [0.0, 0.0, 0.0, 1.0]));
    for triangles in [[front, back].concat(), [back, front].concat()] {
        let frame = rasterize(&positions, &triangles, &color, &view);
        assert!(frame.pixels.iter().all(|p| is_near(*p, [0.5, 0.25, 0.125, 1.0])), "a two-sided sheet shows its front");
    }
    let (nearer, _) = screen(0.25);
    let all = [positions, nearer].concat();
    let nearer_back = back.map(|corners| corners.map(|v| v + 4));
    let hidden = rasterize(&all, &[front, nearer_back].concat(), &[color, color].concat(), &view);
    assert!(hidden.pixels.iter().all(|p| *p == [0.0, 0.0, 0.0, 1.0]));
}

#[test]
fn a_huge_triangle_is_drawn_as_far_as_it_is_seen() {
    let far = 1e9;
    let positions = [[-far, -far, 0.5], [far, -far, 0.5], [0.0, far, 0.5]];
    let frame = rasterize(&positions, &[[0, 1, 2]], &[[2.0; 3]; 3], &view(IDENTITY, 64, 64, 1));
    assert!(frame.pixels.iter().all(|p| is_near(*p, [2.0, 2.0, 2.0, 1.0])));
}

#[test]
fn triangles_with_bad_corners_are_left_out_and_the_rest_is_drawn() {
    let (positions, triangles) = screen(0.5);
    let positions =
        [&positions[..], &[[f32::NAN; 3], [f32::INFINITY, 0.0, 0.5], [0.0, f32::NEG_INFINITY, 0.0]]].concat();
    let bad = [[0, 1, 4], [4, 5, 6], [1, 5, 2], [6, 0, 2], [0, 0, 0]];
    let frame = rasterize(&positions, &[&bad[..], &triangles].concat(), &[[0.5; 3]; 7], &view(IDENTITY, 8, 8, 2));
    assert!(frame.pixels.iter().all(|p| is_near(*p, [0.5, 0.5, 0.5, 1.0])));
}

#[test]
fn huge_and_tiny_radiance_stay_finite() {
    let positions = [[-3.0, -3.0, 1.0], [3.0, -3.0, 6.0], [0.0, 3.0, 2.0]];
    for (radiance, samples) in [(1e30, 4), (-1e30, 1), (1e-38, 3), (0.0, 2)] {
        let frame = rasterize(&positions, &[[0, 1, 2]], &[[radiance; 3]; 3], &view(PINHOLE, 40, 40, samples));
        assert!(frame.pixels.iter().any(|p| p[3] == 1.0));
        let expected = frame.pixels.iter().map(|p| radiance * p[3]);
        assert!(
            frame.pixels.iter().zip(expected).all(|(p, e)| (p[0] - e).abs() <= 1e-6 * radiance.abs()),
            "{radiance}"
        );
    }
}

#[test]
fn the_image_does_not_depend_on_threads() {
    let ring = |i: u32| f64::from(i).mul_add(0.37, 0.1).sin() as f32;
    let positions: Vec<[f32; 3]> = (0..3000).map(|i| [2.0 * ring(i), 2.0 * ring(i + 7), ring(i + 3) + 0.7]).collect();
    let triangles: Vec<[u32; 3]> = (0..2990).map(|i| [i, i + 1, i + 5]).collect();
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| rasterize(&positions, &triangles, &positions, &view(PINHOLE, 100, 100, 2)))
    };
    assert_eq!(run(1), run(7));
}

#[test]
#[should_panic(expected = "triangle 0 uses vertex 3; the surface has 3 vertices")]
fn an_index_out_of_range_is_refused() {
    rasterize(&[[0.0; 3]; 3], &[[0, 1, 3]], &[[0.0; 3]; 3], &view(IDENTITY, 1, 1, 1));
}

#[test]
#[should_panic(expected = "5 samples per axis were asked for")]
fn an_unchecked_view_is_refused() {
    let view = View { clip_from_world: IDENTITY, width: 1, height: 1, samples: 5 };
    rasterize(&[], &[], &[], &view);
}
