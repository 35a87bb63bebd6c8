//! Writes `src/rotation/unrolled.rs`, and proves that the file is what this program writes.
//!
//! After a change here: `UPDATE_UNROLLED=1 cargo test -p sh-core --test rotation_source`.
#![expect(clippy::unwrap_used, reason = "tests")]

use std::fmt::Write;

/// The largest order with straight-line kernels.
const MAX_ORDER: usize = 10;

const HEADER: &str = "\
//! Straight-line rotations of small orders. Written by `tests/rotation_source.rs`: change that program, not this file.
//!
//! Each step is a function of its own, which reads quads and writes quads; see `quad.rs` for the reason.

use super::quad::{Constants, Quad};
use super::turn::{self, Turns};
use super::zyz::Zyz;
use crate::{Order, Real};
";

const COMMON: &str = "
/// Rotates an expansion of an order that has a kernel; returns whether it did. Leaves out `s → −s`.
#[inline(always)]
pub(super) fn rotate<T: Real>(order: Order, zyz: &Zyz<T>, coeffs: &[T], out: &mut [T]) -> bool {
    match order.get() {
        1 => out[0] = coeffs[0],
ORDERS        _ => return false,
    }
    true
}

/// `N2 = N²` for the order `N`; `K` quads in the last band; `Q` quads in all bands from 1.
#[inline(always)]
fn kernel<T: Real, const N2: usize, const K: usize, const Q: usize>(zyz: &Zyz<T>, coeffs: &[T], out: &mut [T]) {
    let coeffs: &[T; N2] = coeffs.try_into().expect(\"length checked by the caller\");
    let out: &mut [T; N2] = out.try_into().expect(\"length checked by the caller\");
    let constants = T::constants();
    let mut turns = [Turns::<T, K>::ZERO; 3];
    // The exchange turns the sense of β.
    let [cos_beta, sin_beta] = zyz.beta;
    turn::fill(&mut turns, zyz.alpha, [cos_beta, -sin_beta], zyz.gamma, constants);
    let (mut a, mut b) = ([Quad::ZERO; Q], [Quad::ZERO; Q]);
    gamma_and_exchange(&turns[2], constants, coeffs, &mut a);
    beta_and_exchange(&turns[1], constants, &a, &mut b);
    out[0] = coeffs[0];
    alpha(&turns[0], &b, out);
}
";

fn source() -> String {
    let orders: String = (2..=MAX_ORDER)
        .map(|n| {
            let quads: usize = (1..n).map(quad_count).sum();
            format!("        {n} => kernel::<T, {}, {}, {quads}>(zyz, coeffs, out),\n", n * n, quad_count(n - 1))
        })
        .collect();
    [HEADER, &COMMON.replace("ORDERS", &orders), &gamma_and_exchange(), &beta_and_exchange(), &alpha(), &factors()]
        .concat()
}

fn quad_count(l: usize) -> usize {
    l / 2 + 1
}

/// Lines for each band, which are left out of orders without it. `of_band` gets l and the number of quads before.
fn bands(of_band: impl Fn(usize, usize) -> Vec<String>) -> String {
    let mut quads = 0;
    let mut source = String::new();
    for l in 1..MAX_ORDER {
        let lines: String = of_band(l, quads).iter().map(|line| format!("        {line}\n")).collect();
        writeln!(source, "    if Q > {quads} {{\n{lines}    }}").unwrap();
        quads += quad_count(l);
    }
    source + "}\n"
}

fn gamma_and_exchange() -> String {
    let head = "
/// `E Z(γ)`, but for the swap of lanes.
#[inline(never)]
fn gamma_and_exchange<T: Real, const N2: usize, const K: usize, const Q: usize>(
    gamma: &Turns<T, K>,
    constants: &Constants<T>,
    coeffs: &[T; N2],
    out: &mut [Quad<T>; Q],
) {
    let e = &constants.exchange;
";
    head.to_owned()
        + &bands(|l, quads| {
            let mut lines = vec![format!("let band = &coeffs[{}..{}];", l * l, (l + 1) * (l + 1))];
            let loads = (0..quad_count(l)).map(|i| format!("let v{i} = gamma.turn({i}, Quad::load({l}, {i}, band));"));
            lines.extend(loads);
            lines.extend(exchange(l, quads));
            lines
        })
}

fn beta_and_exchange() -> String {
    let head = "
/// `E Z(−β)`, but for the last swap of lanes.
#[inline(never)]
fn beta_and_exchange<T: Real, const K: usize, const Q: usize>(
    beta: &Turns<T, K>,
    constants: &Constants<T>,
    quads: &[Quad<T>; Q],
    out: &mut [Quad<T>; Q],
) {
    let e = &constants.exchange;
";
    head.to_owned()
        + &bands(|l, quads| {
            let turn = |i| format!("let v{i} = beta.turn({i}, quads[{}].{}());", quads + i, swap(l));
            let mut lines: Vec<String> = (0..quad_count(l)).map(turn).collect();
            lines.extend(exchange(l, quads));
            lines
        })
}

fn alpha() -> String {
    let head = "
/// `Z(α)`, and back to coefficients.
#[inline(never)]
fn alpha<T: Real, const N2: usize, const K: usize, const Q: usize>(
    alpha: &Turns<T, K>,
    quads: &[Quad<T>; Q],
    out: &mut [T; N2],
) {
";
    head.to_owned()
        + &bands(|l, quads| {
            let mut lines = vec![format!("let band = &mut out[{}..{}];", l * l, (l + 1) * (l + 1))];
            let turn = |i| format!("alpha.turn({i}, quads[{}].{}()).store({l}, {i}, band);", quads + i, swap(l));
            lines.extend((0..quad_count(l)).map(turn));
            lines
        })
}

fn swap(l: usize) -> &'static str {
    if l.is_multiple_of(2) { "after_even_band" } else { "after_odd_band" }
}

/// The factors times the quads `v0`, `v1` and so on.
fn exchange(l: usize, quads: usize) -> Vec<String> {
    let (count, before) = (quad_count(l), (1..l).map(|l| quad_count(l).pow(2)).sum::<usize>());
    let product = |i: usize, j: usize| format!("v{j} * e[{}]", before + i * count + j);
    let sum = |i: usize| (0..count).map(|j| product(i, j)).collect::<Vec<String>>().join(" + ");
    (0..count).map(|i| format!("out[{}] = {};", quads + i, sum(i))).collect()
}

fn factors() -> String {
    let mut source = String::from(
        "
/// Factors of the exchange of y and z: for each band, those of its quads `i, j`.
pub(super) const EXCHANGE: [[f64; 4]; FACTOR_COUNT] = [
",
    );
    let mut total = 0;
    for l in 1..MAX_ORDER {
        let count = quad_count(l);
        total += count * count;
        for (i, j) in (0..count).flat_map(|i| (0..count).map(move |j| (i, j))) {
            writeln!(source, "    {:?},", quad(l, i, j)).unwrap();
        }
    }
    source + &format!("];\n\n/// Quads of factors.\npub(super) const FACTOR_COUNT: usize = {total};\n")
}

/// Factors from the lanes of quad `j`; the lanes of the result are in the order of the lanes that they come from.
fn quad(l: usize, i: usize, j: usize) -> [f64; 4] {
    let (even, odd) = (2 * i, 2 * i + 1);
    let (from_even, from_odd) = (2 * j, 2 * j + 1);
    // In even bands cosines of odd m and sines of even m change places, in odd bands the others.
    let to = if l.is_multiple_of(2) { [even, even, odd, odd] } else { [odd, odd, even, even] };
    let mut factors = [0, 1, 2, 3].map(|lane| entry(l, to[lane], [from_even, from_odd, from_odd, from_even][lane]));
    // There is no sine of m = 0.
    if j == 0 {
        factors[3] = 0.0;
    }
    let sine = if l.is_multiple_of(2) { 1 } else { 3 };
    if i == 0 && to[sine] == 0 {
        factors[sine] = 0.0;
    }
    factors
}

/// Exchange of y and z.
fn entry(l: usize, to: usize, from: usize) -> f64 {
    if to > l || from > l {
        return 0.0;
    }
    let twice = |m: usize| if m == 0 { 1.0 } else { 2.0 };
    let minus = (l - from) + from / 2 + to / 2 + usize::from(l % 2 == 1 && (to + from) % 2 == 1);
    let sign = if minus.is_multiple_of(2) { 1.0 } else { -1.0 };
    sign * quarter_turn(l, to, from, twice(to) * twice(from))
}

/// Wigner's `d^l_m'm(π/2) √scale`: whole numbers and one square root.
fn quarter_turn(l: usize, to: usize, from: usize, scale: f64) -> f64 {
    // 2^-l Σ_k (−1)^(k+to−from) C(l+from, k) C(l−from, l−to−k)  √( (l+to)! (l−to)! / ((l+from)! (l−from)!) )
    let sum: i128 = (0..=l - to)
        .map(|k| {
            let other = l - to - k;
            let sign = if (l - from + other).is_multiple_of(2) { 1 } else { -1 };
            sign * binomial(l + from, k) * binomial(l - from, other)
        })
        .sum();
    let ratio = factorial(l + to) * factorial(l - to) / (factorial(l + from) * factorial(l - from));
    sum as f64 * (scale * ratio).sqrt() / 2_f64.powi(l as i32)
}

fn factorial(n: usize) -> f64 {
    (1..=n).map(|i| i as f64).product()
}

fn binomial(n: usize, k: usize) -> i128 {
    if k > n { 0 } else { (0..k).fold(1, |b, i| b * (n - i) as i128 / (i + 1) as i128) }
}

#[test]
fn the_file_is_what_this_program_writes() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/src/rotation/unrolled.rs");
    let source = source();
    if std::env::var_os("UPDATE_UNROLLED").is_some() {
        std::fs::write(path, &source).unwrap();
    }
    let file = std::fs::read_to_string(path).unwrap();
    let differs = file.lines().zip(source.lines()).position(|(a, b)| a != b);
    assert_eq!(differs, None, "the first line that differs, from 0; see the head of this file");
    assert_eq!(file.len(), source.len());
}
