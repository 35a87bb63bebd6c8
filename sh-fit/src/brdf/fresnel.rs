//! How much a smooth surface reflects.

use crate::Error;

/// The share of light that a smooth facet reflects, by the cosine of the angle to its normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fresnel {
    /// All of it: an ideal mirror, for the shape of a lobe alone.
    One,
    /// Schlick's approximation `F = F₀ + (1 − F₀)(1 − c)⁵`. Source: Schlick, *An Inexpensive BRDF Model for Physically-based
    /// Rendering*, Computer Graphics Forum 13(3), 1994.
    Schlick {
        /// The reflectance `F₀` along the normal, in `0..=1`.
        normal: f64,
    },
    /// The exact reflectance of unpolarised light at a clear medium.
    Dielectric {
        /// The relative index of refraction, from 1; about 1.5 for glass.
        index: f64,
    },
}

impl Fresnel {
    pub(super) fn validate(self) -> Result<(), Error> {
        match self {
            Self::Schlick { normal } if !(0.0..=1.0).contains(&normal) => {
                Err(Error::Parameter { what: "reflectance along the normal", given: normal, accepted: "0..=1" })
            }
            Self::Dielectric { index } if !(1.0..).contains(&index) || !index.is_finite() => {
                Err(Error::Parameter { what: "index of refraction", given: index, accepted: "a finite number from 1" })
            }
            _ => Ok(()),
        }
    }

    /// The reflectance at a cosine in `0..=1`.
    #[must_use]
    pub fn eval(self, cosine: f64) -> f64 {
        match self {
            Self::One => 1.0,
            Self::Schlick { normal } => normal + (1.0 - normal) * (1.0 - cosine).clamp(0.0, 1.0).powi(5),
            Self::Dielectric { index } => dielectric(index, cosine),
        }
    }
}

/// The mean of the squared amplitudes, perpendicular and parallel.
fn dielectric(index: f64, cosine: f64) -> f64 {
    if index == 1.0 {
        return 0.0;
    }
    let refracted = (1.0 - (1.0 - cosine * cosine) / (index * index)).max(0.0).sqrt();
    let perpendicular = (cosine - index * refracted) / (cosine + index * refracted);
    let parallel = (index * cosine - refracted) / (index * cosine + refracted);
    0.5 * (perpendicular * perpendicular + parallel * parallel)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values() {
        // ((1.5 − 1)/(1.5 + 1))² along the normal, all of it at the horizon, none without a boundary.
        let glass = Fresnel::Dielectric { index: 1.5 };
        assert!((glass.eval(1.0) - 0.04).abs() < 1e-15);
        assert_eq!((glass.eval(0.0), Fresnel::Dielectric { index: 1.0 }.eval(0.0)), (1.0, 0.0));
        // At Brewster's angle, tan θ = 1.5, the parallel part vanishes: half of ((1.5² − 1)/(1.5² + 1))².
        let brewster = 1.0 / (1.0 + 2.25_f64).sqrt();
        assert!((glass.eval(brewster) - 0.5 * (1.25_f64 / 3.25).powi(2)).abs() < 1e-15);
        let schlick = Fresnel::Schlick { normal: 0.04 };
        assert_eq!((schlick.eval(1.0), schlick.eval(0.0)), (0.04, 1.0));
        assert!((schlick.eval(0.5) - (0.04 + 0.96 / 32.0)).abs() < 1e-15);
    }
}
