//! Where results are written: checked before the work, so that an hour of baking does not end at a misspelt folder.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};

/// Fails if a file could not be written under this name, or is not likely to be.
pub(crate) fn check(path: &Path) -> anyhow::Result<()> {
    let cannot = || format!("cannot write {}", path.display());
    match fs::metadata(path) {
        Ok(metadata) if metadata.is_dir() => bail!("{}: it is a folder", cannot()),
        // A device or a pipe: written to directly.
        Ok(metadata) if !metadata.is_file() => Ok(()),
        Ok(_) => check_folder(&fs::canonicalize(path).with_context(cannot)?).with_context(cannot),
        Err(_) => check_folder(path).with_context(cannot),
    }
}

/// Fails if writing the output would destroy the input.
pub(crate) fn check_differs(output: &Path, input: &Path) -> anyhow::Result<()> {
    let is_same =
        fs::canonicalize(output).is_ok_and(|output| fs::canonicalize(input).is_ok_and(|input| input == output));
    anyhow::ensure!(!is_same, "cannot write {}: it is the file to read", output.display());
    Ok(())
}

/// A file appears in its folder under another name first.
fn check_folder(path: &Path) -> anyhow::Result<()> {
    let folder = folder_of(path);
    if !folder.is_dir() {
        bail!("there is no folder {}", folder.display());
    }
    tempfile::tempfile_in(&folder).with_context(|| format!("the folder {} cannot be written to", folder.display()))?;
    Ok(())
}

/// The folder that a file lies in, `.` for a bare name.
pub(crate) fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;

    #[test]
    fn what_cannot_be_written_is_known_before() {
        let folder = tempfile::tempdir().unwrap();
        assert!(check(&folder.path().join("a.prt")).is_ok());
        let into_folder = format!("{:#}", check(folder.path()).unwrap_err());
        assert!(into_folder.contains("it is a folder"), "{into_folder}");
        let missing = format!("{:#}", check(&folder.path().join("no/a.prt")).unwrap_err());
        assert!(missing.contains("cannot write") && missing.contains("there is no folder"), "{missing}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "the check leaves nothing");
    }

    #[test]
    fn an_existing_file_stays_as_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.prt");
        fs::write(&path, "old").unwrap();
        assert!(check(&path).is_ok());
        assert_eq!(fs::read(&path).unwrap(), b"old");
    }
}
