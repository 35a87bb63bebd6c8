//! Smooth surfaces of our own to lay textures on, as grids of any fineness and with the relief of a texture raised on them.

use std::f64::consts::TAU;

use glam::DVec3;
use prt_bake::MeshSource;

/// A parametric surface over the unit square; u runs around, v upwards. Texture coordinates run down.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum BaseSurface {
    /// A flat square of side 2, facing +z.
    Patch,
    /// A cylinder of radius 0.5 and height 2.
    Cylinder,
    /// The outer wall of a vase of height 2.
    Vase,
}

impl BaseSurface {
    /// Columns and rows of a grid that shows the surface smooth and has a vertex for each texel of a texture, as far as it stays of moderate
    /// size.
    pub(crate) fn cells(repeat: [usize; 2], texels: [usize; 2]) -> [usize; 2] {
        const SMOOTH: [usize; 2] = [160, 96];
        /// A quarter of a million vertices.
        const MOST: [usize; 2] = [640, 400];
        std::array::from_fn(|axis| {
            let tiles = repeat[axis].max(1);
            let per_tile = (MOST[axis] / tiles).clamp(1, texels[axis].max(1));
            (tiles * per_tile).max(SMOOTH[axis])
        })
    }

    /// Tiles along u and v that are about square, for about `count` of them around.
    pub(crate) fn repeat(self, count: usize) -> [usize; 2] {
        let along = match self {
            Self::Patch => count as f64,
            // Height over circumference.
            Self::Cylinder => count as f64 * 2.0 / (TAU * 0.5),
            Self::Vase => count as f64 * 2.0 / (TAU * 0.6),
        };
        [count.max(1), (along.round() as usize).max(1)]
    }

    /// Whether the edges u = 0 and u = 1 are one.
    fn is_round(self) -> bool {
        self != Self::Patch
    }

    fn point(self, [u, v]: [f64; 2]) -> DVec3 {
        let turned = |radius: f64, height: f64| {
            let (sin, cos) = (TAU * u).sin_cos();
            DVec3::new(radius * sin, height, radius * cos)
        };
        match self {
            Self::Patch => DVec3::new(2.0 * u - 1.0, 2.0 * v - 1.0, 0.0),
            Self::Cylinder => turned(0.5, 2.0 * v - 1.0),
            Self::Vase => turned(vase_radius(v), 2.0 * v - 1.0),
        }
    }

    /// Derivatives along u and v, by central differences.
    fn tangents(self, [u, v]: [f64; 2]) -> [DVec3; 2] {
        const STEP: f64 = 1e-5;
        let difference = |du: f64, dv: f64| self.point([u + du, v + dv]) - self.point([u - du, v - dv]);
        [difference(STEP, 0.0), difference(0.0, STEP)].map(|difference| difference / (2.0 * STEP))
    }

    fn normal(self, uv: [f64; 2]) -> DVec3 {
        let [along_u, along_v] = self.tangents(uv);
        along_u.cross(along_v).normalize()
    }

    /// The surface as a grid of `columns` × `rows` cells, with texture coordinates 0 to 1 and exact normals.
    pub(crate) fn grid(self, [columns, rows]: [usize; 2]) -> MeshSource {
        let mut source = self.relief([columns, rows], [1, 1], |_| 0.0);
        let uv = |place: &[f32; 2]| [f64::from(place[0]), 1.0 - f64::from(place[1])];
        source.normals = source.uvs.iter().map(|place| self.normal(uv(place)).as_vec3().to_array()).collect();
        source
    }

    /// The surface with the relief of a texture raised along its normals, as a grid without normals.
    ///
    /// Texture coordinates run down as in glTF, so that an image stands upright: v is 0 at the upper edge.
    ///
    /// - `repeat`: tiles along u and v
    /// - `height`: of a place in tiles, in units of the width that a tile has there
    pub(crate) fn relief(
        self,
        [columns, rows]: [usize; 2],
        repeat: [usize; 2],
        height: impl Fn([f64; 2]) -> f64,
    ) -> MeshSource {
        let mut source = MeshSource::default();
        for row in 0..=rows {
            for column in 0..=columns {
                let uv = [column as f64 / columns as f64, row as f64 / rows as f64];
                let [along_u, along_v] = self.tangents(uv);
                let tile_width = along_u.length() / repeat[0] as f64;
                let place = [uv[0], 1.0 - uv[1]];
                let raised = tile_width * height([place[0] * repeat[0] as f64, place[1] * repeat[1] as f64]);
                let point = self.point(uv) + raised * along_u.cross(along_v).normalize();
                source.positions.push(point.to_array());
                source.uvs.push(place.map(|x| x as f32));
            }
        }
        if self.is_round() {
            close_seam(&mut source.positions, columns + 1);
        }
        source.triangles = cells(columns, rows);
        source
    }
}

/// Makes the last column of a grid lie exactly on its first.
fn close_seam(positions: &mut [[f64; 3]], row_length: usize) {
    for row in positions.chunks_exact_mut(row_length) {
        row[row_length - 1] = row[0];
    }
}

/// Two triangles for each cell of a grid of `(columns + 1) × (rows + 1)` vertices, u × v towards the viewer.
fn cells(columns: usize, rows: usize) -> Vec<[u32; 3]> {
    let vertex = |column: usize, row: usize| (row * (columns + 1) + column) as u32;
    let cell = |column: usize, row: usize| {
        let [a, b] = [vertex(column, row), vertex(column + 1, row)];
        let [c, d] = [vertex(column + 1, row + 1), vertex(column, row + 1)];
        [[a, b, c], [a, c, d]]
    };
    (0..rows).flat_map(|row| (0..columns).flat_map(move |column| cell(column, row))).collect()
}

/// Radius of the vase: belly, neck, lip.
fn vase_radius(v: f64) -> f64 {
    0.5 + 0.3 * (TAU * (0.8 * v - 0.05)).sin() - 0.12 * v
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use prt_bake::{Mesh, MeshOptions};

    const ALL: [BaseSurface; 3] = [BaseSurface::Patch, BaseSurface::Cylinder, BaseSurface::Vase];

    #[test]
    fn faces_and_normals_look_outwards() {
        for surface in ALL {
            let source = surface.grid([24, 16]);
            let corner = |v: u32| DVec3::from_array(source.positions[v as usize]);
            for &[a, b, c] in &source.triangles {
                let face = (corner(b) - corner(a)).cross(corner(c) - corner(a)).normalize();
                let normal = glam::Vec3::from_array(source.normals[a as usize]).as_dvec3();
                assert!(face.dot(normal) > 0.8, "{surface:?}");
                let outwards =
                    if surface == BaseSurface::Patch { DVec3::Z } else { corner(a) * DVec3::new(1.0, 0.0, 1.0) };
                assert!(normal.dot(outwards) > 0.0, "{surface:?}");
            }
            let (_, report) = Mesh::new(source, &MeshOptions::default()).unwrap();
            assert_eq!(report.faces_dropped(), 0);
        }
    }

    #[test]
    fn relief_is_raised_along_the_normal() {
        for surface in ALL {
            let repeat = [4, 2];
            let raised = surface.relief([12, 8], repeat, |[u, _]| 0.1 * (TAU * u).cos());
            let flat = surface.grid([12, 8]);
            for (i, (low, high)) in flat.positions.iter().zip(&raised.positions).enumerate() {
                let along = DVec3::from_array(*high) - DVec3::from_array(*low);
                let [u, v] = flat.uvs[i].map(f64::from);
                let tile = surface.tangents([u, 1.0 - v])[0].length() / 4.0;
                let expected = 0.1 * tile * (TAU * 4.0 * u).cos();
                let normal = glam::Vec3::from_array(flat.normals[i]).as_dvec3();
                assert!((along - expected * normal).length() < 1e-6, "{surface:?}");
            }
        }
    }

    #[test]
    fn tiles_are_about_square() {
        for surface in ALL {
            let [columns, rows] = surface.repeat(8);
            let [along_u, along_v] = surface.tangents([0.5, 0.5]).map(|tangent| tangent.length());
            let (width, height) = (along_u / columns as f64, along_v / rows as f64);
            assert!((0.6..1.6).contains(&(width / height)), "{surface:?}: {width} × {height}");
        }
    }
}
