//! Triangles as seen from the origin of rays: three planes through it, one for each edge.
//!
//! A ray meets a triangle if it lies on the inner side of all three planes: three dot products a ray and no division. It is watertight:
//! neighbours compute the plane of their common edge with the same operations and opposite sign, and triangles are wider by the rounding
//! of these planes, so that no gap opens where many of them meet in a corner.

#![expect(clippy::needless_range_loop, reason = "plain loops over lanes are vectorised; see `lanes`")]

use glam::Vec3;

use super::beam::Beam;
use super::lanes::{LANES, Lanes, WIDTH, Wide, larger, mask, smaller, wide_bits};
use super::tree::Leaf;

/// The product of a direction with `a × b` is computed with an error of at most about this times the largest component of a times that
/// of b: four roundings a component, and four more for the product with a direction.
const PLANE_TOLERANCE: f32 = 8.0 * f32::EPSILON;

/// Corners of a beam are outside or inside of a plane for certain if they are by this many times the tolerance of the plane: rays are
/// sums of corners times at least 0.3 ([`Beam`]), and both products are rounded.
const BEAM_MARGIN: f32 = 16.0;

/// The triangles of a leaf as seen from an origin.
pub(super) struct Wedges {
    /// Inner normals of the planes opposite to corner 0, 1, 2: `[corner][axis]`.
    planes: [[Wide<f32>; 3]; 3],
    /// A ray is inside if its product with no plane is less than minus this.
    tolerance: [Wide<f32>; 3],
    /// Normal of the triangle away from the origin, with the length of twice its area.
    normal: [Wide<f32>; 3],
    /// Six times the volume of the tetrahedron of origin and triangle. Zero if the origin lies in the plane of the triangle, which then
    /// meets no ray.
    volume: Wide<f32>,
    /// All bits set if corners run counter-clockwise as seen from the origin.
    is_front: Wide<u32>,
}

/// One triangle of a leaf.
pub(super) struct Wedge {
    pub(super) planes: [Vec3; 3],
    pub(super) tolerance: [f32; 3],
}

impl Wedges {
    #[inline(always)]
    pub(super) fn new(leaf: &Leaf, origin: Vec3) -> Self {
        let mut wedges = Self {
            planes: [[[0.0; WIDTH]; 3]; 3],
            tolerance: [[0.0; WIDTH]; 3],
            normal: [[0.0; WIDTH]; 3],
            volume: [0.0; WIDTH],
            is_front: [0; WIDTH],
        };
        if leaf.outline.is_far_from(origin) {
            wedges.fill(leaf, origin, |a, _, _| a, far_edge_plane);
        } else {
            wedges.fill(leaf, origin, nearest, edge_plane);
        }
        wedges
    }

    #[inline(always)]
    fn fill(
        &mut self,
        leaf: &Leaf,
        origin: Vec3,
        nearest: impl Fn([f32; 3], [f32; 3], [f32; 3]) -> [f32; 3],
        edge_plane: impl Fn([f32; 3], [f32; 3]) -> ([f32; 3], f32),
    ) {
        let [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = &leaf.corners;
        for lane in 0..WIDTH {
            let a = [ax[lane] - origin.x, ay[lane] - origin.y, az[lane] - origin.z];
            let b = [bx[lane] - origin.x, by[lane] - origin.y, bz[lane] - origin.z];
            let c = [cx[lane] - origin.x, cy[lane] - origin.y, cz[lane] - origin.z];
            let normal = cross(difference(b, a), difference(c, a));
            // Any corner will do. The rounding of the normal, which is large where the face is a needle, counts least with the nearest.
            let volume = dot(nearest(a, b, c), normal);
            let sign = if volume < 0.0 { -1.0 } else { 1.0 };
            // The front, from which corners run counter-clockwise, turns to the origin if the normal does.
            self.is_front[lane] = mask(volume < 0.0);
            self.volume[lane] = volume * sign;
            for axis in 0..3 {
                self.normal[axis][lane] = normal[axis] * sign;
            }
            let (plane_a, tolerance_a) = edge_plane(b, c);
            let (plane_b, tolerance_b) = edge_plane(c, a);
            let (plane_c, tolerance_c) = edge_plane(a, b);
            for axis in 0..3 {
                self.planes[0][axis][lane] = plane_a[axis] * sign;
                self.planes[1][axis][lane] = plane_b[axis] * sign;
                self.planes[2][axis][lane] = plane_c[axis] * sign;
            }
            self.tolerance[0][lane] = tolerance_a;
            self.tolerance[1][lane] = tolerance_b;
            self.tolerance[2][lane] = tolerance_c;
        }
    }

    /// A bit for each triangle that rays of the beam may meet, and for each that all of them meet.
    #[inline(always)]
    pub(super) fn against(&self, beam: &Beam) -> (u32, u32) {
        let (mut may_meet, mut covers) = ([0; WIDTH], [0; WIDTH]);
        for lane in 0..WIDTH {
            let (mut may, mut all) = (mask(self.volume[lane] > 0.0), mask(self.volume[lane] > 0.0));
            for plane in 0..3 {
                let [x, y, z] = &self.planes[plane];
                let normal = [x[lane], y[lane], z[lane]];
                let [p, q, r, s] = beam.corners;
                let (p, q, r, s) = (dot(normal, p), dot(normal, q), dot(normal, r), dot(normal, s));
                let margin = BEAM_MARGIN * self.tolerance[plane][lane];
                may &= mask(larger(larger(p, q), larger(r, s)) >= -margin);
                all &= mask(smaller(smaller(p, q), smaller(r, s)) > margin);
            }
            (may_meet[lane], covers[lane]) = (may, all);
        }
        (wide_bits(&may_meet), wide_bits(&covers))
    }

    /// For one ray and each triangle the barycentric weights, times a common factor, and whether the ray is inside.
    #[inline(always)]
    pub(super) fn meets_ray(&self, direction: Vec3) -> ([Wide<f32>; 3], Wide<u32>) {
        let (mut weights, mut inside) = ([[0.0; WIDTH]; 3], [0; WIDTH]);
        let [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = &self.planes;
        let [s, t, u] = &self.tolerance;
        for lane in 0..WIDTH {
            let a = ax[lane] * direction.x + ay[lane] * direction.y + az[lane] * direction.z;
            let b = bx[lane] * direction.x + by[lane] * direction.y + bz[lane] * direction.z;
            let c = cx[lane] * direction.x + cy[lane] * direction.y + cz[lane] * direction.z;
            inside[lane] =
                mask(self.volume[lane] > 0.0) & mask(a >= -s[lane]) & mask(b >= -t[lane]) & mask(c >= -u[lane]);
            (weights[0][lane], weights[1][lane], weights[2][lane]) = (a, b, c);
        }
        (weights, inside)
    }

    /// Distance along a direction that meets a triangle.
    ///
    /// - `near`, `far`: where the ray passes the box of the leaf; they bound the result where the triangle is seen edge on
    #[inline(always)]
    pub(super) fn distance(&self, lane: usize, direction: Vec3, near: f32, far: f32) -> f32 {
        let [x, y, z] = &self.normal;
        let slope = x[lane] * direction.x + y[lane] * direction.y + z[lane] * direction.z;
        let distance = if slope > 0.0 { self.volume[lane] / slope } else { far };
        larger(smaller(distance, far), near)
    }

    /// Whether corners run counter-clockwise as seen from the origin.
    #[inline(always)]
    pub(super) fn is_front(&self, lane: usize) -> bool {
        self.is_front[lane] != 0
    }

    #[inline(always)]
    pub(super) fn get(&self, slot: usize) -> Wedge {
        let vector = |v: &[Wide<f32>; 3]| Vec3::new(v[0][slot], v[1][slot], v[2][slot]);
        Wedge {
            planes: [vector(&self.planes[0]), vector(&self.planes[1]), vector(&self.planes[2])],
            tolerance: [self.tolerance[0][slot], self.tolerance[1][slot], self.tolerance[2][slot]],
        }
    }
}

impl Wedge {
    /// Marks the rays of a block that are inside.
    #[inline(always)]
    pub(super) fn hide(&self, direction: &[Lanes<f32>; 3], hidden: &mut Lanes<u32>) {
        let [x, y, z] = direction;
        let mut inside = [u32::MAX; LANES];
        for plane in 0..3 {
            let (normal, tolerance) = (self.planes[plane], self.tolerance[plane]);
            for lane in 0..LANES {
                let weight = normal.x * x[lane] + normal.y * y[lane] + normal.z * z[lane];
                inside[lane] &= mask(weight >= -tolerance);
            }
        }
        for lane in 0..LANES {
            hidden[lane] |= inside[lane];
        }
    }
}

/// Twice `p × q`, the normal of the plane through the origin and an edge, and the tolerance of products with it.
///
/// Far away it is `(p + q) × (q − p)`, which is exact to the rounding of an angle however short the edge. Where a corner lies next to the
/// origin and the other does not, `p × 2q` is. The one with the smaller tolerance is taken: an angle of rounding either way, so that a
/// face beside which a ray starts does not reach beyond its edges.
#[inline(always)]
fn edge_plane(p: [f32; 3], q: [f32; 3]) -> ([f32; 3], f32) {
    let (sum, edge) = ([p[0] + q[0], p[1] + q[1], p[2] + q[2]], difference(q, p));
    let far = size(sum) * size(edge);
    let near = 2.0 * size(p) * size(q);
    let is_near = near < far;
    let a =
        [if is_near { p[0] } else { sum[0] }, if is_near { p[1] } else { sum[1] }, if is_near { p[2] } else { sum[2] }];
    let b = [
        if is_near { 2.0 * q[0] } else { edge[0] },
        if is_near { 2.0 * q[1] } else { edge[1] },
        if is_near { 2.0 * q[2] } else { edge[2] },
    ];
    (cross(a, b), PLANE_TOLERANCE * smaller(near, far))
}

/// The same where no corner is nearer to the origin than to the other.
#[inline(always)]
fn far_edge_plane(p: [f32; 3], q: [f32; 3]) -> ([f32; 3], f32) {
    let (sum, edge) = ([p[0] + q[0], p[1] + q[1], p[2] + q[2]], difference(q, p));
    (cross(sum, edge), PLANE_TOLERANCE * (size(sum) * size(edge)))
}

/// That of three points which lies nearest to the origin.
#[inline(always)]
fn nearest(a: [f32; 3], b: [f32; 3], c: [f32; 3]) -> [f32; 3] {
    let nearer = |a: [f32; 3], b: [f32; 3]| {
        let is_b = size(b) < size(a);
        [if is_b { b[0] } else { a[0] }, if is_b { b[1] } else { a[1] }, if is_b { b[2] } else { a[2] }]
    };
    nearer(nearer(a, b), c)
}

/// Largest component.
#[inline(always)]
fn size([x, y, z]: [f32; 3]) -> f32 {
    larger(larger(x.abs(), y.abs()), z.abs())
}

#[inline(always)]
fn difference(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
