//! How far a bake is.

use std::collections::BTreeMap;
use std::path::Path;

use super::Part;
use super::blocks::Blocks;
use super::header::{DONE, Header};
use super::journal::Journal;
use crate::Error;

/// What a journal, or the file of a part, says of its bake.
#[derive(Debug, Clone, PartialEq)]
pub struct JournalInfo {
    /// Which share of the vertices it is for.
    pub part: Part,
    /// Vertices of this part; of a bake of texels those whose light they gather, none if there are no bounces.
    pub vertices: usize,
    /// Those from which all rays are traced.
    pub vertices_done: usize,
    /// Texels of this part, if texels are baked.
    pub texels: usize,
    /// Those that are done.
    pub texels_done: usize,
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
    // All, and those that are done.
    let count = |blocks: Blocks, part: Part, pass: usize| {
        let sizes = part.blocks(blocks.count()).map(|block| (block, blocks.vertices(block).len()));
        sizes.fold([0; 2], |[all, done], (block, size)| {
            [all + size, done + if journal.has_rows(pass, block) { size } else { 0 }]
        })
    };
    let shared = header.blocks();
    let (vertices, texels) = match header.texels {
        None => (count(shared, part, header.shared_pass()), [0; 2]),
        Some(_) => {
            let vertices = header.gathered_blocks().map(|blocks| count(blocks, Part::whole(), 0));
            (vertices.unwrap_or_default(), count(shared, part, header.shared_pass()))
        }
    };
    Ok(JournalInfo {
        part,
        vertices: vertices[0],
        vertices_done: vertices[1],
        texels: texels[0],
        texels_done: texels[1],
        is_complete: journal.contains(DONE),
        settings: header.settings_by_name(),
        bytes: std::fs::metadata(path)
            .map_err(|cause| Error::Io { action: "read", path: path.to_owned(), cause })?
            .len(),
    })
}
