//! From the transfer of texels to an atlas.

use super::plan::AtlasPlan;
use super::{Coverage, TexelReport, TexelTransfer, gutter, seam};
use crate::{InsidePolicy, Metadata, TransferVectors};

/// The last settings of an atlas.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Finish<'a> {
    pub(crate) inside: InsidePolicy,
    /// See [`TexelOptions::gutter`](super::TexelOptions::gutter).
    pub(crate) gutter: usize,
    /// Texels inside of solids, among those that are baked.
    pub(crate) invalid: &'a [u32],
}

impl AtlasPlan {
    /// Puts the atlas together.
    ///
    /// - `transfer`: `[H · W, C, n²]`, zero where nothing was baked
    pub(crate) fn finish(
        self,
        metadata: Metadata,
        transfer: TransferVectors,
        finish: Finish,
    ) -> (TexelTransfer, TexelReport) {
        let mut report = self.report();
        let Self { grid, coverage, cuts, .. } = self;
        let (width, height, wraps, v_up) = (grid.width, grid.height, grid.wraps, grid.v_up);
        let mut atlas = TexelTransfer { metadata, width, height, wraps, v_up, coverage, transfer };
        replace_invalid(&mut atlas, finish);
        gutter::fill(&mut atlas, finish.gutter);
        let count = |kind: Coverage| atlas.coverage.iter().filter(|&&coverage| coverage == kind).count();
        report.texels_inside = count(Coverage::Inside);
        report.texels_border = count(Coverage::Border);
        report.texels_filled = count(Coverage::Filled);
        report.texels_empty = count(Coverage::Empty);
        let seams = seam::check(&atlas, &cuts);
        (report.seam_edges, report.seam_error, report.seam_max) = (seams.edges, seams.error, seams.max);
        (atlas, report)
    }
}

/// Empties the texels inside of solids where they are not to be kept; the gutter then reaches into them where they are to be filled. If all
/// are inside, nothing is replaced.
fn replace_invalid(atlas: &mut TexelTransfer, Finish { inside, invalid, .. }: Finish) {
    let is_all = invalid.len() == atlas.coverage.iter().filter(|coverage| coverage.is_baked()).count();
    if inside == InsidePolicy::Keep || is_all {
        return;
    }
    let length = atlas.transfer.channels * atlas.transfer.order.coeff_count();
    for texel in invalid.iter().map(|&texel| texel as usize) {
        atlas.transfer.values[texel * length..][..length].fill(0.0);
        if inside == InsidePolicy::Fill {
            atlas.coverage[texel] = Coverage::Empty;
        }
    }
}
