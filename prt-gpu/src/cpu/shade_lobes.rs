use super::build_table::{LightBands, build_table, interleave};
use crate::frame::{IDENTITY, orthonormal_or_replaced, rotate, to_local, unit};
use crate::lobes::LobeShape;
use crate::table::{Block, Places};
use crate::{Evaluation, LobeSurface, LobeTable, Lobes, ViewMap};
use multiversion::multiversion;
use rayon::prelude::*;
use sh_core::{Order, index};
use wide::f32x4;

/// Vertices of one task: its axes and bands stay in the cache.
const CHUNK: usize = 64;

/// A frame: three columns.
type Frame3 = [[f32; 3]; 3];

/// Exit radiance of every vertex of a surface with lobes, in any pose.
///
/// `out[v] = albedo[v] · Σ_r u_r Σ_lm (t~_r rotated by the frame)_lm light_lm` per channel: eq. 10, 13 and 16 of \[SLS05\]. The factors `u_r`
/// are those of the view map towards the eye; without a view map the only row counts fully. Negative values, which ringing can
/// cause, stay.
///
/// - `frames`: `[V]`, rotation from the rest pose, columns; or empty for the rest pose. Mirrors are legal. A frame that is not orthonormal
///   within 0.002 is replaced by one with the same third column and the same plane of the third and first; the identity, where
///   that is zero or a number is not finite
/// - `light`: `[3, k²]` for the `order` of `k` bands in use, at most the order of the lobes
/// - `eye`: in the frame of the positions; without one, and for a vertex at the eye or not finite, it is seen along its local +z
/// - `out`: `[V]`, overwritten
///
/// The result does not depend on the number of threads.
///
/// # Panics
/// If a slice length does not match, `order` exceeds the lobes', or [`Evaluation::check`] refuses the evaluation.
///
/// Source: \[SLS05\] sections 3.2 and 5; the twin of `shaders/shade_lobes.wgsl`.
pub fn shade_lobes(
    surface: &LobeSurface<'_>,
    frames: &[[[f32; 3]; 3]],
    light: &[f32],
    order: Order,
    eye: Option<[f32; 3]>,
    evaluation: Evaluation,
    out: &mut [[f32; 3]],
) {
    assert_eq!(out.len(), surface.vertex_count(), "length of the output");
    assert!(frames.is_empty() || frames.len() == out.len(), "{} frames for {} vertices", frames.len(), out.len());
    let light = LobeLight::new(light, order, &surface.lobes.shape, evaluation);
    out.par_chunks_mut(CHUNK).enumerate().for_each_init(Scratch::default, |scratch, (chunk, out)| {
        let first = chunk * CHUNK;
        scratch.shade(surface, frames, &light, eye, first, out);
    });
}

/// Room for the axes of some points.
#[derive(Debug, Default)]
struct Scratch {
    frames: Vec<Frame3>,
    axes: Vec<[f32; 3]>,
    lobes: LobeSums,
    factors: Vec<f32>,
}

impl Scratch {
    fn shade(
        &mut self,
        surface: &LobeSurface<'_>,
        frames: &[Frame3],
        light: &LobeLight,
        eye: Option<[f32; 3]>,
        first: usize,
        out: &mut [[f32; 3]],
    ) {
        let frame = |v: usize| frames.get(v).map_or(IDENTITY, orthonormal_or_replaced);
        self.frames.clear();
        self.frames.extend((first..first + out.len()).map(frame));
        self.rotate_axes(&surface.lobes, first);
        let shape = surface.lobes.shape;
        let size = shape.coeff_floats();
        let coeffs = &surface.lobes.coeffs[first * size..(first + out.len()) * size];
        light.add_up(&shape, &self.axes, coeffs, &mut self.lobes);
        self.factors.resize(shape.rows, 1.0);
        for (k, out) in out.iter_mut().enumerate() {
            let (v, frame) = (first + k, &self.frames[k]);
            if let Some(map) = surface.lobes.view_map {
                let rest = surface.local_frames.map_or(IDENTITY, |local| orthonormal_or_replaced(&local[v]));
                let local = rest.map(|column| rotate(frame, column));
                view_factors(map, &local, surface.positions[v], eye, &mut self.factors);
            }
            let size = shape.explicit_floats();
            let explicit = &surface.lobes.explicit[v * size..(v + 1) * size];
            let transferred = light.transfer(&shape, explicit, frame, (&self.lobes, k), &self.factors);
            *out = std::array::from_fn(|c| surface.albedo[v][c] * transferred[c]);
        }
    }

    fn rotate_axes(&mut self, lobes: &Lobes<'_>, first: usize) {
        let count = lobes.shape.axis_count();
        self.axes.clear();
        for (k, frame) in self.frames.iter().enumerate() {
            let axes = &lobes.axes[(first + k) * count..(first + k + 1) * count];
            self.axes.extend(axes.iter().map(|axis| rotate(frame, *axis)));
        }
    }
}

/// The factors of the rows for a point and an eye.
pub(super) fn view_factors(
    map: ViewMap<'_>,
    local: &Frame3,
    position: [f32; 3],
    eye: Option<[f32; 3]>,
    out: &mut [f32],
) {
    let towards = |eye: [f32; 3]| unit(std::array::from_fn(|i| eye[i] - position[i]));
    let direction = eye.and_then(towards).map_or([0.0, 0.0, 1.0], |direction| to_local(local, direction));
    map.sample(direction, out);
}

/// A light, made ready for lobes.
#[derive(Debug, Clone)]
pub(super) struct LobeLight {
    /// `e_0` of three channels.
    dc: f32x4,
    /// The linear band as three vectors, one component of all channels beside the other: `(−e_3, −e_1, e_2)`.
    linear: [f32x4; 3],
    /// Bands in use that lobes describe.
    pub(super) band_count: usize,
    source: Source,
}

#[derive(Debug, Clone)]
enum Source {
    Direct(LightBands),
    Table(LobeTable),
}

impl LobeLight {
    pub(super) fn new(light: &[f32], order: Order, shape: &LobeShape, evaluation: Evaluation) -> Self {
        assert!(order <= shape.order, "order {order} exceeds the stored order {}", shape.order);
        assert_eq!(light.len(), 3 * order.coeff_count(), "length of the light");
        if let Err(error) = evaluation.check() {
            panic!("{error}");
        }
        let first_band = shape.first_band();
        let coeffs = interleave(light, order);
        let linear =
            |m, sign: f32| coeffs.get(index(1, m)).map_or(f32x4::ZERO, |e| f32x4::from(*e) * f32x4::splat(sign));
        let source = match evaluation {
            Evaluation::Direct => Source::Direct(LightBands::new(light, order, first_band)),
            Evaluation::Table { width, height } => Source::Table(build_table(light, order, first_band, width, height)),
        };
        Self {
            dc: coeffs[0].into(),
            linear: [linear(1, -1.0), linear(-1, -1.0), linear(0, 1.0)],
            band_count: order.get().saturating_sub(first_band),
            source,
        }
    }

    /// What the lobes of points transfer.
    ///
    /// - `axes`: `[P, R, N]`, rotated by the frames
    /// - `coeffs`: `[P, R, C, N, n]`
    pub(super) fn add_up(&self, shape: &LobeShape, axes: &[[f32; 3]], coeffs: &[f32], out: &mut LobeSums) {
        out.rows.clear();
        if self.band_count == 0 || axes.is_empty() {
            return;
        }
        match &self.source {
            Source::Table(table) => {
                out.places.resize(Places::count(axes.len()), Places::default());
                table.layout.places(axes, &mut out.places);
            }
            Source::Direct(bands) => {
                out.blocks.resize(axes.len() * self.block_count(), [f32x4::ZERO; 3]);
                bands.evaluate(axes, &mut out.basis, &mut out.blocks);
            }
        }
        out.rows.resize(axes.len() / shape.lobe_count, f32x4::ZERO);
        add_up_rows(shape, self.block_count(), &self.source, coeffs, out);
    }

    /// Blocks of four bands per channel.
    fn block_count(&self) -> usize {
        self.band_count.div_ceil(4)
    }

    /// Radiance of a point without its albedo.
    ///
    /// - `explicit`: `[R, C, k]`
    /// - `lobes`: as [`LobeLight::add_up`] makes them, and the point's number among them
    /// - `factors`: `[R]`
    #[inline(always)]
    pub(super) fn transfer(
        &self,
        shape: &LobeShape,
        explicit: &[f32],
        frame: &Frame3,
        (lobes, point): (&LobeSums, usize),
        factors: &[f32],
    ) -> [f32; 3] {
        let local = self.local_linear(frame);
        let explicit = explicit.chunks_exact(shape.channels * shape.explicit_count);
        let mut sum = f32x4::ZERO;
        for (r, (factor, explicit)) in factors.iter().zip(explicit).enumerate() {
            let mut row = self.explicit(shape, explicit, &local);
            if let Some(lobes) = lobes.rows.get(point * shape.rows + r) {
                row += *lobes;
            }
            sum += f32x4::splat(*factor) * row;
        }
        let [red, green, blue, _] = sum.to_array();
        [red, green, blue]
    }

    /// The linear band as a vector in a local frame.
    #[inline(always)]
    fn local_linear(&self, frame: &Frame3) -> [f32x4; 3] {
        let [x, y, z] = self.linear;
        let along = |[a, b, c]: [f32; 3]| (x * f32x4::splat(a) + y * f32x4::splat(b)) + z * f32x4::splat(c);
        [along(frame[0]), along(frame[1]), along(frame[2])]
    }

    /// Explicit coefficients `[C, k]` under the light, its linear band in the local frame.
    #[inline(always)]
    fn explicit(&self, shape: &LobeShape, explicit: &[f32], [x, y, z]: &[f32x4; 3]) -> f32x4 {
        let k = shape.explicit_count;
        let channels = |i: usize| match shape.channels {
            3 => f32x4::from([explicit[i], explicit[k + i], explicit[2 * k + i], 0.0]),
            _ => f32x4::splat(explicit[i]),
        };
        let dc = channels(0) * self.dc;
        if k == 1 {
            return dc;
        }
        // The linear band is a vector, which the frame turns like a direction.
        ((dc - channels(3) * *x) - channels(1) * *y) + channels(2) * *z
    }
}

/// What the lobes of some points transfer, and room to find it.
#[derive(Debug, Default)]
pub(super) struct LobeSums {
    /// `[P, R]`, three channels; empty without lobes.
    rows: Vec<f32x4>,
    /// Where the axes are in the table.
    places: Vec<Places>,
    /// Or their bands, `[axes, ⌈bands/4⌉]`.
    blocks: Vec<Block>,
    /// Room for the basis functions.
    basis: Vec<f32>,
}

/// Adds up the lobes of each row from the places of their axes or their blocks of bands.
#[multiversion(targets("x86_64+avx+avx2"))]
fn add_up_rows(shape: &LobeShape, block_count: usize, source: &Source, coeffs: &[f32], sums: &mut LobeSums) {
    let LobeSums { rows, places, blocks, .. } = sums;
    match source {
        // Constants let the loop over blocks and the choice of channels vanish.
        Source::Table(table) if block_count == 1 && shape.channels == 1 => {
            let bands = |axis, block| table.block(&Places::nth(places, axis), block, 1);
            add_up_bands(&LobeShape { channels: 1, ..*shape }, 1, coeffs, bands, rows);
        }
        Source::Direct(_) if block_count == 1 && shape.channels == 1 => {
            let bands = |axis, block| blocks[axis + block];
            add_up_bands(&LobeShape { channels: 1, ..*shape }, 1, coeffs, bands, rows);
        }
        Source::Table(table) => {
            let bands = |axis, block| table.block(&Places::nth(places, axis), block, block_count);
            add_up_bands(shape, block_count, coeffs, bands, rows);
        }
        Source::Direct(_) => {
            let bands = |axis, block| blocks[axis * block_count + block];
            add_up_bands(shape, block_count, coeffs, bands, rows);
        }
    }
}

/// `out[r] = Σ_jl coeffs_rjl ê_l(axis_rj)` per channel, four bands at a time.
#[inline(always)]
fn add_up_bands(
    shape: &LobeShape,
    block_count: usize,
    coeffs: &[f32],
    bands: impl Fn(usize, usize) -> Block,
    out: &mut [f32x4],
) {
    let (n, first_band, lobe_count) = (shape.order.get(), shape.first_band(), shape.lobe_count);
    let (is_grey, channel) = (shape.channels == 1, lobe_count * n);
    for (r, (coeffs, out)) in coeffs.chunks_exact(shape.channels * channel).zip(out).enumerate() {
        let mut sum = [f32x4::ZERO; 3];
        for j in 0..lobe_count {
            for block in 0..block_count {
                let e = bands(r * lobe_count + j, block);
                let first = j * n + first_band + 4 * block;
                let red = four(coeffs, first);
                let (green, blue) = match is_grey {
                    true => (red, red),
                    false => (four(coeffs, channel + first), four(coeffs, 2 * channel + first)),
                };
                sum = [sum[0] + red * e[0], sum[1] + green * e[1], sum[2] + blue * e[2]];
            }
        }
        let [a, b, c, d] = f32x4::transpose([sum[0], sum[1], sum[2], f32x4::ZERO]);
        *out = (a + b) + (c + d);
    }
}

/// Four coefficients, zeros beyond the last. Those beyond the bands in use do not count: there blocks are zero.
#[inline(always)]
fn four(coeffs: &[f32], first: usize) -> f32x4 {
    let coeffs = &coeffs[first..];
    match coeffs.first_chunk::<4>() {
        Some(four) => f32x4::from(*four),
        None => last_ones(coeffs),
    }
}

#[cold]
fn last_ones(coeffs: &[f32]) -> f32x4 {
    f32x4::from(std::array::from_fn(|i| coeffs.get(i).copied().unwrap_or(0.0)))
}
