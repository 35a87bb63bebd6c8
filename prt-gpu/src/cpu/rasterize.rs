use crate::assemble::{Assembly, assemble, sample_range};
use crate::layout::{ClipVertex, ScreenVertex};
use crate::surface::check_triangles;
use crate::triangle::{self, SUBPIXEL_STEPS};
use crate::{Frame, View};
use rayon::prelude::*;
use std::ops::Range;

/// Rows of samples that one task draws: its visibility buffer stays in the cache.
const BAND_ROWS: u32 = 32;

/// Draws a mesh with a colour per vertex, interpolated with perspective: the twin of the passes `draw_surface` and `resolve`.
///
/// - `colors`: `[V]` linear, any finite value
/// - the sample at the centre of each of `samples²` cells of a pixel sees the nearest surface; the pixel is their mean
/// - a surface seen from the back (clockwise) is black and hides what is behind it, as a one-sided diffuse surface in Mitsuba;
///   of a front and a back at the same depth the front is seen, otherwise the first triangle
/// - shared edges neither overlap nor leave gaps: vertices are snapped to 1/256 of a sample, and a sample on an edge belongs to
///   the triangle below or right of it (top-left rule)
/// - triangles of any size, crossing any plane of the view volume, are clipped; those with corners that are not finite are left out
///
/// The result does not depend on the number of threads.
///
/// # Panics
/// If lengths or indices do not match, or [`View::check`] refuses the view.
pub fn rasterize(positions: &[[f32; 3]], triangles: &[[u32; 3]], colors: &[[f32; 3]], view: &View) -> Frame {
    assert_eq!(colors.len(), positions.len(), "number of colours");
    if let Err(error) = check_triangles(triangles, positions.len()).and_then(|()| view.check()) {
        panic!("{error}");
    }
    draw(assemble(positions, triangles, view), &VertexColors(colors), view)
}

/// Draws what [`assemble`] made, in the colours of a paint.
pub(super) fn draw<P: Paint>(assembly: Assembly, paint: &P, view: &View) -> Frame {
    draw_scene(&Scene { assembly, paint }, view)
}

/// The radiance of a surface at a point of a triangle.
pub(super) trait Paint: Sync {
    /// Room for intermediate results, one per task.
    type Scratch: Default;

    fn radiance(&self, scratch: &mut Self::Scratch, point: &Point) -> [f32; 3];
}

/// A point of a triangle that is seen from the front.
#[derive(Debug)]
pub(super) struct Point {
    pub(super) corners: [Corner; 3],
    /// Shares of the corners, linear on the screen.
    pub(super) screen: [f32; 3],
    /// `1/w` of the corners.
    pub(super) inverse_w: [f32; 3],
}

/// A corner of a triangle on the screen.
#[derive(Debug, Clone, Copy)]
pub(super) enum Corner {
    /// A vertex of the mesh.
    Vertex(u32),
    /// Made by clipping.
    Mixture(ClipVertex),
}

/// Colours of vertices, interpolated with perspective.
#[derive(Debug)]
struct VertexColors<'a>(&'a [[f32; 3]]);

impl Paint for VertexColors<'_> {
    type Scratch = ();

    fn radiance(&self, (): &mut (), point: &Point) -> [f32; 3] {
        let weights = triangle::perspective_weights(point.screen, point.inverse_w);
        blend(weights, point.corners.map(|corner| corner.value(|v| self.0[v])))
    }
}

impl Corner {
    /// What the vertices have, for a corner.
    pub(super) fn value<const N: usize>(&self, of_vertex: impl Fn(usize) -> [f32; N]) -> [f32; N] {
        match self {
            Self::Vertex(v) => of_vertex(*v as usize),
            Self::Mixture(clip) => blend(clip.weight, clip.source.map(|v| of_vertex(v as usize))),
        }
    }
}

/// What is drawn: triangles on the screen and how they look.
#[derive(Debug)]
struct Scene<'a, P> {
    assembly: Assembly,
    paint: &'a P,
}

impl<P: Paint> Scene<'_, P> {
    fn corners(&self, triangle: u32) -> [ScreenVertex; 3] {
        self.assembly.triangles[triangle as usize].map(|v| self.assembly.vertices[v as usize])
    }

    fn corner(&self, vertex: u32) -> Corner {
        match (vertex as usize).checked_sub(self.assembly.vertices.len() - self.assembly.clips.len()) {
            None => Corner::Vertex(vertex),
            Some(clip) => Corner::Mixture(self.assembly.clips[clip]),
        }
    }

    /// Radiance of a triangle at a sample.
    fn radiance(&self, scratch: &mut P::Scratch, triangle: u32, sample: [u32; 2]) -> [f32; 3] {
        if triangle as usize >= self.assembly.front_count {
            return [0.0; 3];
        }
        let corners = self.corners(triangle);
        let edges = Edges::new(corners, sample).values.map(|e| e as f32);
        let point = Point {
            corners: self.assembly.triangles[triangle as usize].map(|v| self.corner(v)),
            screen: triangle::screen_weights(edges),
            inverse_w: corners.map(|c| c.inverse_w),
        };
        self.paint.radiance(scratch, &point)
    }
}

/// A mixture, with the roundings of the shaders' exact one.
pub(super) fn blend<const N: usize>(weight: [f32; 3], value: [[f32; N]; 3]) -> [f32; N] {
    std::array::from_fn(|i| (weight[0] * value[0][i] + weight[1] * value[1][i]) + weight[2] * value[2][i])
}

fn draw_scene<P: Paint>(scene: &Scene<'_, P>, view: &View) -> Frame {
    let (width, height) = (view.width as usize, view.height as usize);
    let mut frame = Frame { width, height, pixels: vec![[0.0; 4]; width * height], depth: vec![1.0; width * height] };
    let band_pixel_rows = (BAND_ROWS / view.samples) as usize;
    let bins = bin(scene, view, band_pixel_rows as u32 * view.samples);
    let pixels = frame.pixels.par_chunks_mut(width * band_pixel_rows);
    let depths = frame.depth.par_chunks_mut(width * band_pixel_rows);
    let bands = pixels.zip(depths).zip(&bins).enumerate();
    let scratch = || (Vec::new(), P::Scratch::default());
    bands.for_each_init(scratch, |(samples, scratch), (index, ((pixels, depth), triangles))| {
        if !triangles.is_empty() {
            let rows = pixels.len() / width;
            let mut band = Band::new(samples, view, (index * band_pixel_rows) as u32, rows as u32);
            triangles.iter().for_each(|&triangle| band.draw(triangle, scene.corners(triangle)));
            band.resolve(scene, scratch, pixels, depth);
        }
    });
    frame
}

/// The triangles that touch each band of rows, in order.
fn bin<P: Paint>(scene: &Scene<'_, P>, view: &View, band_rows: u32) -> Vec<Vec<u32>> {
    let mut bins = vec![Vec::new(); view.sample_size()[1].div_ceil(band_rows) as usize];
    for triangle in 0..scene.assembly.triangles.len() as u32 {
        let rows = row_range(&scene.corners(triangle));
        let range = (rows.start / band_rows) as usize..rows.end.div_ceil(band_rows) as usize;
        bins[range].iter_mut().for_each(|bin| bin.push(triangle));
    }
    bins
}

/// Rows of samples that a triangle can cover; [`assemble`] leaves no triangle without one.
fn row_range(corners: &[ScreenVertex; 3]) -> Range<u32> {
    let [a, b, c] = corners.map(|corner| corner.y);
    sample_range(a.min(b).min(c), a.max(b).max(c))
}

/// Columns of samples that a triangle can cover.
fn column_range(corners: &[ScreenVertex; 3]) -> Range<u32> {
    let [a, b, c] = corners.map(|corner| corner.x);
    sample_range(a.min(b).min(c), a.max(b).max(c))
}

/// The nearest triangle at a sample.
#[derive(Debug, Clone, Copy)]
struct Sample {
    depth: f32,
    /// Number of the triangle, or [`NOTHING`].
    triangle: u32,
}

const NOTHING: u32 = u32::MAX;

/// A band of sample rows that one task draws.
#[derive(Debug)]
struct Band<'a> {
    samples: &'a mut Vec<Sample>,
    view: &'a View,
    width: u32,
    first_row: u32,
    rows: u32,
}

impl<'a> Band<'a> {
    fn new(samples: &'a mut Vec<Sample>, view: &'a View, first_pixel_row: u32, pixel_rows: u32) -> Self {
        let [width, _] = view.sample_size();
        let (first_row, rows) = (first_pixel_row * view.samples, pixel_rows * view.samples);
        samples.clear();
        samples.resize(width as usize * rows as usize, Sample { depth: 1.0, triangle: NOTHING });
        Self { samples, view, width, first_row, rows }
    }

    /// Keeps the triangle at every sample where it is nearer than what is there.
    fn draw(&mut self, triangle: u32, corners: [ScreenVertex; 3]) {
        let (columns, rows) = (column_range(&corners), row_range(&corners));
        let rows = rows.start.max(self.first_row)..rows.end.min(self.first_row + self.rows);
        let z = corners.map(|corner| corner.z);
        let mut edges = Edges::new(corners, [columns.start, rows.start]);
        for row in rows {
            let start = (row - self.first_row) as usize * self.width as usize;
            let mut at = edges.values;
            for sample in &mut self.samples[start + columns.start as usize..start + columns.end as usize] {
                if edges.cover(at) {
                    keep_nearer(sample, triangle, at, z);
                }
                at = add(at, edges.step_right);
            }
            edges.values = add(edges.values, edges.step_down);
        }
    }

    /// Averages the samples of every pixel.
    fn resolve<P: Paint>(
        &self,
        scene: &Scene<'_, P>,
        scratch: &mut P::Scratch,
        pixels: &mut [[f32; 4]],
        depths: &mut [f32],
    ) {
        let width = self.view.width as usize;
        for (i, (pixel, depth)) in pixels.iter_mut().zip(depths).enumerate() {
            (*pixel, *depth) = self.resolve_pixel(scene, scratch, (i % width) as u32, (i / width) as u32);
        }
    }

    /// Mean radiance, coverage and smallest depth of the pixel in this column and row of the band.
    fn resolve_pixel<P: Paint>(
        &self,
        scene: &Scene<'_, P>,
        scratch: &mut P::Scratch,
        x: u32,
        y: u32,
    ) -> ([f32; 4], f32) {
        let samples = self.view.samples;
        let mut sum = [0.0; 4];
        let mut nearest = 1.0_f32;
        for (row, column) in (0..samples).flat_map(|j| (0..samples).map(move |i| (y * samples + j, x * samples + i))) {
            let sample = self.samples[(row * self.width + column) as usize];
            if sample.triangle != NOTHING {
                let [r, g, b] = scene.radiance(scratch, sample.triangle, [column, self.first_row + row]);
                sum = std::array::from_fn(|k| sum[k] + [r, g, b, 1.0][k]);
                nearest = nearest.min(sample.depth);
            }
        }
        (sum.map(|s| s / (samples * samples) as f32), nearest)
    }
}

fn keep_nearer(sample: &mut Sample, triangle: u32, edges: [i64; 3], z: [f32; 3]) {
    let depth = triangle::depth(triangle::screen_weights(edges.map(|e| e as f32)), z);
    if depth < sample.depth {
        *sample = Sample { depth, triangle };
    }
}

/// The edge functions of a triangle: twice the areas that a point spans with each edge, exact, in squared grid steps.
///
/// Source: J. Pineda, "A parallel algorithm for polygon rasterization", SIGGRAPH 1988.
#[derive(Debug, Clone, Copy)]
struct Edges {
    /// At the current sample; entry `k` belongs to the edge opposite to corner `k`.
    values: [i64; 3],
    step_right: [i64; 3],
    step_down: [i64; 3],
    /// 0 where points on the edge belong to the triangle, -1 where they do not.
    bias: [i64; 3],
}

impl Edges {
    /// For corners of positive area (y down), at the centre of a sample.
    fn new(corners: [ScreenVertex; 3], sample: [u32; 2]) -> Self {
        let centre = sample.map(|s| i64::from(s) * i64::from(SUBPIXEL_STEPS) + i64::from(SUBPIXEL_STEPS / 2));
        let point = corners.map(|corner| [i64::from(corner.x) - centre[0], i64::from(corner.y) - centre[1]]);
        let ends = |k: usize| (point[(k + 1) % 3], point[(k + 2) % 3]);
        let from_ends = |f: fn([i64; 2], [i64; 2]) -> i64| std::array::from_fn(|k| f(ends(k).0, ends(k).1));
        Self {
            values: from_ends(|p, q| p[0] * q[1] - p[1] * q[0]),
            step_right: from_ends(|p, q| (p[1] - q[1]) * i64::from(SUBPIXEL_STEPS)),
            step_down: from_ends(|p, q| (q[0] - p[0]) * i64::from(SUBPIXEL_STEPS)),
            bias: from_ends(|p, q| if is_top_left([q[0] - p[0], q[1] - p[1]]) { 0 } else { -1 }),
        }
    }

    /// Whether a sample with these values belongs to the triangle.
    fn cover(&self, values: [i64; 3]) -> bool {
        let [a, b, c] = add(values, self.bias);
        (a | b | c) >= 0
    }
}

/// Whether an edge in this direction has the triangle below it (a horizontal top edge) or right of it (a left edge).
fn is_top_left([x, y]: [i64; 2]) -> bool {
    y < 0 || (y == 0 && x > 0)
}

fn add(a: [i64; 3], b: [i64; 3]) -> [i64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[cfg(test)]
mod tests;
