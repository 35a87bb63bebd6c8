//! What the rays of one vertex found.

/// What the rays of one vertex found, and what they cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VertexStats {
    /// Directions of the set above the horizon of the vertex: those whose visibility its transfer is made of.
    pub directions: u32,
    /// How many of the directions meet something.
    pub occluded: u32,
    /// Rays that were traced one by one, towards the light and for reflected light; fewer than `directions` where many were answered
    /// together.
    pub rays: u32,
    /// Estimated error of the shadowed transfer vector, relative to the length of the unshadowed one; NaN where it was not estimated.
    pub error: f32,
    /// Share of the directions that do not end on the back of a face: near 1 outside of all solids, near 0 inside one.
    pub validity: f32,
}

impl Default for VertexStats {
    /// A vertex for which nothing was traced.
    fn default() -> Self {
        Self { directions: 0, occluded: 0, rays: 0, error: f32::NAN, validity: 1.0 }
    }
}

impl VertexStats {
    /// A vertex is valid if at least this share of its directions does not end on the back of a face.
    pub const VALID: f32 = 0.5;

    /// Whether the vertex lies outside of all solids: its [`validity`](Self::validity) is at least [`VertexStats::VALID`].
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.validity >= Self::VALID
    }

    /// Share of the directions above the horizon that meet something, counted without the cosine.
    #[must_use]
    pub fn occluded_share(&self) -> f32 {
        self.occluded as f32 / self.directions.max(1) as f32
    }
}
