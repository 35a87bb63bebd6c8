//! Running the built program in a folder of its own.

#![allow(dead_code, reason = "each test file uses a part of it")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

use serde_json::Value;

/// A temporary folder in which the program runs.
pub(crate) struct Place {
    folder: tempfile::TempDir,
}

impl Place {
    pub(crate) fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Names of all files, hidden ones too, sorted.
    pub(crate) fn files(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// The program with nothing of a display and, so that tests are the same everywhere, no GPU driver.
    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_prt"));
        command.current_dir(self.folder.path()).args(arguments).stdin(Stdio::null());
        for variable in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
            command.env_remove(variable);
        }
        command.env("VK_ICD_FILENAMES", "/nonexistent").env("VK_DRIVER_FILES", "/nonexistent");
        command.env("__EGL_VENDOR_LIBRARY_DIRS", "/nonexistent");
        command
    }

    pub(crate) fn run(&self, arguments: &[&str]) -> Run {
        Run::from(self.command(arguments).output().unwrap())
    }

    /// Runs a verb that must succeed with `--json`; its object.
    pub(crate) fn json(&self, arguments: &[&str]) -> Value {
        let run = self.run(&[arguments, &["--json"]].concat());
        assert_eq!(run.status, Some(0), "{arguments:?}: {}", run.stderr);
        let object: Value = serde_json::from_str(&run.stdout).unwrap();
        assert!(object.is_object() && run.stdout.lines().count() == 1, "one object in one line: {}", run.stdout);
        object
    }

    pub(crate) fn spawn(&self, arguments: &[&str]) -> Child {
        self.command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.path(name), content).unwrap();
    }

    /// A sphere of radius 0.5 that hovers over a square plane of side 4: `scene.obj`.
    pub(crate) fn write_scene(&self) {
        self.write("scene.obj", sphere_over_plane());
    }

    /// A scene with texture coordinates: a square with a smaller one over it; each has its half of the atlas, and v runs up.
    pub(crate) fn write_roof(&self) {
        self.write(
            "roof.obj",
            "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv -0.5 0.3 -0.5\nv 0.5 0.3 -0.5\nv 0.5 0.3 0.5\nv -0.5 0.3 0.5\n\
             vt 0 0\nvt 0.5 0\nvt 0.5 1\nvt 0 1\nvt 1 0\nvt 1 1\n\
             f 4/1 3/2 2/3\nf 4/1 2/3 1/4\nf 8/2 7/5 6/6\nf 8/2 6/6 5/3\n",
        );
    }

    /// The scene, baked quickly: `scene.prt`.
    pub(crate) fn bake_scene(&self, more: &[&str]) -> Value {
        self.write_scene();
        self.json(&[&["bake", "scene.obj", "-o", "scene.prt", "--order", "4", "--rays", "128"], more].concat())
    }

    /// Refuses with this exit status and one line that has all the words; leaves no other files than there were.
    pub(crate) fn refuses(&self, arguments: &[&str], status: i32, words: &[&str]) {
        let before = self.files();
        let run = self.run(arguments);
        assert_eq!(run.status, Some(status), "{arguments:?}: {}{}", run.stdout, run.stderr);
        for word in words {
            assert!(run.stderr.contains(word), "{arguments:?} does not say {word}: {}", run.stderr);
        }
        assert!(!run.stderr.contains("panicked"), "{}", run.stderr);
        assert_eq!(run.stdout, "", "nothing on the standard output");
        if status == 1 {
            assert_eq!(run.stderr.lines().count(), 1, "one line: {}", run.stderr);
            assert!(run.stderr.starts_with("prt: error: "), "{}", run.stderr);
            let parts: Vec<&str> = run.stderr.trim_end().split(": ").collect();
            assert!(parts.windows(2).all(|pair| pair[0] != pair[1]), "nothing is said twice: {}", run.stderr);
        }
        assert_eq!(self.files(), before, "{arguments:?} leaves no file");
    }
}

/// What a run of the program left.
#[derive(Debug)]
pub(crate) struct Run {
    pub(crate) status: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        Self { status: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
    }
}

fn sphere_over_plane() -> String {
    let (rows, columns) = (8, 12);
    let mut text = String::new();
    for row in 0..=rows {
        for column in 0..columns {
            let theta = std::f64::consts::PI * f64::from(row) / f64::from(rows);
            let phi = std::f64::consts::TAU * f64::from(column) / f64::from(columns);
            let [x, y, z] = [theta.sin() * phi.sin(), theta.cos(), theta.sin() * phi.cos()].map(|v| 0.5 * v);
            text += &format!("v {x} {} {z}\n", y + 1.0);
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let vertex = |row: i32, column: i32| 1 + row * columns + column % columns;
            let [a, b, c, d] =
                [vertex(row, column), vertex(row + 1, column), vertex(row + 1, column + 1), vertex(row, column + 1)];
            text += &format!("f {a} {b} {c} {d}\n");
        }
    }
    let first = 1 + (rows + 1) * columns;
    for i in 0..9 {
        for k in 0..9 {
            text += &format!("v {} 0 {}\n", 0.5 * f64::from(i) - 2.0, 0.5 * f64::from(k) - 2.0);
        }
    }
    for i in 0..8 {
        for k in 0..8 {
            let vertex = |i: i32, k: i32| first + 9 * i + k;
            text += &format!("f {} {} {} {}\n", vertex(i, k), vertex(i, k + 1), vertex(i + 1, k + 1), vertex(i + 1, k));
        }
    }
    text
}

/// Linear pixels of a picture that the program wrote.
pub(crate) fn pixels(path: &Path) -> prt_bake::Image {
    prt_bake::Image::load(path).unwrap()
}

/// A number of a report.
pub(crate) fn number(object: &Value, path: &str) -> f64 {
    object.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path} is a number in {object}"))
}
