//! The thin membrane: a leaf, a wing, a lampshade.

use sh_core::{Order, clamped_cosine, lobe_from_zonal};

use crate::{Error, LobeSet, explicit_count};

/// The lobe coefficients of a thin diffuse membrane that lets the share `alpha` of the light behind it through.
///
/// ```text
/// g(s) = 1/π · (s·ζ        if s·ζ ≥ 0, else −α s·ζ)
/// g*_0 = 1 + α     g*_1 = 2/3 (1 − α)     g*_l = 0 for odd l > 1
/// g*_l = 2 (1 + α) (−1)^(l/2−1) / ((l+2)(l−1)) · l! / (2^l ((l/2)!)²)   for even l
/// ```
///
/// The axis is the normal `ζ`. The `1/π` that turns irradiance into exit radiance is included, albedo is not: `alpha` 0 is an
/// opaque diffuse surface, 1 looks the same from both sides.
///
/// - `alpha`: in `0..=1`
/// - `out`: `[n]`, overwritten
///
/// Accuracy: 1e-14 against quadrature for n ≤ 20, asserted in this module.
///
/// # Errors
/// [`Error::Parameter`] if `alpha` is not in `0..=1`.
///
/// # Panics
/// If `out` is not `[n]`.
///
/// Source: [SLS05](sh_core#references) eq. 22, 23; the sum of two lobes of [RH01](sh_core#references) eq. 8.
///
/// ```
/// let mut lobe = [0.0; 3];
/// sh_fit::membrane_lobe(sh_core::Order::new(3)?, 0.5, &mut lobe)?;
/// assert!((lobe[0] - 1.5).abs() < 1e-15 && (lobe[1] - 1.0 / 3.0).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn membrane_lobe(order: Order, alpha: f64, out: &mut [f64]) -> Result<(), Error> {
    assert!(out.len() == order.get(), "out has {} elements, it needs {order}", out.len());
    if !(0.0..=1.0).contains(&alpha) {
        return Err(Error::Parameter { what: "transparency", given: alpha, accepted: "0..=1" });
    }
    diffuse_lobe(out);
    scale_by_side(alpha, out);
    Ok(())
}

/// The clamped cosine over π, as lobe coefficients.
fn diffuse_lobe(out: &mut [f64]) {
    clamped_cosine(out);
    lobe_from_zonal(out);
    out.iter_mut().for_each(|g| *g *= std::f64::consts::FRAC_1_PI);
}

/// Adds `α` times the lobe about the opposite axis, whose odd bands are negative.
fn scale_by_side(alpha: f64, lobe: &mut [f64]) {
    for (l, g) in lobe.iter_mut().enumerate() {
        *g *= if l % 2 == 0 { 1.0 + alpha } else { 1.0 - alpha };
    }
}

/// Membranes of many points, as one lobe each about the normal.
///
/// - `alphas`: `[P]`, or one for all points
/// - `normals`: `[P]`, unit length
///
/// # Errors
/// [`Error::Item`] names the first transparency that is not in `0..=1`.
///
/// # Panics
/// If there are neither as many transparencies as normals, nor one.
///
/// Source: [SLS05](sh_core#references) section 4.2.
pub fn membrane_lobes(order: Order, alphas: &[f32], normals: &[[f32; 3]]) -> Result<LobeSet, Error> {
    assert!(
        alphas.len() == 1 || alphas.len() == normals.len(),
        "{} transparencies for {} normals",
        alphas.len(),
        normals.len()
    );
    if let Some(item) = alphas.iter().position(|alpha| !(0.0..=1.0).contains(alpha)) {
        return Err(Error::Item { what: "transparency", item, given: alphas[item].into(), accepted: "0..=1" });
    }
    let mut opaque = vec![0.0; order.get()];
    diffuse_lobe(&mut opaque);
    let mut set = LobeSet::zeros(order, 1, 1, explicit_count(order, 1), normals.len());
    set.axes.copy_from_slice(normals);
    let lobes = set.explicit.iter_mut().zip(set.coeffs.chunks_exact_mut(order.get()));
    for ((explicit, coeffs), &alpha) in lobes.zip(alphas.iter().cycle()) {
        let mut lobe = opaque.clone();
        scale_by_side(alpha.into(), &mut lobe);
        coeffs.iter_mut().zip(&lobe).skip(1).for_each(|(to, from)| *to = *from as f32);
        // y_00 is the same everywhere.
        *explicit = (lobe[0] * 0.5 * std::f64::consts::FRAC_1_PI.sqrt()) as f32;
    }
    Ok(set)
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    use std::f64::consts::PI;

    use proptest::prelude::*;
    use sh_core::project_zonal;

    use super::*;

    fn lobe(n: usize, alpha: f64) -> Vec<f64> {
        let mut out = vec![f64::NAN; n];
        membrane_lobe(Order::new(n).unwrap(), alpha, &mut out).unwrap();
        out
    }

    #[test]
    fn bands_are_those_of_the_quadrature() {
        for n in [1, 2, 10, 20] {
            for alpha in [0.0, 0.3, 1.0] {
                let mut expected = vec![0.0; n];
                let g = |z: f64| if z >= 0.0 { z / PI } else { -alpha * z / PI };
                project_zonal(&[-1.0, 0.0, 1.0], 24, g, &mut expected);
                lobe_from_zonal(&mut expected);
                for (found, expected) in lobe(n, alpha).iter().zip(expected) {
                    assert!((found - expected).abs() < 1e-14, "{found} {expected}");
                }
            }
        }
    }

    /// Eq. 23 as it is printed.
    #[test]
    fn bands_are_those_of_the_paper() {
        let factorial = |k: usize| (1..=k).map(|k| k as f64).product::<f64>();
        let alpha = 0.4;
        for (l, found) in lobe(10, alpha).into_iter().enumerate() {
            let printed = match l {
                1 => 2.0 / 3.0 * (1.0 - alpha),
                l if l % 2 == 1 => 0.0,
                l => {
                    let sign = if l % 4 == 2 { 1.0 } else { -1.0 };
                    let shape = sign / ((l as f64 + 2.0) * (l as f64 - 1.0));
                    2.0 * (1.0 + alpha) * shape * factorial(l) / (2.0_f64.powi(l as i32) * factorial(l / 2).powi(2))
                }
            };
            assert!((found - printed).abs() < 1e-15, "band {l}: {found} {printed}");
        }
    }

    #[test]
    fn the_ends_are_an_opaque_surface_and_an_even_one() {
        let mut expected = [0.0; 8];
        clamped_cosine(&mut expected);
        lobe_from_zonal(&mut expected);
        assert!(lobe(8, 0.0).iter().zip(expected).all(|(a, b)| (a * PI - b).abs() < 1e-15));
        assert!(lobe(8, 1.0).iter().skip(1).step_by(2).all(|&odd| odd == 0.0));
    }

    #[test]
    fn transparencies_out_of_range_are_named() {
        let order = Order::new(3).unwrap();
        for alpha in [-0.01, 1.01, f64::NAN, f64::INFINITY] {
            let error = membrane_lobe(order, alpha, &mut [0.0; 3]).unwrap_err();
            assert!(error.to_string().starts_with(&format!("transparency is {alpha}")), "{error}");
            let error = membrane_lobes(order, &[0.5, alpha as f32], &[[0.0, 0.0, 1.0]; 2]).unwrap_err();
            assert!(error.to_string().starts_with("transparency 1 is"), "{error}");
        }
        assert_eq!(membrane_lobes(order, &[], &[]).unwrap().point_count(), 0);
    }

    proptest! {
        /// The set reconstructs the expansion of eq. 22 about each normal.
        #[test]
        fn sets_are_the_same_membranes(alphas in prop::collection::vec(0.0_f32..=1.0, 3), n in 1_usize..=10) {
            let normals = [[0.0, 0.0, 1.0], [0.48, -0.6, 0.64], [-1.0, 0.0, 0.0]];
            let order = Order::new(n).unwrap();
            let set = membrane_lobes(order, &alphas, &normals).unwrap();
            let mut found = vec![0.0; order.coeff_count()];
            for (point, (&alpha, normal)) in alphas.iter().zip(normals).enumerate() {
                let expected = lobe(n, alpha.into());
                set.reconstruct(point, 0, &mut found);
                let mut basis = vec![0.0; order.coeff_count()];
                sh_core::eval(order, normal.map(f64::from), &mut basis);
                for i in 0..n * n {
                    // f32 of a sum of three factors near 1.
                    prop_assert!((f64::from(found[i]) - expected[i.isqrt()] * basis[i]).abs() < 2e-6);
                }
            }
        }
    }

    #[test]
    fn one_transparency_serves_all_points() {
        let order = Order::new(4).unwrap();
        let normals = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]];
        assert_eq!(
            membrane_lobes(order, &[0.7], &normals).unwrap(),
            membrane_lobes(order, &[0.7; 2], &normals).unwrap()
        );
    }
}
