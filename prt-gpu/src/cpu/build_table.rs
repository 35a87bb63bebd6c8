use crate::LobeTable;
use crate::table::{Block, TableLayout};
use multiversion::multiversion;
use sh_core::{BLOCK, Basis, Order};
use wide::f32x4;

/// Directions whose basis functions are evaluated at once.
const CHUNK: usize = 256;

/// Tabulates a light by bands: `ê_l(s) = Σ_m y_lm(s) e_lm` at the texel centres of a map in latitude and longitude.
///
/// - `light`: `[3, k²]` for the `order` of `k` bands
/// - `first_band`: the first band that lobes describe, 1 or 2; those before are left out
/// - `width`, `height`: even width of at least 2
///
/// Accuracy of a texel: rounding, 1e-6 of the light's length. Cost: `3 k²` multiply-adds and one evaluation of the basis per texel.
///
/// # Panics
/// If the length of the light does not match, or a size is 0.
///
/// Source: \[SLS05\] eq. 24; the twin of `shaders/build_table.wgsl`.
pub fn build_table(light: &[f32], order: Order, first_band: usize, width: usize, height: usize) -> LobeTable {
    assert_eq!(light.len(), 3 * order.coeff_count(), "length of the light");
    assert!(width > 0 && width.is_multiple_of(2) && height > 0, "a table of {width} x {height}");
    let layout = TableLayout { width, height, band_count: order.get().saturating_sub(first_band) };
    let blocks = layout.block_count();
    let mut texels = vec![[f32x4::ZERO; 3]; layout.texel_count() * blocks];
    if layout.band_count > 0 {
        let directions = layout.directions();
        let (bands, mut basis) = (LightBands::new(light, order, first_band), Vec::new());
        for (directions, texels) in directions.chunks(CHUNK).zip(texels.chunks_mut(CHUNK * blocks)) {
            bands.evaluate(directions, &mut basis, texels);
        }
    }
    LobeTable { layout, texels }
}

/// A light, to be evaluated by bands at any directions.
#[derive(Debug, Clone)]
pub(super) struct LightBands {
    basis: Basis<f32>,
    first_band: usize,
    /// `[k²]`, the three channels beside each other.
    coeffs: Vec<[f32; 4]>,
}

impl LightBands {
    pub(super) fn new(light: &[f32], order: Order, first_band: usize) -> Self {
        Self { basis: Basis::new(order), first_band, coeffs: interleave(light, order) }
    }

    /// `out[d]` is `ê(directions[d])`, `⌈bands/4⌉` blocks as a texel of a table. `y` is room for the basis functions.
    pub(super) fn evaluate(&self, directions: &[[f32; 3]], y: &mut Vec<f32>, out: &mut [Block]) {
        y.resize(directions.len().div_ceil(BLOCK) * self.coeffs.len() * BLOCK, 0.0);
        self.basis.eval_blocks(directions, y);
        add_up_bands(self, y.as_chunks().0, out);
    }
}

/// [`LightBands::evaluate`] from blocks of basis functions `[⌈D/16⌉, k²]`: loops over directions, which compilers turn into registers.
#[multiversion(targets("x86_64+avx+avx2"))]
fn add_up_bands(light: &LightBands, y: &[[f32; BLOCK]], out: &mut [Block]) {
    let block_count = (light.basis.order().get() - light.first_band).div_ceil(4);
    for (y, out) in y.chunks_exact(light.coeffs.len()).zip(out.chunks_mut(BLOCK * block_count)) {
        for block in 0..block_count {
            let first = light.first_band + 4 * block;
            let bands = [
                band(light, y, first),
                band(light, y, first + 1),
                band(light, y, first + 2),
                band(light, y, first + 3),
            ];
            for (d, out) in out.chunks_exact_mut(block_count).enumerate() {
                for (c, out) in out[block].iter_mut().enumerate() {
                    *out = f32x4::from([bands[0][c][d], bands[1][c][d], bands[2][c][d], bands[3][c][d]]);
                }
            }
        }
    }
}

/// `ê_l` of three channels, or zeros beyond the last band.
#[inline(always)]
fn band(light: &LightBands, y: &[[f32; BLOCK]], l: usize) -> [[f32; BLOCK]; 3] {
    let [mut red, mut green, mut blue] = [[0.0; BLOCK]; 3];
    if l < light.basis.order().get() {
        let range = l * l..(l + 1) * (l + 1);
        for (y, e) in y[range.clone()].iter().zip(&light.coeffs[range]) {
            for (k, y) in y.iter().enumerate() {
                red[k] += y * e[0];
                green[k] += y * e[1];
                blue[k] += y * e[2];
            }
        }
    }
    [red, green, blue]
}

/// A light `[3, k²]` as `[k²]` of red, green, blue and 0.
pub(crate) fn interleave(light: &[f32], order: Order) -> Vec<[f32; 4]> {
    let count = order.coeff_count();
    (0..count).map(|i| [light[i], light[count + i], light[2 * count + i], 0.0]).collect()
}
