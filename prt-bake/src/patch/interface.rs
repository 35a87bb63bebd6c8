//! Light at the smooth boundary between two media.

use glam::DVec3;

/// What becomes of a ray at a boundary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Meeting {
    Reflected(DVec3),
    Refracted(DVec3),
}

/// Chooses between reflection and refraction by the Fresnel reflectance, so that neither changes a path's weight.
///
/// - `direction`: of the ray, unit length
/// - `normal`: unit, towards the side that the ray comes from
/// - `eta`: index of refraction on the other side, relative to the ray's side
/// - `chance`: uniform in 0..1
pub(super) fn meet(direction: DVec3, normal: DVec3, eta: f64, chance: f64) -> Meeting {
    // A ray along the boundary may lie on its wrong side by a rounding.
    let cos_i = (-direction.dot(normal)).max(0.0);
    let (reflectance, cos_t) = fresnel(cos_i, eta);
    if chance < reflectance {
        Meeting::Reflected((direction + 2.0 * cos_i * normal).normalize())
    } else {
        Meeting::Refracted((direction / eta + (cos_i / eta - cos_t) * normal).normalize())
    }
}

/// Fresnel's reflectance of unpolarised light, and the cosine of the refracted ray (0 at total reflection).
///
/// - `cos_i`: cosine of the angle of incidence, 0..1
/// - `eta`: index of refraction on the other side, relative to the ray's side
pub(super) fn fresnel(cos_i: f64, eta: f64) -> (f64, f64) {
    let sin2_t = (1.0 - cos_i * cos_i) / (eta * eta);
    if sin2_t >= 1.0 {
        // An index of 1 is no boundary, even to a ray along it.
        return (if eta == 1.0 { 0.0 } else { 1.0 }, 0.0);
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    let across = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let along = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    (0.5 * (across * across + along * along), cos_t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_reflectances() {
        // Normal incidence: ((n−1)/(n+1))²; Brewster's angle, tan θ = n: half of sin²(θ_i − θ_t); grazing: 1.
        let n: f64 = 1.5;
        assert!((fresnel(1.0, n).0 - 0.04).abs() < 1e-15);
        let brewster = n.atan();
        let refracted = (brewster.sin() / n).asin();
        let (reflectance, cos_t) = fresnel(brewster.cos(), n);
        assert!((reflectance - 0.5 * (brewster - refracted).sin().powi(2)).abs() < 1e-15);
        assert!((cos_t - refracted.cos()).abs() < 1e-15);
        assert!((fresnel(0.0, n).0 - 1.0).abs() < 1e-15);
        // From inside beyond the critical angle, sin θ = 1/n.
        assert_eq!(fresnel(0.74, 1.0 / n), (1.0, 0.0));
        assert!(fresnel(0.75, 1.0 / n).0 < 1.0);
        for cos in [0.0, 1e-9, 0.3, 1.0] {
            assert!(fresnel(cos, 1.0).0 < 1e-15, "{cos}");
        }
    }

    #[test]
    fn a_boundary_reflects_alike_from_both_sides_and_bends_by_snell() {
        for cos_i in [0.05, 0.3, 0.7, 0.99] {
            for eta in [1.1, 1.5, 2.5] {
                let (reflectance, cos_t) = fresnel(cos_i, eta);
                let (back, cos_back) = fresnel(cos_t, 1.0 / eta);
                assert!((reflectance - back).abs() < 1e-12 && (cos_i - cos_back).abs() < 1e-12);
                let sin_i = f64::sqrt(1.0 - cos_i * cos_i);
                let ray = DVec3::new(sin_i, 0.0, -cos_i);
                let Meeting::Refracted(bent) = meet(ray, DVec3::Z, eta, 0.999) else { panic!("refracted") };
                assert!((bent - DVec3::new(sin_i / eta, 0.0, -cos_t)).length() < 1e-14);
                assert_eq!(
                    meet(ray, DVec3::Z, eta, 0.0),
                    Meeting::Reflected(DVec3::new(sin_i, 0.0, cos_i).normalize())
                );
            }
        }
    }
}
