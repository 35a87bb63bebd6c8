//! Rough surfaces made of smooth facets.

use std::f64::consts::{PI, TAU};

use super::{Brdf, Fresnel, dot, mirrored};
use crate::Error;

/// The least roughness: a smaller one counts as this. Lobes are then a thousand times narrower than a band of order 10, and all
/// values are finite.
const MIN_ROUGHNESS: f64 = 1e-4;

/// The least cosine that is divided by. It keeps values at the horizon finite; a map of views never comes near it.
const MIN_COSINE: f64 = 1e-9;

/// The model of Cook and Torrance, with Beckmann's distribution of facets and masking by V-shaped grooves.
///
/// ```text
/// b = F D G / (4 n·v n·s)      D = exp(−tan²δ / m²) / (π m² cos⁴δ)      G = min(1, 2 n·h n·v / v·h, 2 n·h n·s / v·h)
/// ```
///
/// with the half vector `h`, its angle `δ` to the normal, and the roughness `m`, the root mean square slope times √2. The
/// paper's "glossiness = 0.3" is `m`.
///
/// Source: Cook and Torrance, *A Reflectance Model for Computer Graphics*, ACM Transactions on Graphics 1(1), 1982. Where it has
/// `π` in the place of 4 (and a `D` without `π`), more light would come back than arrives; 4 conserves energy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CookTorrance {
    roughness: f64,
    fresnel: Fresnel,
}

/// The GGX model: facets after Trowbridge and Reitz, masking after Smith, correlated in height.
///
/// ```text
/// b = F D G / (4 n·v n·s)      D = α² / (π (cos²δ (α² − 1) + 1)²)
/// G = 2 n·v n·s / (n·s √(α² + (1 − α²)(n·v)²) + n·v √(α² + (1 − α²)(n·s)²))
/// ```
///
/// `roughness` is `α` itself, not its square root as in some tools for artists.
///
/// Source: [WMLT07](sh_core#references) eq. 20, 33; Heitz, *Understanding the Masking-Shadowing Function in Microfacet-Based
/// BRDFs*, Journal of Computer Graphics Techniques 3(2), 2014, eq. 99.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ggx {
    alpha: f64,
    fresnel: Fresnel,
}

/// What a microfacet model adds to the half vector.
trait Facets {
    fn fresnel(&self) -> Fresnel;

    /// `D(h)`, per steradian of half vectors: `∫ D h_z dh = 1`.
    fn distribution(&self, half_z: f64) -> f64;

    /// `tan² δ` below which a share `u` of the facets is.
    fn tangent_squared(&self, u: f64) -> f64;

    /// `G / (4 n·v n·s)`.
    fn visibility(&self, view_z: f64, light_z: f64, half_z: f64, view_half: f64) -> f64;
}

impl CookTorrance {
    /// A surface of roughness `m` in `0..=1`; below 1e-4 it is a mirror of 1e-4.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a roughness or a number of `fresnel` out of its range.
    pub fn new(roughness: f64, fresnel: Fresnel) -> Result<Self, Error> {
        Ok(Self { roughness: checked(roughness, fresnel)?, fresnel })
    }
}

impl Ggx {
    /// A surface of roughness `α` in `0..=1`; below 1e-4 it is a mirror of 1e-4.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a roughness or a number of `fresnel` out of its range.
    pub fn new(roughness: f64, fresnel: Fresnel) -> Result<Self, Error> {
        Ok(Self { alpha: checked(roughness, fresnel)?, fresnel })
    }
}

fn checked(roughness: f64, fresnel: Fresnel) -> Result<f64, Error> {
    fresnel.validate()?;
    if !(0.0..=1.0).contains(&roughness) {
        return Err(Error::Parameter { what: "roughness", given: roughness, accepted: "0..=1" });
    }
    Ok(roughness.max(MIN_ROUGHNESS))
}

impl Facets for CookTorrance {
    fn fresnel(&self) -> Fresnel {
        self.fresnel
    }

    fn distribution(&self, half_z: f64) -> f64 {
        let (m2, c2) = (self.roughness * self.roughness, half_z * half_z);
        let exponent = (1.0 - c2) / (c2 * m2);
        // Far down the slope the exponential is 0, and the cosine may be too small to divide by.
        if exponent < 700.0 { (-exponent).exp() / (PI * m2 * c2 * c2) } else { 0.0 }
    }

    fn tangent_squared(&self, u: f64) -> f64 {
        -self.roughness * self.roughness * (-u).ln_1p()
    }

    fn visibility(&self, view_z: f64, light_z: f64, half_z: f64, view_half: f64) -> f64 {
        let open = 0.25 / (view_z * light_z);
        let groove = 0.5 * half_z / view_half;
        open.min(groove / light_z).min(groove / view_z)
    }
}

impl Facets for Ggx {
    fn fresnel(&self) -> Fresnel {
        self.fresnel
    }

    fn distribution(&self, half_z: f64) -> f64 {
        let a2 = self.alpha * self.alpha;
        // 1 − c² is 0 or more, so nothing cancels for a small α.
        let denominator = a2 * half_z * half_z + (1.0 - half_z * half_z).max(0.0);
        a2 / (PI * denominator * denominator)
    }

    fn tangent_squared(&self, u: f64) -> f64 {
        self.alpha * self.alpha * u / (1.0 - u).max(f64::EPSILON)
    }

    fn visibility(&self, view_z: f64, light_z: f64, _half_z: f64, _view_half: f64) -> f64 {
        let a2 = self.alpha * self.alpha;
        let masked = |z: f64| (a2 + (1.0 - a2) * z * z).sqrt();
        0.5 / (light_z * masked(view_z) + view_z * masked(light_z))
    }
}

macro_rules! brdf_of_facets {
    ($($model:ty),*) => {$(
        impl Brdf for $model {
            fn eval(&self, view: [f64; 3], light: [f64; 3]) -> f64 {
                eval(self, view, light)
            }

            fn sample(&self, view: [f64; 3], square: [f64; 2]) -> ([f64; 3], f64) {
                sample(self, view, square)
            }
        }
    )*};
}

brdf_of_facets!(CookTorrance, Ggx);

/// `F D G / (4 n·v n·s)`.
fn eval(facets: &impl Facets, view: [f64; 3], light: [f64; 3]) -> f64 {
    let Some(half) = half_vector(view, light) else { return 0.0 };
    let view_half = dot(view, half).clamp(0.0, 1.0);
    facets.distribution(half[2]) * facets.fresnel().eval(view_half) * guarded_visibility(facets, view, light, half)
}

fn guarded_visibility(facets: &impl Facets, view: [f64; 3], light: [f64; 3], half: [f64; 3]) -> f64 {
    let [view_z, light_z, view_half] = [view[2], light[2], dot(view, half)].map(|c| c.max(MIN_COSINE));
    facets.visibility(view_z, light_z, half[2], view_half)
}

/// None below the horizon and for directions that cancel.
fn half_vector(view: [f64; 3], light: [f64; 3]) -> Option<[f64; 3]> {
    let sum: [f64; 3] = std::array::from_fn(|k| view[k] + light[k]);
    let length = dot(sum, sum).sqrt();
    (view[2] >= 0.0 && light[2] >= 0.0 && length > MIN_COSINE).then(|| sum.map(|x| x / length))
}

/// The light mirrored at a facet that is drawn with the density `D h_z`: that of the light is `D h_z / (4 v·h)`.
fn sample(facets: &impl Facets, view: [f64; 3], square: [f64; 2]) -> ([f64; 3], f64) {
    let half = facet(facets.tangent_squared(square[0]), TAU * square[1]);
    let light = mirrored(view, half);
    let view_half = dot(view, half);
    if view[2] < 0.0 || light[2] < 0.0 || view_half <= 0.0 {
        return (light, 0.0);
    }
    let reflected = facets.fresnel().eval(view_half.min(1.0)) * guarded_visibility(facets, view, light, half);
    (light, 4.0 * reflected * light[2] * view_half / half[2])
}

fn facet(tangent_squared: f64, phi: f64) -> [f64; 3] {
    let z = 1.0 / (1.0 + tangent_squared).sqrt();
    let radius = z * tangent_squared.sqrt();
    [radius * phi.cos(), radius * phi.sin(), z]
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;
    use crate::hemisphere::{square_to_hemisphere, texel_centres};

    /// Every facet is somewhere: `∫ D h_z dh = 1`. The quadrature resolves lobes of 0.1.
    #[test]
    fn distributions_are_normalised() {
        for roughness in [0.1, 0.3, 1.0] {
            let (ct, ggx) =
                (CookTorrance::new(roughness, Fresnel::One).unwrap(), Ggx::new(roughness, Fresnel::One).unwrap());
            for distribution in [&(|z| ct.distribution(z)) as &dyn Fn(f64) -> f64, &|z| ggx.distribution(z)] {
                let size = 500;
                let sum: f64 =
                    texel_centres(size).map(|s| square_to_hemisphere(s)[2]).map(|z| distribution(z) * z).sum();
                assert!((sum * TAU / (size * size) as f64 - 1.0).abs() < 1e-3, "{roughness} {sum}");
            }
        }
    }

    #[test]
    fn shares_of_facets_follow_the_distribution() {
        let (ct, ggx) = (CookTorrance::new(0.4, Fresnel::One).unwrap(), Ggx::new(0.4, Fresnel::One).unwrap());
        let check = |facets: &dyn Fn(f64) -> f64, distribution: &dyn Fn(f64) -> f64| {
            let limit = 1.0 / (1.0 + facets(0.6)).sqrt();
            // ∫ D z 2π dz from the limit to 1, by the midpoint rule.
            let count = 20_000;
            let z = (0..count).map(|k| limit + (1.0 - limit) * (k as f64 + 0.5) / f64::from(count));
            let share: f64 = z.map(|z| distribution(z) * z).sum::<f64>() * TAU * (1.0 - limit) / f64::from(count);
            assert!((share - 0.6).abs() < 1e-6, "{share}");
        };
        check(&|u| ct.tangent_squared(u), &|z| ct.distribution(z));
        check(&|u| ggx.tangent_squared(u), &|z| ggx.distribution(z));
    }

    #[test]
    fn along_the_normal_both_are_known() {
        let up = [0.0, 0.0, 1.0];
        for roughness in [0.2, 1.0] {
            let peak = 0.25 / (PI * roughness * roughness);
            let ct = CookTorrance::new(roughness, Fresnel::One).unwrap().eval(up, up);
            let ggx = Ggx::new(roughness, Fresnel::Schlick { normal: 0.5 }).unwrap().eval(up, up);
            assert!((ct - peak).abs() < 1e-12 * peak && (ggx - 0.5 * peak).abs() < 1e-12 * peak);
        }
    }
}
