//! Derivatives with tables, and at many directions.

use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;

use super::super::batch::{BLOCK, BlockLanes, Groups, prefetch_ahead, store_rows};
use super::super::recurrence::{self, Tabled};
use super::super::{Basis, Sink, Tables, Values, unrolled};
use super::{Computed, Factors, hessian_from_values, small_tangent_gradient, tangent_gradient};
use crate::order::assert_length;
use crate::simd::{Kernel, Lanes, dispatch};
use crate::{Order, Real};

/// The basis of one order with its derivatives, and their factors in tables.
///
/// The tables take about `3 n²` numbers.
///
/// ```
/// use sh_core::{BasisGradient, Order, fibonacci};
///
/// let order = Order::new(5)?;
/// let directions = fibonacci(100);
/// let (mut y, mut gradients) = (vec![0.0; 100 * 25], vec![0.0; 100 * 3 * 25]);
/// BasisGradient::<f64>::new(order).eval_batch(&directions, &mut y, &mut gradients);
/// // Gradients are tangent to the sphere.
/// for (s, gradient) in directions.iter().zip(gradients.chunks_exact(75)) {
///     let along: f64 = (0..3).map(|axis| s[axis] * gradient[axis * 25 + 17]).sum();
///     assert!(along.abs() < 1e-14);
/// }
/// # Ok::<(), sh_core::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct BasisGradient<T> {
    basis: Basis<T>,
    /// `[n(n+1)/2]`: for each band the columns m ≥ 0.
    factors: Vec<[T; 3]>,
}

impl<T: Real> Factors<T> for &[[T; 3]] {
    #[inline(always)]
    fn get(self, l: usize, m: usize) -> [T; 3] {
        self[l * (l + 1) / 2 + m]
    }
}

impl<T: Real> BasisGradient<T> {
    /// Builds the tables: three square roots per column.
    pub fn new(order: Order) -> Self {
        let factors = (0..order.get()).flat_map(|l| (0..=l).map(move |m| Computed.get(l, m)));
        Self { basis: Basis::new(order), factors: factors.collect() }
    }

    /// The order of the basis.
    pub fn order(&self) -> Order {
        self.basis.order()
    }

    /// Evaluates all basis functions and their gradients at a unit direction, as [`eval_gradient`](crate::eval_gradient) does.
    ///
    /// - `values`: `[n²]`, overwritten
    /// - `gradients`: `[3, n²]`, overwritten
    ///
    /// Does not allocate.
    ///
    /// # Panics
    /// If a slice length does not match the order.
    pub fn eval(&self, direction: [T; 3], values: &mut [T], gradients: &mut [T]) {
        assert_length("gradients", gradients.len(), 3 * self.order().coeff_count());
        self.basis.eval(direction, values);
        tangent_gradient(self.order(), direction, values, self.factors.as_slice(), gradients);
    }

    /// Evaluates all basis functions, gradients and Hessians at a unit direction, as
    /// [`eval_hessian`](crate::eval_hessian) does.
    ///
    /// - `values`: `[n²]`, `gradients`: `[3, n²]`, `hessians`: `[6, n²]`, all overwritten
    ///
    /// Does not allocate.
    ///
    /// # Panics
    /// If a slice length does not match the order.
    pub fn eval_hessian(&self, direction: [T; 3], values: &mut [T], gradients: &mut [T], hessians: &mut [T]) {
        assert_length("gradients", gradients.len(), 3 * self.order().coeff_count());
        assert_length("hessians", hessians.len(), 6 * self.order().coeff_count());
        self.basis.eval(direction, values);
        hessian_from_values(self.order(), direction, self.factors.as_slice(), values, gradients, hessians);
    }

    /// Evaluates all basis functions and their gradients at many unit directions, one after the other.
    ///
    /// - `directions`: `[D]`
    /// - `values`: `[D, n²]`, overwritten
    /// - `gradients`: `[D, 3, n²]`, overwritten
    ///
    /// In registers across directions, as [`Basis::eval_batch`]. Allocates room for one group of directions.
    ///
    /// # Panics
    /// If a slice length does not match.
    pub fn eval_batch(&self, directions: &[[T; 3]], values: &mut [T], gradients: &mut [T]) {
        let count = self.order().coeff_count();
        assert_length("values", values.len(), directions.len() * count);
        assert_length("gradients", gradients.len(), directions.len() * 3 * count);
        match &self.basis.tables {
            Tables::Wide(_) => {
                let outs = values.chunks_exact_mut(count).zip(gradients.chunks_exact_mut(3 * count));
                directions.iter().zip(outs).for_each(|(&s, (values, gradients))| self.eval(s, values, gradients));
            }
            tables => dispatch(Many {
                order: self.order(),
                tables,
                factors: &self.factors,
                directions,
                out: Rows { values, gradients },
            }),
        }
    }

    /// Evaluates all basis functions and their gradients at many unit directions, in coefficient-major blocks.
    ///
    /// - `directions`: `[D]`
    /// - `values`: `[⌈D/16⌉, n², 16]`, overwritten
    /// - `gradients`: `[⌈D/16⌉, 3, n², 16]`, overwritten
    ///
    /// As [`Basis::eval_blocks`]: blocks of [`BLOCK`] directions, 0 beyond the last one.
    ///
    /// # Panics
    /// If a slice length does not match.
    pub fn eval_blocks(&self, directions: &[[T; 3]], values: &mut [T], gradients: &mut [T]) {
        let (count, blocks) = (self.order().coeff_count(), directions.len().div_ceil(BLOCK));
        assert_length("values", values.len(), blocks * count * BLOCK);
        assert_length("gradients", gradients.len(), blocks * 3 * count * BLOCK);
        let used = directions.len() % BLOCK;
        let (values, gradients) = (values.as_chunks_mut().0, gradients.as_chunks_mut().0);
        match &self.basis.tables {
            Tables::Wide(_) => self.eval_wide_blocks(directions, values, gradients),
            tables => dispatch(Many {
                order: self.order(),
                tables,
                factors: &self.factors,
                directions,
                out: InBlocks { values, gradients },
            }),
        }
        if used > 0 {
            let last = directions.len() / BLOCK;
            let unused = values[last * count..].iter_mut().chain(&mut gradients[3 * last * count..]);
            unused.for_each(|row| row[used..].fill(T::ZERO));
        }
    }

    /// Orders beyond the range of `T`, one direction at a time.
    fn eval_wide_blocks(&self, directions: &[[T; 3]], values: &mut [[T; BLOCK]], gradients: &mut [[T; BLOCK]]) {
        let count = self.order().coeff_count();
        let (mut y, mut gradient) = (vec![T::ZERO; count], vec![T::ZERO; 3 * count]);
        for (d, &direction) in directions.iter().enumerate() {
            self.eval(direction, &mut y, &mut gradient);
            let (block, k) = (d / BLOCK, d % BLOCK);
            values[block * count..].iter_mut().zip(&y).for_each(|(row, &y)| row[k] = y);
            gradients[3 * block * count..].iter_mut().zip(&gradient).for_each(|(row, &g)| row[k] = g);
        }
    }
}

/// Where the values and gradients of a group of directions go.
trait Output<T, V> {
    /// Takes `y: [n²]` and `gradient: [3, n²]` of the directions `group`.
    fn put(&mut self, group: Range<usize>, y: &[V], gradient: &[V]);
}

/// `[D, n²]` and `[D, 3, n²]`.
struct Rows<'a, T> {
    values: &'a mut [T],
    gradients: &'a mut [T],
}

impl<T: Real, V: Lanes<T>> Output<T, V> for Rows<'_, T> {
    #[inline(always)]
    fn put(&mut self, group: Range<usize>, y: &[V], gradient: &[V]) {
        prefetch_ahead::<T, V>(self.values, y.len(), &group);
        prefetch_ahead::<T, V>(self.gradients, gradient.len(), &group);
        store_rows(y, &mut self.values[group.start * y.len()..group.end * y.len()]);
        store_rows(gradient, &mut self.gradients[group.start * gradient.len()..group.end * gradient.len()]);
    }
}

/// `[B, n², 16]` and `[B, 3, n², 16]`.
struct InBlocks<'a, T> {
    values: &'a mut [[T; BLOCK]],
    gradients: &'a mut [[T; BLOCK]],
}

impl<T: Real, V: Lanes<T>> Output<T, V> for InBlocks<'_, T> {
    #[inline(always)]
    fn put(&mut self, group: Range<usize>, y: &[V], gradient: &[V]) {
        let (block, part) = (group.start / BLOCK, group.start % BLOCK / V::WIDTH);
        for (rows, out) in [(y, &mut *self.values), (gradient, &mut *self.gradients)] {
            let mut lanes = BlockLanes { out: &mut out[block * rows.len()..][..rows.len()], part };
            for (i, &row) in rows.iter().enumerate() {
                lanes.put(i, row);
            }
        }
    }
}

/// Values and gradients at many directions, in lanes.
struct Many<'a, T, O> {
    order: Order,
    tables: &'a Tables<T>,
    factors: &'a [[T; 3]],
    directions: &'a [[T; 3]],
    out: O,
}

/// A kernel whose output takes any lanes.
macro_rules! impl_kernel {
    ($output:ident) => {
        impl<T: Real> Kernel<T> for Many<'_, T, $output<'_, T>> {
            type Output = ();

            #[inline(always)]
            fn run<V: Lanes<T>>(self) {
                match self.tables {
                    Tables::Native(tables) => self.run_tabled::<V>(tables),
                    _ => { small_order!(self.order, N => self.run_small::<V, N>(), else unreachable!("small orders have no tables")); }
                }
            }
        }
    };
}

impl_kernel!(Rows);
impl_kernel!(InBlocks);

impl<T: Real, O> Many<'_, T, O> {
    #[inline(always)]
    fn run_small<V: Lanes<T>, const N: usize>(mut self)
    where
        O: Output<T, V>,
    {
        const MAX_COUNT: usize = unrolled::MAX_ORDER * unrolled::MAX_ORDER;
        let (mut y, mut gradient) = ([V::splat(T::ZERO); MAX_COUNT], [V::splat(T::ZERO); 3 * MAX_COUNT]);
        let (y, gradient) = (&mut y[..N * N], &mut gradient[..3 * N * N]);
        for (group, direction) in Groups::<T, V>::new(self.directions) {
            unrolled::kernel::<T, V, N>(direction, &mut Values(&mut *y));
            small_tangent_gradient::<T, V, N>(direction, y, self.factors, gradient);
            self.out.put(group, y, gradient);
        }
    }

    #[inline(always)]
    fn run_tabled<V: Lanes<T>>(mut self, tables: &Tabled<T>)
    where
        O: Output<T, V>,
    {
        let count = self.order.coeff_count();
        let (mut y, mut gradient) = (vec![V::splat(T::ZERO); count], vec![V::splat(T::ZERO); 3 * count]);
        for (group, direction) in Groups::<T, V>::new(self.directions) {
            recurrence::eval_lanes(self.order, direction, tables, &mut Values(&mut y));
            tangent_gradient(self.order, direction, &y, self.factors, &mut gradient);
            self.out.put(group, &y, &gradient);
        }
    }
}
