//! Real models and environments, which stand outside the project.

use std::path::{Path, PathBuf};

/// A file of the test data: in `$PRT_DATA`, else in `../shared/data` beside the workspace. If it is not there, says that the test
/// named `test` is skipped, and returns `None`.
#[must_use]
pub fn data_path(test: &str, file: &str) -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    let folder = std::env::var_os("PRT_DATA").map_or_else(beside, PathBuf::from);
    let path = folder.join(file);
    if path.exists() {
        return Some(path);
    }
    announce(&format!("skipped: {test} needs {}", path.display()));
    None
}

#[expect(clippy::print_stderr, reason = "a test that is skipped says so")]
fn announce(message: &str) {
    eprintln!("{message}");
}
