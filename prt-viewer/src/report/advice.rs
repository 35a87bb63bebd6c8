//! What somebody should know who uses the result, in plain words.

use serde_json::Value;

use super::ReportInput;
use super::findings::Findings;
use super::numbers::percent;
use super::pictures::Pictures;
use crate::output;

/// Estimated error above which more rays are recommended.
const ERROR: f64 = 0.01;
/// Error of single vertices above which they are pointed at, although the whole is good.
const WORST_ERROR: f32 = 0.05;
/// Share of the direct light in the last bounce above which another one would be seen.
const LAST_BOUNCE: f64 = 0.01;
/// Share of the energy in the last two bands above which more bands are recommended. Two, because the odd bands of a surface without
/// shadows are empty.
const LAST_BANDS: f64 = 0.02;
/// Share of backs among what is seen from which on a mesh seems open or inside out.
const BACKS: f64 = 0.2;

/// How much something matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Weight {
    /// The result may look wrong.
    Warning,
    /// Good to know.
    Note,
}

/// One sentence or two.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Advice {
    pub(super) weight: Weight,
    pub(super) text: String,
}

/// What matters most comes first.
pub(super) fn of(input: &ReportInput<'_>, findings: &Findings, pictures: &Pictures) -> Vec<Advice> {
    let mut all: Vec<Advice> = [
        not_numbers(findings),
        invalid(input, findings),
        error(input, findings),
        backs(pictures),
        last_bounce(input),
        dropped(input.numbers),
        last_bands(findings),
        unshadowed(input),
        pictures.problem.clone().map(note),
    ]
    .into_iter()
    .flatten()
    .collect();
    all.extend(given(input.numbers));
    all.sort_by_key(|advice| advice.weight);
    all
}

fn warning(text: String) -> Advice {
    Advice { weight: Weight::Warning, text }
}

fn note(text: String) -> Advice {
    Advice { weight: Weight::Note, text }
}

/// Warnings that the bake itself gave.
fn given(numbers: &Value) -> Vec<Advice> {
    let texts = numbers.get("warnings").and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_str);
    texts.map(|text| warning(text.to_owned())).collect()
}

fn not_numbers(findings: &Findings) -> Option<Advice> {
    let count = findings.arriving.iter().filter(|share| !share.is_finite()).count();
    (count > 0)
        .then(|| warning(format!("{} transfer that is not a number.", counted(count, "vertex has", "vertices have"))))
}

fn invalid(input: &ReportInput<'_>, findings: &Findings) -> Option<Advice> {
    let count = findings.invalid.len();
    let were = if count == 1 { "was" } else { "were" };
    let outcome = match input.numbers.get("inside").and_then(Value::as_str) {
        Some("fill") => format!(" and {were} filled from neighbours"),
        Some("black") => format!(" and {were} made black"),
        Some("keep") => format!(" and {were} kept as found: expect dark spots"),
        _ => ": expect dark spots".to_owned(),
    };
    let subject = counted(count, "vertex lies", "vertices lie");
    let share = percent(count as f64 / input.baked.geometry.vertex_count().max(1) as f64);
    (count > 0).then(|| warning(format!("{subject} inside geometry ({share} of all){outcome}.")))
}

fn error(input: &ReportInput<'_>, findings: &Findings) -> Option<Advice> {
    let overall = input.numbers.get("error").and_then(Value::as_f64);
    let worst = findings.error.as_ref().map(|spread| spread.largest);
    match (overall, worst) {
        (Some(overall), _) if overall > ERROR => Some(warning(format!(
            "The estimated error is {:.2} %, above {}: more rays would help.",
            100.0 * overall,
            percent(ERROR)
        ))),
        (_, Some(worst)) if worst > WORST_ERROR => Some(note(format!(
            "Single vertices are less exact than the rest: the largest estimated error is {}.",
            percent(f64::from(worst))
        ))),
        _ => None,
    }
}

fn backs(pictures: &Pictures) -> Option<Advice> {
    let share = percent(pictures.back_share);
    (pictures.back_share > BACKS).then(|| {
        warning(format!(
            "{share} of what the pictures show is backs of faces, which stay black: the mesh may be open or inside out."
        ))
    })
}

fn last_bounce(input: &ReportInput<'_>) -> Option<Advice> {
    let energy = input.numbers.get("bounce_energy").and_then(Value::as_array)?;
    let last = energy.last().and_then(Value::as_f64).filter(|&last| last > LAST_BOUNCE)?;
    Some(note(format!(
        "Bounce {} still adds {} of the direct light: one more would be seen.",
        energy.len(),
        percent(last)
    )))
}

fn dropped(numbers: &Value) -> Option<Advice> {
    let count = |name: &str| numbers.get(name).and_then(Value::as_u64).unwrap_or(0) as usize;
    let total = count("faces_dropped");
    let reasons = [
        ("faces_degenerate", "without area"),
        ("faces_duplicate", "the same as another"),
        ("faces_not_finite", "at undefined positions"),
    ];
    let parts = reasons.map(|(name, reason)| (count(name), reason)).into_iter().filter(|&(count, _)| count > 0);
    let parts: Vec<_> = parts.map(|(number, reason)| format!("{} {reason}", output::count(number as u64))).collect();
    let because = if parts.is_empty() { String::new() } else { format!(": {}", parts.join(", ")) };
    (total > 0).then(|| note(format!("{} left out{because}.", counted(total, "face was", "faces were"))))
}

fn last_bands(findings: &Findings) -> Option<Advice> {
    let bands = &findings.band_energy;
    let held: f64 = bands[bands.len().saturating_sub(2)..].iter().sum();
    (bands.len() > 2 && held > LAST_BANDS).then(|| {
        note(format!(
            "The last two of {} bands still hold {} of the transfer's energy: a higher order would keep sharper shadows.",
            bands.len(),
            percent(held)
        ))
    })
}

fn unshadowed(input: &ReportInput<'_>) -> Option<Advice> {
    (!input.baked.metadata.shadowed).then(|| note("Shadows were left out, as asked: no rays were traced.".to_owned()))
}

/// A count and what is counted.
fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{} {}", output::count(count as u64), if count == 1 { one } else { many })
}
