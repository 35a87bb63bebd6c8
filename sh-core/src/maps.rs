//! Geometry of maps of the sphere: which direction a texel has, and how much of the sphere it covers.

use core::f64::consts::{PI, TAU};

use crate::Real;

/// A latitude-longitude map, y up, oriented as Mitsuba's `envmap`.
///
/// `u = atan2(x, −z) / 2π` in `[0, 1)`, `v = acos(y) / π`: the top row is +y, the left edge is −z, and x grows to the right
/// of it: at `v = ½`, `u = 0, ¼, ½, ¾` are −z, +x, +z, −x. Texel (0, 0) is at the top left, images are row-major:
/// `pixels[row * width + column]`.
///
/// Continuous texel coordinates put the centre of texel `i` at `i + ½`.
///
/// ```
/// let map = sh_core::LatLong { width: 8, height: 4 };
/// let [x, y, z] = map.direction(2.0, 2.0); // a quarter of the way, on the equator
/// assert!((x - 1.0).abs() < 1e-15 && y.abs() < 1e-15 && z.abs() < 1e-15);
/// assert_eq!(map.texel([0.0, 0.0, -1.0]), (0.0, 2.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(::serde::Serialize, ::serde::Deserialize))]
pub struct LatLong {
    /// Texels around the equator.
    pub width: usize,
    /// Texels from pole to pole.
    pub height: usize,
}

impl LatLong {
    /// The number of texels, `width · height`.
    pub const fn texel_count(&self) -> usize {
        self.width * self.height
    }

    /// The unit direction at continuous texel coordinates.
    pub fn direction(&self, x: f64, y: f64) -> [f64; 3] {
        let longitude = TAU * (x / self.width as f64);
        let latitude = PI * (y / self.height as f64);
        let radius = Real::sin(latitude);
        [radius * Real::sin(longitude), Real::cos(latitude), -radius * Real::cos(longitude)]
    }

    /// The continuous texel coordinates of a direction, in `[0, width)` and `[0, height]`.
    ///
    /// The direction need not be of unit length. At the poles, and for the zero vector, the longitude is that of `atan2(±0,
    /// ±0)`.
    pub fn texel(&self, [x, y, z]: [f64; 3]) -> (f64, f64) {
        let mut u = x.atan2(-z) / TAU;
        if u < 0.0 {
            u += 1.0;
        }
        let column = u * self.width as f64;
        // A tiny negative longitude rounds up to a full turn, which is the left edge.
        let column = if column < self.width as f64 { column } else { 0.0 };
        let latitude = x.hypot(z).atan2(y);
        (column, latitude / PI * self.height as f64)
    }

    /// The solid angle of each texel of a row, exact: `2π/width · (cos θ_top − cos θ_bottom)`.
    ///
    /// Over all texels it adds up to 4π. `row` is below the height, which is not checked.
    pub fn solid_angle(&self, row: usize) -> f64 {
        let step = PI / self.height as f64;
        // A difference of cosines as a product of sines: exact in thin rows too.
        let band = 2.0 * Real::sin((row as f64 + 0.5) * step) * Real::sin(0.5 * step);
        TAU / self.width as f64 * band
    }
}

/// A cube map: six square faces in the order +x −x +y −y +z −z.
///
/// Faces are oriented as OpenGL's, which is how images named `px nx py ny pz nz` are stored: with `s` to the right and `t`
/// down, both in `[−1, 1]`, the direction before normalisation is
///
/// | face | 0: +x | 1: −x | 2: +y | 3: −y | 4: +z | 5: −z |
/// |---|---|---|---|---|---|---|
/// | `(x, y, z)` | `(1, −t, −s)` | `(−1, −t, s)` | `(s, 1, t)` | `(s, −1, −t)` | `(s, −t, 1)` | `(−s, −t, −1)` |
///
/// OpenGL's convention is left-handed: photographs that are stored like this surround a viewer in a right-handed scene as
/// their mirror image, while [`LatLong`] shows them as they are. Where that matters, negate x, of directions, or of a light
/// with `ShRotation` and the matrix diag(−1, 1, 1).
///
/// Each face is row-major: `face[row * size + column]`. Continuous texel coordinates put the centre of texel `i` at `i + ½`.
///
/// ```
/// let map = sh_core::CubeMap { size: 4 };
/// assert_eq!(map.direction(0, 2.0, 2.0), [1.0, 0.0, 0.0]); // the middle of the first face
/// assert_eq!(map.texel([0.0, -1.0, 0.0]), (3, 2.0, 2.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(::serde::Serialize, ::serde::Deserialize))]
pub struct CubeMap {
    /// Texels along an edge.
    pub size: usize,
}

/// For each face, the direction as rows `(s, t, 1)`: `x = row · (s, t, 1)`, and so on.
pub(crate) const FACES: [[[f64; 3]; 3]; 6] = [
    [[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [-1.0, 0.0, 0.0]],
    [[0.0, 0.0, -1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]],
    [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]],
    [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, -1.0, 0.0]],
    [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]],
    [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]],
];

impl CubeMap {
    /// The number of texels of all faces, `6 size²`.
    pub const fn texel_count(&self) -> usize {
        6 * self.size * self.size
    }

    /// The unit direction at continuous texel coordinates of a face.
    ///
    /// # Panics
    /// If `face` is not in `0..6`.
    pub fn direction(&self, face: usize, x: f64, y: f64) -> [f64; 3] {
        let [s, t] = [self.centred(x), self.centred(y)];
        let length = Real::sqrt(s * s + t * t + 1.0);
        FACES[face].map(|[a, b, c]| (a * s + b * t + c) / length)
    }

    /// The face of a direction, and its continuous texel coordinates there, in `[0, size]`.
    ///
    /// The direction need not be of unit length. On an edge either face may be given; the zero vector gives the middle of
    /// face 0.
    pub fn texel(&self, direction: [f64; 3]) -> (usize, f64, f64) {
        let [x, y, z] = direction.map(f64::abs);
        let axis = if x >= y && x >= z {
            0
        } else if y >= z {
            1
        } else {
            2
        };
        let depth = direction[axis].abs();
        let face = 2 * axis + usize::from(direction[axis] < 0.0);
        // The rows of a face are orthonormal: its transpose takes the direction back to (s, t, depth).
        let along = |column: usize| {
            let sum: f64 = (0..3).map(|row| FACES[face][row][column] * direction[row]).sum();
            if depth > 0.0 { sum / depth } else { 0.0 }
        };
        (face, self.uncentred(along(0)), self.uncentred(along(1)))
    }

    /// The solid angle of a texel, the same on every face, exact to rounding at any size.
    ///
    /// Over all texels it adds up to 4π. Source: [OS83](crate#references), two triangles.
    pub fn solid_angle(&self, x: usize, y: usize) -> f64 {
        let [s0, s1] = [self.centred(x as f64), self.centred(x as f64 + 1.0)];
        let [t0, t1] = [self.centred(y as f64), self.centred(y as f64 + 1.0)];
        let corners = [[s0, t0, 1.0], [s1, t0, 1.0], [s1, t1, 1.0], [s0, t1, 1.0]];
        let volume = (s1 - s0) * (t1 - t0);
        triangle(corners[0], corners[1], corners[2], volume) + triangle(corners[0], corners[2], corners[3], volume)
    }

    /// Texel coordinates to `[−1, 1]`.
    fn centred(&self, x: f64) -> f64 {
        (2.0 * x - self.size as f64) / self.size as f64
    }

    /// `[−1, 1]` to texel coordinates.
    fn uncentred(&self, s: f64) -> f64 {
        0.5 * (s + 1.0) * self.size as f64
    }
}

/// The solid angle of a triangle seen from the origin; `volume` is the determinant of its corners. No cancellation for thin
/// ones.
fn triangle(a: [f64; 3], b: [f64; 3], c: [f64; 3], volume: f64) -> f64 {
    let dot = |p: [f64; 3], q: [f64; 3]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    let length = |p| Real::sqrt(dot(p, p));
    let [la, lb, lc] = [length(a), length(b), length(c)];
    2.0 * Real::atan2(volume, la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb)
}

#[cfg(all(test, feature = "alloc"))]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use super::*;
    use crate::fibonacci;

    fn assert_near(a: [f64; 3], b: [f64; 3]) {
        let distance = (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max);
        // A few roundings of u, up to 1, times 2π.
        assert!(distance < 2.5e-15, "{a:?} {b:?}");
    }

    fn normalised(v: [f64; 3]) -> [f64; 3] {
        let length = v.iter().map(|v| v * v).sum::<f64>().sqrt();
        v.map(|v| v / length)
    }

    #[test]
    fn lat_long_is_oriented_as_mitsubas() {
        let map = LatLong { width: 400, height: 200 };
        // u = atan2(x, −z)/2π, v = acos(y)/π
        assert_near(map.direction(0.0, 100.0), [0.0, 0.0, -1.0]);
        assert_near(map.direction(100.0, 100.0), [1.0, 0.0, 0.0]);
        assert_near(map.direction(200.0, 100.0), [0.0, 0.0, 1.0]);
        assert_near(map.direction(300.0, 100.0), [-1.0, 0.0, 0.0]);
        assert_near(map.direction(123.0, 0.0), [0.0, 1.0, 0.0]);
        assert_near(map.direction(50.0, 150.0), normalised([0.5, -(0.5_f64.sqrt()), -0.5]));
        // The middle of the top left texel, from the definition.
        let [x, y, z] = map.direction(0.5, 0.5);
        assert!((x.atan2(-z) / TAU - 0.5 / 400.0).abs() < 1e-15);
        assert!((y.acos() / PI - 0.5 / 200.0).abs() < 1e-13);
    }

    #[test]
    fn lat_long_texels_and_directions_go_round() {
        let map = LatLong { width: 37, height: 20 };
        for (column, row) in (0..37).flat_map(|x| (0..20).map(move |y| (x as f64 + 0.5, y as f64 + 0.5))) {
            let (x, y) = map.texel(map.direction(column, row));
            assert!((x - column).abs() < 1e-12 && (y - row).abs() < 1e-13, "{column} {row}: {x} {y}");
        }
        for direction in fibonacci(1000) {
            let (x, y) = map.texel(direction);
            assert!((0.0..37.0).contains(&x) && (0.0..=20.0).contains(&y));
            assert_near(map.direction(x, y), direction);
            assert_eq!(map.texel(direction.map(|d| d * 0.25)), (x, y), "the length does not matter");
        }
    }

    #[test]
    fn lat_long_has_no_hole_at_the_seam_and_poles() {
        let map = LatLong { width: 64, height: 32 };
        assert_eq!(map.texel([-1e-300, 0.0, -1.0]).0, 0.0, "just left of the edge rounds to the edge");
        assert!(map.texel([-1e-6, 0.0, -1.0]).0 > 63.99);
        assert_eq!(map.texel([0.0, 1.0, 0.0]).1, 0.0);
        assert_eq!(map.texel([0.0, -1.0, 0.0]).1, 32.0);
        let (x, y) = map.texel([0.0; 3]);
        assert!((0.0..64.0).contains(&x) && (0.0..=32.0).contains(&y));
    }

    #[test]
    fn solid_angles_add_up_to_the_sphere() {
        for (width, height) in [(1, 1), (2, 1), (3, 5), (1024, 512), (7, 4096)] {
            let map = LatLong { width, height };
            let sum: f64 = (0..height).map(|row| width as f64 * map.solid_angle(row)).sum();
            assert!((sum / (4.0 * PI) - 1.0).abs() < 1e-14, "{width}x{height}: {sum}");
        }
        for size in [1, 2, 3, 16, 255] {
            let map = CubeMap { size };
            let texels = (0..size).flat_map(|x| (0..size).map(move |y| (x, y)));
            let sum: f64 = texels.map(|(x, y)| 6.0 * map.solid_angle(x, y)).sum();
            assert!((sum / (4.0 * PI) - 1.0).abs() < 1e-13, "{size}: {sum}");
        }
    }

    #[test]
    fn solid_angles_are_closed_forms() {
        // The cap of the top row, and a quarter of a face.
        let map = LatLong { width: 10, height: 6 };
        assert!((map.solid_angle(0) - TAU / 10.0 * (1.0 - (PI / 6.0).cos())).abs() < 1e-16);
        assert!((CubeMap { size: 2 }.solid_angle(1, 0) - PI / 6.0).abs() < 1e-15);
        // The corner texel: the antiderivative atan(st/√(1+s²+t²)) at its four corners.
        let corner = |s: f64, t: f64| (s * t).atan2((1.0 + s * s + t * t).sqrt());
        let (a, b) = (0.5, 1.0);
        let expected = corner(b, b) - 2.0 * corner(a, b) + corner(a, a);
        assert!((CubeMap { size: 4 }.solid_angle(3, 0) - expected).abs() < 1e-15);
        // A texel so small that this antiderivative would lose half of its digits: area over distance³.
        let size = 1 << 20;
        let [s, t] = [1.0 / size as f64; 2];
        let expected = 4.0 / (size as f64 * size as f64) * (1.0 + s * s + t * t).powf(-1.5);
        let angle = CubeMap { size }.solid_angle(size / 2, size / 2);
        assert!((angle / expected - 1.0).abs() < 1e-11, "{angle} {expected}");
    }

    #[test]
    fn cube_faces_are_opengls() {
        let map = CubeMap { size: 8 };
        // Table 8.19 of the OpenGL 4.6 specification: s_c, t_c and m_a of each face; s = (s_c/|m_a| + 1)/2.
        let expected = |face: usize, [x, y, z]: [f64; 3]| match face {
            0 => (-z, -y, x),
            1 => (z, -y, -x),
            2 => (x, z, y),
            3 => (x, -z, -y),
            4 => (x, -y, z),
            _ => (-x, -y, -z),
        };
        for face in 0..6 {
            for (x, y) in [(0.5, 0.5), (7.5, 0.5), (2.25, 6.0), (4.0, 4.0)] {
                let direction = map.direction(face, x, y);
                let (s, t, major) = expected(face, direction);
                assert!(major > 0.0, "face {face} looks along its axis");
                assert!(((s / major + 1.0) * 4.0 - x).abs() < 1e-14, "face {face}");
                assert!(((t / major + 1.0) * 4.0 - y).abs() < 1e-14, "face {face}");
            }
        }
        // As images: the top left corner of each face.
        let corners = [
            [1.0, 1.0, 1.0],
            [-1.0, 1.0, -1.0],
            [-1.0, 1.0, -1.0],
            [-1.0, -1.0, 1.0],
            [-1.0, 1.0, 1.0],
            [1.0, 1.0, -1.0],
        ];
        for (face, corner) in corners.into_iter().enumerate() {
            assert_near(map.direction(face, 0.0, 0.0), normalised(corner));
        }
    }

    #[test]
    fn cube_faces_meet_at_their_seams() {
        let map = CubeMap { size: 4 };
        for at in [0.0, 1.3, 2.0, 4.0] {
            // Around the horizon +z +x −z −x, left to right; the top of +z is the bottom of +y, its bottom the top of −y.
            for (left, right) in [(4, 0), (0, 5), (5, 1), (1, 4)] {
                assert_near(map.direction(left, 4.0, at), map.direction(right, 0.0, at));
            }
            assert_near(map.direction(4, at, 0.0), map.direction(2, at, 4.0));
            assert_near(map.direction(4, at, 4.0), map.direction(3, at, 0.0));
            assert_near(map.direction(0, at, 0.0), map.direction(2, 4.0, 4.0 - at));
            assert_near(map.direction(1, at, 4.0), map.direction(3, 0.0, 4.0 - at));
        }
    }

    #[test]
    fn cube_texels_and_directions_go_round() {
        let map = CubeMap { size: 5 };
        let centres: Vec<f64> = (0..5).map(|i| f64::from(i) + 0.5).collect();
        for face in 0..6 {
            for (&x, &y) in centres.iter().flat_map(|x| centres.iter().map(move |y| (x, y))) {
                let (face_back, x_back, y_back) = map.texel(map.direction(face, x, y));
                assert_eq!(face_back, face);
                assert!((x_back - x).abs() < 1e-14 && (y_back - y).abs() < 1e-14);
            }
        }
        for direction in fibonacci(1000) {
            let (face, x, y) = map.texel(direction);
            assert_near(map.direction(face, x, y), direction);
        }
        assert_eq!(map.texel([0.0; 3]), (0, 2.5, 2.5));
    }
}
