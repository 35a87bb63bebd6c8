//! Where a picture is taken from: right-handed, y of the picture up, clip depth from 0 to 1.

use anyhow::ensure;
use glam::camera::rh;
use glam::{Mat4, Vec2, Vec3};

/// The vertical field of view where none is given, radians.
pub(crate) const DEFAULT_FOV: f32 = 0.61;
/// Room left around a framed object, as a factor on the distance.
const MARGIN: f32 = 1.06;
/// How far from the middle of the picture an object may be that counts as centred, as a share of the width and of the height.
const CENTERED: f32 = 2e-3;
/// Share of the way to the middle that is taken at once: what is near moves further in the picture than what is far, so that a whole step could
/// go too far.
const CENTERING_STEP: f32 = 0.6;
/// Most steps.
const CENTERING_ROUNDS: usize = 16;
/// Nearest depth that is drawn when the eye is within the object, in units of its radius.
const NEAREST: f32 = 1e-3;
/// The orbit stops short of straight up and down, where its up direction would turn over; radians.
const MAX_PITCH: f32 = 1.55;

/// A pinhole camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Camera {
    pub(crate) eye: Vec3,
    pub(crate) target: Vec3,
    pub(crate) up: Vec3,
    /// Vertical, radians.
    pub(crate) fov: f32,
}

impl Camera {
    /// # Errors
    /// If the camera looks nowhere or along its own up direction.
    pub(crate) fn check(&self) -> anyhow::Result<()> {
        let Self { eye, target, up, .. } = self;
        let forward = (*target - *eye).try_normalize();
        ensure!(forward.is_some(), "the camera cannot look anywhere: --eye and --target are one point, {eye}");
        let across = forward.unwrap_or(Vec3::ZERO).cross(up.normalize_or_zero());
        ensure!(across.length() > 1e-4, "the camera looks along its up direction {up}: give another --up");
        Ok(())
    }

    /// The matrix that takes the scene to clip space, with the depth range closely around a sphere.
    pub(crate) fn clip_from_world(&self, aspect: f32, around: Sphere) -> Mat4 {
        let depth = (around.center - self.eye).dot(self.forward());
        let near = (depth - 1.01 * around.radius).max(NEAREST * around.radius);
        let far = (depth + 1.01 * around.radius).max(2.0 * near);
        rh::proj::directx::perspective(self.fov, aspect, near, far)
            * rh::view::look_at_mat4(self.eye, self.target, self.up)
    }

    /// The corners of the part of the picture that points take up, in clip space.
    fn picture_bounds(&self, points: &[[f32; 3]], aspect: f32, around: Sphere) -> [Vec2; 2] {
        let clip = self.clip_from_world(aspect, around);
        let places = points.iter().map(|&point| clip.project_point3(Vec3::from_array(point)).truncate());
        places.fold([Vec2::INFINITY, Vec2::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)])
    }

    /// The direction seen at a point of the picture, unit length; `x` and `y` run from −1 (left, bottom) to 1.
    pub(crate) fn direction(&self, aspect: f32, at: Vec2) -> Vec3 {
        let [right, up] = self.across();
        let half = (0.5 * self.fov).tan();
        (self.forward() + right * (at.x * half * aspect) + up * (at.y * half)).normalize()
    }

    pub(crate) fn forward(&self) -> Vec3 {
        (self.target - self.eye).normalize_or(Vec3::NEG_Z)
    }

    /// Unit directions to the right and to the top of the picture.
    pub(crate) fn across(&self) -> [Vec3; 2] {
        let right = self.forward().cross(self.up).normalize_or(Vec3::X);
        [right, right.cross(self.forward())]
    }
}

/// A sphere around an object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sphere {
    pub(crate) center: Vec3,
    pub(crate) radius: f32,
}

impl Sphere {
    /// The sphere about the middle of the box around the points. Never of radius 0.
    pub(crate) fn around(points: &[[f32; 3]]) -> Self {
        let points = || points.iter().copied().map(Vec3::from_array);
        let lower = points().reduce(Vec3::min).unwrap_or(Vec3::ZERO);
        let upper = points().reduce(Vec3::max).unwrap_or(Vec3::ZERO);
        let center = 0.5 * lower + 0.5 * upper;
        let radius = points().map(|point| point.distance(center)).fold(0.0, f32::max);
        Self { center, radius: radius.max(f32::MIN_POSITIVE.sqrt()) }
    }
}

/// A side from which an object can be looked at. With y up the front is +z; with z up it is −y.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Side {
    /// From the front, to the right and from above.
    ThreeQuarter,
    Front,
    Back,
    Left,
    Right,
    Top,
    Bottom,
}

impl Side {
    /// Angle about the up direction from the front towards the right, and angle above the horizon; radians.
    fn angles(self) -> [f32; 2] {
        let [yaw, pitch]: [f32; 2] = match self {
            Self::ThreeQuarter => [30.0, 20.0],
            Self::Front => [0.0, 0.0],
            Self::Right => [90.0, 0.0],
            Self::Back => [180.0, 0.0],
            Self::Left => [-90.0, 0.0],
            Self::Top => [0.0, 88.8],
            Self::Bottom => [0.0, -88.8],
        };
        [yaw.to_radians(), pitch.to_radians()]
    }
}

/// A camera that turns about a point and stays upright.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Orbit {
    pub(crate) target: Vec3,
    pub(crate) distance: f32,
    /// About the up direction, from the front towards the right, radians.
    yaw: f32,
    /// Above the horizon, radians.
    pitch: f32,
    frame: Frame,
    fov: f32,
}

impl Orbit {
    /// Frames an object from one of its sides: as near as all points stay in the picture.
    pub(crate) fn framing(points: &[[f32; 3]], side: Side, up: Vec3, fov: f32, aspect: f32) -> Self {
        Self::framing_from(points, side.angles(), up, fov, aspect)
    }

    /// Frames an object from the angles of [`yaw` about the up direction from the front towards the right, `pitch` above the horizon],
    /// radians.
    pub(crate) fn framing_from(points: &[[f32; 3]], [yaw, pitch]: [f32; 2], up: Vec3, fov: f32, aspect: f32) -> Self {
        let around = Sphere::around(points);
        let mut orbit =
            Self { target: around.center, distance: 2.0 * around.radius, yaw, pitch, frame: Frame::new(up), fov };
        orbit.distance = MARGIN * orbit.fitting_distance(points, aspect).max(1e-3 * around.radius);
        orbit
    }

    /// Moves the object, seen from the same side, to the middle of the picture, as near as all of it stays there.
    pub(crate) fn centered(mut self, points: &[[f32; 3]], aspect: f32) -> Self {
        let around = Sphere::around(points);
        for _ in 0..CENTERING_ROUNDS {
            let [low, high] = self.camera().picture_bounds(points, aspect, around);
            let middle = 0.25 * (low + high);
            if middle.abs().max_element() < CENTERED {
                break;
            }
            let step = CENTERING_STEP * middle;
            self.pan(-step.x * aspect, -step.y);
            self.distance = MARGIN * self.fitting_distance(points, aspect).max(1e-3 * around.radius);
        }
        self
    }

    /// The orbit that starts at a camera.
    pub(crate) fn through(camera: &Camera) -> Self {
        let frame = Frame::new(camera.up);
        let back = camera.eye - camera.target;
        let yaw = back.dot(frame.right).atan2(back.dot(frame.front));
        let pitch = (back.dot(frame.up) / back.length()).clamp(-1.0, 1.0).asin().clamp(-MAX_PITCH, MAX_PITCH);
        Self { target: camera.target, distance: back.length(), yaw, pitch, frame, fov: camera.fov }
    }

    pub(crate) fn camera(&self) -> Camera {
        let eye = self.target + self.distance * self.back();
        Camera { eye, target: self.target, up: self.frame.up, fov: self.fov }
    }

    /// Turns by angles, radians: the object follows a drag to the right and upwards.
    pub(crate) fn turn(&mut self, to_right: f32, upwards: f32) {
        self.yaw = (self.yaw - to_right) % std::f32::consts::TAU;
        self.pitch = (self.pitch - upwards).clamp(-MAX_PITCH, MAX_PITCH);
    }

    /// Moves the target, so that the object follows a drag; fractions of the height of the picture.
    pub(crate) fn pan(&mut self, to_right: f32, upwards: f32) {
        let [right, up] = self.camera().across();
        let height = 2.0 * self.distance * (0.5 * self.fov).tan();
        self.target -= height * (to_right * right + upwards * up);
    }

    /// Multiplies the distance; the object never vanishes in rounding.
    pub(crate) fn zoom(&mut self, factor: f32, around: Sphere) {
        self.distance = (self.distance * factor).clamp(1e-3 * around.radius, 1e3 * around.radius);
    }

    pub(crate) fn up(&self) -> Vec3 {
        self.frame.up
    }

    /// Unit vector from the target to the eye.
    fn back(&self) -> Vec3 {
        let Frame { right, front, up } = self.frame;
        let (sin_yaw, cos_yaw) = self.yaw.sin_cos();
        let (sin_pitch, cos_pitch) = self.pitch.sin_cos();
        cos_pitch * (sin_yaw * right + cos_yaw * front) + sin_pitch * up
    }

    /// The smallest distance from which all points are in the picture.
    fn fitting_distance(&self, points: &[[f32; 3]], aspect: f32) -> f32 {
        let back = self.back();
        let [right, up] = self.camera().across();
        let slope_up = (0.5 * self.fov).tan();
        let slope_right = slope_up * aspect;
        // A point at depth `distance − towards` is within the picture if |across| <= slope · depth.
        let needed = |&point: &[f32; 3]| {
            let point = Vec3::from_array(point) - self.target;
            let across = (point.dot(right).abs() / slope_right).max(point.dot(up).abs() / slope_up);
            point.dot(back) + across
        };
        points.iter().map(needed).fold(0.0, f32::max)
    }
}

/// Unit vectors to the right, to the front and up of an object: `right × up = front`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Frame {
    right: Vec3,
    front: Vec3,
    up: Vec3,
}

impl Frame {
    fn new(up: Vec3) -> Self {
        let up = up.normalize_or(Vec3::Y);
        // Right is +x, unless that is up.
        let right = if up.x.abs() < 0.9 { Vec3::X } else { Vec3::NEG_Y * up.x.signum() };
        let front = right.cross(up).normalize();
        Self { right: up.cross(front), front, up }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPHERE: Sphere = Sphere { center: Vec3::ZERO, radius: 1.0 };

    fn camera() -> Camera {
        Camera { eye: Vec3::new(0.0, 0.0, 5.0), target: Vec3::ZERO, up: Vec3::Y, fov: 0.8 }
    }

    fn cube() -> Vec<[f32; 3]> {
        let side = |corner: usize, axis: usize| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 };
        (0..8).map(|corner| [side(corner, 0), side(corner, 1) + 3.0, side(corner, 2)]).collect()
    }

    #[test]
    fn right_is_right_up_is_up_and_depth_grows() {
        let clip = |x, y, z| camera().clip_from_world(1.5, SPHERE).project_point3(Vec3::new(x, y, z));
        assert!(clip(0.5, 0.0, 0.0).x > 0.0 && clip(0.0, 0.5, 0.0).y > 0.0);
        let depths = [1.0, 0.5, 0.0, -1.0].map(|z| clip(0.0, 0.0, z).z);
        assert!(depths.is_sorted() && depths[0] > 0.0 && depths[3] < 1.0, "{depths:?}");
    }

    #[test]
    fn a_point_is_seen_in_the_direction_of_its_pixel() {
        let camera = Camera { eye: Vec3::new(1.0, 2.0, 3.0), up: Vec3::new(0.1, 1.0, 0.0), ..camera() };
        for point in [Vec3::new(0.3, -0.15, 0.1), Vec3::new(-0.5, 0.5, 0.5)] {
            let at = camera.clip_from_world(1.5, SPHERE).project_point3(point).truncate();
            let direction = camera.direction(1.5, at);
            assert!(direction.distance((point - camera.eye).normalize()) < 1e-5);
        }
    }

    #[test]
    fn all_of_a_framed_object_is_in_the_picture_and_it_fills_it() {
        let points = cube();
        for side in [Side::ThreeQuarter, Side::Front, Side::Top, Side::Bottom] {
            for (up, aspect) in [(Vec3::Y, 1.0), (Vec3::Z, 2.0), (Vec3::X, 0.5)] {
                let camera = Orbit::framing(&points, side, up, DEFAULT_FOV, aspect).camera();
                camera.check().expect("a framing camera is valid");
                let clip = camera.clip_from_world(aspect, Sphere::around(&points));
                let reach = |&point: &[f32; 3]| {
                    let point = clip.project_point3(Vec3::from_array(point));
                    assert!((0.0..1.0).contains(&point.z));
                    point.x.abs().max(point.y.abs())
                };
                let reach = points.iter().map(reach).fold(0.0, f32::max);
                assert!((0.85..1.0).contains(&reach), "{side:?} {up} {aspect}: {reach}");
            }
        }
    }

    #[test]
    fn a_centered_object_has_the_same_room_on_opposite_sides() {
        let points = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 0.0, 6.0], [0.0, 0.5, -1.0_f32]];
        let around = Sphere::around(&points);
        let bounds = |orbit: Orbit| orbit.camera().picture_bounds(&points, 1.5, around);
        let framed = Orbit::framing_from(&points, [0.5, 0.3], Vec3::Y, DEFAULT_FOV, 1.5);
        let [low, high] = bounds(framed);
        assert!((low + high).abs().max_element() > 0.15, "it would be centred anyway: {low} {high}");
        let [low, high] = bounds(framed.centered(&points, 1.5));
        assert!((low + high).abs().max_element() < 0.02, "{low} {high}");
        assert!((0.8..1.0).contains(&high.max_element()), "{high}");
    }

    #[test]
    fn sides_are_where_they_are_called() {
        let eye = |side, up| {
            let orbit = Orbit::framing(&[[-1.0; 3], [1.0; 3]], side, up, DEFAULT_FOV, 1.0);
            orbit.camera().eye.normalize()
        };
        assert!(eye(Side::Front, Vec3::Y).distance(Vec3::Z) < 1e-5);
        assert!(eye(Side::Right, Vec3::Y).distance(Vec3::X) < 1e-5);
        assert!(eye(Side::Front, Vec3::Z).distance(Vec3::NEG_Y) < 1e-5);
        assert!(eye(Side::Right, Vec3::Z).distance(Vec3::X) < 1e-5);
        assert!(eye(Side::Top, Vec3::Z).z > 0.99 && eye(Side::Bottom, Vec3::Y).y < -0.99);
    }

    #[test]
    fn the_object_follows_the_mouse() {
        let around = Sphere::around(&cube());
        let start = Orbit::framing(&cube(), Side::Front, Vec3::Y, DEFAULT_FOV, 1.0);
        let on_screen = |orbit: &Orbit, point| orbit.camera().clip_from_world(1.0, around).project_point3(point);
        // A point on the front.
        let point = around.center + Vec3::Z;
        let mut turned = start;
        turned.turn(0.2, 0.1);
        assert!(on_screen(&turned, point).x > 0.05 && on_screen(&turned, point).y > 0.02);
        let mut moved = start;
        moved.pan(0.25, 0.125);
        let at = on_screen(&moved, around.center);
        assert!((at.x - 0.5).abs() < 1e-3 && (at.y - 0.25).abs() < 1e-3, "{at}");
        let mut near = start;
        near.zoom(0.5, around);
        assert!((near.distance - 0.5 * start.distance).abs() < 1e-5);
    }

    #[test]
    fn an_orbit_starts_where_the_camera_is() {
        let camera = Camera { eye: Vec3::new(3.0, 1.0, -2.0), target: Vec3::new(0.5, 0.0, 0.0), ..camera() };
        let orbit = Orbit::through(&camera).camera();
        assert!(orbit.eye.distance(camera.eye) < 1e-5 && orbit.target == camera.target);
    }

    #[test]
    fn cameras_that_see_nothing_are_refused() {
        assert!(Camera { eye: Vec3::ZERO, ..camera() }.check().is_err());
        assert!(Camera { up: Vec3::Z, ..camera() }.check().is_err());
        assert!(camera().check().is_ok());
    }

    #[test]
    fn one_point_has_a_sphere_too() {
        assert!(Sphere::around(&[[2.0, 0.0, 0.0]]).radius > 0.0);
        assert!(Sphere::around(&[]).radius > 0.0);
    }
}
