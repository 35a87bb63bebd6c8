//! What is found wrong with a file before its name is known.

use std::fs;
use std::io;
use std::path::Path;

use crate::Error;

/// What a parser finds wrong; it knows no file name, which [`Fault::in_file`] adds.
#[derive(Debug)]
pub(super) enum Fault {
    /// The data break the rules of the format. The text is the reason.
    Malformed(String),
    /// The data are in order but not handled here. The text stands before "not supported": `a node with shear is`.
    Unsupported(String),
    /// The fault lies with another file, which the error names already.
    Elsewhere(Error),
}

impl Fault {
    /// Data that break the rules of their format.
    pub(super) fn malformed(reason: impl Into<String>) -> Self {
        Self::Malformed(reason.into())
    }

    /// Data that are not handled here; see [`Fault::Unsupported`] for the wording.
    pub(super) fn unsupported(what: impl Into<String>) -> Self {
        Self::Unsupported(what.into())
    }

    /// Parts that were read, but do not fit together.
    pub(super) fn inconsistent(error: &Error) -> Self {
        Self::Malformed(error.to_string())
    }

    /// The error a caller sees: the fault with the file's name.
    pub(super) fn in_file(self, path: &Path) -> Error {
        match self {
            Self::Malformed(reason) => Error::Malformed { path: path.to_owned(), reason },
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

/// All bytes of a regular file; a folder, a pipe or a device is named as such.
pub(super) fn read_file(path: &Path) -> Result<Vec<u8>, Error> {
    let fail = |cause| Error::Io { path: path.to_owned(), cause };
    let metadata = fs::metadata(path).map_err(fail)?;
    if metadata.is_dir() {
        return Err(fail(io::ErrorKind::IsADirectory.into()));
    }
    if !metadata.is_file() {
        return Err(fail(io::Error::other("not a regular file")));
    }
    fs::read(path).map_err(fail)
}
