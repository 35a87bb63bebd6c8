//! A bake in blocks of vertices, each written down when it is done: what stops half-way goes on from there, and parts that were baked
//! apart are put together. However a bake was cut up, its result has the same bytes.

mod block;
mod blocks;
mod header;
mod info;
mod journal;
mod merge;
mod part;
mod reflect;
mod stages;
mod target;
mod texels;
mod trace;
mod vertices;

pub(crate) use block::HitLists;
pub(crate) use blocks::Blocks;
pub use info::{JournalInfo, journal_info};
pub(crate) use journal::Journal;
pub use journal::is_journal;
pub use merge::merge_parts;
pub use part::Part;
pub(crate) use reflect::Reflector;
pub use target::{BakeTarget, FileReport, Unfinished};
pub use texels::{bake_texels, bake_texels_to_file};
pub(crate) use vertices::bake_in_memory;
pub use vertices::bake_to_file;

#[cfg(test)]
mod tests;
