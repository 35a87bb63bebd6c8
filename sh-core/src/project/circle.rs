//! Fourier sums over the texels of a row, and rows from Fourier coefficients.
//!
//! Columns `k` and `width−1−k` have opposite longitudes: cosines agree there and sines differ in sign. In maps of even
//! width the longitudes of `k` and `width/2−1−k` add up to half a turn, where the sign depends on the parity of `m` too. So
//! four texels share one column of the tables.

use alloc::vec;
use alloc::vec::Vec;
use core::array;
use core::f64::consts::TAU;

use crate::simd::{Kernel, Lanes, dispatch};
use crate::{Order, Real};

/// Waves on a circle of texels, for one width and order; and the Fourier coefficients of one row, for three channels.
#[derive(Clone, Debug)]
pub(super) struct Circle {
    order: Order,
    /// Columns that are left after folding: `width/4`, or `width/2` of odd widths, rounded up.
    folded: usize,
    /// `[n, folded]`: cosines; halved at a column that is its own partner, which is met twice.
    cosine_waves: Vec<f64>,
    /// `[n, folded]`: sines, the same way.
    sine_waves: Vec<f64>,
    /// `[3, n]`: sums of a row with `cos(m longitude)`, or the coefficients of a row.
    pub(super) cosines: Vec<f64>,
    /// `[3, n]`: the same with sines; 0 for m = 0.
    pub(super) sines: Vec<f64>,
    /// `[width]` each: the row.
    rows: [Vec<f64>; 3],
    folds: Folds,
}

/// The parts of a row that waves of one kind see, `[folded]` each.
#[derive(Clone, Debug)]
struct Folds {
    /// Cosines of even and of odd m.
    cosines: [Vec<f64>; 2],
    /// Sines of even and of odd m.
    sines: [Vec<f64>; 2],
}

impl Circle {
    pub(super) fn new(order: Order, width: usize) -> Self {
        let n = order.get();
        let folded_circle = if width.is_multiple_of(2) { width / 2 } else { width };
        let folded = folded_circle.div_ceil(2);
        let share = |k: usize| if 2 * k + 1 == folded_circle { 0.5 } else { 1.0 };
        // Longitudes are whole multiples of a full turn / (2 width): reduced before they are rounded.
        let turns = |m: usize, k: usize| (m * (2 * k + 1) % (2 * width)) as f64 / (2 * width) as f64;
        let table = |wave: fn(f64) -> f64| -> Vec<f64> {
            (0..n).flat_map(|m| (0..folded).map(move |k| share(k) * wave(TAU * turns(m, k)))).collect()
        };
        let part = || vec![0.0; folded];
        Self {
            order,
            folded,
            cosine_waves: table(Real::cos),
            sine_waves: table(Real::sin),
            cosines: vec![0.0; 3 * n],
            sines: vec![0.0; 3 * n],
            rows: array::from_fn(|_| vec![0.0; width]),
            folds: Folds { cosines: [part(), part()], sines: [part(), part()] },
        }
    }

    /// Takes the sums of a row `[width]`.
    pub(super) fn analyse<T: Real>(&mut self, row: &[[T; 3]]) {
        dispatch(Analysis { circle: self, row });
    }

    /// The rows of the three channels with the coefficients `cosines` and `sines`.
    pub(super) fn synthesise(&mut self) -> &[Vec<f64>; 3] {
        dispatch(Synthesis { circle: self });
        &self.rows
    }
}

/// [`Circle::analyse`], compiled for the registers of the machine: plain loops, which compilers vectorise.
struct Analysis<'a, T> {
    circle: &'a mut Circle,
    row: &'a [[T; 3]],
}

impl<T: Real> Kernel<f64> for Analysis<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes<f64>>(self) {
        let Circle { order, cosine_waves, sine_waves, cosines, sines, rows, folds, .. } = self.circle;
        split_channels(self.row, rows);
        let n = order.get();
        for (channel, row) in rows.iter().enumerate() {
            folds.fold(row);
            let channel = channel * n..(channel + 1) * n;
            for parity in 0..n.min(2) {
                sums::<V>(cosine_waves, &folds.cosines[parity], parity, &mut cosines[channel.clone()][parity..]);
                sums::<V>(sine_waves, &folds.sines[parity], parity, &mut sines[channel.clone()][parity..]);
            }
        }
    }
}

/// [`Circle::synthesise`], the same way.
struct Synthesis<'a> {
    circle: &'a mut Circle,
}

impl Kernel<f64> for Synthesis<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes<f64>>(self) {
        let Circle { order, folded, cosine_waves, sine_waves, cosines, sines, rows, folds } = self.circle;
        let n = order.get();
        for (channel, row) in rows.iter_mut().enumerate() {
            folds.clear();
            for m in 0..n {
                let wave = m * *folded..(m + 1) * *folded;
                add_scaled(cosines[channel * n + m], &cosine_waves[wave.clone()], &mut folds.cosines[m % 2]);
                add_scaled(sines[channel * n + m], &sine_waves[wave], &mut folds.sines[m % 2]);
            }
            folds.unfold(row);
        }
    }
}

#[inline(always)]
fn split_channels<T: Real>(row: &[[T; 3]], [red, green, blue]: &mut [Vec<f64>; 3]) {
    for (((pixel, red), green), blue) in row.iter().zip(red).zip(green).zip(blue) {
        (*red, *green, *blue) = (pixel[0].to_f64(), pixel[1].to_f64(), pixel[2].to_f64());
    }
}

/// The sums of a part with every other wave from `m0`, where `out` begins.
#[inline(always)]
fn sums<V: Lanes<f64>>(waves: &[f64], part: &[f64], m0: usize, out: &mut [f64]) {
    let wave = |m: usize| &waves[m * part.len()..(m + 1) * part.len()];
    let mut k = 0;
    while k < out.len() {
        let m = m0 + k;
        // As many waves at a time as share the registers well.
        match (out.len() - k).div_ceil(2) {
            1 => [out[k]] = dots::<V, 1>([wave(m)], part),
            2 => [out[k], out[k + 2]] = dots::<V, 2>([wave(m), wave(m + 2)], part),
            _ => [out[k], out[k + 2], out[k + 4]] = dots::<V, 3>([wave(m), wave(m + 2), wave(m + 4)], part),
        }
        k += 6;
    }
}

/// The dot products of some waves with a part.
#[inline(always)]
fn dots<V: Lanes<f64>, const WAVES: usize>(waves: [&[f64]; WAVES], part: &[f64]) -> [f64; WAVES] {
    let mut sums = [[V::splat(0.0); 2]; WAVES];
    let step = 2 * V::WIDTH;
    let whole = part.len() / step * step;
    for k in (0..whole).step_by(step) {
        let (near, far) = (V::load(&part[k..]), V::load(&part[k + V::WIDTH..]));
        for (sum, wave) in sums.iter_mut().zip(waves) {
            let wave = &wave[k..k + step];
            *sum = [V::load(wave).mul_add(near, sum[0]), V::load(&wave[V::WIDTH..]).mul_add(far, sum[1])];
        }
    }
    let mut out = [0.0; WAVES];
    for ((out, wave), [near, far]) in out.iter_mut().zip(waves).zip(sums) {
        let mut lanes = [0.0; 8];
        (near + far).store(&mut lanes);
        let [s0, s1, s2, s3, s4, s5, s6, s7] = lanes;
        let rest: f64 = wave[whole..].iter().zip(&part[whole..]).map(|(a, b)| a * b).sum();
        *out = (((s0 + s4) + (s2 + s6)) + ((s1 + s5) + (s3 + s7))) + rest;
    }
    out
}

/// `out += factor · wave`
#[inline(always)]
fn add_scaled(factor: f64, wave: &[f64], out: &mut [f64]) {
    for (out, wave) in out.iter_mut().zip(wave) {
        *out += factor * wave;
    }
}

impl Folds {
    /// Adds up the columns that share an entry of the tables, with the signs that the waves have there.
    #[inline(always)]
    fn fold(&mut self, row: &[f64]) {
        let [[cos_even, cos_odd], [sin_even, sin_odd]] = [&mut self.cosines, &mut self.sines];
        let (near, far) = row.split_at(row.len().div_ceil(2));
        let columns = cos_even.iter_mut().zip(cos_odd).zip(sin_even.iter_mut().zip(sin_odd));
        if !row.len().is_multiple_of(2) {
            let opposite = row.iter().rev();
            for (((ce, co), (se, so)), (a, d)) in columns.zip(near.iter().zip(opposite)) {
                (*ce, *co) = (a + d, a + d);
                (*se, *so) = (a - d, a - d);
            }
            return;
        }
        let texels = near.iter().zip(near.iter().rev()).zip(far.iter().zip(far.iter().rev()));
        for (((ce, co), (se, so)), ((a, b), (c, d))) in columns.zip(texels) {
            let (cos_near, cos_far, sin_near, sin_far) = (a + d, b + c, a - d, c - b);
            (*ce, *co) = (cos_near + cos_far, cos_near - cos_far);
            (*se, *so) = (sin_near + sin_far, sin_near - sin_far);
        }
    }

    #[inline(always)]
    fn clear(&mut self) {
        self.cosines.iter_mut().chain(&mut self.sines).for_each(|part| part.fill(0.0));
    }

    /// The adjoint of [`Folds::fold`]: overwrites the row.
    #[inline(always)]
    fn unfold(&self, row: &mut [f64]) {
        let [[cos_even, cos_odd], [sin_even, sin_odd]] = [&self.cosines, &self.sines];
        let (length, last) = (row.len(), row.len() - 1);
        row.fill(0.0);
        for k in 0..cos_even.len() {
            let (even, odd) = ([cos_even[k], sin_even[k]], [cos_odd[k], sin_odd[k]]);
            let near = [even[0] + odd[0], even[1] + odd[1]];
            row[k] += near[0] + near[1];
            row[last - k] += near[0] - near[1];
            if length.is_multiple_of(2) {
                let far = [even[0] - odd[0], even[1] - odd[1]];
                row[last / 2 - k] += far[0] - far[1];
                row[length / 2 + k] += far[0] + far[1];
            }
        }
    }
}
