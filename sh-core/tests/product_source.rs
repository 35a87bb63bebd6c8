//! Writes `src/product/straight.rs`, and proves that the file is what this program writes.
//!
//! After a change here: `UPDATE_STRAIGHT=1 cargo test -p sh-core --test product_source`.
#![expect(clippy::unwrap_used, reason = "tests")]

mod exact;

use std::fmt::Write;

/// The orders that get a kernel. At n = 6 it would be 2,200 lines, for a sixth of the time.
const ORDERS: [usize; 3] = [3, 4, 5];

/// Smaller coefficients are rounding errors of zero.
const ZERO: f64 = 1e-12;

const HEADER: &str = "\
//! Straight-line products of small orders. Written by `tests/product_source.rs`: change that program, not this file.
//!
//! `out_i = Σ g_ijk (a_j b_k + a_k b_j)` over `j ≤ k`, for as many pairs of factors as there are lanes. The Gaunt coefficients
//! are from whole numbers.

use crate::Real;
use crate::simd::Lanes;
";

/// One order: each symmetric product is added to all results that have a part in it, so that it lives in a register.
fn kernel(n: usize) -> String {
    let count = n * n;
    let mut body = String::new();
    let mut begun = vec![false; count];
    for (j, k) in (0..count).flat_map(|j| (j..count).map(move |k| (j, k))) {
        let used: Vec<(usize, f64)> =
            (0..count).map(|i| (i, exact::gaunt(i, j, k))).filter(|(_, g)| g.abs() > ZERO).collect();
        if used.is_empty() {
            continue;
        }
        let value =
            if j == k { format!("a[{j}] * b[{j}]") } else { format!("a[{j}].mul_add(b[{k}], a[{k}] * b[{j}])") };
        writeln!(body, "    let p = {value};").unwrap();
        for (i, g) in used {
            let sum = if begun[i] { format!("p.mul_add(g({g:?}), out[{i}])") } else { format!("p * g({g:?})") };
            writeln!(body, "    out[{i}] = {sum};").unwrap();
            begun[i] = true;
        }
    }
    assert!(begun.iter().all(|&begun| begun));
    format!(
        "\n/// Order {n}.\n#[inline(always)]\n#[rustfmt::skip]\n\
         pub(super) fn order_{n}<T: Real, V: Lanes<T>>(a: &[V; {count}], b: &[V; {count}]) -> [V; {count}] {{\n    \
         let g = |g: f64| V::splat(T::from_f64(g));\n    let mut out = [V::splat(T::ZERO); {count}];\n{body}    out\n}}\n"
    )
}

#[test]
fn the_file_is_what_this_program_writes() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/src/product/straight.rs");
    let source = ORDERS.iter().fold(String::from(HEADER), |source, &n| source + &kernel(n));
    if std::env::var_os("UPDATE_STRAIGHT").is_some() {
        std::fs::write(path, &source).unwrap();
    }
    let file = std::fs::read_to_string(path).unwrap();
    let differs = file.lines().zip(source.lines()).position(|(a, b)| a != b);
    assert_eq!(differs, None, "the first line that differs, from 0; see the head of this file");
    assert_eq!(file.len(), source.len());
}
