//! A head, by formula: an ellipsoid of directions, pushed in and out. Faces +z, y is up.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use prt_bake::MeshSource;

/// A soft bump or dent about a direction: how far out, and how sharp.
struct Feature {
    towards: [f64; 3],
    by: f64,
    sharpness: f64,
}

/// On both sides of the face.
const PAIRS: [Feature; 6] = [
    // Eye sockets, eyeballs, brows, cheeks, ears, temples.
    Feature { towards: [0.34, 0.16, 1.0], by: -0.17, sharpness: 34.0 },
    Feature { towards: [0.34, 0.15, 1.0], by: 0.10, sharpness: 110.0 },
    Feature { towards: [0.36, 0.40, 1.0], by: 0.07, sharpness: 60.0 },
    Feature { towards: [0.52, -0.18, 0.9], by: 0.07, sharpness: 26.0 },
    Feature { towards: [1.0, 0.02, -0.05], by: 0.22, sharpness: 42.0 },
    Feature { towards: [0.9, 0.35, 0.5], by: -0.05, sharpness: 14.0 },
];
/// In the middle.
const MIDDLE: [Feature; 7] = [
    // Nose: bridge and tip; upper and lower lip, the line between them, chin, the hollow of the neck.
    Feature { towards: [0.0, 0.18, 1.0], by: 0.10, sharpness: 60.0 },
    Feature { towards: [0.0, -0.10, 1.0], by: 0.34, sharpness: 70.0 },
    Feature { towards: [0.0, -0.40, 1.0], by: 0.10, sharpness: 90.0 },
    Feature { towards: [0.0, -0.56, 1.0], by: 0.09, sharpness: 90.0 },
    Feature { towards: [0.0, -0.485, 1.0], by: -0.09, sharpness: 300.0 },
    Feature { towards: [0.0, -0.85, 0.9], by: 0.13, sharpness: 34.0 },
    Feature { towards: [0.0, -1.0, 0.32], by: -0.20, sharpness: 16.0 },
];

/// Columns around and rows from below upwards: 17,000 vertices.
const COLUMNS: usize = 136;
const ROWS: usize = 126;

/// The mesh, closed, 2 high, its faces turned outwards.
pub(super) fn head() -> MeshSource {
    let mut source = MeshSource::default();
    source.positions.push(point(DVec3::NEG_Y).to_array());
    for row in 1..ROWS {
        let (sin, cos) = (PI * row as f64 / ROWS as f64).sin_cos();
        for column in 0..COLUMNS {
            let (x, z) = (TAU * column as f64 / COLUMNS as f64).sin_cos();
            source.positions.push(point(DVec3::new(sin * x, -cos, sin * z)).to_array());
        }
    }
    source.positions.push(point(DVec3::Y).to_array());
    let top = (source.positions.len() - 1) as u32;
    let vertex = |row: usize, column: usize| (1 + (row - 1) * COLUMNS + column % COLUMNS) as u32;
    for column in 0..COLUMNS {
        source.triangles.push([0, vertex(1, column + 1), vertex(1, column)]);
        source.triangles.push([top, vertex(ROWS - 1, column), vertex(ROWS - 1, column + 1)]);
        for row in 1..ROWS - 1 {
            let [a, b] = [vertex(row, column), vertex(row, column + 1)];
            let [c, d] = [vertex(row + 1, column + 1), vertex(row + 1, column)];
            source.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    source
}

/// The surface in a direction.
fn point(direction: DVec3) -> DVec3 {
    let mirrored = DVec3::new(-direction.x, direction.y, direction.z);
    let push = |features: &[Feature], direction: DVec3| -> f64 {
        let of = |feature: &Feature| {
            let nearness = direction.dot(DVec3::from_array(feature.towards).normalize());
            feature.by * (feature.sharpness * (nearness - 1.0)).exp()
        };
        features.iter().map(of).sum()
    };
    let radius = 1.0 + push(&MIDDLE, direction) + push(&PAIRS, direction) + push(&PAIRS, mirrored);
    let skull = DVec3::new(0.70, 1.0, 0.82) * (radius * direction);
    // Narrower towards the neck, which goes straight down.
    let low = (-skull.y - 0.35).max(0.0);
    skull * DVec3::new(1.0 - 0.25 * low, 1.0, 1.0 - 0.25 * low)
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use prt_bake::{Mesh, MeshOptions};

    #[test]
    fn the_head_is_closed_and_turned_outwards() {
        let source = head();
        let corner = |v: u32| DVec3::from_array(source.positions[v as usize]);
        let volume: f64 =
            source.triangles.iter().map(|t| corner(t[0]).dot(corner(t[1]).cross(corner(t[2]))) / 6.0).sum();
        assert!((1.5..4.0).contains(&volume), "{volume}");
        let (mesh, report) = Mesh::new(source, &MeshOptions::default()).unwrap();
        assert_eq!(report.faces_dropped(), 0);
        assert!((16_000..19_000).contains(&mesh.positions().len()));
    }
}
