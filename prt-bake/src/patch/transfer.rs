//! Shaped storage for the transfer of a patch.

use sh_core::Order;

use super::field::HeightField;
use super::options::PatchOptions;

/// Transfer of each texel, row and channel, in the tile's frame: x along u, y along v, z up from the surface that the patch is put on.
///
/// Diffuse transfer holds the `1/π` of the BRDF and the cosine with the micro-surface's normal, and never the albedo of the
/// texel itself: exit radiance is `albedo · (transfer · light)`. Transfer of a translucent patch is all that the medium and its surface
/// send back: exit radiance is `transfer · light`, albedo 1.
#[derive(Debug, Clone, PartialEq)]
pub struct PatchTransfer {
    /// Columns of texels.
    pub width: usize,
    /// Rows of texels.
    pub height: usize,
    /// Number of bands `n`.
    pub order: Order,
    /// Rows `R`: 1 for diffuse and translucent patches, else one for each response.
    pub rows: usize,
    /// Channels `C`: 1 where all have the same transfer, else 3 (red, green, blue).
    pub channels: usize,
    /// `[H, W, R, C, n²]`.
    pub values: Vec<f32>,
    /// Unit normals of the micro-surface `[H, W]`, in the tile's frame.
    pub normals: Vec<[f32; 3]>,
    /// Heights `[H, W]`, units of the tile's width.
    pub heights: Vec<f32>,
}

impl PatchTransfer {
    /// All zero.
    pub(super) fn zero(field: &HeightField, options: &PatchOptions) -> Self {
        let (rows, channels, texels) = (options.row_count(), options.channel_count(), field.texel_count());
        Self {
            width: field.width(),
            height: field.height(),
            order: options.order,
            rows,
            channels,
            values: vec![0.0; texels * rows * channels * options.order.coeff_count()],
            normals: (0..texels).map(|texel| field.normal(texel)).collect(),
            heights: field.heights().to_vec(),
        }
    }

    /// Number of texels.
    #[must_use]
    pub fn texel_count(&self) -> usize {
        self.heights.len()
    }

    /// The transfer vector `[n²]` of a texel and row for a colour channel 0, 1 or 2; with one channel it serves all three.
    ///
    /// # Panics
    /// If there is no such texel or row.
    #[must_use]
    pub fn vector(&self, texel: usize, row: usize, channel: usize) -> &[f32] {
        assert!(row < self.rows, "row {row} of {}", self.rows);
        let number = (texel * self.rows + row) * self.channels + channel.min(self.channels - 1);
        &self.values[number * self.order.coeff_count()..][..self.order.coeff_count()]
    }
}
