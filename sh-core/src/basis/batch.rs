//! The basis at many directions at once, in registers across directions.
//!
//! Straight-line kernels are long: ten orders for each scalar type and level of registers. So they are compiled for two
//! outputs only, blocks of [`BLOCK`] directions and vectors. All else reads blocks that stay in the first cache.

use alloc::vec;
use alloc::vec::Vec;
use core::marker::PhantomData;
use core::ops::Range;

use super::recurrence::{self, Tabled};
use super::{Basis, Sink, Source, Tables, Values, unrolled};
use crate::order::assert_length;
use crate::simd::{Kernel, Lanes, dispatch};
use crate::{Order, Real};

/// Directions in a block of [`Basis::eval_blocks`].
pub const BLOCK: usize = 16;

/// Numbers of blocks that are made before they are used: half of a first cache of 32 kB, in `f32`.
const CACHED: usize = 4096;

impl<T: Real> Basis<T> {
    /// Evaluates all basis functions at many unit directions, one vector after the other.
    ///
    /// `out[d, i] = y_i(directions[d])`, up to rounding as [`eval`](crate::eval) does for each.
    ///
    /// - `directions`: `[D]`
    /// - `out`: `[D, n²]`, overwritten
    ///
    /// Several directions share a register, with AVX2 or AVX-512 where the machine has them. The value at a direction does
    /// not depend on its place. Accuracy as stated for [`eval`](crate::eval), asserted by `tests/gradient.rs`. Allocates room
    /// for some blocks.
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
        if let Tables::Unrolled = self.tables {
            return T::eval_rows(self.order(), directions, out);
        }
        self.for_each_chunk(directions, |range, blocks| {
            dispatch(Transpose { blocks, count, directions: range.len(), out: &mut out[range.start * count..] });
        });
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
    /// directions at a time that `out` stays in the first cache, let it begin at a multiple of 64 bytes (a register that
    /// straddles two lines takes twice as long to store), and use them at once. Does not allocate up to the order at
    /// which `T` has the range for the recurrence (128 in `f32`).
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
            _ => T::eval_blocks(self, directions, out),
        }
        clear_unused(directions.len(), self.order().coeff_count(), out);
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

    /// Calls `f` with some directions at a time, and with their blocks.
    pub(crate) fn for_each_chunk(&self, directions: &[[T; 3]], mut f: impl FnMut(Range<usize>, &[[T; BLOCK]])) {
        let size = self.order().coeff_count() * BLOCK;
        let at_once = (CACHED / size).max(1).min(directions.len().div_ceil(BLOCK));
        let mut blocks: Vec<T> = vec![T::ZERO; at_once * size];
        for (chunk, directions) in directions.chunks((at_once * BLOCK).max(1)).enumerate() {
            let start = chunk * at_once * BLOCK;
            let blocks = &mut blocks[..directions.len().div_ceil(BLOCK) * size];
            self.eval_blocks(directions, blocks);
            f(start..start + directions.len(), blocks.as_chunks().0);
        }
    }
}

/// Zeros in the lanes of the last block that have no direction; `size` numbers per direction.
pub(super) fn clear_unused<T: Real>(directions: usize, size: usize, blocks: &mut [T]) {
    let used = directions % BLOCK;
    if used > 0 {
        let last = &mut blocks[directions / BLOCK * size * BLOCK..];
        last.as_chunks_mut::<BLOCK>().0.iter_mut().for_each(|row| row[used..].fill(T::ZERO));
    }
}

/// The blocks of a scalar type. They are compiled here, once for each type, and not in every crate that calls them.
pub trait Batches: Sized {
    /// [`Basis::eval_blocks`].
    fn eval_blocks(basis: &Basis<Self>, directions: &[[Self; 3]], out: &mut [Self]);
    /// [`Basis::eval_batch`] of orders with straight-line kernels.
    fn eval_rows(order: Order, directions: &[[Self; 3]], out: &mut [Self]);
}

macro_rules! impl_batches {
    ($($float:ident)+) => {$(
        impl Batches for $float {
            fn eval_blocks(basis: &Basis<Self>, directions: &[[Self; 3]], out: &mut [Self]) {
                dispatch(Blocks { order: basis.order(), tables: &basis.tables, directions, out });
            }
            fn eval_rows(order: Order, directions: &[[Self; 3]], out: &mut [Self]) {
                dispatch(Rows { order, directions, out });
            }
        }
    )+};
}

impl_batches!(f32 f64);

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
            prefetch_ahead::<T, V>(self.out, N * N, &group);
            let (block, part) = (group.start / BLOCK, group.start % BLOCK / V::WIDTH);
            let out = &mut self.out.as_chunks_mut().0[block * N * N..][..N * N];
            unrolled::kernel::<T, V, N>(direction, &mut PartMut { rows: out, part });
        }
    }

    #[inline(always)]
    fn run_tabled<V: Lanes<T>>(self, tables: &Tabled<T>) {
        let count = self.order.coeff_count();
        for (group, direction) in Groups::<T, V>::new(self.directions) {
            prefetch_ahead::<T, V>(self.out, count, &group);
            let (block, part) = (group.start / BLOCK, group.start % BLOCK / V::WIDTH);
            let out = &mut self.out.as_chunks_mut().0[block * count..][..count];
            recurrence::eval_lanes(self.order, direction, tables, &mut PartMut { rows: out, part });
        }
    }
}

/// [`Basis::eval_batch`] of orders with straight-line kernels, in lanes.
struct Rows<'a, T> {
    order: Order,
    directions: &'a [[T; 3]],
    out: &'a mut [T],
}

impl<T: Real> Kernel<T> for Rows<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes<T>>(self) {
        small_order!(self.order, N => self.run_small::<V, N>(), else unreachable!("large orders go by blocks"));
    }
}

impl<T: Real> Rows<'_, T> {
    #[inline(always)]
    fn run_small<V: Lanes<T>, const N: usize>(self) {
        let mut y = [V::splat(T::ZERO); unrolled::MAX_ORDER * unrolled::MAX_ORDER];
        let y = &mut y[..N * N];
        for (group, direction) in Groups::<T, V>::new(self.directions) {
            prefetch_ahead::<T, V>(self.out, N * N, &group);
            unrolled::kernel::<T, V, N>(direction, &mut Values(&mut *y));
            let out = &mut self.out[group.start * N * N..group.end * N * N];
            if group.len() == V::WIDTH {
                V::store_transposed(y, N * N, out);
                continue;
            }
            for (i, y) in y.iter().enumerate() {
                let mut lanes = [T::ZERO; BLOCK];
                y.store(&mut lanes);
                out[i..].iter_mut().step_by(N * N).zip(lanes).for_each(|(out, lane)| *out = lane);
            }
        }
    }
}

/// Part of the lanes of a block: one of as many as registers make up a row.
pub(super) struct Part<'a, T> {
    pub(super) rows: &'a [[T; BLOCK]],
    pub(super) part: usize,
}

/// The same to be written.
pub(super) struct PartMut<'a, T> {
    pub(super) rows: &'a mut [[T; BLOCK]],
    pub(super) part: usize,
}

impl<T: Real, V: Lanes<T>> Source<V> for Part<'_, T> {
    #[inline(always)]
    fn get(&self, i: usize) -> V {
        let row = &self.rows[i];
        // A whole row has no part to find.
        V::load(if V::WIDTH == BLOCK { row } else { &row[self.part * V::WIDTH..] })
    }
}

impl<T: Real, V: Lanes<T>> Sink<V> for PartMut<'_, T> {
    #[inline(always)]
    fn put(&mut self, i: usize, value: V) {
        let row = &mut self.rows[i];
        value.store(if V::WIDTH == BLOCK { row } else { &mut row[self.part * V::WIDTH..] });
    }
}

/// The directions in groups that fill a register: their range, and their components. The last group may be short; its other
/// lanes then hold the zero vector.
pub(super) struct Groups<'a, T, V> {
    directions: &'a [[T; 3]],
    start: usize,
    lanes: PhantomData<V>,
}

impl<'a, T: Real, V: Lanes<T>> Groups<'a, T, V> {
    #[inline(always)]
    pub(super) fn new(directions: &'a [[T; 3]]) -> Self {
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

/// Numbers per direction from which on that pays.
const BURST: usize = 48;

/// Fetches the lines of an output with `size` numbers per direction that a group to come will write.
///
/// Groups are written in bursts of a few kilobytes, which the machine does not foresee as it does a steady stream: beyond
/// the second cache this makes them up to twice as fast.
#[inline(always)]
fn prefetch_ahead<T: Real, V: Lanes<T>>(out: &mut [T], size: usize, group: &Range<usize>) {
    if size < BURST {
        return;
    }
    let start = (group.start + GROUPS_AHEAD * V::WIDTH) * size;
    let end = out.len().min(start + V::WIDTH * size);
    if let Some(lines) = out.get_mut(start..end) {
        V::prefetch(lines);
    }
}

/// Blocks `[⌈D/16⌉, count, 16]` into vectors `[D, count]`, in lanes.
pub(super) struct Transpose<'a, T> {
    pub(super) blocks: &'a [[T; BLOCK]],
    pub(super) count: usize,
    pub(super) directions: usize,
    /// May go on beyond the directions: what is written next is fetched.
    pub(super) out: &'a mut [T],
}

impl<T: Real> Kernel<T> for Transpose<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes<T>>(self) {
        let Self { blocks, count, directions, out } = self;
        for start in (0..directions).step_by(V::WIDTH) {
            let group = start..directions.min(start + V::WIDTH);
            prefetch_ahead::<T, V>(out, count, &group);
            let rows = &blocks[start / BLOCK * count..][..count];
            let part = Part { rows, part: start % BLOCK / V::WIDTH };
            let out = &mut out[start * count..];
            if group.len() < V::WIDTH || !store_rows::<T, V>(&part, count, out) {
                for (d, out) in out.chunks_exact_mut(count).take(group.len()).enumerate() {
                    out.iter_mut().zip(rows).for_each(|(out, row)| *out = row[start % BLOCK + d]);
                }
            }
        }
    }
}

/// Writes the lanes of a part as vectors, one after the other, where `out` begins; false if it ends too soon for that.
///
/// All by squares of one register's width. The last one takes in some rows before it again. A vector shorter than a register
/// is followed by repeats of its end, which the next one overwrites: there must be room for those of the last.
#[inline(always)]
fn store_rows<T: Real, V: Lanes<T>>(part: &Part<'_, T>, count: usize, out: &mut [T]) -> bool {
    if out.len() < (V::WIDTH - 1) * count + V::WIDTH.max(count) {
        return false;
    }
    let last = part.rows.len() - 1;
    let mut start = 0;
    loop {
        let mut square = [V::splat(T::ZERO); BLOCK];
        for (k, row) in square.iter_mut().enumerate().take(V::WIDTH) {
            *row = part.get((start + k).min(last));
        }
        V::store_square(&square, count, &mut out[start..]);
        if start + V::WIDTH >= count {
            break;
        }
        start = (start + V::WIDTH).min(count - V::WIDTH);
    }
    true
}
