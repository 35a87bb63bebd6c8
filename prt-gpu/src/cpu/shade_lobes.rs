use super::build_table::{LightBands, build_table, interleave};
use crate::frame::{IDENTITY, orthonormal_or_replaced, rotate, to_local, unit};
use crate::lobes::LobeShape;
use crate::table::{Block, Place};
use crate::{Evaluation, LobeSurface, LobeTable, Lobes, ViewMap};
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
    bands: Bands,
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
        light.evaluate(&self.axes, &mut self.bands);
        let shape = surface.lobes.shape;
        self.factors.resize(shape.rows, 1.0);
        for (k, out) in out.iter_mut().enumerate() {
            let (v, frame) = (first + k, &self.frames[k]);
            if let Some(map) = surface.lobes.view_map {
                let rest = surface.local_frames.map_or(IDENTITY, |local| orthonormal_or_replaced(&local[v]));
                let local = rest.map(|column| rotate(frame, column));
                view_factors(map, &local, surface.positions[v], eye, &mut self.factors);
            }
            let lobes = PointLobes::of(&surface.lobes, v);
            let first = k * shape.axis_count();
            let transferred = light.transfer(&shape, lobes, frame, (&self.bands, first), &self.factors);
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

/// The lobes of one point.
#[derive(Debug, Clone, Copy)]
pub(super) struct PointLobes<'a> {
    /// `[R, C, k]`.
    pub(super) explicit: &'a [f32],
    /// `[R, C, N, n]`.
    pub(super) coeffs: &'a [f32],
}

impl<'a> PointLobes<'a> {
    pub(super) fn of(lobes: &Lobes<'a>, point: usize) -> Self {
        let (explicit, coeffs) = (lobes.shape.explicit_floats(), lobes.shape.coeff_floats());
        Self {
            explicit: &lobes.explicit[point * explicit..(point + 1) * explicit],
            coeffs: &lobes.coeffs[point * coeffs..(point + 1) * coeffs],
        }
    }
}

/// A light, made ready for lobes.
#[derive(Debug, Clone)]
pub(super) struct LobeLight {
    /// `e_0` of three channels.
    dc: [f32; 4],
    /// The linear band as three vectors, one component of all channels beside the other: `(−e_3, −e_1, e_2)`.
    linear: [[f32; 4]; 3],
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
        let linear = |m, sign: f32| coeffs.get(index(1, m)).map_or([0.0; 4], |e| e.map(|e| sign * e));
        let source = match evaluation {
            Evaluation::Direct => Source::Direct(LightBands::new(light, order, first_band)),
            Evaluation::Table { width, height } => Source::Table(build_table(light, order, first_band, width, height)),
        };
        Self {
            dc: coeffs[0],
            linear: [linear(1, -1.0), linear(-1, -1.0), linear(0, 1.0)],
            band_count: order.get().saturating_sub(first_band),
            source,
        }
    }

    /// Places axes in the table, or evaluates their bands.
    pub(super) fn evaluate(&self, axes: &[[f32; 3]], out: &mut Bands) {
        if self.band_count == 0 {
            return;
        }
        match &self.source {
            Source::Table(table) => table.layout.places(axes, &mut out.places),
            Source::Direct(bands) => {
                out.blocks.resize(axes.len() * self.block_count(), [f32x4::ZERO; 3]);
                bands.evaluate(axes, &mut out.basis, &mut out.blocks);
            }
        }
    }

    /// Blocks of four bands per channel.
    fn block_count(&self) -> usize {
        self.band_count.div_ceil(4)
    }

    /// Radiance of a point without its albedo.
    ///
    /// - `bands`: as [`LobeLight::evaluate`] makes them, and the number of the point's first axis
    /// - `factors`: `[R]`
    pub(super) fn transfer(
        &self,
        shape: &LobeShape,
        lobes: PointLobes<'_>,
        frame: &Frame3,
        (bands, first_axis): (&Bands, usize),
        factors: &[f32],
    ) -> [f32; 3] {
        let (k, n) = (shape.explicit_count, shape.channels * shape.lobe_count * shape.order.get());
        let mut sum = [0.0; 3];
        for (r, factor) in factors.iter().enumerate() {
            let explicit = &lobes.explicit[r * shape.channels * k..(r + 1) * shape.channels * k];
            let mut row = self.explicit(explicit, k, frame);
            if self.band_count > 0 {
                let axis = first_axis + r * shape.lobe_count;
                let lobes = self.lobes(shape, &lobes.coeffs[r * n..(r + 1) * n], bands, axis);
                row = std::array::from_fn(|c| row[c] + lobes[c]);
            }
            sum = std::array::from_fn(|c| sum[c] + factor * row[c]);
        }
        sum
    }

    /// Explicit coefficients `[C, k]` under the light.
    fn explicit(&self, explicit: &[f32], k: usize, frame: &Frame3) -> [f32; 3] {
        let [x, y, z] = self.linear;
        std::array::from_fn(|c| {
            let channel = if explicit.len() > k { &explicit[c * k..(c + 1) * k] } else { explicit };
            let dc = channel[0] * self.dc[c];
            let [_, f1, f2, f3] = *channel else { return dc };
            // The linear band is a vector, which the frame turns like a direction.
            let vector = rotate(frame, [-f3, -f1, f2]);
            dc + ((vector[0] * x[c] + vector[1] * y[c]) + vector[2] * z[c])
        })
    }

    /// The lobes of a row, `[C, N, n]`, under the light.
    fn lobes(&self, shape: &LobeShape, coeffs: &[f32], bands: &Bands, first_axis: usize) -> [f32; 3] {
        let (axes, blocks) = (first_axis..first_axis + shape.lobe_count, self.block_count());
        let mut sum = [f32x4::ZERO; 3];
        for block in 0..blocks {
            match &self.source {
                Source::Table(table) => {
                    let bands = bands.places[axes.clone()].iter().map(|place| table.block(place, block, blocks));
                    self.add_lobes(shape, coeffs, block, bands, &mut sum);
                }
                Source::Direct(_) => {
                    let bands = axes.clone().map(|axis| bands.blocks[axis * blocks + block]);
                    self.add_lobes(shape, coeffs, block, bands, &mut sum);
                }
            }
        }
        sum.map(|sum| sum.reduce_add())
    }

    /// Adds four bands of all lobes of a row.
    #[inline(always)]
    fn add_lobes(
        &self,
        shape: &LobeShape,
        coeffs: &[f32],
        block: usize,
        bands: impl Iterator<Item = Block>,
        sum: &mut Block,
    ) {
        let (n, first) = (shape.order.get(), shape.first_band());
        let used = first + 4 * block..first + self.band_count;
        let channel = shape.lobe_count * n;
        for ((j, lobe), e) in coeffs[..channel].chunks_exact(n).enumerate().zip(bands) {
            let grey = four(&lobe[used.clone()]);
            let g = match shape.channels {
                3 => [0, 1, 2].map(|c| four(&coeffs[c * channel + j * n..][used.clone()])),
                _ => [grey; 3],
            };
            *sum = std::array::from_fn(|c| sum[c] + g[c] * e[c]);
        }
    }
}

/// A light's bands at some axes: where they are in its table, or themselves.
#[derive(Debug, Default)]
pub(super) struct Bands {
    places: Vec<Place>,
    /// `[axes, ⌈bands/4⌉]`.
    blocks: Vec<Block>,
    /// Room for the basis functions.
    basis: Vec<f32>,
}

/// The first four coefficients, zeros beyond the last.
#[inline(always)]
fn four(lobe: &[f32]) -> f32x4 {
    f32x4::from(match lobe.first_chunk::<4>() {
        Some(four) => *four,
        None => std::array::from_fn(|i| lobe.get(i).copied().unwrap_or(0.0)),
    })
}
