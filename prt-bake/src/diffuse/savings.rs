//! What stopping early saved.

use super::VertexStats;
use super::ladder::set_sizes;
use crate::BakeOptions;

/// Rays that were not traced because the vertex did not need them. All counts are of directions above the horizon.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Savings {
    /// Directions that [`rays_per_vertex`](crate::BakeOptions::rays_per_vertex) for every vertex would have been.
    pub fixed_directions: u64,
    /// Directions of the finest set that each vertex was given.
    pub directions: u64,
    /// Rays that were traced one by one, from all sets and for reflected light. What else was needed was proven for whole bins of directions, or
    /// known from neighbouring ones.
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
    /// Directions over the hemisphere of the finest set that such a vertex was given.
    pub directions: u32,
    /// How many vertices.
    pub vertices: usize,
}

impl Savings {
    pub(crate) fn of(options: &BakeOptions, vertices: &[VertexStats]) -> Self {
        let sum = |count: fn(&VertexStats) -> u32| vertices.iter().map(|stats| u64::from(count(stats))).sum();
        let count = |is: &dyn Fn(&VertexStats) -> bool| vertices.iter().filter(|stats| is(stats)).count();
        let target = options.target_error.unwrap_or(f64::INFINITY);
        Self {
            fixed_directions: options.rays_per_vertex as u64 * vertices.len() as u64,
            directions: sum(|stats| stats.directions),
            rays: sum(|stats| stats.rays),
            open_vertices: count(&|stats| stats.occluded == 0),
            blocked_vertices: count(&|stats| stats.occluded == stats.directions && stats.directions > 0),
            unconverged_vertices: count(&|stats| f64::from(stats.error) > target),
            levels: levels(options, vertices),
        }
    }
}

/// Half of the directions of a set are above the horizon of a vertex, give or take a few: so their number tells which set it was.
fn levels(options: &BakeOptions, vertices: &[VertexStats]) -> Vec<LevelCount> {
    let halves = set_sizes(options).into_iter().map(|size| (size / 2) as u32);
    let mut levels: Vec<LevelCount> = halves.map(|directions| LevelCount { directions, vertices: 0 }).collect();
    levels.dedup_by_key(|level| level.directions);
    for stats in vertices {
        let nearest = levels.iter_mut().min_by_key(|level| level.directions.abs_diff(stats.directions));
        nearest.into_iter().for_each(|level| level.vertices += 1);
    }
    levels
}
