//! The product with one fixed factor.

use alloc::vec;
use alloc::vec::Vec;

use super::{assert_lengths, product_matrix};
use crate::order::assert_length;
use crate::simd::{Kernel, Lanes, dispatch};
use crate::{Order, Real};

/// The product with a fixed expansion, as a symmetric matrix: built once, applied to many.
///
/// It multiplies `n⁴` numbers per vector. Measured per vector by `cargo bench -p prt-benches --bench sh_core_product`: for
/// n = 4 to 16 it is faster than [`product`](crate::product()), most at n = 10, by a factor of 5. Of batches, those by
/// [`product_many`](crate::product_many) are faster for n = 3, those here from n = 4 on: 9 ns against 12, 23 against 92 at n = 6.
///
/// ```
/// use sh_core::{Order, ProductMatrix, product};
///
/// let order = Order::new(3)?;
/// let a = [1.0_f32, 0.5, -0.25, 0.0, 0.1, 0.0, 0.2, 0.0, 0.3];
/// let b = [0.5_f32, 0.0, 0.75, 0.1, 0.0, 0.2, 0.0, 0.3, 0.0];
/// let (mut by_matrix, mut direct) = ([0.0; 9], [0.0; 9]);
/// ProductMatrix::new(order, &a).apply(&b, &mut by_matrix);
/// product(order, &a, &b, &mut direct);
/// assert!(by_matrix.iter().zip(direct).all(|(m, d)| (m - d).abs() < 2e-7));
/// # Ok::<(), sh_core::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct ProductMatrix<T> {
    order: Order,
    /// `[n², stride]`, symmetric, rows padded with zeros to whole registers.
    matrix: Vec<T>,
    stride: usize,
}

/// Numbers in the widest register.
const WIDEST: usize = 16;

impl<T: Real> ProductMatrix<T> {
    /// The matrix of the product with `a`, `[n²]`; see [`product_matrix`](crate::product_matrix()).
    ///
    /// # Panics
    /// If `a` is not `[n²]`.
    pub fn new(order: Order, a: &[T]) -> Self {
        let count = order.coeff_count();
        let mut plain = vec![T::ZERO; count * count];
        product_matrix(order, a, &mut plain);
        let stride = count.next_multiple_of(WIDEST);
        let mut matrix = vec![T::ZERO; count * stride];
        let rows = matrix.chunks_exact_mut(stride).zip(plain.chunks_exact(count));
        rows.for_each(|(row, plain)| row[..count].copy_from_slice(plain));
        Self { order, matrix, stride }
    }

    /// The order of the expansions.
    pub fn order(&self) -> Order {
        self.order
    }

    /// The entry `i, j` of the matrix, `∫ a y_i y_j`.
    ///
    /// # Panics
    /// If an index is not below `n²`.
    pub fn entry(&self, i: usize, j: usize) -> T {
        assert!(j < self.order.coeff_count(), "column {j} is not below {}", self.order.coeff_count());
        self.matrix[i * self.stride + j]
    }

    /// The product of the fixed factor with `b`.
    ///
    /// - `b`: `[n²]`
    /// - `out`: `[n²]`, overwritten
    ///
    /// # Panics
    /// If a slice length does not match the order.
    pub fn apply(&self, b: &[T], out: &mut [T]) {
        assert_lengths(self.order, [("b", b.len()), ("out", out.len())]);
        dispatch(self.kernel(b, out));
    }

    /// The work of applying it.
    pub(super) fn kernel<'a>(&'a self, b: &'a [T], out: &'a mut [T]) -> Apply<'a, T> {
        Apply { matrix: self, b, out }
    }

    /// The products of the fixed factor with several expansions.
    ///
    /// - `b`: `[D, n²]`
    /// - `out`: `[D, n²]`, overwritten
    ///
    /// # Panics
    /// If `out` is not whole vectors, or `b` has not its length.
    pub fn apply_many(&self, b: &[T], out: &mut [T]) {
        assert_length("out", out.len() % self.order.coeff_count(), 0);
        assert_length("b", b.len(), out.len());
        dispatch(self.kernel(b, out));
    }
}

/// One or more products with the matrix.
pub(super) struct Apply<'a, T> {
    matrix: &'a ProductMatrix<T>,
    b: &'a [T],
    out: &'a mut [T],
}

impl<T: Real> Kernel<T> for Apply<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes<T>>(self) {
        let count = self.matrix.order.coeff_count();
        for (b, out) in self.b.chunks_exact(count).zip(self.out.chunks_exact_mut(count)) {
            let mut at = 0;
            while at < count {
                // Up to three registers of the result at once hide the latency.
                at += match (count - at).div_ceil(V::WIDTH) {
                    1 => rows::<T, V, 1>(self.matrix, b, at, out),
                    2 => rows::<T, V, 2>(self.matrix, b, at, out),
                    _ => rows::<T, V, 3>(self.matrix, b, at, out),
                };
            }
        }
    }
}

/// `COUNT` registers of the result from `at` on; returns how many coefficients these are.
#[inline(always)]
fn rows<T: Real, V: Lanes<T>, const COUNT: usize>(
    matrix: &ProductMatrix<T>,
    b: &[T],
    at: usize,
    out: &mut [T],
) -> usize {
    let (pairs, last) = b.as_chunks::<2>();
    let (stride, mut sums) = (matrix.stride, [[V::splat(T::ZERO); 2]; COUNT]);
    for (rows, &[b_0, b_1]) in matrix.matrix.chunks_exact(2 * stride).zip(pairs) {
        let (row_0, row_1) = rows[at..].split_at(stride);
        for (register, sum) in sums.iter_mut().enumerate() {
            sum[0] = V::load(&row_0[register * V::WIDTH..]).mul_add(V::splat(b_0), sum[0]);
            sum[1] = V::load(&row_1[register * V::WIDTH..]).mul_add(V::splat(b_1), sum[1]);
        }
    }
    if let &[b] = last {
        let row = &matrix.matrix[matrix.matrix.len() - stride + at..];
        for (register, sum) in sums.iter_mut().enumerate() {
            sum[0] = V::load(&row[register * V::WIDTH..]).mul_add(V::splat(b), sum[0]);
        }
    }
    let mut padded = [T::ZERO; 3 * WIDEST];
    for (register, sum) in sums.iter().enumerate() {
        (sum[0] + sum[1]).store(&mut padded[register * V::WIDTH..]);
    }
    let done = (COUNT * V::WIDTH).min(out.len() - at);
    out[at..at + done].copy_from_slice(&padded[..done]);
    done
}
