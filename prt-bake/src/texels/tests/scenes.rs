//! Small meshes with texture coordinates.

use std::f64::consts::TAU;

use glam::DVec3;

use super::mesh;
use crate::{Mesh, MeshSource};

/// A grid of `columns × rows` cells over the parameter square: `point` gives position and normal. `uv` lays the parameters out.
pub(super) fn grid(
    [columns, rows]: [u32; 2],
    point: impl Fn([f64; 2]) -> (DVec3, DVec3),
    uv: impl Fn([f64; 2]) -> [f64; 2],
) -> MeshSource {
    let mut source = MeshSource::default();
    for row in 0..=rows {
        for column in 0..=columns {
            let st = [f64::from(column) / f64::from(columns), f64::from(row) / f64::from(rows)];
            let (position, normal) = point(st);
            source.positions.push(position.to_array());
            source.normals.push(normal.as_vec3().to_array());
            source.uvs.push(uv(st).map(|x| x as f32));
            if column < columns && row < rows {
                let a = row * (columns + 1) + column;
                let [b, c, d] = [a + 1, a + columns + 2, a + columns + 1];
                source.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    source
}

/// Both meshes in one.
pub(super) fn together(mut first: MeshSource, second: MeshSource) -> MeshSource {
    let offset = first.positions.len() as u32;
    first.positions.extend(second.positions);
    first.normals.extend(second.normals);
    first.uvs.extend(second.uvs);
    first.triangles.extend(second.triangles.iter().map(|triangle| triangle.map(|vertex| vertex + offset)));
    first
}

/// The unit square at height `z`, facing up or down.
pub(super) fn square(cells: u32, z: f64, is_up: bool, uv: impl Fn([f64; 2]) -> [f64; 2]) -> MeshSource {
    let point = |[s, t]: [f64; 2]| match is_up {
        true => (DVec3::new(s, t, z), DVec3::Z),
        false => (DVec3::new(t, s, z), -DVec3::Z),
    };
    grid([cells, cells], point, uv)
}

/// Two facing squares 0.4 apart with a vertex at the centre of each texel of an atlas of `2 (cells + 1) × (cells + 1)`: the floor to the
/// left, the ceiling to the right.
pub(super) fn plates(cells: u32) -> Mesh {
    let size = f64::from(cells) + 1.0;
    let half = move |offset: f64| {
        move |st: [f64; 2]| {
            let [column, row] = st.map(|x| x * f64::from(cells) + 0.5);
            [(column + offset * size) / (2.0 * size), row / size]
        }
    };
    mesh(together(square(cells, 0.0, true, half(0.0)), square(cells, 0.4, false, half(1.0))))
}

/// The wall of a cylinder of radius 1 and height 1; it begins and ends at u = `left` and 1 − `left`.
pub(super) fn cylinder(cells: u32, left: f64) -> Mesh {
    let point = |[s, t]: [f64; 2]| {
        // The last column lies exactly on the first.
        let (sin, cos) = (TAU * (s % 1.0)).sin_cos();
        (DVec3::new(cos, sin, t), DVec3::new(cos, sin, 0.0))
    };
    mesh(grid([cells, 1], point, |[s, t]| [left + s * (1.0 - 2.0 * left), t]))
}

/// A torus of radii 1 and 0.4, whose inside is shadowed, laid over the whole atlas but for a margin.
pub(super) fn torus([columns, rows]: [u32; 2], margin: f64) -> Mesh {
    let point = |[s, t]: [f64; 2]| {
        let ((sin_s, cos_s), (sin_t, cos_t)) = ((TAU * (s % 1.0)).sin_cos(), (TAU * (t % 1.0)).sin_cos());
        let normal = DVec3::new(cos_s * cos_t, sin_s * cos_t, sin_t);
        (DVec3::new(cos_s, sin_s, 0.0) + 0.4 * normal, normal)
    };
    mesh(grid([columns, rows], point, |st| st.map(|x| margin + x * (1.0 - 2.0 * margin))))
}

/// A floor over the lower half of the atlas, and a closed box that stands in its middle third and reaches through it.
pub(super) fn sunken_box() -> Mesh {
    let floor = square(6, 0.0, true, |[s, t]| [s, 0.5 * t]);
    let corner = |k: usize, low: f64, high: f64| if k == 1 { high } else { low };
    let place = |k: usize| [corner(k & 1, 0.34, 0.66), corner(k >> 1 & 1, 0.34, 0.66), corner(k >> 2, -0.3, 0.3)];
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let mut cube = MeshSource::default();
    for (side, corners) in sides.into_iter().enumerate() {
        let [p, q, r] = [0, 1, 2].map(|k| DVec3::from_array(place(corners[k])));
        let normal = (q - p).cross(r - p).normalize().as_vec3().to_array();
        let first = cube.positions.len() as u32;
        cube.positions.extend(corners.map(place));
        cube.normals.extend([normal; 4]);
        let left = side as f32 / 6.0;
        cube.uvs.extend([[0.0, 0.6], [0.1, 0.6], [0.1, 0.9], [0.0, 0.9]].map(|[u, v]| [left + 0.02 + u, v]));
        cube.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    mesh(together(floor, cube))
}

/// A slanting square whose normals make it bulge 0.2 in its middle, and `gap` above it a parallel roof four times as wide.
pub(super) fn roofed_square(gap: f64) -> Mesh {
    let (slope, normal) = (DVec3::new(0.8, 0.0, 0.6), DVec3::new(-0.6, 0.0, 0.8));
    let bulge = |s: f64| (normal + 0.5 * (2.0 * s - 1.0) * slope).normalize();
    let floor = grid([1, 1], |[s, t]| (s * slope + t * DVec3::Y, bulge(s)), |[s, t]| [0.5 * s, t]);
    let roof = |[s, t]: [f64; 2]| ((2.5 - 4.0 * t) * slope + (4.0 * s - 1.5) * DVec3::Y + gap * normal, -normal);
    let roof = grid([1, 1], roof, |[s, t]| [0.6 + 0.4 * s, t]);
    mesh(together(floor, roof))
}

/// A long groove whose walls, 1 wide, enclose an angle of air. They meet at u = 0.25, one in the upper, one in the lower part of the atlas.
pub(super) fn groove(angle: f64) -> Mesh {
    let (sin, cos) = angle.sin_cos();
    let floor = |[s, t]: [f64; 2]| (DVec3::new(s, 40.0 * t, 0.0), DVec3::Z);
    let wall = |[s, t]: [f64; 2]| (DVec3::new(s * cos, 40.0 * (1.0 - t), s * sin), DVec3::new(sin, 0.0, -cos));
    let at = |v: f64| move |[s, t]: [f64; 2]| [0.25 + 0.5 * s, v + 0.4 * t];
    mesh(together(grid([1, 1], floor, at(0.0)), grid([1, 1], wall, at(0.6))))
}
