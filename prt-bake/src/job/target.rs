//! Baking into a file, so that nothing is lost when the bake stops half-way.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use super::header::{DONE, Header, SURFACE};
use super::journal::Journal;
use super::stages::{Baked, Job};
use crate::atomic::{remove_leftovers, sync_folder};
use crate::image::is_whole_exr;
use crate::{BakeReport, Error, Metadata, Part, Source, file_info};

/// What is done with the journal of a bake that did not come to its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Unfinished {
    /// Nothing is baked, and an error says that it is there.
    #[default]
    Refuse,
    /// The bake goes on where the other one stopped, if mesh and options are the same. Without a journal it begins.
    Resume,
    /// The bake begins anew.
    Discard,
}

/// Where a bake goes.
#[derive(Debug, Clone)]
pub struct BakeTarget {
    /// The baked file, or the file of a part. Until it is complete what is done is in a journal beside it, `PATH.journal`.
    pub path: PathBuf,
    /// Which share of the vertices, or of the texels, is baked, into the file of a part; `None` for the whole.
    pub part: Option<Part>,
    /// What is done if there is a journal already.
    pub unfinished: Unfinished,
    /// Bake nothing if the file is there and was made from the same mesh with the same options.
    pub update: bool,
    /// What is written into the file about its origin.
    pub source: Option<Source>,
}

impl BakeTarget {
    /// The whole bake into `path`; refuses to overwrite an unfinished one.
    #[must_use]
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self { path: path.into(), part: None, unfinished: Unfinished::Refuse, update: false, source: None }
    }

    /// The share that is traced.
    pub(super) fn share(&self) -> Part {
        self.part.unwrap_or_else(Part::whole)
    }

    /// Whether a result of the same bake is as good as a new one.
    fn accepts_what_is_there(&self) -> bool {
        self.update || self.unfinished == Unfinished::Resume
    }

    /// Where the work is kept until it is complete.
    #[must_use]
    pub fn journal_path(&self) -> PathBuf {
        journal_path(&self.path)
    }
}

/// What came of a bake into a file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FileReport {
    /// What the bake did; of a part, for its own vertices or texels.
    pub bake: BakeReport,
    /// How the transfer was made; `None` for a part.
    pub metadata: Option<Metadata>,
    /// Channels of the transfer; `None` for a part.
    pub channels: Option<usize>,
    /// Size of the file.
    pub bytes: u64,
    /// Whether the file was there already, and nothing was baked.
    pub was_up_to_date: bool,
}

/// Makes the file of a bake: what is there already, or goes on with a journal, or begins one.
pub(super) fn into_file<J: Job>(mut job: J, target: &BakeTarget) -> Result<FileReport, Error> {
    let header = job.header().clone();
    let is_traced = header.is_traced();
    if let Some(part) = target.part.filter(|_| !is_traced) {
        return Err(Error::Option(format!("part {part} of transfer without shadows: no ray is traced for it")));
    }
    let is_device = is_device(&target.path);
    if is_device && (target.part.is_some() || header.texels.is_some()) {
        let cause = std::io::Error::other("parts and images need a regular file");
        return Err(Error::Io { action: "write", path: target.path.clone(), cause });
    }
    if target.accepts_what_is_there() && is_done(target, &header) {
        return up_to_date(target, &header);
    }
    if !is_traced || is_device {
        // There is nothing to lose, or no place beside it.
        let journal = Journal::in_memory();
        job.trace(&journal)?;
        let (baked, report) = job.finish(&journal, target.source.as_ref())?;
        return write(&baked, &target.path, report);
    }
    check_overwritten(target, &header)?;
    let journal = open_journal(target, &header)?;
    if let Err(error) = job.trace(&journal) {
        if !journal.has_blocks() {
            remove(&target.journal_path())?;
        }
        return Err(error);
    }
    if target.part.is_some() {
        let surface = job.surface(target.source.as_ref())?;
        return close_part(&surface, target, journal, job.into_report());
    }
    let (baked, report) = job.finish(&journal, target.source.as_ref())?;
    write_result(&baked, &target.path, &journal, report)
}

/// Writes the baked file, and then removes the journal: while it is locked, so that nobody takes it for his own.
pub(super) fn write_result(
    baked: &impl Baked,
    path: &Path,
    _locked: &Journal,
    report: BakeReport,
) -> Result<FileReport, Error> {
    remove_leftovers(path);
    let report = write(baked, path, report)?;
    remove(&journal_path(path))?;
    Ok(report)
}

fn write(baked: &impl Baked, path: &Path, bake: BakeReport) -> Result<FileReport, Error> {
    let bytes = baked.write_to(path)?;
    let channels = Some(baked.transfer().channels);
    Ok(FileReport { bake, metadata: Some(baked.metadata().clone()), channels, bytes, was_up_to_date: false })
}

/// A device or a pipe has no place beside it.
fn is_device(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|metadata| !metadata.is_file() && !metadata.is_dir())
}

/// `PATH.journal`.
pub(super) fn journal_path(path: &Path) -> PathBuf {
    let mut name = OsString::from(path);
    name.push(".journal");
    name.into()
}

/// Whether the file is the result of this very bake.
fn is_done(target: &BakeTarget, header: &Header) -> bool {
    let path = &target.path;
    if target.part.is_some() {
        return Journal::open(path).is_ok_and(|journal| {
            header.is_complete_in(&journal) && Header::read(&journal).is_ok_and(|found| found.as_ref() == Some(header))
        });
    }
    let is_same = file_info(path).is_ok_and(|info| info.metadata.get("identity") == Some(&header.identity()));
    // The head of an image says nothing of what follows.
    is_same && (header.texels.is_none() || is_whole_exr(path))
}

/// Says so, and removes a journal of the same bake, which a power failure may have left.
fn up_to_date(target: &BakeTarget, header: &Header) -> Result<FileReport, Error> {
    let path = target.journal_path();
    let is_left_over = |journal: &Journal| Header::read(journal).is_ok_and(|found| found.as_ref() == Some(header));
    if path.exists() && Journal::resume(&path).is_ok_and(|journal| is_left_over(&journal)) {
        remove(&path)?;
    }
    let fail = |cause| Error::Io { action: "read", path: target.path.clone(), cause };
    let bytes = std::fs::metadata(&target.path).map_err(fail)?.len();
    Ok(FileReport { bytes, was_up_to_date: true, ..FileReport::default() })
}

/// A part takes the place of nothing but itself: not of another part, and not of a baked file.
fn check_overwritten(target: &BakeTarget, header: &Header) -> Result<(), Error> {
    let Some(part) = target.part.filter(|_| target.path.exists()) else { return Ok(()) };
    let path = target.path.display();
    let there = Journal::open(&target.path).ok().and_then(|journal| Header::read(&journal).ok().flatten());
    let Some(there) = there else {
        return Err(Error::Parts(format!("{path} is no part; part {part} would take its place")));
    };
    if there.texels.is_some() != header.texels.is_some() {
        return check_same(&there, header, &target.path);
    }
    match there.part()? {
        found if found == part => Ok(()),
        found => Err(Error::Parts(format!("part {found} is in {path}, where part {part} was to go"))),
    }
}

/// A journal with the header of this bake: a new one, or one to go on with.
fn open_journal(target: &BakeTarget, header: &Header) -> Result<Journal, Error> {
    let path = target.journal_path();
    if path.exists() && target.unfinished == Unfinished::Refuse {
        return Err(Error::Unfinished { path });
    }
    if path.exists() && target.unfinished == Unfinished::Resume {
        let journal = Journal::resume(&path)?;
        match Header::read(&journal)? {
            Some(found) => check_same(&found, header, &path)?,
            None => header.append_to(&journal)?,
        }
        return Ok(journal);
    }
    let journal = Journal::create(&path)?;
    header.append_to(&journal)?;
    Ok(journal)
}

fn check_same(found: &Header, header: &Header, path: &Path) -> Result<(), Error> {
    match header.difference(found) {
        Some(difference) => Err(Error::OtherBake { path: path.to_owned(), difference }),
        None => Ok(()),
    }
}

/// Adds the surface to the journal of a part, and gives it the name of the part.
fn close_part(surface: &[u8], target: &BakeTarget, journal: Journal, report: BakeReport) -> Result<FileReport, Error> {
    journal.append(SURFACE, surface)?;
    journal.append(DONE, &[])?;
    journal.sync()?;
    let fail = |cause| Error::Io { action: "write", path: target.path.clone(), cause };
    // While it is locked, so that nobody takes it for his own.
    std::fs::rename(target.journal_path(), &target.path).map_err(fail)?;
    sync_folder(&target.path);
    drop(journal);
    let bytes = std::fs::metadata(&target.path).map_err(fail)?.len();
    Ok(FileReport { bake: report, bytes, ..FileReport::default() })
}

pub(super) fn remove(path: &Path) -> Result<(), Error> {
    std::fs::remove_file(path).map_err(|cause| Error::Io { action: "remove", path: path.to_owned(), cause })
}
