//! Rays against the surface of a height field, from either side.

use glam::{DVec2, DVec3};

use super::field::{HeightField, RISING};

/// A ray is given up after so many squares of the lattice: one that rises by less than a 65,536th of the relief's height (in sides of
/// a texel) on the way through one.
const MAX_SQUARES: usize = 1 << 16;

/// A ray has crossed the surface once it is this far on the other side of it, in units of the relief's height plus one texel: 10,000
/// times the rounding of `f64`.
const TOLERANCE: f64 = 1e-12;

/// Rays are followed this far above and below the relief, in the same unit, so that a crossing at its highest and lowest point is seen.
const MARGIN: f64 = 1e-3;

/// A side of the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    Above,
    Below,
}

/// A height field prepared for tracing.
///
/// In its frame the texel in column c and row r stands at (c, r), lengths are in sides of a texel, and the lowest texel is at z = 0.
#[derive(Debug)]
pub(super) struct Surface {
    columns: usize,
    rows: usize,
    /// The squares between texels; square (c, r) is to the right of and above texel (c, r).
    squares: Vec<Square>,
    /// Height of the highest texel.
    pub(super) top: f64,
    lowest: f64,
    tolerance: f64,
}

#[derive(Debug, Clone, Copy)]
struct Square {
    planes: [Plane; 2],
    is_rising: bool,
}

/// Height `base + slope · p` above a point `p` of a square, counted from its corner 0.
#[derive(Debug, Clone, Copy)]
struct Plane {
    base: f64,
    slope: DVec2,
}

/// A point of the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SurfacePoint {
    /// Number of the triangle, as [`HeightField::tile_triangles`] counts.
    pub(super) triangle: usize,
    /// Weights of the triangle's second and third corner.
    pub(super) barycentric: [f32; 2],
    /// Upward unit normal of the triangle.
    pub(super) normal: DVec3,
}

/// How far a ray comes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reach {
    pub(super) distance: f64,
    /// Where it crosses the surface; `None` where it does not before its limit, or is given up before.
    pub(super) point: Option<SurfacePoint>,
}

impl Surface {
    pub(super) fn new(field: &HeightField) -> Self {
        let [lowest, highest] = field.range().map(f64::from);
        let scale = field.width() as f64;
        let lattice_height = |texel: usize| (f64::from(field.heights()[texel]) - lowest) * scale;
        let square = |number: usize| {
            let corners = field.corners((number % field.width()) as i64, (number / field.width()) as i64);
            Square::new(corners.map(lattice_height), field.split(corners) == RISING)
        };
        let top = (highest - lowest) * scale;
        Self {
            columns: field.width(),
            rows: field.height(),
            squares: (0..field.texel_count()).map(square).collect(),
            top,
            lowest,
            tolerance: TOLERANCE * (1.0 + top),
        }
    }

    /// Where a texel stands.
    pub(super) fn texel(&self, texel: usize, height: f32) -> DVec3 {
        let (column, row) = (texel % self.columns, texel / self.columns);
        DVec3::new(column as f64, row as f64, self.lattice_z(f64::from(height)))
    }

    /// A height of the field, in units of the tile's width, in this frame.
    pub(super) fn lattice_z(&self, height: f64) -> f64 {
        (height - self.lowest) * self.columns as f64
    }

    /// A point of the surface in the square of a texel, `offset` from the texel in x and y.
    pub(super) fn point_of_texel(&self, texel: usize, offset: [f64; 2]) -> (DVec3, SurfacePoint) {
        let center = DVec2::new((texel % self.columns) as f64, (texel / self.columns) as f64);
        let at = center + DVec2::from_array(offset);
        let corner = at.floor();
        let local = at - corner;
        let column = (corner.x as i64).rem_euclid(self.columns as i64) as usize;
        let row = (corner.y as i64).rem_euclid(self.rows as i64) as usize;
        let number = row * self.columns + column;
        let half = self.squares[number].half(local);
        let plane = self.squares[number].planes[half];
        (at.extend(plane.base + plane.slope.dot(local)), self.squares[number].point(number, half, local))
    }

    /// Sides of a texel in the tile's width.
    pub(super) fn width(&self) -> f64 {
        self.columns as f64
    }

    /// The same point of the tile nearest to the origin.
    pub(super) fn wrap(&self, point: DVec3) -> DVec3 {
        let (width, depth) = (self.columns as f64, self.rows as f64);
        DVec3::new(point.x - width * (point.x / width).floor(), point.y - depth * (point.y / depth).floor(), point.z)
    }

    /// Follows a ray that begins on one side of the surface, or on it, until it is on the other or has gone as far as `limit`.
    ///
    /// Along the ray the height above the surface is linear in every triangle, so its sign where the ray leaves the triangle tells of a
    /// crossing: neighbours agree there, and no ray slips through between two of them.
    pub(super) fn follow(&self, origin: DVec3, direction: DVec3, limit: f64, side: Side) -> Reach {
        let Some([mut from, end]) = self.span_in_relief(origin, direction, limit) else {
            return Reach { distance: limit, point: None };
        };
        let mut lattice = LatticeWalk::new(self, origin, direction, from);
        for _ in 0..MAX_SQUARES {
            let to = lattice.exit().min(end);
            let ray = LocalRay { origin: lattice.local(origin), direction, from, to };
            let number = lattice.row * self.columns + lattice.column;
            if let Some(reach) = ray.crossing(&self.squares[number], number, side, self.tolerance) {
                return reach;
            }
            if to >= end {
                return Reach { distance: limit, point: None };
            }
            from = to;
            lattice.step();
        }
        Reach { distance: from, point: None }
    }

    /// The part of a ray at heights where there is relief.
    fn span_in_relief(&self, origin: DVec3, direction: DVec3, limit: f64) -> Option<[f64; 2]> {
        let margin = MARGIN * (1.0 + self.top);
        let (low, high) = (-margin, self.top + margin);
        if direction.z == 0.0 {
            return (low..=high).contains(&origin.z).then_some([0.0, limit]);
        }
        let (a, b) = ((low - origin.z) / direction.z, (high - origin.z) / direction.z);
        let (start, end) = (a.min(b).max(0.0), a.max(b).min(limit));
        (start < end).then_some([start, end])
    }
}

impl Square {
    fn new([a, b, c, d]: [f64; 4], is_rising: bool) -> Self {
        let plane = |base, x, y| Plane { base, slope: DVec2::new(x, y) };
        let planes = if is_rising {
            [plane(a, b - a, d - b), plane(a, d - c, c - a)]
        } else {
            [plane(a, b - a, c - a), plane(b + c - d, d - c, d - b)]
        };
        Self { planes, is_rising }
    }

    /// How far a point is beyond the diagonal: positive in triangle 1.
    fn beyond_diagonal(&self, p: DVec2) -> f64 {
        if self.is_rising { p.y - p.x } else { p.x + p.y - 1.0 }
    }

    fn half(&self, p: DVec2) -> usize {
        usize::from(self.beyond_diagonal(p) > 0.0)
    }

    fn point(&self, number: usize, half: usize, p: DVec2) -> SurfacePoint {
        let barycentric = match (self.is_rising, half) {
            (true, 0) => [p.x - p.y, p.y],
            (true, _) => [p.x, p.y - p.x],
            (false, 0) => [p.x, p.y],
            (false, _) => [p.x + p.y - 1.0, 1.0 - p.x],
        };
        let normal = (-self.planes[half].slope).extend(1.0).normalize();
        SurfacePoint { triangle: 2 * number + half, barycentric: barycentric.map(|weight| weight as f32), normal }
    }
}

/// The part of a ray within a square; the origin is counted from the square's corner 0.
#[derive(Debug)]
struct LocalRay {
    origin: DVec3,
    direction: DVec3,
    from: f64,
    to: f64,
}

impl LocalRay {
    fn crossing(&self, square: &Square, number: usize, side: Side, tolerance: f64) -> Option<Reach> {
        let beyond = |distance: f64| square.beyond_diagonal(self.at(distance));
        let (first, last) = (beyond(self.from), beyond(self.to));
        let reach = |half, from, to| {
            let distance = self.crossing_of_plane(&square.planes[half], [from, to], side, tolerance)?;
            Some(Reach { distance, point: Some(square.point(number, half, self.at(distance))) })
        };
        let half = |beyond: f64| usize::from(beyond > 0.0);
        if half(first) == half(last) {
            return reach(half(first), self.from, self.to);
        }
        let middle = self.from + (self.to - self.from) * (first / (first - last));
        reach(half(first), self.from, middle).or_else(|| reach(half(last), middle, self.to))
    }

    fn at(&self, distance: f64) -> DVec2 {
        (self.origin + distance * self.direction).truncate()
    }

    fn crossing_of_plane(&self, plane: &Plane, [from, to]: [f64; 2], side: Side, tolerance: f64) -> Option<f64> {
        let sign = if side == Side::Above { 1.0 } else { -1.0 };
        let start = sign * (self.origin.z - plane.base - plane.slope.dot(self.origin.truncate()));
        let slope = sign * (self.direction.z - plane.slope.dot(self.direction.truncate()));
        let (gap_from, gap_to) = (start + slope * from, start + slope * to);
        (gap_to < -tolerance).then(|| {
            let gap = gap_from.max(0.0);
            from + (to - from) * (gap / (gap - gap_to))
        })
    }
}

/// The squares that a ray passes, one after the other.
#[derive(Debug)]
struct LatticeWalk {
    /// The square's corner 0, not wrapped.
    corner: DVec2,
    /// The square in the tile.
    column: usize,
    row: usize,
    size: [usize; 2],
    origin: DVec2,
    direction: DVec2,
    inverse: DVec2,
    exits: DVec2,
}

impl LatticeWalk {
    fn new(surface: &Surface, origin: DVec3, direction: DVec3, start: f64) -> Self {
        let (origin, at, direction) =
            (origin.truncate(), (origin + start * direction).truncate(), direction.truncate());
        // A ray that begins on a line of the lattice and runs towards smaller numbers is in the square before it.
        let first = |at: f64, direction: f64| if direction < 0.0 { at.ceil() - 1.0 } else { at.floor() };
        let corner = DVec2::new(first(at.x, direction.x), first(at.y, direction.y));
        let wrap = |index: f64, size: usize| (index as i64).rem_euclid(size as i64) as usize;
        let mut walk = Self {
            corner,
            column: wrap(corner.x, surface.columns),
            row: wrap(corner.y, surface.rows),
            size: [surface.columns, surface.rows],
            origin,
            direction,
            inverse: 1.0 / direction,
            exits: DVec2::INFINITY,
        };
        walk.find_exits();
        walk
    }

    /// Where the ray leaves the square in x and in y.
    fn find_exits(&mut self) {
        let exit = |corner: f64, origin: f64, direction: f64, inverse: f64| match direction {
            0.0 => f64::INFINITY,
            _ => (corner + f64::from(u8::from(direction > 0.0)) - origin) * inverse,
        };
        self.exits.x = exit(self.corner.x, self.origin.x, self.direction.x, self.inverse.x);
        self.exits.y = exit(self.corner.y, self.origin.y, self.direction.y, self.inverse.y);
    }

    fn exit(&self) -> f64 {
        self.exits.min_element()
    }

    /// A point, counted from the square's corner 0.
    fn local(&self, point: DVec3) -> DVec3 {
        point - self.corner.extend(0.0)
    }

    /// Goes on to the next square.
    fn step(&mut self) {
        let next = |index: usize, size: usize, is_forward: bool| match (is_forward, index) {
            (true, last) if last + 1 == size => 0,
            (true, index) => index + 1,
            (false, 0) => size - 1,
            (false, index) => index - 1,
        };
        if self.exits.x <= self.exits.y {
            self.corner.x += self.direction.x.signum();
            self.column = next(self.column, self.size[0], self.direction.x > 0.0);
        } else {
            self.corner.y += self.direction.y.signum();
            self.row = next(self.row, self.size[1], self.direction.y > 0.0);
        }
        self.find_exits();
    }
}
