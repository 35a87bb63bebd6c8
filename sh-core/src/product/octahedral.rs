//! Cubature rules with the symmetry of the cube, and the basis at their points, made by the compiler.
//!
//! A product of two expansions and a basis function of order `n` has degree `3(n − 1)`. Points come in antipodal pairs, on
//! which a function of even bands has equal values and one of odd bands opposite ones. So one point of each pair is enough,
//! and only even degrees must be integrated exactly:
//!
//! | order | degree | pairs of points |
//! |---|---|---|
//! | 3 | 6 | 13 |
//! | 4 | 8 | 19 |
//! | 5, 6 | 14 | 43 |
//!
//! The free coordinates and the weights solve the moment equations of the invariant polynomials; the script
//! `tests/references/octahedral_rules.py` finds them by Newton's method in 40 digits. They are the rules of
//! V. I. Lebedev, *Values of the nodes and weights of ninth to seventeenth order Gauss-Markov quadrature formulae invariant
//! under the octahedron group with inversion*, USSR Computational Mathematics and Mathematical Physics 15(1), 1975.

/// Rows of tables begin at cache lines, so that no register is loaded from two of them.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Row<T, const WIDTH: usize>(pub(super) [T; WIDTH]);

/// Room for the even bands of six: 1 + 5 + 9.
pub(super) const EVEN: usize = 16;
/// Room for the odd bands of six: 3 + 7 + 11.
pub(super) const ODD: usize = 32;

/// The basis at one point of each pair. `N2` functions, `PAIRS` pairs of points, `ROOM` of them with padding.
///
/// Padding is zero. Rows are in pieces of 16 numbers: the widest register.
#[derive(Clone, Debug)]
pub struct Samples<T, const N2: usize, const PAIRS: usize, const ROOM: usize> {
    /// `y_i` at the points.
    pub(super) values: [Row<T, ROOM>; N2],
    /// For each point `2 w y_i` of the even bands, one after the other: the weight stands for the pair.
    pub(super) even: [Row<T, EVEN>; PAIRS],
    /// The same for the odd bands.
    pub(super) odd: [Row<T, ODD>; PAIRS],
}

/// Orders 3, 4, and 5 with 6.
type Samples3<T> = Samples<T, 9, 13, 16>;
type Samples4<T> = Samples<T, 16, 19, 32>;
type Samples6<T> = Samples<T, 36, 43, 48>;

/// A scalar for which the tables were made.
pub trait Sampled: Sized + 'static {
    /// For order 3.
    const ORDER_3: &'static Samples3<Self>;
    /// For order 4.
    const ORDER_4: &'static Samples4<Self>;
    /// For orders 5 and 6.
    const ORDER_6: &'static Samples6<Self>;
}

const SAMPLES_3: Samples3<f64> =
    samples(&points([Orbit::Faces(1.0 / 21.0), Orbit::Edges(4.0 / 105.0), Orbit::Corners(9.0 / 280.0)]));
const SAMPLES_4: Samples4<f64> = samples(&points([
    Orbit::Faces(1.0 / 105.0),
    Orbit::Corners(9.0 / 280.0),
    Orbit::Sides(1.0 / 35.0, 0.459_700_843_380_983_1),
]));
const SAMPLES_6: Samples6<f64> = samples(&points([
    Orbit::Faces(0.011_544_011_544_011_544),
    Orbit::Corners(0.011_943_909_085_856_282),
    Orbit::Diagonals(0.011_110_555_710_603_403, 0.369_602_846_454_150_25),
    Orbit::Diagonals(0.011_876_501_294_537_142, 0.694_354_006_602_666_4),
    Orbit::Sides(0.011_812_303_746_904_475, 0.374_243_039_090_341_2),
]));

impl Sampled for f64 {
    const ORDER_3: &'static Samples3<Self> = &SAMPLES_3;
    const ORDER_4: &'static Samples4<Self> = &SAMPLES_4;
    const ORDER_6: &'static Samples6<Self> = &SAMPLES_6;
}

impl Sampled for f32 {
    const ORDER_3: &'static Samples3<Self> = &rounded(&SAMPLES_3);
    const ORDER_4: &'static Samples4<Self> = &rounded(&SAMPLES_4);
    const ORDER_6: &'static Samples6<Self> = &rounded(&SAMPLES_6);
}

/// Points that the symmetries of the cube turn into one another, with their weight (of a total of 1) and free coordinate `p`.
#[derive(Clone, Copy)]
enum Orbit {
    /// The 6 of (1, 0, 0).
    Faces(f64),
    /// The 12 of (1, 1, 0)/√2.
    Edges(f64),
    /// The 8 of (1, 1, 1)/√3.
    Corners(f64),
    /// The 24 of (p, p, √(1 − 2p²)).
    Diagonals(f64, f64),
    /// The 24 of (p, √(1 − p²), 0).
    Sides(f64, f64),
}

/// A point and the weight of its orbit.
type Point = ([f64; 3], f64);

/// One point of each pair. The orbits must have `2 PAIRS` points.
const fn points<const PAIRS: usize, const ORBITS: usize>(orbits: [Orbit; ORBITS]) -> [Point; PAIRS] {
    let mut points = [([0.0; 3], 0.0); PAIRS];
    let (mut count, mut orbit) = (0, 0);
    while orbit < ORBITS {
        let ([p, q, r], weight) = match orbits[orbit] {
            Orbit::Faces(weight) => ([1.0, 0.0, 0.0], weight),
            Orbit::Edges(weight) => ([sqrt(0.5), sqrt(0.5), 0.0], weight),
            Orbit::Corners(weight) => ([sqrt(1.0 / 3.0); 3], weight),
            Orbit::Diagonals(weight, p) => ([p, p, sqrt(1.0 - 2.0 * p * p)], weight),
            Orbit::Sides(weight, p) => ([p, sqrt(1.0 - p * p), 0.0], weight),
        };
        let orders = [[p, q, r], [q, r, p], [r, p, q], [q, p, r], [p, r, q], [r, q, p]];
        let mut image = 0;
        while image < 6 * 8 {
            let ([x, y, z], signs) = (orders[image / 8], image % 8);
            let image_point = [signed(x, signs & 1), signed(y, signs & 2), signed(z, signs & 4)];
            if is_upper(image_point) && !contains(&points, count, image_point) {
                points[count] = (image_point, weight);
                count += 1;
            }
            image += 1;
        }
        orbit += 1;
    }
    assert!(count == PAIRS, "the orbits have another number of points");
    points
}

const fn signed(x: f64, sign: usize) -> f64 {
    if sign == 0 || x == 0.0 { x } else { -x }
}

/// Tells a point from its antipode.
const fn is_upper([x, y, z]: [f64; 3]) -> bool {
    z > 0.0 || (z == 0.0 && (y > 0.0 || (y == 0.0 && x > 0.0)))
}

const fn contains(points: &[Point], count: usize, [x, y, z]: [f64; 3]) -> bool {
    let mut i = 0;
    while i < count {
        let ([a, b, c], _) = points[i];
        if a == x && b == y && c == z {
            return true;
        }
        i += 1;
    }
    false
}

const fn samples<const N2: usize, const PAIRS: usize, const ROOM: usize>(
    points: &[Point; PAIRS],
) -> Samples<f64, N2, PAIRS, ROOM> {
    let mut samples =
        Samples { values: [Row([0.0; ROOM]); N2], even: [Row([0.0; EVEN]); PAIRS], odd: [Row([0.0; ODD]); PAIRS] };
    let mut point = 0;
    while point < PAIRS {
        let (direction, weight) = points[point];
        let y = basis::<N2>(direction);
        let scale = 2.0 * 4.0 * core::f64::consts::PI * weight;
        let (mut l, mut i, mut packed) = (0, 0, [0, 0]);
        while i < N2 {
            samples.values[i].0[point] = y[i];
            let row: &mut [f64] = if l % 2 == 0 { &mut samples.even[point].0 } else { &mut samples.odd[point].0 };
            row[packed[l % 2]] = scale * y[i];
            packed[l % 2] += 1;
            i += 1;
            if i == (l + 1) * (l + 1) {
                l += 1;
            }
        }
        point += 1;
    }
    samples
}

/// The basis by the fully normalised three-term recurrence: `y_lm = p_lm Re or Im (x + iy)^m`, `1/√(4π) = p_00`.
const fn basis<const N2: usize>([x, y, z]: [f64; 3]) -> [f64; N2] {
    let mut out = [0.0; N2];
    let (mut c, mut s, mut m) = (sqrt(0.25 / core::f64::consts::PI), 0.0, 0);
    while m * m < N2 {
        if m > 0 {
            let ratio = -sqrt(if m == 1 { 3.0 } else { (2 * m + 1) as f64 / (2 * m) as f64 });
            (c, s) = (ratio * (x * c - y * s), ratio * (x * s + y * c));
        }
        let (mut below, mut p, mut l) = (0.0, 1.0, m);
        while l * l < N2 {
            out[l * (l + 1) - m] = p * s;
            out[l * (l + 1) + m] = p * c;
            (below, p) = (p, (z * p - slope(l, m) * below) / slope(l + 1, m));
            l += 1;
        }
        m += 1;
    }
    out
}

/// `√((l² − m²)/(4l² − 1))`
const fn slope(l: usize, m: usize) -> f64 {
    sqrt((l * l - m * m) as f64 / (4 * l * l).wrapping_sub(1) as f64)
}

/// Square root by Newton's method, for the compiler. From above it falls until rounding stops it.
const fn sqrt(square: f64) -> f64 {
    let mut root = if square > 1.0 { square } else { 1.0 };
    loop {
        let next = 0.5 * (root + square / root);
        if next >= root || square == 0.0 {
            return if square == 0.0 { 0.0 } else { root };
        }
        root = next;
    }
}

const fn rounded<const N2: usize, const PAIRS: usize, const ROOM: usize>(
    samples: &Samples<f64, N2, PAIRS, ROOM>,
) -> Samples<f32, N2, PAIRS, ROOM> {
    Samples {
        values: rounded_rows(&samples.values),
        even: rounded_rows(&samples.even),
        odd: rounded_rows(&samples.odd),
    }
}

const fn rounded_rows<const WIDTH: usize, const ROWS: usize>(
    rows: &[Row<f64, WIDTH>; ROWS],
) -> [Row<f32, WIDTH>; ROWS] {
    let mut out = [Row([0.0; WIDTH]); ROWS];
    let mut at = 0;
    while at < ROWS * WIDTH {
        out[at / WIDTH].0[at % WIDTH] = rows[at / WIDTH].0[at % WIDTH] as f32;
        at += 1;
    }
    out
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    extern crate std;

    use std::vec;
    use std::vec::Vec;

    use super::*;
    use crate::{Order, Real, eval};

    /// The points of a table, from the values of band 1.
    fn check<const N2: usize, const PAIRS: usize, const ROOM: usize>(
        samples: &Samples<f64, N2, PAIRS, ROOM>,
        degree: i32,
    ) {
        let y_1 = Real::sqrt(3.0 / (4.0 * core::f64::consts::PI));
        let at = |i: usize, point: usize| samples.values[i].0[point];
        let points: Vec<[f64; 3]> = (0..PAIRS).map(|k| [-at(3, k) / y_1, -at(1, k) / y_1, at(2, k) / y_1]).collect();
        let n = N2.isqrt();
        for (point, &direction) in points.iter().enumerate() {
            let mut y = vec![0.0; N2];
            eval(Order::new(n).unwrap(), direction, &mut y);
            assert!((0..N2).all(|i| (at(i, point) - y[i]).abs() < 2e-15), "{direction:?}");
        }
        // Weights from the constant function; even monomials of the degree fix all lower even ones.
        let weight = |point: usize| samples.even[point].0[0] / at(0, point);
        let double_factorial = |k: i32| (1..=k).rev().step_by(2).map(f64::from).product::<f64>();
        for (a, b) in (0..=degree).flat_map(|a| (0..=degree - a).map(move |b| (a, b))) {
            let c = degree - a - b;
            let sum: f64 =
                points.iter().enumerate().map(|(k, [x, y, z])| weight(k) * x.powi(a) * y.powi(b) * z.powi(c)).sum();
            let exact = if a % 2 == 0 && b % 2 == 0 {
                4.0 * core::f64::consts::PI * [a, b, c].map(|e| double_factorial(e - 1)).iter().product::<f64>()
                    / double_factorial(degree + 1)
            } else {
                0.0
            };
            assert!((sum - exact).abs() < 2e-15, "{a} {b} {c}: {sum} {exact}");
        }
    }

    #[test]
    fn rules_are_exact_up_to_their_degree() {
        check(&SAMPLES_3, 6);
        check(&SAMPLES_4, 8);
        check(&SAMPLES_6, 14);
    }

    #[test]
    fn padding_is_zero() {
        assert!(SAMPLES_6.values.iter().all(|row| row.0[43..].iter().all(|&v| v == 0.0)));
        assert!(SAMPLES_4.values.iter().all(|row| row.0[19..].iter().all(|&v| v == 0.0)));
        assert!(SAMPLES_6.even.iter().all(|row| row.0[15..] == [0.0]));
        assert!(SAMPLES_6.odd.iter().all(|row| row.0[21..].iter().all(|&v| v == 0.0)));
    }
}
