//! Reflectance of surfaces, as functions of view and light.

mod factor;
mod fresnel;
mod microfacet;
mod phong;
mod svd;
mod table;

pub use factor::{BrdfFactors, FactorOptions, factor_brdf};
pub use fresnel::Fresnel;
pub use microfacet::{CookTorrance, Ggx};
pub use phong::Phong;
pub use table::TabulatedBrdf;

use std::f64::consts::{FRAC_1_PI, TAU};

use crate::hemisphere::square_to_hemisphere;

/// A reflectance `b(view, light)` in 1/sr, without the cosine at the light.
///
/// Both directions are unit vectors away from the surface, in its frame: z the normal, x the tangent. Below the horizon on
/// either side the value is 0.
///
/// A closure `|view, light| …` is one too.
pub trait Brdf {
    /// The reflectance. Finite and not negative; `view` and `light` may be on the horizon.
    fn eval(&self, view: [f64; 3], light: [f64; 3]) -> f64;

    /// A light direction for a point of the unit square, and `b · cos θ` there divided by the density of such directions.
    ///
    /// The mean of `weight · f(light)` over the square is `∫ b(view, s) f(s) s_z ds`. A sharp lobe overrides this with directions
    /// that follow it, so that few of them are enough; otherwise they are spread evenly over the hemisphere.
    fn sample(&self, view: [f64; 3], square: [f64; 2]) -> ([f64; 3], f64) {
        let light = square_to_hemisphere(square);
        (light, self.eval(view, light) * light[2] * TAU)
    }
}

impl<F: Fn([f64; 3], [f64; 3]) -> f64> Brdf for F {
    fn eval(&self, view: [f64; 3], light: [f64; 3]) -> f64 {
        self(view, light)
    }
}

/// The diffuse reflectance `1/π`: albedo 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Lambert;

impl Brdf for Lambert {
    fn eval(&self, view: [f64; 3], light: [f64; 3]) -> f64 {
        if view[2] >= 0.0 && light[2] >= 0.0 { FRAC_1_PI } else { 0.0 }
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `direction` mirrored at `axis`, both unit vectors.
fn mirrored(direction: [f64; 3], axis: [f64; 3]) -> [f64; 3] {
    let twice = 2.0 * dot(direction, axis);
    std::array::from_fn(|k| twice * axis[k] - direction[k])
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::hemisphere::texel_centres;

    /// What is reflected of a white sky, by plain quadrature over `size²` even directions.
    fn albedo(brdf: &dyn Brdf, view: [f64; 3], size: usize) -> f64 {
        let terms = texel_centres(size).map(square_to_hemisphere).map(|light| brdf.eval(view, light) * light[2]);
        terms.sum::<f64>() * TAU / (size * size) as f64
    }

    /// The same by the brdf's own directions, and the mean of the light's x.
    fn sampled(brdf: &dyn Brdf, view: [f64; 3], size: usize) -> [f64; 2] {
        let terms = texel_centres(size).map(|square| brdf.sample(view, square));
        let sums = terms.fold([0.0; 2], |[a, b], (light, weight)| [a + weight, b + weight * light[0]]);
        sums.map(|sum| sum / (size * size) as f64)
    }

    fn models() -> Vec<(&'static str, Box<dyn Brdf>)> {
        let mut models: Vec<(&'static str, Box<dyn Brdf>)> = vec![("lambert", Box::new(Lambert))];
        for roughness in [0.0, 0.05, 0.3, 1.0] {
            for fresnel in [Fresnel::One, Fresnel::Schlick { normal: 0.04 }, Fresnel::Dielectric { index: 1.5 }] {
                models.push(("cook-torrance", Box::new(CookTorrance::new(roughness, fresnel).unwrap())));
                models.push(("ggx", Box::new(Ggx::new(roughness, fresnel).unwrap())));
            }
        }
        for exponent in [0.0, 1.0, 20.0, 1e4] {
            models.push(("phong", Box::new(Phong::new(exponent).unwrap())));
        }
        models.push(("table", Box::new(TabulatedBrdf::tabulate(&Ggx::new(0.4, Fresnel::One).unwrap(), [6, 12]))));
        models
    }

    proptest! {
        #[test]
        fn values_are_reciprocal_finite_and_not_negative(a in 0.0..=1.0, b in 0.0..=1.0, c in 0.0..=1.0, d in 0.0..=1.0) {
            let (view, light) = (square_to_hemisphere([a, b]), square_to_hemisphere([c, d]));
            for (name, model) in models() {
                let (there, back) = (model.eval(view, light), model.eval(light, view));
                prop_assert!(there.is_finite() && there >= 0.0, "{name} {there}");
                // A table has no need to be reciprocal.
                prop_assert!(name == "table" || (there - back).abs() <= 1e-9 * there, "{name} {there} {back}");
                let (direction, weight) = model.sample(view, [c, d]);
                prop_assert!(weight.is_finite() && weight >= 0.0, "{name} {weight}");
                prop_assert!((dot(direction, direction) - 1.0).abs() < 1e-12);
            }
        }

        /// A white sky never reflects brighter than it is. Quadrature of 64² points is good to 2e-3 for the sharpest of these.
        #[test]
        fn energy_is_not_made(a in 0.0..=1.0, b in 0.0..=1.0) {
            let view = square_to_hemisphere([a, b]);
            for (name, model) in models().iter().filter(|(name, _)| *name != "table") {
                let [albedo, _] = sampled(&**model, view, 64);
                prop_assert!(albedo <= 1.002, "{name} {albedo}");
            }
        }
    }

    #[test]
    fn own_directions_give_the_plain_integral() {
        for view in [[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [-0.48, 0.64, 0.6]] {
            for (name, model) in models() {
                // The plain one resolves lobes down to about 0.3.
                let plain = albedo(&*model, view, 400);
                let [own, _] = sampled(&*model, view, 200);
                let sharp = model.eval(view, mirrored(view, [0.0, 0.0, 1.0])) > 20.0;
                assert!(sharp || (plain - own).abs() < 2e-3, "{name} {plain} {own}");
            }
        }
    }

    #[test]
    fn a_smooth_surface_is_a_mirror() {
        let view = [0.6, 0.0, 0.8];
        for model in
            [&CookTorrance::new(0.0, Fresnel::One).unwrap() as &dyn Brdf, &Ggx::new(0.0, Fresnel::One).unwrap()]
        {
            let [albedo, x] = sampled(model, view, 32);
            assert!((albedo - 1.0).abs() < 1e-3 && (x + 0.6).abs() < 1e-3, "{albedo} {x}");
        }
    }

    #[test]
    fn the_horizon_and_below_are_harmless() {
        let directions =
            [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.8, 0.0, -0.6]];
        for (name, model) in models() {
            for view in directions {
                for light in directions {
                    let value = model.eval(view, light);
                    assert!(value.is_finite() && value >= 0.0, "{name} {view:?} {light:?} {value}");
                    assert!(value == 0.0 || (view[2] >= 0.0 && light[2] >= 0.0), "{name} {view:?} {light:?}");
                }
                let (light, weight) = model.sample(view, [0.3, 0.6]);
                assert!(light.iter().all(|x| x.is_finite()) && weight.is_finite(), "{name} {view:?}");
            }
        }
    }

    #[test]
    fn a_closure_is_a_brdf() {
        let half = |_: [f64; 3], _: [f64; 3]| 0.5 * FRAC_1_PI;
        assert!((albedo(&half, [0.0, 0.0, 1.0], 100) - 0.5).abs() < 1e-3);
    }

    #[test]
    fn parameters_out_of_range_are_named() {
        let refused = |result: Result<_, crate::Error>| {
            let message = result.map(|_: Box<dyn Brdf>| ()).unwrap_err().to_string();
            assert!(
                message.contains("roughness")
                    || message.contains("index")
                    || message.contains("reflectance")
                    || message.contains("exponent"),
                "{message}"
            );
        };
        for roughness in [-0.1, 1.1, f64::NAN, f64::INFINITY] {
            refused(CookTorrance::new(roughness, Fresnel::One).map(|b| Box::new(b) as _));
            refused(Ggx::new(roughness, Fresnel::One).map(|b| Box::new(b) as _));
        }
        refused(Ggx::new(0.5, Fresnel::Dielectric { index: 0.9 }).map(|b| Box::new(b) as _));
        refused(Ggx::new(0.5, Fresnel::Schlick { normal: 1.5 }).map(|b| Box::new(b) as _));
        refused(Phong::new(-1.0).map(|b| Box::new(b) as _));
        refused(Phong::new(f64::NAN).map(|b| Box::new(b) as _));
    }
}
