//! Putting together what was baked in parts.

use std::path::{Path, PathBuf};

use super::header::{DONE, Header, SURFACE};
use super::journal::Journal;
use super::target::{FileReport, journal_path, write_result};
use super::{Part, count, finished};
use crate::parallel::Threads;
use crate::{BakeReport, BakedSurface, Error, Progress};

/// Puts the parts of a bake together, in any order, and follows the bounces if any were asked for. The file has the same bytes as one
/// baked in one go. The scene itself is not needed.
///
/// # Errors
/// If a file cannot be read or is not a complete part, parts are of different bakes, or one is missing or there twice.
pub fn merge_parts(
    parts: &[PathBuf],
    path: &Path,
    threads: Option<usize>,
    progress: &dyn Progress,
) -> Result<FileReport, Error> {
    let parts = parts.iter().map(|path| PartFile::open(path)).collect::<Result<Vec<_>, Error>>()?;
    check_complete(&parts)?;
    let first = parts.first().ok_or_else(|| Error::Option("no parts to merge".to_owned()))?;
    let (surface, header) = (first.surface()?, first.header.whole());
    let options = header.settings.options(threads)?;
    let journal = new_journal(&journal_path(path), &header)?;
    parts.iter().try_for_each(|part| part.copy_to(&journal, progress))?;
    let threads = Threads::new(options.threads)?;
    let mut report = BakeReport { threads: threads.count(), ..BakeReport::default() };
    let blocks = header.blocks();
    count(&mut report, &options, journal.all_stats(blocks, 0..blocks.count())?);
    let mut baked = finished(surface.geometry, &header, &options, &journal, &threads, progress, &mut report)?;
    baked.metadata.source = surface.metadata.source;
    write_result(&baked, path, journal, report)
}

/// A journal for the whole, in place of one of the same bake: the parts have all that is in that one.
fn new_journal(path: &Path, header: &Header) -> Result<Journal, Error> {
    if path.exists() && Header::read(&Journal::resume(path)?)?.is_some_and(|found| found != *header) {
        return Err(Error::Unfinished { path: path.to_owned() });
    }
    let journal = Journal::create(path)?;
    header.append_to(&journal)?;
    Ok(journal)
}

/// The file of a part that is done.
struct PartFile {
    path: PathBuf,
    journal: Journal,
    header: Header,
    part: Part,
}

impl PartFile {
    fn open(path: &Path) -> Result<Self, Error> {
        let journal = Journal::open(path)?;
        let header = Header::read(&journal)?;
        let header = header.ok_or_else(|| journal.malformed("its first record is damaged".to_owned()))?;
        if !header.is_complete_in(&journal) {
            let is_done = journal.contains(DONE);
            let reason = if is_done { "blocks are damaged" } else { "the bake of this part did not come to its end" };
            return Err(journal.malformed(reason.to_owned()));
        }
        let part = header.part()?;
        Ok(Self { path: path.to_owned(), journal, header, part })
    }

    fn surface(&self) -> Result<BakedSurface, Error> {
        let mut bytes = Vec::new();
        self.journal.read(SURFACE, &mut bytes)?;
        let surface = BakedSurface::from_bytes(&bytes, &self.path)?;
        match surface.geometry.vertex_count() {
            count if count == self.header.vertex_count => Ok(surface),
            count => Err(self.journal.malformed(format!("{count} vertices for {}", self.header.vertex_count))),
        }
    }

    /// Copies what was traced.
    fn copy_to(&self, journal: &Journal, progress: &dyn Progress) -> Result<(), Error> {
        let mut payload = Vec::new();
        for key in self.journal.keys().into_iter().filter(|key| key.is_of_block()) {
            if progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            self.journal.read(key, &mut payload)?;
            journal.append(key, &payload)?;
        }
        Ok(())
    }
}

/// Checks that the parts are of one bake, and that each is there once.
fn check_complete(parts: &[PartFile]) -> Result<(), Error> {
    let Some(first) = parts.first() else { return Ok(()) };
    let mut paths = vec![None; first.part.count() as usize];
    for part in parts {
        if let Some(difference) = first.header.whole().difference(&part.header.whole()) {
            return Err(Error::OtherBake { path: part.path.clone(), difference });
        }
        if part.part.count() != first.part.count() {
            let difference = format!("it is part {}, beside part {}", part.part, first.part);
            return Err(Error::OtherBake { path: part.path.clone(), difference });
        }
        if let Some(other) = paths[part.part.number() as usize - 1].replace(&part.path) {
            let both = format!("{} and {} are both part {}", other.display(), part.path.display(), part.part);
            return Err(Error::Parts(both));
        }
    }
    let missing: Vec<String> =
        (1_usize..).zip(&paths).filter(|(_, path)| path.is_none()).map(|(number, _)| number.to_string()).collect();
    match missing.len() {
        0 => Ok(()),
        _ => Err(Error::Parts(format!("of {} parts, these are missing: {}", paths.len(), missing.join(", ")))),
    }
}
