//! The same for orders without straight-line kernels, from tables.

use alloc::vec;
use alloc::vec::Vec;

use super::exchange::Rows;
use super::quad::Quad;
use super::zxzxz::invert;
use super::zyz::{Turn, Zyz};
use crate::order::assert_length;
use crate::{Order, Real};

/// The `ZXZXZ` rotation of [`rotate`](crate::rotate), with tables for one order, up to [`Order::MAX`].
///
/// The tables take about `n³/3` numbers: 0.2 MB in `f32` for n = 50, 180 MB for n = 512. Applying takes about `2n³/3`
/// multiplications, half of those of [`ShRotation`](crate::ShRotation), and nothing has to be built for a new rotation.
///
/// Accuracy in `f64`: the basis at a direction becomes that at the rotated one to 3e-14 for n ≤ 64 and 2e-13 for n ≤ 256
/// (measured: 1.5e-14 and 8e-14); the factors hold for n = 512, with 2e-13 (measured: 7e-14). Asserted by
/// `tests/rotation_angles.rs`.
///
/// For n ≤ 10, [`rotate`](crate::rotate) is three to four times faster.
///
/// ```
/// use sh_core::{Order, Zxzxz, Zyz};
///
/// let order = Order::new(32)?;
/// let tables = Zxzxz::<f64>::new(order);
/// let f: Vec<f64> = (0..1024).map(|i| (i as f64).sin()).collect();
/// let (mut turned, mut back) = (vec![0.0; 1024], vec![0.0; 1024]);
/// tables.rotate(&Zyz::from_angles([0.1, 0.2, 0.3]), &f, &mut turned);
/// tables.rotate(&Zyz::from_angles([-0.3, -0.2, -0.1]), &turned, &mut back);
/// assert!(f.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-13));
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// Source: [SLS05](crate#references), "Digression on SH rotation"; [KKP05](crate#references) section 2.2.
#[derive(Clone, Debug)]
pub struct Zxzxz<T> {
    order: Order,
    /// For each band from 1, the factors `[K, K]` of the exchange of y and z, for its `K = l/2 + 1` quads.
    factors: Vec<Quad<T>>,
}

fn quad_count(l: usize) -> usize {
    l / 2 + 1
}

impl<T: Real> Zxzxz<T> {
    /// Builds the tables, in `f64`: `n³/3` divisions.
    pub fn new(order: Order) -> Self {
        let count = (1..order.get()).map(|l| quad_count(l).pow(2)).sum();
        let mut factors = vec![Quad::ZERO; count];
        let mut rest = factors.as_mut_slice();
        for l in 1..order.get() {
            let (band, following) = rest.split_at_mut(quad_count(l).pow(2));
            fill_band(l, band);
            rest = following;
        }
        Self { order, factors }
    }

    /// The order of the expansions that it rotates.
    pub fn order(&self) -> Order {
        self.order
    }

    /// Rotates an expansion. Does not allocate.
    ///
    /// - `zyz`: the rotation or mirror image, for instance from [`Zyz::from_matrix`]
    /// - `coeffs`: `[n²]`
    /// - `out`: `[n²]`, overwritten
    ///
    /// # Panics
    /// If a slice length does not match the order.
    pub fn rotate(&self, zyz: &Zyz<T>, coeffs: &[T], out: &mut [T]) {
        assert_length("coeffs", coeffs.len(), self.order.coeff_count());
        assert_length("out", out.len(), self.order.coeff_count());
        // Room for the quads of the last band.
        match self.order.get() {
            ..=10 => self.rotate_with::<5>(zyz, coeffs, out),
            11..=32 => self.rotate_with::<16>(zyz, coeffs, out),
            33..=128 => self.rotate_with::<64>(zyz, coeffs, out),
            _ => self.rotate_with::<256>(zyz, coeffs, out),
        }
        if zyz.inverted {
            invert(self.order, out);
        }
    }

    fn rotate_with<const K: usize>(&self, zyz: &Zyz<T>, coeffs: &[T], out: &mut [T]) {
        let [cos_beta, sin_beta] = zyz.beta;
        let turns = [zyz.alpha, [cos_beta, -sin_beta], zyz.gamma].map(|turn| Turns::<T, K>::new(self.order, turn));
        let (mut a, mut b) = ([Quad::ZERO; K], [Quad::ZERO; K]);
        out[0] = coeffs[0];
        let mut rest = self.factors.as_slice();
        for (l, band) in self.order.bands().skip(1) {
            let count = quad_count(l);
            let (factors, following) = rest.split_at(count * count);
            rest = following;
            let swap = if l % 2 == 0 { Quad::after_even_band } else { Quad::after_odd_band };
            let (a, b) = (&mut a[..count], &mut b[..count]);
            for (i, a) in a.iter_mut().enumerate() {
                *a = turns[2].turn(i, Quad::load(l, i, &coeffs[band.clone()]));
            }
            exchange(factors, a, b);
            for (i, (a, b)) in a.iter_mut().zip(b.iter()).enumerate() {
                *a = turns[1].turn(i, swap(*b));
            }
            exchange(factors, a, b);
            for (i, b) in b.iter().enumerate() {
                turns[0].turn(i, swap(*b)).store(l, i, &mut out[band.clone()]);
            }
        }
    }
}

/// Spreads the rows of the exchange over the lanes of the quads. There is no sine of m = 0, but its entries are 0 anyway, because
/// `d_k0(π/2)` is for odd `l + k`.
fn fill_band<T: Real>(l: usize, factors: &mut [Quad<T>]) {
    let mut rows = Rows::new(l);
    let mut row = vec![0.0; l + 2];
    for k in 0..=l {
        rows.next(&mut row[..=l]);
        // The lanes whose sums become m = k, from even and from odd m; the cosine for even m if l + k is even.
        let [from_even, from_odd] = if (l + k).is_multiple_of(2) { [0, 1] } else { [3, 2] };
        let quads = factors.chunks_exact_mut(quad_count(l)).nth(k / 2).expect("a row of quads for two rows");
        for (quad, entries) in quads.iter_mut().zip(row.chunks(2)) {
            quad.0[from_even] = T::from_f64(entries[0]);
            quad.0[from_odd] = T::from_f64(*entries.get(1).unwrap_or(&0.0));
        }
    }
}

/// The factors times the quads.
fn exchange<T: Real>(factors: &[Quad<T>], quads: &[Quad<T>], out: &mut [Quad<T>]) {
    for (out, factors) in out.iter_mut().zip(factors.chunks_exact(quads.len())) {
        let mut sum = Quad::ZERO;
        for (&factor, &quad) in factors.iter().zip(quads) {
            sum = sum + factor * quad;
        }
        *out = sum;
    }
}

/// Cosines and sines of the multiples of one angle, as in `turn.rs`, for a number of quads that is known at run time. The
/// multiples are computed in `f64`.
#[derive(Clone, Debug)]
struct Turns<T, const K: usize> {
    cos: [Quad<T>; K],
    sin: [Quad<T>; K],
}

impl<T: Real, const K: usize> Turns<T, K> {
    fn new(order: Order, turn: Turn<T>) -> Self {
        let [c, s] = turn.map(T::to_f64);
        let mut turns = Self { cos: [Quad::ZERO; K], sin: [Quad::ZERO; K] };
        let (mut cos, mut sin) = (1.0, 0.0);
        for i in 0..order.get().div_ceil(2) {
            let [odd_cos, odd_sin] = [cos * c - sin * s, sin * c + cos * s];
            let [c_even, c_odd, s_even, s_odd] = [cos, odd_cos, sin, odd_sin].map(T::from_f64);
            (turns.cos[i], turns.sin[i]) =
                (Quad([c_even, c_odd, c_odd, c_even]), Quad([-s_even, -s_odd, s_odd, s_even]));
            (cos, sin) = (odd_cos * c - odd_sin * s, odd_sin * c + odd_cos * s);
        }
        turns
    }

    #[inline(always)]
    fn turn(&self, i: usize, quad: Quad<T>) -> Quad<T> {
        self.cos[i] * quad + self.sin[i] * quad.reversed()
    }
}
