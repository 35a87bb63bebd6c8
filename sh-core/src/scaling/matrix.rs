//! The matrix that scales an expansion.

use alloc::vec::Vec;

use super::integral::{blocks, entry_count, of_function, of_tau};
use super::tau::{Preserve, Tau};
use crate::order::assert_length;
use crate::{Error, Order, Real, index};

/// Scales expansions about +z: coefficients of `F_r` into those of `F(θ, φ) = F_r(τ(θ), φ)`.
///
/// `M_ij = ∫∫ y_j(τ(θ), φ) y_i(θ, φ) η(θ) dθ dφ` with `η = sinθ`, or `sin τ τ′` to preserve energy. Only entries with
/// `m = m′` are not zero, `n(2n²+1)/3` for a square matrix, and those of `m` and `−m` are equal: one block per `|m|` is kept.
///
/// A light of order `n′` captured at `n′` is scaled exactly by the rectangular `[n², n′²]` matrix; capturing at n + 2 or
/// n + 4 is 7 to 70 times more accurate than at n. Truncated matrices do not compose: always scale from what was captured.
///
/// Accuracy: entries to 1e-12 for n, n′ ≤ 32 and k from 1e-6 to 1e6 before they are rounded to the type; in `f32` scaled
/// coefficients to 2e-7 for a vector of unit length and n ≤ 10; asserted by `tests/scaling.rs`.
///
/// ```
/// use sh_core::{Order, Preserve, ScalingMatrix, Tau};
///
/// // Captured with 6 bands on a sphere around an object, wanted with 4 from half as far again.
/// let (order, captured) = (Order::new(4)?, Order::new(6)?);
/// let matrix = ScalingMatrix::<f32>::new(order, captured, Tau::cone(1.5), Preserve::Value)?;
/// let mut occlusion = [0.0; 36];
/// occlusion[0] = 1.0;
/// let mut scaled = [0.0; 16];
/// matrix.apply(&occlusion, &mut scaled);
/// assert!((scaled[0] - 1.0).abs() < 1e-6); // a constant stays
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// Source: [WXZ06](crate#references) eq. 6 and its appendix.
#[derive(Clone, Debug, PartialEq)]
pub struct ScalingMatrix<T> {
    order: Order,
    source_order: Order,
    /// For `|m| = 0, 1, ...` the rows `l = |m|..n` over the columns `l′ = |m|..n′`.
    entries: Vec<T>,
}

impl<T: Real> ScalingMatrix<T> {
    /// The matrix of a known scaling function.
    ///
    /// - `order`: of the scaled expansion, `n`
    /// - `source_order`: of the captured one, `n′`
    ///
    /// Cost: some thousand evaluations of both bases. For many `k` see [`ScalingTable`](crate::ScalingTable).
    ///
    /// # Errors
    /// [`Error::Scaling`] if `k` or `alpha` is outside the range stated at [`Tau`].
    pub fn new(order: Order, source_order: Order, tau: Tau, preserve: Preserve) -> Result<Self, Error> {
        let tau = tau.validate()?;
        Ok(Self::from_entries(order, source_order, of_tau(order, source_order, tau, preserve)))
    }

    /// The matrix of any scaling function.
    ///
    /// - `tau`: `[τ, τ′]` at an angle `θ` in `0..π`; `τ′` is used to preserve energy only. It may jump and bend.
    ///
    /// Accuracy: 1e-12 where `τ` is smooth or bends or jumps; features narrower than 0.01 may be overlooked. A NaN gives NaN.
    pub fn from_function(order: Order, source_order: Order, preserve: Preserve, tau: impl Fn(f64) -> [f64; 2]) -> Self {
        Self::from_entries(order, source_order, of_function(order, source_order, tau, preserve))
    }

    fn from_entries(order: Order, source_order: Order, entries: Vec<f64>) -> Self {
        Self { order, source_order, entries: entries.into_iter().map(T::from_f64).collect() }
    }

    /// A matrix to be overwritten.
    pub(super) fn zero(order: Order, source_order: Order) -> Self {
        let count = entry_count(order.get(), source_order.get());
        Self { order, source_order, entries: alloc::vec![T::ZERO; count] }
    }

    /// What is stored, one block after the other.
    pub(super) fn stored(&self) -> &[T] {
        &self.entries
    }

    /// What is stored, to be overwritten.
    pub(super) fn stored_mut(&mut self) -> &mut [T] {
        &mut self.entries
    }

    /// The order `n` of the scaled expansion.
    pub fn order(&self) -> Order {
        self.order
    }

    /// The order `n′` of the captured expansion.
    pub fn source_order(&self) -> Order {
        self.source_order
    }

    /// Scales an expansion about +z.
    ///
    /// - `coeffs`: `[n′²]`, captured
    /// - `out`: `[n²]`, overwritten
    ///
    /// Does not allocate.
    ///
    /// # Panics
    /// If a slice length does not match the orders.
    pub fn apply(&self, coeffs: &[T], out: &mut [T]) {
        assert_length("coeffs", coeffs.len(), self.source_order.coeff_count());
        assert_length("out", out.len(), self.order.coeff_count());
        out.fill(T::ZERO);
        let (n, source) = (self.order.get(), self.source_order.get());
        for (m, range) in blocks(n, source) {
            for (l, row) in (m..n).zip(self.entries[range].chunks_exact(source - m)) {
                let (mut plus, mut minus) = (T::ZERO, T::ZERO);
                for (l, &entry) in (m..).zip(row) {
                    let centre = l * (l + 1);
                    plus += entry * coeffs[centre + m];
                    minus += entry * coeffs[centre - m];
                }
                let centre = l * (l + 1);
                out[centre + m] = plus;
                out[centre - m] = minus;
            }
        }
    }

    /// Every entry that may be other than zero, as `(i, j, M_ij)`: `n(2n²+1)/3` of them in a square matrix.
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize, T)> {
        let (n, source) = (self.order.get(), self.source_order.get());
        blocks(n, source).flat_map(move |(m, range)| {
            let columns = source - m;
            let signs = if m == 0 { 0..1 } else { 0..2 };
            signs.map(move |sign| if sign == 0 { m as isize } else { -(m as isize) }).flat_map(move |signed| {
                let block = self.entries[range.clone()].iter().enumerate();
                block.map(move |(k, &entry)| (index(m + k / columns, signed), index(m + k % columns, signed), entry))
            })
        })
    }

    /// Writes the whole matrix.
    ///
    /// - `out`: `[n², n′²]` row-major, overwritten
    ///
    /// # Panics
    /// If `out` has another length.
    pub fn to_dense(&self, out: &mut [T]) {
        let columns = self.source_order.coeff_count();
        assert_length("out", out.len(), self.order.coeff_count() * columns);
        out.fill(T::ZERO);
        for (i, j, entry) in self.entries() {
            out[i * columns + j] = entry;
        }
    }
}
