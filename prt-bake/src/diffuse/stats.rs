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
    /// A vertex is invalid if a smaller share of its directions ends in the open or on the front of a face.
    ///
    /// Vertices inside of closed solids have a validity of 0 to 0.1, those outside one above 0.9. Of the 2,442 vertices of `dragon_100k` that are
    /// more than 90 % occluded 1,838 lie below 0.2 and 11 between 0.3 and 0.7; of 3,792 of `dragon_res3_nonmanifold` 3,514 and 7; of 416 of
    /// `nefertiti` and `utah_teapot` 392 and none. So the threshold matters little; a low one spares what is dark but can be seen, as below
    /// a cloth of one-sided faces.
    pub const VALID: f32 = 0.25;

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
