//! From the mesh to triangles on the screen: projection, clipping, snapping, facing. Both twins draw what this makes.
//!
//! A GPU could do these steps, but not reproducibly: its division, its clipping and its fused multiply-adds round differently
//! from one driver to the next, and a vertex that snaps to another 1/256 of a sample moves silhouettes by a pixel here and
//! there. Here they run once, in `f64`, at 5 ns a vertex; the GPU is handed integers on the grid that it snaps to anyway.

mod clip;

use crate::View;
use crate::layout::{ClipVertex, ScreenVertex};
use crate::triangle::SUBPIXEL_STEPS;
use bytemuck::Zeroable;
use rayon::prelude::*;
use std::cmp::Ordering;
use std::ops::Range;

/// Triangles that one task assembles.
const CHUNK: usize = 8192;

/// Triangles on the screen.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Assembly {
    /// The vertices of the mesh, then those made by clipping. A vertex off the screen is used by no triangle.
    pub(crate) vertices: Vec<ScreenVertex>,
    /// What each vertex made by clipping is a mixture of.
    pub(crate) clips: Vec<ClipVertex>,
    /// Corners in `vertices`: positive area with y down, the topmost (then leftmost) corner first. Each has a sample centre in
    /// its bounding box. Those seen from the front come first, so that of two coincident ones the front wins.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// How many of them are seen from the front.
    pub(crate) front_count: usize,
}

/// Projects, clips and snaps a mesh. Triangles with a corner that is not finite are left out.
///
/// Indices must be in range, and `view` checked. The result does not depend on the number of threads.
pub(crate) fn assemble(positions: &[[f32; 3]], triangles: &[[u32; 3]], view: &View) -> Assembly {
    let screen = Screen::new(view);
    let project = |position: &[f32; 3]| screen.project(*position);
    let (projected, mut vertices): (Vec<Projected>, Vec<ScreenVertex>) =
        positions.par_iter().with_min_len(4096).map(project).unzip();
    let assemble_part = |triangles: &[[u32; 3]]| {
        let mut part = Part::new(&screen, &projected, &vertices);
        triangles.iter().for_each(|&corners| part.add(corners));
        part.made
    };
    let parts: Vec<Made> = triangles.par_chunks(CHUNK).map(assemble_part).collect();
    let mut joined = join(parts, positions.len() as u32);
    vertices.append(&mut joined.vertices);
    Assembly { vertices, ..joined }
}

/// A vertex in clip space.
#[derive(Debug, Clone, Copy)]
struct Projected {
    clip: [f64; 4],
    /// One bit for every plane of [`clip::PLANE_COUNT`] that it lies outside of, and [`NOT_FINITE`].
    outside: u8,
}

const NOT_FINITE: u8 = 1 << clip::PLANE_COUNT;

/// The camera, and the grid that positions are snapped to.
#[derive(Debug, Clone)]
struct Screen {
    clip_from_world: [[f64; 4]; 4],
    /// Width and height in steps of the grid.
    steps: [i32; 2],
}

impl Screen {
    fn new(view: &View) -> Self {
        let steps = view.sample_size().map(|side| side as i32 * SUBPIXEL_STEPS);
        Self { clip_from_world: view.clip_from_world.map(|column| column.map(f64::from)), steps }
    }

    fn project(&self, position: [f32; 3]) -> (Projected, ScreenVertex) {
        let [x, y, z] = position.map(f64::from);
        let m = &self.clip_from_world;
        let clip: [f64; 4] = std::array::from_fn(|i| m[0][i] * x + m[1][i] * y + m[2][i] * z + m[3][i]);
        let outside = match clip.iter().all(|c| c.is_finite()) {
            true => clip::outside(clip),
            false => NOT_FINITE,
        };
        let vertex = if outside == 0 { self.snap(clip) } else { ScreenVertex::zeroed() };
        (Projected { clip, outside }, vertex)
    }

    /// The nearest grid position of a point inside the view volume.
    fn snap(&self, [x, y, z, w]: [f64; 4]) -> ScreenVertex {
        let inverse_w = 1.0 / w;
        let step = |share: f64, steps: i32| ((share * f64::from(steps) + 0.5) as i32).clamp(0, steps);
        ScreenVertex {
            x: step(0.5 + 0.5 * x * inverse_w, self.steps[0]),
            y: step(0.5 - 0.5 * y * inverse_w, self.steps[1]),
            z: ((z * inverse_w) as f32).clamp(0.0, 1.0),
            inverse_w: inverse_w as f32,
        }
    }
}

/// What one task makes; clip vertices are numbered from the number of mesh vertices on, to be shifted by [`join`].
#[derive(Debug, Default)]
struct Made {
    vertices: Vec<ScreenVertex>,
    clips: Vec<ClipVertex>,
    front: Vec<[u32; 3]>,
    back: Vec<[u32; 3]>,
}

#[derive(Debug)]
struct Part<'a> {
    screen: &'a Screen,
    projected: &'a [Projected],
    vertices: &'a [ScreenVertex],
    made: Made,
}

impl<'a> Part<'a> {
    fn new(screen: &'a Screen, projected: &'a [Projected], vertices: &'a [ScreenVertex]) -> Self {
        Self { screen, projected, vertices, made: Made::default() }
    }

    fn add(&mut self, corners: [u32; 3]) {
        let [a, b, c] = corners.map(|v| self.projected[v as usize]);
        let any_outside = a.outside | b.outside | c.outside;
        if any_outside & NOT_FINITE != 0 || a.outside & b.outside & c.outside != 0 {
            return;
        }
        let is_front = orientation([a.clip, b.clip, c.clip]) > 0.0;
        match any_outside {
            0 => self.set_up(corners, is_front),
            planes => self.add_clipped(corners, planes, is_front),
        }
    }

    /// Clips a triangle and adds what is left as a fan.
    ///
    /// The corners are sorted by position before, so that two coincident triangles give the same fan whatever their winding.
    fn add_clipped(&mut self, mut corners: [u32; 3], planes: u8, is_front: bool) {
        corners.sort_by(|&a, &b| compare(self.projected[a as usize].clip, self.projected[b as usize].clip));
        let polygon = clip::clip(corners.map(|v| self.projected[v as usize].clip), planes);
        let ids: Vec<u32> = polygon.iter().map(|corner| self.number(corner, corners)).collect();
        for pair in ids.windows(2).skip(1) {
            self.set_up([ids[0], pair[0], pair[1]], is_front);
        }
    }

    /// The number of a corner of a clipped polygon: a vertex of the mesh, or a new one.
    fn number(&mut self, corner: &clip::Corner, source: [u32; 3]) -> u32 {
        if let Some(k) = corner.original {
            return source[k];
        }
        let weight = corner.weight.map(|w| w as f32);
        self.made.vertices.push(self.screen.snap(corner.clip));
        self.made.clips.push(ClipVertex { source, padding_0: 0, weight, padding_1: 0 });
        (self.projected.len() + self.made.clips.len() - 1) as u32
    }

    /// Adds a triangle on the screen in canonical form, if it can cover a sample.
    fn set_up(&mut self, corners: [u32; 3], is_front: bool) {
        let point = |v: u32| match self.vertices.get(v as usize) {
            Some(vertex) => [vertex.x, vertex.y],
            None => {
                let vertex = self.made.vertices[v as usize - self.vertices.len()];
                [vertex.x, vertex.y]
            }
        };
        let points = corners.map(point);
        if !has_sample_centre(points) {
            return;
        }
        let Some(order) = canonical_order(points) else { return };
        let triangles = if is_front { &mut self.made.front } else { &mut self.made.back };
        triangles.push(order.map(|k| corners[k]));
    }
}

fn compare(a: [f64; 4], b: [f64; 4]) -> Ordering {
    a.partial_cmp(&b).unwrap_or(Ordering::Equal)
}

/// Positive if the triangle is seen counterclockwise with y up; also right for a triangle that is partly behind the camera.
fn orientation([a, b, c]: [[f64; 4]; 3]) -> f64 {
    a[0] * (b[1] * c[3] - b[3] * c[1]) - a[1] * (b[0] * c[3] - b[3] * c[0]) + a[3] * (b[0] * c[1] - b[1] * c[0])
}

/// Whether the bounding box holds the centre of a sample.
fn has_sample_centre(points: [[i32; 2]; 3]) -> bool {
    (0..2).all(|axis| {
        let [a, b, c] = points.map(|point| point[axis]);
        !sample_range(a.min(b).min(c), a.max(b).max(c)).is_empty()
    })
}

/// The samples whose centres, half a sample from their corners, lie in `min..=max` grid steps on one axis. `min >= 0`.
pub(crate) fn sample_range(min: i32, max: i32) -> Range<u32> {
    const HALF: i32 = SUBPIXEL_STEPS / 2;
    ((min + HALF - 1) / SUBPIXEL_STEPS) as u32..((max + HALF) / SUBPIXEL_STEPS) as u32
}

/// The order of the corners that gives positive area with y down and begins with the topmost, then leftmost corner.
///
/// The same three points thus give the same numbers whatever their winding was. `None` for an empty triangle.
fn canonical_order(points: [[i32; 2]; 3]) -> Option<[usize; 3]> {
    let [a, b, c] = points.map(|point| point.map(i64::from));
    let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let mut order = match area {
        0 => return None,
        1.. => [0, 1, 2],
        _ => [0, 2, 1],
    };
    let topmost = (0..3).min_by_key(|&k| (points[order[k]][1], points[order[k]][0])).unwrap_or(0);
    order.rotate_left(topmost);
    Some(order)
}

/// Joins parts in order: all that is seen from the front, then all that is seen from the back.
fn join(parts: Vec<Made>, vertex_count: u32) -> Assembly {
    let mut joined = Assembly::default();
    let mut back = Vec::new();
    for part in parts {
        let shift = joined.clips.len() as u32;
        let shifted = |corners: [u32; 3]| corners.map(|v| if v >= vertex_count { v + shift } else { v });
        joined.triangles.extend(part.front.into_iter().map(shifted));
        back.extend(part.back.into_iter().map(shifted));
        joined.vertices.extend(part.vertices);
        joined.clips.extend(part.clips);
    }
    joined.front_count = joined.triangles.len();
    joined.triangles.append(&mut back);
    joined
}

#[cfg(test)]
mod tests;
