//! Exact rotation by the block-diagonal matrix of all bands.

use alloc::vec::Vec;

use super::ivanic::Bands;
use super::many::{Many, Vectors};
use super::zyz::Zyz;
use crate::order::assert_length;
use crate::simd::dispatch;
use crate::{Order, Real, dot};

/// A rotation of expansions of one order: one square matrix per band.
///
/// The rotated expansion is `g(s) = f(R⁻¹ s)`: a feature of `f` in the direction `d` is in the direction `R d` of `g`.
///
/// Built once for `n(4n²−1)/3` entries, applied to as many vectors as wanted with as many multiplications.
///
/// Accuracy, at every angle: 2e-7 in `f32` for n ≤ 10 and coefficients of unit length; in `f64` the basis at a direction
/// becomes that at the rotated one to 4e-14 for n ≤ 64 and 2e-13 for n = 200; asserted by `tests/rotation.rs`.
///
/// ```
/// use sh_core::{Order, ShRotation, eval};
///
/// let order = Order::new(4)?;
/// // A quarter turn about z: +x goes to +y.
/// let rotation = ShRotation::new(order, [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
/// let (mut about_x, mut about_y, mut rotated) = ([0.0_f64; 16], [0.0; 16], [0.0; 16]);
/// eval(order, [1.0, 0.0, 0.0], &mut about_x);
/// eval(order, [0.0, 1.0, 0.0], &mut about_y);
/// rotation.apply(&about_x, &mut rotated);
/// assert!(rotated.iter().zip(about_y).all(|(a, b)| (a - b).abs() < 1e-14));
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// Source: [IR96](crate#references) with its 1998 correction.
#[derive(Clone, Debug)]
pub struct ShRotation<T> {
    order: Order,
    /// Band after band, each `[2l+1, 2l+1]` row-major.
    matrices: Vec<T>,
}

impl<T: Real> ShRotation<T> {
    /// Builds the matrices of all bands, in `f64`.
    ///
    /// - `matrix`: the rows of `R`. It is first brought to the nearest orthogonal matrix by two Newton steps, so the
    ///   rounding errors of an `f32` matrix, or anything up to 1e-4, do not grow with the band. Mirror images are as good
    ///   as rotations. A matrix far from orthogonal gives a meaningless result, a NaN in it gives NaN.
    ///
    /// Takes `n(4n²−1)/3` numbers of memory, in `f32` 5 kB for n = 10 and 0.7 GB for n = 512.
    pub fn new(order: Order, matrix: [[T; 3]; 3]) -> Self {
        let n = order.get();
        let mut matrices = Vec::with_capacity(n * (4 * n * n - 1) / 3);
        let mut bands = Bands::new(nearest_orthogonal(matrix.map(|row| row.map(T::to_f64))));
        for l in 0..n {
            if l > 0 {
                bands.advance();
            }
            matrices.extend(bands.matrix().iter().map(|&r| T::from_f64(r)));
        }
        Self { order, matrices }
    }

    /// The order of the expansions that it rotates.
    pub fn order(&self) -> Order {
        self.order
    }

    /// Rotates an expansion.
    ///
    /// - `coeffs`: `[n²]`
    /// - `out`: `[n²]`, overwritten
    ///
    /// # Panics
    /// If a slice length does not match the order.
    pub fn apply(&self, coeffs: &[T], out: &mut [T]) {
        assert_length("coeffs", coeffs.len(), self.order.coeff_count());
        assert_length("out", out.len(), self.order.coeff_count());
        let mut rest = self.matrices.as_slice();
        for (_, band) in self.order.bands() {
            let (matrix, following) = rest.split_at(band.len() * band.len());
            rest = following;
            multiply(matrix, &coeffs[band.clone()], &mut out[band]);
        }
    }
}

impl<T: Real> ShRotation<T> {
    /// From a quaternion `[x, y, z, w]` of any length but 0, for which the matrices are NaN.
    pub fn from_quaternion(order: Order, quaternion: [T; 4]) -> Self {
        Self::new(order, Zyz::from_quaternion(quaternion.map(T::to_f64)).matrix().map(|row| row.map(T::from_f64)))
    }

    /// Turns about z by an angle in radians. [`rotate_z`](crate::rotate_z) does the same to one expansion in O(n²).
    pub fn about_z(order: Order, angle: T) -> Self {
        let (s, c) = (angle.sin(), angle.cos());
        Self::new(order, [[c, -s, T::ZERO], [s, c, T::ZERO], [T::ZERO, T::ZERO, T::ONE]])
    }

    /// Rotates many expansions, or the channels of a light, across them: as many at once as the registers of this machine
    /// have lanes.
    ///
    /// - `coeffs`: `[V, n²]`
    /// - `out`: `[V, n²]`, overwritten
    ///
    /// The same sums as in [`ShRotation::apply`], in another order. For n > 10, and for what is left over of the last
    /// block, one vector after the other. Does not allocate.
    ///
    /// ```
    /// use sh_core::{Order, ShRotation};
    ///
    /// // A light of three channels, turned by a quarter about z.
    /// let order = Order::new(2)?;
    /// let light = [1.0, 0.0, 0.0, -0.5, 2.0, 0.0, 0.0, -1.0, 3.0, 0.0, 0.0, -1.5];
    /// let mut turned = [0.0; 12];
    /// let rotation = ShRotation::<f32>::new(order, [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
    /// rotation.apply_many(&light, &mut turned);
    /// assert_eq!(turned, [1.0, -0.5, 0.0, 0.0, 2.0, -1.0, 0.0, 0.0, 3.0, -1.5, 0.0, 0.0]);
    /// # Ok::<(), sh_core::Error>(())
    /// ```
    ///
    /// # Panics
    /// If the lengths differ, or are not a multiple of n².
    pub fn apply_many(&self, coeffs: &[T], out: &mut [T]) {
        self.assert_whole_vectors(coeffs.len());
        assert_length("out", out.len(), coeffs.len());
        self.run(Vectors::Copied(coeffs, out));
    }

    /// The same in place.
    ///
    /// - `coeffs`: `[V, n²]`
    ///
    /// # Panics
    /// If the length is not a multiple of n².
    pub fn apply_many_in_place(&self, coeffs: &mut [T]) {
        self.assert_whole_vectors(coeffs.len());
        self.run(Vectors::InPlace(coeffs));
    }

    fn run(&self, vectors: Vectors<'_, T>) {
        dispatch::<T, _>(Many { order: self.order, matrices: self.matrices(), vectors });
    }

    /// Band after band, `[2l+1, 2l+1]` row-major.
    pub(super) fn matrices(&self) -> &[T] {
        &self.matrices
    }

    #[track_caller]
    fn assert_whole_vectors(&self, given: usize) {
        let count = self.order.coeff_count();
        assert!(given.is_multiple_of(count), "coeffs has {given} elements, it needs a multiple of {count}");
    }
}

/// Rotates several expansions once, holding the matrices of two bands only.
///
/// - `coeffs`, `out`: `[C, n²]`
pub(crate) fn rotate_channels(order: Order, matrix: [[f64; 3]; 3], coeffs: &[f64], out: &mut [f64]) {
    let mut bands = Bands::new(matrix);
    for (l, band) in order.bands() {
        if l > 0 {
            bands.advance();
        }
        let channels = coeffs.chunks_exact(order.coeff_count()).zip(out.chunks_exact_mut(order.coeff_count()));
        for (coeffs, out) in channels {
            multiply(bands.matrix(), &coeffs[band.clone()], &mut out[band.clone()]);
        }
    }
}

/// `out = matrix · vector`, row-major.
pub(super) fn multiply<T: Real>(matrix: &[T], vector: &[T], out: &mut [T]) {
    for (out, row) in out.iter_mut().zip(matrix.chunks_exact(vector.len())) {
        *out = dot(row, vector);
    }
}

/// Two steps of Newton's method `X ← X (3 − XᵀX) / 2` towards the nearest orthogonal matrix: an error `e` becomes about `e⁴`.
fn nearest_orthogonal(mut x: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    for _ in 0..2 {
        // gram = XᵀX
        let entry = |i: usize, j: usize| (0..3).map(|k| x[k][i] * x[k][j]).sum::<f64>();
        let gram: [[f64; 3]; 3] = core::array::from_fn(|i| core::array::from_fn(|j| entry(i, j)));
        let product = |i: usize, j: usize| (0..3).map(|k| x[i][k] * gram[k][j]).sum::<f64>();
        x = core::array::from_fn(|i| core::array::from_fn(|j| 1.5 * x[i][j] - 0.5 * product(i, j)));
    }
    x
}
