//! Derivatives with tables, and at many directions.

use alloc::vec::Vec;

use super::super::batch::{BLOCK, Groups, Part, PartMut, Transpose, clear_unused};
use super::super::{Basis, Values};
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
        let factors = self.factors.as_slice();
        tangent_gradient(self.order(), direction, &&*values, factors, &mut Values(gradients));
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
    /// In registers across directions, as [`Basis::eval_batch`]. Allocates room for some blocks.
    ///
    /// # Panics
    /// If a slice length does not match.
    pub fn eval_batch(&self, directions: &[[T; 3]], values: &mut [T], gradients: &mut [T]) {
        let count = self.order().coeff_count();
        assert_length("values", values.len(), directions.len() * count);
        assert_length("gradients", gradients.len(), directions.len() * 3 * count);
        let mut scratch: Vec<T> = Vec::new();
        self.basis.for_each_chunk(directions, |range, blocks| {
            scratch.resize(3 * blocks.len() * BLOCK, T::ZERO);
            self.gradient_blocks(&directions[range.clone()], blocks, &mut scratch);
            let (start, directions) = (range.start, range.len());
            dispatch(Transpose { blocks, count, directions, out: &mut values[start * count..] });
            let (blocks, out) = (scratch.as_chunks().0, &mut gradients[3 * start * count..]);
            dispatch(Transpose { blocks, count: 3 * count, directions, out });
        });
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
        self.basis.eval_blocks(directions, values);
        self.gradient_blocks(directions, values.as_chunks().0, gradients);
        clear_unused(directions.len(), 3 * count, gradients);
    }

    /// The gradients, from the values.
    fn gradient_blocks(&self, directions: &[[T; 3]], values: &[[T; BLOCK]], gradients: &mut [T]) {
        let (order, factors) = (self.order(), self.factors.as_slice());
        dispatch(Gradients { order, factors, directions, values, gradients: gradients.as_chunks_mut().0 });
    }
}

/// Gradients in blocks, in lanes.
struct Gradients<'a, T> {
    order: Order,
    factors: &'a [[T; 3]],
    directions: &'a [[T; 3]],
    values: &'a [[T; BLOCK]],
    gradients: &'a mut [[T; BLOCK]],
}

impl<T: Real> Kernel<T> for Gradients<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes<T>>(self) {
        let Self { order, factors, directions, values, gradients } = self;
        let count = order.coeff_count();
        for (group, direction) in Groups::<T, V>::new(directions) {
            let (block, part) = (group.start / BLOCK, group.start % BLOCK / V::WIDTH);
            let values = &Part { rows: &values[block * count..][..count], part };
            let gradients = &mut PartMut { rows: &mut gradients[3 * block * count..][..3 * count], part };
            // The smallest orders gain most, and are short.
            match order.get() {
                2 => small_tangent_gradient::<T, V, 2>(direction, values, factors, gradients),
                3 => small_tangent_gradient::<T, V, 3>(direction, values, factors, gradients),
                4 => small_tangent_gradient::<T, V, 4>(direction, values, factors, gradients),
                _ => tangent_gradient(order, direction, values, factors, gradients),
            }
        }
    }
}
