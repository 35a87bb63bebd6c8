//! Which direction of the captured function is seen in a direction after moving along the axis.

use core::f64::consts::{FRAC_PI_4, PI};

use crate::{Error, Real};

/// An angular scaling function: the polar angle `θ_r = τ(θ)` at which a captured function `F_r` is read for the direction
/// `θ` of the scaled function, `F(θ, φ) = F_r(τ(θ), φ)`.
///
/// Angles are measured from +z, which points away from the place of capture for [`Tau::MidRange`] with `k > 0`, and from the
/// viewer to the object for the other two. All three are smooth, increasing in `θ`, and are evaluated without branches,
/// poles, tangents or cotangents.
///
/// Work on occlusion `1 − V`, not on visibility `V`: the cone reads `V` far from the axis, where a truncated expansion rings,
/// and so darkens the far field by some per cent at every distance.
///
/// ```
/// use sh_core::Tau;
///
/// // From twice the distance an object looks smaller: what is at 10° is read at more than 10°.
/// let tau = Tau::cone(2.0);
/// assert!(tau.angle(0.17).unwrap() > 0.17);
/// assert_eq!(Tau::cone(1.0).angle(1.25), Some(1.25));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(::serde::Serialize, ::serde::Deserialize))]
pub enum Tau {
    /// The cone geometric approximation: the object's surface is a cone that faces the viewer.
    ///
    /// `τ = atan2(k sinθ, cosθ + (1−k) cot α sinθ)`, fixed at `0`, `π − α` and `π`; `τ_a ∘ τ_b = τ_ab`.
    ///
    /// Source: [WXZ06](crate#references) section 3.1, written without its branch and poles.
    Cone {
        /// Distance of the viewer over the distance of capture, `d/r`, in `1e-100..=1e100`.
        k: f64,
        /// Angle of the cone's surface from the axis, in `1e-4..=π − 1e-4`; the paper has `π/4`.
        alpha: f64,
    },
    /// Light from a sphere of finite radius, seen from a point off its centre.
    ///
    /// `t = −k cosθ + √(1 − k² sin²θ)`, `τ = atan2(t sinθ, k + t cosθ)`: the ray from `k ẑ` along `θ` meets the unit sphere
    /// after the length `t`. Exact geometry, equal to the arc tangent of the source.
    ///
    /// Source: [WXZ06](crate#references) eq. 7.
    MidRange {
        /// Position on the axis over the radius of the sphere of light, in `−1..=1`.
        k: f64,
    },
    /// The object is a sphere: `sin τ = k sinθ` in front (`θ < π/2`, and `k sinθ < 1`), nothing elsewhere.
    ///
    /// The scaled function is zero where there is nothing; so scale occlusion. At `k = 1` it keeps the front half.
    Sphere {
        /// Distance of the viewer over the distance of capture, `d/r`, in `1e-100..=1e100`.
        k: f64,
    },
}

/// What scaling keeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(::serde::Serialize, ::serde::Deserialize))]
pub enum Preserve {
    /// Values: `F(θ, φ) = F_r(τ(θ), φ)`. For visibility and occlusion, and for radiance, which is constant along a ray.
    /// A constant function stays as it is.
    Value,
    /// Energy: values are multiplied by `sin τ τ′ / sinθ`, so the integral over the sphere stays as it is. For functions
    /// that count energy per element of the captured sphere.
    Energy,
}

impl Tau {
    /// The cone with the paper's angle `α = π/4`.
    pub const fn cone(k: f64) -> Self {
        Self::Cone { k, alpha: FRAC_PI_4 }
    }

    /// `τ(theta)`, or `None` where there is nothing.
    ///
    /// - `theta`: in `0..=π`
    ///
    /// Accuracy: some roundings of `θ`, enlarged by `τ′`, and of `τ`; finite and increasing for `k` from 1e-6 to 1e6, and at
    /// ±1 for the mid-range; asserted by `tests/scaling.rs`.
    pub fn angle(self, theta: f64) -> Option<f64> {
        let (s, c) = (Real::sin(theta), Real::cos(theta));
        match self {
            Self::Cone { k, alpha } => {
                let [from_s, from_c] = cone_direction(k, alpha, [s, c]);
                Some(Real::atan2(from_s, from_c))
            }
            Self::MidRange { k } => {
                let ([from_s, from_c], _) = mid_range(k, [s, c]);
                Some(Real::atan2(from_s, from_c))
            }
            Self::Sphere { k } if c > 0.0 && k * s <= 1.0 => Some(Real::atan2(k * s, sphere_cosine(k, [s, c]))),
            Self::Sphere { .. } => None,
        }
    }

    /// Returns the same function if it has a meaning.
    ///
    /// # Errors
    /// [`Error::Scaling`] if `k` or `alpha` is outside the range stated at its variant.
    pub fn validate(self) -> Result<Self, Error> {
        match self {
            Self::Cone { k, .. } | Self::Sphere { k } if !(1.0 / MAX_FACTOR..=MAX_FACTOR).contains(&k) => {
                Err(Error::Scaling { what: "k", given: k, accepted: "in 1e-100..=1e100" })
            }
            Self::Cone { alpha, .. } if !(MIN_ALPHA..=PI - MIN_ALPHA).contains(&alpha) => {
                Err(Error::Scaling { what: "alpha", given: alpha, accepted: "in 1e-4..=π − 1e-4" })
            }
            Self::MidRange { k } if !(-1.0..=1.0).contains(&k) => {
                Err(Error::Scaling { what: "k of the mid-range scaling", given: k, accepted: "in -1..=1" })
            }
            _ => Ok(self),
        }
    }
}

/// Beyond, squares of such factors leave the range of numbers.
const MAX_FACTOR: f64 = 1e100;

/// The time to integrate over a cone grows as one over the angle: milliseconds at this one, and less by far at usual ones.
const MIN_ALPHA: f64 = 1e-4;

/// `(k sinθ, cosθ + (1−k) cot α sinθ)` times `sin α`, not normalised.
fn cone_direction(k: f64, alpha: f64, [s, c]: [f64; 2]) -> [f64; 2] {
    let (sin_a, cos_a) = (Real::sin(alpha), Real::cos(alpha));
    [k * s * sin_a, c * sin_a + (1.0 - k) * cos_a * s]
}

/// The point of the unit sphere that is seen, as its sine and cosine; and `τ′`.
pub(super) fn mid_range(k: f64, [s, c]: [f64; 2]) -> ([f64; 2], f64) {
    // √(1 − k² sin²θ) and 1 − k², without cancellation near |k| = 1
    let power = (1.0 - k) * (1.0 + k);
    let root = Real::sqrt(power + k * k * c * c);
    let t = match k * c {
        // (√ − kc)(√ + kc) = 1 − k²
        ahead if ahead > 0.0 => power / (root + ahead),
        ahead => root - ahead,
    };
    // 0/0 only in the tangent plane at |k| = 1
    let slope = if root > 0.0 { t / root } else { 1.0 };
    ([t * s, k + t * c], slope)
}

/// `cos τ = √(1 − k² sin²θ)`, without cancellation near k = 1.
pub(super) fn sphere_cosine(k: f64, [s, c]: [f64; 2]) -> f64 {
    let squared = if k <= 1.0 { (1.0 - k) * (1.0 + k) + k * k * c * c } else { (1.0 - k * s) * (1.0 + k * s) };
    Real::sqrt(squared.max(0.0))
}
