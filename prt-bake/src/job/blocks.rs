//! The vertices of a bake, in the blocks that are handed out, written and read together.

use std::ops::Range;

/// Most vertices in a block: enough to share what a block costs, few enough that a killed bake loses little.
const MOST_VERTICES: usize = 16;

/// Most rays of a block of more than one vertex. What they hit takes 16 bytes each, and waits in memory until the block is done: 4 MB.
const MOST_RAYS: usize = 1 << 18;

/// A number of vertices, cut into blocks.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Blocks {
    vertex_count: usize,
    size: usize,
}

impl Blocks {
    pub(crate) fn of(vertex_count: usize, rays_per_vertex: usize) -> Self {
        Self { vertex_count, size: (MOST_RAYS / rays_per_vertex.max(1)).clamp(1, MOST_VERTICES) }
    }

    /// Number of blocks.
    pub(crate) fn count(self) -> u32 {
        u32::try_from(self.vertex_count.div_ceil(self.size)).expect("a mesh has less than 2^32 vertices")
    }

    /// How many vertices some blocks in a row have.
    pub(crate) fn vertex_count_of(self, blocks: &Range<u32>) -> usize {
        if blocks.is_empty() { 0 } else { self.vertices(blocks.end - 1).end - self.vertices(blocks.start).start }
    }

    /// All vertices.
    pub(crate) fn vertex_count(self) -> usize {
        self.vertex_count
    }

    /// The vertices of a block.
    pub(crate) fn vertices(self, block: u32) -> Range<usize> {
        let first = block as usize * self.size;
        first..(first + self.size).min(self.vertex_count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_vertex_is_in_one_block_and_many_rays_make_small_blocks() {
        for (rays, size) in [(1, 16), (16_384, 16), (20_000, 13), (65_536, 4), (1 << 18, 1), (1 << 20, 1)] {
            for vertex_count in [1, 15, 16, 17, 1000] {
                let blocks = Blocks::of(vertex_count, rays);
                let all: Vec<usize> = (0..blocks.count()).flat_map(|block| blocks.vertices(block)).collect();
                assert_eq!(all, (0..vertex_count).collect::<Vec<_>>());
                assert_eq!(blocks.vertex_count_of(&(0..blocks.count())), vertex_count);
                assert_eq!(blocks.vertex_count_of(&(1..blocks.count())), vertex_count - blocks.vertices(0).len());
                assert_eq!(blocks.vertex_count_of(&(1..1)), 0);
                assert_eq!(blocks.vertices(0).len(), size.min(vertex_count), "{rays} rays");
            }
        }
    }
}
