//! Coefficients that fit samples at irregular directions best.

use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::PI;

use crate::order::assert_length;
use crate::{Basis, Error, Order, Real, dot};

/// A pivot below this share of its diagonal element has lost its digits: the samples do not determine the coefficient.
///
/// Each of up to n² eliminations rounds the diagonal by 1e-16 of itself; what is left then has at least two digits.
const LOST_PIVOT: f64 = 1e-12;

/// How far the squared length of a direction may be from 1. Unit vectors of `f32` are within 1e-6; this is for those of low
/// precision, and keeps out what is no direction.
const LENGTH_TOLERANCE: f64 = 2e-3;

/// The least-squares fit of expansions to samples at fixed directions, factored once for any number of fits.
///
/// The coefficients `f` minimise
///
/// ```text
/// Σ_d w_d (Σ_i f_i y_i(s_d) − v_d)² + smoothing · W/(4π) · Σ_i (l(l+1) f_i)²      W = Σ_d w_d
/// ```
///
/// The second term is the squared Laplacian: it keeps the fit from swinging where there are no samples. 0 leaves it out; 1e-6
/// to 1e-3 are usual.
///
/// Where [`Basis::project`] needs samples that are evenly spread or have the weights of a quadrature, this takes what there
/// is: `D ≥ n²` samples, or fewer with smoothing. It is exact for functions of the order, without smoothing.
///
/// Works in `f64`: the normal equations by Cholesky's method, `n⁴ D/2` operations to build, `n² D` for each fit. The error
/// grows with the square of the condition of the directions; a set that leaves no digits is refused.
///
/// ```
/// use sh_core::{LeastSquares, Order, fibonacci};
///
/// // Directions of the upper half only.
/// let directions: Vec<_> = fibonacci(2000).into_iter().filter(|s| s[2] > -0.2).collect();
/// let fit = LeastSquares::new(Order::new(3)?, &directions, None, 0.0)?;
/// let samples: Vec<f64> = directions.iter().map(|[x, _, z]| 1.0 + x * z).collect();
/// let mut coeffs = [0.0; 9];
/// fit.fit(&samples, &mut coeffs);
/// let s = [-0.6, 0.0, -0.8]; // where there was none
/// assert!((sh_core::reconstruct(Order::new(3)?, &coeffs, s) - 1.48).abs() < 1e-10);
/// # Ok::<(), sh_core::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct LeastSquares {
    basis: Basis<f64>,
    directions: Vec<[f64; 3]>,
    weights: Vec<f64>,
    /// `[n², n²]`: the lower triangle of Cholesky's factor.
    factor: Vec<f64>,
}

impl LeastSquares {
    /// Builds and factors the normal equations.
    ///
    /// - `directions`: `[D]`, unit length
    /// - `weights`: `[D]`, not negative; all 1 if `None`
    /// - `smoothing`: not negative
    ///
    /// # Errors
    /// [`Error::Sample`] for a direction that is not finite or not of unit length to 1e-3, and for a weight that is not finite,
    /// negative, or so large that the sum of all is not finite; [`Error::Smoothing`];
    /// [`Error::Undetermined`] if the samples do not determine all coefficients.
    ///
    /// # Panics
    /// If `weights` is not `[D]`.
    pub fn new(order: Order, directions: &[[f64; 3]], weights: Option<&[f64]>, smoothing: f64) -> Result<Self, Error> {
        let weights = weights.map_or_else(|| vec![1.0; directions.len()], <[f64]>::to_vec);
        assert_length("weights", weights.len(), directions.len());
        check(directions, &weights, smoothing)?;
        let basis = Basis::new(order);
        let mut matrix = normal_matrix(&basis, directions, &weights);
        let scale = smoothing * weights.iter().sum::<f64>() / (4.0 * PI);
        for (l, band) in order.bands() {
            let laplacian = (l * (l + 1)) as f64;
            band.for_each(|i| matrix[i * order.coeff_count() + i] += scale * laplacian * laplacian);
        }
        factor(&mut matrix, order.coeff_count()).map_err(|index| Error::Undetermined {
            order: order.get(),
            samples: directions.len(),
            index,
        })?;
        Ok(Self { basis, directions: directions.to_vec(), weights, factor: matrix })
    }

    /// The order of the fitted expansions.
    pub fn order(&self) -> Order {
        self.basis.order()
    }

    /// The coefficients that fit values at the directions.
    ///
    /// - `values`: `[D]`
    /// - `coeffs`: `[n²]`, overwritten; not finite where a value with a weight is not
    ///
    /// # Panics
    /// If a slice length does not match.
    pub fn fit<T: Real>(&self, values: &[T], coeffs: &mut [T]) {
        let count = self.order().coeff_count();
        assert_length("values", values.len(), self.directions.len());
        assert_length("coeffs", coeffs.len(), count);
        let weighted: Vec<[f64; 1]> = values.iter().zip(&self.weights).map(|(v, w)| [v.to_f64() * w]).collect();
        let mut solution = vec![0.0; count];
        self.basis.project(&self.directions, &weighted, &mut solution);
        solve(&self.factor, &mut solution);
        coeffs.iter_mut().zip(solution).for_each(|(out, f)| *out = T::from_f64(f));
    }
}

fn check(directions: &[[f64; 3]], weights: &[f64], smoothing: f64) -> Result<(), Error> {
    if !(smoothing.is_finite() && smoothing >= 0.0) {
        return Err(Error::Smoothing { given: smoothing });
    }
    for (item, (direction, &weight)) in directions.iter().zip(weights).enumerate() {
        if let Some(&given) = direction.iter().find(|component| !component.is_finite()) {
            return Err(Error::Sample { what: "direction", item, given });
        }
        let length2: f64 = direction.iter().map(|component| component * component).sum();
        if (length2 - 1.0).abs() > LENGTH_TOLERANCE {
            return Err(Error::Sample { what: "the squared length of direction", item, given: length2 });
        }
        if !(weight.is_finite() && weight >= 0.0) {
            return Err(Error::Sample { what: "weight", item, given: weight });
        }
    }
    let total: f64 = weights.iter().sum();
    if !total.is_finite() {
        return Err(Error::Sample { what: "the sum of weights up to", item: weights.len() - 1, given: total });
    }
    Ok(())
}

/// The lower triangle of `Σ w y yᵀ`, `[n², n²]`.
fn normal_matrix(basis: &Basis<f64>, directions: &[[f64; 3]], weights: &[f64]) -> Vec<f64> {
    let count = basis.order().coeff_count();
    let (mut matrix, mut y) = (vec![0.0; count * count], vec![0.0; count]);
    for (&direction, &weight) in directions.iter().zip(weights) {
        basis.eval(direction, &mut y);
        for (i, row) in matrix.chunks_exact_mut(count).enumerate() {
            let factor = weight * y[i];
            row.iter_mut().zip(&y[..=i]).for_each(|(sum, y)| *sum += factor * y);
        }
    }
    matrix
}

/// Cholesky's factor, in place of the lower triangle; the index of the pivot that is lost.
fn factor(matrix: &mut [f64], count: usize) -> Result<(), usize> {
    for i in 0..count {
        let (above, row) = matrix.split_at_mut(i * count);
        let row = &mut row[..=i];
        for j in 0..i {
            let other = &above[j * count..j * count + j + 1];
            row[j] = (row[j] - dot(&row[..j], &other[..j])) / other[j];
        }
        let pivot = row[i] - dot(&row[..i], &row[..i]);
        row[i] = match pivot > LOST_PIVOT * row[i] {
            true => Real::sqrt(pivot),
            // A NaN is lost too.
            false => return Err(i),
        };
    }
    Ok(())
}

/// Forward and backward substitution, in place.
fn solve(factor: &[f64], x: &mut [f64]) {
    let count = x.len();
    for i in 0..count {
        let row = &factor[i * count..];
        x[i] = (x[i] - dot(&row[..i], &x[..i])) / row[i];
    }
    for i in (0..count).rev() {
        let row = &factor[i * count..];
        x[i] /= row[i];
        let (below, value) = x.split_at_mut(i);
        below.iter_mut().zip(row).for_each(|(x, l)| *x -= l * value[0]);
    }
}
