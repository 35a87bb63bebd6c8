//! The singular value decomposition of a tall matrix.

/// Sweeps over all pairs of columns. Convergence is quadratic: ten are many.
const MAX_SWEEPS: usize = 60;

/// Columns whose cosine is below this are orthogonal: rounding of sums of a thousand products.
const ORTHOGONAL: f64 = 1e-15;

/// Singular values below this part of the largest one are those of rounding, and count as 0.
const RANK: f64 = 1e-14;

/// One term `σ u vᵀ` of a matrix.
#[derive(Debug, Clone)]
pub(super) struct Term {
    pub(super) value: f64,
    /// Unit length, or 0 where the value is.
    pub(super) left: Vec<f64>,
    /// Unit length.
    pub(super) right: Vec<f64>,
}

/// The terms of a matrix that is given by its columns, the largest first; as many as it has columns.
///
/// By rotations of pairs of columns until all are orthogonal: accurate for each singular value, and for matrices of low rank,
/// where that of nalgebra 0.35 depends on its tolerance: the 64×16 matrix of a diffuse BRDF, of rank 1, came back with a largest
/// value 3 % off at 5 ε, its default, and right at 1e-12.
///
/// Source: Hestenes, *Inversion of Matrices by Biorthogonalization and Related Results*, Journal of the SIAM 6(1), 1958.
pub(super) fn singular_terms(mut columns: Vec<Vec<f64>>) -> Vec<Term> {
    let count = columns.len();
    let unit = |k: usize| (0..count).map(|i| f64::from(u8::from(i == k))).collect();
    let mut right: Vec<Vec<f64>> = (0..count).map(unit).collect();
    for _ in 0..MAX_SWEEPS {
        let mut turned = false;
        for q in 1..count {
            for p in 0..q {
                if let Some(turn) = jacobi_turn(&columns[p], &columns[q]) {
                    turned = true;
                    rotate(&mut columns, p, q, turn);
                    rotate(&mut right, p, q, turn);
                }
            }
        }
        if !turned {
            break;
        }
    }
    let mut terms: Vec<Term> = columns.into_iter().zip(right).map(|(left, right)| term(left, right)).collect();
    terms.sort_by(|a, b| b.value.total_cmp(&a.value));
    let least = RANK * terms.first().map_or(0.0, |term| term.value);
    for term in terms.iter_mut().filter(|term| term.value <= least) {
        term.value = 0.0;
        term.left.fill(0.0);
    }
    terms
}

fn term(mut left: Vec<f64>, right: Vec<f64>) -> Term {
    let value = dot(&left, &left).sqrt();
    if value > 0.0 {
        left.iter_mut().for_each(|x| *x /= value);
    }
    Term { value, left, right }
}

/// Cosine and sine of the turn that makes two columns orthogonal; none if they are.
fn jacobi_turn(p: &[f64], q: &[f64]) -> Option<[f64; 2]> {
    let (alpha, beta, gamma) = (dot(p, p), dot(q, q), dot(p, q));
    if gamma.abs() <= ORTHOGONAL * (alpha * beta).sqrt() || gamma == 0.0 {
        return None;
    }
    let zeta = (beta - alpha) / (2.0 * gamma);
    let tangent = 1.0_f64.copysign(zeta) / (zeta.abs() + zeta.hypot(1.0));
    let cosine = 1.0 / tangent.hypot(1.0);
    Some([cosine, cosine * tangent])
}

fn rotate(columns: &mut [Vec<f64>], p: usize, q: usize, [cosine, sine]: [f64; 2]) {
    let (before, after) = columns.split_at_mut(q);
    for (a, b) in before[p].iter_mut().zip(&mut after[0]) {
        (*a, *b) = (cosine * *a - sine * *b, sine * *a + cosine * *b);
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn terms_add_up_to_the_matrix(numbers in prop::collection::vec(-1.0_f64..1.0, 20), rank in 1_usize..=4) {
            let base: Vec<Vec<f64>> = numbers.chunks_exact(5).map(<[f64]>::to_vec).collect();
            // The last columns repeat the first ones.
            let columns: Vec<Vec<f64>> = (0..4).map(|k| base[k % rank].clone()).collect();
            let terms = singular_terms(columns.clone());
            for (j, column) in columns.iter().enumerate() {
                for (i, a) in column.iter().enumerate() {
                    let sum: f64 = terms.iter().map(|term| term.value * term.left[i] * term.right[j]).sum();
                    prop_assert!((a - sum).abs() < 1e-13, "{a} {sum}");
                }
            }
            prop_assert!(terms.windows(2).all(|pair| pair[0].value >= pair[1].value));
            prop_assert!(terms[rank..].iter().all(|term| term.value == 0.0));
            for (a, b) in (0..4).flat_map(|a| (0..a).map(move |b| (a, b))) {
                prop_assert!(dot(&terms[a].left, &terms[b].left).abs() < 1e-9);
                prop_assert!(dot(&terms[a].right, &terms[b].right).abs() < 1e-13);
            }
        }

        /// Of full rank nalgebra is right.
        #[test]
        fn values_are_those_of_nalgebra(numbers in prop::collection::vec(-1.0_f64..1.0, 20)) {
            let columns: Vec<Vec<f64>> = numbers.chunks_exact(5).map(<[f64]>::to_vec).collect();
            let mut theirs = DMatrix::from_column_slice(5, 4, &numbers).singular_values().as_slice().to_vec();
            theirs.sort_by(|a, b| b.total_cmp(a));
            for (term, value) in singular_terms(columns).iter().zip(theirs) {
                prop_assert!((term.value - value).abs() < 1e-12, "{} {value}", term.value);
            }
        }
    }
}
