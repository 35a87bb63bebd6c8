//! Samples at any directions to coefficients, and coefficients to values at any directions: the basis is made block by
//! block, and used at once.

use alloc::vec;
use alloc::vec::Vec;

use crate::order::assert_length;
use crate::simd::{Kernel, Lanes, dispatch};
use crate::{BLOCK, Basis, Real};

/// Blocks whose products are added up in the type of the samples before they go on in `f64`: 32 roundings of a random sign,
/// against which the sum over all samples loses nothing.
const BLOCKS_AT_ONCE: usize = 32;

impl<T: Real> Basis<T> {
    /// Projects weighted samples: `out[c, i] = Σ_d samples[d][c] y_i(directions[d])`.
    ///
    /// - `directions`: `[D]`, unit length
    /// - `samples`: `[D]` of `C` channels: values times their weights; with `4π/D` for evenly spread directions, or with the
    ///   weights of a quadrature, the sum is the integral
    /// - `out`: `[C, n²]`, channel-major, overwritten
    ///
    /// Works on several directions at once and sums in `f64` from time to time, so it is as accurate as the basis, for any
    /// number of samples. For directions that are not evenly spread and have no weights, see
    /// [`LeastSquares`](crate::LeastSquares).
    ///
    /// ```
    /// use sh_core::{Basis, Order, fibonacci};
    ///
    /// let directions = fibonacci(10_000);
    /// let weight = 4.0 * std::f64::consts::PI / 10_000.0;
    /// let samples: Vec<[f64; 1]> = directions.iter().map(|[_, _, z]| [z.max(0.0) * weight]).collect();
    /// let mut coeffs = [0.0; 9];
    /// Basis::new(Order::new(3)?).project(&directions, &samples, &mut coeffs);
    /// assert!((coeffs[0] - std::f64::consts::PI.sqrt() / 2.0).abs() < 1e-6); // the clamped cosine
    /// # Ok::<(), sh_core::Error>(())
    /// ```
    ///
    /// # Panics
    /// If a slice length does not match.
    pub fn project<const C: usize>(&self, directions: &[[T; 3]], samples: &[[T; C]], out: &mut [T]) {
        let count = self.order().coeff_count();
        assert_length("samples", samples.len(), directions.len());
        assert_length("out", out.len(), C * count);
        let mut sums = vec![0.0; C * count];
        let mut partial = vec![[T::ZERO; BLOCK]; C * count];
        let (mut lanes, mut blocks_since) = (Vec::new(), 0);
        self.for_each_chunk(directions, |range, blocks| {
            load_samples(&samples[range], &mut lanes);
            dispatch(Projection { blocks, samples: &lanes, partial: &mut partial });
            blocks_since += lanes.len();
            if blocks_since >= BLOCKS_AT_ONCE {
                flush(&mut partial, &mut sums);
                blocks_since = 0;
            }
        });
        flush(&mut partial, &mut sums);
        out.iter_mut().zip(sums).for_each(|(out, sum)| *out = T::from_f64(sum));
    }

    /// The values of expansions at many directions: `out[d][c] = Σ_i coeffs[c, i] y_i(directions[d])`.
    ///
    /// - `coeffs`: `[C, n²]`, channel-major
    /// - `directions`: `[D]`, unit length
    /// - `out`: `[D]` of `C` channels, overwritten
    ///
    /// Works on several directions at once. Accuracy as of [`reconstruct`](crate::reconstruct). Allocates room for some blocks.
    ///
    /// ```
    /// use sh_core::{Basis, Order};
    ///
    /// let basis = Basis::new(Order::new(2)?);
    /// let light = [2.0_f64, 0.0, 1.0, 0.0, /* green */ 1.0, 0.0, 0.0, 0.0];
    /// let mut radiance = [[0.0; 2]; 3];
    /// basis.reconstruct(&light, &[[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]], &mut radiance);
    /// assert!(radiance[0][0] > radiance[1][0] && radiance[1][0] > radiance[2][0]);
    /// assert_eq!(radiance[0][1], radiance[2][1]);
    /// # Ok::<(), sh_core::Error>(())
    /// ```
    ///
    /// # Panics
    /// If a slice length does not match.
    pub fn reconstruct<const C: usize>(&self, coeffs: &[T], directions: &[[T; 3]], out: &mut [[T; C]]) {
        let count = self.order().coeff_count();
        assert_length("coeffs", coeffs.len(), C * count);
        assert_length("out", out.len(), directions.len());
        if C == 0 {
            return;
        }
        self.for_each_chunk(directions, |range, blocks| {
            dispatch(Reconstruction { coeffs, blocks, out: &mut out[range] });
        });
    }
}

/// [`Basis::project`] in lanes: adds to partial sums.
struct Projection<'a, T, const C: usize> {
    /// `[B, n², 16]`: the basis.
    blocks: &'a [[T; BLOCK]],
    /// `[B, C, 16]`
    samples: &'a [[[T; BLOCK]; C]],
    /// `[C, n², 16]`
    partial: &'a mut [[T; BLOCK]],
}

impl<T: Real, const C: usize> Kernel<T> for Projection<'_, T, C> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes<T>>(self) {
        let Self { blocks, samples, partial } = self;
        let count = blocks.len() / samples.len();
        for lane in (0..BLOCK).step_by(V::WIDTH) {
            for i in 0..count {
                let mut sums = [V::splat(T::ZERO); C];
                for (y, samples) in blocks[i..].iter().step_by(count).zip(samples) {
                    let y = V::load(&y[lane..]);
                    for (sum, sample) in sums.iter_mut().zip(samples) {
                        *sum = V::load(&sample[lane..]).mul_add(y, *sum);
                    }
                }
                for (c, sum) in sums.into_iter().enumerate() {
                    let partial = &mut partial[c * count + i][lane..];
                    (V::load(partial) + sum).store(partial);
                }
            }
        }
    }
}

/// Samples `[D]` of `C` channels into `[⌈D/16⌉, C, 16]`; 0 in lanes without a sample.
fn load_samples<T: Real, const C: usize>(samples: &[[T; C]], lanes: &mut Vec<[[T; BLOCK]; C]>) {
    lanes.clear();
    lanes.extend(samples.chunks(BLOCK).map(|samples| {
        core::array::from_fn(|c| core::array::from_fn(|k| samples.get(k).map_or(T::ZERO, |sample| sample[c])))
    }));
}

/// Moves partial sums on.
fn flush<T: Real>(partial: &mut [[T; BLOCK]], sums: &mut [f64]) {
    for (partial, sum) in partial.iter_mut().zip(sums) {
        *sum += partial.iter().map(|lane| lane.to_f64()).sum::<f64>();
        *partial = [T::ZERO; BLOCK];
    }
}

/// [`Basis::reconstruct`] in lanes.
struct Reconstruction<'a, T, const C: usize> {
    /// `[C, n²]`
    coeffs: &'a [T],
    /// `[⌈D/16⌉, n², 16]`: the basis.
    blocks: &'a [[T; BLOCK]],
    /// `[D]`
    out: &'a mut [[T; C]],
}

impl<T: Real, const C: usize> Kernel<T> for Reconstruction<'_, T, C> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes<T>>(self) {
        let Self { coeffs, blocks, out } = self;
        let count = coeffs.len() / C;
        for (out, block) in out.chunks_mut(BLOCK).zip(blocks.chunks_exact(count)) {
            let mut values = [[T::ZERO; BLOCK]; C];
            for lane in (0..BLOCK).step_by(V::WIDTH) {
                let mut sums = [V::splat(T::ZERO); C];
                for (i, y) in block.iter().enumerate() {
                    let y = V::load(&y[lane..]);
                    for (c, sum) in sums.iter_mut().enumerate() {
                        *sum = V::splat(coeffs[c * count + i]).mul_add(y, *sum);
                    }
                }
                for (values, sum) in values.iter_mut().zip(sums) {
                    sum.store(&mut values[lane..]);
                }
            }
            for (k, out) in out.iter_mut().enumerate() {
                for (out, values) in out.iter_mut().zip(&values) {
                    *out = values[k];
                }
            }
        }
    }
}
