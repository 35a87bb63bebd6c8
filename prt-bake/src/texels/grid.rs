//! The texels of an atlas as places.

use glam::DVec2;

/// Rows and columns of texels, and whether opposite edges touch.
///
/// Places are in texels: `(0, 0)` is the corner of the texel in column 0 and row 0, whose centre is `(½, ½)`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Grid {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Along columns and rows.
    pub(super) wraps: [bool; 2],
    /// Whether v = 0 is below the last row, not above the first.
    pub(super) v_up: bool,
}

impl Grid {
    #[cfg(feature = "trace")]
    pub(super) fn texel_count(&self) -> usize {
        self.width * self.height
    }

    pub(super) fn size(&self) -> DVec2 {
        DVec2::new(self.width as f64, self.height as f64)
    }

    /// The place of a texture coordinate.
    pub(super) fn place(&self, uv: [f32; 2]) -> DVec2 {
        let [u, v] = uv.map(f64::from);
        DVec2::new(u, if self.v_up { 1.0 - v } else { v }) * self.size()
    }

    /// The centre of a texel.
    #[cfg(feature = "trace")]
    pub(super) fn center(&self, texel: usize) -> DVec2 {
        DVec2::new((texel % self.width) as f64 + 0.5, (texel / self.width) as f64 + 0.5)
    }

    /// The number of the texel in a column and row; outside of the atlas the one on the other side, where it wraps round.
    pub(super) fn texel(&self, column: i64, row: i64) -> Option<usize> {
        let [column, row] = [(column, self.width, self.wraps[0]), (row, self.height, self.wraps[1])].map(inside);
        Some(row? * self.width + column?)
    }

    /// The texels of a bilinear lookup and their weights. At an edge that does not wrap round the outermost texel counts twice.
    pub(super) fn bilinear(&self, place: DVec2) -> [(usize, f64); 4] {
        let corner = (place - 0.5).floor();
        let share = place - 0.5 - corner;
        let limit = self.size() - 1.0;
        let axis = |at: f64, limit: f64, wraps: bool| if wraps { at as i64 } else { at.clamp(0.0, limit) as i64 };
        [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(dx, dy)| {
            let column = axis(corner.x + dx, limit.x, self.wraps[0]);
            let row = axis(corner.y + dy, limit.y, self.wraps[1]);
            let weight = (1.0 - dx - share.x).abs() * (1.0 - dy - share.y).abs();
            (self.texel(column, row).unwrap_or_default(), weight)
        })
    }
}

fn inside((at, size, wraps): (i64, usize, bool)) -> Option<usize> {
    let at = if wraps { at.rem_euclid(size as i64) } else { at };
    usize::try_from(at).ok().filter(|&at| at < size)
}
