//! Windows, and the minimum of an expansion that they are chosen by.
#![cfg(feature = "alloc")]
#![expect(clippy::unwrap_used, reason = "tests")]

use std::f64::consts::PI;

use proptest::prelude::*;
use sh_core::{
    Minimum, Order, Quadrature, Window, dot, eval, expand_zonal, fibonacci, gaussian, hanning, lanczos, laplacian,
    laplacian_lambda, minimum, minimum_zonal, nonnegative_window, project_function, reconstruct, scale_bands,
};

fn order(n: usize) -> Order {
    Order::new(n).unwrap()
}

fn noise(count: usize, seed: f64) -> Vec<f64> {
    (0..count).map(|i| (1.0 + seed + 1.7 * i as f64 + 0.31 * (i * i) as f64).sin()).collect()
}

/// `Σ_(l>0) √((2l+1)/4π) |f_l|`, the scale of the guarantee.
fn swing(n: usize, coeffs: &[f64]) -> f64 {
    let sup = |band: std::ops::Range<usize>| dot(&coeffs[band.clone()], &coeffs[band]);
    order(n).bands().skip(1).map(|(l, band)| ((2 * l + 1) as f64 / (4.0 * PI) * sup(band)).sqrt()).sum()
}

fn unit([x, y, z]: [f64; 3]) -> [f64; 3] {
    let length = (x * x + y * y + z * z).sqrt();
    [x / length, y / length, z / length]
}

/// The value is taken where it is said to be, nothing on a grid is lower, and no neighbour is.
#[track_caller]
fn assert_is_minimum(n: usize, coeffs: &[f64], found: Minimum<f64>, grid: &[[f64; 3]]) {
    let scale = swing(n, coeffs);
    let value = reconstruct(order(n), coeffs, found.direction);
    assert!((value - found.value).abs() <= 1e-13 * scale, "n = {n}: {value} {found:?}");
    assert!((found.direction.iter().map(|d| d * d).sum::<f64>() - 1.0).abs() < 1e-14);
    let lowest = grid.iter().map(|&d| reconstruct(order(n), coeffs, d)).fold(f64::INFINITY, f64::min);
    assert!(found.value <= lowest + 1e-13 * scale, "n = {n}: {found:?}, the grid has {lowest}");
    // Refined: nothing near it is lower by more than rounding.
    for (d, step) in fibonacci(20).into_iter().flat_map(|d| [1e-2, 1e-4, 1e-6].map(|step| (d, step))) {
        let near = unit(std::array::from_fn(|i| found.direction[i] + step / n as f64 * d[i]));
        let value = reconstruct(order(n), coeffs, near);
        assert!(value >= found.value - 1e-13 * scale, "n = {n}: {found:?}, {value:e} at {near:?}");
    }
}

#[test]
fn minima_of_noise_are_below_every_grid() {
    for n in (1..=10).chain([16, 24]) {
        let grid = fibonacci(600 * n * n);
        for seed in 0..6 {
            let coeffs = noise(n * n, 10.0 * f64::from(seed));
            assert_is_minimum(n, &coeffs, minimum(order(n), &coeffs), &grid);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn minima_are_below_every_grid(n in 1..9_usize, coeffs in prop::collection::vec(-1.0..1.0_f64, 64)) {
        let coeffs = &coeffs[..n * n];
        assert_is_minimum(n, coeffs, minimum(order(n), coeffs), &fibonacci(300 * n * n));
    }

    #[test]
    fn windows_fade(n in 1..40_usize, strength in prop_oneof![Just(0.0), Just(f64::INFINITY), 1e-6..1e3_f64]) {
        for window in [Window::Hanning, Window::Lanczos, Window::Laplacian, Window::Gaussian] {
            let mut weights = vec![f64::NAN; n];
            window.weights(order(n), strength, &mut weights);
            prop_assert_eq!(weights[0], 1.0);
            prop_assert!(weights.windows(2).all(|pair| pair[1] <= pair[0] && pair[1] >= 0.0), "{:?} {:?}", window, weights);
            if strength == 0.0 {
                prop_assert!(weights.iter().all(|&w| w == 1.0), "{:?} {:?}", window, weights);
            } else if strength.is_infinite() {
                prop_assert!(weights[1..].iter().all(|&w| w == 0.0), "{:?} {:?}", window, weights);
            }
        }
    }
}

/// Deep and narrow: minus the sharpest peak that n bands can have.
#[test]
fn the_minimum_of_a_peak_is_its_height() {
    for n in [3, 6, 10, 20, 32] {
        for axis in fibonacci(12) {
            let mut coeffs = vec![0.0_f64; n * n];
            eval(order(n), axis, &mut coeffs);
            coeffs.iter_mut().for_each(|f| *f = -*f);
            let found = minimum(order(n), &coeffs);
            let height = (n * n) as f64 / (4.0 * PI);
            assert!((found.value + height).abs() < 1e-12 * height, "n = {n}: {found:?}");
            let along: f64 = found.direction.iter().zip(axis).map(|(a, b)| a * b).sum();
            assert!(along > 1.0 - 1e-14, "n = {n}: {found:?} {axis:?}");
        }
    }
}

/// Of two nearly equal minima the lower one is found, wherever both are.
#[test]
fn the_lower_of_two_minima_is_found() {
    for n in [4, 6, 10] {
        let directions = fibonacci(11);
        for (a, b) in directions.iter().flat_map(|a| directions[..5].iter().map(move |b| (*a, b.map(|b| -b)))) {
            let (mut coeffs, mut other) = (vec![0.0_f64; n * n], vec![0.0; n * n]);
            eval(order(n), a, &mut coeffs);
            eval(order(n), b, &mut other);
            coeffs.iter_mut().zip(&other).for_each(|(f, o)| *f = -*f - 1.0001 * o);
            let along = |found: [f64; 3], d: [f64; 3]| found.iter().zip(d).map(|(f, d)| f * d).sum::<f64>();
            let found = minimum(order(n), &coeffs);
            assert!(along(found.direction, b) > along(found.direction, a), "n = {n}: {a:?} {b:?} {found:?}");
        }
    }
}

/// About a tilted axis the minima of a zonal function are rings, found here in the plane and there in one dimension.
#[test]
fn rings_and_flats_are_no_obstacle() {
    for n in [3, 5, 6, 8] {
        for seed in 0..4 {
            let zonal = noise(n, f64::from(seed));
            let (value, _) = minimum_zonal(&zonal);
            let mut coeffs = vec![0.0_f64; n * n];
            expand_zonal(order(n), &zonal, [0.36, -0.48, 0.8], &mut coeffs);
            let found = minimum(order(n), &coeffs);
            assert!((found.value - value).abs() < 1e-13 * swing(n, &coeffs), "n = {n}: {found:?} {value}");
        }
    }
    // ((1 + a·s)/2)^(n−1) is nearly zero around −a: flat to 1e-6 over a tenth of the sphere and more.
    for n in [6, 10] {
        let axis = [0.36, -0.48, 0.8];
        let power = |s: [f64; 3]| (0.5 + 0.5 * s.iter().zip(axis).map(|(a, b)| a * b).sum::<f64>()).powi(n as i32 - 1);
        let mut coeffs = vec![0.0_f64; n * n];
        project_function(order(n), &Quadrature::new(2 * n), power, &mut coeffs);
        let found = minimum(order(n), &coeffs);
        assert!(found.value.abs() < 1e-6 * swing(n, &coeffs), "n = {n}: {found:?}");
    }
}

#[test]
fn minima_with_documented_answers() {
    let z = [0.0, 0.0, 1.0];
    let constant = minimum(order(1), &[-2.0_f64]);
    assert!((constant.value + 2.0 * (0.25 / PI).sqrt()).abs() < 1e-15);
    assert_eq!(constant.direction, z);
    for n in [1, 2, 3, 7] {
        assert_eq!(minimum(order(n), &vec![0.0_f64; n * n]), Minimum { value: 0.0, direction: z });
        for odd in [f64::NAN, f64::INFINITY] {
            let mut coeffs = noise(n * n, 0.0);
            coeffs[n * n - 1] = odd;
            let found = minimum(order(n), &coeffs);
            assert!(found.value.is_nan());
            assert_eq!(found.direction, z);
        }
    }
    // Tiny and huge coefficients.
    for scale in [1e-300, 1e-150, 1e140, 1e300] {
        let (plain, scaled) = (noise(25, 0.0), noise(25, 0.0).iter().map(|f| f * scale).collect::<Vec<_>>());
        let [plain, scaled] = [plain, scaled].map(|coeffs| minimum(order(5), &coeffs));
        assert!((scaled.value / scale - plain.value).abs() < 1e-13, "{scale}: {plain:?} {scaled:?}");
    }
    // A mean that dwarfs the rest takes nothing from the direction.
    let (mut coeffs, plain) = (noise(25, 0.0), minimum(order(5), &noise(25, 0.0)));
    coeffs[0] = 1e12;
    assert_eq!(minimum(order(5), &coeffs).direction, plain.direction);
    // In f32, the value of the f64 search.
    let coeffs: Vec<f32> = noise(36, 0.0).iter().map(|&f| f as f32).collect();
    let wide: Vec<f64> = coeffs.iter().map(|&f| f64::from(f)).collect();
    assert_eq!(minimum(order(6), &coeffs).value, minimum(order(6), &wide).value as f32);
}

#[test]
fn zonal_minima_are_below_every_sample() {
    for n in (1..=12).chain([20, 33, 64]) {
        for seed in 0..8 {
            let zonal = noise(n, 3.0 * f64::from(seed));
            let (value, z) = minimum_zonal(&zonal);
            let at = |z: f64| {
                // Bonnet's recurrence
                let (mut below, mut p, mut sum) = (0.0, 1.0, 0.0);
                for (l, g) in zonal.iter().enumerate() {
                    let l = l as f64;
                    sum += g * ((2.0 * l + 1.0) / (4.0 * PI)).sqrt() * p;
                    (below, p) = (p, ((2.0 * l + 1.0) * z * p - l * below) / (l + 1.0));
                }
                sum
            };
            let size: f64 =
                zonal.iter().enumerate().map(|(l, g)| g.abs() * ((2 * l + 1) as f64 / (4.0 * PI)).sqrt()).sum();
            assert!((at(z) - value).abs() < 1e-14 * size, "n = {n}: {value} {z}");
            let lowest = (0..=20_000).map(|i| at((PI * f64::from(i) / 20_000.0).cos())).fold(f64::INFINITY, f64::min);
            // Samples are 1.6e-4 apart: the nearest one is within (n · 8e-5)²/2 of the swing.
            assert!(
                value <= lowest + 1e-14 * size && value > lowest - 4e-9 * (n * n) as f64 * size,
                "n = {n}: {value} {lowest}"
            );
        }
    }
}

#[test]
fn zonal_minima_with_known_answers() {
    let y = |l: usize| ((2 * l + 1) as f64 / (4.0 * PI)).sqrt();
    // P_4 is lowest at z² = 3/7, at −3/7; the smaller z is returned.
    let (value, z) = minimum_zonal(&[0.0, 0.0, 0.0, 0.0, 1.0 / y(4)]);
    assert!((value + 3.0 / 7.0).abs() < 1e-15 && (z + (3.0_f64 / 7.0).sqrt()).abs() < 1e-8, "{value} {z}");
    // (z − 0.3)⁴: a root of the derivative that is threefold.
    let f = |z: f64| (z - 0.3).powi(4);
    let mut coeffs = [0.0_f64; 25];
    project_function(order(5), &Quadrature::new(10), |s| f(s[2]), &mut coeffs);
    let (value, z) = minimum_zonal(&[coeffs[0], coeffs[2], coeffs[6], coeffs[12], coeffs[20]]);
    assert!(value.abs() < 1e-14 && (z - 0.3).abs() < 1e-3, "{value} {z}");
    assert_eq!(minimum_zonal::<f64>(&[]), (0.0, 1.0));
    assert_eq!(minimum_zonal(&[0.0_f32, 1.0]).1, -1.0);
    assert!(minimum_zonal(&[0.0, f64::NAN]).0.is_nan());
}

#[test]
fn weights_are_their_formulas() {
    let mut weights = [9.0_f64; 6];
    lanczos(order(6), 4.0, &mut weights);
    let half = std::f64::consts::FRAC_1_SQRT_2;
    for (w, expected) in weights.iter().zip([1.0, half / (PI / 4.0), 2.0 / PI, half / (0.75 * PI), 0.0, 0.0]) {
        assert!((w - expected).abs() < 1e-15, "{weights:?}");
    }
    gaussian(order(6), 0.1, &mut weights);
    for (w, expected) in weights.iter().zip([0.0, 0.2, 0.6, 1.2, 2.0, 3.0]) {
        assert!((w.ln() + expected).abs() < 1e-14, "{weights:?}");
    }
    laplacian(order(6), 0.5, &mut weights);
    assert_eq!(weights, [1.0, 1.0 / 3.0, 1.0 / 19.0, 1.0 / 73.0, 1.0 / 201.0, 1.0 / 451.0]);
    let odd = |window: fn(Order, f64, &mut [f64]), parameter| {
        let mut weights = [9.0; 3];
        window(order(3), parameter, &mut weights);
        weights
    };
    for parameter in [0.0, -1.0, f64::NAN, f64::NEG_INFINITY] {
        assert_eq!(odd(lanczos, parameter), [1.0, 0.0, 0.0]);
        assert_eq!(odd(hanning, parameter), [1.0, 0.0, 0.0]);
        assert_eq!(odd(gaussian, parameter), [1.0; 3]);
        assert_eq!(odd(laplacian, parameter), [1.0; 3]);
    }
    assert_eq!(odd(lanczos, f64::INFINITY), [1.0; 3]);
    assert_eq!(odd(gaussian, f64::INFINITY), [1.0, 0.0, 0.0]);
    assert_eq!(odd(laplacian, f64::INFINITY), [1.0, 0.0, 0.0]);
}

/// The Laplacian window minimises `∫ (g − f)² + λ ∫ (Δg)²`: any other weight of any band is worse.
#[test]
fn the_laplacian_window_is_a_minimum() {
    let lambda = 0.037;
    let mut weights = [0.0; 6];
    laplacian(order(6), lambda, &mut weights);
    let cost = |l: f64, w: f64| (w - 1.0).powi(2) + lambda * (l * (l + 1.0) * w).powi(2);
    for (l, &w) in weights.iter().enumerate() {
        assert!([-1e-3, 1e-3].iter().all(|d| cost(l as f64, w + d) > cost(l as f64, w)), "band {l}");
    }
}

#[test]
fn lambda_leaves_the_fraction_asked_for() {
    let squared_laplacian = |coeffs: &[f64]| -> f64 {
        let band = |(l, band): (usize, std::ops::Range<usize>)| {
            ((l * (l + 1)) as f64).powi(2) * dot(&coeffs[band.clone()], &coeffs[band])
        };
        order(7).bands().map(band).sum()
    };
    for scale in [1.0, 1e-200, 1e200] {
        for left in [0.999_999, 0.9, 0.5, 0.1, 1e-3, 1e-12, 1e-30] {
            let mut coeffs = noise(49, 0.0);
            let before = squared_laplacian(&coeffs);
            let scaled: Vec<f64> = coeffs.iter().map(|f| f * scale).collect();
            let lambda = laplacian_lambda(order(7), &scaled, left);
            let mut weights = [0.0; 7];
            laplacian(order(7), lambda, &mut weights);
            scale_bands(order(7), &weights, &mut coeffs);
            let now = squared_laplacian(&coeffs) / before;
            assert!((now / left - 1.0).abs() < 1e-13, "{left}: {now}, λ = {lambda}");
        }
    }
    // One band: (1 + 36 λ)⁻² = left.
    let one = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0_f64];
    assert!((laplacian_lambda(order(3), &one, 0.25) - 1.0 / 36.0).abs() < 1e-16);
    for left in [1.0, 2.0, f64::NAN] {
        assert_eq!(laplacian_lambda(order(3), &one, left), 0.0);
    }
    for left in [f64::MIN_POSITIVE, 5e-324] {
        let lambda = laplacian_lambda(order(3), &one, left);
        assert!(lambda.is_finite() && lambda > 1e150, "{left}: {lambda}");
    }
    for left in [0.0, -1.0] {
        assert_eq!(laplacian_lambda(order(3), &one, left), f64::INFINITY);
    }
    assert_eq!(laplacian_lambda(order(2), &[1.0, 0.0, 0.0, 0.0_f64], 0.5), 0.0);
    assert_eq!(laplacian_lambda(order(2), &[1.0, 0.0, f64::NAN, 0.0], 0.5), 0.0);
}

const FAMILIES: [Window; 4] = [Window::Hanning, Window::Lanczos, Window::Laplacian, Window::Gaussian];

fn windowed_minimum(n: usize, coeffs: &[f64], window: Window, strength: f64) -> f64 {
    let (mut weights, mut windowed) = (vec![0.0; n], coeffs.to_vec());
    window.weights(order(n), strength, &mut weights);
    scale_bands(order(n), &weights, &mut windowed);
    minimum(order(n), &windowed).value
}

#[test]
fn nonnegative_windows_are_the_weakest() {
    for n in [3, 4, 6, 10] {
        // Two lights of unequal strength: not zonal.
        let (mut coeffs, mut other) = (vec![0.0; n * n], vec![0.0; n * n]);
        eval(order(n), [0.6, 0.0, 0.8], &mut coeffs);
        eval(order(n), [0.0, 0.8, -0.6], &mut other);
        coeffs.iter_mut().zip(&other).for_each(|(f, o)| *f += 0.4 * o);
        for window in FAMILIES {
            let mut weights = vec![0.0; n];
            let strength = nonnegative_window(order(n), &coeffs, window, &mut weights);
            let mut expected = vec![0.0; n];
            window.weights(order(n), strength, &mut expected);
            assert_eq!(weights, expected);
            // The guarantee of the search, and in fact rounding.
            assert!(windowed_minimum(n, &coeffs, window, strength) >= -1e-14, "{window:?}, n = {n}");
            for weaker in (0..40).map(|i| f64::from(i) / 40.0).chain([1.0 - 4e-6]) {
                let lowest = windowed_minimum(n, &coeffs, window, weaker * strength);
                assert!(lowest < 0.0, "{window:?}, n = {n}: {weaker} of {strength}");
            }
        }
    }
}

/// Band 1 against band 0 has a closed form: `f = 1 + 2z` needs a weight of 1/2.
#[test]
fn the_window_of_a_linear_light_is_known() {
    let coeffs = [(4.0 * PI).sqrt(), 0.0, 2.0 * (4.0 * PI / 3.0).sqrt(), 0.0];
    for (window, expected) in [
        (Window::Hanning, 0.5),
        (Window::Laplacian, 0.25),
        (Window::Gaussian, std::f64::consts::LN_2 / 2.0),
        // sin(πs)/(πs) = 1/2
        (Window::Lanczos, 0.603_354_606_8),
    ] {
        let mut weights = [0.0; 2];
        let strength = nonnegative_window(order(2), &coeffs, window, &mut weights);
        assert!((strength / expected - 1.0).abs() < 2e-6, "{window:?}: {strength}");
        assert!((weights[1] - 0.5).abs() < 2e-6, "{window:?}: {weights:?}");
    }
}

#[test]
fn windows_that_are_not_needed_or_cannot_help() {
    let mut weights = [9.0_f64; 3];
    let mut light = [0.0; 9];
    light[0] = 1.0;
    light[7] = 0.1;
    assert_eq!(nonnegative_window(order(3), &light, Window::Hanning, &mut weights), 0.0);
    assert_eq!(weights, [1.0; 3]);
    assert_eq!(nonnegative_window(order(3), &[0.0; 9], Window::Gaussian, &mut weights), 0.0);
    for (i, value) in [(0, -1.0), (0, 0.0), (4, f64::NAN), (0, f64::INFINITY)] {
        let mut light = light;
        light[i] = value;
        for window in FAMILIES {
            assert_eq!(nonnegative_window(order(3), &light, window, &mut weights), f64::INFINITY);
            assert_eq!(weights, [1.0, 0.0, 0.0]);
        }
    }
    // A mean that is almost nothing beside the rest.
    light = [1e-12, 1.0, 0.0, 0.5, 0.3, 0.0, 0.0, -1.0, 0.0];
    for window in FAMILIES {
        let strength = nonnegative_window(order(3), &light, window, &mut weights);
        assert!(
            strength.is_finite() && windowed_minimum(3, &light, window, strength) >= -1e-18,
            "{window:?}: {strength}"
        );
    }
}

/// With the Gaussian window the minimum never falls as the window gets stronger.
#[test]
fn the_minimum_rises_with_the_gaussian_window() {
    let coeffs = noise(49, 0.0);
    let minima: Vec<f64> =
        (0..60).map(|i| windowed_minimum(7, &coeffs, Window::Gaussian, 0.01 * f64::from(i))).collect();
    assert!(minima.windows(2).all(|pair| pair[1] >= pair[0] - 1e-13), "{minima:?}");
}
