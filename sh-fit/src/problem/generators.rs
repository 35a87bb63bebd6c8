//! Infinitesimal rotations of an expansion.

use sh_core::{Order, index};

/// Writes the coefficients of `(a × s)·∇f(s)` for the coordinate axes `a = x, y, z`: the derivatives of `f` along rotations
/// of its argument.
///
/// With `c_m = √((l−m)(l+m+1))` and `R_m = y_lm`, `I_m = y_l−m` for m > 0, from `D = i L` and the ladder operators
/// `L± Y_lm = c Y_l(m±1)`:
///
/// ```text
/// D_z R_m = −m I_m                          D_z I_m = m R_m
/// D_y R_m = ½ (c_m R_(m+1) − c_(m−1) R_(m−1))   D_y I_m = ½ (c_m I_(m+1) − c_(m−1) I_(m−1))
/// D_x R_m = −½ (c_m I_(m+1) + c_(m−1) I_(m−1))  D_x I_m = ½ (c_m R_(m+1) + c_(m−1) R_(m−1))
/// ```
///
/// where `I_0 = 0`, and `R_0` counts √2 times; `D_y R_0 = c_0/√2 R_1`, `D_x R_0 = −c_0/√2 I_1`.
///
/// - `coeffs`: `[n²]`
/// - `turned`: three times `[n²]`, overwritten
pub(crate) fn turn(order: Order, coeffs: &[f64], turned: &mut [Vec<f64>; 3]) {
    turned.iter_mut().for_each(|out| {
        out.clear();
        out.resize(coeffs.len(), 0.0);
    });
    let [x, y, z] = turned;
    for l in 0..order.get() {
        for m in 1..=l {
            let (re, im) = (index(l, m as isize), index(l, -(m as isize)));
            z[im] -= m as f64 * coeffs[re];
            z[re] += m as f64 * coeffs[im];
        }
        // The pair of D R_m and D R_(m+1) that c_m joins; the operators are antisymmetric.
        for m in 0..l {
            let half = 0.5 * (((l - m) * (l + m + 1)) as f64).sqrt();
            let (re, im) = (index(l, m as isize), index(l, -(m as isize)));
            let (re_next, im_next) = (index(l, m as isize + 1), index(l, -(m as isize) - 1));
            let c = if m == 0 { half * std::f64::consts::SQRT_2 } else { half };
            y[re_next] += c * coeffs[re];
            y[re] -= c * coeffs[re_next];
            x[im_next] -= c * coeffs[re];
            x[re] += c * coeffs[im_next];
            if m > 0 {
                y[im_next] += c * coeffs[im];
                y[im] -= c * coeffs[im_next];
                x[re_next] += c * coeffs[im];
                x[im] -= c * coeffs[re_next];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn generators_are_the_derivatives_of_rotated_functions() {
        let order = Order::new(7).expect("valid");
        let f: Vec<f64> = (0..49).map(|i| (i * 7919 % 101) as f64 / 50.0 - 1.0).collect();
        let mut turned = [const { Vec::new() }; 3];
        turn(order, &f, &mut turned);
        for s in [[0.36, 0.48, 0.8], [0.0, 0.0, 1.0], [-0.6, 0.0, -0.8], [0.0, -1.0, 0.0]] {
            let (mut y, mut gradients) = (vec![0.0; 49], vec![0.0; 147]);
            sh_core::eval_gradient(order, s, &mut y, &mut gradients);
            let gradient: Vec<f64> = gradients.chunks_exact(49).map(|g| sh_core::dot(g, &f)).collect();
            // (a × s)·∇f = a·(s × ∇f)
            let [gx, gy, gz] = [gradient[0], gradient[1], gradient[2]];
            let moment = [s[1] * gz - s[2] * gy, s[2] * gx - s[0] * gz, s[0] * gy - s[1] * gx];
            for (turned, expected) in turned.iter().zip(moment) {
                let value = sh_core::dot(turned, &y);
                // Rounding of sums of 49 products of about 5.
                assert!((value - expected).abs() < 1e-12, "{value} {expected} at {s:?}");
            }
        }
    }
}
