//! Putting together what was baked in parts.

use std::path::{Path, PathBuf};

use super::Part;
use super::header::{DONE, Header, SURFACE};
use super::journal::Journal;
use super::stages::Baked;
use super::target::{FileReport, journal_path, remove, write_result};
use super::texels::assembled;
use super::vertices::finished;
use crate::parallel::Threads;
use crate::texels::AtlasPlan;
use crate::{BakeOptions, BakeReport, BakedSurface, Error, Metadata, Progress};

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
    let header = first.header.whole();
    let surface = first.surface()?;
    let options = header.settings.options(threads)?;
    let threads = Threads::new(options.threads)?;
    let journal_path = journal_path(path);
    let journal = new_journal(&journal_path, &header)?;
    let merge = Merge { parts: &parts, header: &header, options: &options, journal: &journal, threads: &threads };
    let merged = merge.run(surface, path, progress);
    if merged.is_err() {
        // The parts have all that is in it.
        remove(&journal_path)?;
    }
    merged
}

/// Parts, and a journal that they come together in.
struct Merge<'a> {
    parts: &'a [PartFile],
    header: &'a Header,
    options: &'a BakeOptions,
    journal: &'a Journal,
    threads: &'a Threads,
}

impl Merge<'_> {
    fn run(&self, surface: Surface, path: &Path, progress: &dyn Progress) -> Result<FileReport, Error> {
        let Self { parts, header, options, journal, threads } = *self;
        parts.iter().try_for_each(|part| part.copy_to(journal, progress))?;
        let mut report = BakeReport { threads: threads.count(), ..BakeReport::default() };
        let blocks = header.blocks();
        report.count(options, journal.all_stats(header.shared_pass(), blocks, 0..blocks.count())?);
        match surface {
            Surface::Mesh(BakedSurface { geometry, metadata: Metadata { source, .. }, .. }) => {
                let mut baked = finished(geometry, header, options, journal, threads, progress, &mut report)?;
                baked.complete(header, source.as_ref());
                write_result(&baked, path, journal, report)
            }
            Surface::Atlas(plan) => {
                let source = plan.head.source.clone();
                let (mut atlas, found) = assembled(plan, header, options, journal, &report)?;
                atlas.complete(header, source.as_ref());
                write_result(&atlas, path, journal, BakeReport { texels: Some(found), ..report })
            }
        }
    }
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

/// What a part keeps of the scene.
enum Surface {
    Mesh(BakedSurface),
    Atlas(AtlasPlan),
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
        let header = header.ok_or_else(|| journal.malformed("it was stopped before it was begun".to_owned()))?;
        if !header.is_complete_in(&journal) {
            let is_done = journal.contains(DONE);
            let reason = if is_done { "blocks are damaged" } else { "the bake of this part did not come to its end" };
            return Err(journal.malformed(reason.to_owned()));
        }
        let part = header.part()?;
        Ok(Self { path: path.to_owned(), journal, header, part })
    }

    fn surface(&self) -> Result<Surface, Error> {
        let mut bytes = Vec::new();
        self.journal.read(SURFACE, &mut bytes)?;
        let (surface, count) = if let Some(texels) = self.header.texel_options() {
            let plan = AtlasPlan::from_bytes(&bytes).map_err(|reason| self.journal.malformed(reason))?;
            if !plan.is_of(&texels) {
                return Err(self.journal.malformed("its atlas is of another size".to_owned()));
            }
            let options = self.header.settings.options(None)?;
            texels.validate(options.order, self.header.channels)?;
            if plan.head.bounces > options.bounces {
                return Err(self.journal.malformed(format!("it claims {} bounces", plan.head.bounces)));
            }
            let count = plan.baked().count();
            (Surface::Atlas(plan), count)
        } else {
            let surface = BakedSurface::from_bytes(&bytes, &self.path)?;
            let count = surface.geometry.vertex_count();
            (Surface::Mesh(surface), count)
        };
        match self.header.shared_count() {
            expected if expected == count => Ok(surface),
            expected => Err(self.journal.malformed(format!("{count} vertices or texels for {expected}"))),
        }
    }

    /// Copies what was traced for this part; the vertices that texels gather from are in every part, and are not needed any more.
    fn copy_to(&self, journal: &Journal, progress: &dyn Progress) -> Result<(), Error> {
        let mut payload = Vec::new();
        for key in self.journal.keys().into_iter().filter(|key| self.header.shares(*key)) {
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
