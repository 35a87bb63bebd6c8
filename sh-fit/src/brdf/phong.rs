//! The lobe of Phong, normalised.

use std::f64::consts::TAU;

use super::{Brdf, dot, mirrored};
use crate::Error;

/// The largest exponent that is told apart: a larger one counts as this, a mirror to every order.
const MAX_EXPONENT: f64 = 1e8;

/// Phong's lobe about the direction of reflection, `b = (s + 2)/(2π) max(r·v, 0)^s` with `r` the mirrored light.
///
/// Reciprocal, and it keeps all light at normal incidence.
///
/// Source: Lafortune and Willems, *Using the Modified Phong Reflectance Model for Physically Based Rendering*, K.U. Leuven
/// report CW 197, 1994.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Phong {
    exponent: f64,
}

impl Phong {
    /// A lobe with an exponent from 0; above 1e8 it is a mirror of 1e8.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an exponent below 0 or NaN.
    pub fn new(exponent: f64) -> Result<Self, Error> {
        if !(0.0..).contains(&exponent) {
            return Err(Error::Parameter { what: "exponent", given: exponent, accepted: "0 or more" });
        }
        Ok(Self { exponent: exponent.min(MAX_EXPONENT) })
    }
}

impl Brdf for Phong {
    fn eval(&self, view: [f64; 3], light: [f64; 3]) -> f64 {
        if view[2] < 0.0 || light[2] < 0.0 {
            return 0.0;
        }
        let cosine = dot(mirrored(light, [0.0, 0.0, 1.0]), view).min(1.0);
        if cosine > 0.0 { (self.exponent + 2.0) / TAU * cosine.powf(self.exponent) } else { 0.0 }
    }

    /// Directions have the density `(s + 1)/(2π) cos^s` about the mirrored view.
    fn sample(&self, view: [f64; 3], square: [f64; 2]) -> ([f64; 3], f64) {
        let cosine = (1.0 - square[0]).powf(1.0 / (self.exponent + 1.0));
        let radius = ((1.0 - cosine) * (1.0 + cosine)).max(0.0).sqrt();
        let (sin, cos) = (TAU * square[1]).sin_cos();
        let [t, b, axis] = frame(mirrored(view, [0.0, 0.0, 1.0]));
        let light = std::array::from_fn(|k| radius * (cos * t[k] + sin * b[k]) + cosine * axis[k]);
        if view[2] < 0.0 || light[2] < 0.0 {
            return (light, 0.0);
        }
        (light, (self.exponent + 2.0) / (self.exponent + 1.0) * light[2])
    }
}

/// Two unit vectors that make a right-handed frame with the axis. Source: Duff et al., *Building an Orthonormal Basis,
/// Revisited*, Journal of Computer Graphics Techniques 6(1), 2017.
fn frame(axis: [f64; 3]) -> [[f64; 3]; 3] {
    let [x, y, z] = axis;
    let sign = 1.0_f64.copysign(z);
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    [[1.0 + sign * x * x * a, sign * b, -sign * x], [b, sign + y * y * a, -y], axis]
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    #[test]
    fn at_normal_incidence_all_light_returns() {
        // ∫ (s+2)/(2π) c^s c 2π dc = 1.
        for exponent in [0.0, 3.0, 50.0] {
            let phong = Phong::new(exponent).unwrap();
            let count = 100_000;
            let integrand = |c: f64| phong.eval([0.0, 0.0, 1.0], [(1.0 - c * c).sqrt(), 0.0, c]) * c * TAU;
            let sum: f64 = (0..count).map(|k| integrand((k as f64 + 0.5) / f64::from(count))).sum();
            assert!((sum / f64::from(count) - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn frames_are_orthonormal() {
        for axis in [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.48, -0.6, 0.64], [0.48, -0.6, -0.64]] {
            let rows = frame(axis);
            for (i, a) in rows.iter().enumerate() {
                for (j, b) in rows.iter().enumerate() {
                    assert!((dot(*a, *b) - f64::from(u8::from(i == j))).abs() < 1e-15);
                }
            }
        }
    }
}
