//! The basis at many directions at once, in registers across directions.

use alloc::vec;
use alloc::vec::Vec;
use core::marker::PhantomData;
use core::ops::Range;

use super::recurrence::{self, Tabled};
use super::{Basis, Sink, Tables, Values, unrolled};
use crate::order::assert_length;
use crate::simd::{Kernel, Lanes, dispatch};
use crate::{Order, Real};

/// Directions in a block of [`Basis::eval_blocks`].
pub const BLOCK: usize = 16;

impl<T: Real> Basis<T> {
    /// Evaluates all basis functions at many unit directions, one vector after the other.
    ///
    /// `out[d, i] = y_i(directions[d])`, up to rounding as [`eval`](crate::eval) does for each.
    ///
    /// - `directions`: `[D]`
    /// - `out`: `[D, n²]`, overwritten
    ///
    /// Several directions share a register, with AVX2 or AVX-512 where the machine has them. The value at a direction does
    /// not depend on its place. Accuracy as stated for [`eval`](crate::eval), asserted by `tests/accuracy.rs`. Allocates for
    /// n > 10, room for one group of directions.
    ///
    /// ```
    /// use sh_core::{Basis, Order, fibonacci};
    ///
    /// let directions = fibonacci(1000);
    /// let basis = Basis::<f64>::new(Order::new(4)?);
    /// let mut y = vec![0.0; 1000 * 16];
    /// basis.eval_batch(&directions, &mut y);
    /// let power: f64 = y[16 * 7..16 * 8].iter().map(|y| y * y).sum();
    /// assert!((power - 16.0 / (4.0 * std::f64::consts::PI)).abs() < 1e-14);
    /// # Ok::<(), sh_core::Error>(())
    /// ```
    ///
    /// # Panics
    /// If `out` is not `[D, n²]`.
    pub fn eval_batch(&self, directions: &[[T; 3]], out: &mut [T]) {
        let count = self.order().coeff_count();
        assert_length("out", out.len(), directions.len() * count);
        match &self.tables {
            Tables::Wide(_) => {
                directions.iter().zip(out.chunks_exact_mut(count)).for_each(|(&s, out)| self.eval(s, out));
            }
            tables => dispatch(Rows { order: self.order(), tables, directions, out }),
        }
    }

    /// Evaluates all basis functions at many unit directions, in coefficient-major blocks of [`BLOCK`] directions: what
    /// code in registers of any width can go on with.
    ///
    /// `out[b, i, k] = y_i(directions[b · 16 + k])`; in the last block 0 beyond the last direction.
    ///
    /// - `directions`: `[D]`
    /// - `out`: `[⌈D/16⌉, n², 16]`, overwritten
    ///
    /// The same values as [`Basis::eval_batch`], and faster: nothing is transposed. For the most speed pass so few
    /// directions at a time that `out` stays in the first cache, and use them at once. Does not allocate.
    ///
    /// ```
    /// use sh_core::{BLOCK, Basis, Order, fibonacci};
    ///
    /// let directions = fibonacci(BLOCK);
    /// let basis = Basis::<f64>::new(Order::new(2)?);
    /// let mut y = [0.0; 4 * BLOCK];
    /// basis.eval_blocks(&directions, &mut y);
    /// let heights = &y[2 * BLOCK..3 * BLOCK]; // y_2 = √(3/(4π)) z
    /// assert!(heights.iter().zip(&directions).all(|(y, [_, _, z])| (y - 0.4886025119029199 * z).abs() < 1e-15));
    /// # Ok::<(), sh_core::Error>(())
    /// ```
    ///
    /// # Panics
    /// If `out` is not `[⌈D/16⌉, n², 16]`.
    pub fn eval_blocks(&self, directions: &[[T; 3]], out: &mut [T]) {
        let size = self.order().coeff_count() * BLOCK;
        assert_length("out", out.len(), directions.len().div_ceil(BLOCK) * size);
        match &self.tables {
            Tables::Wide(_) => self.eval_wide_blocks(directions, out),
            tables => dispatch(Blocks { order: self.order(), tables, directions, out }),
        }
        let used = directions.len() % BLOCK;
        if used > 0 {
            out[directions.len() / BLOCK * size..]
                .as_chunks_mut::<BLOCK>()
                .0
                .iter_mut()
                .for_each(|y| y[used..].fill(T::ZERO));
        }
    }

    /// Whether the basis can be evaluated in lanes of `T`: not at orders that are beyond its range.
    pub(crate) fn is_native(&self) -> bool {
        !matches!(self.tables, Tables::Wide(_))
    }

    /// Hands every `y_i` at some directions to `sink`. The basis [is native](Self::is_native).
    #[inline(always)]
    pub(crate) fn eval_lanes<V: Lanes<T>>(&self, direction: [V; 3], sink: &mut impl Sink<V>) {
        match &self.tables {
            Tables::Unrolled => {
                small_order!(self.order, N => unrolled::kernel::<T, V, N>(direction, sink), else unreachable!());
            }
            Tables::Native(tables) => recurrence::eval_lanes(self.order, direction, tables, sink),
            Tables::Wide(_) => unreachable!("checked by the caller"),
        }
    }

    /// Orders beyond the range of `T`, one direction at a time.
    fn eval_wide_blocks(&self, directions: &[[T; 3]], out: &mut [T]) {
        let count = self.order().coeff_count();
        let mut y = vec![T::ZERO; count];
        for (directions, out) in directions.chunks(BLOCK).zip(out.chunks_exact_mut(count * BLOCK)) {
            for (k, &direction) in directions.iter().enumerate() {
                self.eval(direction, &mut y);
                out.as_chunks_mut::<BLOCK>().0.iter_mut().zip(&y).for_each(|(out, &y)| out[k] = y);
            }
        }
    }
}

/// [`Basis::eval_batch`] in lanes.
struct Rows<'a, T> {
    order: Order,
    tables: &'a Tables<T>,
    directions: &'a [[T; 3]],
    out: &'a mut [T],
}

impl<T: Real> Kernel<T> for Rows<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes<T>>(self) {
        match self.tables {
            Tables::Native(tables) => self.run_tabled::<V>(tables),
            _ => {
                small_order!(self.order, N => self.run_small::<V, N>(), else unreachable!("small orders have no tables"));
            }
        }
    }
}

impl<T: Real> Rows<'_, T> {
    #[inline(always)]
    fn run_small<V: Lanes<T>, const N: usize>(self) {
        let mut y = [V::splat(T::ZERO); unrolled::MAX_ORDER * unrolled::MAX_ORDER];
        let y = &mut y[..N * N];
        for (group, direction) in Groups::<T, V>::new(self.directions) {
            unrolled::kernel::<T, V, N>(direction, &mut Values(y));
            prefetch_ahead::<T, V>(self.out, N * N, &group);
            store_rows(y, &mut self.out[group.start * N * N..group.end * N * N]);
        }
    }

    #[inline(always)]
    fn run_tabled<V: Lanes<T>>(self, tables: &Tabled<T>) {
        let count = self.order.coeff_count();
        let mut y: Vec<V> = vec![V::splat(T::ZERO); count];
        for (group, direction) in Groups::<T, V>::new(self.directions) {
            recurrence::eval_lanes(self.order, direction, tables, &mut Values(&mut y));
            prefetch_ahead::<T, V>(self.out, count, &group);
            store_rows(&y, &mut self.out[group.start * count..group.end * count]);
        }
    }
}

/// [`Basis::eval_blocks`] in lanes.
struct Blocks<'a, T> {
    order: Order,
    tables: &'a Tables<T>,
    directions: &'a [[T; 3]],
    out: &'a mut [T],
}

impl<T: Real> Kernel<T> for Blocks<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes<T>>(self) {
        match self.tables {
            Tables::Native(tables) => self.run_tabled::<V>(tables),
            _ => {
                small_order!(self.order, N => self.run_small::<V, N>(), else unreachable!("small orders have no tables"));
            }
        }
    }
}

impl<T: Real> Blocks<'_, T> {
    #[inline(always)]
    fn run_small<V: Lanes<T>, const N: usize>(self) {
        for (group, direction) in Groups::<T, V>::new(self.directions) {
            let (block, part) = (group.start / BLOCK, group.start % BLOCK / V::WIDTH);
            prefetch_ahead::<T, V>(self.out, N * N, &group);
            let out = &mut self.out.as_chunks_mut().0[block * N * N..][..N * N];
            unrolled::kernel::<T, V, N>(direction, &mut BlockLanes { out, part });
        }
    }

    #[inline(always)]
    fn run_tabled<V: Lanes<T>>(self, tables: &Tabled<T>) {
        let count = self.order.coeff_count();
        for (group, direction) in Groups::<T, V>::new(self.directions) {
            let (block, part) = (group.start / BLOCK, group.start % BLOCK / V::WIDTH);
            prefetch_ahead::<T, V>(self.out, count, &group);
            let out = &mut self.out.as_chunks_mut().0[block * count..][..count];
            recurrence::eval_lanes(self.order, direction, tables, &mut BlockLanes { out, part });
        }
    }
}

/// Part of the lanes of a block `[n²]`: one of as many as registers make up a row.
pub(super) struct BlockLanes<'a, T> {
    pub(super) out: &'a mut [[T; BLOCK]],
    pub(super) part: usize,
}

impl<T: Real, V: Lanes<T>> Sink<V> for BlockLanes<'_, T> {
    #[inline(always)]
    fn put(&mut self, i: usize, value: V) {
        let row = &mut self.out[i];
        // A whole row has no part to find.
        value.store(if V::WIDTH == BLOCK { row } else { &mut row[self.part * V::WIDTH..] });
    }
}

/// The directions in groups that fill a register: their range, and their components. The last group may be short; its other
/// lanes then hold the zero vector.
pub(crate) struct Groups<'a, T, V> {
    directions: &'a [[T; 3]],
    start: usize,
    lanes: PhantomData<V>,
}

impl<'a, T: Real, V: Lanes<T>> Groups<'a, T, V> {
    #[inline(always)]
    pub(crate) fn new(directions: &'a [[T; 3]]) -> Self {
        Self { directions, start: 0, lanes: PhantomData }
    }
}

impl<T: Real, V: Lanes<T>> Iterator for Groups<'_, T, V> {
    type Item = (Range<usize>, [V; 3]);

    #[inline(always)]
    fn next(&mut self) -> Option<Self::Item> {
        let start = self.start;
        let rest = self.directions.get(start..).filter(|rest| !rest.is_empty())?;
        self.start += V::WIDTH;
        if rest.len() >= V::WIDTH {
            return Some((start..start + V::WIDTH, V::load_directions(rest)));
        }
        let mut padded = [[T::ZERO; 3]; BLOCK];
        padded[..rest.len()].copy_from_slice(rest);
        Some((start..self.directions.len(), V::load_directions(&padded)))
    }
}

/// Groups that lie between the one that is written and the one whose lines are fetched.
const GROUPS_AHEAD: usize = 2;

/// Numbers per direction from which on it pays.
const BURST: usize = 48;

/// Fetches the lines of an output `[D, size]` that a group to come will write.
///
/// Groups are written in bursts of a few kilobytes, which the machine does not foresee as it does a steady stream: beyond
/// the second cache this makes them up to twice as fast.
#[inline(always)]
pub(super) fn prefetch_ahead<T: Real, V: Lanes<T>>(out: &mut [T], size: usize, group: &Range<usize>) {
    if size < BURST {
        return;
    }
    let start = (group.start + GROUPS_AHEAD * V::WIDTH) * size;
    let end = out.len().min(start + V::WIDTH * size);
    if let Some(lines) = out.get_mut(start..end) {
        V::prefetch(lines);
    }
}

/// Writes the lanes of `rows` as vectors, one after the other: as many as fit `out`.
#[inline(always)]
pub(super) fn store_rows<T: Real, V: Lanes<T>>(rows: &[V], out: &mut [T]) {
    if out.len() == V::WIDTH * rows.len() {
        V::store_transposed(rows, rows.len(), out);
        return;
    }
    for (j, row) in rows.iter().enumerate() {
        let mut lanes = [T::ZERO; BLOCK];
        row.store(&mut lanes);
        out.iter_mut().skip(j).step_by(rows.len()).zip(lanes).for_each(|(out, lane)| *out = lane);
    }
}
