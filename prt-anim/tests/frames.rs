//! The rotation by which lobes follow a surface, its laws and its extremes.
#![expect(clippy::unwrap_used, clippy::print_stderr, reason = "tests, and what they measure is printed")]

use glam::{DMat3, DQuat, DVec3, Mat3};
use proptest::prelude::*;
use prt_anim::{
    Deformation, Deformed, frames_from_mesh, push_tangent_frame, push_tangent_frames, rotation_of, tangent_frames,
};
use sh_core::{Order, ShRotation, expand_lobe};

/// Frames are rounded to `f32`: six units in the last place for products of two of them.
const ROUNDING: f32 = 4e-7;

type Frame = [[f32; 3]; 3];

fn unit() -> impl Strategy<Value = DVec3> {
    (-1.0..1.0_f64, 0.0..std::f64::consts::TAU).prop_map(|(z, phi)| {
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * phi.cos(), r * phi.sin(), z)
    })
}

fn rotation() -> impl Strategy<Value = DMat3> {
    (unit(), -3.2..3.2_f64).prop_map(|(axis, angle)| DMat3::from_quat(DQuat::from_axis_angle(axis, angle)))
}

/// Matrices that neither mirror nor collapse: of a mirror the angle may be badly conditioned or undefined.
fn proper() -> impl Strategy<Value = DMat3> {
    let matrix = prop::array::uniform9(-1.0..1.0_f64).prop_map(|values| DMat3::from_cols_array(&values));
    let positive = matrix.prop_map(|f| if f.determinant() < 0.0 { f * -1.0 } else { f });
    positive.prop_map(|f| if f.determinant() < 0.02 { f + DMat3::IDENTITY * 3.0 } else { f })
}

fn rotate(gradient: DMat3, normal: DVec3) -> Mat3 {
    Mat3::from_cols_array_2d(&rotation_of(gradient.to_cols_array_2d(), normal.to_array()))
}

fn distance(a: Mat3, b: Mat3) -> f32 {
    (a - b).to_cols_array().into_iter().fold(0.0, |largest, value: f32| largest.max(value.abs()))
}

#[track_caller]
fn assert_rotation(frame: Mat3) {
    assert!(frame.is_finite(), "{frame}");
    assert!(distance(frame * frame.transpose(), Mat3::IDENTITY) < ROUNDING, "{frame}");
    assert!(frame.determinant() > 0.0, "{frame}");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_rotation_is_itself(r in rotation(), n in unit(), scale in -200.0..200.0_f64) {
        prop_assert!(distance(rotate(r * scale.exp2(), n), r.as_mat3()) < ROUNDING);
    }

    /// The normal against the inverse transpose, the tangents against the polar factor found by Newton's iteration.
    #[test]
    fn normal_and_tangents_by_a_second_method(f in proper(), n in unit()) {
        let r = rotate(f, n).as_dmat3();
        let expected = (f.inverse().transpose() * n).normalize();
        prop_assert!((r * n).distance(expected) < 1e-6);
        // The gradient of the surface alone, completed by the normals: its nearest rotation is ours.
        let on_surface = f - f * DMat3::from_cols(n * n.x, n * n.y, n * n.z);
        let completed = on_surface + DMat3::from_cols(expected * n.x, expected * n.y, expected * n.z);
        prop_assert!(distance(polar(completed).as_mat3(), r.as_mat3()) < 1e-5);
    }

    /// A rotation before or after changes the frame by just that.
    #[test]
    fn commutes_with_rotations(f in proper(), n in unit(), before in rotation(), after in rotation()) {
        let whole = rotate(after * f * before, before.transpose() * n);
        let parts = after.as_mat3() * rotate(f, n) * before.as_mat3();
        prop_assert!(distance(whole, parts) < 1e-4);
    }

    #[test]
    fn any_matrix_gives_a_rotation(values in prop::array::uniform9(number()), normal in prop::array::uniform3(number())) {
        let f = DMat3::from_cols_array(&values);
        assert_rotation(Mat3::from_cols_array_2d(&rotation_of(f.to_cols_array_2d(), normal)));
        let frame = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], normal.map(|value| value as f32)];
        let pushed = Mat3::from_cols_array_2d(&push_tangent_frame(f.to_cols_array_2d(), frame));
        prop_assert!(distance(pushed * pushed.transpose(), Mat3::IDENTITY) < ROUNDING);
    }

    /// Plane to line: the line is followed.
    #[test]
    fn rank_one_follows_its_line(from in unit(), to in unit(), n in unit()) {
        let along = from - n * n.dot(from);
        prop_assume!(along.length() > 0.1);
        let f = DMat3::from_cols(to * from.x, to * from.y, to * from.z);
        let r = rotate(f, n);
        assert_rotation(r);
        prop_assert!((r.as_dmat3() * along.normalize()).distance(to) < 1e-6);
    }

    /// Plane kept, thickness lost: the limit of thin slabs.
    #[test]
    fn rank_two_keeps_the_surface(r in rotation(), n in unit()) {
        let flat = DMat3::IDENTITY - DMat3::from_cols(n * n.x, n * n.y, n * n.z);
        prop_assert!(distance(rotate(r * flat, n), r.as_mat3()) < ROUNDING);
    }

    /// Lobes turned by the frame are the lobes' expansion turned exactly.
    #[test]
    fn lobes_follow_the_frame(r in rotation(), n in unit(), axis in unit(), lobe in prop::array::uniform6(-1.0..1.0_f64)) {
        let order = Order::new(6).unwrap();
        let frame = rotate(r, n).as_dmat3();
        let (mut rest, mut turned, mut expected) = (vec![0.0; 36], vec![0.0; 36], vec![0.0; 36]);
        expand_lobe(order, &lobe, axis.to_array(), &mut rest);
        expand_lobe(order, &lobe, (frame * axis).normalize().to_array(), &mut turned);
        let rows = r.transpose().to_cols_array_2d();
        ShRotation::new(order, rows).apply(&rest, &mut expected);
        for (a, b) in turned.iter().zip(&expected) {
            // A frame of f32, times the slope of band 5.
            prop_assert!((a - b).abs() < 1e-5, "{a} {b}");
        }
    }
}

/// Ordinary numbers, and those that break formulas.
fn number() -> impl Strategy<Value = f64> {
    let special = vec![
        0.0,
        -0.0,
        1.0,
        -1.0,
        1e-300,
        1e300,
        f64::MAX,
        f64::MIN_POSITIVE,
        5e-324,
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        1e-12,
    ];
    prop_oneof![-2.0..2.0_f64, prop::sample::select(special)]
}

/// The rotation nearest to a matrix, by Newton's iteration for its polar factor (Higham 1986).
fn polar(matrix: DMat3) -> DMat3 {
    (0..60).fold(matrix, |x, _| (x + x.inverse().transpose()) * 0.5)
}

#[test]
fn a_mirror_keeps_to_the_winding() {
    let mirror = DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0));
    // Through its own plane nothing of the surface moves.
    assert!(distance(rotate(mirror, DVec3::Z), Mat3::IDENTITY) < ROUNDING);
    // Across its plane the winding turns, and so does the normal.
    let turned = rotate(mirror, DVec3::X);
    assert_rotation(turned);
    assert!((turned * glam::Vec3::X).distance(glam::Vec3::NEG_X) < ROUNDING);
}

#[test]
fn collapse_to_a_point_is_the_identity() {
    assert_eq!(rotate(DMat3::ZERO, DVec3::X), Mat3::IDENTITY);
    // All that is left moves along the normal.
    assert_eq!(rotate(DMat3::from_diagonal(DVec3::Z), DVec3::Z), Mat3::IDENTITY);
}

/// A sphere of latitudes and longitudes, irregular on purpose; its poles are single vertices.
fn sphere(rings: usize) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let around = 2 * rings;
    let mut positions = vec![[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    for ring in 1..rings {
        for i in 0..around {
            let theta = std::f64::consts::PI * ring as f64 / rings as f64;
            let phi = std::f64::consts::TAU * (i as f64 + 0.3 * (ring as f64).sin()) / around as f64;
            positions.push([theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()].map(|value| value as f32));
        }
    }
    let at = |ring: usize, i: usize| (2 + (ring - 1) * around + i % around) as u32;
    let mut triangles = Vec::new();
    for i in 0..around {
        triangles.extend([[0, at(1, i), at(1, i + 1)], [1, at(rings - 1, i + 1), at(rings - 1, i)]]);
        for ring in 1..rings - 1 {
            let (a, b, c, d) = (at(ring, i), at(ring, i + 1), at(ring + 1, i), at(ring + 1, i + 1));
            triangles.extend([[a, c, d], [a, d, b]]);
        }
    }
    (positions, triangles)
}

/// Root of the mean square, and the largest, angle between frames.
fn angles(a: &[Frame], b: &[Frame]) -> (f64, f64) {
    let angle = |(a, b): (&Frame, &Frame)| {
        let between = Mat3::from_cols_array_2d(a).as_dmat3().transpose() * Mat3::from_cols_array_2d(b).as_dmat3();
        // |R − I|² = 8 sin²(angle / 2), in Frobenius' norm; accurate for small angles.
        let difference = between - DMat3::IDENTITY;
        let square: f64 = difference.to_cols_array().iter().map(|value| value * value).sum();
        2.0 * (square / 8.0).sqrt().min(1.0).asin()
    };
    let all: Vec<f64> = a.iter().zip(b).map(angle).collect();
    let square: f64 = all.iter().map(|angle| angle * angle).sum();
    ((square / all.len() as f64).sqrt(), all.into_iter().fold(0.0, f64::max))
}

#[test]
fn mesh_frames_of_rigid_motions_and_scaling() {
    let (rest, triangles) = sphere(12);
    let r = DMat3::from_quat(DQuat::from_axis_angle(DVec3::new(2.0, 3.0, -6.0) / 7.0, 2.0));
    let moved: Vec<[f32; 3]> = rest
        .iter()
        .map(|&point| (2.5 * (r * DVec3::from(point.map(f64::from))) + DVec3::new(1.0, -2.0, 0.5)).as_vec3().to_array())
        .collect();
    let frames = frames_from_mesh(&rest, &rest, &moved, &triangles);
    let expected = vec![r.as_mat3().to_cols_array_2d(); rest.len()];
    // Positions of size 5 are rounded by 2e-7, the shortest edges are 0.07 · 2.5.
    assert!(angles(&frames, &expected).1 < 3e-6);
}

/// Against the exact frames of the same bend: the error falls with the edges, and is what the README says.
#[test]
fn mesh_frames_converge() {
    let bend = Deformation::Chain(vec![
        Deformation::bend([[-1.0; 3], [1.0; 3]], 1.5),
        Deformation::twist([[-1.0; 3], [1.0; 3]], 1.0),
    ]);
    let error = |rings| {
        let (rest, triangles) = sphere(rings);
        let mut exact = Deformed::default();
        bend.deform(&rest, &rest, &mut exact);
        angles(&frames_from_mesh(&rest, &rest, &exact.positions, &triangles), &exact.frames)
    };
    let errors = [16, 32, 64].map(error);
    eprintln!("rms and largest angle at 16, 32, 64 rings: {errors:?}");
    assert!(errors.windows(2).all(|pair| pair[1].0 < 0.55 * pair[0].0 && pair[1].1 < 0.7 * pair[0].1), "{errors:?}");
    assert!(errors[2].0 < 3.5e-3, "{errors:?}");
}

#[test]
fn mesh_frames_of_broken_meshes() {
    let rest = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [5.0; 3], [0.5, 0.0, 0.0]];
    let normals = [[0.0, 0.0, 1.0], [0.0; 3], [f32::NAN; 3], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    // A face; one without area in the rest pose.
    let triangles = [[0, 1, 2], [0, 4, 1]];
    let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let point = frames_from_mesh(&rest, &normals, &[[7.0; 3]; 5], &triangles);
    assert_eq!(point, [identity; 5]);
    let mut gone = rest;
    gone[1] = [f32::NAN, f32::INFINITY, 0.0];
    assert_eq!(frames_from_mesh(&rest, &normals, &gone, &triangles), [identity; 5]);
    let line = [[0.0; 3], [0.0, 0.0, 2.0], [0.0, 0.0, 1.0], [0.0; 3], [0.0; 3]];
    let frames = frames_from_mesh(&rest, &normals, &line, &triangles);
    frames.iter().for_each(|&frame| assert_rotation(Mat3::from_cols_array_2d(&frame)));
    assert_eq!((frames[3], frames[4]), (identity, identity));
    assert!(frames_from_mesh(&[], &[], &[], &[]).is_empty());
}

/// Positions, normals, texture coordinates and triangles.
type Patch = (Vec<[f32; 3]>, Vec<[f32; 3]>, Vec<[f32; 2]>, Vec<[u32; 3]>);

/// A patch of a surface over `(u, v)` with its normals; `mirror` turns `u` around.
fn patch(point: impl Fn(f64, f64) -> DVec3, mirror: bool) -> Patch {
    const N: u32 = 24;
    let (mut positions, mut normals, mut uvs, mut triangles) = (vec![], vec![], vec![], vec![]);
    for j in 0..=N {
        for i in 0..=N {
            let (u, v) = (f64::from(i) / f64::from(N), f64::from(j) / f64::from(N));
            let h = 1e-5;
            let normal = (point(u + h, v) - point(u - h, v)).cross(point(u, v + h) - point(u, v - h)).normalize();
            positions.push(point(u, v).as_vec3().to_array());
            normals.push(normal.as_vec3().to_array());
            uvs.push([if mirror { 1.0 - u } else { u } as f32, v as f32]);
            if i < N && j < N {
                let a = j * (N + 1) + i;
                triangles.extend([[a, a + 1, a + N + 2], [a, a + N + 2, a + N + 1]]);
            }
        }
    }
    (positions, normals, uvs, triangles)
}

fn wavy(u: f64, v: f64) -> DVec3 {
    DVec3::new(u + 0.2 * v, v, 0.1 * (5.0 * u).sin() * (3.0 * v).cos())
}

#[test]
fn tangents_are_the_derivatives() {
    let (positions, normals, uvs, triangles) = patch(wavy, false);
    let frames = tangent_frames(&positions, &normals, &uvs, &triangles);
    for (vertex, &frame) in frames.iter().enumerate() {
        let frame = Mat3::from_cols_array_2d(&frame);
        assert_rotation(frame);
        let [u, v] = uvs[vertex].map(f64::from);
        let by_u = (wavy(u + 1e-5, v) - wavy(u - 1e-5, v)).normalize();
        // One-sided differences at the rim over edges of 1/24, slopes change by 2.5 a unit.
        assert!(frame.x_axis.as_dvec3().distance(by_u) < 0.06, "{u} {v}");
        assert!(frame.z_axis.distance(normals[vertex].into()) < ROUNDING);
    }
}

#[test]
fn mirrored_coordinates_give_left_handed_frames() {
    let (positions, normals, uvs, triangles) = patch(wavy, false);
    let (_, _, mirrored, _) = patch(wavy, true);
    let frames = tangent_frames(&positions, &normals, &uvs, &triangles);
    let others = tangent_frames(&positions, &normals, &mirrored, &triangles);
    for (frame, other) in frames.iter().zip(&others) {
        let [frame, other] = [frame, other].map(Mat3::from_cols_array_2d);
        assert!(frame.determinant() > 0.99 && other.determinant() < -0.99);
        assert!(frame.x_axis.distance(-other.x_axis) < 1e-6 && frame.y_axis.distance(other.y_axis) < 1e-6);
    }
}

#[test]
fn tangent_frames_of_broken_meshes() {
    let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [2.0; 3]];
    let normals = [[0.0, 0.0, 1.0], [0.0; 3], [f32::NAN, 0.0, 0.0], [0.0, 0.0, -3.0]];
    for uvs in [
        [[0.5; 2]; 4],
        [[f32::NAN; 2]; 4],
        [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [0.0, 0.0]],
        [[f32::MAX, 0.0], [0.0, 0.0], [0.0, f32::MIN], [0.0, 0.0]],
    ] {
        for triangles in [&[[0, 1, 2]][..], &[[0, 0, 1], [3, 3, 3]]] {
            for frame in tangent_frames(&positions, &normals, &uvs, triangles) {
                let frame = Mat3::from_cols_array_2d(&frame);
                assert!(distance(frame * frame.transpose(), Mat3::IDENTITY) < ROUNDING, "{frame}");
            }
        }
    }
}

/// Pushed through the exact Jacobian, or made anew on the deformed mesh: the same within the size of a face.
#[test]
fn pushed_tangents_are_those_of_the_deformed_mesh() {
    for mirror in [false, true] {
        let (positions, normals, uvs, triangles) = patch(wavy, mirror);
        let bend = Deformation::bend([[0.0, 0.0, -0.1], [1.2, 1.0, 0.1]], 2.0);
        let mut deformed = Deformed::default();
        bend.deform(&positions, &normals, &mut deformed);
        let rest = tangent_frames(&positions, &normals, &uvs, &triangles);
        let anew = tangent_frames(&deformed.positions, &deformed.normals, &uvs, &triangles);
        for vertex in 0..rest.len() {
            let pushed = push_tangent_frame(bend.jacobian(positions[vertex].map(f64::from)), rest[vertex]);
            let [pushed, anew] = [pushed, anew[vertex]].map(|frame| Mat3::from_cols_array_2d(&frame));
            assert!(distance(pushed, anew) < 0.03, "{pushed} {anew}");
        }
    }
}

#[test]
fn frames_turn_tangent_frames() {
    let r = Mat3::from_axis_angle(glam::Vec3::new(0.6, 0.0, 0.8), 1.0);
    let left = Mat3::from_cols(glam::Vec3::X, glam::Vec3::NEG_Y, glam::Vec3::Z);
    let mut out = [[[0.0; 3]; 3]];
    push_tangent_frames(&[r.to_cols_array_2d()], &[left.to_cols_array_2d()], &mut out);
    assert!(distance(Mat3::from_cols_array_2d(&out[0]), r * left) < ROUNDING);
    let pushed = push_tangent_frame(r.as_dmat3().to_cols_array_2d(), left.to_cols_array_2d());
    assert!(distance(Mat3::from_cols_array_2d(&pushed), r * left) < ROUNDING);
}
