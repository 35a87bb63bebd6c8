//! What stopping early saved.

/// Rays that were not traced because the vertex did not need them. All counts are of directions above the horizon.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Savings {
    /// Directions that [`rays_per_vertex`](crate::BakeOptions::rays_per_vertex) for every vertex would have been.
    pub fixed_directions: u64,
    /// Directions whose visibility the transfer is made of.
    pub directions: u64,
    /// Rays of them that were traced one by one, and for reflected light; the others were answered many at a time.
    pub rays: u64,
    /// Vertices from which no direction is occluded: their transfer is the unshadowed one, exact.
    pub open_vertices: usize,
    /// Vertices from which every direction is occluded: their transfer is zero.
    pub blocked_vertices: usize,
    /// Vertices whose estimated error is above [`target_error`](crate::BakeOptions::target_error) with all rays that they may use.
    pub unconverged_vertices: usize,
    /// How many vertices stopped at each count of directions, fewest first.
    pub levels: Vec<LevelCount>,
}

/// Vertices that stopped at the same count of directions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LevelCount {
    /// Directions over the hemisphere, all levels of such a vertex together.
    pub directions: u32,
    /// How many vertices.
    pub vertices: usize,
}
