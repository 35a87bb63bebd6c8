//! The optional features `glam`, `nalgebra` and `serde`: run with `--all-features`.
#![cfg(feature = "alloc")]
#![cfg(any(feature = "glam", feature = "nalgebra", feature = "serde"))]
#![expect(clippy::unwrap_used, reason = "tests")]

/// Turning +x, then +y, then +z by the rows is what the library does, and what `ShRotation` does to an expansion.
#[cfg(any(feature = "glam", feature = "nalgebra"))]
#[track_caller]
fn assert_turns<T: sh_core::Real>(rows: [[T; 3]; 3], turn: impl Fn([T; 3]) -> [T; 3]) {
    let order = sh_core::Order::new(4).unwrap();
    let rotation = sh_core::ShRotation::new(order, rows);
    for axis in 0..3 {
        let before = std::array::from_fn(|i| if i == axis { T::ONE } else { T::ZERO });
        let after = turn(before);
        for (row, after) in rows.iter().zip(after) {
            assert!((row[axis] - after).abs().to_f64() < 4.0 * T::EPSILON.to_f64());
        }
        let [mut f, mut turned, mut expected] = [[T::ZERO; 16]; 3];
        sh_core::eval(order, before, &mut f);
        sh_core::eval(order, after, &mut expected);
        rotation.apply(&f, &mut turned);
        for (a, b) in turned.iter().zip(expected) {
            assert!((*a - b).abs().to_f64() < 20.0 * T::EPSILON.to_f64());
        }
    }
}

#[cfg(feature = "glam")]
#[test]
fn glam_rotations_are_the_same_rotation() {
    use glam::{DMat3, DQuat, DVec3, Mat3, Mat3A, Quat, Vec3};
    use sh_core::RotationRows;

    let axis = Vec3::new(0.36, -0.48, 0.8);
    let quat = Quat::from_axis_angle(axis, 1.1);
    let turn = |d: [f32; 3]| (quat * Vec3::from(d)).to_array();
    assert_turns(quat.to_rows(), turn);
    assert_turns(Mat3::from_quat(quat).to_rows(), turn);
    assert_turns(Mat3A::from_quat(quat).to_rows(), turn);
    let quat = DQuat::from_axis_angle(DVec3::new(0.36, -0.48, 0.8), 1.1);
    let turn = |d: [f64; 3]| (quat * DVec3::from(d)).to_array();
    assert_turns(quat.to_rows(), turn);
    assert_turns(DMat3::from_quat(quat).to_rows(), turn);
}

#[cfg(feature = "nalgebra")]
#[test]
fn nalgebra_rotations_are_the_same_rotation() {
    use nalgebra::{Unit, UnitQuaternion, Vector3};
    use sh_core::RotationRows;

    let quat = UnitQuaternion::from_axis_angle(&Unit::new_normalize(Vector3::new(0.36, -0.48, 0.8)), 1.1);
    let turn = |d: [f64; 3]| (quat * Vector3::from(d)).into();
    assert_turns(RotationRows::<f64>::to_rows(&quat), turn);
    assert_turns(quat.to_rotation_matrix().to_rows(), turn);
    assert_turns(quat.to_rotation_matrix().matrix().to_rows(), turn);
}

#[cfg(feature = "nalgebra")]
#[test]
fn scaling_matrices_become_nalgebra_matrices() {
    use sh_core::{Order, Preserve, ScalingMatrix, Tau};

    let orders = [3, 4].map(|n| Order::new(n).unwrap());
    let matrix = ScalingMatrix::<f64>::new(orders[0], orders[1], Tau::cone(1.5), Preserve::Value).unwrap();
    let dense = nalgebra::DMatrix::from(&matrix);
    assert_eq!(dense.shape(), (9, 16));
    let coeffs: Vec<f64> = (0..16).map(|i| f64::from(i).cos()).collect();
    let mut out = [0.0; 9];
    matrix.apply(&coeffs, &mut out);
    let product = dense * nalgebra::DVector::from_vec(coeffs);
    assert!(product.iter().zip(out).all(|(a, b)| (a - b).abs() < 1e-14));
}

#[cfg(feature = "serde")]
#[test]
fn options_are_written_and_read() {
    use sh_core::{CubeMap, Interpolation, LatLong, Order, Preserve, SplatLayout, Tau, Window};

    fn there_and_back<T>(value: &T, json: &str)
    where
        T: serde::Serialize + serde::de::DeserializeOwned + PartialEq + std::fmt::Debug,
    {
        assert_eq!(serde_json::to_string(value).unwrap(), json);
        assert_eq!(serde_json::from_str::<T>(json).unwrap(), *value);
    }
    there_and_back(&Order::new(6).unwrap(), "6");
    there_and_back(&LatLong { width: 4, height: 2 }, r#"{"width":4,"height":2}"#);
    there_and_back(&CubeMap { size: 8 }, r#"{"size":8}"#);
    there_and_back(&Tau::Cone { k: 0.5, alpha: 0.25 }, r#"{"Cone":{"k":0.5,"alpha":0.25}}"#);
    there_and_back(&Preserve::Energy, r#""Energy""#);
    there_and_back(&Interpolation::CubicLog, r#""CubicLog""#);
    there_and_back(&Window::Lanczos, r#""Lanczos""#);
    there_and_back(&SplatLayout::Planar, r#""Planar""#);
}

#[cfg(feature = "serde")]
#[test]
fn orders_are_checked_when_read() {
    use sh_core::Order;

    for (json, message) in [
        ("0", "order 0 is not in 1..=512"),
        ("513", "order 513 is not in 1..=512"),
        ("18446744073709551615", "order 18446744073709551615 is not in 1..=512"),
    ] {
        assert_eq!(serde_json::from_str::<Order>(json).unwrap_err().to_string(), message);
    }
    assert!(serde_json::from_str::<Order>("-1").is_err());
    assert!(serde_json::from_str::<Order>("2.5").is_err());
}

#[cfg(feature = "serde")]
#[test]
fn expansions_keep_their_length() {
    use sh_core::Sh2;

    let sh = Sh2::new([1.0_f32, -2.5, 0.0, 3.0]);
    assert_eq!(serde_json::to_string(&sh).unwrap(), "[1.0,-2.5,0.0,3.0]");
    assert_eq!(serde_json::from_str::<Sh2<f32>>("[1.0,-2.5,0.0,3.0]").unwrap(), sh);
    for json in ["[1.0,2.0,3.0]", "[1.0,2.0,3.0,4.0,5.0]", "[]"] {
        let message = serde_json::from_str::<Sh2<f32>>(json).unwrap_err().to_string();
        assert!(message.contains("expected 4 coefficients"), "{message}");
    }
}
