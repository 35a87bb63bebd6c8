//! How far a bake is.

use std::collections::BTreeMap;
use std::path::Path;

use super::Part;
use super::header::{DONE, Header};
use super::journal::{Journal, Key};
use crate::Error;

/// What a journal, or the file of a part, says of its bake.
#[derive(Debug, Clone, PartialEq)]
pub struct JournalInfo {
    /// Which share of the vertices it is for.
    pub part: Part,
    /// Vertices of this part.
    pub vertices: usize,
    /// Those from which all rays are traced.
    pub vertices_done: usize,
    /// Whether it is the file of a part that is ready to be merged.
    pub is_complete: bool,
    /// The options of the bake, by name.
    pub settings: BTreeMap<String, String>,
    /// Size of the file.
    pub bytes: u64,
}

/// Tells how far a bake is that is running, was stopped, or was done in parts.
///
/// # Errors
/// If the file cannot be read or is not a journal.
pub fn journal_info(path: &Path) -> Result<JournalInfo, Error> {
    let journal = Journal::inspect(path)?;
    let header = Header::read(&journal)?;
    let header = header.ok_or_else(|| journal.malformed("it was stopped before it was begun".to_owned()))?;
    let part = header.part()?;
    let blocks = header.blocks();
    let vertices = |block: u32| blocks.vertices(block).len();
    let all = part.blocks(blocks.count());
    Ok(JournalInfo {
        part,
        vertices: all.clone().map(vertices).sum(),
        vertices_done: all.filter(|&block| journal.contains(Key { pass: 0, block })).map(vertices).sum(),
        is_complete: journal.contains(DONE),
        settings: header.settings.by_name(),
        bytes: std::fs::metadata(path)
            .map_err(|cause| Error::Io { action: "read", path: path.to_owned(), cause })?
            .len(),
    })
}
