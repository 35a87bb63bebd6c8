//! The height field: what is baked, checked once.

use glam::DVec3;

use crate::{Error, MeshSource};

/// A tile of relief that repeats in both directions.
///
/// Heights stand at the centres of the texels, `(column + ½)/width` and `(row + ½)/height` in texture coordinates; between them the
/// surface is two triangles for each square of four neighbouring centres, across the border of the tile too. The diagonal joins the
/// two corners whose heights differ less, so that mirrored fields have mirrored surfaces.
///
/// Lengths are in units of the tile's width: the tile is `1 × height/width`, x runs with u (columns), y with v (rows), z is up, and
/// row 0 lies at v = 0.
#[derive(Debug, Clone, PartialEq)]
pub struct HeightField {
    width: usize,
    height: usize,
    heights: Vec<f32>,
}

impl HeightField {
    /// Most texels of a field: 4,096 × 4,096.
    pub const MAX_TEXELS: usize = 1 << 24;
    /// Largest height, up or down, in units of the tile's width.
    pub const MAX_HEIGHT: f32 = 1e6;

    /// A field from its heights `[height, width]`, row after row.
    ///
    /// # Errors
    /// If a side is 0, there are more than [`MAX_TEXELS`](Self::MAX_TEXELS), their number is not `width · height`, or one is not a
    /// number or beyond [`MAX_HEIGHT`](Self::MAX_HEIGHT): the message names the first such texel.
    pub fn new(width: usize, height: usize, heights: Vec<f32>) -> Result<Self, Error> {
        let fail = |reason: String| Err(Error::HeightField(reason));
        match width.checked_mul(height) {
            None | Some(0) => return fail(format!("its size is {width} × {height}")),
            Some(count) if count > Self::MAX_TEXELS => {
                return fail(format!("{width} × {height} texels; at most {} are possible", Self::MAX_TEXELS));
            }
            Some(count) if count != heights.len() => {
                return fail(format!("{} heights for {width} × {height} texels", heights.len()));
            }
            Some(_) => (),
        }
        if let Some(bad) = heights.iter().position(|height| !(0.0..=Self::MAX_HEIGHT).contains(&height.abs())) {
            let (column, row, largest) = (bad % width, bad / width, Self::MAX_HEIGHT);
            return fail(format!(
                "the height in column {column}, row {row} is {}; it must lie between -{largest} and {largest}",
                heights[bad]
            ));
        }
        Ok(Self { width, height, heights })
    }

    /// Columns.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// Heights `[height, width]`, units of the tile's width.
    #[must_use]
    pub fn heights(&self) -> &[f32] {
        &self.heights
    }

    /// Number of texels.
    #[must_use]
    pub fn texel_count(&self) -> usize {
        self.heights.len()
    }

    /// The lowest and the highest height.
    #[must_use]
    pub fn range(&self) -> [f32; 2] {
        let lowest = self.heights.iter().copied().fold(f32::INFINITY, f32::min);
        [lowest, self.heights.iter().copied().fold(f32::NEG_INFINITY, f32::max)]
    }

    /// The number of the texel in a column and row, which wrap around.
    pub(super) fn texel(&self, column: i64, row: i64) -> usize {
        let wrap = |index: i64, size: usize| index.rem_euclid(size as i64) as usize;
        wrap(row, self.height) * self.width + wrap(column, self.width)
    }

    /// The four texels at the corners of a square of the lattice: columns `c` and `c + 1` of row `r`, then of row `r + 1`.
    pub(super) fn corners(&self, column: i64, row: i64) -> [usize; 4] {
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(right, up)| self.texel(column + right, row + up))
    }

    /// The two triangles of a square, each as three of its corners as [`corners`](Self::corners) numbers them, counter-clockwise.
    pub(super) fn split(&self, corners: [usize; 4]) -> [[usize; 3]; 2] {
        let [a, b, c, d] = corners.map(|texel| self.heights[texel]);
        if (a - d).abs() <= (b - c).abs() { RISING } else { FALLING }
    }

    /// The unit normal at a texel, from central differences: up, and against the slope.
    ///
    /// # Panics
    /// If there is no such texel.
    #[must_use]
    pub fn normal(&self, texel: usize) -> [f32; 3] {
        assert!(texel < self.texel_count(), "texel {texel} of {}", self.texel_count());
        let (column, row) = ((texel % self.width) as i64, (texel / self.width) as i64);
        let at = |column, row| f64::from(self.heights[self.texel(column, row)]);
        let per_texel = 0.5 * self.width as f64;
        let slope_x = (at(column + 1, row) - at(column - 1, row)) * per_texel;
        let slope_y = (at(column, row + 1) - at(column, row - 1)) * per_texel;
        DVec3::new(-slope_x, -slope_y, 1.0).normalize().as_vec3().to_array()
    }

    /// Where a texel lies on the surface: x, y, z.
    ///
    /// # Panics
    /// If there is no such texel.
    #[must_use]
    pub fn position(&self, texel: usize) -> [f64; 3] {
        let side = self.width as f64;
        let center = |index: usize| (index as f64 + 0.5) / side;
        [center(texel % self.width), center(texel / self.width), f64::from(self.heights[texel])]
    }

    /// Height of the surface at texture coordinates, which wrap around: exactly the surface that is traced.
    #[must_use]
    pub fn height_at(&self, u: f64, v: f64) -> f64 {
        let (x, y) = (u * self.width as f64 - 0.5, v * self.height as f64 - 0.5);
        let (column, row) = (x.floor(), y.floor());
        let corners = self.corners(column as i64, row as i64);
        let (x, y) = (x - column, y - row);
        let heights = corners.map(|texel| f64::from(self.heights[texel]));
        let second = if self.split(corners) == RISING { y > x } else { x + y > 1.0 };
        let [a, b, c, d] = heights;
        match (self.split(corners) == RISING, second) {
            (true, false) => a + (b - a) * x + (d - b) * y,
            (true, true) => a + (d - c) * x + (c - a) * y,
            (false, false) => a + (b - a) * x + (c - a) * y,
            (false, true) => d + (c - d) * (1.0 - x) + (b - d) * (1.0 - y),
        }
    }

    /// Three texels for each triangle of one tile, wrapping at its border: squares row after row, two triangles each.
    pub(super) fn tile_triangles(&self) -> Vec<[u32; 3]> {
        let squares = (0..self.height as i64).flat_map(|row| (0..self.width as i64).map(move |column| (column, row)));
        let texels = squares.map(|(column, row)| self.corners(column, row));
        texels.flat_map(|texels| self.split(texels).map(|corners| corners.map(|k| texels[k] as u32))).collect()
    }

    /// The surface of several tiles as a mesh: `tiles[0]` along x, `tiles[1]` along y.
    ///
    /// Vertices are the texel centres, `tiles[0] · width + 1` in a row, from the centre of the first texel of the first tile; they
    /// have the normals of [`normal`](Self::normal) and texture coordinates that go on growing from tile to tile.
    #[must_use]
    pub fn mesh(&self, tiles: [usize; 2]) -> MeshSource {
        let (columns, rows) = (tiles[0] * self.width, tiles[1] * self.height);
        let mut mesh = MeshSource::default();
        for row in 0..=rows {
            for column in 0..=columns {
                let texel = self.texel(column as i64, row as i64);
                let [x, y] = [column, row].map(|index| (index as f64 + 0.5) / self.width as f64);
                mesh.positions.push([x, y, f64::from(self.heights[texel])]);
                mesh.normals.push(self.normal(texel));
                mesh.uvs.push([x as f32, (y * self.width as f64 / self.height as f64) as f32]);
            }
        }
        for row in 0..rows {
            for column in 0..columns {
                let first = row * (columns + 1) + column;
                let vertices = [first, first + 1, first + columns + 1, first + columns + 2];
                let split = self.split(self.corners(column as i64, row as i64));
                mesh.triangles.extend(split.map(|corners| corners.map(|k| vertices[k] as u32)));
            }
        }
        mesh
    }
}

/// Triangles of a square whose diagonal runs from corner 0 to corner 3: below it, above it.
pub(super) const RISING: [[usize; 3]; 2] = [[0, 1, 3], [0, 3, 2]];
/// Triangles of a square whose diagonal runs from corner 1 to corner 2: below it, above it.
pub(super) const FALLING: [[usize; 3]; 2] = [[0, 1, 2], [1, 3, 2]];
