//! Gaunt coefficients against whole numbers and against another program.
#![cfg(feature = "alloc")]
#![expect(clippy::unwrap_used, clippy::print_stdout, reason = "tests")]

mod exact;

use sh_core::{Order, Quadrature, TripleTensor, eval, gaunt, index};

/// The accuracy that the documentation of `gaunt` states.
const ACCURACY: f64 = 3e-15;

#[test]
fn coefficients_are_those_from_whole_numbers() {
    let mut worst = 0.0_f64;
    // All of order 4, and one of seven to order 9.
    let triples = (0..81).flat_map(|i| (i..81).flat_map(move |j| (j..81).map(move |k| [i, j, k])));
    for [i, j, k] in triples.filter(|&[i, j, k]| k < 16 || (i + 3 * j + 5 * k) % 7 == 0) {
        let (value, expected) = (gaunt(i, j, k), exact::gaunt(i, j, k));
        worst = worst.max((value - expected).abs());
        assert!((value - expected).abs() <= ACCURACY, "{i} {j} {k}: {value} {expected}");
    }
    println!("worst {worst:.1e}");
}

/// `tests/references/gaunt.txt` holds `l m l m l m value`, made by the script beside it.
#[test]
fn coefficients_are_those_of_sympy() {
    let mut count = 0;
    for line in include_str!("references/gaunt.txt").lines().filter(|line| !line.starts_with('#')) {
        let fields: Vec<&str> = line.split_whitespace().collect();
        let whole: Vec<isize> = fields[..6].iter().map(|field| field.parse().unwrap()).collect();
        let function = |at: usize| index(whole[2 * at].unsigned_abs(), whole[2 * at + 1]);
        let expected: f64 = fields[6].parse().unwrap();
        let value = gaunt(function(0), function(1), function(2));
        assert!((value - expected).abs() <= ACCURACY, "{line}: {value}");
        count += 1;
    }
    assert_eq!(count, 60);
}

#[test]
fn coefficients_are_symmetric_and_zero_where_they_must_be() {
    let [a, b, c] = [index(7, -3), index(5, 2), index(4, -1)];
    let value = gaunt(a, b, c);
    assert!(value.abs() > 1e-3);
    for other in [gaunt(a, c, b), gaunt(b, a, c), gaunt(b, c, a), gaunt(c, a, b), gaunt(c, b, a)] {
        assert!((value - other).abs() < ACCURACY);
    }
    // An odd sum of bands, a band too large, |m| that do not add up, an odd number of sines.
    for [a, b, c] in [
        [index(3, 0), index(2, 0), index(2, 0)],
        [index(6, 0), index(2, 0), index(2, 0)],
        [index(4, 2), index(3, 1), index(3, 2)],
        [index(4, 3), index(3, -2), index(3, 1)],
    ] {
        assert_eq!([gaunt(a, b, c), gaunt(c, a, b), gaunt(b, c, a)], [0.0; 3]);
    }
}

#[test]
fn the_tensor_has_every_coefficient_once() {
    for (n, count) in [(1, 1), (2, 4), (3, 25), (4, 79), (5, 240), (6, 559), (8, 2326), (10, 7098), (16, 75_212)] {
        let tensor = TripleTensor::<f64>::new(Order::new(n).unwrap());
        assert_eq!(tensor.entries().len(), count, "n = {n}");
        let mut last = None;
        for &([i, j, k], value) in tensor.entries() {
            assert!(i <= j && j <= k && (k as usize) < n * n);
            if n <= 6 || (i + j + k) % 101 == 0 {
                let expected = exact::gaunt(i as usize, j as usize, k as usize);
                assert!((value - expected).abs() <= ACCURACY, "{i} {j} {k}: {value} {expected}");
            }
            assert!(!tensor_has_twice(&mut last, [i, j, k]), "{i} {j} {k} twice");
        }
    }
    // What is left out is zero.
    let tensor = TripleTensor::<f64>::new(Order::new(6).unwrap());
    let sum: f64 = tensor.entries().iter().map(|(_, value)| value.abs()).sum();
    let triples = (0..36).flat_map(|i| (i..36).flat_map(move |j| (j..36).map(move |k| exact::gaunt(i, j, k).abs())));
    assert!((sum - triples.sum::<f64>()).abs() < 1e-11);
}

/// Entries of a pair follow one another with growing bands, so a repetition has the same first two indices.
fn tensor_has_twice(seen: &mut Option<([u32; 2], Vec<u32>)>, [i, j, k]: [u32; 3]) -> bool {
    match seen {
        Some((pair, thirds)) if *pair == [i, j] => {
            let twice = thirds.contains(&k);
            thirds.push(k);
            twice
        }
        _ => {
            *seen = Some(([i, j], vec![k]));
            false
        }
    }
}

#[test]
fn coefficients_are_integrals() {
    let n = 5;
    let mut y = vec![0.0; n * n];
    let mut sums = vec![0.0; (n * n).pow(3)];
    for &(direction, weight) in Quadrature::new(3 * (n - 1)).points() {
        eval(Order::new(n).unwrap(), direction, &mut y);
        for (at, sum) in sums.iter_mut().enumerate() {
            *sum += weight * y[at / 625] * y[at / 25 % 25] * y[at % 25];
        }
    }
    for (at, sum) in sums.into_iter().enumerate() {
        let value = gaunt(at / 625, at / 25 % 25, at % 25);
        assert!((value - sum).abs() < 1e-14, "{at}: {value} {sum}");
    }
}

#[test]
#[should_panic(expected = "index 262144 is not below 262144")]
fn indices_beyond_the_largest_order_are_refused() {
    gaunt(512 * 512, 0, 0);
}
