//! Clipping of one triangle against the view volume, in homogeneous coordinates.
//!
//! Source: I. Sutherland, G. Hodgman, "Reentrant polygon clipping", Communications of the ACM 17(1), 1974.

/// Planes of the view volume: left, right, bottom, top, near, far, and `w` away from zero.
pub(super) const PLANE_COUNT: usize = 7;

/// Smallest `w` of a visible point, so that `1/w` is finite in `f32`. Perspective matrices clip earlier, at the near plane.
const MIN_W: f64 = 1e-30;

/// Distances to the planes, positive inside; any positive scale.
fn distances([x, y, z, w]: [f64; 4]) -> [f64; PLANE_COUNT] {
    [w + x, w - x, w + y, w - y, z, w - z, w - MIN_W]
}

/// One bit for every plane that the point lies outside of.
pub(super) fn outside(clip: [f64; 4]) -> u8 {
    let bits = distances(clip).into_iter().enumerate();
    bits.fold(0, |outside, (plane, distance)| outside | (u8::from(distance < 0.0) << plane))
}

/// A corner of a clipped triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Corner {
    pub(super) clip: [f64; 4],
    /// Shares of the corners of the triangle.
    pub(super) weight: [f64; 3],
    /// The corner of the triangle that this is, if clipping did not make it.
    pub(super) original: Option<usize>,
}

/// The part of a triangle inside the given planes (bits as in [`outside`]): a convex polygon of 0 or 3 to 10 corners.
pub(super) fn clip(triangle: [[f64; 4]; 3], planes: u8) -> Vec<Corner> {
    let original =
        |k: usize| Corner { clip: triangle[k], weight: std::array::from_fn(|i| f64::from(i == k)), original: Some(k) };
    let mut polygon: Vec<Corner> = (0..3).map(original).collect();
    for plane in (0..PLANE_COUNT).rev().filter(|plane| planes & (1 << plane) != 0) {
        polygon = clip_plane(&polygon, plane);
    }
    polygon
}

fn clip_plane(polygon: &[Corner], plane: usize) -> Vec<Corner> {
    let distance = |corner: &Corner| distances(corner.clip)[plane];
    let mut inside = Vec::with_capacity(polygon.len() + 1);
    for (k, corner) in polygon.iter().enumerate() {
        let next = &polygon[(k + 1) % polygon.len()];
        if distance(corner) >= 0.0 {
            inside.push(*corner);
        }
        if (distance(corner) >= 0.0) != (distance(next) >= 0.0) {
            inside.push(cut(corner, next, distance));
        }
    }
    inside
}

/// Where an edge meets a plane. Always computed from the inner end: two triangles that share the edge, in opposite directions,
/// get the same point.
fn cut(a: &Corner, b: &Corner, distance: impl Fn(&Corner) -> f64) -> Corner {
    let (inner, outer) = if distance(a) >= 0.0 { (a, b) } else { (b, a) };
    let t = distance(inner) / (distance(inner) - distance(outer));
    let mix = |p: f64, q: f64| p + t * (q - p);
    Corner {
        clip: std::array::from_fn(|i| mix(inner.clip[i], outer.clip[i])),
        weight: std::array::from_fn(|i| mix(inner.weight[i], outer.weight[i])),
        original: None,
    }
}
