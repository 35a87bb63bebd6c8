//! An atlas of transfer vectors.

use std::path::Path;

use super::grid::Grid;
use super::{Coverage, exr, read_exr};
use crate::{Error, Image, Metadata, TransferVectors};

/// A transfer vector for each texel of an atlas.
///
/// Texel (row 0, column 0) is the upper left of the image and has its corner at texture coordinates (0, 0), as in glTF, or at (0, 1) if
/// `v_up`; texel centres are at `((column + ½)/W, (row + ½)/H)`. Lookups are bilinear. The vectors are in the frame of the scene, hold the
/// `1/π` of the diffuse BRDF and leave out the albedo of their own point, so that a texture of albedo multiplies them.
#[derive(Debug, Clone, PartialEq)]
pub struct TexelTransfer {
    /// How the transfer was made.
    pub metadata: Metadata,
    /// Columns `W`.
    pub width: usize,
    /// Rows `H`.
    pub height: usize,
    /// Whether lookups wrap round along u and along v, because faces leave 0 to 1; else they are clamped to the outermost texels.
    pub wraps: [bool; 2],
    /// Whether v grows upwards, so that row 0 is v = 1.
    pub v_up: bool,
    /// What each texel holds, `[H, W]`.
    pub coverage: Vec<Coverage>,
    /// `[H · W, C, n²]`, row after row; zero in empty texels.
    pub transfer: TransferVectors,
}

impl TexelTransfer {
    /// The transfer vector `[n²]` at texture coordinates, bilinear between the centres of texels, for a colour channel 0, 1 or 2; with one
    /// channel it serves all three. `out` is overwritten.
    ///
    /// On a face it reads baked texels alone, unless another chart is less than two texels away.
    ///
    /// # Panics
    /// If `out` is not `[n²]`.
    pub fn sample(&self, uv: [f32; 2], channel: usize, out: &mut [f32]) {
        assert_eq!(out.len(), self.transfer.order.coeff_count(), "coefficients of a vector");
        let grid = self.grid();
        out.fill(0.0);
        for (texel, weight) in grid.bilinear(grid.place(uv)) {
            let vector = self.transfer.vector(texel, channel);
            out.iter_mut().zip(vector).for_each(|(out, value)| *out += weight as f32 * value);
        }
    }

    /// The atlas under a light: the exit radiance of each texel at albedo 1. Times a texture of albedo it is the lit texture.
    ///
    /// - `light`: `[3, n²]`, channel-major
    ///
    /// # Panics
    /// If `light` is not `[3, n²]`.
    #[must_use]
    pub fn relit(&self, light: &[f32]) -> Image {
        let coeff_count = self.transfer.order.coeff_count();
        assert_eq!(light.len(), 3 * coeff_count, "coefficients of three channels of light");
        let radiance = |texel: usize, channel: usize| -> f32 {
            let light = &light[channel * coeff_count..][..coeff_count];
            self.transfer.vector(texel, channel).iter().zip(light).map(|(transfer, light)| transfer * light).sum()
        };
        let pixels = (0..self.coverage.len()).map(|texel| [0, 1, 2].map(|channel| radiance(texel, channel))).collect();
        Image { width: self.width, height: self.height, pixels }
    }

    /// Writes an OpenEXR image of 32 bits with named channels; returns its size in bytes. The file appears under its name only when it
    /// is complete.
    ///
    /// Channels: `transfer.00`, `transfer.01` … are the coefficients, with `i = l(l+1) + m` in as many digits as the last one needs, so that
    /// they sort; with three channels `transfer.00.r`, `.g`, `.b`, which image viewers show as layers of colour. `coverage` is 0 where a
    /// texel is empty, 0.25 in the gutter, 0.5 at the border of a chart, 1 inside. The metadata are attributes of the image: `prt.kind`
    /// (`texture-transfer`), `prt.order`, `prt.convention`, `prt.rays`, `prt.bounces`, `prt.seed`, `prt.source`, …, and `prt.wrap` (`none`,
    /// `u`, `v` or `uv`) and `prt.v` (`up` or `down`).
    ///
    /// # Errors
    /// If the file cannot be written, or the arrays have different lengths.
    pub fn write_exr(&self, path: &Path) -> Result<u64, Error> {
        self.check_lengths()?;
        exr::write(self, path)
    }

    /// Reads what [`write_exr`](Self::write_exr) wrote; every number comes back as it was. Other programs may have compressed the image
    /// anew, without loss.
    ///
    /// # Errors
    /// If the file cannot be read, is not such an image, is of another convention, lacks a channel, or holds values that are not finite.
    pub fn read_exr(path: &Path) -> Result<Self, Error> {
        read_exr::read(path)
    }

    pub(super) fn grid(&self) -> Grid {
        Grid { width: self.width, height: self.height, wraps: self.wraps, v_up: self.v_up }
    }

    fn check_lengths(&self) -> Result<(), Error> {
        let texels = self.width * self.height;
        let coefficients = texels * self.transfer.channels * self.transfer.order.coeff_count();
        let counts = [
            ("marks of coverage", self.coverage.len(), texels),
            ("coefficients", self.transfer.values.len(), coefficients),
        ];
        match counts.into_iter().find(|&(_, given, needed)| given != needed) {
            Some((what, given, needed)) => {
                Err(Error::InconsistentMesh(format!("{given} {what} for {texels} texels; {needed} are needed")))
            }
            None => Ok(()),
        }
    }
}
