//! Many products, a pair of factors in each lane.

use super::straight;
use crate::Real;
use crate::simd::{Kernel, Lanes};

/// Products of order `N`; all but the last few that do not fill the lanes. Says how many were done.
pub(super) struct Batch<'a, T, const N2: usize> {
    /// `[D, N²]`
    pub(super) a: &'a [T],
    /// `[D, N²]`
    pub(super) b: &'a [T],
    /// `[D, N²]`
    pub(super) out: &'a mut [T],
}

macro_rules! batch {
    ($count:literal, $kernel:ident) => {
        impl<T: Real> Kernel<T> for Batch<'_, T, $count> {
            type Output = usize;

            #[inline(always)]
            fn run<V: Lanes<T>>(self) -> usize {
                let size = V::WIDTH * $count;
                let factors = self.a.chunks_exact(size).zip(self.b.chunks_exact(size));
                for ((a, b), out) in factors.zip(self.out.chunks_exact_mut(size)) {
                    let [mut rows_a, mut rows_b] = [[V::splat(T::ZERO); $count]; 2];
                    V::load_transposed(&mut rows_a, $count, a);
                    V::load_transposed(&mut rows_b, $count, b);
                    V::store_transposed(&straight::$kernel::<T, V>(&rows_a, &rows_b), $count, out);
                }
                self.out.len() / size * V::WIDTH
            }
        }
    };
}

batch!(9, order_3);
batch!(16, order_4);
batch!(25, order_5);
