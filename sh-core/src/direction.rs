//! A unit direction from any vector.

use crate::Real;

/// The vector at unit length, or `None` if it is zero or not finite.
///
/// Scaled by its largest component first, so that neither 1e-300 nor 1e300 is lost on the way.
pub(crate) fn unit(vector: [f64; 3]) -> Option<[f64; 3]> {
    let largest = vector.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    // `max` skips a NaN, so each component is looked at.
    if largest == 0.0 || !vector.iter().all(|x| x.is_finite()) {
        return None;
    }
    // In two steps: the reciprocal of a subnormal number is infinite.
    let scaled = vector.map(|x| x / largest);
    let length = Real::sqrt(dot3(scaled, scaled));
    Some(scaled.map(|x| x / length))
}

/// The vector at unit length; +z if it is zero or not finite.
pub(crate) fn unit_or_z<T: Real>(vector: [T; 3]) -> [f64; 3] {
    unit(vector.map(T::to_f64)).unwrap_or([0.0, 0.0, 1.0])
}

/// The dot product of two vectors.
pub(crate) fn dot3(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The cross product of two vectors.
#[cfg(feature = "alloc")]
pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_finite_vector_with_a_length_has_a_direction() {
        for size in [5e-324, 1e-300, 1e-3, 1.0, 1e200, f64::MAX] {
            assert_eq!(unit([0.0, -size, 0.0]), Some([0.0, -1.0, 0.0]), "{size}");
        }
        let [x, y, z] = unit_or_z([3e-40_f32, 0.0, 4e-40]);
        assert!((x - 0.6).abs() < 1e-5 && y == 0.0 && (z - 0.8).abs() < 1e-5);
    }

    #[test]
    fn others_are_plus_z() {
        for bad in [[0.0; 3], [f32::NAN, 1.0, 1.0], [1.0, f32::INFINITY, 0.0], [0.0, 0.0, f32::NEG_INFINITY]] {
            assert_eq!(unit_or_z(bad), [0.0, 0.0, 1.0]);
        }
    }
}
