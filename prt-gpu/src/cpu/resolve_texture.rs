use super::rasterize::{Paint, Point, blend};
use super::shade_lobes::{LobeLight, LobeSums, view_factors};
use crate::frame::{orthonormal_or_replaced, orthonormalised, relief_frame, rotate, unit};
use crate::triangle::exact_perspective_weights;
use crate::{LobeSampling, LobeTexture, TexturedSurface};

/// Largest texel coordinate before wrapping: far beyond what `f32` resolves, and within `i32`.
const MAX_COORDINATE: f32 = 1e9;

/// Radiance of a textured surface at its samples: the twin of `shaders/resolve_texture.wgsl`.
///
/// Which texel a sample reads is decided by the same roundings in both twins.
#[derive(Debug)]
pub(super) struct TexturePaint<'a> {
    surface: &'a TexturedSurface<'a>,
    /// `[V]`, orthonormal.
    frames: Vec<[[f32; 3]; 3]>,
    light: &'a LobeLight,
    eye: Option<[f32; 3]>,
    /// Texels per unit of uv.
    scale: [f32; 2],
}

impl<'a> TexturePaint<'a> {
    pub(super) fn new(
        surface: &'a TexturedSurface<'a>,
        frames: &[[[f32; 3]; 3]],
        light: &'a LobeLight,
        eye: Option<[f32; 3]>,
    ) -> Self {
        let frames = frames.iter().map(orthonormal_or_replaced).collect();
        Self { surface, frames, light, eye, scale: texels_per_uv(surface) }
    }
}

/// Texels per unit of uv.
pub(crate) fn texels_per_uv(surface: &TexturedSurface<'_>) -> [f32; 2] {
    [surface.repeat[0] * surface.texture.width as f32, surface.repeat[1] * surface.texture.height as f32]
}

/// Room for the lobes of one point.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    explicit: Vec<f32>,
    coeffs: Vec<f32>,
    axes: Vec<[f32; 3]>,
    lobes: LobeSums,
    factors: Vec<f32>,
}

impl Paint for TexturePaint<'_> {
    type Scratch = Scratch;

    fn radiance(&self, scratch: &mut Scratch, point: &Point) -> [f32; 3] {
        let surface = self.surface;
        let weights = exact_perspective_weights(point.screen, point.inverse_w);
        let uv = blend(weights, point.corners.map(|corner| corner.value(|v| surface.uvs[v])));
        let frame = std::array::from_fn(|k| blend(weights, point.corners.map(|c| c.value(|v| self.frames[v][k]))));
        let frame = orthonormalised(&frame);
        let albedo = blend(weights, point.corners.map(|corner| corner.value(|v| surface.albedo[v])));
        let position = || blend(weights, point.corners.map(|corner| corner.value(|v| surface.positions[v])));

        let place = [0, 1].map(|i| (uv[i] * self.scale[i]).clamp(-MAX_COORDINATE, MAX_COORDINATE));
        let (near, around) = (nearest(&surface.texture, place), bilinear(&surface.texture, place));
        let (explicit, lobes) = match surface.sampling {
            LobeSampling::Nearest => (near, near),
            LobeSampling::PointLobes => (around, near),
            LobeSampling::Bilinear => (around, around),
        };
        scratch.fetch(&surface.texture, &explicit, &lobes);
        scratch.axes.iter_mut().for_each(|axis| *axis = rotate(&frame, *axis));
        let shape = &surface.texture.lobes.shape;
        self.light.add_up(shape, &scratch.axes, &scratch.coeffs, &mut scratch.lobes);
        scratch.factors.resize(shape.rows, 1.0);
        if let Some(map) = surface.texture.lobes.view_map {
            let normal = surface.texture.normals.map(|normals| normals[near.texels[0]]);
            let looked_from = normal.map_or(frame, |normal| relief_frame(&frame, normal));
            view_factors(map, &looked_from, position(), self.eye, &mut scratch.factors);
        }
        let Scratch { explicit: coeffs, lobes, factors, .. } = scratch;
        let transferred = self.light.transfer(shape, coeffs, &frame, (lobes, 0), factors);
        let texel = explicit.albedo(&surface.texture);
        std::array::from_fn(|c| (albedo[c] * texel[c]) * transferred[c])
    }
}

impl Scratch {
    /// Reads what a point needs.
    fn fetch(&mut self, texture: &LobeTexture<'_>, explicit: &Taps, lobes: &Taps) {
        let shape = texture.lobes.shape;
        mix(texture.lobes.explicit, shape.explicit_floats(), explicit, &mut self.explicit);
        mix(texture.lobes.coeffs, shape.coeff_floats(), lobes, &mut self.coeffs);
        let count = shape.axis_count();
        self.axes.clear();
        self.axes.extend((0..count).map(|k| lobes.axis(|texel| texture.lobes.axes[texel * count + k])));
    }
}

/// `out = Σ weights · values` of the taps, `size` numbers each.
fn mix(values: &[f32], size: usize, taps: &Taps, out: &mut Vec<f32>) {
    out.clear();
    out.resize(size, 0.0);
    for (texel, weight) in taps.iter() {
        let values = &values[texel * size..(texel + 1) * size];
        out.iter_mut().zip(values).for_each(|(out, value)| *out += weight * value);
    }
}

/// Texels and their weights.
#[derive(Debug, Clone, Copy)]
struct Taps {
    texels: [usize; 4],
    weights: [f32; 4],
    /// 1 or 4.
    count: usize,
}

impl Taps {
    fn iter(&self) -> impl Iterator<Item = (usize, f32)> {
        self.texels.into_iter().zip(self.weights).take(self.count)
    }

    fn albedo(&self, texture: &LobeTexture<'_>) -> [f32; 3] {
        let Some(albedo) = texture.albedo else { return [1.0; 3] };
        self.iter().fold([0.0; 3], |sum, (texel, w)| std::array::from_fn(|c| sum[c] + w * albedo[texel][c]))
    }

    /// The mean of axes, of unit length; the first one where they cancel.
    fn axis(&self, of_texel: impl Fn(usize) -> [f32; 3]) -> [f32; 3] {
        let first = of_texel(self.texels[0]);
        if self.count == 1 {
            return first;
        }
        let sum = self.iter().fold([0.0; 3], |sum: [f32; 3], (texel, w)| {
            let axis = of_texel(texel);
            std::array::from_fn(|i| sum[i] + w * axis[i])
        });
        unit(sum).unwrap_or(first)
    }
}

/// The texel that a place lies in, in texels.
fn nearest(texture: &LobeTexture<'_>, place: [f32; 2]) -> Taps {
    let texel = texel(texture, place[0].floor() as i32, place[1].floor() as i32);
    Taps { texels: [texel; 4], weights: [1.0, 0.0, 0.0, 0.0], count: 1 }
}

/// The four texels around a place.
fn bilinear(texture: &LobeTexture<'_>, place: [f32; 2]) -> Taps {
    let corner = place.map(|x| x - 0.5);
    let base = corner.map(f32::floor);
    let [s, t] = [corner[0] - base[0], corner[1] - base[1]];
    let (i, j) = (base[0] as i32, base[1] as i32);
    Taps {
        texels: [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)].map(|(i, j)| texel(texture, i, j)),
        weights: [(1.0 - s) * (1.0 - t), s * (1.0 - t), (1.0 - s) * t, s * t],
        count: 4,
    }
}

/// The number of a texel of the tiled texture.
fn texel(texture: &LobeTexture<'_>, column: i32, row: i32) -> usize {
    let wrap = |x: i32, size: usize| x.rem_euclid(size as i32) as usize;
    wrap(row, texture.height) * texture.width + wrap(column, texture.width)
}
