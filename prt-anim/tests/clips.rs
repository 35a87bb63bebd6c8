//! Clips: interpolation as glTF 2.0 defines it, times outside the keys, and what is refused.
#![expect(clippy::unwrap_used, reason = "tests")]

use glam::{DQuat, DVec3};
use proptest::prelude::*;
use prt_anim::{Channel, Clip, Error, Interpolation, Joint, Keys, Playback, Pose, Skeleton, Track, Transform};

fn joint(parent: Option<usize>, rest: Transform) -> Joint {
    Joint { name: None, parent, rest }
}

fn clip(track: Track) -> Clip {
    Clip::new(None, vec![Channel { joint: 0, track }], 1).unwrap()
}

fn translation_at(keys: Keys<3>, time: f64, playback: Playback) -> [f64; 3] {
    let mut pose = Pose { locals: vec![Transform::IDENTITY] };
    clip(Track::Translation(keys)).sample(time, playback, &mut pose);
    pose.locals[0].translation
}

fn rotation_at(keys: Keys<4>, time: f64) -> DQuat {
    let mut pose = Pose { locals: vec![Transform::IDENTITY] };
    clip(Track::Rotation(keys)).sample(time, Playback::Clamp, &mut pose);
    DQuat::from_array(pose.locals[0].rotation)
}

fn ramp(interpolation: Interpolation) -> Keys<3> {
    Keys::new(vec![1.0, 2.0, 4.0], vec![[1.0, 0.0, 0.0], [3.0, 1.0, 0.0], [-1.0, 1.0, 8.0]], interpolation).unwrap()
}

#[test]
fn step_and_linear_values() {
    let at = |time| translation_at(ramp(Interpolation::Linear), time, Playback::Clamp);
    assert_eq!(at(1.5), [2.0, 0.5, 0.0]);
    assert_eq!(at(3.5), [0.0, 1.0, 6.0]);
    let at = |time| translation_at(ramp(Interpolation::Step), time, Playback::Clamp);
    assert_eq!(
        (at(1.999), at(2.0), at(3.999), at(4.0)),
        ([1.0, 0.0, 0.0], [3.0, 1.0, 0.0], [3.0, 1.0, 0.0], [-1.0, 1.0, 8.0])
    );
}

#[test]
fn times_outside_the_keys() {
    let at = |time, playback| translation_at(ramp(Interpolation::Linear), time, playback);
    let (first, last) = ([1.0, 0.0, 0.0], [-1.0, 1.0, 8.0]);
    for time in [-9.0, 0.0, 0.5, f64::NAN, f64::NEG_INFINITY, f64::INFINITY] {
        assert_eq!(at(time, Playback::Clamp), first, "{time}");
    }
    assert_eq!(at(99.0, Playback::Clamp), last);
    // The clip lasts 4 s, from time zero.
    assert_eq!(at(5.5, Playback::Loop), [2.0, 0.5, 0.0]);
    assert_eq!(at(-0.5, Playback::Loop), [0.0, 1.0, 6.0]);
    assert_eq!(at(4.0, Playback::Loop), first);
    let single = Keys::new(vec![0.0], vec![[7.0; 3]], Interpolation::Linear).unwrap();
    assert_eq!(translation_at(single, 3.0, Playback::Loop), [7.0; 3]);
    let jump = Keys::new(vec![0.0, 1.0, 1.0, 2.0], vec![[0.0; 3], [1.0; 3], [5.0; 3], [6.0; 3]], Interpolation::Linear)
        .unwrap();
    assert_eq!(translation_at(jump.clone(), 1.0, Playback::Clamp), [5.0; 3]);
    assert_eq!(translation_at(jump, 0.5, Playback::Clamp), [0.5; 3]);
}

/// A cubic polynomial is its own spline, whatever the keys' distance.
#[test]
fn splines_reproduce_cubics() {
    let value = |t: f32| [t * t * t - 2.0 * t, 0.5 * t * t, 3.0];
    let slope = |t: f32| [3.0 * t * t - 2.0, t, 0.0];
    let times = vec![0.0, 0.5, 2.0, 3.0];
    let values = times.iter().flat_map(|&t| [slope(t), value(t), slope(t)]).collect();
    let keys = Keys::new(times, values, Interpolation::CubicSpline).unwrap();
    for i in 0..=30 {
        let t = f64::from(i) / 10.0;
        let expected = [t * t * t - 2.0 * t, 0.5 * t * t, 3.0];
        let found = translation_at(keys.clone(), t, Playback::Clamp);
        assert!(DVec3::from(found).distance(expected.into()) < 1e-12, "{t} {found:?}");
    }
    assert_eq!(translation_at(keys, 99.0, Playback::Clamp), [21.0, 4.5, 3.0]);
}

/// In-tangent and out-tangent are not the same thing.
#[test]
fn splines_use_each_tangent_on_its_side() {
    // In-tangents 9 before the first key and out-tangents 9 after the last must not matter; d = 2.
    let values = vec![[9.0; 3], [0.0; 3], [1.0; 3], [-1.0; 3], [0.0; 3], [9.0; 3]];
    let keys = Keys::new(vec![1.0, 3.0], values, Interpolation::CubicSpline).unwrap();
    // t = 1/2: (t³ − 2t² + t) d b + (t³ − t²) d a = 2/8 + 2/8.
    assert_eq!(translation_at(keys, 2.0, Playback::Clamp), [0.5; 3]);
}

#[test]
fn rotation_splines_are_made_unit() {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let zero = [0.0; 4];
    let values = vec![zero, [0.0, 0.0, 0.0, 1.0], zero, zero, [half, 0.0, 0.0, half], zero];
    let keys = Keys::new(vec![0.0, 1.0], values, Interpolation::CubicSpline).unwrap();
    // By symmetry the middle is the half turn, though the chord is shorter than one.
    let expected = DQuat::from_rotation_x(std::f64::consts::FRAC_PI_4);
    assert!(rotation_at(keys, 0.5).dot(expected) > 1.0 - 1e-14);
}

fn quaternion() -> impl Strategy<Value = [f32; 4]> {
    prop::array::uniform4(-1.0..1.0_f32).prop_filter("a direction", |q| q.iter().map(|x| x * x).sum::<f32>() > 1e-3)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Constant speed along the shorter arc: the rotation so far is the whole one with its angle times t.
    #[test]
    fn rotations_follow_great_arcs(a in quaternion(), b in quaternion(), t in 0.0..1.0_f32) {
        let keys = Keys::new(vec![0.0, 1.0], vec![a, b], Interpolation::Linear).unwrap();
        let [a, b] = [a, b].map(|q| DQuat::from_array(q.map(f64::from)).normalize());
        let (axis, angle) = (b * a.inverse()).to_axis_angle();
        let angle = if angle > std::f64::consts::PI { angle - std::f64::consts::TAU } else { angle };
        let t = f64::from(t);
        let expected = DQuat::from_axis_angle(axis, t * angle) * a;
        let found = rotation_at(keys, t);
        prop_assert!((found.length() - 1.0).abs() < 1e-12);
        // A half turn has two shorter arcs.
        prop_assume!(angle.abs() < 3.1);
        prop_assert!(found.dot(expected).abs() > 1.0 - 1e-9, "{found} {expected}");
    }

    #[test]
    fn any_keys_give_finite_unit_rotations(q in prop::collection::vec(prop::array::uniform4(prop::sample::select(vec![0.0, 1.0, -1.0, f32::MAX, 1e-45])), 9), time in -1.0..4.0_f64) {
        for (interpolation, count) in [(Interpolation::Linear, 9), (Interpolation::Step, 9), (Interpolation::CubicSpline, 3)] {
            let times = (0..count).map(|i| i as f32).collect();
            let found = rotation_at(Keys::new(times, q.clone(), interpolation).unwrap(), time);
            prop_assert!((found.length() - 1.0).abs() < 1e-12, "{found}");
        }
    }
}

#[test]
fn bad_keys_are_refused() {
    let refuse = |times: &[f32], values: &[[f32; 3]], interpolation, words: &str| {
        let error = Keys::new(times.to_vec(), values.to_vec(), interpolation).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    };
    let linear = Interpolation::Linear;
    refuse(&[], &[], linear, "0 times have 0 values");
    refuse(&[0.0, 1.0], &[[0.0; 3]], linear, "2 times have 1 values; 1 for each");
    refuse(&[0.0, 1.0], &[[0.0; 3]; 2], Interpolation::CubicSpline, "3 for each");
    refuse(&[1.0, 0.5], &[[0.0; 3]; 2], linear, "key 1 is earlier than key 0");
    refuse(&[0.0, f32::NAN], &[[0.0; 3]; 2], linear, "key 1 is at time NaN");
    refuse(&[-1.0], &[[0.0; 3]], linear, "key 0 is at time -1");
    refuse(&[0.0, 1.0], &[[0.0; 3], [0.0, f32::INFINITY, 0.0]], linear, "key 1 has a value that is not finite");
    let track = Track::Translation(Keys::new(vec![0.0], vec![[0.0; 3]], linear).unwrap());
    let error = Clip::new(None, vec![Channel { joint: 5, track }], 2).unwrap_err();
    assert_eq!(error.to_string(), "clip: a channel moves joint 5, but there are 2");
}

#[test]
fn what_has_no_channel_stays() {
    let mut pose = Pose { locals: vec![Transform { scale: [2.0; 3], ..Transform::IDENTITY }; 2] };
    clip(Track::Translation(ramp(Interpolation::Linear))).sample(0.0, Playback::Loop, &mut pose);
    assert_eq!(pose.locals[0], Transform { translation: [1.0, 0.0, 0.0], scale: [2.0; 3], ..Transform::IDENTITY });
    assert_eq!(pose.locals[1].translation, [0.0; 3]);
}

#[test]
fn parents_stand_anywhere() {
    let shift = |x: f64| Transform { translation: [x, 0.0, 0.0], ..Transform::IDENTITY };
    let turn = Transform { rotation: [0.0, 0.0, 2.0, 2.0], ..shift(10.0) };
    // 0 hangs from 2, 2 from 1; 3 stands alone.
    let joints =
        vec![joint(Some(2), shift(1.0)), joint(None, turn), joint(Some(1), shift(100.0)), joint(None, shift(-5.0))];
    let skeleton = Skeleton::new(joints).unwrap();
    let world = skeleton.world_from_joints(&skeleton.rest_pose());
    // The quarter turn about z takes x to y.
    for (joint, expected) in
        [(0, [10.0, 101.0, 0.0]), (1, [10.0, 0.0, 0.0]), (2, [10.0, 100.0, 0.0]), (3, [-5.0, 0.0, 0.0])]
    {
        assert!(DVec3::from(world[joint].apply([0.0; 3])).distance(expected.into()) < 1e-12, "{joint}");
    }
}

#[test]
fn bad_skeletons_are_refused() {
    let refuse = |parents: &[Option<usize>], words: &str| {
        let joints = parents.iter().map(|&parent| joint(parent, Transform::IDENTITY)).collect();
        let Err(Error::Skeleton(reason)) = Skeleton::new(joints) else { panic!("accepted") };
        assert!(reason.contains(words), "{reason}");
    };
    refuse(&[None, Some(7)], "joint 1 hangs from joint 7, but there are 2");
    refuse(&[Some(0)], "joint 0 hangs from a cycle");
    refuse(&[None, Some(3), Some(1), Some(2), Some(0)], "joint 1 hangs from a cycle");
    assert_eq!(Skeleton::new(Vec::new()).unwrap().joints().len(), 0);
    // A long chain, deepest joint first: no recursion.
    let count = 200_000;
    let chain = (0..count).map(|i| joint((i + 1 < count).then_some(i + 1), Transform::IDENTITY)).collect();
    Skeleton::new(chain).unwrap();
}
