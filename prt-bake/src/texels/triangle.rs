//! Triangles in the plane.

use glam::DVec2;

/// The point of a triangle that is nearest to some other point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Nearest {
    /// Weights of the corners; not negative, sum 1.
    pub(super) weights: [f64; 3],
    /// Squared distance to the other point.
    pub(super) distance_squared: f64,
    /// How far the other point lies inside: its distance to the nearest edge, 0 outside.
    pub(super) depth: f64,
}

/// The point of a triangle, which may run either way round, that is nearest to `point`.
pub(super) fn nearest(corners: [DVec2; 3], point: DVec2) -> Nearest {
    let [a, b, c] = corners;
    let doubled_area = (b - a).perp_dot(c - a);
    let edges = [(b, c), (c, a), (a, b)];
    // Twice the area that the point spans with each edge, positive inside.
    let spanned = edges.map(|(from, to)| (from - point).perp_dot(to - point) * doubled_area.signum());
    if doubled_area != 0.0 && spanned.iter().all(|&area| area >= 0.0) {
        let sum: f64 = spanned.iter().sum();
        let depths = [0, 1, 2].map(|k| spanned[k] / edges[k].0.distance(edges[k].1));
        return Nearest {
            weights: spanned.map(|area| area / sum),
            distance_squared: 0.0,
            depth: depths.into_iter().fold(f64::INFINITY, f64::min),
        };
    }
    let on_edges = [0, 1, 2].map(|k| nearest_on_edge(corners, k, point));
    on_edges.into_iter().min_by(|p, q| p.distance_squared.total_cmp(&q.distance_squared)).unwrap_or(on_edges[0])
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
    Nearest { weights, distance_squared, depth: 0.0 }
}
