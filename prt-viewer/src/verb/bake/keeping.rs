//! What is kept of a bake that takes long: resuming it, sharing it out, leaving out what is up to date.

use std::path::{Path, PathBuf};

use anyhow::anyhow;
use prt_bake::{BakeTarget, Error, FileReport, Part, Source, Unfinished};

use crate::output;

#[derive(Debug, clap::Args)]
pub(super) struct Keeping {
    /// Go on with a bake that was stopped or killed; begin it if there is none
    #[arg(long, conflicts_with = "restart")]
    resume: bool,
    /// Throw away what is left of a bake that was stopped or killed
    #[arg(long)]
    restart: bool,
    /// Bake nothing if the output was made from the same mesh with the same options
    #[arg(long)]
    update: bool,
    /// Bake one of K equal parts, to be put together by `prt merge`
    #[arg(long, value_name = "I/K")]
    part: Option<Part>,
    /// Leave the processor to other programs: 0 to 19, as the system's nice does
    #[arg(long, value_name = "LEVEL", default_value = "0", value_parser = clap::value_parser!(u8).range(0..=19))]
    nice: u8,
}

impl Keeping {
    /// Whether any of this was asked for, but for the priority.
    pub(super) fn is_asked_for(&self) -> bool {
        self.resume || self.restart || self.update || self.part.is_some()
    }

    pub(super) fn is_part(&self) -> bool {
        self.part.is_some()
    }

    /// The name of the scene with `.prt`, or with the extension of its kind, or of the part, in the current folder.
    pub(super) fn default_output(&self, scene: &Path, extension: &str) -> PathBuf {
        match self.part {
            Some(part) => {
                super::default_output(scene).with_extension(format!("{}-of-{}.part", part.number(), part.count()))
            }
            None => super::default_output(scene).with_extension(extension),
        }
    }

    pub(super) fn target(&self, path: PathBuf, source: Source) -> BakeTarget {
        let unfinished = match (self.resume, self.restart) {
            (true, _) => Unfinished::Resume,
            (_, true) => Unfinished::Discard,
            _ => Unfinished::Refuse,
        };
        BakeTarget { path, part: self.part, unfinished, update: self.update, source: Some(source) }
    }

    /// Gives way to other programs, if that was asked for.
    pub(super) fn lower_priority(&self) -> anyhow::Result<()> {
        if self.nice == 0 {
            return Ok(());
        }
        #[cfg(unix)]
        {
            use anyhow::Context;
            rustix::process::nice(self.nice.into()).map(drop).context("cannot lower the priority")
        }
        #[cfg(not(unix))]
        Err(output::usage("--nice is not there on this system"))
    }
}

/// Says how to go on, where a journal is left.
pub(super) fn explain(result: Result<FileReport, Error>, target: &BakeTarget) -> anyhow::Result<FileReport> {
    match &result {
        Err(Error::Unfinished { path }) => {
            return Err(anyhow!(
                "{} holds an unfinished bake: --resume goes on with it, --restart throws it away",
                path.display()
            ));
        }
        Err(error) if keeps_journal(error) && target.journal_path().exists() => output::note(format_args!(
            "what is done is kept in {}: --resume goes on from there",
            target.journal_path().display()
        )),
        _ => {}
    }
    Ok(result?)
}

/// Whether a bake that ended like this was at work on its journal.
fn keeps_journal(error: &Error) -> bool {
    match error {
        Error::Cancelled => true,
        Error::Io { cause, .. } => cause.kind() == std::io::ErrorKind::StorageFull,
        _ => false,
    }
}
