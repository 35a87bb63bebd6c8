//! Triangles in the plane.

use std::f64::consts::TAU;

use glam::DVec2;

/// The point of a triangle that is nearest to some other point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Nearest {
    /// Weights of the corners; not negative, sum 1.
    pub(super) weights: [f64; 3],
    /// Squared distance to the other point.
    pub(super) distance_squared: f64,
}

/// The point of a triangle, which may run either way round, that is nearest to `point`.
pub(super) fn nearest(corners: [DVec2; 3], point: DVec2) -> Nearest {
    let spanned = spanned_areas(corners, point);
    let sum: f64 = spanned.iter().sum();
    if sum > 0.0 && spanned.iter().all(|&area| area >= 0.0) {
        return Nearest { weights: spanned.map(|area| area / sum), distance_squared: 0.0 };
    }
    let on_edges = [0, 1, 2].map(|k| nearest_on_edge(corners, k, point));
    on_edges.into_iter().min_by(|p, q| p.distance_squared.total_cmp(&q.distance_squared)).unwrap_or(on_edges[0])
}

/// The edge that a point lies farthest beyond, by its opposite corner, and the weights of the corners at the point, of which that one is
/// negative; `None` inside.
pub(super) fn beyond(corners: [DVec2; 3], point: DVec2) -> Option<(usize, [f64; 3])> {
    let spanned = spanned_areas(corners, point);
    let depth = |k: usize| spanned[k] / corners[(k + 1) % 3].distance(corners[(k + 2) % 3]);
    let k = (0..3).min_by(|&j, &k| depth(j).total_cmp(&depth(k)))?;
    let sum: f64 = spanned.iter().sum();
    (spanned[k] < 0.0).then(|| (k, spanned.map(|area| area / sum)))
}

/// Twice the areas that a point spans with the edges, each opposite to its corner; positive on the inner side.
fn spanned_areas(corners: [DVec2; 3], point: DVec2) -> [f64; 3] {
    let [a, b, c] = corners;
    let sign = (b - a).perp_dot(c - a).signum();
    [(b, c), (c, a), (a, b)].map(|(from, to)| sign * (from - point).perp_dot(to - point))
}

/// The share of the surroundings of a point that a triangle covers: 1 inside, ½ on an edge, its angle over 2π at a corner, 0 outside. So
/// the shares of triangles that only meet add up to 1 at most.
///
/// - `tolerance`: a point this near to an edge lies on it
pub(super) fn covered_share(corners: [DVec2; 3], point: DVec2, tolerance: f64) -> f64 {
    let side = |from: usize, to: usize| corners[to % 3] - corners[from % 3];
    let spanned = spanned_areas(corners, point);
    let depths = [0, 1, 2].map(|k| spanned[k] / side(k + 1, k + 2).length());
    if depths.iter().any(|&depth| depth < -tolerance) {
        return 0.0;
    }
    let far: Vec<usize> = (0..3).filter(|&k| depths[k] > tolerance).collect();
    match far.as_slice() {
        [] => 0.0,
        // Only the edge opposite to this corner is not near.
        &[k] => side(k, k + 1).angle_to(side(k, k + 2)).abs() / TAU,
        [_, _] => 0.5,
        _ => 1.0,
    }
}

/// The nearest point of the edge opposite corner `k`.
fn nearest_on_edge(corners: [DVec2; 3], k: usize, point: DVec2) -> Nearest {
    let (from, to) = ((k + 1) % 3, (k + 2) % 3);
    let along = corners[to] - corners[from];
    let length_squared = along.length_squared();
    let share = if length_squared > 0.0 { (point - corners[from]).dot(along) / length_squared } else { 0.0 };
    let share = share.clamp(0.0, 1.0);
    let mut weights = [0.0; 3];
    (weights[from], weights[to]) = (1.0 - share, share);
    let distance_squared = (corners[from] + share * along).distance_squared(point);
    Nearest { weights, distance_squared }
}
