//! The surface as the report shows it: at unit size, and from sides that have something to show.

use glam::{DVec3, Vec3};
use prt_bake::Geometry;
use prt_gpu::View;

use crate::camera::{DEFAULT_FOV, Orbit, Sphere};

/// Width and height of a picture, pixels: twice what a page of 1,400 px gives to one of four in a row.
const SIZE: [u32; 2] = [560, 420];
/// That of the picture beside the title.
const TITLE_SIZE: [u32; 2] = [1120, 840];
/// Samples per pixel along each axis.
const SAMPLES: u32 = 2;
/// A side is shown if it has this share of the area of the side that has most.
const WORTH_SHOWING: f64 = 0.15;
/// The sides in their order: name, angle from the front to the right, angle above the horizon, degrees.
const SIDES: [(&str, f32, f32); 4] = [
    ("from the front", 30.0, 20.0),
    ("from behind", 210.0, 20.0),
    ("from above", 30.0, 65.0),
    ("from below", 30.0, -45.0),
];

/// The surface and its views.
#[derive(Debug)]
pub(super) struct Stage<'a> {
    pub(super) geometry: &'a Geometry,
    /// `[V]`, moved and scaled into a sphere of radius 1, so that a camera can stand before a surface of any size.
    pub(super) positions: Vec<[f32; 3]>,
    /// At least one; fewer than four where some sides show little but the backs of faces.
    pub(super) shots: Vec<Shot>,
    /// The first of them, larger.
    pub(super) title: Shot,
}

/// One view.
#[derive(Debug)]
pub(super) struct Shot {
    pub(super) name: &'static str,
    pub(super) eye: Vec3,
    pub(super) view: View,
}

impl<'a> Stage<'a> {
    /// None if the surface has no extent that could be shown: all its vertices are at one point, or some are nowhere.
    pub(super) fn new(geometry: &'a Geometry) -> Option<Self> {
        let positions = unit_sized(&geometry.positions)?;
        let areas: Vec<DVec3> = geometry.triangles.iter().map(|&corners| area_vector(&positions, corners)).collect();
        let orbits = SIDES.map(|(name, yaw, pitch)| (name, [yaw, pitch].map(f32::to_radians)));
        let seen = orbits.map(|(_, angles)| area_towards(&areas, towards(angles)));
        let most = seen.into_iter().fold(0.0, f64::max);
        let is_shown = |side: usize| seen[side] >= WORTH_SHOWING * most;
        let shown: Vec<_> = (0..SIDES.len()).filter(|&side| is_shown(side)).map(|side| orbits[side]).collect();
        let shots = shown.iter().map(|&side| Shot::new(&positions, side, SIZE)).collect();
        let title = Shot::new(&positions, *shown.first()?, TITLE_SIZE);
        Some(Self { geometry, positions, shots, title })
    }
}

impl Shot {
    fn new(positions: &[[f32; 3]], (name, angles): (&'static str, [f32; 2]), [width, height]: [u32; 2]) -> Self {
        let aspect = width as f32 / height as f32;
        let camera =
            Orbit::framing_from(positions, angles, Vec3::Y, DEFAULT_FOV, aspect).centered(positions, aspect).camera();
        let clip_from_world = camera.clip_from_world(aspect, Sphere::around(positions)).to_cols_array_2d();
        let view = View { clip_from_world, width, height, samples: SAMPLES };
        Self { name, eye: camera.eye, view }
    }
}

/// Positions about the middle of their box, over half its diagonal; none without extent.
fn unit_sized(positions: &[[f32; 3]]) -> Option<Vec<[f32; 3]>> {
    let points = || positions.iter().map(|position| DVec3::from_array(position.map(f64::from)));
    let lower = points().reduce(DVec3::min)?;
    let upper = points().reduce(DVec3::max)?;
    let (center, radius) = (0.5 * (lower + upper), 0.5 * (upper - lower).length());
    let is_sound = radius.is_finite() && radius > 0.0 && points().all(DVec3::is_finite);
    is_sound.then(|| points().map(|point| ((point - center) / radius).as_vec3().to_array()).collect())
}

/// Along the normal of a triangle, as long as twice its area.
fn area_vector(positions: &[[f32; 3]], corners: [u32; 3]) -> DVec3 {
    let [a, b, c] = corners.map(|vertex| DVec3::from_array(positions[vertex as usize].map(f64::from)));
    (b - a).cross(c - a)
}

/// Area of the fronts of faces as seen from far away in a direction.
fn area_towards(areas: &[DVec3], direction: DVec3) -> f64 {
    areas.iter().map(|area| area.dot(direction).max(0.0)).sum()
}

/// The direction of the eye of an orbit about +y.
fn towards([yaw, pitch]: [f32; 2]) -> DVec3 {
    let ((sin_yaw, cos_yaw), (sin_pitch, cos_pitch)) = (f64::from(yaw).sin_cos(), f64::from(pitch).sin_cos());
    DVec3::new(cos_pitch * sin_yaw, sin_pitch, cos_pitch * cos_yaw)
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;

    fn triangle(scale: f32, offset: f32, flipped: bool) -> Geometry {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]];
        let positions = corners.map(|corner: [f32; 3]| corner.map(|x| scale * x + offset)).to_vec();
        let triangles = vec![if flipped { [0, 2, 1] } else { [0, 1, 2] }];
        Geometry { positions, triangles, ..Geometry::default() }
    }

    fn names(geometry: &Geometry) -> Vec<&'static str> {
        Stage::new(geometry).unwrap().shots.iter().map(|shot| shot.name).collect()
    }

    #[test]
    fn sides_that_show_only_backs_are_left_out() {
        assert_eq!(names(&triangle(1.0, 0.0, false)), ["from the front", "from behind", "from above"]);
        assert_eq!(names(&triangle(1.0, 0.0, true)), ["from below"]);
    }

    #[test]
    fn any_size_and_place_is_shown_the_same() {
        let plain = Stage::new(&triangle(1.0, 0.0, false)).unwrap().positions.clone();
        for scale in [1e-30, 1e30, 2.5e38] {
            let scaled = Stage::new(&triangle(scale, 0.0, false)).unwrap().positions.clone();
            let difference = plain.as_flattened().iter().zip(scaled.as_flattened()).map(|(a, b)| (a - b).abs());
            assert!(difference.fold(0.0, f32::max) < 1e-6, "{scale}");
        }
        let moved = Stage::new(&triangle(1.0, 1024.0, false)).unwrap().positions.clone();
        assert_eq!(plain, moved);
    }

    #[test]
    fn the_eye_is_where_the_area_is_looked_at_from() {
        let geometry = triangle(1.0, 0.0, false);
        for shot in Stage::new(&geometry).unwrap().shots {
            let (_, yaw, pitch) = SIDES.into_iter().find(|side| side.0 == shot.name).unwrap();
            let expected = towards([yaw, pitch].map(f32::to_radians)).as_vec3();
            // Centring moves the eye a little to the side.
            assert!(shot.eye.normalize().dot(expected) > 0.9, "{} {}", shot.name, shot.eye);
            assert!(shot.view.check().is_ok());
        }
    }

    #[test]
    fn what_has_no_extent_is_not_staged() {
        assert!(Stage::new(&triangle(0.0, 3.0, false)).is_none());
        assert!(Stage::new(&Geometry::default()).is_none());
        let mut nowhere = triangle(1.0, 0.0, false);
        nowhere.positions[1][2] = f32::NAN;
        assert!(Stage::new(&nowhere).is_none());
    }
}
