//! Legendre polynomials with two derivatives.

/// `P_l(t), P_l'(t), P_l''(t)` for `l = 0..out.len()`.
///
/// `(l+1) P_(l+1) = (2l+1) t P_l − l P_(l−1)`, and `P'_(l+1) = P'_(l−1) + (2l+1) P_l`, which holds for the next derivative
/// too: [DLMF](sh_core#references) 18.9.1, 18.9.19.
#[inline]
pub(super) fn legendre(t: f64, out: &mut [[f64; 3]]) {
    let (mut before, mut here) = ([0.0; 3], [1.0, 0.0, 0.0]);
    for (l, out) in out.iter_mut().enumerate() {
        *out = here;
        let l = l as f64;
        let odd = 2.0 * l + 1.0;
        let next =
            [(odd * t * here[0] - l * before[0]) / (l + 1.0), before[1] + odd * here[0], before[2] + odd * here[1]];
        (before, here) = (here, next);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_and_derivatives_are_the_closed_ones() {
        for t in [-1.0_f64, -0.3, 0.0, 0.7, 1.0] {
            let mut p = [[0.0; 3]; 5];
            legendre(t, &mut p);
            let expected = [
                [1.0, 0.0, 0.0],
                [t, 1.0, 0.0],
                [1.5 * t * t - 0.5, 3.0 * t, 3.0],
                [2.5 * t.powi(3) - 1.5 * t, 7.5 * t * t - 1.5, 15.0 * t],
                [4.375 * t.powi(4) - 3.75 * t * t + 0.375, 17.5 * t.powi(3) - 7.5 * t, 52.5 * t * t - 7.5],
            ];
            for (p, expected) in p.iter().flatten().zip(expected.iter().flatten()) {
                // Values up to 45, a few roundings.
                assert!((p - expected).abs() < 1e-13, "{p} {expected} at {t}");
            }
        }
    }
}
