//! Which corners of a polygon lie near a triangle.

use glam::DVec2;

/// Most grid cells along one axis: 2^20 cells keep a large polygon's cells at about one corner each.
const MAX_CELLS_PER_AXIS: usize = 1024;

/// How far beyond its border a cell counts, in cells: well above rounding, and next to nothing.
const CELL_MARGIN: f64 = 1e-3;

/// Some corners of a polygon, sorted into the cells of a regular grid over their bounding box.
#[derive(Debug, Default)]
pub(super) struct CornerGrid {
    low: DVec2,
    cells_per_unit: DVec2,
    cells_per_axis: usize,
    /// Where each cell begins in `items`, and the end.
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl CornerGrid {
    /// Replaces the members.
    ///
    /// - `members`: indices into `points`
    pub(super) fn fill(&mut self, points: &[DVec2], members: impl Iterator<Item = u32> + Clone) {
        let count = members.clone().count();
        let (low, high) = members
            .clone()
            .map(|i| points[i as usize])
            .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), point| (low.min(point), high.max(point)));
        self.cells_per_axis = count.isqrt().clamp(1, MAX_CELLS_PER_AXIS);
        self.low = if count == 0 { DVec2::ZERO } else { low };
        let extent = if count == 0 { DVec2::ONE } else { high - low };
        self.cells_per_unit =
            (self.cells_per_axis as f64 / extent).map(|scale| if scale.is_finite() { scale } else { 0.0 });
        self.sort(points, members);
    }

    /// How many members there are.
    pub(super) fn len(&self) -> usize {
        self.items.len()
    }

    /// Counting sort by cell.
    fn sort(&mut self, points: &[DVec2], members: impl Iterator<Item = u32> + Clone) {
        self.starts = vec![0; self.cells_per_axis * self.cells_per_axis + 1];
        for i in members.clone() {
            let cell = self.cell_of(points[i as usize]);
            self.starts[cell + 1] += 1;
        }
        for cell in 1..self.starts.len() {
            self.starts[cell] += self.starts[cell - 1];
        }
        let mut fill = self.starts.clone();
        self.items = vec![0; fill.last().map_or(0, |&end| end as usize)];
        for i in members {
            let slot = &mut fill[self.cell_of(points[i as usize])];
            self.items[*slot as usize] = i;
            *slot += 1;
        }
    }

    /// Column and row; a point outside goes to the nearest cell (a cast from float saturates).
    fn column_row(&self, point: DVec2) -> (usize, usize) {
        let scaled = (point - self.low) * self.cells_per_unit;
        let last = self.cells_per_axis - 1;
        ((scaled.x as usize).min(last), (scaled.y as usize).min(last))
    }

    fn cell_of(&self, point: DVec2) -> usize {
        let (column, row) = self.column_row(point);
        row * self.cells_per_axis + column
    }

    /// The cells that a triangle touches, and perhaps a few beside it; row by row, so that a long thin one has few.
    pub(super) fn cells_over(&self, triangle: [DVec2; 3]) -> impl Iterator<Item = usize> {
        let [a, b, c] = triangle;
        let (_, bottom) = self.column_row(a.min(b).min(c));
        let (_, top) = self.column_row(a.max(b).max(c));
        (bottom..=top).flat_map(move |row| {
            let edge = |row: f64| self.low.y + row / self.cells_per_unit.y;
            let (below, above) = (edge(row as f64 - CELL_MARGIN), edge((row + 1) as f64 + CELL_MARGIN));
            // In a grid without height the edges are not finite, and the whole triangle counts.
            let (left, right) = span_between(triangle, below.max(f64::MIN), above.min(f64::MAX));
            let margin = CELL_MARGIN / self.cells_per_unit.x;
            let (first, _) = self.column_row(DVec2::new(left - margin, below));
            let (last, _) = self.column_row(DVec2::new(right + margin, below));
            (first..=last).map(move |column| row * self.cells_per_axis + column)
        })
    }

    /// The members in a cell.
    pub(super) fn members(&self, cell: usize) -> &[u32] {
        &self.items[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }
}

/// The range of x that a triangle takes between two heights; the whole of it if rounding leaves none.
fn span_between(triangle: [DVec2; 3], below: f64, above: f64) -> (f64, f64) {
    let [a, b, c] = triangle;
    let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
    for (p, q) in [(a, b), (b, c), (c, a)] {
        let (low, high) = if p.y <= q.y { (p, q) } else { (q, p) };
        if high.y < below || low.y > above {
            continue;
        }
        let x_at = |y: f64| {
            let share = (y - low.y) / (high.y - low.y);
            if share.is_finite() { low.x + share * (high.x - low.x) } else { low.x }
        };
        let ends = if low.y == high.y { [low.x, high.x] } else { [x_at(below.max(low.y)), x_at(above.min(high.y))] };
        left = left.min(ends[0]).min(ends[1]);
        right = right.max(ends[0]).max(ends[1]);
    }
    if left <= right { (left, right) } else { (a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x)) }
}
