//! A polygon of light, by an integral along its edges.

use core::f64::consts::PI;

use alloc::vec;
use alloc::vec::Vec;

use crate::direction::{cross, dot3, unit};
use crate::order::assert_length;
use crate::{Basis, Order, Real, index};

/// A polygon of radiance 1, seen from the origin: the integral of every basis function over its solid angle, without
/// sampling.
///
/// - `vertices`: from the point that is lit, at any distance and in any unit; three or more, in either sense: both sides
///   shine. Only the directions matter
/// - `out`: `[n²]`, overwritten; band 0 is the solid angle over `√(4π)`
///
/// For `l > 0` the harmonics are eigenfunctions of the Laplacian, so Stokes' theorem turns the integral into one along the
/// edges,
///
/// ```text
/// ∫ y_lm dω = −1/(l(l+1)) Σ_a R_a V_a      V_a,lm = ∮ y_lm(s) ds_a      R = s × ∇,  a = x, y, z
/// ```
///
/// where `R` turns a band into itself by known factors. Along an edge the integrand is a trigonometric polynomial of degree
/// at most n. It is integrated in pieces on which 16 Gauss-Legendre points leave a remainder below 1e-17 of its size, so
/// there is rounding and no other error. Band 0 is the sum of signed solid angles of triangles.
///
/// Accuracy in `f64`: 1e-14 absolute, against quadrature to n = 24 and a closed form to n = 512; relative to the solid angle
/// of a small polygon of angular size `a`, 4e-15/`a`, which is about what the rounding of its vertices does to it. Asserted
/// by `tests/polygon.rs`.
///
/// Every simple polygon is allowed, convex or not, planar or not. Of the two parts of the sphere the smaller one shines, which
/// for a planar polygon is the polygon; for the larger one subtract from [`ambient_light`](super::ambient_light). An edge is
/// the shorter arc. Vertices at the origin
/// or not finite are left out, as are repeated ones. Seen exactly edge-on the polygon is dark. At a point on the polygon
/// itself the light is the half space on one of its sides (the left of the edges), and dark where the point is on an edge.
///
/// ```
/// use sh_core::{Order, polygon_light};
///
/// // An eighth of the sphere.
/// let mut light = [0.0_f64; 9];
/// polygon_light(Order::new(3)?, &[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], &mut light);
/// let solid_angle = light[0] * (4.0 * std::f64::consts::PI).sqrt();
/// assert!((solid_angle - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If `out` is not `[n²]`.
///
/// Source: the problem is that of [WR18](crate#references), with the same theorem applied to all harmonics at once instead of
/// to zonal ones; [OS83](crate#references) for the solid angle.
pub fn polygon_light<T: Real>(order: Order, vertices: &[[T; 3]], out: &mut [T]) {
    assert_length("out", out.len(), order.coeff_count());
    out.fill(T::ZERO);
    let corners = corners(vertices);
    let Some(edges) = edges(&corners) else { return };
    // Radiance is positive whichever way the edges run.
    let solid_angle = signed_solid_angle(&corners);
    let sense = if solid_angle < 0.0 { -1.0 } else { 1.0 };
    out[0] = T::from_f64(solid_angle.abs() / Real::sqrt(4.0 * PI));
    let moments = edge_moments(order, &edges);
    for (l, band) in order.bands().skip(1) {
        let factor = -sense / (l * (l + 1)) as f64;
        for (out, m) in out[band].iter_mut().zip(-(l as isize)..) {
            *out = T::from_f64(factor * turned(&moments, l, m));
        }
    }
}

/// Unit directions of the vertices, without those that have none and without repeats.
fn corners<T: Real>(vertices: &[[T; 3]]) -> Vec<[f64; 3]> {
    let mut corners: Vec<[f64; 3]> = vertices.iter().filter_map(|v| unit(v.map(T::to_f64))).collect();
    corners.dedup();
    while corners.len() > 1 && corners.first() == corners.last() {
        corners.pop();
    }
    corners
}

/// An arc of a great circle: `start cos t + tangent sin t` for `t` from 0 to `angle`.
struct Edge {
    start: [f64; 3],
    tangent: [f64; 3],
    angle: f64,
}

/// The arcs between neighbours; `None` if there is no polygon, or an edge joins opposite directions and could go anywhere.
fn edges(corners: &[[f64; 3]]) -> Option<Vec<Edge>> {
    if corners.len() < 3 {
        return None;
    }
    let ends = corners.iter().cycle().skip(1);
    corners.iter().zip(ends).map(|(&start, &end)| edge(start, end)).collect()
}

fn edge(start: [f64; 3], end: [f64; 3]) -> Option<Edge> {
    // The difference first: its digits are good also where the ends are close.
    let step: [f64; 3] = core::array::from_fn(|k| end[k] - start[k]);
    let normal = cross(start, step);
    let sine = Real::sqrt(dot3(normal, normal));
    let cosine = dot3(start, end);
    if sine < OPPOSITE_SINE && cosine < 0.0 {
        return None;
    }
    // Neighbours differ, so there is a tangent; had rounding eaten it, the edge would have no length either.
    let tangent = unit(cross(normal, start)).unwrap_or_default();
    Some(Edge { start, tangent, angle: Real::atan2(sine, cosine) })
}

/// The ends of an edge are opposite if the sine of its angle is below this: four roundings of a unit vector. A point lies on
/// an edge then, as far as its coordinates can tell.
const OPPOSITE_SINE: f64 = 1e-15;

/// The area to the left of the edges, in `(−2π, 2π]`: triangles from a point amid the corners. Source:
/// [OS83](crate#references).
fn signed_solid_angle(corners: &[[f64; 3]]) -> f64 {
    let pairs = || corners.iter().zip(corners.iter().cycle().skip(1));
    // Twice the vector area, and the sum of the corners to choose the side on which they are: the opposite one is amid the
    // rest of the sphere, where a small area is the difference of large ones.
    let (mut amid, mut sum) = ([0.0; 3], [0.0; 3]);
    for (&b, &c) in pairs() {
        let normal = cross(b, c);
        for k in 0..3 {
            amid[k] += normal[k];
            sum[k] += b[k];
        }
    }
    let side = if dot3(amid, sum) < 0.0 { -1.0 } else { 1.0 };
    let Some(a) = unit(amid.map(|x| side * x)) else { return 0.0 };
    let triangle = |(&b, &c): (&[f64; 3], &[f64; 3])| {
        let from_a = |v: [f64; 3]| core::array::from_fn(|k| v[k] - a[k]);
        let volume = dot3(a, cross(from_a(b), from_a(c)));
        2.0 * Real::atan2(volume, 1.0 + dot3(a, b) + dot3(b, c) + dot3(c, a))
    };
    // Triangles may wind around the sphere. A hemisphere has both signs, by rounding; its edges run to the left.
    let area = pairs().map(triangle).sum::<f64>() % (4.0 * PI);
    if area > 2.0 * PI + HEMISPHERE_TOLERANCE {
        area - 4.0 * PI
    } else if area <= -2.0 * PI + HEMISPHERE_TOLERANCE {
        area + 4.0 * PI
    } else {
        area
    }
}

/// By so much the area of a hemisphere may differ from 2π by rounding.
const HEMISPHERE_TOLERANCE: f64 = 1e-12;

/// `V_a,lm = ∮ y_lm(s) ds_a` for `a = x, y, z`, each `[n²]`.
fn edge_moments(order: Order, edges: &[Edge]) -> [Vec<f64>; 3] {
    let basis = Basis::<f64>::new(order);
    let mut moments = [(); 3].map(|()| vec![0.0; order.coeff_count()]);
    let mut y = vec![0.0; order.coeff_count()];
    for edge in edges {
        let pieces = piece_count(order, edge.angle);
        let half = 0.5 * edge.angle / pieces as f64;
        for (piece, (node, weight)) in (0..pieces).flat_map(|k| rule().map(move |point| (k, point))) {
            let t = half * ((2 * piece + 1) as f64 + node);
            let (c, s) = (Real::cos(t), Real::sin(t));
            basis.eval(core::array::from_fn(|k| c * edge.start[k] + s * edge.tangent[k]), &mut y);
            for (a, moment) in moments.iter_mut().enumerate() {
                let displacement = half * weight * (c * edge.tangent[a] - s * edge.start[a]);
                moment.iter_mut().zip(&y).for_each(|(v, y)| *v += displacement * y);
            }
        }
    }
    moments
}

/// Into how many pieces an edge is cut so that the rule is exact to rounding on each.
fn piece_count(order: Order, angle: f64) -> usize {
    let phase = 0.5 * angle * order.get() as f64;
    // The quotient is below 512 · π/2 / 7.
    1 + (phase / LARGEST_PHASE) as usize
}

/// Half the length of a piece times the degree, at most.
///
/// For a trigonometric polynomial of degree n on a piece of half length `h`, Bernstein's inequality bounds the derivatives by
/// `(n h)^2N`, and the remainder of N Gauss-Legendre points is at most `2^(2N+1) (N!)⁴ / ((2N+1) ((2N)!)³) (n h)^2N` times the
/// largest value. For N = 16 and `n h = 7` that is 3e-18.
const LARGEST_PHASE: f64 = 7.0;

/// Nodes above 0 and weights of the Gauss-Legendre rule of 16 points.
const RULE: [(f64, f64); 8] = [
    (0.095_012_509_837_637_44, 0.189_450_610_455_068_5),
    (0.281_603_550_779_258_9, 0.182_603_415_044_923_58),
    (0.458_016_777_657_227_37, 0.169_156_519_395_002_54),
    (0.617_876_244_402_643_8, 0.149_595_988_816_576_74),
    (0.755_404_408_355_003, 0.124_628_971_255_533_88),
    (0.865_631_202_387_831_8, 0.095_158_511_682_492_79),
    (0.944_575_023_073_232_6, 0.062_253_523_938_647_894),
    (0.989_400_934_991_649_9, 0.027_152_459_411_754_096),
];

fn rule() -> impl Iterator<Item = (f64, f64)> {
    RULE.into_iter().flat_map(|(node, weight)| [(-node, weight), (node, weight)])
}

/// `Σ_a R_a V_a` at one coefficient: the derivatives of `y_lm` along the turns about the axes, applied to the moments.
///
/// With `Y^m` complex, `y_m = √2 Re Y^m` and `y_−m = √2 Im Y^m`, the ladder operators give `R_x Y^m = i/2 (up Y^(m+1) + down
/// Y^(m−1))`, `R_y Y^m = 1/2 (up Y^(m+1) − down Y^(m−1))`, `R_z Y^m = i m Y^m`.
fn turned([x, y, z]: &[Vec<f64>; 3], l: usize, m: isize) -> f64 {
    let at = |v: &[f64], m: isize| if m.unsigned_abs() <= l { v[index(l, m)] } else { 0.0 };
    let (size, sign) = (m.abs(), if m < 0 { -1.0 } else { 1.0 });
    let (lf, mf) = (l as f64, size as f64);
    let up = 0.5 * Real::sqrt((lf - mf) * (lf + mf + 1.0));
    if m == 0 {
        // √2 because y_0 is not one of a pair
        return core::f64::consts::SQRT_2 * up * (at(y, 1) - at(x, -1));
    }
    let down = 0.5 * Real::sqrt((lf + mf) * (lf - mf + 1.0));
    let s = if m < 0 { -1 } else { 1 };
    // R_x and R_z lead to the partner of the other sign, R_y keeps the sign; Im Y^0 = 0.
    let pair = |v: &[f64], m: isize, partner: isize| match m {
        0 if partner < 0 => 0.0,
        0 => core::f64::consts::SQRT_2 * at(v, 0),
        m => at(v, partner * m),
    };
    let about_x = -sign * (up * pair(x, size + 1, -s) + down * pair(x, size - 1, -s));
    let about_y = up * pair(y, size + 1, s) - down * pair(y, size - 1, s);
    let about_z = -sign * mf * at(z, -m);
    about_x + about_y + about_z
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;
    use crate::sphere::gauss_legendre;

    #[test]
    fn the_rule_is_that_of_gauss_and_legendre() {
        let mut points: Vec<_> = rule().collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        for ((node, weight), (expected_node, expected_weight)) in points.into_iter().zip(gauss_legendre(16)) {
            assert!((node - expected_node).abs() < 3e-16 && (weight - expected_weight).abs() < 3e-16);
        }
    }

    #[test]
    fn the_largest_phase_leaves_nothing() {
        // B(N) = 2^(2N+1) (N!)⁴ / ((2N+1) ((2N)!)³) k^2N, by its ratio from N − 1 to N.
        let ratio = |n: f64| LARGEST_PHASE * LARGEST_PHASE * n / (2.0 * (4.0 * n * n - 1.0) * (2.0 * n - 1.0));
        let bound: f64 = 2.0 * (1..=16).map(|n| ratio(f64::from(n))).product::<f64>();
        assert!(bound > 1e-18 && bound < 1e-17, "{bound:e}");
    }

    #[test]
    fn pieces_are_short_enough() {
        for (n, angle) in [(1, 0.0), (1, PI), (4, 1.0), (6, PI), (65, 2.0), (512, PI), (512, 1e-9)] {
            let pieces = piece_count(Order::new(n).unwrap(), angle);
            assert!(0.5 * angle / pieces as f64 * n as f64 <= LARGEST_PHASE, "{n} {angle}");
            assert!(pieces == 1 || 0.5 * angle / (pieces - 1) as f64 * n as f64 >= LARGEST_PHASE, "{n} {angle}");
        }
    }

    #[test]
    fn turns_are_derivatives_of_the_basis() {
        // R_a y_lm at a direction is the change of y_lm when the direction is turned about the axis a.
        let order = Order::new(7).unwrap();
        let (s, angle) = ([0.36, -0.48, 0.8], 1e-5_f64);
        let turn = |a: usize, angle: f64| {
            let (b, c) = ((a + 1) % 3, (a + 2) % 3);
            let mut turned = s;
            turned[b] = angle.cos() * s[b] - angle.sin() * s[c];
            turned[c] = angle.sin() * s[b] + angle.cos() * s[c];
            turned
        };
        let values = |direction| {
            let mut y = vec![0.0; 49];
            crate::eval(order, direction, &mut y);
            y
        };
        for a in 0..3 {
            let (after, before) = (values(turn(a, angle)), values(turn(a, -angle)));
            let mut moments = [vec![0.0; 49], vec![0.0; 49], vec![0.0; 49]];
            moments[a] = values(s);
            for (l, m) in (1..7).flat_map(|l| (-(l as isize)..=l as isize).map(move |m| (l, m))) {
                let i = index(l, m);
                let slope = (after[i] - before[i]) / (2.0 * angle);
                assert!((turned(&moments, l, m) - slope).abs() < 1e-8, "about {a}: y_{l} {m}");
            }
        }
    }
}
