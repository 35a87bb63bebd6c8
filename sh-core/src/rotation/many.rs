//! One rotation of many expansions: as many of them at once as a register has lanes.

use core::ops::Range;

use super::exact::multiply;
use crate::simd::{Kernel, Lanes};
use crate::{Order, Real};

/// Rows of a band that are summed side by side: with as many, a sum hides the latency of the next.
const MOST_ROWS: usize = 7;

/// Where the vectors are.
#[derive(Debug)]
pub(super) enum Vectors<'a, T> {
    /// Read here, written there.
    Copied(&'a [T], &'a mut [T]),
    InPlace(&'a mut [T]),
}

impl<T: Real> Vectors<'_, T> {
    #[inline(always)]
    fn len(&self) -> usize {
        match self {
            Self::Copied(coeffs, _) => coeffs.len(),
            Self::InPlace(coeffs) => coeffs.len(),
        }
    }

    #[inline(always)]
    fn source(&self) -> &[T] {
        match self {
            Self::Copied(coeffs, _) => coeffs,
            Self::InPlace(coeffs) => coeffs,
        }
    }

    #[inline(always)]
    fn target(&mut self) -> &mut [T] {
        match self {
            Self::Copied(_, out) => out,
            Self::InPlace(coeffs) => coeffs,
        }
    }
}

/// `[V, n²]` times the matrices of all bands.
#[derive(Debug)]
pub(super) struct Many<'a, T> {
    pub(super) order: Order,
    /// Band after band, `[2l+1, 2l+1]`, row-major.
    pub(super) matrices: &'a [T],
    pub(super) vectors: Vectors<'a, T>,
}

impl<T: Real> Kernel<T> for Many<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes<T>>(mut self) {
        let done = match self.order.get() {
            2 => self.rotate_blocks::<V, 4, 16>(),
            3 => self.rotate_blocks::<V, 9, 16>(),
            4 => self.rotate_blocks::<V, 16, 16>(),
            5 => self.rotate_blocks::<V, 25, 25>(),
            6 => self.rotate_blocks::<V, 36, 36>(),
            7 => self.rotate_blocks::<V, 49, 49>(),
            8 => self.rotate_blocks::<V, 64, 64>(),
            9 => self.rotate_blocks::<V, 81, 81>(),
            10 => self.rotate_blocks::<V, 100, 100>(),
            _ => 0,
        };
        let count = self.order.coeff_count();
        for vector in done..self.vectors.len() / count {
            self.rotate_one(vector * count..(vector + 1) * count);
        }
    }
}

impl<T: Real> Many<'_, T> {
    /// A vector for every lane, while there are as many; `N2 = n²`, `ROOM` is at least that and the number of lanes. Returns
    /// how many are done.
    #[inline(always)]
    fn rotate_blocks<V: Lanes<T>, const N2: usize, const ROOM: usize>(&mut self) -> usize {
        let blocks = self.vectors.len() / (N2 * V::WIDTH);
        let mut rows = [V::splat(T::ZERO); ROOM];
        for block in 0..blocks {
            let start = block * V::WIDTH * N2;
            let loaded = load(&self.vectors.source()[start..], N2, &mut rows);
            rotate_lanes::<T, V, N2>(self.matrices, &mut rows);
            // What was taken in of the next vector is written unchanged, and that vector after it.
            V::store_transposed(&rows[..loaded], N2, &mut self.vectors.target()[start..]);
        }
        blocks * V::WIDTH
    }

    /// The plain twin, for any order.
    #[inline(always)]
    fn rotate_one(&mut self, vector: Range<usize>) {
        let mut rest = self.matrices;
        for (_, band) in self.order.bands() {
            let (matrix, following) = rest.split_at(band.len() * band.len());
            rest = following;
            let range = vector.start + band.start..vector.start + band.end;
            match &mut self.vectors {
                Vectors::Copied(coeffs, out) => multiply(matrix, &coeffs[range.clone()], &mut out[range]),
                Vectors::InPlace(coeffs) => multiply_in_place(matrix, &mut coeffs[range]),
            }
        }
    }
}

fn multiply_in_place<T: Real>(matrix: &[T], vector: &mut [T]) {
    let mut copy = [T::ZERO; 2 * Order::MAX - 1];
    let copy = &mut copy[..vector.len()];
    copy.copy_from_slice(vector);
    multiply(matrix, copy, vector);
}

/// Transposes. Of vectors shorter than a register it takes in the beginning of the next one, so as to load whole registers.
/// Returns the number of rows to store.
#[inline(always)]
fn load<T: Real, V: Lanes<T>>(values: &[T], count: usize, rows: &mut [V]) -> usize {
    let more = count < V::WIDTH && values.len() >= (V::WIDTH - 1) * count + V::WIDTH;
    let loaded = if more { V::WIDTH } else { count };
    V::load_transposed(&mut rows[..loaded], count, values);
    loaded
}

/// All bands of order n, `N2 = n²`, in every lane.
#[inline(always)]
fn rotate_lanes<T: Real, V: Lanes<T>, const N2: usize>(matrices: &[T], rows: &mut [V]) {
    let mut rest = &matrices[1..];
    macro_rules! band {
        ($l:literal) => {
            if N2 > $l * $l {
                const SIZE: usize = 2 * $l + 1;
                let (matrix, following) = rest.split_at(SIZE * SIZE);
                multiply_lanes::<T, V, SIZE>(matrix, &mut rows[$l * $l..($l + 1) * ($l + 1)]);
                rest = following;
            }
        };
    }
    band!(1);
    band!(2);
    band!(3);
    band!(4);
    band!(5);
    band!(6);
    band!(7);
    band!(8);
    band!(9);
    debug_assert!(rest.is_empty(), "a matrix for every band");
}

/// `band ← matrix · band` in every lane, in groups of rows that share the loads of the band and leave room in 16 registers.
#[inline(always)]
fn multiply_lanes<T: Real, V: Lanes<T>, const SIZE: usize>(matrix: &[T], band: &mut [V]) {
    let mut copy = [V::splat(T::ZERO); SIZE];
    copy.copy_from_slice(band);
    let (mut matrix, mut out) = (matrix, band);
    loop {
        let groups = out.len().div_ceil(MOST_ROWS);
        let rows = out.len().div_ceil(groups);
        let (matrix_rows, matrix_rest) = matrix.split_at(rows * SIZE);
        let (out_rows, out_rest) = out.split_at_mut(rows);
        match rows {
            3 => multiply_rows::<T, V, SIZE, 3>(matrix_rows, &copy, out_rows),
            4 => multiply_rows::<T, V, SIZE, 4>(matrix_rows, &copy, out_rows),
            5 => multiply_rows::<T, V, SIZE, 5>(matrix_rows, &copy, out_rows),
            6 => multiply_rows::<T, V, SIZE, 6>(matrix_rows, &copy, out_rows),
            _ => multiply_rows::<T, V, SIZE, 7>(matrix_rows, &copy, out_rows),
        }
        if out_rest.is_empty() {
            return;
        }
        (matrix, out) = (matrix_rest, out_rest);
    }
}

/// `R` rows of a matrix.
#[inline(always)]
fn multiply_rows<T: Real, V: Lanes<T>, const SIZE: usize, const R: usize>(
    matrix: &[T],
    band: &[V; SIZE],
    out: &mut [V],
) {
    let matrix = &matrix[..R * SIZE];
    let mut sums = [V::splat(T::ZERO); R];
    for r in 0..R {
        sums[r] = V::splat(matrix[r * SIZE]) * band[0];
    }
    for j in 1..SIZE {
        for r in 0..R {
            sums[r] = V::splat(matrix[r * SIZE + j]).mul_add(band[j], sums[r]);
        }
    }
    out.copy_from_slice(&sums);
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    extern crate std;

    use std::vec;
    use std::vec::Vec;

    use super::*;
    use crate::ShRotation;
    use crate::simd::{Level, run_at};

    #[test]
    fn every_level_gives_the_same() {
        for n in 1..=11 {
            let order = Order::new(n).unwrap();
            let (s, c) = (0.6, 0.8);
            let rotation = ShRotation::<f64>::new(order, [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]);
            let coeffs: Vec<f64> = (0..35 * n * n).map(|i| (1.0 + i as f64).sin()).collect();
            let mut expected = vec![0.0; coeffs.len()];
            rotation.apply_many(&coeffs, &mut expected);
            for level in Level::available() {
                let (mut out, mut in_place) = (vec![f64::NAN; coeffs.len()], coeffs.clone());
                for vectors in [Vectors::Copied(&coeffs, &mut out), Vectors::InPlace(&mut in_place)] {
                    run_at::<f64, _>(level, Many { order, matrices: rotation.matrices(), vectors });
                }
                for found in [out, in_place] {
                    let differs = found.iter().zip(&expected).position(|(a, b)| a.is_nan() || (a - b).abs() > 4e-15);
                    assert_eq!(differs, None, "n = {n}, {level:?}");
                }
            }
        }
    }
}
