//! Writing a file whole or not at all.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::Error;

/// What a file's name ends with while it is not complete.
const SUFFIX: &str = ".part";

/// Writes a file through a temporary one in the same folder, which takes its name only once it is complete.
///
/// A failure in `body`, a full disk or a killed program leaves an older file of that name as it was.
/// The new file gets the permissions that the process's umask leaves (0666 without it). A symbolic link
/// is followed; a device or pipe is written to directly, for there is nothing to replace.
///
/// # Errors
/// [`Error::Io`] naming `path`, whatever went wrong.
pub(crate) fn write_atomically<T>(
    path: &Path,
    body: impl FnOnce(&mut BufWriter<&File>) -> io::Result<T>,
) -> Result<T, Error> {
    write(path, body).map_err(|cause| Error::Io { action: "write", path: path.to_owned(), cause })
}

fn write<T>(path: &Path, body: impl FnOnce(&mut BufWriter<&File>) -> io::Result<T>) -> io::Result<T> {
    match fs::metadata(path) {
        Ok(metadata) if metadata.is_dir() => Err(io::ErrorKind::IsADirectory.into()),
        Ok(metadata) if !metadata.is_file() => fill(&File::options().write(true).open(path)?, body),
        Ok(_) => replace(&fs::canonicalize(path)?, body),
        Err(_) => replace(path, body),
    }
}

fn replace<T>(path: &Path, body: impl FnOnce(&mut BufWriter<&File>) -> io::Result<T>) -> io::Result<T> {
    let temporary = new_temporary(path)?;
    let value = fill(temporary.as_file(), body)?;
    // In this order a power failure leaves the old file or the new one, whole.
    temporary.as_file().sync_all()?;
    temporary.persist(path)?;
    sync_folder(path);
    Ok(value)
}

fn fill<T>(file: &File, body: impl FnOnce(&mut BufWriter<&File>) -> io::Result<T>) -> io::Result<T> {
    let mut writer = BufWriter::new(file);
    let value = body(&mut writer)?;
    writer.flush()?;
    Ok(value)
}

/// A hidden file beside `path`, removed again when dropped.
fn new_temporary(path: &Path) -> io::Result<tempfile::NamedTempFile> {
    let name = path.file_name().ok_or(io::ErrorKind::InvalidInput)?;
    let mut prefix = OsString::from(".");
    prefix.push(name);
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(SUFFIX);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    // The library's own message would show the temporary name.
    builder.tempfile_in(folder_of(path)).map_err(|error| error.kind().into())
}

/// Removes what programs left that were killed while they wrote this file. Only for those who know that nobody is writing it.
#[cfg(feature = "trace")]
pub(crate) fn remove_leftovers(path: &Path) {
    let Some(name) = path.file_name().and_then(|name| name.to_str()) else { return };
    let Ok(entries) = fs::read_dir(folder_of(path)) else { return };
    // As `new_temporary` names them, with six letters of the library's choice.
    let is_left = |found: &str| {
        let letters = found.strip_prefix('.').and_then(|rest| rest.strip_prefix(name)?.strip_suffix(SUFFIX));
        letters.is_some_and(|letters| letters.len() == 6)
    };
    for entry in entries.flatten().filter(|entry| entry.file_name().to_str().is_some_and(is_left)) {
        let _ = fs::remove_file(entry.path());
    }
}

/// Makes sure that the name of a file is on the disk. Where folders cannot be synced there is nothing more to be done.
pub(crate) fn sync_folder(path: &Path) {
    let _ = File::open(folder_of(path)).and_then(|folder| folder.sync_all());
}

/// The folder a path lies in, `.` for a bare name.
fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    }
}
