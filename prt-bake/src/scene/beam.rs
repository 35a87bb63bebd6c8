//! What encloses the rays of a packet or of a bin of packets, and which boxes it misses.

#![expect(clippy::needless_range_loop, reason = "plain loops over lanes are vectorised; see `lanes`")]

use glam::Vec3;

use super::lanes::{WIDTH, Wide, larger, mask, wide_bits};
use super::rectangle::Rectangle;
use super::tree::{Leaf, Node};

/// A pyramid from the origin that encloses directions.
#[derive(Debug, Clone)]
pub(crate) struct Beam {
    /// Inner normals of four planes through the origin, at least 1 long; zero if the directions spread too far for that.
    planes: [Vec3; 4],
    /// Directions of its edges. Each enclosed direction is a sum of them with positive factors that add up to at least
    /// [`WIDEST_BEAM_COSINE`].
    pub(super) corners: [[f32; 3]; 4],
    /// Whether there are planes and corners.
    pub(super) is_narrow: bool,
    /// Mean of the directions.
    pub(super) mean: Vec3,
}

/// Rays that leave the mean direction by more than the angle with this cosine get no beam: its planes would not cull.
const WIDEST_BEAM_COSINE: f32 = 0.3;

/// The beam is wider than its directions by this slope: more than the rounding of slopes.
const SLOPE_MARGIN: f32 = 1e-6;

/// A box outside a plane by less than this is kept: above the rounding of the test, and above what triangles are widened by, for a
/// scene 1 across.
const PLANE_MARGIN: f32 = 4e-6;

impl Beam {
    /// Four planes around the directions, seen as points on a plane at distance 1 along their mean.
    pub(crate) fn new(directions: &[Vec3]) -> Self {
        let mean = directions.iter().sum::<Vec3>().normalize_or_zero();
        let mut beam = Self { planes: [Vec3::ZERO; 4], corners: [[0.0; 3]; 4], is_narrow: false, mean };
        if mean == Vec3::ZERO || directions.iter().any(|direction| direction.dot(mean) < WIDEST_BEAM_COSINE) {
            return beam;
        }
        let Rectangle { axes: [u, v], slopes } = Rectangle::around(directions, mean);
        let (lower, upper) =
            (slopes.map(|[lower, _]| lower - SLOPE_MARGIN), slopes.map(|[_, upper]| upper + SLOPE_MARGIN));
        let corner = |x: f32, y: f32| (mean + x * u + y * v).to_array();
        beam.planes = [u - lower[0] * mean, upper[0] * mean - u, v - lower[1] * mean, upper[1] * mean - v];
        beam.corners = [
            corner(lower[0], lower[1]),
            corner(upper[0], lower[1]),
            corner(upper[0], upper[1]),
            corner(lower[0], upper[1]),
        ];
        beam.is_narrow = true;
        beam
    }
}

/// The planes of a beam from an origin, and that of the horizon.
pub(super) struct Culling {
    planes: [CullingPlane; 5],
    count: usize,
}

#[derive(Clone, Copy, Default)]
struct CullingPlane {
    normal: [f32; 3],
    /// For each axis the side of a box that lies farther inside.
    side: [usize; 3],
    /// What lies inside has no smaller product with the normal.
    limit: f32,
}

impl CullingPlane {
    #[inline(always)]
    fn new(normal: Vec3, origin: Vec3) -> Self {
        let side = [usize::from(normal.x > 0.0), usize::from(normal.y > 0.0), usize::from(normal.z > 0.0)];
        Self { normal: normal.to_array(), side, limit: normal.dot(origin) - PLANE_MARGIN }
    }
}

impl Culling {
    /// `horizon`: the normal of a plane through the origin below which there is no ray; zero if there is none.
    #[inline(always)]
    pub(super) fn new(beam: Option<&Beam>, horizon: Vec3, origin: Vec3) -> Self {
        let mut culling = Self { planes: [CullingPlane::default(); 5], count: 0 };
        if let Some(beam) = beam.filter(|beam| beam.is_narrow) {
            for plane in beam.planes {
                culling.add(plane, origin);
            }
        }
        if horizon != Vec3::ZERO {
            culling.add(horizon, origin);
        }
        culling
    }

    #[inline(always)]
    fn add(&mut self, normal: Vec3, origin: Vec3) {
        self.planes[self.count] = CullingPlane::new(normal, origin);
        self.count += 1;
    }

    /// A bit for each child of a node whose box may be met.
    #[inline(always)]
    pub(super) fn children(&self, node: &Node) -> u32 {
        let mut outside = [0; WIDTH];
        for plane in &self.planes[..self.count] {
            let [x, y, z] = plane.normal;
            let (bx, by, bz) = (
                &node.bounds[plane.side[0] & 1][0],
                &node.bounds[plane.side[1] & 1][1],
                &node.bounds[plane.side[2] & 1][2],
            );
            for lane in 0..WIDTH {
                let reach = x * bx[lane] + y * by[lane] + z * bz[lane];
                outside[lane] |= mask(reach < plane.limit);
            }
        }
        node.used & !wide_bits(&outside)
    }

    /// A bit for each triangle of a leaf that has corners on the inner side of each plane.
    #[inline(always)]
    pub(super) fn triangles(&self, leaf: &Leaf) -> u32 {
        let mut outside = [0; WIDTH];
        for plane in &self.planes[..self.count] {
            let mut reach = [f32::NEG_INFINITY; WIDTH];
            for corner in &leaf.corners {
                for lane in 0..WIDTH {
                    let product = plane.normal[0] * corner[0][lane]
                        + plane.normal[1] * corner[1][lane]
                        + plane.normal[2] * corner[2][lane];
                    reach[lane] = larger(reach[lane], product);
                }
            }
            for lane in 0..WIDTH {
                outside[lane] |= mask(reach[lane] < plane.limit);
            }
        }
        !wide_bits(&outside) & ((1 << WIDTH) - 1)
    }
}

/// Numbers in the order of the distances of the middles of the boxes along a direction.
#[inline(always)]
pub(super) fn distances_along(node: &Node, along: Vec3) -> Wide<u32> {
    let mut distances = [0.0; WIDTH];
    for axis in 0..3 {
        for lane in 0..WIDTH {
            distances[lane] += along[axis] * (node.bounds[0][axis][lane] + node.bounds[1][axis][lane]);
        }
    }
    let mut ordered = [0; WIDTH];
    for lane in 0..WIDTH {
        // Made positive: boxes lie in a cube of side 1 around 0. Then bits are in the order of the numbers.
        ordered[lane] = larger(4.0 + distances[lane], 0.0).to_bits();
    }
    ordered
}

/// A bit for each child of a node whose box is wider than `ratio` times its distance.
#[inline(always)]
pub(super) fn wide_children(node: &Node, origin: Vec3, ratio: f32) -> u32 {
    let origin = origin.to_array();
    let (mut size, mut distance): (Wide<f32>, Wide<f32>) = ([0.0; WIDTH], [0.0; WIDTH]);
    for axis in 0..3 {
        let (lower, upper) = (&node.bounds[0][axis], &node.bounds[1][axis]);
        for lane in 0..WIDTH {
            let extent = upper[lane] - lower[lane];
            let center = 0.5 * (upper[lane] + lower[lane]) - origin[axis];
            size[lane] += extent * extent;
            distance[lane] += center * center;
        }
    }
    let mut wide = [0; WIDTH];
    for lane in 0..WIDTH {
        wide[lane] = mask(size[lane] > ratio * ratio * distance[lane]);
    }
    wide_bits(&wide)
}
