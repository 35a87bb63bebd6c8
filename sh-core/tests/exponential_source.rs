//! Fits `src/exponential/linear_table.rs`, and proves that the file is what this program fits.
//!
//! Training set, for every order: sums of the logarithms of 1 to 64 blockers (`tests/blockers`, floor 0.02), 1000 sets of
//! each number, each also halved up to four times, as it is before squaring. The target is the exponential in the algebra of
//! truncated products. For each set the best `a` and `b` are `⟨e, 1⟩/4π` and `⟨e, f̂⟩/|f̂|²`; a node of the table is the mean of
//! `(a − 1)/|f̂|²` and `b`
//! over the sets near its length, with the weights of linear interpolation.
//!
//! After a change here: `UPDATE_LINEAR_TABLE=1 cargo test -p sh-core --test exponential_source`.
#![cfg(feature = "alloc")]
#![expect(clippy::unwrap_used, reason = "tests")]

mod blockers;

use std::fmt::Write;

use blockers::{Blockers, Logarithms, Random};
use sh_core::{ExpOptions, ExpStart, Order, dot, exp};

const ORDERS: std::ops::RangeInclusive<usize> = 2..=6;
const TABLE_END: f64 = 4.0;
const NODES: usize = 17;

/// Close to the limit of many halvings.
const TARGET: ExpOptions = ExpOptions { start: ExpStart::ProductSeries(8), longest: 0.5 };

/// Other machines' functions differ in the last digits; the file has six.
const TOLERANCE: f64 = 2e-6;

fn fit(n: usize) -> Vec<[f64; 2]> {
    let order = Order::new(n).unwrap();
    let logarithms = Logarithms::new(order, 0.02);
    let mut random = Random::new(n as u64);
    let mut sums = [[0.0; 3]; NODES];
    for count in [1, 2, 4, 8, 16, 32, 64].into_iter().flat_map(|count| [count; 1000]) {
        let mut f = Blockers::random(count, &mut random).logarithm(&logarithms);
        f[0] = 0.0;
        for _ in 0..5 {
            add_example(order, &f, &mut sums);
            f.iter_mut().for_each(|f| *f *= 0.5);
        }
    }
    means(&sums)
}

/// `(a − 1)/|f̂|²` and `b` of one expansion, shared between the two nodes next to its length.
fn add_example(order: Order, f: &[f64], sums: &mut [[f64; 3]; NODES]) {
    let mut e = vec![0.0; f.len()];
    exp(order, &TARGET, f, &mut e);
    let (square, one) = (dot(f, f), (4.0 * std::f64::consts::PI).sqrt());
    let (a, b) = ((e[0] / one - 1.0) / square, dot(&e, f) / square);
    let position = square.sqrt() / TABLE_END * (NODES - 1) as f64;
    let node = position as usize;
    for (node, weight) in [(node, 1.0 - position.fract()), (node + 1, position.fract())] {
        if let Some(sum) = sums.get_mut(node) {
            sum.iter_mut().zip([weight, weight * a, weight * b]).for_each(|(sum, value)| *sum += value);
        }
    }
}

/// At length 0 the mean of `f̂²/2` is all of `a − 1`, `|f̂|²/8π`, and `b` is 1.
fn means(sums: &[[f64; 3]; NODES]) -> Vec<[f64; 2]> {
    let mean = |&[weight, a, b]: &[f64; 3]| {
        assert!(weight > 20.0, "a node with too few examples: {weight}");
        [a / weight, b / weight]
    };
    std::iter::once([1.0 / (8.0 * std::f64::consts::PI), 1.0]).chain(sums[1..].iter().map(mean)).collect()
}

fn source(tables: &[Vec<[f64; 2]>]) -> String {
    let mut source = String::from(
        "//! `a` and `b` of the optimal linear exponential. Written by `tests/exponential_source.rs`: change that program, not this\n\
         //! file.\n\n\
         /// The order of the first row.\n",
    );
    writeln!(source, "pub(super) const FIRST_ORDER: usize = {};\n", ORDERS.start()).unwrap();
    source += "/// For each order `(a − 1)/|f̂|²` and `b` at equally spaced lengths.\n#[rustfmt::skip]\n";
    writeln!(source, "pub(super) const TABLE: [[[f64; 2]; {NODES}]; {}] = [", tables.len()).unwrap();
    for table in tables {
        source += "    [\n";
        for nodes in table.chunks(5) {
            let nodes: Vec<String> = nodes.iter().map(|[a, b]| format!("[{a:.6}, {b:.6}]")).collect();
            writeln!(source, "        {},", nodes.join(", ")).unwrap();
        }
        source += "    ],\n";
    }
    source + "];\n"
}

/// All numbers with a decimal point.
fn numbers(source: &str) -> Vec<f64> {
    source
        .split(['[', ']', ',', ' ', '\n'])
        .filter(|word| word.contains('.'))
        .filter_map(|word| word.parse().ok())
        .collect()
}

#[test]
fn the_table_is_what_this_program_fits() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/src/exponential/linear_table.rs");
    let source = source(&ORDERS.map(fit).collect::<Vec<_>>());
    if std::env::var_os("UPDATE_LINEAR_TABLE").is_some() {
        std::fs::write(path, &source).unwrap();
    }
    let (found, expected) = (numbers(&std::fs::read_to_string(path).unwrap()), numbers(&source));
    assert_eq!(expected.len(), 2 * NODES * ORDERS.count());
    assert_eq!(found.len(), expected.len());
    for (at, (found, expected)) in found.iter().zip(&expected).enumerate() {
        assert!((found - expected).abs() < TOLERANCE, "number {at}: {found} {expected}");
    }
}
