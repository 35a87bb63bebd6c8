//! Which points lie beside which.

use crate::Error;

/// The neighbours of every point of a surface.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Neighbours {
    /// `[P + 1]`: where the neighbours of each point begin.
    starts: Vec<u32>,
    /// The neighbours of all points, of each point in rising order.
    points: Vec<u32>,
}

impl Neighbours {
    /// Points that share an edge of a triangle.
    ///
    /// # Errors
    /// [`Error::Triangle`] if a triangle names a point that does not exist.
    pub fn from_triangles(point_count: usize, triangles: &[[u32; 3]]) -> Result<Self, Error> {
        let mut pairs = Vec::with_capacity(6 * triangles.len());
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(&point) = corners.iter().find(|&&point| point as usize >= point_count) {
                return Err(Error::Triangle { triangle, point, point_count });
            }
            let [a, b, c] = *corners;
            pairs.extend([[a, b], [b, a], [b, c], [c, b], [c, a], [a, c]]);
        }
        Ok(Self::from_pairs(point_count, pairs))
    }

    /// Texels that share an edge; row-major, `height` rows of `width`.
    ///
    /// - `wraps`: whether the last column lies beside the first one, and the last row beside the first one
    #[must_use]
    pub fn grid(width: usize, height: usize, wraps: bool) -> Self {
        let at = |row: usize, column: usize| (row % height * width + column % width) as u32;
        let mut pairs = Vec::with_capacity(4 * width * height);
        for (row, column) in (0..height).flat_map(|row| (0..width).map(move |column| (row, column))) {
            let here = at(row, column);
            let right = (wraps || column + 1 < width).then(|| at(row, column + 1));
            let below = (wraps || row + 1 < height).then(|| at(row + 1, column));
            pairs.extend([right, below].into_iter().flatten().flat_map(|there| [[here, there], [there, here]]));
        }
        Self::from_pairs(width * height, pairs)
    }

    fn from_pairs(point_count: usize, mut pairs: Vec<[u32; 2]>) -> Self {
        pairs.retain(|[a, b]| a != b);
        pairs.sort_unstable();
        pairs.dedup();
        let mut starts = vec![0; point_count + 1];
        pairs.iter().for_each(|[a, _]| starts[*a as usize + 1] += 1);
        (0..point_count).for_each(|i| starts[i + 1] += starts[i]);
        Self { starts, points: pairs.into_iter().map(|[_, b]| b).collect() }
    }

    /// Number of points.
    #[must_use]
    pub fn point_count(&self) -> usize {
        self.starts.len() - 1
    }

    /// The neighbours of a point, in rising order.
    ///
    /// # Panics
    /// If there is no such point.
    #[must_use]
    pub fn of(&self, point: usize) -> &[u32] {
        &self.points[self.starts[point] as usize..self.starts[point + 1] as usize]
    }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    #[test]
    fn edges_of_triangles_join_their_ends() {
        let neighbours = Neighbours::from_triangles(6, &[[0, 1, 2], [2, 1, 3], [4, 4, 0]]).unwrap();
        let expected: [&[u32]; 6] = [&[1, 2, 4], &[0, 2, 3], &[0, 1, 3], &[1, 2], &[0], &[]];
        assert_eq!(neighbours.point_count(), 6);
        for (point, expected) in expected.into_iter().enumerate() {
            assert_eq!(neighbours.of(point), expected, "point {point}");
        }
        let error = Neighbours::from_triangles(3, &[[0, 1, 2], [0, 1, 3]]).unwrap_err();
        assert_eq!(error.to_string(), "triangle 1 names point 3; there are 3");
    }

    #[test]
    fn texels_have_four_sides() {
        let open = Neighbours::grid(3, 2, false);
        assert_eq!((open.of(0), open.of(1), open.of(5)), (&[1, 3][..], &[0, 2, 4][..], &[2, 4][..]));
        let tile = Neighbours::grid(4, 3, true);
        assert_eq!((tile.of(0), tile.of(11)), (&[1, 3, 4, 8][..], &[3, 7, 8, 10][..]));
        assert_eq!(Neighbours::grid(1, 1, true).of(0), &[] as &[u32]);
        assert_eq!(Neighbours::grid(0, 0, true).point_count(), 0);
    }
}
