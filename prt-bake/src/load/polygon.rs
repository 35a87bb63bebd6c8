//! Polygons, as mesh files list them, to triangles.

use glam::{DVec2, DVec3};

use super::ear_clipping::EarClipper;
use crate::input::Fault;

/// The faces of a mesh: polygons of any number of corners.
#[derive(Debug, Default)]
pub(super) struct Polygons {
    /// Vertex numbers, face after face.
    corners: Vec<u32>,
    /// Corners of each face.
    sizes: Vec<u32>,
}

impl Polygons {
    /// Reserves room; the numbers must come from data that are there, not from a header.
    pub(super) fn with_capacity(faces: usize) -> Self {
        Self { corners: Vec::with_capacity(3 * faces), sizes: Vec::with_capacity(faces) }
    }

    /// Adds a face.
    pub(super) fn push(&mut self, corners: impl IntoIterator<Item = u32>) {
        let before = self.corners.len();
        self.corners.extend(corners);
        self.sizes.push((self.corners.len() - before) as u32);
    }

    /// [`triangulate_numbered`](Self::triangulate_numbered), without the numbers.
    pub(super) fn triangulate(&self, positions: &[[f64; 3]]) -> Result<Vec<[u32; 3]>, Fault> {
        self.triangulate_numbered(positions).map(|(triangles, _)| triangles)
    }

    /// Splits every face into triangles that keep its orientation, in the order of the faces; returns them, and for each the number of
    /// its face.
    ///
    /// A face of one or two corners becomes a degenerate triangle, so that whoever counts degenerate faces counts it;
    /// one of no corners vanishes. Quadrilaterals are cut along the diagonal that leaves two proper triangles.
    /// Larger faces become a fan where they are star-shaped about their first corner, as convex ones are, in linear time;
    /// others go to [`EarClipper`], whose time is bounded too. Nothing recurses.
    ///
    /// # Errors
    /// A corner past the end of `positions`; a concave polygon beyond the limits of [`EarClipper`].
    pub(super) fn triangulate_numbered(&self, positions: &[[f64; 3]]) -> Result<(Vec<[u32; 3]>, Vec<u32>), Fault> {
        let mut triangles = Vec::with_capacity(self.sizes.iter().map(|&size| size.saturating_sub(2) as usize).sum());
        let mut numbers = Vec::with_capacity(triangles.capacity());
        let mut clipper = EarClipper::default();
        let mut rest = self.corners.as_slice();
        for (face, &size) in self.sizes.iter().enumerate() {
            let (corners, after) = rest.split_at(size as usize);
            rest = after;
            check_range(face, corners, positions.len())?;
            split_face(face, corners, positions, &mut clipper, &mut triangles)?;
            numbers.resize(triangles.len(), face as u32);
        }
        Ok((triangles, numbers))
    }
}

fn check_range(face: usize, corners: &[u32], vertices: usize) -> Result<(), Fault> {
    match corners.iter().find(|&&corner| corner as usize >= vertices) {
        Some(corner) => Err(Fault::malformed(format!(
            "face {face} refers to vertex {corner} but there are {vertices} vertices (both counted from 0)"
        ))),
        None => Ok(()),
    }
}

fn split_face(
    face: usize,
    corners: &[u32],
    positions: &[[f64; 3]],
    clipper: &mut EarClipper,
    out: &mut Vec<[u32; 3]>,
) -> Result<(), Fault> {
    match *corners {
        [] => {}
        [a] => out.push([a, a, a]),
        [a, b] => out.push([a, b, b]),
        [a, b, c] => out.push([a, b, c]),
        [a, b, c, d] => out.extend(split_quadrilateral([a, b, c, d], positions)),
        _ => {
            let points = normalized_points(corners, positions);
            let normal = newell_normal(&points);
            if is_star_shaped_about_first(&points, normal) || !normal.is_finite() || normal == DVec3::ZERO {
                push_fan(corners, out);
            } else {
                let flat = project(&points, normal);
                clipper
                    .clip(&flat, |triangle| out.push(triangle.map(|corner| corners[corner as usize])))
                    .map_err(|reason| Fault::unsupported(format!("face {face}: {reason}")))?;
            }
        }
    }
    Ok(())
}

/// Two triangles on the diagonal 0-2, or on 1-3 where only that one leaves both with positive area.
fn split_quadrilateral(corners: [u32; 4], positions: &[[f64; 3]]) -> [[u32; 3]; 2] {
    let [a, b, c, d] = corners;
    let points = normalized_points(&corners, positions);
    let normal = newell_normal(&points);
    let faces_up =
        |i: usize, j: usize, k: usize| (points[j] - points[i]).cross(points[k] - points[i]).dot(normal) > 0.0;
    if !(faces_up(0, 1, 2) && faces_up(0, 2, 3)) && faces_up(1, 2, 3) && faces_up(1, 3, 0) {
        [[b, c, d], [b, d, a]]
    } else {
        [[a, b, c], [a, c, d]]
    }
}

fn push_fan(corners: &[u32], out: &mut Vec<[u32; 3]>) {
    out.extend(corners[1..].windows(2).map(|pair| [corners[0], pair[0], pair[1]]));
}

/// The corners relative to the first one, in units of the face's extent, so that products neither overflow nor vanish.
fn normalized_points(corners: &[u32], positions: &[[f64; 3]]) -> Vec<DVec3> {
    let point = |corner: u32| DVec3::from(positions[corner as usize]);
    let first = point(corners[0]);
    let extent = corners.iter().map(|&corner| (point(corner) - first).abs().max_element()).fold(0.0, f64::max);
    corners.iter().map(|&corner| (point(corner) - first) / extent).collect()
}

/// Twice the area vector of a polygon (Newell's sum), about its first point.
fn newell_normal(points: &[DVec3]) -> DVec3 {
    points[1..].windows(2).map(|pair| (pair[0] - points[0]).cross(pair[1] - points[0])).sum()
}

/// Whether every triangle of the fan about point 0 is seen from the side the whole polygon is seen from.
fn is_star_shaped_about_first(points: &[DVec3], normal: DVec3) -> bool {
    points[1..].windows(2).all(|pair| (pair[0] - points[0]).cross(pair[1] - points[0]).dot(normal) > 0.0)
}

/// Coordinates in the polygon's plane, in which it runs counter-clockwise.
fn project(points: &[DVec3], normal: DVec3) -> Vec<DVec2> {
    let (u, v) = normal.normalize().any_orthonormal_pair();
    points.iter().map(|point| DVec2::new(point.dot(u), point.dot(v))).collect()
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]

    use super::*;

    fn triangles_of(points: &[[f64; 3]]) -> Vec<[u32; 3]> {
        let mut polygons = Polygons::default();
        polygons.push(0..points.len() as u32);
        polygons.triangulate(points).unwrap()
    }

    fn area_vector(points: &[[f64; 3]], [a, b, c]: [u32; 3]) -> DVec3 {
        let [a, b, c] = [a, b, c].map(|i| DVec3::from(points[i as usize]));
        (b - a).cross(c - a) / 2.0
    }

    /// The triangles tile the polygon exactly if none is turned over and their areas add up to the polygon's.
    fn assert_tiles(points: &[[f64; 3]]) {
        let triangles = triangles_of(points);
        assert_eq!(triangles.len(), points.len() - 2);
        let whole =
            newell_normal(&points.iter().map(|&point| DVec3::from(point) - DVec3::from(points[0])).collect::<Vec<_>>())
                / 2.0;
        let parts: f64 = triangles
            .iter()
            .map(|&triangle| {
                let area = area_vector(points, triangle);
                assert!(area.dot(whole) >= -1e-12 * whole.length_squared(), "turned over: {triangle:?}");
                area.length()
            })
            .sum();
        assert!((parts / whole.length() - 1.0).abs() < 1e-9, "{parts} against {}", whole.length());
    }

    fn in_tilted_plane(points: impl IntoIterator<Item = [f64; 2]>) -> Vec<[f64; 3]> {
        points.into_iter().map(|[x, y]| [x, 0.5 * x + y, 3.0 - y]).collect()
    }

    #[test]
    fn convex_and_concave_quadrilaterals() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        assert_eq!(triangles_of(&in_tilted_plane(square)), [[0, 1, 2], [0, 2, 3]]);
        for reflex in 0..4 {
            let mut dart = [[0.0, 0.0], [2.0, 0.0], [0.5, 0.5], [0.0, 2.0]];
            dart.rotate_left(reflex);
            assert_tiles(&in_tilted_plane(dart));
        }
    }

    #[test]
    fn corner_on_an_edge_leaves_no_degenerate_triangle() {
        for start in 0..4 {
            let mut points = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [0.0, 2.0]];
            points.rotate_left(start);
            let points = in_tilted_plane(points);
            for triangle in triangles_of(&points) {
                assert!(area_vector(&points, triangle).length() > 0.1);
            }
        }
    }

    #[test]
    fn concave_polygons_of_many_shapes() {
        let star = |n: usize| {
            in_tilted_plane((0..n).map(|i| {
                let angle = i as f64 / n as f64 * std::f64::consts::TAU;
                let radius = if i % 2 == 0 { 1.0 } else { 0.3 };
                [radius * angle.cos(), radius * angle.sin()]
            }))
        };
        for n in [6, 10, 100, 2000] {
            assert_tiles(&star(n));
        }
        let comb =
            (0..500).map(|i| [f64::from(i), if i % 2 == 0 { 1000.0 } else { 0.5 }]).chain([[499.0, -1.0], [0.0, -1.0]]);
        assert_tiles(&in_tilted_plane(comb));
    }

    #[test]
    fn polygon_with_a_bridged_hole() {
        let outer = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [0.0, 0.0]];
        let hole = [[1.0, 1.0], [1.0, 3.0], [3.0, 3.0], [3.0, 1.0], [1.0, 1.0]];
        assert_tiles(&in_tilted_plane(outer.into_iter().chain(hole)));
    }

    #[test]
    fn scale_does_not_matter() {
        for scale in [1e-320, 1e-300, 1e-20, 1e20, 1e300] {
            let points =
                [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.5], [0.0, 2.0]].map(|[x, y]| [x * scale, y * scale, 0.0]);
            let mut triangles = triangles_of(&points);
            triangles.iter_mut().for_each(|triangle| triangle.sort_unstable());
            triangles.sort_unstable();
            assert_eq!(triangles, [[0, 1, 3], [0, 3, 4], [1, 2, 3]], "{scale}");
        }
    }

    #[test]
    fn few_corners_are_degenerate_triangles() {
        let mut polygons = Polygons::default();
        polygons.push([]);
        polygons.push([1]);
        polygons.push([0, 1]);
        let triangles = polygons.triangulate(&[[0.0; 3], [1.0; 3]]).unwrap();
        assert_eq!(triangles, [[1, 1, 1], [0, 1, 1]]);
    }

    #[test]
    fn huge_polygons_take_linear_time() {
        let n = 1_000_000;
        let circle = in_tilted_plane((0..n).map(|i| {
            let angle = f64::from(i) / f64::from(n) * std::f64::consts::TAU;
            [angle.cos(), angle.sin()]
        }));
        assert_tiles(&circle);
        let line: Vec<_> = (0..n).map(|i| [f64::from(i), 0.0, 0.0]).collect();
        assert_eq!(triangles_of(&line).len(), n as usize - 2);
        let not_numbers = vec![[f64::NAN; 3]; n as usize];
        assert_eq!(triangles_of(&not_numbers).len(), n as usize - 2);
    }
}
