//! Cholesky factors of small symmetric matrices, in place.

/// Replaces the lower triangle of a row-major matrix `[n, n]` by its Cholesky factor. Tells the first row whose pivot is not
/// positive; rows above it are done.
#[inline(always)]
pub(crate) fn decompose(matrix: &mut [f64], n: usize) -> Option<usize> {
    for i in 0..n {
        for j in 0..=i {
            let dot: f64 = (0..j).map(|k| matrix[i * n + k] * matrix[j * n + k]).sum();
            let rest = matrix[i * n + j] - dot;
            if i > j {
                matrix[i * n + j] = rest * matrix[j * n + j];
            } else if rest > 0.0 {
                // The diagonal holds the reciprocal: it is divided by more often than it is computed.
                matrix[i * n + i] = 1.0 / rest.sqrt();
            } else {
                matrix[i * n + i] = rest;
                return Some(i);
            }
        }
    }
    None
}

/// `x ← L⁻¹ x`.
#[inline(always)]
pub(crate) fn solve_lower(factor: &[f64], n: usize, x: &mut [f64]) {
    for i in 0..n {
        let dot: f64 = (0..i).map(|k| factor[i * n + k] * x[k]).sum();
        x[i] = (x[i] - dot) * factor[i * n + i];
    }
}

/// `x ← L⁻ᵀ x`.
#[inline(always)]
pub(crate) fn solve_upper(factor: &[f64], n: usize, x: &mut [f64]) {
    for i in (0..n).rev() {
        let dot: f64 = (i + 1..n).map(|k| factor[k * n + i] * x[k]).sum();
        x[i] = (x[i] - dot) * factor[i * n + i];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_system_is_solved_and_a_saddle_is_found() {
        let matrix = [4.0, 0.0, 0.0, 2.0, 5.0, 0.0, -2.0, 1.0, 6.0];
        let full = |i: usize, j: usize| if i > j { matrix[i * 3 + j] } else { matrix[j * 3 + i] };
        let (mut factor, mut x) = (matrix, [1.0, -2.0, 3.0]);
        assert_eq!(decompose(&mut factor, 3), None);
        solve_lower(&factor, 3, &mut x);
        solve_upper(&factor, 3, &mut x);
        for (i, expected) in [1.0, -2.0, 3.0].into_iter().enumerate() {
            let product: f64 = (0..3).map(|j| full(i, j) * x[j]).sum();
            assert!((product - expected).abs() < 1e-14);
        }
        assert_eq!(decompose(&mut [1.0, 0.0, 2.0, 3.0], 2), Some(1));
        assert_eq!(decompose(&mut [f64::NAN], 1), Some(0));
    }
}
