//! Gaunt coefficients from whole numbers: Wigner 3j symbols as sums of products of binomials, exact in 128 bits up to
//! `l = 15`; only the square root at the end is rounded.
//!
//! ```text
//! (j1 j2 j3; m1 m2 m3) = (−1)^(j1−j2−m3) √( C(2j1, J−2j2) C(2j2, J−2j3) / ((2j3+1) C(J+1, J−2j3) C(2j1, j1−m1) C(2j2, j2−m2) C(2j3, j3−m3)) )
//!                        · Σ_k (−1)^k C(J−2j3, k) C(J−2j2, j1−m1−k) C(J−2j1, j2+m2−k),     J = j1 + j2 + j3
//! ```
//!
//! This is Racah's formula with its factorials gathered into binomials.

/// `C(n, k)`, 0 outside `0 ≤ k ≤ n`.
fn binomial(n: i64, k: i64) -> i128 {
    if k < 0 || k > n {
        return 0;
    }
    (0..k.min(n - k)).fold(1, |value, i| value * i128::from(n - i) / i128::from(i + 1))
}

fn sign(power: i64) -> f64 {
    if power.rem_euclid(2) == 0 { 1.0 } else { -1.0 }
}

/// The Wigner 3j symbol of whole `j`.
fn wigner_3j([j1, j2, j3]: [i64; 3], [m1, m2, m3]: [i64; 3]) -> f64 {
    if m1 + m2 + m3 != 0 || j3 > j1 + j2 || j3 < (j1 - j2).abs() || m1.abs() > j1 || m2.abs() > j2 || m3.abs() > j3 {
        return 0.0;
    }
    let total = j1 + j2 + j3;
    let term = |k: i64| {
        let product =
            binomial(total - 2 * j3, k) * binomial(total - 2 * j2, j1 - m1 - k) * binomial(total - 2 * j1, j2 + m2 - k);
        if k % 2 == 0 { product } else { -product }
    };
    let sum: i128 = (0..=total - 2 * j3).map(term).sum();
    let above = [binomial(2 * j1, total - 2 * j2), binomial(2 * j2, total - 2 * j3)];
    let below = [
        i128::from(2 * j3 + 1),
        binomial(total + 1, total - 2 * j3),
        binomial(2 * j1, j1 - m1),
        binomial(2 * j2, j2 - m2),
        binomial(2 * j3, j3 - m3),
    ];
    let product = |numbers: &[i128]| numbers.iter().map(|&number| number as f64).product::<f64>();
    sign(j1 - j2 - m3) * sum as f64 * (product(&above) / product(&below)).sqrt()
}

/// `∫ Y_l1^m1 Y_l2^m2 Y_l3^m3` of complex harmonics.
fn complex_gaunt(l: [i64; 3], m: [i64; 3]) -> f64 {
    let degeneracy = l.iter().map(|l| (2 * l + 1) as f64).product::<f64>() / (4.0 * std::f64::consts::PI);
    degeneracy.sqrt() * wigner_3j(l, [0; 3]) * wigner_3j(l, m)
}

/// A real function as a sum of complex ones: `(m, [re, im])`. `y_lm = √2 Re Y_l^m`, `y_l−m = √2 Im Y_l^m`, and
/// `Y_l^−m = (−1)^m conj Y_l^m`.
fn complex_terms(m: i64) -> Vec<(i64, [f64; 2])> {
    let (size, half) = (m.abs(), 0.5_f64.sqrt());
    match m {
        0 => vec![(0, [1.0, 0.0])],
        1.. => vec![(size, [half, 0.0]), (-size, [sign(size) * half, 0.0])],
        _ => vec![(size, [0.0, -half]), (-size, [0.0, sign(size) * half])],
    }
}

/// `∫ y_i y_j y_k` of real harmonics, indices `l(l+1) + m`.
pub(crate) fn gaunt(i: usize, j: usize, k: usize) -> f64 {
    let band = |i: usize| i.isqrt() as i64;
    let l = [i, j, k].map(band);
    let [a, b, c] = [i, j, k].map(|i| complex_terms(i as i64 - band(i) * (band(i) + 1)));
    let mut sum = 0.0;
    for (m1, [a_re, a_im]) in &a {
        for (m2, [b_re, b_im]) in &b {
            for (m3, [c_re, c_im]) in &c {
                let [re, im] = [a_re * b_re - a_im * b_im, a_re * b_im + a_im * b_re];
                // The sum is real.
                sum += (re * c_re - im * c_im) * complex_gaunt(l, [*m1, *m2, *m3]);
            }
        }
    }
    sum
}
