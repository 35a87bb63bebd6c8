use glam::DVec2;
use proptest::prelude::*;

use crate::texels::triangle::{covered_share, nearest};

fn point() -> impl Strategy<Value = DVec2> {
    (-20.0..20.0, -20.0..20.0).prop_map(|(x, y)| DVec2::new(x, y))
}

proptest! {
    /// The nearest point `q` of a convex set is the one from which no part of the set lies towards `p`: `(p − q)·(c − q) ≤ 0` for all `c`.
    #[test]
    fn the_nearest_point_is_the_projection(a in point(), b in point(), c in point(), p in point(), flat in 0_usize..4) {
        let corners = match flat {
            0 => [a, b, a.lerp(b, 0.3)],
            1 => [a, a, a],
            _ => [a, b, c],
        };
        let found = nearest(corners, p);
        let q = found.weights[0] * corners[0] + found.weights[1] * corners[1] + found.weights[2] * corners[2];
        prop_assert!(found.weights.iter().all(|&weight| weight >= 0.0));
        prop_assert!((found.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        // Rounding of products of lengths up to 60.
        prop_assert!((q.distance_squared(p) - found.distance_squared).abs() < 1e-9);
        prop_assert!(corners.iter().all(|&corner| (p - q).dot(corner - q) < 1e-9));
    }

    /// Triangles around a point cover its surroundings once, wherever it lies in one of them.
    #[test]
    fn shares_of_a_fan_add_up_to_one(angles in prop::collection::vec(0.2..1.5, 5), radius in 1.0..9.0, turn in 0.0..6.0, at in 0_usize..4) {
        let scale = std::f64::consts::TAU / angles.iter().sum::<f64>();
        prop_assume!(angles.iter().all(|angle| angle * scale < 2.5));
        let mut direction = turn;
        let rim: Vec<DVec2> = angles.iter().map(|angle| {
            direction += angle * scale;
            radius * DVec2::from_angle(direction)
        }).collect();
        let inner = (rim[0] + rim[1]) / 3.0;
        let point = [DVec2::ZERO, 0.5 * rim[0], inner, 3.0 * rim[0]][at];
        let faces = (0..5).map(|k| [DVec2::ZERO, rim[k], rim[(k + 1) % 5]]);
        // Faces may run either way round.
        let faces = faces.enumerate().map(|(k, [a, b, c])| if k % 2 == 0 { [a, b, c] } else { [c, b, a] });
        let sum: f64 = faces.map(|face| covered_share(face, point, 1e-6)).sum();
        let expected = if at == 3 { 0.0 } else { 1.0 };
        prop_assert!((sum - expected).abs() < 1e-9, "{sum}");
    }
}
