//! Exponential and logarithm: the errors that the documentation states, laws, and extremes.
#![cfg(feature = "alloc")]
#![expect(clippy::unwrap_used, clippy::print_stdout, reason = "tests")]

mod blockers;

use std::f64::consts::PI;

use blockers::{ANGLE_STEP, Blockers, Logarithms, Random, about, cap};
use proptest::prelude::*;
use sh_core::{
    ExpOptions, ExpStart, Order, Quadrature, ShRotation, dot, eval, exp, fibonacci, log, project_function, reconstruct,
};

fn order(n: usize) -> Order {
    Order::new(n).unwrap()
}

/// Closer to the limit of many halvings than any error below.
const LIMIT: ExpOptions = ExpOptions { start: ExpStart::ProductSeries(8), longest: 0.25 };

fn exp_of(n: usize, options: &ExpOptions, f: &[f64]) -> Vec<f64> {
    let mut out = vec![f64::NAN; n * n];
    exp(order(n), options, f, &mut out);
    out
}

/// `∫ e^f(s) y_i(s)`, by a rule far beyond the order.
fn projected(n: usize, f: &[f64], function: impl Fn(f64) -> f64) -> Vec<f64> {
    let mut out = vec![0.0; n * n];
    project_function(order(n), &Quadrature::new(60), |s| function(reconstruct(order(n), f, s)), &mut out);
    out
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    let difference: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    (dot(&difference, &difference) / dot(b, b)).sqrt()
}

fn series(degree: u32, longest: f64) -> ExpOptions {
    ExpOptions { start: ExpStart::ProductSeries(degree), longest }
}

/// The projection of the directions that no blocker hides, by 5000 samples.
fn visibility(n: usize, blockers: &Blockers) -> Vec<f64> {
    let hides = |(axis, angle): &([f64; 3], usize), s: [f64; 3]| dot(axis, &s) > (*angle as f64 * ANGLE_STEP).cos();
    let (mut y, mut sum) = (vec![0.0; n * n], vec![0.0; n * n]);
    for s in fibonacci(5000).into_iter().filter(|&s| !blockers.0.iter().any(|blocker| hides(blocker, s))) {
        eval(order(n), s, &mut y);
        sum.iter_mut().zip(&y).for_each(|(sum, y)| *sum += y * 4.0 * PI / 5000.0);
    }
    sum
}

/// Mean errors over sets of blockers: against the limit, the projected exponential of the values, and the true visibility.
fn blocker_errors(n: usize, options: &ExpOptions) -> [f64; 3] {
    let logarithms = Logarithms::new(order(n), 0.02);
    let mut random = Random::new(99);
    let mut sums = [0.0; 3];
    let counts: Vec<usize> = [1, 2, 4, 8, 16].into_iter().flat_map(|count| [count; 12]).collect();
    for &count in &counts {
        let blockers = Blockers::random(count, &mut random);
        let f = blockers.logarithm(&logarithms);
        let found = exp_of(n, options, &f);
        let truths = [exp_of(n, &LIMIT, &f), projected(n, &f, f64::exp), visibility(n, &blockers)];
        sums.iter_mut().zip(truths).for_each(|(sum, truth)| *sum += distance(&found, &truth));
    }
    sums.map(|sum| sum / counts.len() as f64)
}

/// Mean errors for random functions of a length: against the limit, and the projected exponential of the values.
fn random_errors(n: usize, options: &ExpOptions, length: f64) -> [f64; 2] {
    let mut random = Random::new(5);
    let mut sums = [0.0; 2];
    for _ in 0..20 {
        let f: Vec<f64> = (0..n * n).map(|_| random.next() - 0.5).collect();
        let scale = length / dot(&f[1..], &f[1..]).sqrt();
        let f: Vec<f64> = f.iter().map(|f| f * scale).collect();
        let found = exp_of(n, options, &f);
        let truths = [exp_of(n, &LIMIT, &f), projected(n, &f, f64::exp)];
        sums.iter_mut().zip(truths).for_each(|(sum, truth)| *sum += distance(&found, &truth));
    }
    sums.map(|sum| sum / 20.0)
}

/// Stated errors have two digits, or four places.
#[track_caller]
fn assert_stated(what: &str, found: f64, stated: f64) {
    println!("{what}: {found:.5}, stated {stated}");
    assert!((found - stated).abs() <= 0.05 * stated + 5e-5, "{what}: {found:e}, stated {stated:e}");
}

/// For each order: blockers against the limit, the values, and the truth; random vectors of length 2 against the first two.
#[test]
fn errors_are_those_of_the_documentation() {
    let tables = [
        (
            ExpOptions::linear(),
            [
                (3, [0.0527, 0.0511, 0.0752, 0.0937, 0.0995]),
                (4, [0.094, 0.091, 0.100, 0.147, 0.160]),
                (6, [0.1798, 0.1752, 0.1765, 0.2024, 0.2209]),
            ],
        ),
        (
            ExpOptions { start: ExpStart::OptimalLinear, longest: 1.0 },
            [
                (3, [0.0224, 0.0248, 0.0590, 0.0580, 0.0703]),
                (4, [0.036, 0.045, 0.063, 0.100, 0.116]),
                (6, [0.0662, 0.1015, 0.0802, 0.1463, 0.1661]),
            ],
        ),
        (
            ExpOptions::hybrid(),
            [
                (3, [0.0119, 0.0159, 0.0552, 0.0332, 0.0475]),
                (4, [0.020, 0.033, 0.056, 0.061, 0.078]),
                (6, [0.0448, 0.0942, 0.0670, 0.0999, 0.1207]),
            ],
        ),
        (
            series(4, f64::INFINITY),
            [
                (3, [0.0015, 0.0102, 0.0534, 0.0012, 0.0203]),
                (4, [0.0175, 0.036, 0.063, 0.0026, 0.025]),
                (6, [0.8195, 0.8059, 0.8358, 0.0028, 0.0276]),
            ],
        ),
        (
            series(8, f64::INFINITY),
            [
                (3, [0.0002, 0.0090, 0.0534, 0.0003, 0.0192]),
                (4, [0.0012, 0.022, 0.054, 0.0005, 0.023]),
                (6, [0.7692, 0.7522, 0.8001, 0.0006, 0.0254]),
            ],
        ),
        (
            ExpOptions::balanced(),
            [
                (3, [0.0033, 0.0121, 0.0541, 0.0103, 0.0289]),
                (4, [0.0057, 0.027, 0.056, 0.0152, 0.037]),
                (6, [0.0062, 0.0816, 0.0586, 0.0162, 0.0401]),
            ],
        ),
        (
            ExpOptions::accurate(),
            [
                (3, [0.0000, 0.0091, 0.0534, 0.0001, 0.0193]),
                (4, [0.0001, 0.022, 0.054, 0.0002, 0.023]),
                (6, [0.0001, 0.0776, 0.0562, 0.0002, 0.0256]),
            ],
        ),
    ];
    for (options, rows) in tables {
        for (n, stated) in rows {
            let found = blocker_errors(n, &options).into_iter().chain(random_errors(n, &options, 2.0));
            for (column, (found, stated)) in found.zip(stated).enumerate() {
                assert_stated(&format!("n = {n}, {options:?}, column {column}"), found, stated);
            }
        }
    }
}

/// For each order the error of the logarithm here, and of the projected logarithm of the values.
#[test]
fn logarithms_of_caps_come_back() {
    let table = [
        (10.0_f64, [[0.0000, 0.0000], [0.0000, 0.0000], [0.0000, 0.0001]]),
        (20.0, [[0.0000, 0.0002], [0.0000, 0.0009], [0.0004, 0.0069]]),
        (30.0, [[0.0000, 0.0023], [0.0000, 0.0112], [0.0011, 0.0312]]),
        (45.0, [[0.0001, 0.0379], [0.0017, 0.0512], [0.0364, 0.0414]]),
        (60.0, [[0.0032, 0.0724], [0.0486, 0.0514], [0.0224, 0.0847]]),
        (80.0, [[0.0739, 0.0755], [0.0522, 0.1079], [0.0492, 0.0587]]),
    ];
    for (angle, row) in table {
        for (n, stated) in [3, 4, 6].into_iter().zip(row) {
            let visibility = about(order(n), &cap(order(n), angle.to_radians()), [0.36, 0.48, 0.8]);
            let mut logarithm = vec![0.0; n * n];
            log(order(n), &visibility, 0.01, &mut logarithm);
            let by_values = projected(n, &visibility, |value| value.max(0.01).ln());
            for (f, stated) in [logarithm, by_values].iter().zip(stated) {
                let found = distance(&exp_of(n, &ExpOptions::accurate(), f), &visibility);
                assert_stated(&format!("{angle} degrees, n = {n}"), found, stated);
            }
        }
    }
}

/// More halvings of the series come to a limit; the error of the linear start falls with the length it is halved to.
#[test]
fn the_knobs_turn_the_right_way() {
    let n = 4;
    let mut random = Random::new(3);
    let f: Vec<f64> = (0..n * n).map(|_| random.next() - 0.6).collect();
    let limit = exp_of(n, &series(12, 0.05), &f);
    for degree in 1..6 {
        let errors = [2.0, 1.0, 0.5, 0.25].map(|longest| distance(&exp_of(n, &series(degree, longest), &f), &limit));
        // A halving divides the error of degree d by about 2^d.
        assert!(errors.is_sorted_by(|a, b| *b < 0.8 * a), "{degree}: {errors:?}");
    }
    let errors = [1.0, 0.5, 0.1, 1e-3, 1e-6]
        .map(|longest| distance(&exp_of(n, &ExpOptions { start: ExpStart::OptimalLinear, longest }, &f), &limit));
    assert!(errors.is_sorted_by(|a, b| b < a) && errors[4] < 2e-6, "{errors:?}");
    // Without a degree nothing is left but the first coefficient.
    let constant = exp_of(n, &series(0, f64::INFINITY), &f);
    assert!(constant[1..].iter().all(|&f| f == 0.0));
    assert!((constant[0] - (4.0 * PI).sqrt() * (f[0] / (4.0 * PI).sqrt()).exp()).abs() < 1e-14);
}

const ALL: [ExpOptions; 5] = [
    ExpOptions::linear(),
    ExpOptions::hybrid(),
    ExpOptions::balanced(),
    ExpOptions::accurate(),
    ExpOptions { start: ExpStart::ProductSeries(3), longest: f64::INFINITY },
];

#[test]
fn constants_are_exact() {
    let one = (4.0 * PI).sqrt();
    for (n, options) in [1, 2, 3, 5, 6, 7, 12].into_iter().flat_map(|n| ALL.map(|options| (n, options))) {
        for value in [0.0, -0.7, 3.0, -40.0] {
            let mut f = vec![0.0; n * n];
            f[0] = value * one;
            let found = exp_of(n, &options, &f);
            assert!((found[0] / one / f64::exp(value) - 1.0).abs() < 1e-14, "{n} {options:?} {value}: {}", found[0]);
            assert!(found[1..].iter().all(|&f| f == 0.0));
            let mut back = vec![f64::NAN; n * n];
            log(order(n), &found, 1e-300, &mut back);
            let error = back[1..].iter().fold((back[0] - value * one).abs(), |worst, f| worst.max(f.abs()));
            assert!(error < 1e-13 * value.abs().max(1.0), "{n} {value}: {error:e}");
        }
    }
}

#[test]
fn extremes_have_an_answer() {
    for (n, options) in [1, 2, 4, 6, 7].into_iter().flat_map(|n| ALL.map(|options| (n, options))) {
        let vector = |first: f32, others: f32| {
            let mut f = vec![others; n * n];
            f[0] = first;
            f
        };
        let exp_of = |f: &[f32]| {
            let mut out = vec![f32::NAN; n * n];
            exp(order(n), &options, f, &mut out);
            out
        };
        // Dark: everything underflows, from finite and from infinite logarithms.
        for dark in [vector(-1e30, 0.3), vector(f32::NEG_INFINITY, 0.3), vector(-3e38, 0.0), vector(-1e35, 1e20)] {
            assert!(exp_of(&dark).iter().all(|&f| f == 0.0), "{n} {options:?}");
        }
        // Long and dark together: no infinity times zero.
        assert!(exp_of(&vector(-1e4, 100.0)).iter().all(|f| !f.is_nan()), "{n} {options:?}");
        // Too bright.
        for bright in [vector(1e5, 0.0), vector(f32::INFINITY, 0.1)] {
            let out = exp_of(&bright);
            assert!(out[0] == f32::INFINITY && out[1..].iter().all(|&f| f == 0.0), "{n} {options:?}: {out:?}");
        }
        assert!(exp_of(&vector(0.0, 1e30)).iter().all(|f| !f.is_nan()), "{n} {options:?}");
        assert!(exp_of(&vector(f32::NAN, 0.0)).iter().all(|f| f.is_nan()));
        if n > 1 {
            assert!(exp_of(&vector(0.0, f32::INFINITY)).iter().all(|f| f.is_nan()));
        }
    }
    // Limits that make no sense end.
    for longest in [0.0, -1.0, f64::NAN] {
        assert!(exp_of(4, &series(2, longest), &[0.1; 16]).iter().all(|f| f.is_finite()));
    }
}

#[test]
fn logarithms_of_extremes_have_an_answer() {
    for n in [1, 3, 5] {
        let log_of = |f: &[f32], floor: f32| {
            let mut out = vec![f32::NAN; n * n];
            log(order(n), f, floor, &mut out);
            out
        };
        let one = (4.0 * std::f32::consts::PI).sqrt();
        let dark = log_of(&vec![0.0; n * n], 1e-3);
        assert!((dark[0] / one - 1e-3_f32.ln()).abs() < 1e-5 && dark[1..].iter().all(|f| f.abs() < 1e-6));
        for floor in [0.0, -1.0, f32::NAN] {
            assert!(log_of(&vec![0.0; n * n], floor).iter().all(|f| f.is_finite()));
        }
        assert!(log_of(&vec![1e30; n * n], 1e-3).iter().all(|f| f.is_finite()));
        assert!(log_of(&vec![f32::NAN; n * n], 1e-3).iter().all(|f| f.is_nan()));
        assert!(log_of(&vec![f32::INFINITY; n * n], 1e-3).iter().all(|f| f.is_nan()));
    }
}

#[test]
fn both_precisions_agree() {
    let mut random = Random::new(8);
    for (n, options) in [2, 4, 6, 8].into_iter().flat_map(|n| ALL.map(|options| (n, options))) {
        let f: Vec<f32> = (0..n * n).map(|_| random.next() as f32 - 0.7).collect();
        let mut out = vec![0.0_f32; n * n];
        exp(order(n), &options, &f, &mut out);
        let wide: Vec<f64> = f.iter().map(|&f| f64::from(f)).collect();
        let found: Vec<f64> = out.iter().map(|&f| f64::from(f)).collect();
        // Each of up to six squarings doubles the relative error of some 1e-7.
        assert!(distance(&found, &exp_of(n, &options, &wide)) < 6.4e-6, "{n} {options:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, failure_persistence: None, ..ProptestConfig::default() })]

    /// Where the floor is below the function's eigenvalues, the logarithm of the limit is its inverse.
    #[test]
    fn exponential_and_logarithm_are_inverse(n in 1..7_usize, f in prop::collection::vec(-0.2..0.2_f64, 36)) {
        let mut visibility = f[..n * n].to_vec();
        visibility[0] += 3.0;
        let (mut logarithm, options) = (vec![0.0; n * n], series(10, 0.05));
        log(order(n), &visibility, 1e-6, &mut logarithm);
        // What is left is that M of the logarithm is not the logarithm of M when products are cut off.
        prop_assert!(distance(&exp_of(n, &options, &logarithm), &visibility) < 1e-3);
    }

    #[test]
    fn the_exponential_of_a_sum_with_a_constant_is_a_multiple(n in 1..7_usize, f in prop::collection::vec(-0.5..0.5_f64, 36), c in -3.0..3.0_f64) {
        let f = &f[..n * n];
        let mut raised = f.to_vec();
        raised[0] += c * (4.0 * PI).sqrt();
        for options in ALL {
            let expected: Vec<f64> = exp_of(n, &options, f).iter().map(|e| e * c.exp()).collect();
            prop_assert!(distance(&exp_of(n, &options, &raised), &expected) < 1e-13);
        }
    }

    /// Products commute with rotation, and lengths do not change: so does everything that is made of them.
    #[test]
    fn exponential_and_logarithm_commute_with_rotation(n in 1..7_usize, f in prop::collection::vec(-0.3..0.3_f64, 36), angle in 0.0..6.3_f64) {
        // About the axis (0.6, 0.0, 0.8), by Rodrigues' formula.
        let ([x, z], (s, c)) = ([0.6, 0.8], angle.sin_cos());
        let (t, matrix) = (1.0 - c, |t: f64| [
            [c + t * x * x, -s * z, t * x * z],
            [s * z, c, -s * x],
            [t * x * z, s * x, c + t * z * z],
        ]);
        let turn = ShRotation::new(order(n), matrix(t));
        let rotated = |f: &[f64]| {
            let mut out = vec![0.0; n * n];
            turn.apply(f, &mut out);
            out
        };
        let f = &f[..n * n];
        for options in ALL {
            prop_assert!(distance(&exp_of(n, &options, &rotated(f)), &rotated(&exp_of(n, &options, f))) < 1e-13);
        }
        let log_of = |f: &[f64]| {
            let (mut f, mut out) = (f.to_vec(), vec![0.0; n * n]);
            f[0] += 2.0;
            log(order(n), &f, 0.1, &mut out);
            out
        };
        // Eigenvalues next to the floor change by the rounding errors of the matrix over 0.1.
        prop_assert!(distance(&log_of(&rotated(f)), &rotated(&log_of(f))) < 1e-12);
    }
}
