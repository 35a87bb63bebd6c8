//! Legendre polynomials by a recurrence that keeps its digits at the ends of `[−1, 1]`.

/// `(P_l(z), (P_l(z) − P_{l−1}(z)) / (1 − z))` for `l = 0, 1, …`, at `z = 1 − versine`.
///
/// The three-term recurrence, written for the difference of neighbours divided by the versine (Reinsch's form): the second
/// value keeps its relative accuracy as `z` goes to 1, and is `−l` there. For `0 ≤ versine ≤ 1`; at `l = 0` it is 0.
pub(super) fn legendre_from_top(versine: f64) -> impl Iterator<Item = (f64, f64)> {
    let (mut l, mut value, mut slope) = (0.0, 1.0, 0.0);
    core::iter::repeat_with(move || {
        let current = (value, slope);
        slope = (l * slope - (2.0 * l + 1.0) * value) / (l + 1.0);
        value += versine * slope;
        l += 1.0;
        current
    })
}

/// `P_l(z)` for `l = 0, 1, …`; `z` in `[−1, 1]`.
pub(super) fn legendre(z: f64) -> impl Iterator<Item = f64> {
    // P_l(−z) = (−1)^l P_l(z), so only the half next to z = 1 is needed.
    let mut sign = 1.0;
    legendre_from_top(1.0 - z.abs()).map(move |(value, _)| {
        let signed = sign * value;
        sign *= z.signum();
        signed
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn low_polynomials() {
        for z in [-1.0_f64, -0.8, -1e-9, 0.0, 0.3, 1.0 - 1e-12, 1.0] {
            let expected = [1.0, z, 1.5 * z * z - 0.5, (2.5 * z * z - 1.5) * z];
            for (value, expected) in legendre(z).zip(expected) {
                assert!((value - expected).abs() < 4e-16, "{z}: {value} {expected}");
            }
        }
    }

    #[test]
    fn slopes_at_the_top() {
        // P_l'(1) = l(l+1)/2, so the difference of neighbours falls as l versine.
        for (l, (value, slope)) in legendre_from_top(0.0).take(600).enumerate() {
            assert_eq!((value, slope), (1.0, -(l as f64)));
        }
    }
}
