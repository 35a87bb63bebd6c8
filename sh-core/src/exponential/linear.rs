//! The best `a` and `b` in `exp f̂ ≈ a 1 + b f̂`.

use super::linear_table::{FIRST_ORDER, TABLE};
use crate::Order;

/// The longest `f̂` of the table.
pub(super) const TABLE_END: f64 = 4.0;

/// `a` and `b` for a vector of this length, at most [`TABLE_END`].
pub(super) fn coefficients(order: Order, length: f64) -> [f64; 2] {
    match order.get().checked_sub(FIRST_ORDER).and_then(|row| TABLE.get(row)) {
        Some(table) => {
            // Near zero `a − 1` is a square: interpolated itself, its error would survive any number of halvings.
            let [a, b] = interpolate(table, length);
            [1.0 + a * length * length, b]
        }
        None => of_random_direction(order, length),
    }
}

/// Linear between the nodes, which are equally spaced from 0 to [`TABLE_END`].
fn interpolate(table: &[[f64; 2]], length: f64) -> [f64; 2] {
    let position = length / TABLE_END * (table.len() - 1) as f64;
    let node = (position as usize).min(table.len() - 2);
    let (t, [low, high]) = (position - node as f64, [table[node], table[node + 1]]);
    [0, 1].map(|which| low[which] + t * (high[which] - low[which]))
}

/// The means over all directions of `f̂` in the space of the `N = n² − 1` coefficients.
///
/// At any point `f̂(s) = κ u` with `κ = |f̂| √(N/4π)`, by the addition theorem, and `u` the cosine of a random direction. Then
/// `a = ⟨e^κu⟩ = Σ_j (κ/2)^2j / (j! (N/2)_j)`, and `b = (N/κ) da/dκ`.
fn of_random_direction(order: Order, length: f64) -> [f64; 2] {
    let half_dimension = 0.5 * (order.coeff_count() - 1) as f64;
    if half_dimension == 0.0 {
        return [1.0, 1.0];
    }
    let quarter_kappa2 = length * length * half_dimension / (8.0 * core::f64::consts::PI);
    let (mut a, mut b, mut term, mut j) = (0.0, 0.0, 1.0, 0.0);
    while term > f64::EPSILON * a * 1e-3 {
        a += term;
        b += term * half_dimension / (half_dimension + j);
        term *= quarter_kappa2 / ((j + 1.0) * (half_dimension + j));
        j += 1.0;
    }
    [a, b]
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    #[test]
    fn closed_forms_of_three_and_infinitely_many_dimensions() {
        // Three: a = sinh κ/κ, b = 3 (κ cosh κ − sinh κ)/κ³.
        let two = Order::new(2).unwrap();
        for length in [1e-6, 0.3, 2.0, 4.0] {
            let kappa: f64 = length * (3.0 / (4.0 * core::f64::consts::PI)).sqrt();
            let [a, b] = of_random_direction(two, length);
            assert!((a / (kappa.sinh() / kappa) - 1.0).abs() < 1e-14, "{a}");
            if kappa > 0.01 {
                let expected = 3.0 * (kappa * kappa.cosh() - kappa.sinh()) / kappa.powi(3);
                assert!((b / expected - 1.0).abs() < 1e-11, "{b} {expected}");
            }
        }
        // Many: a normal distribution of variance |f̂|²/4π, of which a is the mean of the exponential.
        let [a, b] = of_random_direction(Order::new(Order::MAX).unwrap(), 2.0);
        let normal = (2.0 / (4.0 * core::f64::consts::PI)).exp();
        assert!((a / normal - 1.0).abs() < 1e-5 && (b / normal - 1.0).abs() < 1e-5, "{a} {b} {normal}");
        assert_eq!(of_random_direction(Order::new(1).unwrap(), 0.0), [1.0, 1.0]);
    }

    #[test]
    fn tables_begin_at_the_identity_and_are_met_at_their_nodes() {
        for (row, n) in TABLE.iter().zip(FIRST_ORDER..) {
            let order = Order::new(n).unwrap();
            assert_eq!(coefficients(order, 0.0), [1.0, 1.0]);
            for (node, expected) in row.iter().enumerate() {
                let found = coefficients(order, TABLE_END * node as f64 / (row.len() - 1) as f64);
                let length = TABLE_END * node as f64 / (row.len() - 1) as f64;
                let expected = [1.0 + expected[0] * length * length, expected[1]];
                assert!((0..2).all(|k| (found[k] - expected[k]).abs() < 1e-14), "n = {n}: {found:?} {expected:?}");
            }
        }
    }
}
