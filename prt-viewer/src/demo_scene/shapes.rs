//! Parametric shapes, collected into one mesh. All are closed, with faces turned outwards.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use prt_bake::MeshSource;

/// Radius and height, or another pair of coordinates in the plane of a section.
pub(super) type Point = [f64; 2];

/// A mesh under construction.
#[derive(Debug, Default)]
pub(super) struct Shapes {
    source: MeshSource,
}

impl Shapes {
    pub(super) fn into_source(self) -> MeshSource {
        self.source
    }

    /// Turns an outline about the vertical through `at`. The outline starts and ends on the axis and goes up on its outside.
    ///
    /// - `radius`: radius of the surface at a point of the outline and an angle
    pub(super) fn lathe(
        &mut self,
        at: DVec3,
        outline: &[Point],
        segments: u32,
        radius: impl Fn(Point, f64) -> f64,
        color: impl Fn(DVec3) -> [f32; 3],
    ) {
        let row = |&point: &Point| {
            let count = if point[0] == 0.0 { 1 } else { segments };
            let corner = |segment: u32| {
                let angle = TAU * f64::from(segment) / f64::from(segments);
                let (sin, cos) = angle.sin_cos();
                let radius = if point[0] == 0.0 { 0.0 } else { radius(point, angle) };
                at + DVec3::new(radius * cos, point[1], radius * sin)
            };
            (0..count).map(corner).collect()
        };
        self.rows(&outline.iter().map(row).collect::<Vec<_>>(), color);
    }

    pub(super) fn sphere(&mut self, center: DVec3, radius: f64, rows: u32, color: [f32; 3]) {
        let point = |row: u32| {
            let (sin, cos) = (PI * f64::from(row) / f64::from(rows)).sin_cos();
            [if row == 0 || row == rows { 0.0 } else { radius * sin }, -radius * cos]
        };
        let outline: Vec<Point> = (0..=rows).map(point).collect();
        self.lathe(center, &outline, 2 * rows, |[radius, _], _| radius, |_| color);
    }

    /// A tube of constant radius about a closed curve, `s` from 0 to 1, that never runs along the z axis.
    pub(super) fn tube(
        &mut self,
        curve: impl Fn(f64) -> DVec3,
        radius: f64,
        segments: u32,
        sides: u32,
        color: [f32; 3],
    ) {
        let corner = |segment: u32, side: u32| {
            let s = f64::from(segment % segments) / f64::from(segments);
            let tangent = (curve(s + 1e-4) - curve(s - 1e-4)).normalize();
            let normal = tangent.cross(DVec3::Z).normalize();
            let (sin, cos) = (TAU * f64::from(side % sides) / f64::from(sides)).sin_cos();
            curve(s) + radius * (cos * normal + sin * tangent.cross(normal))
        };
        // Rows run around the tube, so that the outside is on the same side as that of a lathe.
        let row = |side: u32| (0..segments).map(|segment| corner(segment, side)).collect();
        self.rows(&(0..=sides).map(row).collect::<Vec<_>>(), |_| color);
    }

    /// A wall along an arc about the vertical axis through the origin, rounded off at both ends.
    ///
    /// - `section`: a closed outline of offset from the middle of the wall, outwards, and height; up on its outside
    /// - `angles`: from +x towards +z
    pub(super) fn arc_wall(&mut self, radius: f64, section: &[Point], angles: [f64; 2], steps: u32, color: [f32; 3]) {
        let half_width = section.iter().map(|[offset, _]| *offset).fold(0.0, f64::max);
        let end = half_width / radius;
        let corner = |&[offset, height]: &Point, step: u32| {
            // Steps gather at the ends, where the width shrinks like a half circle.
            let angle =
                angles[0] + (angles[1] - angles[0]) * 0.5 * (1.0 - (PI * f64::from(step) / f64::from(steps)).cos());
            let inside = ((angle - angles[0]).min(angles[1] - angle) / end).clamp(0.0, 1.0);
            let radius = radius + offset * (1.0 - (1.0 - inside).powi(2)).sqrt();
            DVec3::new(radius * angle.cos(), height, radius * angle.sin())
        };
        let closed = section.iter().chain(&section[..1]);
        let rows: Vec<Vec<DVec3>> = closed.map(|point| (0..=steps).map(|step| corner(point, step)).collect()).collect();
        self.strips(&rows, color);
    }

    /// Joins rows of corners that close to rings; a row of one corner is a pole.
    fn rows(&mut self, rows: &[Vec<DVec3>], color: impl Fn(DVec3) -> [f32; 3]) {
        let starts: Vec<usize> = rows.iter().map(|row| self.add_corners(row, &color)).collect();
        for (index, pair) in rows.windows(2).enumerate() {
            let segments = pair[0].len().max(pair[1].len());
            for segment in 0..segments {
                let corner = |row: usize, segment: usize| starts[index + row] + segment % pair[row].len();
                let quad = [corner(0, segment), corner(1, segment), corner(1, segment + 1), corner(0, segment + 1)];
                self.add_quad(quad);
            }
        }
    }

    /// Joins rows of corners that do not close.
    fn strips(&mut self, rows: &[Vec<DVec3>], color: [f32; 3]) {
        let starts: Vec<usize> = rows.iter().map(|row| self.add_corners(row, &|_| color)).collect();
        for pair in starts.windows(2) {
            for step in 0..rows[0].len() - 1 {
                self.add_quad([pair[0] + step, pair[1] + step, pair[1] + step + 1, pair[0] + step + 1]);
            }
        }
    }

    fn add_corners(&mut self, corners: &[DVec3], color: &impl Fn(DVec3) -> [f32; 3]) -> usize {
        let start = self.source.positions.len();
        self.source.positions.extend(corners.iter().map(|corner| corner.to_array()));
        self.source.albedo.extend(corners.iter().map(|&corner| color(corner)));
        start
    }

    /// Two triangles, or one where two corners coincide.
    fn add_quad(&mut self, [a, b, c, d]: [usize; 4]) {
        for triangle in [[a, b, c], [a, c, d]] {
            let [p, q, r] = triangle.map(|corner| DVec3::from_array(self.source.positions[corner]));
            if (q - p).cross(r - p).length() > 1e-12 {
                self.source.triangles.push(triangle.map(|corner| corner as u32));
            }
        }
    }
}
