//! Files from outside: their bytes, and what is found wrong with them.

use std::fs;
use std::io;
use std::path::Path;

use crate::Error;

/// What a parser finds wrong; it knows no file name, which [`Fault::in_file`] adds.
#[derive(Debug)]
pub(crate) enum Fault {
    /// The data break the rules of the format. The text is the reason.
    Malformed(String),
    /// The data are in order but not handled here. The text stands before "not supported": `DWAB compression is`.
    Unsupported(String),
    /// The fault lies with another file, which the error names already.
    Elsewhere(Error),
}

impl Fault {
    /// Data that break the rules of their format.
    pub(crate) fn malformed(reason: impl Into<String>) -> Self {
        Self::Malformed(reason.into())
    }

    /// Data that are not handled here; see [`Fault::Unsupported`] for the wording.
    pub(crate) fn unsupported(what: impl Into<String>) -> Self {
        Self::Unsupported(what.into())
    }

    /// The error a caller sees: the fault with the file's name.
    pub(crate) fn in_file(self, path: &Path, format: &'static str) -> Error {
        match self {
            Self::Malformed(reason) => Error::Malformed { path: path.to_owned(), format, reason },
            Self::Unsupported(what) => Error::Unsupported { path: path.to_owned(), what },
            Self::Elsewhere(error) => error,
        }
    }
}

impl From<Error> for Fault {
    fn from(error: Error) -> Self {
        Self::Elsewhere(error)
    }
}

/// Refuses what is not there and what is no regular file, so that a folder, a pipe or a device is named as such.
pub(crate) fn check_is_file(path: &Path) -> Result<(), Error> {
    let metadata = fs::metadata(path).map_err(|source| cannot_read(path, source))?;
    if metadata.is_dir() {
        return Err(cannot_read(path, io::ErrorKind::IsADirectory.into()));
    }
    if !metadata.is_file() {
        return Err(cannot_read(path, io::Error::other("not a regular file")));
    }
    Ok(())
}

/// All bytes of a regular file.
pub(crate) fn read_file(path: &Path) -> Result<Vec<u8>, Error> {
    check_is_file(path)?;
    fs::read(path).map_err(|source| cannot_read(path, source))
}

/// The extension in lower case, empty where there is none.
pub(crate) fn extension(path: &Path) -> String {
    path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

fn cannot_read(path: &Path, cause: io::Error) -> Error {
    Error::Io { action: "read", path: path.to_owned(), cause }
}
