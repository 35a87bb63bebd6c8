//! The factoring of a reflectance into functions of the view and vectors for the light.

use sh_core::{Basis, Order};

use super::Brdf;
use super::svd::singular_terms;
use crate::Error;
use crate::hemisphere::{bilinear, hemisphere_to_square, square_to_hemisphere, texel_centres};

/// How finely a reflectance is sampled.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FactorOptions {
    /// Texels along a side of the view map, 1 to [`FactorOptions::MAX_SIZE`]. The paper's is 32.
    pub map_size: usize,
    /// Light directions along a side of the square that is mapped to them, 1 to [`FactorOptions::MAX_SIZE`]; for each view their
    /// number is the square of it.
    pub light_samples: usize,
}

impl FactorOptions {
    /// The largest size of a map.
    pub const MAX_SIZE: usize = 1024;

    /// Checks every setting.
    ///
    /// # Errors
    /// [`Error::Parameter`] names the first setting out of its range.
    pub fn validate(&self) -> Result<(), Error> {
        for (what, given) in [("size of the view map", self.map_size), ("number of light samples", self.light_samples)]
        {
            if !(1..=Self::MAX_SIZE).contains(&given) {
                return Err(Error::Parameter { what, given: given as f64, accepted: "1..=1024" });
            }
        }
        Ok(())
    }
}

impl Default for FactorOptions {
    /// 32×32 views, 64×64 lights.
    fn default() -> Self {
        Self { map_size: 32, light_samples: 64 }
    }
}

/// A reflectance as a sum of `R` products: `∫ b(v, s) f(s) s_z ds ≈ Σ_r u_r(v) (light_r · f)`.
#[derive(Debug, Clone, PartialEq)]
pub struct BrdfFactors {
    /// Order of the light `n`.
    pub order: Order,
    /// Number of products `R`, the paper's `n_b`.
    pub row_count: usize,
    /// Texels along a side of the view map.
    pub map_size: usize,
    /// `u_r(v)` `[map_size, map_size, R]`, at the texel centres of the map of [`square_to_hemisphere`]; the mean square of each
    /// `u_r` over the map is 1. It is `Ũ` of eq. 15 times `map_size`.
    pub view_map: Vec<f32>,
    /// `[R, n²]`: `Σ̃ Ṽ` of eq. 15 over `map_size`. The cosine at the light is included.
    pub light: Vec<f64>,
    /// All singular values of `B`, falling, over `map_size`: the mean square over the views of what row `r` adds is
    /// `singular_values[r]²`.
    pub singular_values: Vec<f64>,
}

impl BrdfFactors {
    /// The relative L2 error of the sum with only the first `row_count` products, over all views of the map and all light of the
    /// order; 0 for a reflectance that is zero.
    ///
    /// It falls with `row_count`, to 0 at the number of singular values. An isotropic reflectance has pairs of equal singular
    /// values; a number of rows that cuts a pair prefers an arbitrary direction, so take both or none.
    #[must_use]
    pub fn error(&self, row_count: usize) -> f64 {
        let energy = |values: &[f64]| values.iter().map(|s| s * s).sum::<f64>();
        let total = energy(&self.singular_values);
        let left = energy(&self.singular_values[row_count.min(self.singular_values.len())..]);
        if total > 0.0 { (left / total).sqrt() } else { 0.0 }
    }

    /// Looks up `u_r(v)` bilinearly, clamped at the border of the map.
    ///
    /// - `view`: unit length, in the frame of the surface; below the horizon counts as on it
    /// - `out`: `[R]`, overwritten
    ///
    /// # Panics
    /// If `out` is not `[R]`.
    pub fn view(&self, view: [f64; 3], out: &mut [f64]) {
        assert!(out.len() == self.row_count, "out has {} elements, it needs {}", out.len(), self.row_count);
        out.fill(0.0);
        for (texel, weight) in bilinear(self.map_size, hemisphere_to_square(view)) {
            let u = &self.view_map[texel * self.row_count..][..self.row_count];
            out.iter_mut().zip(u).for_each(|(out, &u)| *out += weight * f64::from(u));
        }
    }

    /// The rows of transfer to which lobes are fitted, `M′ = Σ̃ Ṽ T`.
    ///
    /// - `transfer_matrix`: `T` `[n², n²]` row-major, from light to transferred incident radiance, in the frame of the surface
    /// - `out`: `[R, n²]`, overwritten
    ///
    /// # Panics
    /// If a slice length does not match.
    ///
    /// Source: [SLS05](sh_core#references) eq. 15.
    pub fn transfer_rows(&self, transfer_matrix: &[f64], out: &mut [f64]) {
        let count = self.order.coeff_count();
        assert!(transfer_matrix.len() == count * count, "the transfer matrix is not [n², n²]");
        assert!(out.len() == self.row_count * count, "out is not [R, n²]");
        out.fill(0.0);
        for (out, light) in out.chunks_exact_mut(count).zip(self.light.chunks_exact(count)) {
            for (factor, row) in light.iter().zip(transfer_matrix.chunks_exact(count)) {
                out.iter_mut().zip(row).for_each(|(out, t)| *out += factor * t);
            }
        }
    }
}

/// Factors a reflectance into `row_count` functions of the view and as many vectors for the light.
///
/// ```text
/// B_ij = ∫_H b(v_i, s) y_j(s) s_z ds ≈ (Ũ Σ̃ Ṽ)_ij
/// ```
///
/// over the views `v_i` at the texel centres of the map of [`square_to_hemisphere`], each of which stands for the same solid
/// angle. No other sum of `row_count` products is nearer to `B`; its error for any number of rows is [`BrdfFactors::error`].
/// The sign of each product is chosen so that the mean of `u_r` over the map is positive, or, where that is zero, its value of
/// largest size.
///
/// More rows than `B` has are zero.
///
/// Cook-Torrance of roughness 0.3 without Fresnel, n = 4, three rows: error 0.65 over all views and 0.49 within 60° of the normal,
/// and lobes fitted to the rows, N = 3, add 0.004 (`repro -- ldprt/fig4`). The paper's figure 4 says
/// 0.33 and 0.0074; it does not say over which views and lights, nor which Fresnel term, so the first is not reproduced. Most of
/// the 16 singular values of a lobe of that width matter: six rows leave 0.34.
///
/// # Errors
/// [`Error::Parameter`] for `row_count` 0 or options out of their range; [`Error::Reflectance`] if the reflectance is not
/// finite somewhere.
///
/// Source: [SLS05](sh_core#references) eq. 14, 15 and section 3.2.
pub fn factor_brdf(
    brdf: &(impl Brdf + ?Sized),
    order: Order,
    row_count: usize,
    options: &FactorOptions,
) -> Result<BrdfFactors, Error> {
    options.validate()?;
    if row_count == 0 {
        return Err(Error::Parameter { what: "number of rows", given: 0.0, accepted: "1 or more" });
    }
    let terms = singular_terms(sampled_columns(brdf, order, options)?);
    let size = options.map_size;
    let mut factors = BrdfFactors {
        order,
        row_count,
        map_size: size,
        view_map: vec![0.0; size * size * row_count],
        light: vec![0.0; row_count * order.coeff_count()],
        singular_values: terms.iter().map(|term| term.value / size as f64).collect(),
    };
    for (row, term) in terms.iter().take(row_count).enumerate() {
        let sign = sign_of_mean(&term.left);
        for (u, value) in factors.view_map[row..].iter_mut().step_by(row_count).zip(&term.left) {
            *u = (sign * size as f64 * value) as f32;
        }
        let light = &mut factors.light[row * order.coeff_count()..][..order.coeff_count()];
        light.iter_mut().zip(&term.right).for_each(|(to, v)| *to = sign * term.value / size as f64 * v);
    }
    Ok(factors)
}

/// The columns of `B` of eq. 14.
fn sampled_columns(brdf: &(impl Brdf + ?Sized), order: Order, options: &FactorOptions) -> Result<Vec<Vec<f64>>, Error> {
    let views = options.map_size * options.map_size;
    let mut columns = vec![Vec::with_capacity(views); order.coeff_count()];
    let mut integrator = Integrator::new(order, options.light_samples);
    for view in texel_centres(options.map_size).map(square_to_hemisphere) {
        let row = integrator.integrate(brdf, view);
        if row.iter().any(|b| !b.is_finite()) {
            return Err(Error::Reflectance { view });
        }
        columns.iter_mut().zip(row).for_each(|(column, b)| column.push(*b));
    }
    Ok(columns)
}

/// One row of `B`: `∫_H b(v, s) y_j(s) s_z ds`.
#[derive(Debug)]
struct Integrator {
    basis: Basis<f64>,
    samples: usize,
    values: Vec<f64>,
    sums: Vec<f64>,
}

impl Integrator {
    fn new(order: Order, samples: usize) -> Self {
        let zeros = vec![0.0; order.coeff_count()];
        Self { basis: Basis::new(order), samples, values: zeros.clone(), sums: zeros }
    }

    fn integrate(&mut self, brdf: &(impl Brdf + ?Sized), view: [f64; 3]) -> &[f64] {
        self.sums.fill(0.0);
        for square in texel_centres(self.samples) {
            let (light, weight) = brdf.sample(view, square);
            if weight != 0.0 {
                self.basis.eval(light, &mut self.values);
                self.sums.iter_mut().zip(&self.values).for_each(|(sum, y)| *sum += weight * y);
            }
        }
        let count = (self.samples * self.samples) as f64;
        self.sums.iter_mut().for_each(|sum| *sum /= count);
        &self.sums
    }
}

fn sign_of_mean(values: &[f64]) -> f64 {
    /// A mean below this part of the root mean square is that of rounding: the function is odd about the normal.
    const NO_MEAN: f64 = 1e-9;
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let size = (values.iter().map(|u| u * u).sum::<f64>() / values.len() as f64).sqrt();
    let largest = values.iter().fold(0.0, |a: f64, &b| if b.abs() > a.abs() { b } else { a });
    let deciding = if mean.abs() > NO_MEAN * size { mean } else { largest };
    1.0_f64.copysign(deciding)
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    use std::f64::consts::FRAC_1_PI;

    use proptest::prelude::*;
    use sh_core::clamped_cosine;

    use super::*;
    use crate::{CookTorrance, Fresnel, Ggx, Lambert, Phong, TabulatedBrdf};

    fn order(n: usize) -> Order {
        Order::new(n).unwrap()
    }

    const SMALL: FactorOptions = FactorOptions { map_size: 8, light_samples: 32 };

    fn shiny(roughness: f64) -> CookTorrance {
        CookTorrance::new(roughness, Fresnel::Schlick { normal: 0.04 }).unwrap()
    }

    /// The sum of the products against the integral, over views; relative.
    fn view_error(brdf: &dyn Brdf, factors: &BrdfFactors, views: &[[f64; 3]]) -> f64 {
        let mut integrator = Integrator::new(factors.order, 64);
        let mut u = vec![0.0; factors.row_count];
        let count = factors.order.coeff_count();
        let (mut error, mut length) = (0.0, 0.0);
        for &view in views {
            factors.view(view, &mut u);
            for (j, b) in integrator.integrate(brdf, view).iter().enumerate() {
                let sum: f64 = u.iter().enumerate().map(|(r, u)| u * factors.light[r * count + j]).sum();
                error += (sum - b).powi(2);
                length += b * b;
            }
        }
        (error / length).sqrt()
    }

    #[test]
    fn a_diffuse_surface_has_one_factor() {
        let factors = factor_brdf(&Lambert, order(4), 2, &FactorOptions { light_samples: 200, ..SMALL }).unwrap();
        assert!(factors.error(1) < 1e-12 && factors.error(0) == 1.0);
        let mut zonal = [0.0; 4];
        clamped_cosine(&mut zonal);
        for i in 0..16_usize {
            let l = i.isqrt();
            let expected = if i == l * (l + 1) { zonal[l] * FRAC_1_PI } else { 0.0 };
            // The quadrature of 200².
            assert!((factors.light[i] - expected).abs() < 1e-4, "{i} {} {expected}", factors.light[i]);
            assert!(factors.light[16 + i].abs() < 1e-12);
        }
        assert!(factors.view_map.chunks_exact(2).all(|u| (u[0] - 1.0).abs() < 1e-6));
    }

    #[test]
    fn all_rows_reproduce_the_matrix_and_the_error_is_that_of_fewer() {
        let views: Vec<[f64; 3]> = texel_centres(8).map(square_to_hemisphere).collect();
        let options = FactorOptions { map_size: 8, light_samples: 64 };
        for row_count in [1, 3, 16] {
            let factors = factor_brdf(&shiny(0.3), order(4), row_count, &options).unwrap();
            let found = view_error(&shiny(0.3), &factors, &views);
            assert!(
                (found - factors.error(row_count)).abs() < 1e-6,
                "{row_count} {found} {}",
                factors.error(row_count)
            );
        }
    }

    #[test]
    fn between_texels_a_finer_map_is_nearer() {
        let views: Vec<[f64; 3]> = texel_centres(11).map(square_to_hemisphere).collect();
        let error = |map_size| {
            let options = FactorOptions { map_size, light_samples: 64 };
            view_error(&shiny(0.3), &factor_brdf(&shiny(0.3), order(4), 16, &options).unwrap(), &views)
        };
        let errors = [8, 16, 32].map(error);
        assert!(errors[1] < 0.6 * errors[0] && errors[2] < 0.6 * errors[1], "{errors:?}");
    }

    proptest! {
        #[test]
        fn errors_fall_and_rows_are_orthogonal(roughness in 0.0_f64..=1.0, n in 1_usize..=5) {
            let brdf = Ggx::new(roughness, Fresnel::One).unwrap();
            let factors = factor_brdf(&brdf, order(n), n * n, &SMALL).unwrap();
            for r in 0..n * n {
                prop_assert!(factors.error(r + 1) <= factors.error(r) + 1e-15);
                for q in 0..r {
                    let dot: f64 = (0..n * n).map(|j| factors.light[r * n * n + j] * factors.light[q * n * n + j]).sum();
                    prop_assert!(dot.abs() < 1e-9, "{r} {q} {dot}");
                }
            }
            prop_assert!(factors.error(n * n) < 1e-9);
            prop_assert!(factors.view_map.iter().all(|u| u.is_finite()));
        }
    }

    #[test]
    fn every_model_and_size_is_finite() {
        let table = TabulatedBrdf::tabulate(&shiny(0.5), [4, 8]);
        let phong = Phong::new(30.0).unwrap();
        let mirror = Ggx::new(0.0, Fresnel::Dielectric { index: 1.5 }).unwrap();
        let (black, rough) = (|_: [f64; 3], _: [f64; 3]| 0.0, shiny(1.0));
        let models: [&dyn Brdf; 5] = [&table, &phong, &mirror, &black, &rough];
        for (brdf, (n, map_size)) in models.iter().flat_map(|brdf| [(1, 1), (2, 4), (10, 6)].map(|size| (brdf, size))) {
            let options = FactorOptions { map_size, light_samples: 8 };
            let factors = factor_brdf(*brdf, order(n), 3, &options).unwrap();
            assert!(factors.view_map.iter().all(|u| u.is_finite()) && factors.light.iter().all(|b| b.is_finite()));
            let mut u = [0.0; 3];
            for view in [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.6, -0.8], [0.0, 0.0, -1.0]] {
                factors.view(view, &mut u);
                assert!(u.iter().all(|u| u.is_finite()));
            }
        }
    }

    /// The BRDF of the paper's figure 4, over all views and lights; recorded, since the paper's 0.33 for three rows is of a measure
    /// that it does not tell.
    #[test]
    fn figure_4() {
        let brdf = CookTorrance::new(0.3, Fresnel::One).unwrap();
        let factors = factor_brdf(&brdf, order(4), 3, &FactorOptions::default()).unwrap();
        for (rows, expected) in [(1, 0.873), (3, 0.648), (6, 0.342), (12, 0.024)] {
            assert!((factors.error(rows) - expected).abs() < 2e-3, "{rows} {}", factors.error(rows));
        }
    }

    #[test]
    fn signs_are_chosen() {
        let factors = factor_brdf(&shiny(0.3), order(4), 4, &SMALL).unwrap();
        let mean: f32 = factors.view_map.iter().step_by(4).sum();
        assert!(mean > 0.0);
        assert_eq!(factors, factor_brdf(&shiny(0.3), order(4), 4, &SMALL).unwrap());
        assert_eq!(
            [sign_of_mean(&[1.0, -3.0]), sign_of_mean(&[1.0, -1.0, 2.0, -2.0]), sign_of_mean(&[0.0])],
            [-1.0, 1.0, 1.0]
        );
    }

    #[test]
    fn rows_of_transfer_are_the_light_through_the_matrix() {
        let factors = factor_brdf(&shiny(0.4), order(2), 2, &SMALL).unwrap();
        let matrix: Vec<f64> = (0..16).map(|i| f64::from(i) - 3.0).collect();
        let mut rows = [0.0; 8];
        factors.transfer_rows(&matrix, &mut rows);
        for r in 0..2 {
            for j in 0..4 {
                let expected: f64 = (0..4).map(|i| factors.light[r * 4 + i] * matrix[i * 4 + j]).sum();
                assert!((rows[r * 4 + j] - expected).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn what_cannot_be_factored_is_named() {
        let nan = |view: [f64; 3], _: [f64; 3]| if view[0] > 0.9 { f64::NAN } else { 1.0 };
        let error = factor_brdf(&nan, order(2), 1, &SMALL).unwrap_err();
        assert!(error.to_string().starts_with("the reflectance seen from [0.9"), "{error}");
        assert!(factor_brdf(&Lambert, order(2), 0, &SMALL).unwrap_err().to_string().starts_with("number of rows is 0"));
        for map_size in [0, 1025] {
            assert!(factor_brdf(&Lambert, order(2), 1, &FactorOptions { map_size, ..SMALL }).is_err());
        }
    }
}
