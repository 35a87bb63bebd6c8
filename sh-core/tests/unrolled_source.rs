//! Writes `src/basis/unrolled.rs`, and proves that the file is what this program writes.
//!
//! After a change here: `UPDATE_UNROLLED=1 cargo test -p sh-core --test unrolled_source`.
#![expect(clippy::unwrap_used, reason = "tests")]

use std::fmt::Write;

/// The largest order with a straight-line kernel.
const MAX_ORDER: usize = 10;

const HEADER: &str = "\
//! Straight-line kernels for small orders. Written by `tests/unrolled_source.rs`: change that program, not this file.
//!
//! For m ≥ 0, `y_lm = p cos`, `y_l−m = p sin`, with `cos + i sin = (x + iy)^m` and `p` a polynomial: `p(v)` for even l − m,
//! `z p(v)` for odd, where `v = 2z² − 1`. In `v` the coefficients are small, and its rounding near the poles costs a
//! quarter of that of z. Column `m` of every order is one function, cut off at the constant order `N`.

use super::Sink;
use crate::Real;
use crate::simd::Lanes;
";

const COMMON: &str = "
/// Hands every `y_i` of order `N` to `sink`, column by column.
#[inline(always)]
pub(super) fn kernel<T: Real, V: Lanes<T>, const N: usize>([x, y, z]: [V; 3], sink: &mut impl Sink<V>) {
    let zv = [z, polynomial_argument([x, y, z])];
    column_0::<T, V, N>(zv, sink);
    let (mut c, mut s) = (x, y);
COLUMNS}

/// `(x + iy)(c + is)`
#[inline(always)]
fn turn<T: Real, V: Lanes<T>>([x, y]: [V; 2], [c, s]: [V; 2]) -> (V, V) {
    (x.mul_add(c, -(y * s)), x.mul_add(s, y * c))
}

/// `2z² − 1`, near the poles from x and y, where z has lost digits.
#[inline(always)]
fn polynomial_argument<T: Real, V: Lanes<T>>([x, y, z]: [V; 3]) -> V {
    let (one, two) = (V::splat(T::ONE), V::splat(T::ONE + T::ONE));
    let (radius2, height2) = (x.mul_add(x, y * y), z * z);
    radius2.select_less(height2, one - two * radius2, two * height2 - one)
}
";

fn source() -> String {
    let mut source = String::from(HEADER);
    source += "\n/// The largest order that has a kernel.\n#[cfg(feature = \"alloc\")]\n";
    writeln!(source, "pub(super) const MAX_ORDER: usize = {MAX_ORDER};").unwrap();
    source += &COMMON.replace("COLUMNS", &columns());
    for m in 0..MAX_ORDER {
        source += &column(m);
    }
    source
}

/// The calls of the columns m ≥ 1.
fn columns() -> String {
    let call = |m: usize| {
        let turn = if m == 1 { "" } else { "        (c, s) = turn::<T, V>([x, y], [c, s]);\n" };
        format!("    if N > {m} {{\n{turn}        column_{m}::<T, V, N>([c, s], zv, sink);\n    }}\n")
    };
    (1..MAX_ORDER).map(call).collect()
}

fn column(m: usize) -> String {
    let mut source = String::from("\n#[inline(always)]\n");
    let argument = match MAX_ORDER - m {
        1 => "_",
        2 => "[z, _]",
        _ => "[z, v]",
    };
    let wave = if m == 0 { "" } else { "[c, s]: [V; 2], " };
    let arguments = format!("{wave}{argument}: [V; 2], sink: &mut impl Sink<V>");
    writeln!(source, "fn column_{m}<T: Real, V: Lanes<T>, const N: usize>({arguments}) {{").unwrap();
    source += "    let k = |number: f64| V::splat(T::from_f64(number));\n";
    for l in m..MAX_ORDER {
        source += &band(l, m);
    }
    source + "}\n"
}

fn band(l: usize, m: usize) -> String {
    let coefficients = polynomial(l, m);
    let mut lines: Vec<String> = Vec::new();
    for (i, c) in coefficients.iter().rev().enumerate() {
        lines.push(if i == 0 { format!("let p = k({c:?});") } else { format!("let p = p.mul_add(v, k({c:?}));") });
    }
    let p = if !(l - m).is_multiple_of(2) {
        lines.push("let p = p * z;".into());
        "p"
    } else {
        "p"
    };
    let centre = l * (l + 1);
    if m == 0 {
        lines.push(format!("sink.put({centre}, {p});"));
    } else {
        lines.push(format!("sink.put({}, p * s);", centre - m));
        lines.push(format!("sink.put({}, p * c);", centre + m));
    }
    if l == m {
        return lines.iter().map(|line| format!("    {line}\n")).collect();
    }
    let body: String = lines.iter().map(|line| format!("        {line}\n")).collect();
    format!("    if N > {l} {{\n{body}    }}\n")
}

/// Coefficients of `p` in powers of `v`, lowest first: exact whole numbers times one rounded norm.
fn polynomial(l: usize, m: usize) -> Vec<f64> {
    // 2^l d^m/dz^m P_l(z), in powers of z²: the coefficient of z^(l−2k−m).
    let degree = (l - m) / 2;
    let mut in_z2 = vec![0_i128; degree + 1];
    for k in 0..=degree {
        let sign = if k.is_multiple_of(2) { 1 } else { -1 };
        in_z2[degree - k] = sign * binomial(l, k) * binomial(2 * l - 2 * k, l) * falling(l - 2 * k, m);
    }
    // z^(2j) = (1+v)^j / 2^j, over the common denominator 2^degree.
    let in_v = (0..=degree).map(|i| {
        let terms = (i..=degree).map(|j| in_z2[j] * binomial(j, i) * (1 << (degree - j)));
        terms.sum::<i128>() as f64 / 2_f64.powi((l + degree) as i32)
    });
    let scale = norm(l, m);
    in_v.map(|c| scale * c).collect()
}

/// `(−1)^m √2 K_lm`, or `K_l0`.
fn norm(l: usize, m: usize) -> f64 {
    let twice = if m == 0 { 1.0 } else { 2.0 };
    let sign = if m.is_multiple_of(2) { 1.0 } else { -1.0 };
    // (l+m)!/(l−m)!
    let ratio = falling(l + m, 2 * m) as f64;
    sign * (twice * (2 * l + 1) as f64 / (4.0 * std::f64::consts::PI * ratio)).sqrt()
}

fn binomial(n: usize, k: usize) -> i128 {
    falling(n, k) / falling(k, k)
}

/// `n (n−1) ... (n−k+1)`
fn falling(n: usize, k: usize) -> i128 {
    (0..k).map(|i| n as i128 - i as i128).product()
}

#[test]
fn the_file_is_what_this_program_writes() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/src/basis/unrolled.rs");
    let source = source();
    if std::env::var_os("UPDATE_UNROLLED").is_some() {
        std::fs::write(path, &source).unwrap();
    }
    let file = std::fs::read_to_string(path).unwrap();
    let differs = file.lines().zip(source.lines()).position(|(a, b)| a != b);
    assert_eq!(differs, None, "the first line that differs, from 0; see the head of this file");
    assert_eq!(file.len(), source.len());
}
