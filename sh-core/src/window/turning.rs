//! How an expansion changes as the sphere is turned: derivatives by rotations about the axes.
//!
//! `(D_a f)(s) = (a × s) · ∇f` is the rate at which `f` changes as `s` turns about `a`. It keeps bands apart. With the complex
//! `Y_l^m`, Condon-Shortley phase included, and `α_m = √((l−m)(l+m+1))`, `β_m = √((l+m)(l−m+1))`
//! ([VMK88](crate#references), chapter 5, for the operators of angular momentum `−i D`):
//!
//! ```text
//! D_x Y^m = i/2 (α_m Y^(m+1) + β_m Y^(m−1))    D_y Y^m = 1/2 (α_m Y^(m+1) − β_m Y^(m−1))    D_z Y^m = i m Y^m
//! ```
//!
//! Here are their real and imaginary parts, `y_lm = √2 Re Y_l^m` and `y_l−m = √2 Im Y_l^m` for m > 0.

use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::SQRT_2;

use crate::{Order, Real, index};

/// The coefficients of `D_x f`, `D_y f` and `D_z f`.
pub(super) fn turned(order: Order, coeffs: &[f64]) -> [Vec<f64>; 3] {
    let [mut x, mut y, mut z] = [(); 3].map(|()| vec![0.0; coeffs.len()]);
    for l in 1..order.get() {
        for m in 0..=l as isize {
            let [plus, minus] = [coeffs[index(l, m)], if m > 0 { coeffs[index(l, -m)] } else { 0.0 }];
            if m > 0 {
                z[index(l, -m)] -= m as f64 * plus;
                z[index(l, m)] += m as f64 * minus;
            }
            // y_l0 is Y^0 itself, the others are √2 times a part of Y^m: between m = 0 and 1 there is a factor √2.
            if m < l as isize {
                let half_alpha = half_root(l, m) * if m == 0 { SQRT_2 } else { 1.0 };
                add(&mut x, l, m + 1, half_alpha * minus, -half_alpha * plus);
                add(&mut y, l, m + 1, half_alpha * plus, half_alpha * minus);
            }
            if m > 0 {
                let half_beta = half_root(l, m - 1) * if m == 1 { SQRT_2 } else { 1.0 };
                add(&mut x, l, m - 1, half_beta * minus, -half_beta * plus);
                add(&mut y, l, m - 1, -half_beta * plus, -half_beta * minus);
            }
        }
    }
    [x, y, z]
}

/// Adds to the coefficients of `y_lm` and `y_l−m`; at m = 0 there is no imaginary part.
fn add(coeffs: &mut [f64], l: usize, m: isize, real: f64, imaginary: f64) {
    coeffs[index(l, m)] += real;
    if m > 0 {
        coeffs[index(l, -m)] += imaginary;
    }
}

/// `√((l−m)(l+m+1)) / 2`
fn half_root(l: usize, m: isize) -> f64 {
    let l = l as isize;
    0.5 * Real::sqrt(((l - m) * (l + m + 1)) as f64)
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    extern crate std;

    use super::*;
    use crate::{dot, eval, fibonacci};

    #[test]
    fn derivatives_are_differences_of_turned_directions() {
        let order = Order::new(7).unwrap();
        let coeffs: Vec<f64> = (0..49).map(|i| (1.0 + 1.3 * f64::from(i)).sin()).collect();
        let turned = turned(order, &coeffs);
        let value = |coeffs: &[f64], s: [f64; 3]| {
            let mut y = [0.0; 49];
            eval(order, s, &mut y);
            dot(coeffs, &y)
        };
        for s in fibonacci(30) {
            for (axis, derivative) in turned.iter().enumerate() {
                let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
                let at = |angle: f64| {
                    let mut t = s;
                    t[j] = s[j] * angle.cos() - s[k] * angle.sin();
                    t[k] = s[k] * angle.cos() + s[j] * angle.sin();
                    value(&coeffs, t)
                };
                // Fourth order: h⁴/30 times a fifth derivative of at most 6⁵ · 30, and rounding of 1e-14/h.
                let h = 1e-3;
                let difference = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
                let derivative = value(derivative, s);
                assert!((difference - derivative).abs() < 1e-8, "axis {axis}, {s:?}: {difference} {derivative}");
            }
        }
    }
}
