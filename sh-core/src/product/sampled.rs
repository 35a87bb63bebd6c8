//! Products of small orders at sample points.
//!
//! With `f = f₊ + f₋`, the even and the odd bands: at a point `s` and its antipode `f(±s) = f₊(s) ± f₋(s)`. So from the
//! samples of both factors at one point of each pair,
//!
//! ```text
//! (ab)₊ = a₊b₊ + a₋b₋,   (ab)₋ = a₊b₋ + a₋b₊
//! ```
//!
//! and the coefficients of the product are sums over the pairs, exact for the rules in [`octahedral`](super::octahedral).
//! Sampling has a point in each lane, expanding has a coefficient in each lane: nothing is summed across a register.

use super::octahedral::{EVEN, ODD, Row, Samples};
use crate::Real;
use crate::simd::{Kernel, Lanes};

/// Several products, one after the other. `N` is the order; that of the samples may be larger.
pub(super) struct Products<'a, T, const N: usize, const N2: usize, const PAIRS: usize, const ROOM: usize> {
    pub(super) samples: &'a Samples<T, N2, PAIRS, ROOM>,
    /// `[D, N²]`
    pub(super) a: &'a [T],
    /// `[D, N²]`
    pub(super) b: &'a [T],
    /// `[D, N²]`
    pub(super) out: &'a mut [T],
}

impl<T: Real, const N: usize, const N2: usize, const PAIRS: usize, const ROOM: usize> Kernel<T>
    for Products<'_, T, N, N2, PAIRS, ROOM>
{
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes<T>>(self) {
        let factors = self.a.chunks_exact(N * N).zip(self.b.chunks_exact(N * N));
        for ((a, b), out) in factors.zip(self.out.chunks_exact_mut(N * N)) {
            let mut product = [Row([T::ZERO; ROOM]); 2];
            for at in (0..PAIRS).step_by(V::WIDTH) {
                let a = sample::<T, V, N, ROOM>(a, &self.samples.values, at);
                let b = sample::<T, V, N, ROOM>(b, &self.samples.values, at);
                store_product(a, b, at, &mut product);
            }
            expand::<T, V, N, N2, PAIRS, ROOM>(self.samples, &product, out);
        }
    }
}

/// The square of one expansion, sampled once.
pub(super) struct Square<'a, T, const N: usize, const N2: usize, const PAIRS: usize, const ROOM: usize> {
    pub(super) samples: &'a Samples<T, N2, PAIRS, ROOM>,
    pub(super) a: &'a [T],
    pub(super) out: &'a mut [T],
}

impl<T: Real, const N: usize, const N2: usize, const PAIRS: usize, const ROOM: usize> Kernel<T>
    for Square<'_, T, N, N2, PAIRS, ROOM>
{
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes<T>>(self) {
        let mut product = [Row([T::ZERO; ROOM]); 2];
        for at in (0..PAIRS).step_by(V::WIDTH) {
            let a = sample::<T, V, N, ROOM>(self.a, &self.samples.values, at);
            store_product(a, a, at, &mut product);
        }
        expand::<T, V, N, N2, PAIRS, ROOM>(self.samples, &product, self.out);
    }
}

/// The matrix of the product with `a`: column `j` is the product with `y_j`.
pub(super) struct Matrix<'a, T, const N: usize, const N2: usize, const PAIRS: usize, const ROOM: usize> {
    pub(super) samples: &'a Samples<T, N2, PAIRS, ROOM>,
    pub(super) a: &'a [T],
    /// `[N², N²]`; columns are written as rows.
    pub(super) out: &'a mut [T],
}

impl<T: Real, const N: usize, const N2: usize, const PAIRS: usize, const ROOM: usize> Kernel<T>
    for Matrix<'_, T, N, N2, PAIRS, ROOM>
{
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes<T>>(self) {
        let mut sampled = [Row([T::ZERO; ROOM]); 2];
        for at in (0..PAIRS).step_by(V::WIDTH) {
            let a = sample::<T, V, N, ROOM>(self.a, &self.samples.values, at);
            a[0].store(&mut sampled[0].0[at..]);
            a[1].store(&mut sampled[1].0[at..]);
        }
        for (j, out) in self.out.chunks_exact_mut(N * N).enumerate() {
            // An even function keeps the parity of a, an odd one swaps it.
            let parity = j.isqrt() % 2;
            let mut product = [Row([T::ZERO; ROOM]); 2];
            for at in (0..PAIRS).step_by(V::WIDTH) {
                let y = V::load(&self.samples.values[j].0[at..]);
                for (p, product) in product.iter_mut().enumerate() {
                    (y * V::load(&sampled[p ^ parity].0[at..])).store(&mut product.0[at..]);
                }
            }
            expand::<T, V, N, N2, PAIRS, ROOM>(self.samples, &product, out);
        }
    }
}

/// Even and odd part of an expansion at the points from `at`.
#[inline(always)]
fn sample<T: Real, V: Lanes<T>, const N: usize, const ROOM: usize>(
    coeffs: &[T],
    values: &[Row<T, ROOM>],
    at: usize,
) -> [V; 2] {
    let mut parts = [V::splat(T::ZERO); 2];
    for l in 0..N {
        for i in l * l..(l + 1) * (l + 1) {
            parts[l % 2] = V::load(&values[i].0[at..]).mul_add(V::splat(coeffs[i]), parts[l % 2]);
        }
    }
    parts
}

#[inline(always)]
fn store_product<T: Real, V: Lanes<T>, const ROOM: usize>(
    a: [V; 2],
    b: [V; 2],
    at: usize,
    product: &mut [Row<T, ROOM>; 2],
) {
    a[0].mul_add(b[0], a[1] * b[1]).store(&mut product[0].0[at..]);
    a[0].mul_add(b[1], a[1] * b[0]).store(&mut product[1].0[at..]);
}

/// The coefficients of a function from its even and odd part at the points.
#[inline(always)]
fn expand<T: Real, V: Lanes<T>, const N: usize, const N2: usize, const PAIRS: usize, const ROOM: usize>(
    samples: &Samples<T, N2, PAIRS, ROOM>,
    parts: &[Row<T, ROOM>; 2],
    out: &mut [T],
) {
    let (mut even, mut odd) = (Row([T::ZERO; EVEN]), Row([T::ZERO; ODD]));
    // Bands 0, 2, 4 have 1, 6, 15 functions up to there; bands 1, 3, 5 have 3, 10, 21.
    let even_count = N.div_ceil(2) * (2 * N.div_ceil(2) - 1);
    let odd_count = (N / 2) * (2 * (N / 2) + 1);
    expand_part::<T, V, EVEN, PAIRS, ROOM>(&samples.even, &parts[0], even_count, &mut even);
    expand_part::<T, V, ODD, PAIRS, ROOM>(&samples.odd, &parts[1], odd_count, &mut odd);
    let mut packed = [0; 2];
    for l in 0..N {
        let (count, start) = (2 * l + 1, packed[l % 2]);
        let row: &[T] = if l % 2 == 0 { &even.0 } else { &odd.0 };
        out[l * l..l * l + count].copy_from_slice(&row[start..start + count]);
        packed[l % 2] += count;
    }
}

#[inline(always)]
fn expand_part<T: Real, V: Lanes<T>, const WIDTH: usize, const PAIRS: usize, const ROOM: usize>(
    rows: &[Row<T, WIDTH>; PAIRS],
    part: &Row<T, ROOM>,
    count: usize,
    out: &mut Row<T, WIDTH>,
) {
    for at in (0..count).step_by(V::WIDTH) {
        // Two sums hide the latency.
        let mut sums = [V::splat(T::ZERO); 2];
        for (point, row) in rows.iter().enumerate() {
            sums[point % 2] = V::load(&row.0[at..]).mul_add(V::splat(part.0[point]), sums[point % 2]);
        }
        (sums[0] + sums[1]).store(&mut out.0[at..]);
    }
}
