//! The report that a bake, or a merge of its parts, is asked to write.

use std::path::{Path, PathBuf};

use prt_bake::{BakedSurface, FileReport};
use serde::Serialize;

use crate::output;
use crate::report::{self, Paths, ReportInput};

#[derive(Debug, clap::Args)]
pub(crate) struct Reporting {
    /// Write a report, a page with pictures and a JSON file: beside the result, in a folder, or as FILE.html
    #[arg(long, value_name = "FOLDER|FILE.html", num_args = 0..=1, value_parser = report::parse)]
    report: Option<Option<PathBuf>>,
}

impl Reporting {
    pub(super) fn is_asked_for(&self) -> bool {
        self.report.is_some()
    }

    /// Fails before the work if a report could not be written, or not for each of several bakes.
    ///
    /// - `input`: what must not be overwritten
    pub(super) fn check(&self, input: &Path, output: &Path, is_one_of_several: bool) -> anyhow::Result<()> {
        let Some(paths) = self.paths(output) else { return Ok(()) };
        let is_device = std::fs::metadata(output).is_ok_and(|metadata| !metadata.is_file());
        anyhow::ensure!(!is_device, "no report of {}: it is a device, and cannot be read again", output.display());
        if is_one_of_several && self.report.as_ref().is_some_and(|given| given.as_deref() == Some(&paths.html)) {
            return Err(output::usage("--report needs a folder for several scenes"));
        }
        paths.check(input, output)
    }

    /// Writes the report that was asked for. That of a bake which was done before stays.
    ///
    /// - `scene`: what it is called in the title
    pub(super) fn write(
        &self,
        scene: &str,
        output: &Path,
        file: &FileReport,
        numbers: &impl Serialize,
    ) -> anyhow::Result<()> {
        let Some(paths) = self.paths(output) else { return Ok(()) };
        if file.was_up_to_date && paths.html.exists() {
            return Ok(());
        }
        let input = ReportInput {
            scene,
            baked: &BakedSurface::read(output)?,
            vertices: &file.bake.vertices,
            numbers: &serde_json::to_value(numbers)?,
            command: &report::command_line(std::env::args_os()),
        };
        report::write(&paths, &input)
    }

    fn paths(&self, output: &Path) -> Option<Paths> {
        self.report.as_ref().map(|given| Paths::new(output, given.as_deref()))
    }
}
