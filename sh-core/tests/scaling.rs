//! Scaling matrices: against integrals made in other ways, their identities, and their extremes.
#![cfg(feature = "alloc")]
#![expect(clippy::unwrap_used, reason = "tests")]

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use proptest::prelude::*;
use sh_core::{
    Error, Order, Preserve, Quadrature, ScalingMatrix, ShRotation, Tau, eval, index, project_function, reconstruct,
};

const EXTREMES: [f64; 9] = [1e-6, 1e-3, 0.1, 0.7, 1.0, 1.4, 10.0, 1e3, 1e6];

fn order(n: usize) -> Order {
    Order::new(n).unwrap()
}

fn matrix(n: usize, source: usize, tau: Tau, preserve: Preserve) -> ScalingMatrix<f64> {
    ScalingMatrix::new(order(n), order(source), tau, preserve).unwrap()
}

fn dense(matrix: &ScalingMatrix<f64>) -> Vec<f64> {
    let mut out = vec![f64::NAN; matrix.order().coeff_count() * matrix.source_order().coeff_count()];
    matrix.to_dense(&mut out);
    out
}

#[track_caller]
fn assert_close(a: &[f64], b: &[f64], tolerance: f64, what: &str) {
    assert_eq!(a.len(), b.len());
    for (i, (a, b)) in a.iter().zip(b).enumerate() {
        assert!((a - b).abs() <= tolerance, "{what}: entry {i}: {a} {b}, {:e} apart", (a - b).abs());
    }
}

/// Nodes and weights of the tanh-sinh rule, as distances from one end of an interval of the given length, up to its middle.
fn half_of_tanh_sinh(length: f64) -> impl Iterator<Item = (f64, f64)> {
    const STEP: f64 = 1.0 / 512.0;
    (0..3200).map(move |i| {
        let t = STEP * f64::from(i);
        let s = FRAC_PI_2 * t.sinh();
        let distance = length / (1.0 + (2.0 * s).exp());
        let weight = length * 0.5 * STEP * FRAC_PI_2 * t.cosh() / s.cosh().powi(2);
        (distance, if i == 0 { 0.5 * weight } else { weight })
    })
}

/// The matrix by the tanh-sinh rule in θ, between the ends and the cone's fixed point, where fronts are. `tau` is given the
/// sine and cosine of θ and returns those of τ, and τ′.
fn by_tanh_sinh(
    [n, source]: [usize; 2],
    ends: &[f64],
    preserve: Preserve,
    tau: impl Fn([f64; 2]) -> ([f64; 2], f64),
) -> Vec<f64> {
    let (rows, columns) = (n * n, source * source);
    let mut out = vec![0.0; rows * columns];
    let (mut to, mut from) = (vec![0.0; rows], vec![0.0; columns]);
    let sides =
        ends.windows(2).flat_map(|pair| [(pair[0], 1.0, pair[1] - pair[0]), (pair[1], -1.0, pair[1] - pair[0])]);
    for (end, sign, length) in sides {
        let (sin_end, cos_end) = if end == PI { (0.0, -1.0) } else { end.sin_cos() };
        for (distance, weight) in half_of_tanh_sinh(length) {
            let (sd, cd) = (sign * distance).sin_cos();
            let [s, c] = [sin_end * cd + cos_end * sd, cos_end * cd - sin_end * sd];
            let ([from_s, from_c], slope) = tau([s, c]);
            let eta = match preserve {
                Preserve::Value => s,
                Preserve::Energy => from_s * slope,
            };
            eval(order(n), [s, 0.0, c], &mut to);
            eval(order(source), [from_s, 0.0, from_c], &mut from);
            for m in 0..n.min(source) {
                for (l, k) in (m..n).flat_map(|l| (m..source).map(move |k| (l, k))) {
                    let [i, j] = [index(l, m as isize), index(k, m as isize)];
                    let around = if m == 0 { 2.0 * PI } else { PI };
                    let part = weight * eta * around * to[i] * from[j];
                    out[i * columns + j] += part;
                    if m > 0 {
                        out[(i - 2 * m) * columns + j - 2 * m] += part;
                    }
                }
            }
        }
    }
    out
}

/// The cone in the form of the paper, sines and cosines of `arctan(k tanθ / (1 + (1−k) tanθ cot α))` with its branch.
fn cone(k: f64, alpha: f64) -> impl Fn([f64; 2]) -> ([f64; 2], f64) {
    move |[s, c]| {
        let [a, b] = [k * s, c + (1.0 - k) / alpha.tan() * s];
        let length2 = a * a + b * b;
        ([a / length2.sqrt(), b / length2.sqrt()], k / length2)
    }
}

#[test]
fn cones_equal_another_rule_at_every_k() {
    for alpha in [FRAC_PI_4, 0.2, FRAC_PI_2, 2.5] {
        for k in EXTREMES {
            // All energy is in fronts as wide as k or 1/k, where the other rule has the rounding of cosθ, times 1/k: it has
            // no digits to compare with there. The identity with the transpose has no such limit.
            let kinds = if (0.01..100.0).contains(&k) { 2 } else { 1 };
            for preserve in [Preserve::Value, Preserve::Energy].into_iter().take(kinds) {
                let built = dense(&matrix(6, 8, Tau::Cone { k, alpha }, preserve));
                let expected = by_tanh_sinh([6, 8], &[0.0, PI - alpha, PI], preserve, cone(k, alpha));
                assert_close(&built, &expected, 1e-12, &format!("k = {k:e}, α = {alpha}, {preserve:?}"));
            }
        }
    }
}

#[test]
fn high_orders_equal_another_rule() {
    for (k, n, source) in [(1e-6, 32, 10), (0.3, 32, 32), (1e6, 10, 32), (1.3, 1, 32)] {
        let built = dense(&matrix(n, source, Tau::cone(k), Preserve::Value));
        let expected = by_tanh_sinh([n, source], &[0.0, 0.75 * PI, PI], Preserve::Value, cone(k, FRAC_PI_4));
        assert_close(&built, &expected, 1e-12, &format!("k = {k:e}, n = {n}, {source}"));
    }
}

#[test]
fn mid_range_equals_another_rule_up_to_the_ends() {
    // t from the chord theorem in half angles: the point seen, by the law of sines: sin(τ − θ) = −k sinθ.
    for k in [-1.0, -0.999_999, -0.5, 0.0, 1e-6, 0.3, 0.9, 0.999, 1.0 - 1e-12, 1.0] {
        let tau = |[s, c]: [f64; 2]| {
            let turn: f64 = -k * s;
            // cos(τ − θ) = √(1 − k² sin²θ)
            let root = ((1.0 - k) * (1.0 + k) + k * k * c * c).sqrt();
            // τ′ = 1 − k cosθ / √
            let slope = if root > 0.0 { 1.0 - k * c / root } else { 1.0 };
            ([s * root + c * turn, c * root - s * turn], slope)
        };
        for preserve in [Preserve::Value, Preserve::Energy] {
            let built = dense(&matrix(8, 6, Tau::MidRange { k }, preserve));
            let expected = by_tanh_sinh([8, 6], &[0.0, FRAC_PI_2, PI], preserve, tau);
            assert_close(&built, &expected, 1e-12, &format!("k = {k}, {preserve:?}"));
        }
    }
}

#[test]
fn spheres_equal_another_rule_at_every_k() {
    for k in EXTREMES.into_iter().chain([1.0 - 1e-9, 1.0 + 1e-9]) {
        // In front only, up to the angle where k sinθ = 1.
        let end = if k > 1.0 { (1.0 / k).asin() } else { FRAC_PI_2 };
        let (cut_s, cut_c) = end.sin_cos();
        let tau = |[s, c]: [f64; 2]| {
            // 1 − k² sin²θ from the distance to the cut, where k > 1: k² (cut_s² − s²) = k² (c − cut_c)(c + cut_c)
            let squared = if k > 1.0 { k * k * (c - cut_c) * (c + cut_c) } else { 1.0 - (k * s).powi(2) };
            let root = squared.max(0.0).sqrt();
            ([(k * s).min(k * cut_s), root], if root > 0.0 { k * c / root } else { 0.0 })
        };
        let built = dense(&matrix(5, 5, Tau::Sphere { k }, Preserve::Value));
        let expected = by_tanh_sinh([5, 5], &[0.0, end], Preserve::Value, tau);
        // Near the cut cos τ is a square root: the rounding of its argument, 1e-16 of 1, is 1e-8 of it in a part 1e-8 wide.
        assert_close(&built, &expected, 1e-12, &format!("k = {k}"));
    }
}

/// `F_r(τ(θ), φ)` in space, projected by an exact rule for polynomials of high degree.
fn projected(n: usize, coeffs: &[f64], source: usize, seen: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<f64> {
    let mut out = vec![0.0; n * n];
    let scaled = |s: [f64; 3]| reconstruct(order(source), coeffs, seen(s));
    project_function(order(n), &Quadrature::new(240), scaled, &mut out);
    out
}

fn light(count: usize) -> Vec<f64> {
    (0..count).map(|i| (1.0 + 1.7 * i as f64).sin()).collect()
}

/// A light of `n′` bands is scaled exactly by the `[n², n′²]` matrix.
#[test]
fn rectangular_matrices_are_exact_on_band_limited_lights() {
    for (n, source) in [(4, 8), (6, 6), (8, 3), (1, 5), (5, 1)] {
        let captured = light(source * source);
        let k = 0.4;
        // The point of the sphere of light that is hit by the ray from (0, 0, k): geometry in space.
        let mid_range = |d: [f64; 3]| {
            let along = k * d[2];
            let t = -along + (along * along + 1.0 - k * k).sqrt();
            [t * d[0], t * d[1], k + t * d[2]]
        };
        // sin θ and cos θ turned into those of atan(k tanθ / (1 + (1−k) tanθ)), the paper's cone, with k' = 1.5.
        let cone = |d: [f64; 3]| {
            let theta = d[0].hypot(d[1]).atan2(d[2]);
            let angle = (1.5 * theta.tan() / (1.0 + theta.tan() - 1.5 * theta.tan())).atan();
            let tau = if angle < 0.0 { angle + PI } else { angle };
            let radius = d[0].hypot(d[1]);
            [tau.sin() * d[0] / radius, tau.sin() * d[1] / radius, tau.cos()]
        };
        let mut out = vec![f64::NAN; n * n];
        matrix(n, source, Tau::MidRange { k }, Preserve::Value).apply(&captured, &mut out);
        assert_close(&out, &projected(n, &captured, source, mid_range), 1e-12, "mid-range");
        matrix(n, source, Tau::cone(1.5), Preserve::Value).apply(&captured, &mut out);
        // The tip of the cone is a bend at the pole, where the rule loses its digits: 1e-8 here, as degree⁻⁴.
        assert_close(&out, &projected(n, &captured, source, cone), 3e-8, "cone");
    }
}

/// Capturing more bands than are wanted: how much nearer to the true scaled light, [WXZ06]'s printed use being n′ = n.
#[test]
fn capturing_more_bands_is_more_accurate() {
    // A smooth light of 16 bands that fall off, scaled down to 4.
    let (n, all) = (4, 16);
    let captured: Vec<f64> = order(all)
        .bands()
        .flat_map(|(l, band)| band.map(move |i| (1.0 + 1.7 * i as f64).sin() * 2.0_f64.powi(-(l as i32))))
        .collect();
    let scaled = |source: usize| {
        let mut out = vec![0.0; n * n];
        matrix(n, source, Tau::cone(1.3), Preserve::Value).apply(&captured[..source * source], &mut out);
        out
    };
    let exact = scaled(all);
    let error = |source| scaled(source).iter().zip(&exact).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    let gains = [error(4) / error(6), error(4) / error(8)];
    assert!(gains[0] > 7.0 && gains[1] > 40.0, "{gains:?}");
}

#[test]
fn any_function_is_integrated_in_theta() {
    for k in [0.05, 0.5, 1.0, 3.0, 20.0] {
        for preserve in [Preserve::Value, Preserve::Energy] {
            let tau = Tau::cone(k);
            let slope = |theta: f64| {
                let b = theta.cos() + (1.0 - k) * theta.sin();
                k / (k * k * theta.sin().powi(2) + b * b)
            };
            let function = |theta| [tau.angle(theta).unwrap(), slope(theta)];
            let built = ScalingMatrix::<f64>::from_function(order(6), order(5), preserve, function);
            assert_close(&dense(&built), &dense(&matrix(6, 5, tau, preserve)), 1e-12, &format!("k = {k}"));
        }
    }
    // A jump: τ = 0 before 1 rad and π beyond. y_00 of the result from y_10: √3 · ½ ∫ sign sinθ dθ = √3 cos... = −√3 cos 1.
    let jump = |theta| [if theta < 1.0 { 0.0 } else { PI }, 0.0];
    let built = dense(&ScalingMatrix::<f64>::from_function(order(3), order(2), Preserve::Value, jump));
    assert!((built[2] + 3.0_f64.sqrt() * 1.0_f64.cos()).abs() < 1e-12, "{}", built[2]);
}

#[test]
fn scaling_by_one_is_the_identity() {
    for n in (1..=10).chain([17, 32]) {
        for (tau, preserve) in [
            (Tau::cone(1.0), Preserve::Value),
            (Tau::cone(1.0), Preserve::Energy),
            (Tau::Cone { k: 1.0, alpha: 0.1 }, Preserve::Value),
            (Tau::MidRange { k: 0.0 }, Preserve::Value),
            (Tau::MidRange { k: 0.0 }, Preserve::Energy),
        ] {
            for (i, j, entry) in matrix(n, n, tau, preserve).entries() {
                let expected = f64::from(u8::from(i == j));
                assert!((entry - expected).abs() < 1e-13, "n = {n}, {tau:?}, ({i}, {j}): {entry}");
            }
        }
    }
}

#[test]
fn constants_and_energy_are_preserved() {
    for n in 1..=10 {
        for tau in EXTREMES.map(Tau::cone).into_iter().chain([-1.0, -0.9, 0.5, 1.0].map(|k| Tau::MidRange { k })) {
            // The first column is what a constant becomes, the first row is the integral.
            let value = dense(&matrix(n, n, tau, Preserve::Value));
            let energy = dense(&matrix(n, n, tau, Preserve::Energy));
            for i in 0..n * n {
                let expected = f64::from(u8::from(i == 0));
                assert!((value[i * n * n] - expected).abs() < 1e-13, "n = {n}, {tau:?}: {}", value[i * n * n]);
                assert!((energy[i] - expected).abs() < 1e-13, "n = {n}, {tau:?}: {}", energy[i]);
            }
        }
    }
}

#[test]
fn energy_at_k_is_the_transpose_of_value_at_its_inverse() {
    for k in EXTREMES {
        for (at, inverse) in [(Tau::cone(k), Tau::cone(1.0 / k)), (Tau::Sphere { k }, Tau::Sphere { k: 1.0 / k })] {
            let energy = matrix(7, 4, at, Preserve::Energy);
            let value = dense(&matrix(4, 7, inverse, Preserve::Value));
            for (i, j, entry) in energy.entries() {
                let expected = value[j * 49 + i];
                assert!((entry - expected).abs() < 1e-13, "{at:?}: ({i}, {j}): {entry} {expected}");
            }
        }
    }
}

#[test]
fn mid_range_mirrors() {
    for k in [0.1, 0.5, 0.99, 1.0] {
        for preserve in [Preserve::Value, Preserve::Energy] {
            let (ahead, behind) =
                (matrix(6, 9, Tau::MidRange { k }, preserve), matrix(6, 9, Tau::MidRange { k: -k }, preserve));
            for ((i, j, a), (_, _, b)) in ahead.entries().zip(behind.entries()) {
                // Both have the same m, so (−1)^(l+m) (−1)^(l′+m) = (−1)^(l+l′).
                let parity = if (i.isqrt() + j.isqrt()) % 2 == 0 { 1.0 } else { -1.0 };
                assert!((a - parity * b).abs() < 1e-13, "k = {k}: ({i}, {j}): {a} {b}");
            }
        }
    }
}

/// `dM/dk` at the centre is the gradient of a light at distance 1: `−sinθ ∂/∂θ`, whose entries are known.
#[test]
fn the_derivative_of_mid_range_is_the_gradient() {
    let n = 8;
    let at = |k| dense(&matrix(n, n, Tau::MidRange { k }, Preserve::Value));
    // The central difference of eighth order.
    let h = 0.02;
    let factors = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
    let mut derivative = vec![0.0; n.pow(4)];
    for (i, factor) in factors.into_iter().enumerate() {
        let step = h * (i + 1) as f64;
        for ((d, plus), minus) in derivative.iter_mut().zip(at(step)).zip(at(-step)) {
            *d += factor * (plus - minus) / h;
        }
    }
    // sinθ dp_l/dθ = l c_(l+1) p_(l+1) − (l+1) c_l p_(l−1), c_l = √((l² − m²)/(4l² − 1))
    let c = |l: usize, m: isize| (((l * l) as f64 - (m * m) as f64) / (4 * l * l - 1) as f64).sqrt();
    let mut expected = vec![0.0; n.pow(4)];
    for l in 0..n {
        for m in -(l as isize)..=l as isize {
            if l + 1 < n {
                expected[index(l + 1, m) * n * n + index(l, m)] = -(l as f64) * c(l + 1, m);
            }
            if m.unsigned_abs() < l {
                expected[index(l - 1, m) * n * n + index(l, m)] = (l + 1) as f64 * c(l, m);
            }
        }
    }
    // Rounding: 1e-14/h. The rule's error is h⁸/630 times the ninth derivative.
    assert_close(&derivative, &expected, 2e-9, "gradient");
}

/// Nonzero entries only at m = m′, as many as the paper says, and equal for ±m.
#[test]
fn the_pattern_is_that_of_the_paper() {
    for n in 1..=12 {
        let matrix = matrix(n, n, Tau::cone(1.7), Preserve::Value);
        let entries: Vec<_> = matrix.entries().collect();
        assert_eq!(entries.len(), n * (2 * n * n + 1) / 3);
        let dense = dense(&matrix);
        let m = |i: usize| i as isize - (i.isqrt() * (i.isqrt() + 1)) as isize;
        for (i, j) in (0..n * n).flat_map(|i| (0..n * n).map(move |j| (i, j))) {
            let listed = entries.iter().filter(|entry| (entry.0, entry.1) == (i, j)).count();
            assert_eq!(listed, usize::from(m(i) == m(j)), "({i}, {j})");
            let mirrored = |i: usize| index(i.isqrt(), -m(i));
            if m(i) == m(j) {
                assert_eq!(dense[i * n * n + j], dense[mirrored(i) * n * n + mirrored(j)]);
            } else {
                assert_eq!(dense[i * n * n + j], 0.0);
            }
        }
    }
    assert_eq!([4, 6].map(|n| matrix(n, n, Tau::cone(2.0), Preserve::Value).entries().count()), [44, 146]);
}

#[test]
fn angles_compose_increase_and_stay_fixed() {
    for (a, b) in EXTREMES.into_iter().flat_map(|a| EXTREMES.map(|b| (a, b))) {
        for theta in (1..100).map(|i| PI * f64::from(i) / 100.0) {
            let [inner, outer] = [Tau::cone(b).angle(theta), Tau::cone(a * b).angle(theta)].map(Option::unwrap);
            let twice = Tau::cone(a).angle(inner).unwrap();
            // Roundings of angles, of 4e-16, are enlarged by the slopes.
            let slope =
                cone(a * b, FRAC_PI_4)([theta.sin(), theta.cos()]).1 + cone(a, FRAC_PI_4)([inner.sin(), inner.cos()]).1;
            assert!((twice - outer).abs() < 1e-15 * (1.0 + slope), "{a:e} {b:e} {theta}: {twice} {outer}");
        }
    }
    for alpha in [0.05, FRAC_PI_4, 1.5, 3.0] {
        for k in EXTREMES {
            let tau = Tau::Cone { k, alpha };
            for (theta, fixed) in [(0.0, 0.0), (PI - alpha, PI - alpha), (PI, PI)] {
                let slope = k.max(1.0 / k);
                assert!((tau.angle(theta).unwrap() - fixed).abs() < 1e-13 + 1e-15 * slope, "{tau:?} at {theta}");
            }
        }
    }
    let functions = EXTREMES.into_iter().flat_map(|k| [Tau::cone(k), Tau::Cone { k, alpha: 0.05 }, Tau::Sphere { k }]);
    let mid_range = [-1.0, -1.0 + 1e-12, -0.5, 0.0, 1e-6, 0.9, 1.0 - 1e-12, 1.0].map(|k| Tau::MidRange { k });
    for tau in functions.chain(mid_range) {
        let mut before = 0.0;
        for theta in (0..=20_000).map(|i| PI * f64::from(i) / 20_000.0) {
            let Some(angle) = tau.angle(theta) else { continue };
            assert!(angle.is_finite() && (0.0..=PI).contains(&angle), "{tau:?} at {theta}: {angle}");
            // Rounding where it is flat.
            assert!(angle >= before - 4e-16, "{tau:?} falls at {theta}: {before} {angle}");
            before = angle;
        }
    }
}

#[test]
fn sphere_keeps_the_front() {
    assert_eq!(Tau::Sphere { k: 0.5 }.angle(2.0), None);
    assert_eq!(Tau::Sphere { k: 2.0 }.angle(0.6), None);
    assert!((Tau::Sphere { k: 2.0 }.angle(0.5).unwrap() - (2.0 * 0.5_f64.sin()).asin()).abs() < 1e-15);
    // A constant becomes the front cap: its integral is 2π (1 − cos asin(1/k)).
    for k in [0.5, 1.0, 2.0, 100.0] {
        let kept = dense(&matrix(1, 1, Tau::Sphere { k }, Preserve::Value))[0];
        let cosine = if k > 1.0 { (1.0_f64 - 1.0 / (k * k)).sqrt() } else { 0.0 };
        assert!((kept - 0.5 * (1.0 - cosine)).abs() < 1e-14, "k = {k}: {kept}");
    }
}

#[test]
fn f32_is_f64_rounded() {
    for n in [4, 6, 10] {
        let exact = matrix(n, n, Tau::cone(1.6), Preserve::Value);
        let single = ScalingMatrix::<f32>::new(order(n), order(n), Tau::cone(1.6), Preserve::Value).unwrap();
        assert!(exact.entries().zip(single.entries()).all(|(a, b)| a.2 as f32 == b.2));
        // Coefficients of unit length.
        let coeffs = light(n * n);
        let length = coeffs.iter().map(|f| f * f).sum::<f64>().sqrt();
        let unit: Vec<f64> = coeffs.iter().map(|f| f / length).collect();
        let (mut out, mut rounded) = (vec![0.0; n * n], vec![0.0_f32; n * n]);
        exact.apply(&unit, &mut out);
        single.apply(&unit.iter().map(|&f| f as f32).collect::<Vec<_>>(), &mut rounded);
        assert_close(&out, &rounded.iter().map(|&f| f64::from(f)).collect::<Vec<_>>(), 2e-7, "f32");
    }
}

#[test]
fn every_order_and_extreme_is_finite_in_f32() {
    for n in 1..=10 {
        for tau in EXTREMES.into_iter().flat_map(|k| [Tau::cone(k), Tau::Sphere { k }, Tau::MidRange { k: k.min(1.0) }])
        {
            for preserve in [Preserve::Value, Preserve::Energy] {
                let matrix = ScalingMatrix::<f32>::new(order(n), order(n), tau, preserve).unwrap();
                assert!(matrix.entries().all(|entry| entry.2.is_finite()), "n = {n}, {tau:?}");
            }
        }
    }
}

#[test]
fn meaningless_numbers_are_refused() {
    let new = |tau| ScalingMatrix::<f64>::new(order(2), order(2), tau, Preserve::Value);
    for k in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(new(Tau::cone(k)), Err(Error::Scaling { what: "k", .. })));
        assert!(matches!(new(Tau::Sphere { k }), Err(Error::Scaling { what: "k", .. })));
    }
    for alpha in [0.0, PI, f64::NAN, -0.1] {
        assert!(matches!(new(Tau::Cone { k: 1.0, alpha }), Err(Error::Scaling { what: "alpha", .. })));
    }
    let message = new(Tau::MidRange { k: 1.5 }).unwrap_err().to_string();
    assert_eq!(message, "k of the mid-range scaling is 1.5, it must be in -1..=1");
    assert!(new(Tau::MidRange { k: f64::NAN }).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    /// Scaling about an axis is what scaling about +z is after turning the axis there by any rotation.
    #[test]
    fn any_axis(n in 1..7_usize, source in 1..7_usize, z in -1.0..=1.0_f64, phi in 0.0..7.0_f64, twist in 0.0..7.0_f64, k in 0.2..5.0_f64) {
        let radius = ((1.0 - z) * (1.0 + z)).sqrt();
        let axis = [radius * phi.cos(), radius * phi.sin(), z];
        let captured = light(source * source);
        let scaling = matrix(n, source, Tau::cone(k), Preserve::Value);
        let mut about = vec![0.0; n * n];
        scaling.apply_about(axis.map(|a| 3.0 * a), &captured, &mut about);
        // Rows: two directions across the axis, turned by `twist`, and the axis.
        let across = [z * phi.cos(), z * phi.sin(), -radius];
        let other = [-phi.sin(), phi.cos(), 0.0];
        let (c, s) = (twist.cos(), twist.sin());
        let rows = [
            std::array::from_fn(|i| c * across[i] + s * other[i]),
            std::array::from_fn(|i| c * other[i] - s * across[i]),
            axis,
        ];
        let columns = std::array::from_fn(|i| std::array::from_fn(|j| rows[j][i]));
        let (mut turned, mut scaled, mut back) = (vec![0.0; source * source], vec![0.0; n * n], vec![0.0; n * n]);
        ShRotation::new(order(source), rows).apply(&captured, &mut turned);
        scaling.apply(&turned, &mut scaled);
        ShRotation::new(order(n), columns).apply(&scaled, &mut back);
        for (a, b) in about.iter().zip(&back) {
            prop_assert!((a - b).abs() < 1e-13, "{a} {b}");
        }
    }
}

#[test]
fn axes_without_a_direction_are_z() {
    let scaling = matrix(3, 3, Tau::cone(2.0), Preserve::Value);
    let captured = light(9);
    let (mut expected, mut out) = (vec![0.0; 9], vec![0.0; 9]);
    scaling.apply(&captured, &mut expected);
    for axis in [[0.0; 3], [f64::NAN, 0.0, 1.0], [f64::INFINITY, 0.0, 0.0], [0.0, 0.0, 1e-300], [0.0, 0.0, 1e300]] {
        scaling.apply_about(axis, &captured, &mut out);
        assert_close(&out, &expected, 1e-15, "+z");
    }
}
