//! Where the two files of a report go.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};

use crate::output_file;

/// The two files of a report.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Paths {
    pub(crate) html: PathBuf,
    pub(crate) json: PathBuf,
}

impl Paths {
    /// The files for a result: beside it as `OUT.report.html` and `OUT.report.json`; in a folder under these names; or those of a page
    /// `FILE.html` and `FILE.json`.
    pub(crate) fn new(output: &Path, given: Option<&Path>) -> Self {
        let html = match given {
            Some(file) if is_page(file) => file.to_owned(),
            Some(folder) => folder.join(name_for(output)),
            None => output.with_file_name(name_for(output)),
        };
        Self { json: html.with_extension("json"), html }
    }

    /// Fails if the files could not be written, or would replace the scene or the result.
    pub(crate) fn check(&self, scene: &Path, output: &Path) -> anyhow::Result<()> {
        for path in [&self.html, &self.json] {
            output_file::check(path)?;
            output_file::check_differs(path, scene)?;
            ensure!(path != output, "cannot write {}: it is the baked file", path.display());
        }
        Ok(())
    }
}

/// Parses what stands behind `--report`: a page, or a folder that exists.
pub(crate) fn parse(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    if is_page(&path) || path.is_dir() {
        return Ok(path);
    }
    Err("neither a name that ends in .html nor a folder that exists".to_owned())
}

fn is_page(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("html")) && !path.is_dir()
}

fn name_for(output: &Path) -> PathBuf {
    let mut name = output.file_stem().unwrap_or(output.as_os_str()).to_owned();
    name.push(".report.html");
    PathBuf::from(name)
}

/// Writes a file that appears whole or not at all.
pub(super) fn replace(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    let write = || -> anyhow::Result<()> {
        // A device or a pipe: there is nothing to replace.
        if fs::metadata(path).is_ok_and(|metadata| !metadata.is_file()) {
            return Ok(fs::write(path, bytes)?);
        }
        let mut builder = tempfile::Builder::new();
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        // Through a symbolic link to the file that it names.
        let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let mut file = builder.tempfile_in(output_file::folder_of(&path))?;
        file.write_all(bytes)?;
        file.persist(&path).map_err(|error| error.error)?;
        Ok(())
    };
    write().with_context(|| format!("cannot write {}", path.display()))
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;

    fn pair(html: &str, json: &str) -> Paths {
        Paths { html: html.into(), json: json.into() }
    }

    #[test]
    fn a_report_lies_beside_the_result_unless_told_otherwise() {
        let output = Path::new("out/bunny.v2.prt");
        assert_eq!(Paths::new(output, None), pair("out/bunny.v2.report.html", "out/bunny.v2.report.json"));
        assert_eq!(Paths::new(Path::new("a.prt"), None), pair("a.report.html", "a.report.json"));
        assert_eq!(
            Paths::new(output, Some(Path::new("docs"))),
            pair("docs/bunny.v2.report.html", "docs/bunny.v2.report.json")
        );
        assert_eq!(Paths::new(output, Some(Path::new("x/page.HTML"))), pair("x/page.HTML", "x/page.json"));
    }

    #[test]
    fn names_behind_the_flag_are_pages_or_folders() {
        assert_eq!(parse("a/b.html"), Ok(PathBuf::from("a/b.html")));
        assert!(parse("scene.obj").unwrap_err().contains(".html"));
        let folder = tempfile::tempdir().unwrap();
        assert!(parse(folder.path().to_str().unwrap()).is_ok());
    }

    #[test]
    fn a_file_is_replaced_whole_and_nothing_else_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        replace(&path, b"long old contents").unwrap();
        replace(&path, b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        let error = format!("{:#}", replace(&folder.path().join("no/a.json"), b"").unwrap_err());
        assert!(error.contains("cannot write") && error.contains("a.json"), "{error}");
    }

    #[test]
    fn a_report_replaces_neither_scene_nor_result() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let paths = Paths { html: at("a.html"), json: at("a.json") };
        fs::write(at("a.json"), "a scene of this name").unwrap();
        assert!(paths.check(&at("a.json"), &at("a.prt")).is_err());
        assert!(paths.check(&at("b.obj"), &at("a.html")).is_err());
        assert!(paths.check(&at("b.obj"), &at("a.prt")).is_ok());
    }
}
