//! The points of the surface that texels stand for.

use glam::{DVec2, DVec3, Vec3};

use super::layout::Layout;
use super::plan::LaidOut;
use super::raster::{NO_FACE, ON_FACE};
use super::triangle::{Nearest, beyond, nearest};
use crate::Scene;
use crate::diffuse::face_origin;
use crate::mesh::unit_vector;
use crate::scene::{Hits, Packet, Stack};

/// A point is lifted to the smooth surface only if there is this many times as much room: another surface may lie close above.
const HEADROOM: f64 = 2.0;

/// Most faces that are walked over from the edge of a chart to the centre of a texel.
const MOST_STEPS: usize = 64;

/// The points of a run of texels, as the direct pass takes them.
#[derive(Debug, Default)]
pub(super) struct Points {
    /// Shading normals, unit length.
    pub(super) normals: Vec<[f32; 3]>,
    /// Where their rays start, in the frame that is traced in.
    pub(super) origins: Vec<Vec3>,
}

impl Points {
    /// - `neighbors`: of each face, across the edge opposite to each corner; see [`smooth_neighbors`](super::edges::smooth_neighbors)
    /// - `numbers`: among the texels that are baked
    pub(super) fn new(
        laid_out: &LaidOut,
        scene: &Scene,
        neighbors: &[[u32; 3]],
        numbers: impl IntoIterator<Item = usize>,
    ) -> Self {
        let LaidOut { layout, raster, texels, .. } = laid_out;
        let mut points = Self::default();
        for texel in numbers.into_iter().map(|number| texels[number] as usize) {
            let (face, weights) = place(layout, neighbors, texel, raster.faces[texel] as usize);
            let normal = normal(layout, face, weights);
            points.origins.push(origin(layout, scene, face, weights, normal));
            points.normals.push(normal.as_vec3().to_array());
        }
        points
    }
}

/// The face, and the weights of its corners, at the point that a texel stands for: the one below its centre, or if that lies off the chart,
/// as far across the edge on the next face; where the surface ends or has a crease, the nearest point.
fn place(layout: &Layout, neighbors: &[[u32; 3]], texel: usize, face: usize) -> (usize, [f64; 3]) {
    let corners = layout.corners(face);
    let found = copies(layout, texel).map(|center| (nearest(corners, center), center));
    let by_distance =
        |a: &(Nearest, DVec2), b: &(Nearest, DVec2)| a.0.distance_squared.total_cmp(&b.0.distance_squared);
    let Some((found, center)) = found.min_by(by_distance) else { return (face, [1.0, 0.0, 0.0]) };
    if found.distance_squared <= ON_FACE * ON_FACE {
        return (face, found.weights);
    }
    walk(layout, neighbors, face, corners, center)
}

/// Walks from a face to a point in its plane, over the edges where the surface goes on smoothly, and turns the plane with each face. Ends in
/// the face that the point then lies in, or at the nearest point of the last one.
///
/// - `corners`: of the face, in any affine picture of its plane
fn walk(
    layout: &Layout,
    neighbors: &[[u32; 3]],
    mut face: usize,
    mut corners: [DVec2; 3],
    mut point: DVec2,
) -> (usize, [f64; 3]) {
    for _ in 0..MOST_STEPS {
        match beyond(corners, point) {
            Some((k, weights)) if neighbors[face][k] != NO_FACE => {
                let next = neighbors[face][k] as usize;
                (corners, point) = unrolled(layout, face, k, weights, next);
                face = next;
            }
            _ => break,
        }
    }
    (face, nearest(corners, point).weights)
}

/// The corners of the next face and a point in the plane of a face, both planes unrolled about their common edge, which is opposite to
/// corner `k`: it lies along x, and the next face above it.
fn unrolled(layout: &Layout, face: usize, k: usize, weights: [f64; 3], next: usize) -> ([DVec2; 3], DVec2) {
    let own = corners(layout, face);
    let (a, b) = (own[(k + 1) % 3], own[(k + 2) % 3]);
    let along = unit_vector(b - a);
    let flat = |point: DVec3| DVec2::new((point - a).dot(along), (point - a).reject_from(along).length());
    (corners(layout, next).map(flat), flat(blend(weights, own)))
}

/// The centre of a texel, and where the atlas wraps round its copies near the atlas: a face that begins on it may end one size further.
fn copies(layout: &Layout, texel: usize) -> impl Iterator<Item = DVec2> {
    let grid = layout.grid;
    let turns = |wraps: bool| if wraps { -1..=2 } else { 0..=0 };
    let turns =
        turns(grid.wraps[0]).flat_map(move |x| turns(grid.wraps[1]).map(move |y| DVec2::new(x.into(), y.into())));
    turns.map(move |turn| grid.center(texel) + turn * grid.size())
}

/// The smooth normal; that of the face where the corners' cancel.
fn normal(layout: &Layout, face: usize, weights: [f64; 3]) -> DVec3 {
    let triangle = layout.mesh.triangles()[face];
    let normals = triangle.map(|vertex| Vec3::from_array(layout.mesh.normals()[vertex as usize]).as_dvec3());
    let mean = unit_vector(blend(weights, normals));
    if mean == DVec3::ZERO {
        let [a, b, c] = corners(layout, face);
        return unit_vector(unit_vector(b - a).cross(unit_vector(c - a)));
    }
    mean
}

/// Just outside of the face, and from there up to the smooth surface.
fn origin(layout: &Layout, scene: &Scene, face: usize, weights: [f64; 3], normal: DVec3) -> Vec3 {
    let corners = corners(layout, face);
    let (origin, lift) = (face_origin(scene, corners, weights, normal), lift(layout, face, weights));
    let position = blend(weights, corners);
    let lift_here = scene.to_unit_cube(position + lift) - scene.to_unit_cube(position);
    if lift_here != Vec3::ZERO && is_free(scene, origin, lift_here.normalize(), HEADROOM * lift.length()) {
        return origin + lift_here;
    }
    origin
}

/// From a point of a face to the smooth surface above it, as far as that bulges outwards: the mean of the feet of the point on the tangent
/// planes of the corners. Without it the smooth normals of a coarse mesh see its own faces, and every edge shows in shadows. Source:
/// J. Hanika, *Hacking the Shadow Terminator*, Ray Tracing Gems II, 2021.
fn lift(layout: &Layout, face: usize, weights: [f64; 3]) -> DVec3 {
    let corners = corners(layout, face);
    let position = blend(weights, corners);
    let normals = layout.mesh.triangles()[face].map(|vertex| layout.mesh.normals()[vertex as usize]);
    let normals = normals.map(|normal| Vec3::from_array(normal).as_dvec3());
    blend(weights, [0, 1, 2].map(|k| (corners[k] - position).dot(normals[k]).max(0.0) * normals[k]))
}

/// Whether nothing is nearer than `distance`, in scene units, in some direction.
fn is_free(scene: &Scene, origin: Vec3, direction: Vec3, distance: f64) -> bool {
    let (packet, mut hits) = (Packet::new(&[direction]), Hits::default());
    scene.closest_packet(origin, &packet, packet.all(), &mut hits, &mut Stack::default());
    scene.hit(&hits, 0).is_none_or(|hit| hit.distance > distance)
}

fn corners(layout: &Layout, face: usize) -> [DVec3; 3] {
    layout.mesh.triangles()[face].map(|vertex| DVec3::from_array(layout.mesh.positions()[vertex as usize]))
}

fn blend(weights: [f64; 3], values: [DVec3; 3]) -> DVec3 {
    weights[0] * values[0] + weights[1] * values[1] + weights[2] * values[2]
}
