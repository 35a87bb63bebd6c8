//! Deformations in closed form: Jacobians, limits and the geometry that they promise.

use std::f64::consts::{PI, TAU};

use glam::{DMat3, DVec3};
use proptest::prelude::*;
use prt_anim::{Deformation, Deformed, rotation_of};

const BOUNDS: [[f64; 3]; 2] = [[-0.5, -1.0, -0.25], [0.5, 3.0, 0.75]];

fn one() -> impl Strategy<Value = Deformation> {
    let strength = || -2.0..2.0_f64;
    prop_oneof![
        strength().prop_map(|angle| Deformation::bend(BOUNDS, angle)),
        strength().prop_map(|angle| Deformation::twist(BOUNDS, 3.0 * angle)),
        (strength(), 0.2..4.0_f64, strength()).prop_map(|(a, waves, phase)| Deformation::wave(
            BOUNDS,
            0.1 * a,
            waves,
            phase
        )),
        strength().prop_map(|strength| Deformation::taper(BOUNDS, strength)),
        tilted(),
    ]
}

/// A bend about axes that are no coordinate axes.
fn tilted() -> impl Strategy<Value = Deformation> {
    (prop::array::uniform3(-1.0..1.0_f64), -2.0..2.0_f64).prop_map(|(direction, curvature)| {
        let along = (DVec3::from(direction) + DVec3::splat(1e-3)).normalize();
        let toward = along.any_orthonormal_vector().to_array();
        Deformation::Bend { origin: [0.1, 0.2, 0.3], along: along.to_array(), toward, curvature }
    })
}

fn deformation() -> impl Strategy<Value = Deformation> {
    prop_oneof![4 => one(), 1 => prop::collection::vec(one(), 0..4).prop_map(Deformation::Chain)]
}

fn point() -> impl Strategy<Value = [f64; 3]> {
    (-0.5..0.5_f64, -1.0..3.0_f64, -0.25..0.75_f64).prop_map(|(x, y, z)| [x, y, z])
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Central differences: the error is a third derivative (chains of twists reach thousands) times h², and rounding over h.
    #[test]
    fn jacobian_equals_central_differences(deformation in deformation(), p in point()) {
        let h = 1e-5;
        let jacobian = deformation.jacobian(p);
        for (axis, column) in DVec3::AXES.into_iter().zip(jacobian) {
            let step = axis * h;
            let [forward, back] = [1.0, -1.0].map(|sign| DVec3::from(deformation.apply((DVec3::from(p) + step * sign).to_array())));
            let difference = (forward - back) / (2.0 * h);
            let scale = 1.0 + difference.length();
            prop_assert!(difference.distance(column.into()) < 1e-6 * scale, "{difference} {:?}", column);
        }
    }

    /// Strength zero changes no bit.
    #[test]
    fn strength_zero_is_the_identity(p in prop::array::uniform3(-1e6..1e6_f64), waves in 0.0..9.0_f64, phase in -9.0..9.0_f64) {
        let none = [
            Deformation::bend(BOUNDS, 0.0),
            Deformation::twist(BOUNDS, 0.0),
            Deformation::wave(BOUNDS, 0.0, waves, phase),
            Deformation::taper(BOUNDS, 0.0),
            Deformation::Chain(Vec::new()),
        ];
        for deformation in none.iter().chain([&Deformation::Chain(none.to_vec())]) {
            prop_assert_eq!(deformation.apply(p), p);
            prop_assert_eq!(deformation.jacobian(p), DMat3::IDENTITY.to_cols_array_2d());
        }
    }

    /// A bend is a circle: all points of a line along it stay at one distance from its centre, and arcs on the neutral line keep their length.
    #[test]
    fn a_bend_is_a_circle(angle in 0.01..6.0_f64, s in -2.0..2.0_f64, d in -0.5..0.5_f64) {
        let deformation = Deformation::bend(BOUNDS, angle);
        // The box's longest side is y; x and z are equal, of which z is the first; its centre is (0, 1, 0.25).
        let radius = 4.0 / angle;
        let image = DVec3::from(deformation.apply([0.0, 1.0 + s, 0.25 + d]));
        let center = DVec3::new(0.0, 1.0, 0.25 + radius);
        prop_assert!((image.distance(center) - (radius - d).abs()).abs() < 1e-9 * radius);
        let turned = s * angle / 4.0;
        let expected = center + (radius - d) * DVec3::new(0.0, turned.sin(), -turned.cos());
        prop_assert!(image.distance(expected) < 1e-9 * radius);
        let tangent = DVec3::from(deformation.jacobian([0.3, 1.0 + s, 0.25])[1]);
        prop_assert!((tangent.length() - 1.0).abs() < 1e-12);
    }

    /// A twist keeps volume, height and the distance from its axis; its ends differ by the angle.
    #[test]
    fn a_twist_turns_sections(angle in -7.0..7.0_f64, p in point()) {
        let deformation = Deformation::twist(BOUNDS, angle);
        let image = deformation.apply(p);
        prop_assert!((DMat3::from_cols_array_2d(&deformation.jacobian(p)).determinant() - 1.0).abs() < 1e-9);
        let phi = angle * (p[1] - 1.0) / 4.0;
        let (x, z) = (p[0], p[2] - 0.25);
        // About +y: z turns to x.
        let expected = [phi.cos() * x + phi.sin() * z, p[1], 0.25 + phi.cos() * z - phi.sin() * x];
        prop_assert!(DVec3::from(image).distance(expected.into()) < 1e-12);
    }

    #[test]
    fn chains_compose(a in one(), b in one(), p in point()) {
        let chain = Deformation::Chain(vec![a.clone(), b.clone()]);
        let between = a.apply(p);
        prop_assert_eq!(chain.apply(p), b.apply(between));
        let expected = DMat3::from_cols_array_2d(&b.jacobian(between)) * DMat3::from_cols_array_2d(&a.jacobian(p));
        let jacobian = DMat3::from_cols_array_2d(&chain.jacobian(p));
        let scale = expected.to_cols_array().into_iter().fold(1.0, |largest: f64, value| largest.max(value.abs()));
        prop_assert!(jacobian.abs_diff_eq(expected, 1e-12 * scale));
    }

    /// Whole meshes are deformed as their vertices are.
    #[test]
    fn meshes_follow(deformation in deformation(), p in point(), n in prop::array::uniform3(-1.0..1.0_f32)) {
        let mut out = Deformed::default();
        let n = (glam::Vec3::from(n) + glam::Vec3::splat(1e-3)).normalize().to_array();
        let position = p.map(|value| value as f32);
        deformation.deform(&[position; 3], &[n; 3], &mut out);
        let p = position.map(f64::from);
        prop_assert_eq!(&out.positions, &[deformation.apply(p).map(|value| value as f32); 3]);
        let frame = rotation_of(deformation.jacobian(p), n.map(f64::from));
        prop_assert_eq!(&out.frames, &[frame; 3]);
        let normal = glam::Mat3::from_cols_array_2d(&frame) * glam::Vec3::from(n);
        prop_assert!(normal.distance(out.normals[2].into()) < 3e-7);
    }

    #[test]
    fn extremes_stay_finite(strength in special(), bounds in prop::array::uniform2(prop::array::uniform3(special())), p in prop::array::uniform3(special())) {
        let position = p.map(|value| value as f32);
        for deformation in [
            Deformation::bend(bounds, strength),
            Deformation::twist(bounds, strength),
            Deformation::wave(bounds, strength, strength, strength),
            Deformation::taper(bounds, strength),
        ] {
            let mut out = Deformed::default();
            deformation.deform(&[position], &[position], &mut out);
            let values = out.positions[0].iter().chain(out.normals[0].iter()).chain(out.frames[0].as_flattened());
            prop_assert!(values.into_iter().all(|value| value.is_finite()), "{deformation:?} {out:?}");
        }
    }
}

fn special() -> impl Strategy<Value = f64> {
    prop_oneof![-2.0..2.0_f64, prop::sample::select(vec![0.0, 1e-300, 1e30, -1e30, 1e300, f64::NAN, f64::INFINITY])]
}

/// A wave has moved by one wavelength when its phase has grown by 2π, and moves towards +along.
#[test]
fn a_wave_travels() {
    let at = |phase: f64, y: f64| Deformation::wave(BOUNDS, 0.1, 2.0, phase).apply([0.0, y, 0.0])[2];
    for y in [-1.0, 0.2, 1.7] {
        assert!((at(0.0, y) - at(TAU, y)).abs() < 1e-12);
        // The wavelength is 2: a quarter of it for a quarter turn.
        assert!((at(PI / 2.0, y + 0.5) - at(0.0, y)).abs() < 1e-12);
    }
    // Amplitude 0.1 · 4 at a quarter of a wavelength from the centre, y = 1.
    assert!((at(0.0, 1.5) - 0.4).abs() < 1e-12);
}

#[test]
fn a_taper_scales_sections() {
    let deformation = Deformation::taper(BOUNDS, 2_f64.ln());
    let far = deformation.apply([0.5, 3.0, 0.25])[0];
    let near = deformation.apply([0.5, -1.0, 0.25])[0];
    assert!((far / near - 2.0).abs() < 1e-12 && (far * near - 0.25).abs() < 1e-12);
    assert_eq!(deformation.apply([0.5, 1.0, 0.0]), [0.5, 1.0, 0.0]);
}

#[test]
fn sides_of_boxes() {
    let sides = |size: [f64; 3]| match Deformation::bend([[0.0; 3], size], 1.0) {
        Deformation::Bend { along, toward, curvature, .. } => (along, toward, 1.0 / curvature),
        other => panic!("{other:?}"),
    };
    let [x, y, z] = DVec3::AXES.map(|axis| axis.to_array());
    assert_eq!(sides([1.0; 3]), (y, z, 1.0));
    assert_eq!(sides([3.0, 1.0, 2.0]), (x, y, 3.0));
    assert_eq!(sides([3.0, 2.0, 0.0]), (x, z, 3.0));
    assert_eq!(sides([2.0, 2.0, 9.0]), (z, x, 9.0));
    assert_eq!(sides([0.0; 3]), (y, z, 1.0));
}
