//! Zonal functions: one coefficient per band, symmetric about +z or about an axis.

mod axis;
mod ggx;
mod kernel;
mod legendre;
mod ratio;
mod value;
mod von_mises_fisher;

use core::f64::consts::PI;

pub use axis::{fit_lobe_about_axis, linear_axis};
pub use ggx::ggx_kernel;
pub use kernel::{cap_kernel, clamped_cosine, clamped_cosine_power, gaussian_kernel, phong_kernel, spherical_cap};
#[cfg(feature = "alloc")]
pub use value::project_zonal;
pub use value::{lobe_value, zonal_value};
pub use von_mises_fisher::{spherical_gaussian, von_mises_fisher_kernel};

use crate::order::assert_length;
use crate::{Order, Real, eval};

/// `√(4π/(2l+1))`: turns a zonal coefficient into a lobe coefficient, and a kernel into the factor of a convolution.
fn lobe_factor(l: usize) -> f64 {
    Real::sqrt(4.0 * PI / (2 * l + 1) as f64)
}

/// Expands a zonal function about an axis.
///
/// `out[i] = √(4π/(2l+1)) · zonal[l] · y_i(axis)` with `i = l(l+1) + m`.
///
/// - `zonal`: `[n]`, any unit; the result has the same one
/// - `axis`: unit length, in the frame in which the result is wanted
/// - `out`: `[n²]`, overwritten
///
/// Does not allocate.
///
/// # Panics
/// If a slice length does not match `order`.
///
/// Source: [SLS05](crate#references) eq. 4.
pub fn expand_zonal<T: Real>(order: Order, zonal: &[T], axis: [T; 3], out: &mut [T]) {
    assert_length("zonal", zonal.len(), order.get());
    eval(order, axis, out);
    for ((l, band), &g) in order.bands().zip(zonal) {
        let factor = g * T::from_f64(lobe_factor(l));
        out[band].iter_mut().for_each(|y| *y *= factor);
    }
}

/// Expands lobe coefficients about an axis: `out[i] = lobe[l] · y_i(axis)`.
///
/// - `lobe`: `[n]`, the `g*_l` of [SLS05](crate#references), see [`lobe_from_zonal`]
/// - `axis`: unit length, in the frame in which the result is wanted
/// - `out`: `[n²]`, overwritten
///
/// # Panics
/// If a slice length does not match `order`.
///
/// Source: [SLS05](crate#references) eq. 6.
pub fn expand_lobe<T: Real>(order: Order, lobe: &[T], axis: [T; 3], out: &mut [T]) {
    assert_length("lobe", lobe.len(), order.get());
    eval(order, axis, out);
    for ((_, band), &g) in order.bands().zip(lobe) {
        out[band].iter_mut().for_each(|y| *y *= g);
    }
}

/// Zonal coefficients into lobe coefficients, in place: `g*_l = √(4π/(2l+1)) g_l`.
///
/// Source: [SLS05](crate#references) eq. 4, 6.
pub fn lobe_from_zonal<T: Real>(coeffs: &mut [T]) {
    for (l, g) in coeffs.iter_mut().enumerate() {
        *g *= T::from_f64(lobe_factor(l));
    }
}

/// Lobe coefficients into zonal coefficients, in place: `g_l = g*_l / √(4π/(2l+1))`.
///
/// Source: [SLS05](crate#references) eq. 4, 6.
pub fn zonal_from_lobe<T: Real>(coeffs: &mut [T]) {
    for (l, g) in coeffs.iter_mut().enumerate() {
        *g *= T::from_f64(1.0 / lobe_factor(l));
    }
}

/// Convolves an expansion with a zonal kernel `h`, in place: `f_lm *= √(4π/(2l+1)) h_l`.
///
/// The result at a direction `a` is the integral over `s` of `f(s) h(a·s)`, the kernel turned to `a`.
///
/// - `zonal`: `[n]`, the kernel; with [`clamped_cosine`] radiance becomes irradiance as a function of the normal
/// - `coeffs`: `[n²]`
///
/// ```
/// use sh_core::{Order, clamped_cosine, convolve, reconstruct};
///
/// let order = Order::new(3)?;
/// let mut light = [0.0_f64; 9];
/// light[0] = (4.0 * std::f64::consts::PI).sqrt(); // radiance 1 from everywhere
/// let mut kernel = [0.0; 3];
/// clamped_cosine(&mut kernel);
/// convolve(order, &kernel, &mut light);
/// let irradiance = reconstruct(order, &light, [0.0, 0.6, 0.8]);
/// assert!((irradiance - std::f64::consts::PI).abs() < 1e-14);
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If a slice length does not match `order`.
///
/// Source: [SKS02](crate#references) section 3, "Convolution".
pub fn convolve<T: Real>(order: Order, zonal: &[T], coeffs: &mut [T]) {
    assert_length("zonal", zonal.len(), order.get());
    assert_length("coeffs", coeffs.len(), order.coeff_count());
    for ((l, band), &h) in order.bands().zip(zonal) {
        let factor = h * T::from_f64(lobe_factor(l));
        coeffs[band].iter_mut().for_each(|f| *f *= factor);
    }
}

#[cfg(all(test, feature = "alloc"))]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    extern crate std;

    use std::vec;

    use super::*;
    use crate::sphere::gauss_legendre;
    use crate::{Quadrature, dot, project_function, reconstruct};

    #[test]
    fn clamped_cosine_is_its_integral() {
        // g_l = √((2l+1)/4π) 2π ∫_0^1 z P_l(z) dz, a polynomial.
        const N: usize = 120;
        let mut expected = [0.0; N];
        for (z, weight) in gauss_legendre(N / 2 + 1).map(|(z, w)| (0.5 * (z + 1.0), 0.5 * w)) {
            let (mut below, mut p) = (0.0, 1.0);
            for (l, sum) in expected.iter_mut().enumerate() {
                let l = l as f64;
                *sum += 2.0 * PI * ((2.0 * l + 1.0) / (4.0 * PI)).sqrt() * weight * z * p;
                (below, p) = (p, ((2.0 * l + 1.0) * z * p - l * below) / (l + 1.0));
            }
        }
        let mut zonal = [0.0_f64; N];
        clamped_cosine(&mut zonal);
        for (l, (g, expected)) in zonal.iter().zip(expected).enumerate() {
            assert!((g - expected).abs() < 1e-14, "band {l}: {g} {expected}");
        }
    }

    #[test]
    fn clamped_cosine_has_the_printed_values() {
        // [RH01] eq. 9: A_l √... = π, 2π/3, π/4, 0, −π/24, 0, π/64
        let printed = [PI, 2.0 * PI / 3.0, PI / 4.0, 0.0, -PI / 24.0, 0.0, PI / 64.0];
        let mut lobe = [0.0_f64; 7];
        clamped_cosine(&mut lobe);
        lobe_from_zonal(&mut lobe);
        for (g, printed) in lobe.iter().zip(printed) {
            assert!((g - printed).abs() < 1e-15, "{lobe:?}");
        }
    }

    #[test]
    fn clamped_cosine_works_at_the_ends() {
        clamped_cosine::<f32>(&mut []);
        let mut zonal = vec![0.0_f32; Order::MAX];
        clamped_cosine(&mut zonal);
        assert!(zonal.iter().all(|g| g.is_finite()));
        // Parseval: ∫ max(z,0)² = 2π/3; the rest beyond the last band falls as 1/n³.
        assert!((dot(&zonal, &zonal) - (2.0 * PI / 3.0) as f32).abs() < 1e-5);
    }

    #[test]
    fn lobe_and_zonal_coefficients_go_round() {
        let mut coeffs = [1.0_f64, -2.0, 3.0, 0.5];
        lobe_from_zonal(&mut coeffs);
        assert!((coeffs[2] - 3.0 * (4.0 * PI / 5.0).sqrt()).abs() < 1e-15);
        zonal_from_lobe(&mut coeffs);
        for (c, expected) in coeffs.iter().zip([1.0, -2.0, 3.0, 0.5]) {
            assert!((c - expected).abs() < 1e-15);
        }
    }

    #[test]
    fn a_zonal_function_about_its_own_axis_is_itself() {
        let order = Order::new(4).unwrap();
        let (zonal, mut out) = ([1.0_f64, -2.0, 3.0, 0.5], [9.0; 16]);
        expand_zonal(order, &zonal, [0.0, 0.0, 1.0], &mut out);
        for (i, f) in out.iter().enumerate() {
            let expected = [0, 2, 6, 12].iter().position(|&centre| centre == i).map_or(0.0, |l| zonal[l]);
            assert!((f - expected).abs() < 1e-15, "{out:?}");
        }
        let mut lobe = zonal;
        lobe_from_zonal(&mut lobe);
        let (mut by_lobe, mut by_zonal) = ([0.0; 16], [0.0; 16]);
        expand_lobe(order, &lobe, [0.36, 0.48, 0.8], &mut by_lobe);
        expand_zonal(order, &zonal, [0.36, 0.48, 0.8], &mut by_zonal);
        assert!(by_lobe.iter().zip(by_zonal).all(|(a, b)| (a - b).abs() < 1e-15));
    }

    #[test]
    fn an_expanded_lobe_is_the_turned_function() {
        // ((1 + a·s)/2)³ is a polynomial of degree 3: its expansion about a is exact.
        let (order, axis) = (Order::new(4).unwrap(), [0.36, -0.48, -0.8]);
        let lobe = |cosine: f64| (0.5 + 0.5 * cosine).powi(3);
        let along = |a: [f64; 3], s: [f64; 3]| a.iter().zip(s).map(|(a, s)| a * s).sum::<f64>();
        let quadrature = Quadrature::new(6);
        let (mut about_z, mut about_axis, mut expanded) = ([0.0; 16], [0.0; 16], [0.0; 16]);
        project_function(order, &quadrature, |s| lobe(s[2]), &mut about_z);
        project_function(order, &quadrature, |s| lobe(along(axis, s)), &mut about_axis);
        expand_zonal(order, &[about_z[0], about_z[2], about_z[6], about_z[12]], axis, &mut expanded);
        for (a, b) in expanded.iter().zip(about_axis) {
            // 4π times a few roundings, in the quadrature
            assert!((a - b).abs() < 1e-14, "{a} {b}");
        }
    }

    #[test]
    fn convolution_is_its_integral() {
        // (h*f)(a) = ∫ f(s) h(a·s) ds with a kernel of order 5, at some directions.
        let order = Order::new(5).unwrap();
        let kernel = [0.7_f64, 0.5, -0.3, 0.2, 0.1];
        let f: [f64; 25] = core::array::from_fn(|i| Real::sin(1.0 + i as f64));
        let mut convolved = f;
        convolve(order, &kernel, &mut convolved);
        let quadrature = Quadrature::new(8);
        for axis in [[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [-0.36, 0.48, -0.8]] {
            let mut about_axis = [0.0; 25];
            expand_zonal(order, &kernel, axis, &mut about_axis);
            let product = |s| reconstruct(order, &f, s) * reconstruct(order, &about_axis, s);
            let integral: f64 = quadrature.points().iter().map(|&(s, w)| w * product(s)).sum();
            let value = reconstruct(order, &convolved, axis);
            assert!((value - integral).abs() < 1e-13, "{value} {integral}");
        }
    }

    #[test]
    fn irradiance_of_a_constant_and_a_linear_light() {
        // L = 1 gives π everywhere, L = z gives 2π/3 n_z: ∫ (s·z) max(s·n, 0) ds.
        for n in [2, 3, 6, 20] {
            let order = Order::new(n).unwrap();
            let mut kernel = vec![0.0_f64; n];
            clamped_cosine(&mut kernel);
            let mut light = vec![0.0; n * n];
            light[0] = (4.0 * PI).sqrt();
            light[2] = (4.0 * PI / 3.0).sqrt();
            convolve(order, &kernel, &mut light);
            for normal in [[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.36, 0.48, 0.8]] {
                let expected = PI + 2.0 * PI / 3.0 * normal[2];
                assert!((reconstruct(order, &light, normal) - expected).abs() < 1e-14);
            }
        }
    }
}
