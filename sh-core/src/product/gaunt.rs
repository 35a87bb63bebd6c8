//! Gaunt coefficients: the integral of three basis functions.

use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::PI;

use crate::sphere::gauss_legendre;
use crate::{Basis, Order, Real};

/// The integral of three basis functions over the sphere, `∫ y_i y_j y_k ds`.
///
/// Symmetric in its arguments, which are indices `l(l+1) + m`. Not zero only if all of these hold:
///
/// - `l_i + l_j + l_k` is even, and no `l` is larger than the sum of the two others
/// - one `|m|` is the sum of the two others
/// - the number of negative `m` is even
///
/// The result is exactly zero otherwise.
///
/// Computed by a Gauss-Legendre rule that is exact for the degree, in `f64`: no factorials and no alternating sums, so it is
/// as good for large bands as for small ones. Accuracy: 3e-15 absolute, asserted by `tests/product_gaunt.rs` against whole
/// numbers for `l < 9`, and to `l = 70` against the exact values of another program. Allocates; many coefficients come
/// faster from a [`TripleTensor`].
///
/// ```
/// use sh_core::{gaunt, index};
///
/// // ∫ y_10 y_10 y_20 = 1/√(5π)
/// let value = gaunt(index(1, 0), index(1, 0), index(2, 0));
/// assert!((value - 1.0 / (5.0 * std::f64::consts::PI).sqrt()).abs() < 1e-15);
/// assert_eq!(gaunt(0, 1, 2), 0.0);
/// ```
///
/// # Panics
/// If a band is not below [`Order::MAX`].
pub fn gaunt(i: usize, j: usize, k: usize) -> f64 {
    for index in [i, j, k] {
        assert!(index < Order::MAX * Order::MAX, "index {index} is not below {}", Order::MAX * Order::MAX);
    }
    let functions = [i, j, k].map(Function::new);
    let azimuth = azimuth_integral(functions.map(|f| f.m));
    let [l1, l2, l3] = functions.map(|f| f.l);
    if azimuth == 0.0 || !(l1 + l2 + l3).is_multiple_of(2) || l3 > l1 + l2 || l3 < l1.abs_diff(l2) {
        return 0.0;
    }
    let meridian = Meridian::new(l1.max(l2).max(l3) + 1, l1 + l2 + l3);
    azimuth * meridian.integral(functions)
}

/// A basis function.
#[derive(Clone, Copy, Debug)]
struct Function {
    index: usize,
    l: usize,
    m: isize,
}

impl Function {
    fn new(index: usize) -> Self {
        let l = index.isqrt();
        Self { index, l, m: index as isize - (l * (l + 1)) as isize }
    }

    /// The function with `|m|` in place of `m`: the same along a meridian.
    fn meridian_index(self) -> usize {
        self.l * (self.l + 1) + self.m.unsigned_abs()
    }
}

/// `∫ t_a t_b t_c dφ` over the circle, with `t_m = cos mφ` for m ≥ 0 and `sin |m|φ` for m < 0.
fn azimuth_integral(m: [isize; 3]) -> f64 {
    let sizes = m.map(isize::unsigned_abs);
    let largest = sizes.into_iter().max().unwrap_or(0);
    let sines = m.iter().filter(|&&m| m < 0).count();
    if 2 * largest != sizes.iter().sum::<usize>() || sines % 2 == 1 {
        return 0.0;
    }
    // sin aφ sin bφ = ½ (cos (a−b)φ − cos (a+b)φ): the sum is where the cosine is the largest.
    let sign = if m.iter().any(|&m| m > 0 && m.unsigned_abs() == largest) && sines == 2 { -1.0 } else { 1.0 };
    match sizes.iter().filter(|&&size| size == 0).count() {
        3 => 2.0 * PI,
        1 => PI,
        _ => sign * 0.5 * PI,
    }
}

/// The basis along the meridian φ = 0, at the nodes `z ≥ 0` of a rule; the other half follows by parity.
#[derive(Clone, Debug)]
struct Meridian {
    /// `[n², nodes]`; of the functions with m ≥ 0.
    values: Vec<f64>,
    /// Of a node and its mirror image.
    weights: Vec<f64>,
}

impl Meridian {
    /// For bands below `n`, and products of `degree`.
    fn new(n: usize, degree: usize) -> Self {
        let basis = Basis::<f64>::new(Order::new(n).expect("bands are below the largest order"));
        let nodes: Vec<(f64, f64)> = gauss_legendre(degree / 2 + 1).filter(|&(z, _)| z >= 0.0).collect();
        let (mut values, mut y) = (vec![0.0; n * n * nodes.len()], vec![0.0; n * n]);
        for (node, &(z, _)) in nodes.iter().enumerate() {
            basis.eval([Real::sqrt((1.0 - z) * (1.0 + z)), 0.0, z], &mut y);
            values.iter_mut().skip(node).step_by(nodes.len()).zip(&y).for_each(|(value, &y)| *value = y);
        }
        let weights = nodes.into_iter().map(|(z, weight)| if z > 0.0 { 2.0 * weight } else { weight });
        Self { values, weights: weights.collect() }
    }

    fn row(&self, function: Function) -> &[f64] {
        let nodes = self.weights.len();
        &self.values[function.meridian_index() * nodes..][..nodes]
    }

    /// `∫ y y y dz` along the meridian, for an even sum of bands.
    fn integral(&self, functions: [Function; 3]) -> f64 {
        let [a, b, c] = functions.map(|f| self.row(f));
        self.weights.iter().zip(a).zip(b).zip(c).map(|(((w, a), b), c)| w * a * b * c).sum()
    }
}

/// All Gaunt coefficients of an order that can be different from zero, `∫ y_i y_j y_k ds` with `i ≤ j ≤ k`.
///
/// The plain way to multiply expansions, and what [`product`](crate::product()) is tested against. Number of entries:
///
/// | n | 1 | 2 | 3 | 4 | 5 | 6 | 8 | 10 | 16 |
/// |---|---|---|---|---|---|---|---|---|---|
/// | entries | 1 | 4 | 25 | 79 | 240 | 559 | 2,326 | 7,098 | 75,212 |
///
/// It grows as `n^5`: building takes 0.4 ms for n = 10 and 4 ms for n = 16.
///
/// ```
/// use sh_core::{Order, TripleTensor};
///
/// let tensor = TripleTensor::<f64>::new(Order::new(2)?);
/// // 1 · 1 = 1, with 1 = √(4π) y_0
/// let one = [(4.0 * std::f64::consts::PI).sqrt(), 0.0, 0.0, 0.0];
/// let mut out = [0.0; 4];
/// tensor.product(&one, &one, &mut out);
/// assert!((out[0] - one[0]).abs() < 1e-15 && out[1..] == [0.0; 3]);
/// # Ok::<(), sh_core::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct TripleTensor<T> {
    order: Order,
    entries: Vec<([u32; 3], T)>,
}

impl<T: Real> TripleTensor<T> {
    /// Computes all coefficients, in `f64`; accuracy as of [`gaunt`].
    pub fn new(order: Order) -> Self {
        let n = order.get();
        let meridian = Meridian::new(n, 3 * (n - 1));
        let mut entries = Vec::new();
        for first in 0..n * n {
            for second in first..n * n {
                let pair = [first, second].map(Function::new);
                thirds(n, pair, |third| {
                    let functions = [pair[0], pair[1], third];
                    let value = azimuth_integral(functions.map(|f| f.m)) * meridian.integral(functions);
                    entries.push((functions.map(|f| f.index as u32), T::from_f64(value)));
                });
            }
        }
        Self { order, entries }
    }

    /// The order of the expansions.
    pub fn order(&self) -> Order {
        self.order
    }

    /// Indices `i ≤ j ≤ k` with their coefficients.
    pub fn entries(&self) -> &[([u32; 3], T)] {
        &self.entries
    }

    /// The product of two expansions to the same order, `out_i = Σ_jk a_j b_k ∫ y_i y_j y_k`.
    ///
    /// - `a`, `b`: `[n²]`
    /// - `out`: `[n²]`, overwritten
    ///
    /// # Panics
    /// If a slice length does not match the order.
    pub fn product(&self, a: &[T], b: &[T], out: &mut [T]) {
        super::assert_lengths(self.order, [("a", a.len()), ("b", b.len()), ("out", out.len())]);
        out.fill(T::ZERO);
        for &(indices, value) in &self.entries {
            for [i, j, k] in arrangements(indices) {
                out[i] += value * a[j] * b[k];
            }
        }
    }

    /// The matrix of the product with `a`: `out_ij = Σ_k a_k ∫ y_i y_j y_k`.
    ///
    /// - `a`: `[n²]`
    /// - `out`: `[n², n²]`, symmetric, overwritten
    ///
    /// # Panics
    /// If a slice length does not match the order.
    pub fn product_matrix(&self, a: &[T], out: &mut [T]) {
        let count = self.order.coeff_count();
        super::assert_lengths(self.order, [("a", a.len())]);
        crate::order::assert_length("out", out.len(), count * count);
        out.fill(T::ZERO);
        for &(indices, value) in &self.entries {
            for [i, j, k] in arrangements(indices) {
                out[i * count + j] += value * a[k];
            }
        }
    }
}

/// The functions after the second one that may give a coefficient different from zero with a pair.
fn thirds(n: usize, [first, second]: [Function; 2], mut visit: impl FnMut(Function)) {
    let (low, high) = (first.l.abs_diff(second.l), (first.l + second.l).min(n - 1));
    let sine = (first.m < 0) != (second.m < 0);
    let (a, b) = (first.m.unsigned_abs(), second.m.unsigned_abs());
    for l in (low..=high).step_by(2) {
        let mut sizes = [a.abs_diff(b), a + b].into_iter();
        // The two are one if a or b is 0.
        let sizes = sizes.by_ref().take(if a.min(b) == 0 { 1 } else { 2 });
        for size in sizes.filter(|&size| size <= l && !(sine && size == 0)) {
            let third =
                Function::new((l * (l + 1)).wrapping_add_signed(if sine { -(size as isize) } else { size as isize }));
            if third.index >= second.index {
                visit(third);
            }
        }
    }
}

/// The different arrangements of three sorted indices.
fn arrangements([i, j, k]: [u32; 3]) -> impl Iterator<Item = [usize; 3]> {
    let all = [[i, j, k], [j, k, i], [k, i, j], [i, k, j], [k, j, i], [j, i, k]];
    let count = if i == k {
        1
    } else if i == j || j == k {
        3
    } else {
        6
    };
    all.into_iter().take(count).map(|indices| indices.map(|index| index as usize))
}
