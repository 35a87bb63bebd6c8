//! What a bake of texels found.

use serde::Serialize;

use crate::BakeReport;

/// What an atlas holds. What its bake did is in the [`BakeReport`] that this is part of: there, vertices are the texels that a point of the
/// surface is baked for, row after row. Of a part only [`vertices`](Self::vertices) are told; all else is of the whole.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct TexelReport {
    /// Texels whose centre lies on a face.
    pub texels_inside: usize,
    /// Texels near the border of a chart, which lookups on it can read.
    pub texels_border: usize,
    /// Texels of the gutter.
    pub texels_filled: usize,
    /// Texels without a value.
    pub texels_empty: usize,
    /// Texels whose centre lies in several faces: charts overlap there, and the face with the lowest number is baked.
    pub texels_overlapping: usize,
    /// Faces that have no area on the atlas. They get no texel.
    pub faces_degenerate: usize,
    /// Faces that leave 0 to 1, so that the atlas wraps round.
    pub faces_wrapped: usize,
    /// Faces, other than the degenerate ones, that no texel's centre was baked for: smaller than a texel, or below another face.
    pub faces_without_center: usize,
    /// Median number of texels whose centre lies on a face, over the faces that are not degenerate.
    pub texels_per_face: usize,
    /// Edges that lie at two different places of the atlas and are smooth, and so were compared.
    pub seam_edges: usize,
    /// Root mean square difference of bilinear lookups on both sides of these edges, relative to the length of the vectors there.
    pub seam_error: f64,
    /// Largest difference of the two, relative to the root mean square length of the vectors there.
    pub seam_max: f64,
    /// The bake of the vertices that light is reflected from, if there are bounces and it was not done elsewhere. Its rays and its time are its own.
    #[serde(skip)]
    pub vertices: Option<Box<BakeReport>>,
}
