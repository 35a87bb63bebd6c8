//! The report of a bake: a JSON file for programs and a page for people, which needs nothing but itself.
//!
//! ```text
//! findings   what the numbers of the vertices say, counted once
//! stage      the surface at unit size, and where it is looked at from
//! pictures   light, occlusion, error, invalid vertices and rays, drawn on the CPU
//! advice     warnings in plain words
//! page       the HTML; json: the other file
//! ```

mod advice;
mod base64;
mod chart;
mod color;
mod command;
mod findings;
mod histogram;
mod html;
mod legend;
mod marks;
mod numbers;
mod page;
mod paths;
mod pictures;
mod raster;
mod stage;
#[cfg(test)]
mod tests;

use anyhow::Context;
use prt_bake::{BakedSurface, VertexStats};
use serde_json::{Value, json};

use findings::Findings;

pub(crate) use command::command_line;
pub(crate) use paths::{Paths, parse};

/// What a report is made of.
#[derive(Debug)]
pub(crate) struct ReportInput<'a> {
    /// What the scene is called in the title.
    pub(crate) scene: &'a str,
    pub(crate) baked: &'a BakedSurface,
    /// `[V]`; empty where no ray was traced.
    pub(crate) vertices: &'a [VertexStats],
    /// What `--json` prints, an object. Members that are not known here are shown in a table of their own.
    pub(crate) numbers: &'a Value,
    /// The command that repeats the bake, as [`command_line`] quotes it.
    pub(crate) command: &'a str,
}

/// Writes both files. Each appears whole or not at all; the baked surface stays as it is.
///
/// # Errors
/// If a file cannot be written.
///
/// # Panics
/// If there are numbers for other than all or none of the vertices.
pub(crate) fn write(paths: &Paths, input: &ReportInput<'_>) -> anyhow::Result<()> {
    let findings = Findings::of(input.baked, input.vertices);
    let pictures = pictures::draw(input, &findings);
    let advice = advice::of(input, &findings, &pictures);
    let text = serde_json::to_string_pretty(&json(input, &findings, &advice)).context("cannot write JSON")?;
    paths::replace(&paths.json, text.as_bytes())?;
    paths::replace(&paths.html, page::page(input, &findings, &pictures, &advice).as_bytes())
}

/// All that `--json` prints, and what was found on top.
fn json(input: &ReportInput<'_>, findings: &Findings, advice: &[advice::Advice]) -> Value {
    let mut object = input.numbers.as_object().cloned().unwrap_or_default();
    let texts: Vec<&str> = advice.iter().map(|advice| advice.text.as_str()).collect();
    let added = [
        ("title", json!(input.scene)),
        ("command", json!(input.command)),
        ("version", json!(env!("CARGO_PKG_VERSION"))),
        ("warnings", json!(texts)),
        ("findings", findings.json()),
    ];
    object.extend(added.map(|(key, value)| (key.to_owned(), value)));
    Value::Object(object)
}
