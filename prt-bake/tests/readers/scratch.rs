//! Files that exist for the length of a test.

use std::path::{Path, PathBuf};

use prt_bake::{Error, Image, MeshSource, load_mesh};

/// A folder that is removed with its files.
pub(crate) struct Scratch(tempfile::TempDir);

impl Scratch {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(crate) fn path(&self) -> &Path {
        self.0.path()
    }

    pub(crate) fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }
}

thread_local! {
    /// One folder for each test's thread: making one takes longer than reading a small file.
    static SHARED: Scratch = Scratch::new();
}

/// Loads a mesh from bytes under the name `test.EXTENSION`.
pub(crate) fn mesh(extension: &str, bytes: impl AsRef<[u8]>) -> Result<MeshSource, Error> {
    SHARED.with(|scratch| load_mesh(&scratch.write(&format!("test.{extension}"), bytes)))
}

/// Loads an image likewise.
pub(crate) fn image(extension: &str, bytes: impl AsRef<[u8]>) -> Result<Image, Error> {
    SHARED.with(|scratch| Image::load(&scratch.write(&format!("test.{extension}"), bytes)))
}

/// Asserts that the result is an error that names the file and has the given words, and that nothing huge was allocated.
#[track_caller]
pub(crate) fn assert_refused<T>(result: Result<T, Error>, words: &str) {
    let Err(error) = result else { panic!("accepted, where `{words}` was expected") };
    let message = error.to_string();
    assert!(message.contains("test."), "the file is not named: {message}");
    assert!(message.contains(words), "expected `{words}` in: {message}");
    assert!(!message.ends_with('.') && !message.contains('\n'), "{message}");
    assert_no_giant_allocation();
}

/// Asserts that this process never held 8 GiB of address space: the lies told to the readers would take 24 GB and more.
#[track_caller]
pub(crate) fn assert_no_giant_allocation() {
    let Ok(status) = std::fs::read_to_string("/proc/self/status") else { return };
    let peak = status.lines().find_map(|line| line.strip_prefix("VmPeak:")).unwrap();
    let kibibytes: u64 = peak.trim().trim_end_matches(" kB").parse().unwrap();
    assert!(kibibytes < 8 << 20, "peak address space {kibibytes} KiB");
}

/// The sRGB curve, from display value to linear.
pub(crate) fn srgb(value: f64) -> f32 {
    (if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }) as f32
}

#[track_caller]
pub(crate) fn assert_near(a: &[f32], b: &[f32], tolerance: f32) {
    assert_eq!(a.len(), b.len());
    let near = a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance);
    assert!(near, "{a:?} is not within {tolerance} of {b:?}");
}
