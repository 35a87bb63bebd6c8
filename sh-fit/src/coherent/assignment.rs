//! The assignment problem.

/// Assigns each row to a column of its own so that the sum of the costs is least.
///
/// - `cost`: `[n, n]`, row-major, finite
///
/// Returns the column of each row. O(n³).
///
/// Source: the Hungarian method with potentials, Jonker and Volgenant, *A Shortest Augmenting Path Algorithm for Dense and
/// Sparse Linear Assignment Problems*, Computing 38, 1987.
pub(super) fn assign(cost: &[f64], n: usize) -> Vec<usize> {
    // Row of each column; the column n is where a new row starts.
    let mut owner = vec![usize::MAX; n + 1];
    let (mut row_potential, mut column_potential) = (vec![0.0; n], vec![0.0; n + 1]);
    for row in 0..n {
        owner[n] = row;
        let mut least = vec![f64::INFINITY; n];
        let mut previous = vec![n; n];
        let mut visited = vec![false; n + 1];
        let mut column = n;
        // The shortest path from the new row to a free column.
        while owner[column] != usize::MAX {
            visited[column] = true;
            let r = owner[column];
            let (mut delta, mut next) = (f64::INFINITY, n);
            for c in (0..n).filter(|&c| !visited[c]) {
                let reduced = cost[r * n + c] - row_potential[r] - column_potential[c];
                if reduced < least[c] {
                    (least[c], previous[c]) = (reduced, column);
                }
                if least[c] < delta {
                    (delta, next) = (least[c], c);
                }
            }
            for c in 0..=n {
                if visited[c] {
                    row_potential[owner[c]] += delta;
                    column_potential[c] -= delta;
                } else if c < n {
                    least[c] -= delta;
                }
            }
            column = next;
        }
        while column != n {
            owner[column] = owner[previous[column]];
            column = previous[column];
        }
    }
    let mut columns = vec![0; n];
    (0..n).for_each(|c| columns[owner[c]] = c);
    columns
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The least sum over all permutations.
    fn brute_force(cost: &[f64], n: usize, row: usize, taken: &mut Vec<bool>) -> f64 {
        if row == n {
            return 0.0;
        }
        let mut least = f64::INFINITY;
        for c in 0..n {
            if !taken[c] {
                taken[c] = true;
                least = least.min(cost[row * n + c] + brute_force(cost, n, row + 1, taken));
                taken[c] = false;
            }
        }
        least
    }

    proptest! {
        #[test]
        fn no_permutation_is_cheaper(n in 1_usize..=5, costs in prop::collection::vec(0.0_f64..1.0, 25)) {
            let cost = &costs[..n * n];
            let columns = assign(cost, n);
            let mut sorted = columns.clone();
            sorted.sort_unstable();
            prop_assert_eq!(sorted, (0..n).collect::<Vec<_>>());
            let sum: f64 = columns.iter().enumerate().map(|(row, c)| cost[row * n + c]).sum();
            prop_assert!((sum - brute_force(cost, n, 0, &mut vec![false; n])).abs() < 1e-12);
        }
    }
}
