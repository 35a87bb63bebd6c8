//! Zonal functions against long references, quadrature and their laws, at ordinary and at extreme parameters.
#![cfg(feature = "alloc")]
#![expect(clippy::print_stdout, reason = "tests print what they measured")]

mod long;

use std::f64::consts::{FRAC_PI_2, PI};

use proptest::prelude::*;
use sh_core::{
    Order, Real, cap_kernel, clamped_cosine, clamped_cosine_power, convolve, dot, expand_lobe, expand_zonal,
    gaussian_kernel, ggx_kernel, lobe_value, phong_kernel, project_zonal, reconstruct, spherical_cap,
    spherical_gaussian, von_mises_fisher_kernel, zonal_value,
};

const N: usize = Order::MAX;

fn kernel<T: Real>(name: &str, parameter: f64, count: usize) -> Vec<T> {
    let (mut zonal, parameter) = (vec![T::from_f64(f64::NAN); count], T::from_f64(parameter));
    match name {
        "phong" => phong_kernel(parameter, &mut zonal),
        "cap" => cap_kernel(parameter, &mut zonal),
        "von_mises_fisher" => von_mises_fisher_kernel(parameter, &mut zonal),
        "ggx" => ggx_kernel(parameter, &mut zonal),
        "gaussian" => gaussian_kernel(parameter, &mut zonal),
        "clamped_cosine_power" => clamped_cosine_power(parameter, &mut zonal),
        "spherical_cap" => spherical_cap(parameter, &mut zonal),
        "spherical_gaussian" => spherical_gaussian(parameter, &mut zonal),
        _ => panic!("no kernel {name}"),
    }
    zonal
}

/// `√((2l+1)/(4π))`: the coefficients of the delta function.
fn delta(l: usize) -> f64 {
    ((2 * l + 1) as f64 / (4.0 * PI)).sqrt()
}

/// `(kernel, parameter, l, A_l)` to 17 digits, by mpmath; the script is beside the file.
fn long_reference() -> impl Iterator<Item = (&'static str, f64, usize, f64)> {
    include_str!("references/zonal_kernels.txt").lines().map(|line| {
        let fields: Vec<_> = line.split(' ').collect();
        let number = |i: usize| fields[i].parse::<f64>().expect("a number");
        (fields[0], number(1), number(2) as usize, number(3))
    })
}

#[test]
fn kernels_agree_with_the_long_reference() {
    /// Products of up to 512 factors, each wrong by two roundings: 2e-13 if they all add up, relative. Near 1 less.
    const RELATIVE: f64 = 2e-13;
    /// What the documentation states.
    const ABSOLUTE: f64 = 5e-15;
    for name in ["phong", "cap", "von_mises_fisher", "ggx"] {
        let (mut worst, mut worst_relative, mut worst_f32, mut compared) = (0.0_f64, 0.0_f64, 0.0_f64, 0);
        let mut given = (f64::NAN, vec![], vec![], vec![]);
        for (_, parameter, l, expected) in long_reference().filter(|line| line.0 == name) {
            if given.0 != parameter {
                let single = kernel::<f32>(name, parameter, N);
                // The parameter itself is rounded in f32: compare with the kernel of the rounded one.
                let of_rounded = kernel::<f64>(name, f64::from(parameter as f32), N);
                given = (parameter, kernel::<f64>(name, parameter, N), single, of_rounded);
            }
            let error = (given.1[l] / delta(l) - expected).abs();
            assert!(error < ABSOLUTE, "{name} {parameter}, band {l}: {error:e}");
            worst = worst.max(error);
            // Caps change sign from band to band, and above 1e-290 nothing is subnormal.
            if name != "cap" && expected.abs() > 1e-290 {
                worst_relative = worst_relative.max(error / expected.abs());
            }
            worst_f32 = worst_f32.max((f64::from(given.2[l]) - given.3[l]).abs() / delta(l));
            compared += 1;
        }
        println!("{name}: {compared} values, worst error {worst:e}, relative {worst_relative:e}; {worst_f32:e} in f32");
        assert!(compared >= 12 * 8);
        assert!(worst_relative < RELATIVE, "{name} {worst_relative:e}");
        // half a unit in the last place of 1
        assert!(worst_f32 < 6.1e-8, "{name} {worst_f32:e}");
    }
}

#[test]
fn kernels_are_the_projections_of_their_profiles() {
    let two_pi = 2.0 * PI;
    for parameter in [0.07, 0.4, 1.0, 1.3, 2.9, 17.5] {
        let p: f64 = parameter;
        let radius: f64 = p.min(PI);
        let alpha: f64 = p.min(1.0);
        let (a2, sinh) = (alpha * alpha, f64::sinh(p));
        type Profile<'a> = (&'a str, Vec<f64>, Box<dyn Fn(f64) -> f64 + 'a>);
        let whole = || vec![-1.0, 1.0];
        let profiles: Vec<Profile> = vec![
            ("phong", vec![0.0, 1.0], Box::new(move |u: f64| u.powf(p) * (p + 1.0) / two_pi)),
            ("clamped_cosine_power", vec![0.0, 1.0], Box::new(move |u: f64| u.powf(p))),
            ("cap", vec![radius.cos(), 1.0], Box::new(move |_| 1.0 / (two_pi * (1.0 - radius.cos())))),
            ("spherical_cap", vec![radius.cos(), 1.0], Box::new(|_| 1.0)),
            ("von_mises_fisher", whole(), Box::new(move |u: f64| p / (2.0 * two_pi * sinh) * (p * u).exp())),
            ("spherical_gaussian", whole(), Box::new(move |u: f64| (p * (u - 1.0)).exp())),
            // D(theta/2)/4 with D as printed, of the cosine of the half angle
            (
                "ggx",
                vec![-1.0, 0.9, 1.0],
                Box::new(move |u: f64| {
                    let cos2 = 0.5 * (1.0 + u);
                    let tan2 = (1.0 - cos2) / cos2;
                    a2 / (PI * cos2 * cos2 * (a2 + tan2) * (a2 + tan2)) / 4.0
                }),
            ),
        ];
        for (name, cuts, profile) in &profiles {
            let mut expected = [0.0_f64; 40];
            if cuts[0] == 0.0 {
                project_power(&**profile, &mut expected);
            } else {
                project_zonal(cuts, 150, profile, &mut expected);
            }
            for (l, (g, e)) in kernel::<f64>(name, parameter, 40).iter().zip(expected).enumerate() {
                assert!((g - e).abs() < 2e-13, "{name} {parameter}, band {l}: {g} {e}");
            }
        }
    }
}

/// The projection of a profile on `[0, 1]` that is not smooth at 0, by pieces that halve towards it.
fn project_power(profile: &dyn Fn(f64) -> f64, zonal: &mut [f64]) {
    let mut cuts: Vec<f64> = (0..60).rev().map(|k| 0.5_f64.powi(k)).collect();
    cuts.insert(0, 0.0);
    project_zonal(&cuts, 30, profile, zonal);
}

#[test]
fn values_hold_their_accuracy() {
    // A delta function has all bands at full size.
    let zonal: Vec<f64> = (0..N).map(delta).collect();
    let lobe = vec![1.0; N];
    let scale: f64 = (0..N).map(|l| delta(l) * delta(l)).sum();
    let mut worst = 0.0_f64;
    for theta in [0.0, 1e-9, 1e-5, 1e-3, 0.01, 0.1, 0.7, 1.5, FRAC_PI_2, 1.6, 2.5, 3.1, 3.13, PI] {
        let z = f64::cos(theta);
        let s = ((1.0 - z) * (1.0 + z)).sqrt();
        let y = long::basis(N, [s, 0.0, z]);
        let by_basis: f64 = zonal.iter().enumerate().map(|(l, g)| g * y[l * (l + 1)]).sum();
        let p = long::legendre(N, [0.0, 0.0, 1.0], [s, 0.0, z]);
        let by_legendre: f64 = p.iter().enumerate().map(|(l, p)| delta(l) * delta(l) * p).sum();
        for (value, expected) in [(zonal_value(&zonal, z), by_basis), (lobe_value(&lobe, z), by_legendre)] {
            worst = worst.max((value - expected).abs() / scale);
        }
    }
    println!("worst error of a value over the sum of sizes: {worst:e}");
    assert!(worst < 4e-15, "{worst:e}");
}

#[test]
fn kernels_are_finite_and_bounded_at_every_parameter() {
    let names = [
        "phong",
        "cap",
        "von_mises_fisher",
        "ggx",
        "gaussian",
        "clamped_cosine_power",
        "spherical_cap",
        "spherical_gaussian",
    ];
    let parameters = [
        0.0,
        5e-324,
        1e-300,
        1e-45,
        1e-12,
        1e-6,
        0.01,
        0.5,
        1.0,
        FRAC_PI_2,
        2.0,
        3.0,
        PI,
        3.2,
        50.0,
        511.0,
        1e3,
        1e5,
        262_143.9,
        1e6,
        1e8,
        1e15,
        1e38,
        1e300,
        f64::MAX,
        f64::INFINITY,
        f64::NAN,
        -1.0,
        -0.0,
        f64::NEG_INFINITY,
    ];
    for (name, parameter) in names.into_iter().flat_map(|name| parameters.map(|p| (name, p))) {
        for count in [0, 1, 2, 64, 65, N] {
            let (double, single) = (kernel::<f64>(name, parameter, count), kernel::<f32>(name, parameter, count));
            // Band 0 bounds the others of a function that is never negative.
            let bound = double.first().map_or(0.0, |g| g * (1.0 + 1e-14) / delta(0));
            for (l, (g, single)) in double.iter().zip(single).enumerate() {
                assert!(g.abs() <= bound * delta(l), "{name} {parameter} n = {count}, band {l}: {g}");
                assert!(single.is_finite(), "{name} {parameter} n = {count}, band {l}: {single}");
            }
            if count > 0 && ["phong", "cap", "von_mises_fisher", "ggx", "gaussian"].contains(&name) {
                assert!((double[0] / delta(0) - 1.0).abs() < 1e-15, "{name} {parameter} integrates to one");
            }
        }
    }
}

/// Bands do not depend on how many are asked for, though the way they are computed does.
#[test]
fn the_number_of_bands_does_not_matter() {
    for name in ["phong", "cap", "von_mises_fisher", "ggx", "gaussian"] {
        for parameter in [0.001, 0.0078, 0.02, 0.19, 0.4, 1.0, 5.0, 24.0, 25.0, 899.0, 900.0, 4095.0, 4225.0, 17e3] {
            let all = kernel::<f64>(name, parameter, N);
            for count in [1, 2, 5, 30, 64, 65, 128, 130] {
                let some = kernel::<f64>(name, parameter, count);
                let error = |(l, (a, b)): (usize, (&f64, &f64))| (a - b).abs() / delta(l);
                let worst = some.iter().zip(&all).enumerate().map(error).fold(0.0, f64::max);
                assert!(worst < 1e-14, "{name} {parameter}, n = {count}: {worst:e}");
            }
        }
    }
}

#[test]
fn limits_of_kernels_are_the_delta_function_and_the_constant() {
    let deltas = [
        ("phong", f64::INFINITY),
        ("phong", 1e300),
        ("cap", 0.0),
        ("cap", -1.0),
        ("cap", f64::NAN),
        ("von_mises_fisher", f64::INFINITY),
        ("von_mises_fisher", 1e300),
        ("ggx", 0.0),
        ("ggx", 1e-200),
        ("gaussian", 0.0),
        ("gaussian", f64::NAN),
    ];
    for (name, parameter) in deltas {
        for (l, g) in kernel::<f64>(name, parameter, N).iter().enumerate() {
            assert!((g / delta(l) - 1.0).abs() < 1e-14, "{name} {parameter}, band {l}: {g}");
        }
    }
    let constants = [
        ("cap", PI),
        ("cap", 9.0),
        ("spherical_cap", f64::INFINITY),
        ("von_mises_fisher", 0.0),
        ("von_mises_fisher", -3.0),
        ("spherical_gaussian", f64::NAN),
        ("spherical_gaussian", 1e-300),
        ("ggx", 1.0),
        ("ggx", 7.0),
        ("gaussian", f64::INFINITY),
        ("gaussian", 1e200),
    ];
    for (name, parameter) in constants {
        let zonal = kernel::<f64>(name, parameter, N);
        let size = if name.starts_with("spherical") { 4.0 * PI } else { 1.0 };
        assert!((zonal[0] / delta(0) / size - 1.0).abs() < 1e-15, "{name} {parameter}: {}", zonal[0]);
        assert!(zonal[1..].iter().all(|g| g.abs() < 1e-15), "{name} {parameter}");
    }
    for (name, parameter) in [("spherical_cap", 0.0), ("spherical_cap", -2.0), ("spherical_gaussian", f64::INFINITY)] {
        assert!(kernel::<f64>(name, parameter, N).iter().all(|&g| g == 0.0), "{name} {parameter}");
    }
}

#[test]
fn the_half_space_and_the_clamped_cosine_are_the_first_powers() {
    let mut cosine = [0.0_f64; 60];
    clamped_cosine(&mut cosine);
    assert_eq!(kernel::<f64>("clamped_cosine_power", 1.0, 60), cosine);
    let half_space = kernel::<f64>("clamped_cosine_power", 0.0, 60);
    for (a, b) in kernel::<f64>("spherical_cap", FRAC_PI_2, 60).iter().zip(half_space) {
        assert!((a - b).abs() < 1e-15);
    }
}

#[test]
fn a_known_share_of_the_ggx_lobe_is_beyond_the_horizon() {
    // Its product with the half space z > 0, integrated: 1/(1 + α²). The bands fall as exp(−2 l artanh α).
    let half_space = kernel::<f64>("clamped_cosine_power", 0.0, 400);
    for alpha in [0.06, 0.1, 0.5, 0.9] {
        let above = dot(&kernel::<f64>("ggx", alpha, 400), &half_space);
        assert!((above - 1.0 / (1.0 + alpha * alpha)).abs() < 1e-14, "{alpha}: {above}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// A cap and the cap of the rest, turned over, make the constant 1.
    #[test]
    fn caps_complete_each_other(radius in 0.0..PI) {
        let (a, b) = (kernel::<f64>("spherical_cap", radius, 100), kernel::<f64>("spherical_cap", PI - radius, 100));
        for (l, (a, b)) in a.iter().zip(b).enumerate() {
            let sum = if l % 2 == 0 { a + b } else { a - b };
            let expected = if l == 0 { (4.0 * PI).sqrt() } else { 0.0 };
            prop_assert!((sum - expected).abs() < 1e-14, "band {l}: {sum}");
        }
    }

    /// Gaussians convolve to Gaussians.
    #[test]
    fn variances_add(a in 0.0..2.0_f64, b in 0.0..2.0_f64) {
        let order = Order::new(12).expect("valid");
        let mut blurred = vec![0.0; 144];
        let axis = [0.36, 0.48, -0.8];
        expand_zonal(order, &kernel::<f64>("gaussian", a, 12), axis, &mut blurred);
        convolve(order, &kernel::<f64>("gaussian", b, 12), &mut blurred);
        let mut expected = vec![0.0; 144];
        expand_zonal(order, &kernel::<f64>("gaussian", a.hypot(b), 12), axis, &mut expected);
        prop_assert!(blurred.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14));
    }

    /// A zonal function has the value of its expansion.
    #[test]
    fn values_agree_with_expansions(z in -1.0..=1.0_f64, phi in 0.0..7.0_f64, coeffs in prop::collection::vec(-1.0..1.0_f64, 14)) {
        let (order, s) = (Order::new(14).expect("valid"), ((1.0 - z) * (1.0 + z)).sqrt());
        let (axis, direction) = ([s * phi.cos(), s * phi.sin(), z], [0.48, -0.6, 0.64]);
        let cosine = axis.iter().zip(direction).map(|(a, b)| a * b).sum();
        let (mut about_zonal, mut about_lobe) = (vec![0.0; 196], vec![0.0; 196]);
        expand_zonal(order, &coeffs, axis, &mut about_zonal);
        expand_lobe(order, &coeffs, axis, &mut about_lobe);
        prop_assert!((zonal_value(&coeffs, cosine) - reconstruct(order, &about_zonal, direction)).abs() < 1e-13);
        prop_assert!((lobe_value(&coeffs, cosine) - reconstruct(order, &about_lobe, direction)).abs() < 1e-13);
    }

    /// Sharper lobes have more in every band, and their squares obey Parseval.
    #[test]
    fn sharper_is_larger_in_every_band(k in 0.1..200.0_f64, alpha in 0.01..0.99_f64) {
        for (name, blunt, sharp) in [("von_mises_fisher", k, 1.2 * k), ("ggx", alpha, 0.8 * alpha), ("gaussian", alpha, 0.8 * alpha)] {
            let (blunt, sharp) = (kernel::<f64>(name, blunt, 30), kernel::<f64>(name, sharp, 30));
            prop_assert!(blunt.iter().zip(&sharp).skip(1).all(|(b, s)| 0.0 < *b && b < s), "{name}");
        }
        // ∫ exp(2k(z−1)) over the sphere
        let gaussian = kernel::<f64>("spherical_gaussian", k, 200);
        let expected = PI * (1.0 - (-4.0 * k).exp()) / k;
        prop_assert!((dot(&gaussian, &gaussian) / expected - 1.0).abs() < 1e-12);
    }
}

#[test]
#[should_panic(expected = "cuts [1.0, -1.0] do not grow within -1..=1")]
fn cuts_in_the_wrong_order_are_refused() {
    project_zonal(&[1.0, -1.0], 4, |z| z, &mut [0.0_f64; 3]);
}
