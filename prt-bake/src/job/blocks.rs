//! The vertices of a bake, in the blocks that are handed out, written and read together.

use std::ops::Range;

/// Vertices in a block: enough to share what a block costs, few enough that a killed bake loses little.
const SIZE: usize = 16;

/// A number of vertices, cut into blocks.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Blocks {
    vertex_count: usize,
}

impl Blocks {
    pub(crate) fn of(vertex_count: usize) -> Self {
        Self { vertex_count }
    }

    /// Number of blocks.
    pub(crate) fn count(self) -> u32 {
        u32::try_from(self.vertex_count.div_ceil(SIZE)).expect("a mesh has less than 2^32 vertices")
    }

    /// The vertices of a block.
    pub(crate) fn vertices(self, block: u32) -> Range<usize> {
        let first = block as usize * SIZE;
        first..(first + SIZE).min(self.vertex_count)
    }
}
