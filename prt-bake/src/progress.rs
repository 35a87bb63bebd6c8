//! Telling a caller how far a bake is, and hearing that it should stop.

/// One sweep over all vertices, or texels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pass {
    /// Rays towards the light, from vertices.
    Direct,
    /// Light that arrives after this many reflections, from 1.
    Bounce(usize),
    /// Rays from the texels of an atlas or of a height field.
    Texels,
}

/// Hears how a bake goes on, from any of its threads.
pub trait Progress: Sync {
    /// A pass over `count` vertices or texels begins.
    fn start(&self, _pass: Pass, _count: usize) {}

    /// So many more are done; `rays` were traced for them.
    fn advance(&self, _count: usize, _rays: u64) {}

    /// Whether to stop; asked several times a second.
    fn is_cancelled(&self) -> bool {
        false
    }
}

/// Nobody listens, nobody stops the bake.
impl Progress for () {}
