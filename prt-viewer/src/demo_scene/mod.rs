//! The built-in scene: a trefoil knot, a fluted column and a few smaller things on a round plate. Metres, y up.

mod shapes;

use std::f64::consts::TAU;

use glam::DVec3;
use prt_bake::MeshSource;

use shapes::{Point, Shapes};

const STONE: [f32; 3] = [0.56, 0.52, 0.47];
const DARK_STONE: [f32; 3] = [0.20, 0.18, 0.18];
const MARBLE: [f32; 3] = [0.74, 0.72, 0.68];
const SLATE: [f32; 3] = [0.16, 0.24, 0.42];
const CORAL: [f32; 3] = [0.80, 0.20, 0.11];
const TEAL: [f32; 3] = [0.06, 0.42, 0.44];
const OCHRE: [f32; 3] = [0.82, 0.52, 0.09];
const PLUM: [f32; 3] = [0.36, 0.10, 0.26];

/// Everything on the plate stands this far in it, so that no gap lets light through.
const SUNK: f64 = 0.004;

/// The scene, its shapes closed and their faces turned outwards.
pub(crate) fn demo_scene() -> MeshSource {
    let mut shapes = Shapes::default();
    plate(&mut shapes);
    knot(&mut shapes, DVec3::new(0.05, 0.0, 0.1));
    column(&mut shapes, DVec3::new(-1.45, 0.0, -0.55));
    vase(&mut shapes, DVec3::new(1.40, 0.0, 0.05));
    wall(&mut shapes);
    shapes.sphere(DVec3::new(-0.95, 0.26 - SUNK, 0.85), 0.26, 36, OCHRE);
    shapes.sphere(DVec3::new(-0.52, 0.14 - SUNK, 1.25), 0.14, 26, MARBLE);
    shapes.sphere(DVec3::new(0.80, 0.18 - SUNK, 1.10), 0.18, 30, PLUM);
    shapes.into_source()
}

/// Where the plate ends.
const PLATE_RADIUS: f64 = 2.3;

/// Tessellated finely, because it receives the shadows: rings 2.5 cm apart.
fn plate(shapes: &mut Shapes) {
    const EDGE: f64 = 0.06;
    const THICKNESS: f64 = 0.2;
    let flat = PLATE_RADIUS - EDGE;
    let rim = |step: f64| {
        let (sin, cos) = (step * 0.25 * TAU).sin_cos();
        [flat + EDGE * cos, EDGE * (sin - 1.0)]
    };
    let mut outline = vec![[0.0, -THICKNESS], [flat, -THICKNESS], [PLATE_RADIUS - 0.01, -THICKNESS + 0.01]];
    outline.extend((0..=6).map(|i| rim(f64::from(i) / 6.0)));
    let rings = 90;
    outline.extend((0..rings).rev().map(|i| [flat * f64::from(i) / f64::from(rings), 0.0]));
    let color = |point: DVec3| {
        let radius = point.x.hypot(point.z);
        let inlay = (1.79..1.87).contains(&radius) || (1.93..1.95).contains(&radius);
        if inlay { DARK_STONE } else { STONE }
    };
    shapes.lathe(DVec3::ZERO, &outline, 288, |[radius, _], _| radius, color);
}

/// A trefoil, standing upright on its lowest bow.
fn knot(shapes: &mut Shapes, at: DVec3) {
    const TUBE: f64 = 0.15;
    const SCALE: f64 = 0.30;
    let curve = |s: f64| {
        let t = TAU * (s + 0.25);
        let radius = 2.1 + 0.9 * (3.0 * t).cos();
        SCALE * DVec3::new(radius * (2.0 * t).cos(), radius * (2.0 * t).sin(), 0.8 * (3.0 * t).sin())
    };
    let lowest = (0..2000).map(|i| curve(f64::from(i) / 2000.0).y).fold(f64::INFINITY, f64::min);
    let lift = at + DVec3::Y * (TUBE - lowest - SUNK);
    shapes.tube(|s| lift + curve(s), TUBE, 280, 36, CORAL);
}

/// Base, fluted shaft and capital.
fn column(shapes: &mut Shapes, at: DVec3) {
    const FLUTES: f64 = 16.0;
    const SHAFT: [f64; 2] = [0.26, 1.74];
    let mut outline = vec![[0.0, -SUNK]];
    outline.extend(standing(0.34, 0.10, 6));
    // A rounded cushion, then the shaft, narrower at the top.
    outline.extend(arc([0.27, 0.17], 0.07, -0.25, 0.25, 10));
    outline.extend((0..=28).map(|i| {
        let s = f64::from(i) / 28.0;
        [0.235 - 0.035 * s * s, SHAFT[0] + (SHAFT[1] - SHAFT[0]) * s]
    }));
    outline.extend(arc([0.235, 1.80], 0.045, -0.25, 0.25, 8));
    outline.extend((0..=8).map(|i| {
        let s = f64::from(i) / 8.0;
        [0.235 + 0.085 * s * s, 1.85 + 0.09 * s]
    }));
    outline.extend([[0.34, 1.94], [0.34, 1.97], [0.34, 2.0], [0.34, 2.03], [0.33, 2.04], [0.17, 2.04], [0.0, 2.04]]);
    let fluted = |[radius, height]: Point, angle: f64| {
        let is_shaft = smooth_step((height - SHAFT[0] - 0.01) / 0.06) * smooth_step((SHAFT[1] - 0.01 - height) / 0.06);
        radius * (1.0 - 0.10 * is_shaft * (0.5 * FLUTES * angle).sin().powi(2))
    };
    shapes.lathe(at, &outline, 112, fluted, |_| MARBLE);
}

/// An open vase with an inner wall.
fn vase(shapes: &mut Shapes, at: DVec3) {
    /// Height and outer radius.
    const OUTLINE: [Point; 7] =
        [[0.0, 0.135], [0.05, 0.215], [0.30, 0.34], [0.55, 0.30], [0.74, 0.15], [0.86, 0.145], [0.95, 0.21]];
    const WALL: f64 = 0.022;
    /// Height of the floor inside.
    const FLOOR: f64 = 0.05;
    let outer = (0..=30).map(|i| smooth_outline(&OUTLINE, f64::from(i) / 30.0));
    let outer: Vec<Point> = outer.map(|[height, radius]| [radius, height - SUNK]).collect();
    let inner =
        outer.iter().rev().filter(|[_, height]| *height > FLOOR).map(|&[radius, height]| [radius - WALL, height]);
    let mut outline = vec![[0.0, -SUNK]];
    outline.extend(outer.iter().copied());
    let [radius, height] = outer[outer.len() - 1];
    outline.push([radius - 0.5 * WALL, height + 0.012]);
    outline.extend(inner);
    outline.push([0.0, FLOOR]);
    shapes.lathe(at, &outline, 72, |[radius, _], _| radius, |_| TEAL);
}

/// A low curved wall behind the knot.
fn wall(shapes: &mut Shapes) {
    const RADIUS: f64 = 1.95;
    const HALF_WIDTH: f64 = 0.07;
    const HEIGHT: f64 = 0.78;
    let mut section = standing(HALF_WIDTH, HEIGHT, 18);
    section.extend(arc([0.0, HEIGHT], HALF_WIDTH, 0.0, 0.5, 10).into_iter().skip(1));
    section.extend(standing(-HALF_WIDTH, HEIGHT, 18).into_iter().rev().skip(1));
    shapes.arc_wall(RADIUS, &section, [-0.31 * TAU, -0.10 * TAU], 64, SLATE);
}

/// A vertical line from within the plate to a height, on a foot that is set back: what touches the plate is dark, and so are the
/// vertices of the plate beneath it; the overhang keeps their jagged edge out of sight.
fn standing(offset: f64, height: f64, steps: u32) -> Vec<Point> {
    const FOOT: f64 = 0.02;
    let inset = offset - 0.03 * offset.signum();
    let above = (0..=steps).map(|i| [offset, FOOT + (height - FOOT) * f64::from(i) / f64::from(steps)]);
    [[inset, -SUNK], [inset, 0.6 * FOOT]].into_iter().chain(above).collect()
}

/// Points of a circle; angles in turns from +x towards +y.
fn arc(center: Point, radius: f64, from: f64, to: f64, steps: u32) -> Vec<Point> {
    let point = |i: u32| {
        let (sin, cos) = (TAU * (from + (to - from) * f64::from(i) / f64::from(steps))).sin_cos();
        [center[0] + radius * cos, center[1] + radius * sin]
    };
    (0..=steps).map(point).collect()
}

/// 0 below 0, 1 above 1, and a smooth rise between.
fn smooth_step(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// A Catmull-Rom curve through the points; `s` from 0 to 1.
fn smooth_outline<const N: usize>(points: &[Point; N], s: f64) -> Point {
    let place = s * (N - 1) as f64;
    let segment = (place as usize).min(N - 2);
    let t = place - segment as f64;
    let point = |i: isize| points[(segment as isize + i).clamp(0, N as isize - 1) as usize];
    let [a, b, c, d] = [-1, 0, 1, 2].map(point);
    std::array::from_fn(|k| {
        let cubic = 3.0 * (b[k] - c[k]) + d[k] - a[k];
        let square = 2.0 * a[k] - 5.0 * b[k] + 4.0 * c[k] - d[k];
        b[k] + 0.5 * t * (c[k] - a[k] + t * (square + t * cubic))
    })
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use prt_bake::{Mesh, MeshOptions};

    #[test]
    fn the_scene_is_clean_and_of_moderate_size() {
        let (mesh, report) = Mesh::new(demo_scene(), &MeshOptions::default()).unwrap();
        assert_eq!(report.faces_dropped(), 0, "{report:?}");
        assert!((40_000..110_000).contains(&mesh.positions().len()), "{} vertices", mesh.positions().len());
        let [lower, upper] = mesh.bounds();
        assert!(lower[1] < -0.1 && upper[1] > 1.5 && upper[1] < 2.5);
    }

    #[test]
    fn every_thing_is_closed_and_turned_outwards() {
        use std::collections::HashMap;
        let source = demo_scene();
        // Edges of welded corners: each is passed once in either direction.
        let key = |v: u32| source.positions[v as usize].map(|x| (x * 1e7).round() as i64);
        let mut edges: HashMap<_, i32> = HashMap::new();
        for &[a, b, c] in &source.triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *edges.entry((key(from), key(to))).or_default() += 1;
                *edges.entry((key(to), key(from))).or_default() -= 1;
            }
        }
        assert!(edges.values().all(|&balance| balance == 0));
        let corner = |v: u32| DVec3::from_array(source.positions[v as usize]);
        let volume: f64 =
            source.triangles.iter().map(|t| corner(t[0]).dot(corner(t[1]).cross(corner(t[2]))) / 6.0).sum();
        assert!(volume > 0.0, "{volume}");
    }

    #[test]
    fn outlines_pass_through_their_points() {
        let points = [[0.0, 1.0], [1.0, 2.0], [2.0, 0.5]];
        assert_eq!([0.0, 0.5, 1.0].map(|s| smooth_outline(&points, s)), points);
    }
}
