//! The basis by recurrence: any order, and the reference for the unrolled kernels.
//!
//! On the unit sphere, for m ≥ 0, `y_lm = N_lm q_lm(z) C_m` and `y_l−m = N_lm q_lm(z) S_m`, with
//!
//! ```text
//! C_0 = 1/√(4π), S_0 = 0,  C_m + i S_m = r_m (x + iy) (C_m−1 + i S_m−1),  r_1 = −√3, r_m = −√((2m+1)/(2m))
//! N_mm = 1,  N_lm = √((2l+1)/(2l−1) · (l+m)/(l−m)) N_l−1,m
//! q_mm = 1,  (l+m) q_lm = (2l−1) z q_l−1,m − (l−1−m) q_l−2,m
//! ```
//!
//! `q` is scaled to be 1 at z = 1 in every band. The plain recurrence for it loses `l²` units there: neighbours are nearly
//! equal, and their difference comes from `1 − z`, which it never forms. So the difference is what is carried, as Reinsch
//! does for Clenshaw sums:
//!
//! ```text
//! δ_l = q_l − q_l−1,   (l+m) δ_l = (l−1−m) δ_l−1 − (2l−1)(1−z) q_l−1
//! ```
//!
//! with `1 − z` from x and y near the pole, where z has lost it. At z < 0 the functions follow by parity, `(−1)^(l+m)`.
//! Everything is normalised, so nothing overflows; `sin^m theta` is part of `C_m, S_m`, so nothing is divided by it.
//! Columns (fixed `m`) are independent: [`LANES`] of them advance side by side through the bands.

#[cfg(feature = "alloc")]
use alloc::vec::Vec;

#[cfg(feature = "alloc")]
use super::Sink;
use crate::simd::Lanes;
use crate::{Order, Real};

/// Columns that advance together. Eight fill the vector registers and hide the latency of the recurrence.
const LANES: usize = 8;

/// `1/√(4π)`.
const Y_00: f64 = 0.282_094_791_773_878_14;

/// One value for each of the columns `m0..m0 + LANES`.
type Block<W> = [W; LANES];

/// The factors of one band in a block of columns; zero in columns that have not begun, `m ≥ l`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step<W> {
    /// `(l−1−m)/(l+m)`
    keep: Block<W>,
    /// `(2l−1)/(l+m)`
    change: Block<W>,
    /// `N_lm`; 1 at `m = l`.
    norm: Block<W>,
}

impl<W: Real> Step<W> {
    const ZERO: Self = Self { keep: [W::ZERO; LANES], change: [W::ZERO; LANES], norm: [W::ZERO; LANES] };
}

/// Where the factors of the recurrence come from.
pub(super) trait Factors<W> {
    /// What is kept from band to band in a block of columns.
    type Memory: Default;
    /// `r_m`, for m ≥ 1.
    fn ratio(&self, m: usize) -> W;
    /// The factors of band `l` for the columns from `m0`. Bands are asked for in turn, from `l = m0`.
    fn step<'a>(&'a self, m0: usize, l: usize, memory: &'a mut Self::Memory) -> &'a Step<W>;
}

/// Factors computed when they are asked for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Computed;

/// The band before, with the squares `N²`, which are rational.
#[derive(Debug)]
pub(super) struct Previous<W> {
    step: Step<W>,
    squares: Block<f64>,
}

impl<W: Real> Default for Previous<W> {
    fn default() -> Self {
        Self { step: Step::ZERO, squares: [0.0; LANES] }
    }
}

impl<W: Real> Factors<W> for Computed {
    type Memory = Previous<W>;

    fn ratio(&self, m: usize) -> W {
        let m2 = (2 * m) as f64;
        // The √2 that tells m ≠ 0 from m = 0 enters at m = 1.
        let squared = if m == 1 { 3.0 } else { (m2 + 1.0) / m2 };
        W::from_f64(-Real::sqrt(squared))
    }

    #[inline]
    fn step<'a>(&'a self, m0: usize, l: usize, Previous { step, squares }: &'a mut Previous<W>) -> &'a Step<W> {
        for (lane, square) in squares.iter_mut().enumerate().take(l + 1 - m0) {
            let (l, m) = (l as f64, (m0 + lane) as f64);
            if m < l {
                step.keep[lane] = W::from_f64((l - 1.0 - m) / (l + m));
                step.change[lane] = W::from_f64((2.0 * l - 1.0) / (l + m));
                *square *= (2.0 * l + 1.0) * (l + m) / ((2.0 * l - 1.0) * (l - m));
            } else {
                *square = 1.0;
            }
            step.norm[lane] = W::from_f64(Real::sqrt(*square));
        }
        step
    }
}

/// Factors from a table.
#[cfg(feature = "alloc")]
#[derive(Clone, Debug)]
pub(super) struct Tabled<W> {
    order: Order,
    /// `[n]`; the first is not used.
    ratios: Vec<W>,
    /// For each block of columns, one entry per band from `l = m0` on.
    steps: Vec<Step<W>>,
}

#[cfg(feature = "alloc")]
impl<W: Real> Tabled<W> {
    pub(super) fn new(order: Order) -> Self {
        let n = order.get();
        let ratios = (0..n).map(|m| if m == 0 { W::ONE } else { Factors::<W>::ratio(&Computed, m) });
        let block = |m0: usize| {
            let mut previous = Previous::default();
            (m0..n).map(move |l| *Computed.step(m0, l, &mut previous))
        };
        Self { order, ratios: ratios.collect(), steps: (0..n).step_by(LANES).flat_map(block).collect() }
    }
}

#[cfg(feature = "alloc")]
impl<W: Real> Factors<W> for Tabled<W> {
    type Memory = ();

    #[inline(always)]
    fn ratio(&self, m: usize) -> W {
        self.ratios[m]
    }

    #[inline(always)]
    fn step<'a>(&'a self, m0: usize, l: usize, (): &'a mut ()) -> &'a Step<W> {
        // Block b begins after the b blocks before it, of n, n − LANES, n − 2 LANES, ... entries.
        let b = m0 / LANES;
        let start = b * self.order.get() - LANES * (b * b.saturating_sub(1) / 2);
        &self.steps[start + l - m0]
    }
}

/// Evaluates all basis functions: works in `W`, writes `T`.
#[inline]
pub(super) fn eval<W: Real, T: Real>(order: Order, direction: [W; 3], factors: &impl Factors<W>, out: &mut [T]) {
    visit::<W, W, _>(order, direction, factors, |l, m0, values, [cosines, sines]| {
        let (minus, plus) = out[l * l..(l + 1) * (l + 1)].split_at_mut(l);
        let write = |out: &mut T, value: W, wave: W| *out = T::from_f64((value * wave).to_f64());
        // Column 0 has no sine.
        let (minus, plus, first) = (&mut minus[..l + 1 - m0.max(1)], &mut plus[m0..], usize::from(m0 == 0));
        match (minus.last_chunk_mut::<LANES>(), plus.first_chunk_mut::<LANES>()) {
            (Some(minus), Some(plus)) if first == 0 => {
                for j in 0..LANES {
                    write(&mut plus[j], values[j], cosines[j]);
                    write(&mut minus[LANES - 1 - j], values[j], sines[j]);
                }
            }
            _ => {
                for (j, out) in plus.iter_mut().take(LANES).enumerate() {
                    write(out, values[j], cosines[j]);
                }
                for (j, out) in (first..LANES).zip(minus.iter_mut().rev()) {
                    write(out, values[j], sines[j]);
                }
            }
        }
    });
}

/// Hands every `y_i` to `sink`, in lanes.
#[cfg(feature = "alloc")]
#[inline(always)]
pub(super) fn eval_lanes<W: Real, V: Lanes<W>>(
    order: Order,
    direction: [V; 3],
    factors: &Tabled<W>,
    sink: &mut impl Sink<V>,
) {
    visit(order, direction, factors, |l, m0, values, [cosines, sines]| {
        let centre = l * (l + 1);
        for j in 0..LANES.min(l + 1 - m0) {
            sink.put(centre + m0 + j, values[j] * cosines[j]);
            // Column 0 has no sine.
            if m0 + j > 0 {
                sink.put(centre - m0 - j, values[j] * sines[j]);
            }
        }
    });
}

/// The value of an expansion, without storing the basis.
pub(super) fn reconstruct<W: Real, T: Real>(order: Order, direction: [W; 3], coeffs: &[T]) -> T {
    let mut sums = [W::ZERO; LANES];
    visit::<W, W, _>(order, direction, &Computed, |l, m0, values, [cosines, sines]| {
        let centre = l * (l + 1);
        for lane in 0..LANES.min(l + 1 - m0) {
            let [plus, minus] = [centre + m0 + lane, centre - m0 - lane].map(|i| W::from_f64(coeffs[i].to_f64()));
            sums[lane] += values[lane] * (plus * cosines[lane] + minus * sines[lane]);
        }
    });
    T::from_f64(sums.into_iter().sum::<W>().to_f64())
}

/// Hands every band of every block of columns to `sink(l, m0, N q, [C, S])`; columns with `m > l` are zero.
#[inline(always)]
fn visit<W: Real, V: Lanes<W>, F: Factors<W>>(
    order: Order,
    direction: [V; 3],
    factors: &F,
    mut sink: impl FnMut(usize, usize, &Block<V>, &[Block<V>; 2]),
) {
    let n = order.get();
    let (zero, one) = (V::splat(W::ZERO), V::splat(W::ONE));
    let polar = Polar::new(direction);
    let mut azimuth = [V::splat(W::from_f64(Y_00)), zero];
    for m0 in (0..n).step_by(LANES) {
        // Bands with l − m0 even and odd: at z < 0 they differ by the parity (−1)^(l+m).
        let waves = azimuth_block(m0, n, &polar, factors, &mut azimuth);
        let waves = [flip_columns(&waves, 1, polar.sign), flip_columns(&waves, 0, polar.sign)];
        let (mut q, mut delta, mut values) = ([zero; LANES], [zero; LANES], [zero; LANES]);
        let mut memory = F::Memory::default();
        for l in m0..n {
            let Step { keep, change, norm } = factors.step(m0, l, &mut memory);
            for j in 0..LANES {
                let drop = V::splat(change[j]) * polar.from_pole * q[j];
                delta[j] = V::splat(keep[j]).mul_add(delta[j], -drop);
                q[j] = q[j] + delta[j];
            }
            if l - m0 < LANES {
                q[l - m0] = one;
            }
            for j in 0..LANES {
                values[j] = V::splat(norm[j]) * q[j];
            }
            sink(l, m0, &values, &waves[(l - m0) % 2]);
        }
    }
}

/// Multiplies every other column by `sign`, from `first` on.
#[inline(always)]
fn flip_columns<W: Real, V: Lanes<W>>(waves: &[Block<V>; 2], first: usize, sign: V) -> [Block<V>; 2] {
    let mut flipped = *waves;
    for wave in &mut flipped {
        for column in (first..LANES).step_by(2) {
            wave[column] = wave[column] * sign;
        }
    }
    flipped
}

/// Below this `tan² theta` the distance from the pole is taken from x and y. Its rounding, three units in the last place, is
/// then below that of numbers of size 1.
const POLAR_CAP: f64 = 1.0 / 16.0;

/// What the recurrence needs of a direction.
#[derive(Clone, Copy, Debug)]
struct Polar<V> {
    x: V,
    y: V,
    /// −1 where z < 0, else 1.
    sign: V,
    /// `1 − |z|` of the normalised direction, to full relative accuracy.
    from_pole: V,
    /// `|direction|² − 1`, far below the rounding of the components.
    ///
    /// The components are rounded, so the length is 1 to half a unit in the last place only, and it would enter as its m-th
    /// power: half of the whole error at m = 500.
    excess: V,
}

impl<V> Polar<V> {
    #[inline(always)]
    fn new<W: Real>([x, y, z]: [V; 3]) -> Self
    where
        V: Lanes<W>,
    {
        let (zero, one, half) = (V::splat(W::ZERO), V::splat(W::ONE), V::splat(W::from_f64(0.5)));
        let sign = z.select_less(zero, -one, one);
        let height = z * sign;
        let excess = excess_length2::<W, V>([x, y, z]);
        let radius2 = x.mul_add(x, y * y);
        // Close to the poles the distance is in x and y, elsewhere in z, with a correction for the length of the direction.
        let distance = one - height;
        let near_equator = (half * excess).mul_add(height, distance);
        let close = V::splat(W::from_f64(POLAR_CAP)) * height;
        let from_pole = radius2.select_less(close * height, radius2.div(one + height), near_equator);
        Self { x, y, sign, from_pole, excess }
    }
}

/// `x² + y² + z² − 1` with the rounding errors of the squares. Near 1 the largest parts cancel exactly.
#[inline(always)]
fn excess_length2<W: Real, V: Lanes<W>>(direction: [V; 3]) -> V {
    let [x, y, z] = direction.map(square::<W, V>);
    let add = |[a, a_low]: [V; 2], [b, b_low]: [V; 2]| {
        let sum = a + b;
        let b_part = sum - a;
        [sum, ((a - (sum - b_part)) + (b - b_part)) + (a_low + b_low)]
    };
    let [sum, low] = add(add(x, y), z);
    (sum - V::splat(W::ONE)) + low
}

/// `a²` and the rounding error of it, by splitting `a` into halves (Dekker). It needs no fused multiply-add.
#[inline(always)]
fn square<W: Real, V: Lanes<W>>(a: V) -> [V; 2] {
    let shifted = V::splat(W::SPLIT) * a;
    let high = shifted - (shifted - a);
    let low = a - high;
    let product = a * a;
    let twice = (high + high) * low;
    [product, ((high * high - product) + twice) + low * low]
}

/// `[C_m, S_m]` for the columns from `m0`; `azimuth` holds the last pair of the block before, and of this one afterwards.
#[inline(always)]
fn azimuth_block<W: Real, V: Lanes<W>>(
    m0: usize,
    n: usize,
    &Polar { x, y, excess, .. }: &Polar<V>,
    factors: &impl Factors<W>,
    azimuth: &mut [V; 2],
) -> [Block<V>; 2] {
    let zero = V::splat(W::ZERO);
    let [mut cosines, mut sines] = [[zero; LANES]; 2];
    for (m, (cosine, sine)) in (m0..n).zip(cosines.iter_mut().zip(&mut sines)) {
        if m == 0 {
            [*cosine, *sine] = *azimuth;
            continue;
        }
        let (ratio, [c, s]) = (V::splat(factors.ratio(m)), *azimuth);
        *azimuth = [ratio * x.mul_add(c, -(y * s)), ratio * x.mul_add(s, y * c)];
        // |direction|^−m, which is too near to 1 to be multiplied in step by step.
        let power = V::splat(W::from_f64(-0.5 * m as f64)) * excess;
        [*cosine, *sine] = azimuth.map(|wave| wave.mul_add(power, wave));
    }
    [cosines, sines]
}
