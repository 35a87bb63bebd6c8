//! Products of any order by a separable transform.
//!
//! Gauss-Legendre rings in `z`, equally spaced in longitude: exact for a polynomial of the degree of the product times a basis
//! function. Two symmetries leave a quarter of the points. The parity of `l` is that of a function at antipodes, the parity of
//! `m` is that under a half turn about z; so an expansion is the sum of four classes, and the points `s`, `−s` and both after a
//! half turn carry the same four numbers. The classes multiply like the group,
//!
//! ```text
//! (ab)_λμ = Σ a_λ'μ' b_λ+λ',μ+μ'   modulo 2
//! ```
//!
//! Each factor: `x_λm(ring) = Σ_l P_lm(z) f_lm` over `l` of parity λ, then `f_λμ(ring, φ) = Σ_m x_λm t_m(φ)` over `m` of parity
//! μ. Expanding is the same backwards. Lanes are rings, then longitudes, then `m`, then bands.

use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::TAU;

use crate::order::assert_length;
use crate::simd::{Kernel, Lanes, dispatch};
use crate::sphere::gauss_legendre;
use crate::{Basis, Order, Real};

/// Rows of tables are padded to whole registers of the widest kind.
const WIDEST: usize = 16;

/// Multiplies expansions of any order: tables and scratch memory for three given orders.
///
/// About `16 n³` multiplications for three equal orders, in registers: 1.5 µs for n = 10 in `f32`, 24 µs for n = 32, measured
/// by `cargo bench -p prt-benches --bench sh_core_product`. The result is exact but for rounding, also where it is truncated.
///
/// Accuracy, absolute, for factors of unit length: 1e-7 in `f32` and 1e-15 in `f64` to n = 24, asserted by `tests/product.rs`.
///
/// ```
/// use sh_core::{Order, ProductTransform};
///
/// // y · y² = y³, with nothing cut off: orders 2 and 3 give order 4.
/// let [two, three, four] = [2, 3, 4].map(|n| Order::new(n).unwrap());
/// let y = [0.0, -(4.0 * std::f64::consts::PI / 3.0).sqrt(), 0.0, 0.0];
/// let (mut y_2, mut y_3) = ([0.0; 9], [0.0; 16]);
/// ProductTransform::with_orders(two, two, three).product(&y, &y, &mut y_2);
/// ProductTransform::with_orders(two, three, four).product(&y, &y_2, &mut y_3);
/// let value = sh_core::reconstruct(four, &y_3, [0.6, 0.8, 0.0]);
/// assert!((value - 0.8_f64.powi(3)).abs() < 1e-14);
/// ```
#[derive(Clone, Debug)]
pub struct ProductTransform<T> {
    /// Of the two factors and the result.
    orders: [Order; 3],
    /// Rings with z ≥ 0.
    rings: usize,
    /// Longitudes of half a turn.
    longitudes: usize,
    /// `[n², rings]` of the larger factor: `y_l|m|` at φ = 0.
    legendre: Vec<T>,
    /// `[M, longitudes]` of the larger factor: `cos mφ` or `sin |m|φ`.
    waves: Vec<T>,
    /// `[2, longitudes, M]` of the result: the same for even and for odd `m`, from the least on.
    waves_back: Vec<T>,
    /// `[M, 2, rings, bands]` of the result: `w y_l|m|` for even and for odd `l`, from the least on.
    legendre_back: Vec<T>,
    /// `[M, 2, rings]` for each factor.
    columns: [Vec<T>; 2],
    /// `[4, longitudes]`: the product on one ring.
    ring: Vec<T>,
    /// `[rings, 4, M]`: the product on all rings.
    ring_waves: Vec<T>,
}

/// Bands (or `m`) of one parity among `0..n`.
fn half(n: usize) -> usize {
    n.div_ceil(2)
}

fn padded(count: usize) -> usize {
    count.next_multiple_of(WIDEST)
}

/// All `m` of an order, from the least on.
fn all_m(n: usize) -> impl Iterator<Item = isize> + Clone {
    1 - n as isize..n as isize
}

/// The least `m` of a parity, and how many there are.
fn m_of_parity(n: usize, parity: usize) -> (isize, usize) {
    let size = if (n - 1) % 2 == parity { n - 1 } else { n.saturating_sub(2) };
    if size % 2 == parity { (-(size as isize), size + 1) } else { (0, 0) }
}

impl<T: Real> ProductTransform<T> {
    /// For factors and result of one order.
    pub fn new(order: Order) -> Self {
        Self::with_orders(order, order, order)
    }

    /// For factors of the orders `a` and `b`, and a result of order `out`.
    ///
    /// With `out = a + b − 1` nothing is cut off; a larger one adds zeros.
    pub fn with_orders(a: Order, b: Order, out: Order) -> Self {
        let degree = a.get() + b.get() + out.get() - 3;
        // Only even degrees are left by the symmetry.
        let nodes: Vec<(f64, f64)> = gauss_legendre(degree / 2 + 1).filter(|&(z, _)| z >= 0.0).collect();
        let longitudes = (degree + 1).div_ceil(2);
        let (factor, result) = (a.max(b), out);
        let mut transform = Self {
            orders: [a, b, out],
            rings: nodes.len(),
            longitudes,
            legendre: vec![T::ZERO; factor.coeff_count() * padded(nodes.len())],
            waves: vec![T::ZERO; (2 * factor.get() - 1) * padded(longitudes)],
            waves_back: vec![T::ZERO; 2 * longitudes * padded(result.get())],
            legendre_back: vec![T::ZERO; (2 * result.get() - 1) * 2 * nodes.len() * padded(half(result.get()))],
            columns: [a, b].map(|order| vec![T::ZERO; (2 * order.get() - 1) * 2 * padded(nodes.len())]),
            ring: vec![T::ZERO; 4 * padded(longitudes)],
            ring_waves: vec![T::ZERO; nodes.len() * 4 * padded(result.get())],
        };
        transform.fill_waves();
        transform.fill_legendre(&nodes);
        transform
    }

    fn fill_waves(&mut self) {
        let wave = |m: isize, k: usize| {
            let angle = TAU / 2.0 * ((k * m.unsigned_abs()) % (2 * self.longitudes)) as f64 / self.longitudes as f64;
            T::from_f64(if m < 0 { Real::sin(angle) } else { Real::cos(angle) })
        };
        let [a, b, result] = self.orders.map(Order::get);
        for (m, row) in all_m(a.max(b)).zip(self.waves.chunks_exact_mut(padded(self.longitudes))) {
            row.iter_mut().take(self.longitudes).enumerate().for_each(|(k, value)| *value = wave(m, k));
        }
        for (at, row) in self.waves_back.chunks_exact_mut(padded(result)).enumerate() {
            let (parity, k) = (at / self.longitudes, at % self.longitudes);
            let (least, count) = m_of_parity(result, parity);
            let all = (0..count).map(|j| least + 2 * j as isize);
            row.iter_mut().zip(all).for_each(|(value, m)| *value = wave(m, k));
        }
    }

    fn fill_legendre(&mut self, nodes: &[(f64, f64)]) {
        let [a, b, result] = self.orders;
        let largest = a.max(b).max(result);
        let basis = Basis::<f64>::new(largest);
        let mut y = vec![0.0; largest.coeff_count()];
        for (ring, &(z, weight)) in nodes.iter().enumerate() {
            basis.eval([Real::sqrt((1.0 - z) * (1.0 + z)), 0.0, z], &mut y);
            let along = |l: usize, m: isize| y[l * (l + 1) + m.unsigned_abs()];
            for (l, band) in a.max(b).bands() {
                for (m, i) in (-(l as isize)..).zip(band) {
                    self.legendre[i * padded(self.rings) + ring] = T::from_f64(along(l, m));
                }
            }
            // Four points, on the equator only two of them on this ring; 2 longitudes around.
            let share = if z > 0.0 { 4.0 } else { 2.0 } * weight * TAU / (2 * self.longitudes) as f64;
            for (m, rows) in all_m(result.get()).zip(0..) {
                for l in m.unsigned_abs()..result.get() {
                    let row = (rows * 2 + l % 2) * self.rings + ring;
                    self.legendre_back[row * padded(half(result.get())) + l / 2] = T::from_f64(share * along(l, m));
                }
            }
        }
    }

    /// The orders of the two factors and of the result.
    pub fn orders(&self) -> [Order; 3] {
        self.orders
    }

    /// The product of two expansions, projected to the order of the result. Does not allocate.
    ///
    /// - `a`, `b`: `[n_a²]`, `[n_b²]`
    /// - `out`: `[n²]`, overwritten
    ///
    /// # Panics
    /// If a slice length does not match its order.
    pub fn product(&mut self, a: &[T], b: &[T], out: &mut [T]) {
        let [count_a, count_b, count] = self.orders.map(Order::coeff_count);
        assert_length("a", a.len(), count_a);
        assert_length("b", b.len(), count_b);
        assert_length("out", out.len(), count);
        dispatch(self.kernel([a, b], out));
    }

    /// The work of one product.
    pub(super) fn kernel<'a>(&'a mut self, factors: [&'a [T]; 2], out: &'a mut [T]) -> Multiply<'a, T> {
        Multiply { transform: self, factors, out }
    }

    /// Columns of the matrix of the product with `a`, written as rows.
    pub(super) fn product_matrix(&mut self, a: &[T], out: &mut [T]) {
        let count = self.orders[1].coeff_count();
        let mut y_j = vec![T::ZERO; count];
        for (j, column) in out.chunks_exact_mut(count).enumerate() {
            y_j[j] = T::ONE;
            self.product(a, &y_j, column);
            y_j[j] = T::ZERO;
        }
    }
}

/// One product.
pub(super) struct Multiply<'a, T> {
    transform: &'a mut ProductTransform<T>,
    factors: [&'a [T]; 2],
    out: &'a mut [T],
}

impl<T: Real> Kernel<T> for Multiply<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes<T>>(self) {
        let Self { transform, factors, out } = self;
        for (which, coeffs) in factors.into_iter().enumerate() {
            columns::<T, V>(transform, which, coeffs);
        }
        for ring in 0..transform.rings {
            multiply_on_ring::<T, V>(transform, ring);
            waves_on_ring::<T, V>(transform, ring);
        }
        bands::<T, V>(transform, out);
    }
}

/// `x_λm(ring) = Σ_l P_lm f_lm`, rings in lanes.
#[inline(always)]
fn columns<T: Real, V: Lanes<T>>(transform: &mut ProductTransform<T>, which: usize, coeffs: &[T]) {
    let n = transform.orders[which].get();
    let stride = padded(transform.rings);
    for (m, columns) in all_m(n).zip(transform.columns[which].chunks_exact_mut(2 * stride)) {
        for at in (0..transform.rings).step_by(V::WIDTH) {
            for lambda in 0..2 {
                let mut sum = V::splat(T::ZERO);
                for l in (m.unsigned_abs()..n).skip((m.unsigned_abs() + lambda) % 2).step_by(2) {
                    let i = (l * (l + 1)).wrapping_add_signed(m);
                    sum = V::load(&transform.legendre[i * stride + at..]).mul_add(V::splat(coeffs[i]), sum);
                }
                sum.store(&mut columns[lambda * stride + at..]);
            }
        }
    }
}

/// Both factors and their product along one ring, longitudes in lanes.
#[inline(always)]
fn multiply_on_ring<T: Real, V: Lanes<T>>(transform: &mut ProductTransform<T>, ring: usize) {
    let stride = padded(transform.longitudes);
    for at in (0..transform.longitudes).step_by(V::WIDTH) {
        let a = classes::<T, V>(transform, 0, ring, at);
        let b = classes::<T, V>(transform, 1, ring, at);
        for class in 0..4 {
            let mut sum = a[0] * b[class];
            for other in 1..4 {
                sum = a[other].mul_add(b[class ^ other], sum);
            }
            sum.store(&mut transform.ring[class * stride + at..]);
        }
    }
}

/// The four classes of a factor at the longitudes from `at`; the class is `2 λ + μ`.
#[inline(always)]
fn classes<T: Real, V: Lanes<T>>(transform: &ProductTransform<T>, which: usize, ring: usize, at: usize) -> [V; 4] {
    let n = transform.orders[which].get();
    let larger = transform.orders[0].max(transform.orders[1]).get();
    let (rings, longitudes) = (padded(transform.rings), padded(transform.longitudes));
    let waves = transform.waves[(larger - n) * longitudes..].chunks_exact(longitudes);
    let columns = transform.columns[which].chunks_exact(2 * rings);
    let mut sums = [V::splat(T::ZERO); 4];
    for mu in 0..2 {
        // The first m is 1 − n.
        let first = (n + 1 + mu) % 2;
        let rows = columns.clone().skip(first).step_by(2).zip(waves.clone().skip(first).step_by(2));
        let [mut even, mut odd] = [V::splat(T::ZERO); 2];
        for (column, wave) in rows {
            let wave = V::load(&wave[at..]);
            even = wave.mul_add(V::splat(column[ring]), even);
            odd = wave.mul_add(V::splat(column[rings + ring]), odd);
        }
        (sums[mu], sums[2 + mu]) = (even, odd);
    }
    sums
}

/// `Σ_φ (ab)_λμ t_m(φ)` for one ring, `m` in lanes.
#[inline(always)]
fn waves_on_ring<T: Real, V: Lanes<T>>(transform: &mut ProductTransform<T>, ring: usize) {
    let n = transform.orders[2].get();
    let (longitudes, stride) = (transform.longitudes, padded(n));
    for class in 0..4 {
        let values = &transform.ring[class * padded(longitudes)..][..longitudes];
        let waves = &transform.waves_back[(class % 2) * longitudes * stride..][..longitudes * stride];
        let (_, count) = m_of_parity(n, class % 2);
        for at in (0..count).step_by(V::WIDTH) {
            let mut sum = V::splat(T::ZERO);
            for (row, &value) in waves.chunks_exact(stride).zip(values) {
                sum = V::load(&row[at..]).mul_add(V::splat(value), sum);
            }
            sum.store(&mut transform.ring_waves[(ring * 4 + class) * stride + at..]);
        }
    }
}

/// `Σ_ring w P_lm(ring) ...`, bands of one parity in lanes.
#[inline(always)]
fn bands<T: Real, V: Lanes<T>>(transform: &ProductTransform<T>, out: &mut [T]) {
    let n = transform.orders[2].get();
    let (rings, bands, stride) = (transform.rings, padded(half(n)), padded(n));
    for (m, row) in all_m(n).zip(0..) {
        let mu = m.unsigned_abs() % 2;
        let column = (m - m_of_parity(n, mu).0) as usize / 2;
        for lambda in 0..2 {
            let legendre = &transform.legendre_back[(row * 2 + lambda) * rings * bands..][..rings * bands];
            let waves = transform.ring_waves[(2 * lambda + mu) * stride + column..].iter().step_by(4 * stride);
            // Bands below |m| are zero.
            let first = (m.unsigned_abs() / 2) / V::WIDTH * V::WIDTH;
            for at in (first..half(n)).step_by(V::WIDTH) {
                let mut sum = V::splat(T::ZERO);
                for (row, &wave) in legendre.chunks_exact(bands).zip(waves.clone()) {
                    sum = V::load(&row[at..]).mul_add(V::splat(wave), sum);
                }
                let mut lanes = [T::ZERO; WIDEST];
                sum.store(&mut lanes);
                let parity_bands = (lambda..n).step_by(2).skip(at).take(V::WIDTH);
                for (l, &value) in parity_bands.zip(&lanes).filter(|&(l, _)| l >= m.unsigned_abs()) {
                    out[(l * (l + 1)).wrapping_add_signed(m)] = value;
                }
            }
        }
    }
}
