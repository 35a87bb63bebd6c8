//! What a bake of texels found and did.

use std::time::Duration;

use crate::BakeReport;

/// What a bake of texels found and did.
#[derive(Debug, Clone, Default, PartialEq)]
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
    /// Texels that lie inside of solids: those that are not [valid](crate::VertexStats::is_valid).
    pub texels_invalid: usize,
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
    /// Rays traced from texels, for shadows and for interreflection.
    pub rays_traced: u64,
    /// Share of the rays towards the light that met something.
    pub occluded_share: f64,
    /// Estimated relative root-mean-square error of the shadowed transfer vectors; see [`Metadata::error`](crate::Metadata::error).
    pub error: Option<f64>,
    /// Time to lay out the faces and build the tree and the set of directions.
    pub build: Duration,
    /// Time to trace and sum, the vertices aside.
    pub trace: Duration,
    /// Threads used.
    pub threads: usize,
    /// The bake of the vertices that light is reflected from, if there are bounces.
    pub vertices: Option<BakeReport>,
}
