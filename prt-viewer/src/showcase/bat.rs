//! A bat: an opaque body, wings of thin membrane, and a skeleton that flaps them. Made by formula; faces +z, y is up.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Quat, Vec3};
use prt_anim::{
    Affine, Bone, Channel, Clip, Error, Interpolation, Joint, Keys, Skeleton, Skin, SkinSource, Track, Transform,
};
use prt_bake::Geometry;

/// The bat in its rest pose, and what moves it.
#[derive(Debug)]
pub(crate) struct Bat {
    pub(crate) geometry: Geometry,
    /// Transparency `[V]` of the membrane; 0 is opaque.
    pub(crate) alphas: Vec<f32>,
    pub(crate) skeleton: Skeleton,
    pub(crate) skin: Skin,
    pub(crate) clip: Clip,
}

/// Where the wings begin and end, from the middle.
const SPAN: [f64; 2] = [0.08, 1.5];
/// Joints of a wing, from the middle.
const SHOULDER: f64 = 0.10;
const WRIST: f64 = 0.62;
/// Transparency of the skin between the fingers, and of the fingers.
const MEMBRANE: f64 = 0.65;
const FINGER: f64 = 0.08;
const FUR: [f32; 3] = [0.20, 0.13, 0.09];
const SKIN: [f32; 3] = [0.62, 0.24, 0.14];

impl Bat {
    /// Builds the bat.
    ///
    /// # Errors
    /// None that is known; those of the parts are handed on.
    pub(crate) fn new() -> Result<Self, Error> {
        let mut shape = Shape::default();
        for side in [1.0, -1.0] {
            shape.wing(side);
        }
        shape.ellipsoid(DVec3::new(0.0, 0.0, 0.0), DVec3::new(0.12, 0.11, 0.36), DVec3::ZERO);
        shape.ellipsoid(DVec3::new(0.0, 0.05, 0.40), DVec3::splat(0.115), DVec3::ZERO);
        for side in [1.0, -1.0] {
            shape.ellipsoid(
                DVec3::new(0.07 * side, 0.18, 0.38),
                DVec3::new(0.045, 0.11, 0.02),
                DVec3::new(0.3 * side, 0.0, 0.0),
            );
        }
        let skeleton = skeleton()?;
        let skin = Skin::new(shape.skin(), &skeleton)?;
        let clip = flap(skeleton.joints().len())?;
        Ok(Self { geometry: shape.geometry, alphas: shape.alphas, skeleton, skin, clip })
    }
}

/// Vertices under construction.
#[derive(Debug, Default)]
struct Shape {
    geometry: Geometry,
    alphas: Vec<f32>,
}

impl Shape {
    /// Both sides of a wing: `side` is 1 on the left of the bat, which is +x, and −1 on its right.
    fn wing(&mut self, side: f64) {
        const COLUMNS: usize = 48;
        const ROWS: usize = 20;
        let point = |s: f64, t: f64| wing_point(s, t) * DVec3::new(side, 1.0, 1.0);
        for face in [1.0, -1.0] {
            let start = self.geometry.positions.len() as u32;
            for row in 0..=ROWS {
                for column in 0..=COLUMNS {
                    let (s, t) = (column as f64 / COLUMNS as f64, row as f64 / ROWS as f64);
                    let alpha = membrane(s, t);
                    let thin = (alpha / MEMBRANE) as f32;
                    let color = Vec3::from_array(FUR).lerp(Vec3::from_array(SKIN), thin);
                    self.add(point(s, t), face * upwards(point, s, t), color, alpha);
                }
            }
            // On the right a grid that runs along the span and backwards turns the other way.
            self.add_cells(start, COLUMNS, ROWS, face * side > 0.0);
        }
    }

    /// An ellipsoid whose points are shifted by `lean` times their height.
    fn ellipsoid(&mut self, center: DVec3, radii: DVec3, lean: DVec3) {
        const COLUMNS: usize = 36;
        const ROWS: usize = 20;
        let start = self.geometry.positions.len() as u32;
        for row in 0..=ROWS {
            for column in 0..=COLUMNS {
                let (sin, cos) = (PI * row as f64 / ROWS as f64).sin_cos();
                let angle = TAU * (column % COLUMNS) as f64 / COLUMNS as f64;
                let unit = DVec3::new(sin * angle.cos(), sin * angle.sin(), cos);
                let local = unit * radii;
                self.add(center + local + lean * local.y, (unit / radii).normalize(), Vec3::from_array(FUR), 0.0);
            }
        }
        self.add_cells(start, COLUMNS, ROWS, false);
    }

    fn add(&mut self, position: DVec3, normal: DVec3, color: Vec3, alpha: f64) {
        self.geometry.positions.push(position.as_vec3().to_array());
        self.geometry.normals.push(normal.as_vec3().to_array());
        self.geometry.albedo.push(color.to_array());
        self.alphas.push(alpha as f32);
    }

    /// Two triangles for each cell of a grid of rows that starts at a vertex.
    ///
    /// - `is_turned`: whether the front is where rows × columns points, not columns × rows
    fn add_cells(&mut self, start: u32, columns: usize, rows: usize, is_turned: bool) {
        for row in 0..rows {
            for column in 0..columns {
                let vertex = |right: usize, down: usize| start + ((row + down) * (columns + 1) + column + right) as u32;
                let [a, b, c, d] = [vertex(0, 0), vertex(1, 0), vertex(1, 1), vertex(0, 1)];
                let faces = if is_turned { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] };
                let faces: Vec<[u32; 3]> = faces.into_iter().filter(|face| self.has_area(*face)).collect();
                self.geometry.triangles.extend(faces);
            }
        }
    }

    fn has_area(&self, face: [u32; 3]) -> bool {
        let [a, b, c] = face.map(|vertex| Vec3::from_array(self.geometry.positions[vertex as usize]));
        (b - a).cross(c - a).length() > 1e-9
    }

    /// Each vertex follows the body, an arm and a hand, by its distance from the middle.
    fn skin(&self) -> SkinSource {
        let weights = |position: &[f32; 3]| {
            let from_middle = f64::from(position[0].abs());
            let arm = smooth_step(0.5 * SHOULDER, 2.0 * SHOULDER, from_middle);
            let hand = smooth_step(0.8 * WRIST, 1.2 * WRIST, from_middle);
            [1.0 - arm, arm * (1.0 - hand), arm * hand].map(|weight| weight as f32)
        };
        let bones = |position: &[f32; 3]| if position[0] >= 0.0 { [0, 1, 2] } else { [0, 3, 4] };
        let joints = JOINTS.iter().enumerate();
        SkinSource {
            bones: joints
                .map(|(joint, (_, _, at))| Bone { joint, inverse_bind: moved(-DVec3::from_array(*at)) })
                .collect(),
            bones_per_vertex: 3,
            bone_indices: self.geometry.positions.iter().flat_map(bones).collect(),
            weights: self.geometry.positions.iter().flat_map(weights).collect(),
            positions: self.geometry.positions.clone(),
            normals: self.geometry.normals.clone(),
        }
    }
}

/// A point of the left wing: `s` along the span, `t` from the leading to the trailing edge, which is scalloped between the fingers.
fn wing_point(s: f64, t: f64) -> DVec3 {
    let leading = 0.10 + 0.34 * (PI * (0.12 + 0.80 * s)).sin() - 0.30 * s * s;
    let scallop = 0.11 * (3.0 * PI * s).sin().abs() * (1.0 - 0.4 * s);
    let trailing = -0.50 + 0.36 * s.powf(1.5) + scallop;
    let arch = 0.10 * (PI * s).sin() + 0.04 * (PI * t).sin() * (1.0 - s);
    DVec3::new(SPAN[0] + (SPAN[1] - SPAN[0]) * s, arch, leading + (trailing - leading) * t)
}

/// The normal of a wing's upper side, by central differences.
fn upwards(point: impl Fn(f64, f64) -> DVec3, s: f64, t: f64) -> DVec3 {
    const STEP: f64 = 1e-4;
    let along = point(s + STEP, t) - point((s - STEP).max(0.0), t);
    let across = point(s, t + STEP) - point(s, t - STEP);
    let normal = across.cross(along).normalize();
    if normal.y < 0.0 { -normal } else { normal }
}

/// Transparency of the wing: fingers spread from the wrist to the trailing edge, and the arm runs along the leading one.
fn membrane(s: f64, t: f64) -> f64 {
    const TIPS: [f64; 3] = [1.0 / 3.0, 2.0 / 3.0, 1.0];
    const WRIST_AT: f64 = (WRIST - SPAN[0]) / (SPAN[1] - SPAN[0]);
    let to_finger = |tip: f64| (s - (WRIST_AT + (tip - WRIST_AT) * t)).abs();
    let nearest = TIPS.into_iter().map(to_finger).fold(0.6 * t, f64::min);
    FINGER + (MEMBRANE - FINGER) * smooth_step(0.008, 0.04, nearest)
}

/// Name, parent and place of each joint.
const JOINTS: [(&str, Option<usize>, [f64; 3]); 5] = [
    ("body", None, [0.0; 3]),
    ("left arm", Some(0), [SHOULDER, 0.02, 0.0]),
    ("left hand", Some(1), [WRIST, 0.09, 0.2]),
    ("right arm", Some(0), [-SHOULDER, 0.02, 0.0]),
    ("right hand", Some(3), [-WRIST, 0.09, 0.2]),
];

fn skeleton() -> Result<Skeleton, Error> {
    let joint = |&(name, parent, at): &(&str, Option<usize>, [f64; 3])| {
        let from = parent.map_or([0.0; 3], |parent: usize| JOINTS[parent].2);
        let translation = std::array::from_fn(|k| at[k] - from[k]);
        Joint { name: Some(name.to_owned()), parent, rest: Transform { translation, ..Transform::IDENTITY } }
    };
    Skeleton::new(JOINTS.iter().map(joint).collect())
}

/// One beat of the wings, a second long: the hands follow the arms, and the body goes up and down against them.
fn flap(joint_count: usize) -> Result<Clip, Error> {
    const KEYS: usize = 24;
    let phase = |key: usize| TAU * key as f64 / KEYS as f64;
    let times: Vec<f32> = (0..=KEYS).map(|key| key as f32 / KEYS as f32).collect();
    let turns = |degrees: f64, lag: f64| -> Result<Track, Error> {
        let angle = |key: usize| (degrees.to_radians() * (phase(key) - lag).sin()) as f32;
        let values = (0..=KEYS).map(|key| Quat::from_rotation_z(angle(key)).to_array()).collect();
        Ok(Track::Rotation(Keys::new(times.clone(), values, Interpolation::Linear)?))
    };
    let rise = (0..=KEYS).map(|key| [0.0, (-0.07 * (phase(key) - 0.4).sin()) as f32, 0.0]).collect();
    let channels = vec![
        Channel { joint: 0, track: Track::Translation(Keys::new(times.clone(), rise, Interpolation::Linear)?) },
        Channel { joint: 1, track: turns(38.0, 0.0)? },
        Channel { joint: 2, track: turns(34.0, 0.9)? },
        Channel { joint: 3, track: turns(-38.0, 0.0)? },
        Channel { joint: 4, track: turns(-34.0, 0.9)? },
    ];
    Clip::new(Some("flap".to_owned()), channels, joint_count)
}

fn moved(by: DVec3) -> Affine {
    Affine { translation: by.to_array(), ..Affine::IDENTITY }
}

/// 0 below `from`, 1 above `to`, and a smooth rise between.
fn smooth_step(from: f64, to: f64, x: f64) -> f64 {
    let x = ((x - from) / (to - from)).clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use prt_anim::{Deformed, Playback};

    #[test]
    fn faces_turn_where_their_normals_point() {
        let bat = Bat::new().unwrap();
        let Geometry { positions, normals, triangles, .. } = &bat.geometry;
        assert!((3_000..12_000).contains(&positions.len()), "{} vertices", positions.len());
        for face in triangles {
            let [a, b, c] = face.map(|vertex| Vec3::from_array(positions[vertex as usize]));
            let turned = (b - a).cross(c - a).normalize();
            let normal: Vec3 = face.iter().map(|&vertex| Vec3::from_array(normals[vertex as usize])).sum();
            assert!(turned.dot(normal.normalize()) > 0.5, "{face:?} {a} {b} {c} {normal}");
        }
    }

    #[test]
    fn the_rest_pose_is_the_shape_and_wings_beat_alike() {
        let bat = Bat::new().unwrap();
        let mut deformed = Deformed::default();
        bat.skin.deform(&bat.skeleton, &bat.skeleton.rest_pose(), &mut deformed);
        for (posed, shape) in deformed.positions.iter().zip(&bat.geometry.positions) {
            assert!(Vec3::from_array(*posed).distance(Vec3::from_array(*shape)) < 1e-6);
        }
        let mut pose = bat.skeleton.rest_pose();
        bat.clip.sample(0.25, Playback::Loop, &mut pose);
        bat.skin.deform(&bat.skeleton, &pose, &mut deformed);
        let highest = |side: f32| {
            let of_side = deformed.positions.iter().filter(|position| position[0] * side > 0.5);
            of_side.map(|position| position[1]).fold(f32::NEG_INFINITY, f32::max)
        };
        assert!(highest(1.0) > 0.4, "the wings are up: {}", highest(1.0));
        assert!((highest(1.0) - highest(-1.0)).abs() < 1e-5);
    }

    #[test]
    fn fingers_are_darker_than_the_skin_between_them() {
        let bat = Bat::new().unwrap();
        assert!(bat.alphas.iter().all(|alpha| (0.0..=MEMBRANE as f32).contains(alpha)));
        assert!(bat.alphas.contains(&(MEMBRANE as f32)) && bat.alphas.contains(&0.0));
    }
}
