//! How far a bake is.

use std::collections::BTreeMap;
use std::path::Path;

use super::Part;
use super::blocks::Blocks;
use super::header::Header;
use super::journal::Journal;
use crate::Error;

/// What a journal, or the file of a part, says of its bake.
#[derive(Debug, Clone, PartialEq)]
pub struct JournalInfo {
    /// Which share of the vertices, or of the texels, it is for.
    pub part: Part,
    /// Whether texels are baked in place of vertices.
    pub bakes_texels: bool,
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
    let shared = header.blocks();
    let own =
        [shared.vertex_count_of(&part.blocks(shared.count())), done(&journal, shared, header.shared_pass(), part)];
    let (vertices, texels) = match header.texels {
        None => (own, [0; 2]),
        Some(_) => {
            let all = |blocks: Blocks| [blocks.vertex_count(), done(&journal, blocks, 0, Part::whole())];
            (header.gathered_blocks().map(all).unwrap_or_default(), own)
        }
    };
    Ok(JournalInfo {
        part,
        bakes_texels: header.texels.is_some(),
        vertices: vertices[0],
        vertices_done: vertices[1],
        texels: texels[0],
        texels_done: texels[1],
        is_complete: header.is_complete_in(&journal),
        settings: header.settings_by_name(),
        bytes: std::fs::metadata(path)
            .map_err(|cause| Error::Io { action: "read", path: path.to_owned(), cause })?
            .len(),
    })
}

/// How many vertices, or texels, of a part are done. Goes through what is there, not through what is claimed.
fn done(journal: &Journal, blocks: Blocks, pass: usize, part: Part) -> usize {
    let own = part.blocks(blocks.count());
    journal.blocks_of(pass).filter(|block| own.contains(block)).map(|block| blocks.vertices(block).len()).sum()
}
