//! The logarithm in the algebra of truncated products.

use alloc::vec;
use alloc::vec::Vec;

use super::ONE;
use crate::product::{assert_lengths, product_matrix};
use crate::{Order, Real};

/// The logarithm of an expansion: what [`exp`](super::exp) turns back into it.
///
/// With `M` the matrix of the product with `coeffs` and `M = V D Vᵀ` its eigenvalues and eigenvectors,
///
/// ```text
/// out = V ln(max(D, floor)) Vᵀ 1
/// ```
///
/// the function 1 times the logarithm of the matrix. The eigenvalues are values of the function in the algebra of truncated
/// products, some below zero where the expansion rings: the floor is for them, as it is for a visibility of 0.
///
/// - `coeffs`: `[n²]`, dimensionless: a visibility with values around 0 to 1
/// - `floor`: the least value whose logarithm is taken, such as 0.02: lower floors follow deep shadow better, and make vectors
///   longer, which [`exp`](super::exp) pays with halvings. One that is not positive means the least positive number.
/// - `out`: `[n²]`, overwritten
///
/// Error of `exp(log f)` with [`ExpOptions::accurate`](super::ExpOptions::accurate), relative to the length of `f`, for the
/// visibility beside one cap and a floor of 0.01, asserted by `tests/exponential.rs`. The other obvious way, the projection of
/// `ln max(f(s), floor)`, is worse where it matters (in brackets):
///
/// | half angle | n = 3 | n = 4 | n = 6 |
/// |---|---|---|---|
/// | 10° | 0.0000 (0.0000) | 0.0000 (0.0000) | 0.0000 (0.0001) |
/// | 20° | 0.0000 (0.0002) | 0.0000 (0.0009) | 0.0004 (0.0069) |
/// | 30° | 0.0000 (0.0023) | 0.0000 (0.0112) | 0.0011 (0.0312) |
/// | 45° | 0.0001 (0.0379) | 0.0017 (0.0512) | 0.0364 (0.0414) |
/// | 60° | 0.0032 (0.0724) | 0.0486 (0.0514) | 0.0224 (0.0847) |
/// | 80° | 0.0739 (0.0755) | 0.0522 (0.1079) | 0.0492 (0.0587) |
///
/// Where no eigenvalue is below the floor the round trip is exact but for the cutting of products.
///
/// Costs `n⁶`, by Jacobi rotations in `f64`: 0.1 ms for n = 4, 1 ms for n = 6; meant for tables made beforehand. For caps only
/// the angle matters: take the logarithm about +z, keep its zonal coefficients, and expand them about any axis.
///
/// Zero gives `ln floor` as a constant. A coefficient that is not finite gives NaN.
///
/// ```
/// use sh_core::{ExpOptions, Order, exp, log};
///
/// let order = Order::new(3)?;
/// let visibility = [2.9_f32, 0.3, -0.4, 0.1, 0.0, 0.2, -0.1, 0.0, 0.1];
/// let (mut f, mut back) = ([0.0; 9], [0.0; 9]);
/// log(order, &visibility, 0.01, &mut f);
/// exp(order, &ExpOptions::accurate(), &f, &mut back);
/// assert!(back.iter().zip(visibility).all(|(b, v)| (b - v).abs() < 1e-4));
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// With coefficients or a floor that are not finite the result is NaN.
///
/// # Panics
/// If a slice length does not match `order`.
///
/// Source: [RWS06](crate#references), where it is applied to tabulated blockers.
pub fn log<T: Real>(order: Order, coeffs: &[T], floor: T, out: &mut [T]) {
    assert_lengths(order, [("coeffs", coeffs.len()), ("out", out.len())]);
    if coeffs.iter().any(|f| !f.is_finite()) {
        out.fill(T::from_f64(f64::NAN));
        return;
    }
    let count = order.coeff_count();
    let wide: Vec<f64> = coeffs.iter().map(|f| f.to_f64()).collect();
    let mut matrix = vec![0.0; count * count];
    product_matrix(order, &wide, &mut matrix);
    let vectors = diagonalise(&mut matrix, count);
    let floor = floor.to_f64().max(f64::MIN_POSITIVE);
    let mut sums = vec![0.0; count];
    for (k, vector) in vectors.chunks_exact(count).enumerate() {
        // The component of 1 along the eigenvector, times the logarithm.
        let weight = ONE * vector[0] * Real::ln(matrix[k * count + k].max(floor));
        sums.iter_mut().zip(vector).for_each(|(sum, v)| *sum += weight * v);
    }
    out.iter_mut().zip(sums).for_each(|(out, sum)| *out = T::from_f64(sum));
}

/// Sweeps after which rotations have long become the identity: convergence is quadratic.
const MAX_SWEEPS: usize = 30;

/// Makes a symmetric matrix diagonal by Jacobi rotations; returns the eigenvectors as rows.
fn diagonalise(matrix: &mut [f64], count: usize) -> Vec<f64> {
    let mut vectors = vec![0.0; count * count];
    vectors.iter_mut().step_by(count + 1).for_each(|v| *v = 1.0);
    let scale = matrix.iter().fold(0.0_f64, |scale, m| scale.max(m.abs()));
    for _ in 0..MAX_SWEEPS {
        let mut largest = 0.0_f64;
        for p in 0..count {
            for q in p + 1..count {
                let off = matrix[p * count + q];
                largest = largest.max(off.abs());
                if off.abs() > f64::MIN_POSITIVE {
                    let turn = rotation(matrix[p * count + p], matrix[q * count + q], off);
                    rotate_columns(matrix, count, [p, q], turn);
                    rotate_rows(matrix, count, [p, q], turn);
                    rotate_rows(&mut vectors, count, [p, q], turn);
                }
            }
        }
        if largest <= f64::EPSILON * 1e-2 * scale {
            break;
        }
    }
    vectors
}

/// Cosine and sine of the rotation that makes `[[p, off], [off, q]]` diagonal, by the smaller of its two angles.
fn rotation(p: f64, q: f64, off: f64) -> [f64; 2] {
    let cotangent = (q - p) / (2.0 * off);
    let tangent = if cotangent < 0.0 { -1.0 } else { 1.0 } / (cotangent.abs() + Real::hypot(cotangent, 1.0));
    let cosine = 1.0 / Real::hypot(tangent, 1.0);
    [cosine, tangent * cosine]
}

fn rotate_rows(matrix: &mut [f64], count: usize, [p, q]: [usize; 2], [c, s]: [f64; 2]) {
    let (above, below) = matrix.split_at_mut(q * count);
    for (a, b) in above[p * count..][..count].iter_mut().zip(&mut below[..count]) {
        (*a, *b) = (c * *a - s * *b, s * *a + c * *b);
    }
}

fn rotate_columns(matrix: &mut [f64], count: usize, [p, q]: [usize; 2], [c, s]: [f64; 2]) {
    for row in matrix.chunks_exact_mut(count) {
        (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigenvectors_are_orthonormal_and_rebuild_the_matrix() {
        let count = 12;
        let entry = |i: usize, j: usize| ((i * j) as f64 * 0.7 + (i + j) as f64).sin() + f64::from(u8::from(i == j));
        let original: Vec<f64> = (0..count * count).map(|at| entry(at / count, at % count)).collect();
        let mut matrix = original.clone();
        let vectors = diagonalise(&mut matrix, count);
        for (i, j) in (0..count).flat_map(|i| (0..count).map(move |j| (i, j))) {
            let sum = |f: &dyn Fn(usize) -> f64| (0..count).map(f).sum::<f64>();
            let gram = sum(&|k| vectors[i * count + k] * vectors[j * count + k]);
            assert!((gram - f64::from(u8::from(i == j))).abs() < 1e-14);
            let rebuilt = sum(&|k| vectors[k * count + i] * matrix[k * count + k] * vectors[k * count + j]);
            assert!((rebuilt - original[i * count + j]).abs() < 1e-14);
            assert!(i == j || matrix[i * count + j].abs() < 1e-15);
        }
    }
}
