//! The factoring of a reflectance into functions of the view and vectors for the light.

use nalgebra::{DMatrix, DVector, SVD};
use sh_core::{Basis, Order};

use super::Brdf;
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
    let matrix = sampled_matrix(brdf, order, options)?;
    let (singular_values, terms) = singular_terms(&matrix).ok_or(Error::Reflectance { view: [0.0, 0.0, 1.0] })?;
    let size = options.map_size;
    let mut factors = BrdfFactors {
        order,
        row_count,
        map_size: size,
        view_map: vec![0.0; size * size * row_count],
        light: vec![0.0; row_count * order.coeff_count()],
        singular_values: singular_values.iter().map(|s| s / size as f64).collect(),
    };
    for (row, (left, right)) in terms.into_iter().take(row_count).enumerate() {
        let sign = sign_of_mean(left.as_slice());
        for (u, value) in factors.view_map[row..].iter_mut().step_by(row_count).zip(left.iter()) {
            *u = (sign * size as f64 * value) as f32;
        }
        let light = &mut factors.light[row * order.coeff_count()..][..order.coeff_count()];
        light.iter_mut().zip(right.iter()).for_each(|(light, value)| *light = sign * value / size as f64);
    }
    Ok(factors)
}

/// `B` of eq. 14.
fn sampled_matrix(brdf: &(impl Brdf + ?Sized), order: Order, options: &FactorOptions) -> Result<DMatrix<f64>, Error> {
    let views = options.map_size * options.map_size;
    let mut matrix = DMatrix::zeros(views, order.coeff_count());
    let mut integrator = Integrator::new(order, options.light_samples);
    for (i, view) in texel_centres(options.map_size).map(square_to_hemisphere).enumerate() {
        let row = integrator.integrate(brdf, view);
        if row.iter().any(|b| !b.is_finite()) {
            return Err(Error::Reflectance { view });
        }
        matrix.row_mut(i).iter_mut().zip(row).for_each(|(to, from)| *to = *from);
    }
    Ok(matrix)
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

/// A left singular vector, and its right one times the singular value.
type Term = (DVector<f64>, DVector<f64>);

/// Singular values, falling, with their vectors. None if the iteration does not converge.
fn singular_terms(matrix: &DMatrix<f64>) -> Option<(Vec<f64>, Vec<Term>)> {
    /// Sweeps; the method needs two or three per value.
    const MAX_ITERATIONS: usize = 10_000;
    let svd = SVD::try_new(matrix.clone(), true, true, f64::EPSILON, MAX_ITERATIONS)?;
    let (left, right) = (svd.u?, svd.v_t?);
    let mut order: Vec<usize> = (0..svd.singular_values.len()).collect();
    order.sort_by(|&a, &b| svd.singular_values[b].total_cmp(&svd.singular_values[a]));
    let value = |k: usize| svd.singular_values[k];
    let term = |&k: &usize| (left.column(k).into_owned(), right.row(k).transpose() * value(k));
    Some((order.iter().map(|&k| value(k)).collect(), order.iter().map(term).collect()))
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
