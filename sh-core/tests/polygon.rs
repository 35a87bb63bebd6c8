//! The polygon light against closed forms, quadrature and its laws, and where it degenerates.
#![cfg(feature = "alloc")]
#![expect(clippy::unwrap_used, clippy::print_stdout, reason = "tests print what they measured")]

use std::f64::consts::{FRAC_PI_2, PI};

use proptest::prelude::*;
use sh_core::{
    Basis, Order, Quadrature, Real, ShRotation, ambient_light, clamped_cosine_power, disk_light, hemisphere_light,
    index, polygon_light,
};

fn order(n: usize) -> Order {
    Order::new(n).unwrap()
}

fn light<T: Real>(n: usize, vertices: &[[T; 3]]) -> Vec<T> {
    let mut out = vec![T::from_f64(f64::NAN); n * n];
    polygon_light(order(n), vertices, &mut out);
    out
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    // NaN counts as large
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, |worst, d| if d <= worst { worst } else { d })
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn unit(a: [f64; 3]) -> [f64; 3] {
    a.map(|x| x / dot(a, a).sqrt())
}

/// Gauss-Legendre on `[0, 1]`, from the rings of a quadrature.
fn gauss(count: usize) -> Vec<(f64, f64)> {
    let quadrature = Quadrature::new(2 * (count - 1));
    let longitudes = quadrature.points().len() / count;
    let rings = quadrature.points().iter().step_by(longitudes);
    rings.map(|&([_, _, z], w)| (0.5 + 0.5 * z, w * longitudes as f64 / (4.0 * PI))).collect()
}

/// The definition: a signed fan of flat triangles, each by a product rule. `ds = n·p dA / |p|³`.
fn by_quadrature(n: usize, vertices: &[[f64; 3]], count: usize) -> Vec<f64> {
    let (basis, rule) = (Basis::<f64>::new(order(n)), gauss(count));
    let (mut y, mut sums) = (vec![0.0; n * n], vec![0.0; n * n]);
    for pair in vertices[1..].windows(2) {
        let (a, b, c) = (vertices[0], sub(pair[0], vertices[0]), sub(pair[1], vertices[0]));
        let volume = dot(a, cross(b, c));
        for (&(u, u_weight), &(v, v_weight)) in rule.iter().flat_map(|u| rule.iter().map(move |v| (u, v))) {
            // Duffy's map of the square to the triangle
            let p = std::array::from_fn(|k| a[k] + u * (1.0 - v) * b[k] + u * v * c[k]);
            basis.eval(unit(p), &mut y);
            let weight = u_weight * v_weight * u * volume / dot(p, p).powf(1.5);
            sums.iter_mut().zip(&y).for_each(|(sum, y)| *sum += weight * y);
        }
    }
    let sense = sums[0].signum();
    sums.iter().map(|sum| sense * sum).collect()
}

#[test]
fn an_octant_has_its_closed_forms() {
    let octant = light(3, &[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    // ∫ x = π/4, ∫ xy = 1/3 over the octant, by symmetry in all axes; z² has the mean 1/3.
    let (linear, quadratic) = ((3.0 / (4.0 * PI)).sqrt() * PI / 4.0, (15.0 / PI).sqrt() / 2.0 / 3.0);
    let solid_angle = FRAC_PI_2 / (4.0 * PI).sqrt();
    let expected = [solid_angle, -linear, linear, -linear, quadratic, -quadratic, 0.0, -quadratic, 0.0];
    assert!(difference(&octant, &expected) < 3e-16, "{octant:?}");
}

/// A slice from the equator to the pole, of width `w`: `w/2π` of the half space in each zonal coefficient, any band.
#[test]
fn a_slice_has_its_share_of_the_half_space_in_every_band() {
    for (n, width) in [(2, 1.0), (6, 0.3), (20, 3.0), (100, 2.0), (512, 0.7)] {
        let slice = light(n, &[[1.0, 0.0, 0.0], [f64::cos(width), f64::sin(width), 0.0], [0.0, 0.0, 1.0]]);
        let mut half_space = vec![0.0; n];
        clamped_cosine_power(0.0, &mut half_space);
        let zonal: Vec<f64> = (0..n).map(|l| slice[index(l, 0)]).collect();
        let expected: Vec<f64> = half_space.iter().map(|g| g * width / (2.0 * PI)).collect();
        let error = difference(&zonal, &expected);
        println!("slice of {width} at n = {n}: {error:e}");
        assert!(error < 1e-14);
        // About the middle of the slice it is even.
        for (l, m) in (0..n).flat_map(|l| (1..=l as isize).map(move |m| (l, m))) {
            let (s, c) = f64::sin_cos(0.5 * width * m as f64);
            let odd = c * slice[index(l, -m)] - s * slice[index(l, m)];
            assert!(odd.abs() < 1e-13, "y_{l} {m}: {odd:e}");
        }
    }
}

#[test]
fn polygons_are_their_quadrature() {
    let polygons: [(&str, Vec<[f64; 3]>); 5] = [
        ("square above", vec![[-1.0, -1.0, 2.0], [1.0, -1.0, 2.0], [1.0, 1.0, 2.0], [-1.0, 1.0, 2.0]]),
        ("close wall", vec![[-2.0, 0.9, -1.5], [2.0, 0.9, -1.5], [2.5, 0.9, 1.0], [-2.0, 0.9, 1.0]]),
        ("clockwise sliver", vec![[1.0, 2.0, 3.0], [1.1, 2.0, 3.0], [1.0, 2.2, 2.0]]),
        ("arrow", vec![[-1.0, -1.0, -1.5], [0.0, 1.0, -1.5], [1.0, -1.0, -1.5], [0.0, -0.3, -1.5]]),
        ("far", vec![[1e3, 2e3, 0.0], [1e3, 2e3, 50.0], [1e3, 2.1e3, 50.0]]),
    ];
    let mut worst = 0.0_f64;
    for (name, vertices) in &polygons {
        for n in [1, 2, 6, 13, 24] {
            let error = difference(&light(n, vertices), &by_quadrature(n, vertices, 120));
            assert!(error < 1e-14, "{name}, n = {n}: {error:e}");
            worst = worst.max(error);
        }
    }
    println!("worst difference from quadrature to n = 24: {worst:e}");
}

/// The fine print of the relative accuracy: what is left when edges nearly cancel.
#[test]
fn small_polygons_lose_digits_as_their_vertices_do() {
    for exponent in 0..8 {
        let size = 10.0_f64.powi(-exponent);
        let at = |x: f64, y: f64| [0.6 + 0.8 * size * x, size * y, 0.8 - 0.6 * size * x];
        let vertices = [at(-1.0, -0.8), at(1.0, -1.0), at(0.8, 1.0), at(-1.0, 1.0)];
        let (found, expected) = (light(6, &vertices), by_quadrature(6, &vertices, 60));
        let relative = difference(&found, &expected) / expected[0];
        println!("size {size:e}: relative error {relative:e}");
        assert!(relative < 4e-15 / size);
        assert!((found[0] / expected[0] - 1.0).abs() < 4e-15 / size);
        let reversed: Vec<_> = vertices.into_iter().rev().collect();
        assert!(difference(&light(6, &reversed), &expected) / expected[0] < 4e-15 / size);
    }
}

#[test]
fn many_corners_make_a_disk() {
    // The area between a regular polygon and its circle falls as 1/count².
    let mut disk = [0.0_f64; 36];
    disk_light(order(6), [0.0, 0.6, 0.8], 0.5, &mut disk);
    let error = |count: usize| {
        let vertex = |k: usize| {
            let (s, c) = f64::sin_cos(2.0 * PI * k as f64 / count as f64);
            let (x, y, z) = (f64::sin(0.5) * c, f64::sin(0.5) * s, f64::cos(0.5));
            [x, 0.8 * y + 0.6 * z, 0.8 * z - 0.6 * y]
        };
        difference(&light(6, &(0..count).map(vertex).collect::<Vec<_>>()), &disk)
    };
    let (coarse, fine) = (error(100), error(1000));
    assert!(coarse < 1e-3 && (coarse / fine / 100.0 - 1.0).abs() < 0.01, "{coarse:e} {fine:e}");
}

#[test]
fn eight_octants_are_the_sphere() {
    let mut sum = vec![0.0; 400];
    for signs in 0..8_u8 {
        let sign = |bit: u8| if signs >> bit & 1 == 0 { 1.0 } else { -1.0 };
        let octant = light(20, &[[sign(0), 0.0, 0.0], [0.0, sign(1), 0.0], [0.0, 0.0, sign(2)]]);
        sum.iter_mut().zip(octant).for_each(|(sum, f)| *sum += f);
    }
    let mut everywhere = vec![0.0; 400];
    ambient_light(order(20), &mut everywhere);
    assert!(difference(&sum, &everywhere) < 1e-14);
}

#[test]
fn degenerate_polygons_have_an_answer() {
    let triangle = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let [a, b, c] = triangle;
    let expected = light(6, &triangle);
    // Repeats, vertices without a direction, and points on the edges change nothing; nor does the distance.
    let same = [
        vec![a, a, b, c, c],
        vec![a, b, c, a],
        vec![a, b, [0.0; 3], c, [f64::NAN, 1.0, 0.0], [f64::INFINITY, 0.0, 0.0]],
        vec![a, [0.5, 0.5, 0.0], b, [0.0, 1e-3, 0.7], c],
        vec![c, b, a],
        vec![a.map(|x| x * 1e300), b.map(|x| x * 1e-300), c.map(|x| x * 5e-324)],
    ];
    for vertices in same {
        assert!(difference(&light(6, &vertices), &expected) < 2e-15, "{vertices:?}");
    }
    // Corners that differ by a rounding, in length or direction.
    let near = [a, [1.0, 1e-16, 0.0], [1.0 - 1e-16, 1e-300, 0.0], b, c];
    assert!(difference(&light(6, &near), &expected) < 2e-15);
    let tilted = [[0.36, -0.48, 0.8], [-0.6, 0.64, 0.48], [0.0, -0.28, -0.96]];
    let rounded: Vec<_> = tilted.iter().flat_map(|v| (1..60).map(move |k| v.map(|x| x * f64::from(k)))).collect();
    assert!(difference(&light(6, &rounded), &light(6, &tilted)) < 1e-14);
    let dark = [
        vec![],
        vec![a],
        vec![a, b],
        vec![a, a, a],
        vec![a, b, a, b],
        vec![[0.0; 3]; 5],
        vec![[f64::NAN; 3]; 4],
        // edge-on
        vec![[1.0, -1.0, 0.0], [2.0, -1.0, 0.0], [2.0, 1.0, 0.0], [1.0, 1.0, 0.0]],
        vec![[1.0, -1.0, 1.0], [2.0, -1.0, 2.0], [2.0, 1.0, 2.0], [3.0, 3.0, 3.0]],
        // the point is on an edge, or at a corner
        vec![[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]],
        vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
    ];
    for vertices in dark {
        assert!(difference(&light(6, &vertices), &[0.0; 36]) < 1e-15, "{vertices:?}");
    }
}

#[test]
fn a_point_on_the_polygon_sees_a_half_space() {
    for (k, turn) in [0.0, 0.3, 1.0, 2.7, 4.0, 6.0].into_iter().enumerate() {
        // Along z, and about tilted axes, where rounding decides on which side of the plane the corners are.
        let tilt = 0.9 * k as f64;
        let (axis, e1) = ([0.0, tilt.sin(), tilt.cos()], [0.0, tilt.cos(), -tilt.sin()]);
        for (sense, count) in [3, 4, 5, 7, 12].into_iter().flat_map(|count| [(1.0, count), (-1.0, count)]) {
            let corner = |k: usize| {
                let (s, c) = f64::sin_cos(turn + sense * 2.0 * PI * k as f64 / count as f64);
                // a right-handed frame: x × e1 = axis
                std::array::from_fn(|i| [c, 0.0, 0.0][i] + s * e1[i])
            };
            let found = light(6, &(0..count).map(corner).collect::<Vec<_>>());
            let mut expected = [0.0; 36];
            hemisphere_light(order(6), axis.map(|x| sense * x), 1.0, 0.0, &mut expected);
            assert!(difference(&found, &expected) < 4e-15, "{sense} {turn} {count}: {found:?}");
        }
    }
    // A hair above it, nearly so, and continuous with it.
    let mut above = [0.0; 36];
    hemisphere_light(order(6), [0.0, 0.0, -1.0], 1.0, 0.0, &mut above);
    let square = [[-1.0, -1.0, -1e-9], [1.0, -1.0, -1e-9], [1.0, 1.0, -1e-9], [-1.0, 1.0, -1e-9]];
    assert!(difference(&light(6, &square), &above) < 1e-8);
}

#[test]
fn the_smaller_side_of_the_sphere_shines() {
    // All but a cap around −z, to the left of the edges.
    let corners = [[0.6, 0.0, -0.8], [0.0, 0.6, -0.8], [-0.6, 0.0, -0.8], [0.0, -0.6, -0.8]];
    let cap = light(4, &corners);
    assert!(cap[0] < PI && cap[2] < 0.0);
    let reversed: Vec<_> = corners.into_iter().rev().collect();
    assert!(difference(&cap, &light(4, &reversed)) < 1e-15);
}

#[test]
fn single_precision_is_double_precision_rounded() {
    let vertices = [[-1.0_f32, 0.25, 2.0], [1.5, -1.0, 0.5], [1.0, 2.0, 2.0]];
    let double = light(10, &vertices.map(|v| v.map(f64::from)));
    for (single, double) in light(10, &vertices).iter().zip(double) {
        assert!((f64::from(*single) - double).abs() <= 6e-8 * double.abs());
    }
}

#[test]
fn orders_1_and_512_are_finite() {
    let triangle = [[-1.0_f32, 0.25, 2.0], [1.5, -1.0, 0.5], [1.0, 2.0, 2.0]];
    let (one, many) = (light(1, &triangle), light(512, &triangle));
    assert_eq!(one[0], many[0]);
    assert!(many.iter().all(|f| f.is_finite()));
    // Parseval: the squares add up to the solid angle. What is missing beyond band n is the perimeter over πn.
    let energy: f64 = many.iter().map(|&f| f64::from(f).powi(2)).sum();
    let solid_angle = f64::from(one[0]) * (4.0 * PI).sqrt();
    let [a, b, c] = triangle.map(|v| unit(v.map(f64::from)));
    let perimeter = dot(a, b).acos() + dot(b, c).acos() + dot(c, a).acos();
    let tail = (solid_angle - energy) * PI * 512.0 / perimeter;
    assert!((tail - 1.0).abs() < 0.02, "{tail}");
}

fn vertex() -> impl Strategy<Value = [f64; 3]> {
    [-1.0..1.0_f64, -1.0..1.0_f64, -1.0..1.0_f64].prop_filter("a direction", |v| dot(*v, *v) > 1e-4)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// A triangle is the sum of its parts.
    #[test]
    fn parts_add_up([a, b, c] in [vertex(), vertex(), vertex()], u in 0.0..1.0_f64, v in 0.0..1.0_f64) {
        let whole = light(8, &[a, b, c]);
        let inside = std::array::from_fn(|k| (1.0 - u) * a[k] + u * ((1.0 - v) * b[k] + v * c[k]));
        let mut sum = vec![0.0; 64];
        for part in [[a, b, inside], [b, c, inside], [c, a, inside]] {
            sum.iter_mut().zip(light(8, &part)).for_each(|(sum, f)| *sum += f);
        }
        // Where the triangle is seen nearly edge-on from within, its sides cannot be told apart.
        prop_assume!(dot(a, cross(b, c)).abs() > 1e-6);
        prop_assert!(difference(&whole, &sum) < 1e-9, "{:e}", difference(&whole, &sum));
    }

    /// A triangle, by quadrature where that converges.
    #[test]
    fn triangles_are_their_quadrature(vertices in [vertex(), vertex(), vertex()]) {
        let vertices = vertices.map(unit);
        let [a, b, c] = vertices;
        prop_assume!(dot(a, b) > -0.3 && dot(b, c) > -0.3 && dot(c, a) > -0.3 && dot(a, cross(b, c)).abs() > 0.1);
        prop_assert!(difference(&light(5, &vertices), &by_quadrature(5, &vertices, 40)) < 1e-12);
    }

    /// Turning the vertices turns the light.
    #[test]
    fn rotation_commutes(vertices in prop::collection::vec(vertex(), 3), angle in 0.0..7.0_f64) {
        let (s, c) = angle.sin_cos();
        let matrix = [[c, 0.0, s], [0.36 * s, 0.8, -0.36 * c], [0.0; 3]];
        let x = unit(matrix[0]);
        let y = unit(sub(matrix[1], x.map(|k| k * dot(matrix[1], x))));
        let matrix = [x, y, cross(x, y)];
        let turned: Vec<[f64; 3]> = vertices.iter().map(|&v| matrix.map(|row| dot(row, v))).collect();
        let mut expected = vec![0.0; 49];
        ShRotation::new(order(7), matrix).apply(&light(7, &vertices), &mut expected);
        prop_assert!(difference(&light(7, &turned), &expected) < 1e-11);
    }

    /// Anything at all gives finite numbers, and no more than the sphere.
    #[test]
    fn the_answer_is_finite(vertices in prop::collection::vec([any::<f32>(), any::<f32>(), any::<f32>()], 0..6)) {
        let light = light(4, &vertices);
        prop_assert!(light.iter().all(|f| f.is_finite()));
        prop_assert!(light[0] >= 0.0 && f64::from(light[0]) <= 2.0 * PI / (4.0 * PI).sqrt() + 1e-6);
    }
}
