//! Several meshes, one after another.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::Arguments;
use super::report::Report;
use crate::laps::Laps;
use crate::{cancel, output, output_file};

#[derive(Debug, Serialize)]
struct Reports {
    scenes: Vec<Report>,
    /// What went wrong, where something did.
    failed: Vec<Failure>,
    seconds: f64,
}

#[derive(Debug, Serialize)]
struct Failure {
    scene: String,
    error: String,
}

/// Bakes each mesh into a file of its own. One that cannot be baked does not hold up the others; the program fails after the last.
pub(super) fn run(arguments: &Arguments, scenes: &[PathBuf]) -> anyhow::Result<()> {
    let laps = Laps::start();
    let outputs = outputs(arguments, scenes)?;
    outputs.iter().try_for_each(|output| output_file::check(output))?;
    for (scene, output) in scenes.iter().zip(&outputs) {
        arguments.reporting.check(scene, output, true)?;
    }
    cancel::listen()?;
    arguments.keeping.lower_priority()?;
    let mut reports = Reports { scenes: Vec::new(), failed: Vec::new(), seconds: 0.0 };
    for (number, (scene, output)) in (1..).zip(scenes.iter().zip(outputs)) {
        cancel::check()?;
        output::note(format_args!("{number} of {}: {}", scenes.len(), scene.display()));
        match super::bake_mesh(arguments, scene, output) {
            Ok(report) => reports.scenes.push(report),
            Err(error) => {
                cancel::check()?;
                let error = output::one_line(&error);
                output::note(format_args!("error: {error}"));
                reports.failed.push(Failure { scene: scene.display().to_string(), error });
            }
        }
    }
    reports.seconds = laps.total();
    output::result(arguments.json, &reports, || summary(&reports))?;
    anyhow::ensure!(
        reports.failed.is_empty(),
        "{} of {} scenes could not be baked",
        reports.failed.len(),
        scenes.len()
    );
    Ok(())
}

/// A file for each scene, in the folder that was asked for.
fn outputs(arguments: &Arguments, scenes: &[PathBuf]) -> anyhow::Result<Vec<PathBuf>> {
    let folder = arguments.output.as_deref().unwrap_or(Path::new(""));
    let is_folder = arguments.output.is_none() || folder.is_dir();
    anyhow::ensure!(is_folder, "{} is not a folder; several scenes need one", folder.display());
    let outputs: Vec<PathBuf> =
        scenes.iter().map(|scene| folder.join(arguments.keeping.default_output(scene, "prt"))).collect();
    let mut sorted: Vec<&PathBuf> = outputs.iter().collect();
    sorted.sort();
    match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => anyhow::bail!("two of the scenes would be written to {}", pair[0].display()),
        None => Ok(outputs),
    }
}

fn summary(reports: &Reports) -> String {
    reports.scenes.iter().map(Report::summary).collect::<Vec<_>>().join("\n")
}
