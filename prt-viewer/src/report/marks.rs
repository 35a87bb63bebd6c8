//! Dots at vertices: those in sight are full, those behind something are rings.

use glam::{Mat4, Vec2, Vec3};

use super::raster::{Canvas, Raster};

/// Vermilion of the palette of Okabe and Ito, apart from grey for every kind of colour vision.
pub(super) const DOT: [u8; 3] = [213, 94, 0];
const RIM: [u8; 3] = [255, 255, 255];
/// Clip depth by which a vertex may lie behind the surface that is drawn at its pixel and still be in sight.
const DEPTH_TOLERANCE: f32 = 2e-3;
/// Share of a ring's colour: it is seen through the surface.
const RING_OPACITY: f32 = 0.55;

/// A vertex, and the colour of its dot.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mark {
    pub(super) position: [f32; 3],
    pub(super) color: [u8; 3],
}

/// Radius of a dot in pixels: many dots are small, so that they do not hide one another.
fn radius(count: usize) -> f32 {
    match count {
        0..=20 => 9.0,
        21..=100 => 6.0,
        101..=1_000 => 4.0,
        1_001..=10_000 => 2.5,
        _ => 1.5,
    }
}

/// Marks vertices; those in sight last, over those that are hidden.
pub(super) fn mark(raster: &mut Raster, canvas: &Canvas<'_>, points: &[Mark]) {
    let radius = radius(points.len());
    let placed = points.iter().filter_map(|mark| Some((place(canvas, raster, mark.position)?, mark.color)));
    let (seen, hidden): (Vec<_>, Vec<_>) = placed.partition(|&((_, is_seen), _)| is_seen);
    hidden.iter().for_each(|&((at, _), color)| ring(raster, at, radius, color));
    seen.iter().for_each(|&((at, _), color)| dot(raster, at, radius, color));
}

/// The place of a point in pixels, and whether nothing hides it; none if it is outside of the picture.
fn place(canvas: &Canvas<'_>, raster: &Raster, point: [f32; 3]) -> Option<(Vec2, bool)> {
    let view = &canvas.shot.view;
    let clip = Mat4::from_cols_array_2d(&view.clip_from_world).project_point3(Vec3::from_array(point));
    let size = Vec2::new(view.width as f32, view.height as f32);
    let at = Vec2::new(0.5 + 0.5 * clip.x, 0.5 - 0.5 * clip.y) * size;
    let is_inside = at.cmpge(Vec2::ZERO).all() && at.cmplt(size).all();
    is_inside.then(|| {
        let (x, y) = (at.x as usize, at.y as usize);
        let columns = x.saturating_sub(1)..(x + 2).min(raster.width);
        let rows = y.saturating_sub(1)..(y + 2).min(raster.height());
        let farthest = rows.flat_map(|y| columns.clone().map(move |x| canvas.depth(x, y))).fold(0.0, f32::max);
        (at, clip.z <= farthest + DEPTH_TOLERANCE)
    })
}

fn dot(raster: &mut Raster, at: Vec2, radius: f32, color: [u8; 3]) {
    disc(raster, at, radius + 1.0, |distance| {
        let inner = coverage(radius - 1.0, distance);
        [(RIM, coverage(radius, distance)), (color, inner)]
    });
}

fn ring(raster: &mut Raster, at: Vec2, radius: f32, color: [u8; 3]) {
    disc(raster, at, radius + 1.0, |distance| {
        let band = coverage(radius, distance) - coverage(radius - 2.0, distance);
        [(color, RING_OPACITY * band), (color, 0.0)]
    });
}

/// Share of a pixel at a distance from the middle of a disc that the disc covers.
fn coverage(radius: f32, distance: f32) -> f32 {
    (radius + 0.5 - distance).clamp(0.0, 1.0)
}

/// Lays two layers over the pixels around a point.
fn disc(raster: &mut Raster, at: Vec2, reach: f32, layers: impl Fn(f32) -> [([u8; 3], f32); 2]) {
    let range = |middle: f32, end: usize| {
        let low = (middle - reach).max(0.0) as usize;
        low..((middle + reach).ceil() as usize).min(end)
    };
    let (columns, rows) = (range(at.x, raster.width), range(at.y, raster.height()));
    for (x, y) in rows.flat_map(|y| columns.clone().map(move |x| (x, y))) {
        let distance = Vec2::new(x as f32 + 0.5, y as f32 + 0.5).distance(at);
        for (color, opacity) in layers(distance) {
            raster.blend(x, y, color, opacity);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::stage::Stage;

    #[test]
    fn dots_are_round_and_cut_at_the_edge() {
        let mut raster = Raster::empty();
        dot(&mut raster, Vec2::new(100.0, 100.0), 6.0, DOT);
        dot(&mut raster, Vec2::new(0.0, 419.9), 6.0, DOT);
        let drawn: f32 = raster.pixels[..].iter().map(|pixel| f32::from(pixel[3]) / 255.0).sum();
        // A disc and a quarter of one, whose edge is half a pixel wide to either side.
        let area = 1.25 * std::f32::consts::PI * 6.0 * 6.0;
        assert!((drawn / area - 1.0).abs() < 0.03, "{drawn} of {area}");
        assert_eq!(raster.pixels[100 * raster.width + 100], [DOT[0], DOT[1], DOT[2], 255]);
    }

    #[test]
    fn a_ring_is_hollow() {
        let mut raster = Raster::empty();
        ring(&mut raster, Vec2::new(50.0, 50.0), 6.0, DOT);
        assert_eq!(raster.pixels[50 * raster.width + 50], [0; 4]);
        assert!(raster.pixels[50 * raster.width + 55][3] > 100);
    }
    /// A square that faces the front, with points before and behind its middle.
    #[test]
    fn what_is_behind_the_surface_is_hidden() {
        let geometry = prt_bake::Geometry {
            positions: vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..prt_bake::Geometry::default()
        };
        let stage = Stage::new(&geometry).expect("a square has an extent");
        let canvas = Canvas::new(&stage, &stage.shots[0]);
        let is_seen = |z| place(&canvas, &Raster::empty(), [0.0, 0.0, z]).map(|(_, is_seen)| is_seen);
        assert_eq!([0.2, 0.0, -0.2].map(is_seen), [Some(true), Some(true), Some(false)]);
        assert!(place(&canvas, &Raster::empty(), [9.0, 0.0, 0.0]).is_none(), "outside of the picture");
        let mut raster = Raster::empty();
        let marks = [0.0, 9.0].map(|x| Mark { position: [x, 0.0, 0.0], color: DOT });
        mark(&mut raster, &canvas, &marks);
        assert!(raster.pixels.iter().any(|pixel| pixel[..3] == DOT));
    }
}
