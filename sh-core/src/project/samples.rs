//! Samples at any directions to coefficients, and coefficients to values at any directions: fused kernels that never store
//! the basis.

use alloc::vec;
use alloc::vec::Vec;
use core::marker::PhantomData;

use crate::basis::{Groups, Sink};
use crate::order::assert_length;
use crate::simd::{Kernel, Lanes, dispatch};
use crate::{Basis, Real};

/// Groups of directions whose products are added up in the type of the samples before they go on in `f64`: 32 roundings of
/// a random sign, against which the sum over all samples loses nothing.
const GROUPS_AT_ONCE: usize = 32;

/// The lanes of the widest register.
const MAX_WIDTH: usize = 16;

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
        if self.is_native() {
            dispatch(Projection { basis: self, directions, samples, sums: &mut sums });
        } else {
            let mut y = vec![T::ZERO; count];
            for (&direction, sample) in directions.iter().zip(samples) {
                self.eval(direction, &mut y);
                for (sums, sample) in sums.chunks_exact_mut(count).zip(sample) {
                    sums.iter_mut().zip(&y).for_each(|(sum, &y)| *sum += sample.to_f64() * y.to_f64());
                }
            }
        }
        out.iter_mut().zip(sums).for_each(|(out, sum)| *out = T::from_f64(sum));
    }

    /// The values of expansions at many directions: `out[d][c] = Σ_i coeffs[c, i] y_i(directions[d])`.
    ///
    /// - `coeffs`: `[C, n²]`, channel-major
    /// - `directions`: `[D]`, unit length
    /// - `out`: `[D]` of `C` channels, overwritten
    ///
    /// Works on several directions at once. Accuracy as of [`reconstruct`](crate::reconstruct). Does not allocate up to the
    /// order at which `T` has the range for the recurrence (128 in `f32`).
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
        if self.is_native() {
            dispatch(Reconstruction { basis: self, coeffs, directions, out });
            return;
        }
        let mut y = vec![T::ZERO; count];
        for (&direction, out) in directions.iter().zip(out) {
            self.eval(direction, &mut y);
            for (out, coeffs) in out.iter_mut().zip(coeffs.chunks_exact(count)) {
                *out = crate::dot(coeffs, &y);
            }
        }
    }
}

/// [`Basis::project`] in lanes.
struct Projection<'a, T, const C: usize> {
    basis: &'a Basis<T>,
    directions: &'a [[T; 3]],
    samples: &'a [[T; C]],
    sums: &'a mut [f64],
}

impl<T: Real, const C: usize> Kernel<T> for Projection<'_, T, C> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes<T>>(self) {
        let count = self.basis.order().coeff_count();
        let mut partial: Vec<V> = vec![V::splat(T::ZERO); C * count];
        let mut groups = 0;
        for (group, direction) in Groups::<T, V>::new(self.directions) {
            let samples = load_samples(&self.samples[group]);
            self.basis
                .eval_lanes(direction, &mut Accumulate { sums: &mut partial, samples, count, scalar: PhantomData });
            groups += 1;
            if groups == GROUPS_AT_ONCE {
                flush(&mut partial, self.sums);
                groups = 0;
            }
        }
        flush(&mut partial, self.sums);
    }
}

/// Adds `y_i` times the samples to sums `[C, n²]`.
struct Accumulate<'a, T, V, const C: usize> {
    sums: &'a mut [V],
    samples: [V; C],
    count: usize,
    scalar: PhantomData<T>,
}

impl<T: Real, V: Lanes<T>, const C: usize> Sink<V> for Accumulate<'_, T, V, C> {
    #[inline(always)]
    fn put(&mut self, i: usize, value: V) {
        for (c, &sample) in self.samples.iter().enumerate() {
            let sum = &mut self.sums[c * self.count + i];
            *sum = sample.mul_add(value, *sum);
        }
    }
}

/// The channels of a group of samples in lanes; 0 in lanes without a sample.
#[inline(always)]
fn load_samples<T: Real, V: Lanes<T>, const C: usize>(samples: &[[T; C]]) -> [V; C] {
    let mut channels = [V::splat(T::ZERO); C];
    for (c, channel) in channels.iter_mut().enumerate() {
        let mut lanes = [T::ZERO; MAX_WIDTH];
        lanes.iter_mut().zip(samples).for_each(|(lane, sample)| *lane = sample[c]);
        *channel = V::load(&lanes);
    }
    channels
}

/// Moves the lanes of partial sums on.
#[inline(always)]
fn flush<T: Real, V: Lanes<T>>(partial: &mut [V], sums: &mut [f64]) {
    for (partial, sum) in partial.iter_mut().zip(sums) {
        let mut lanes = [T::ZERO; MAX_WIDTH];
        partial.store(&mut lanes);
        *sum += lanes.into_iter().map(T::to_f64).sum::<f64>();
        *partial = V::splat(T::ZERO);
    }
}

/// [`Basis::reconstruct`] in lanes.
struct Reconstruction<'a, T, const C: usize> {
    basis: &'a Basis<T>,
    coeffs: &'a [T],
    directions: &'a [[T; 3]],
    out: &'a mut [[T; C]],
}

impl<T: Real, const C: usize> Kernel<T> for Reconstruction<'_, T, C> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes<T>>(self) {
        let count = self.basis.order().coeff_count();
        for (group, direction) in Groups::<T, V>::new(self.directions) {
            let mut dots = Dots { coeffs: self.coeffs, sums: [V::splat(T::ZERO); C], count };
            self.basis.eval_lanes(direction, &mut dots);
            for (c, sum) in dots.sums.into_iter().enumerate() {
                let mut lanes = [T::ZERO; MAX_WIDTH];
                sum.store(&mut lanes);
                self.out[group.clone()].iter_mut().zip(lanes).for_each(|(out, lane)| out[c] = lane);
            }
        }
    }
}

/// Adds `coeffs[c, i] y_i` to the value of each channel.
struct Dots<'a, T, V, const C: usize> {
    coeffs: &'a [T],
    sums: [V; C],
    count: usize,
}

impl<T: Real, V: Lanes<T>, const C: usize> Sink<V> for Dots<'_, T, V, C> {
    #[inline(always)]
    fn put(&mut self, i: usize, value: V) {
        for (c, sum) in self.sums.iter_mut().enumerate() {
            *sum = V::splat(self.coeffs[c * self.count + i]).mul_add(value, *sum);
        }
    }
}
