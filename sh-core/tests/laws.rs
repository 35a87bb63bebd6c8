//! Laws of the basis and of what is built on it.
#![cfg(feature = "alloc")]
#![expect(clippy::unwrap_used, reason = "tests")]

use proptest::prelude::*;
use sh_core::{
    Basis, LatLong, Order, Quadrature, clamped_cosine, convolve, dot, eval, expand_zonal, hanning, index,
    project_function, project_lat_long, reconstruct, rotate, scale_bands,
};

/// All pairs of functions: the Gram matrix is the identity.
#[test]
fn orthonormal_at_order_10_in_f64() {
    let n = 10;
    let order = Order::new(n).unwrap();
    let mut gram = vec![0.0; n.pow(4)];
    let mut y = vec![0.0; n * n];
    for &(direction, weight) in Quadrature::new(2 * (n - 1)).points() {
        eval(order, direction, &mut y);
        for (row, &a) in gram.chunks_exact_mut(n * n).zip(&y) {
            row.iter_mut().zip(&y).for_each(|(g, b)| *g += weight * a * b);
        }
    }
    for (i, row) in gram.chunks_exact(n * n).enumerate() {
        for (j, &g) in row.iter().enumerate() {
            let expected = f64::from(u8::from(i == j));
            assert!((g - expected).abs() < 1e-13, "⟨y_{i}, y_{j}⟩ = {g}");
        }
    }
}

/// Some functions against all: the corners of the table, and a few from inside.
#[test]
fn orthonormal_at_order_65_in_f32() {
    let n = 65;
    let basis = Basis::<f32>::new(Order::new(n).unwrap());
    let l = n - 1;
    let chosen = [
        0,
        index(1, -1),
        index(10, 7),
        index(33, 0),
        index(40, -40),
        index(l, -64),
        index(l, 0),
        index(l, 1),
        index(l, 64),
    ];
    let mut gram = vec![0.0_f64; chosen.len() * n * n];
    let mut y = vec![0.0; n * n];
    for &(direction, weight) in Quadrature::new(2 * l).points() {
        basis.eval(direction.map(|d| d as f32), &mut y);
        for (row, &i) in gram.chunks_exact_mut(n * n).zip(&chosen) {
            row.iter_mut().zip(&y).for_each(|(g, &b)| *g += weight * f64::from(y[i]) * f64::from(b));
        }
    }
    for (row, &i) in gram.chunks_exact(n * n).zip(&chosen) {
        for (j, &g) in row.iter().enumerate() {
            let expected = f64::from(u8::from(i == j));
            // Each factor is wrong by at most 5e-6, and the mean of |y| is at most √(1/4π): 2 · 4π · 5e-6 · 0.28 at worst.
            assert!((g - expected).abs() < 3.6e-5, "⟨y_{i}, y_{j}⟩ = {g}");
        }
    }
}

/// A unit direction, with the poles and the axes among them.
fn direction() -> impl Strategy<Value = [f64; 3]> {
    let anywhere = (-1.0..=1.0_f64, 0.0..std::f64::consts::TAU).prop_map(|(z, phi)| {
        let radius = ((1.0 - z) * (1.0 + z)).sqrt();
        [radius * phi.cos(), radius * phi.sin(), z]
    });
    let axis = prop::sample::select(vec![[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]);
    prop_oneof![4 => anywhere, 1 => axis]
}

fn coeffs(order: Order) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(-1.0..1.0_f64, order.coeff_count())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn finite_in_finite_out(n in 1..80_usize, x in -1e3..1e3_f32, y in -1e3..1e3_f32, z in -1e3..1e3_f32) {
        let order = Order::new(n).unwrap();
        let length = (x * x + y * y + z * z).sqrt();
        let unit = if length > 0.0 { [x / length, y / length, z / length] } else { [0.0; 3] };
        let mut out = vec![f32::NAN; n * n];
        eval(order, unit, &mut out);
        prop_assert!(out.iter().all(|y| y.is_finite()));
        let mut zonal = vec![0.0; n];
        clamped_cosine(&mut zonal);
        convolve(order, &zonal, &mut out);
        prop_assert!(reconstruct(order, &out, unit).is_finite());
    }

    #[test]
    fn finite_maps_give_finite_lights(n in 1..12_usize, width in 1..20_usize, height in 1..10_usize, exponent in -45..36_i32) {
        let (order, map) = (Order::new(n).unwrap(), LatLong { width, height });
        let pixels = vec![[10.0_f32.powi(exponent), 0.0, -(10.0_f32.powi(exponent))]; map.texel_count()];
        let mut light = vec![f32::NAN; 3 * n * n];
        project_lat_long(order, map, &pixels, &mut light);
        prop_assert!(light.iter().all(|f| f.is_finite()));
    }

    /// Expanding about an axis and looking along it: Σ √((2l+1)/4π) g_l, whatever the axis.
    #[test]
    fn a_lobe_is_the_same_about_every_axis(n in 1..40_usize, axis in direction(), other in direction()) {
        let order = Order::new(n).unwrap();
        let zonal: Vec<f64> = (0..n).map(|l| 1.0 / (1 + l * l) as f64).collect();
        let mut about = [vec![0.0; n * n], vec![0.0; n * n]];
        expand_zonal(order, &zonal, axis, &mut about[0]);
        expand_zonal(order, &zonal, other, &mut about[1]);
        let peak = |coeffs: &[f64], axis| reconstruct(order, coeffs, axis);
        prop_assert!((peak(&about[0], axis) - peak(&about[1], other)).abs() < 1e-12);
        // and each sees the other from the same angle
        prop_assert!((peak(&about[0], other) - peak(&about[1], axis)).abs() < 1e-12);
        prop_assert!((dot(&about[0], &about[0]) - dot(&about[1], &about[1])).abs() < 1e-12);
    }

    /// Projecting the values of an expansion gives it back.
    #[test]
    fn projection_inverts_reconstruction(n in 1..14_usize, seed in coeffs(Order::new(14).unwrap())) {
        let order = Order::new(n).unwrap();
        let expected = &seed[..n * n];
        let mut projected = vec![0.0; n * n];
        let quadrature = Quadrature::new(2 * (n - 1));
        project_function(order, &quadrature, |direction| reconstruct(order, expected, direction), &mut projected);
        for (p, e) in projected.iter().zip(expected) {
            prop_assert!((p - e).abs() < 1e-12, "{p} {e}");
        }
    }

    /// Smoothing kernels act on bands, so their order does not matter.
    #[test]
    fn convolution_and_windows_commute(f in coeffs(Order::new(8).unwrap()), width in 0.5..20.0_f64) {
        let order = Order::new(8).unwrap();
        let (mut kernel, mut window) = ([0.0; 8], [0.0; 8]);
        clamped_cosine(&mut kernel);
        hanning(order, width, &mut window);
        let (mut a, mut b) = (f.clone(), f);
        convolve(order, &kernel, &mut a);
        scale_bands(order, &window, &mut a);
        scale_bands(order, &window, &mut b);
        convolve(order, &kernel, &mut b);
        prop_assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-14));
    }

    /// Windows and convolution act on whole bands, and so do rotations.
    #[test]
    fn rotations_commute_with_windows_and_convolution(
        f in coeffs(Order::new(7).unwrap()), axis in direction(), width in 0.5..20.0_f64
    ) {
        let order = Order::new(7).unwrap();
        // Half a turn about the axis.
        let matrix = std::array::from_fn(|r| std::array::from_fn(|c| 2.0 * axis[r] * axis[c] - f64::from(u8::from(r == c))));
        let (mut kernel, mut window) = ([0.0; 7], [0.0; 7]);
        clamped_cosine(&mut kernel);
        hanning(order, width, &mut window);
        let smooth = |f: &mut [f64]| {
            scale_bands(order, &window, f);
            convolve(order, &kernel, f);
        };
        let (mut turned_first, mut smoothed, mut smoothed_first) = ([0.0; 49], f.clone(), [0.0; 49]);
        rotate(order, matrix, &f, &mut turned_first);
        smooth(&mut turned_first);
        smooth(&mut smoothed);
        rotate(order, matrix, &smoothed, &mut smoothed_first);
        // The accuracy of the rotation, times the kernel's largest factor.
        prop_assert!(turned_first.iter().zip(&smoothed_first).all(|(a, b)| (a - b).abs() < 1e-14 * 4.0));
    }

    /// Parseval: the integral of the square is the sum of the squares.
    #[test]
    fn power_is_kept(f in coeffs(Order::new(9).unwrap())) {
        let order = Order::new(9).unwrap();
        let square = |(s, w): &([f64; 3], f64)| w * reconstruct(order, &f, *s).powi(2);
        let integral: f64 = Quadrature::new(16).points().iter().map(square).sum();
        prop_assert!((integral - dot(&f, &f)).abs() < 1e-12, "{integral}");
    }
}
