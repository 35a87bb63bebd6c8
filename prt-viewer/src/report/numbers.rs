//! The numbers of a bake as rows of tables.

use std::collections::BTreeSet;

use serde_json::Value;

use crate::output;

/// How a number is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Count,
    Share,
    Bytes,
    /// Millions of rays in a second.
    Rate,
    /// As it is.
    Plain,
}

/// A known number: its name in the file, its label, and how it is written.
pub(super) type Known = (&'static str, &'static str, Kind);

pub(super) const MESH: &[Known] = &[
    ("vertices", "Vertices", Kind::Count),
    ("triangles", "Triangles", Kind::Count),
    ("vertices_split", "Vertices split at creases", Kind::Count),
    ("vertices_unused", "Vertices without a face, left out", Kind::Count),
    ("faces_dropped", "Faces left out", Kind::Count),
    ("faces_degenerate", "– without area", Kind::Count),
    ("faces_duplicate", "– the same as another", Kind::Count),
    ("faces_not_finite", "– at undefined positions", Kind::Count),
    ("vertices_invalid", "Vertices inside geometry", Kind::Count),
];

pub(super) const SETTINGS: &[Known] = &[
    ("order", "Order (bands)", Kind::Plain),
    ("channels", "Channels", Kind::Plain),
    ("rays_per_vertex", "Rays per vertex", Kind::Count),
    ("bounces", "Bounces", Kind::Plain),
    ("inside", "Inside of geometry", Kind::Plain),
    ("seed", "Seed", Kind::Plain),
    ("threads", "Threads", Kind::Plain),
];

pub(super) const RAYS: &[Known] = &[
    ("rays_traced", "Rays traced", Kind::Count),
    ("vertices_resumed", "– vertices from an earlier run", Kind::Count),
    ("mrays_per_second", "Speed", Kind::Rate),
    ("occluded_share", "Directions that meet something", Kind::Share),
];

pub(super) const ERROR: &[Known] = &[("error", "Of the whole", Kind::Share)];

pub(super) const RESULT: &[Known] = &[
    ("scene", "Scene", Kind::Plain),
    ("output", "Baked file", Kind::Plain),
    ("output_bytes", "Its size", Kind::Bytes),
    ("peak_memory_bytes", "Peak memory", Kind::Bytes),
];

/// How labels begin that belong to the row above.
const DETAIL: char = '–';

/// Members that are shown otherwise than in a table.
const DRAWN: [&str; 4] = ["seconds", "bounce_energy", "warnings", "up_to_date"];

/// A label and a text.
pub(super) type Row = (String, String);

/// The known numbers of a group that are there.
pub(super) fn known(numbers: &Value, group: &[Known]) -> Vec<Row> {
    let row = |&(name, label, kind): &Known| {
        // A reason that nothing was left out for is no news.
        let is_news = |value: &&Value| !(value.is_null() || label.starts_with(DETAIL) && value.as_u64() == Some(0));
        let value = numbers.get(name).filter(is_news)?;
        Some((label.to_owned(), written(value, kind)))
    };
    group.iter().filter_map(row).collect()
}

/// Everything else.
pub(super) fn others(numbers: &Value) -> Vec<Row> {
    let known: BTreeSet<&str> =
        [MESH, SETTINGS, RAYS, ERROR, RESULT].concat().iter().map(|known| known.0).chain(DRAWN).collect();
    let members = numbers.as_object().into_iter().flatten();
    let mut rows = Vec::new();
    members
        .filter(|(name, _)| !known.contains(name.as_str()))
        .for_each(|(name, value)| flatten(name, value, &mut rows));
    rows
}

/// A name of the file as words.
pub(super) fn label(name: &str) -> String {
    let mut letters = name.chars();
    let first = letters.next().map(|letter| letter.to_uppercase().to_string()).unwrap_or_default();
    first + &letters.as_str().replace('_', " ")
}

/// A row for a value, or a row for each member of an object.
fn flatten(name: &str, value: &Value, rows: &mut Vec<Row>) {
    let label = label(name);
    match value {
        Value::Object(members) => {
            members.iter().for_each(|(member, value)| flatten(&format!("{label}: {member}"), value, rows));
        }
        Value::Array(values) => rows.push((label, list(values))),
        Value::Null => {}
        value => rows.push((label, scalar(value))),
    }
}

/// Values of a list; of a long one, how many and the ends.
fn list(values: &[Value]) -> String {
    let texts = |values: &[Value]| values.iter().map(scalar).collect::<Vec<_>>().join(", ");
    match values {
        [] => "none".to_owned(),
        [first, .., last] if values.len() > 12 => {
            format!("{} values, {} … {}", output::count(values.len() as u64), scalar(first), scalar(last))
        }
        values => texts(values),
    }
}

fn written(value: &Value, kind: Kind) -> String {
    match (kind, value.as_u64(), value.as_f64()) {
        (Kind::Count, Some(count), _) => output::count(count),
        (Kind::Bytes, Some(size), _) => output::bytes(size),
        (Kind::Share, _, Some(share)) => percent(share),
        (Kind::Rate, _, Some(rate)) => format!("{rate:.1} Mrays/s"),
        _ => scalar(value),
    }
}

fn scalar(value: &Value) -> String {
    match value {
        Value::Null => "–".to_owned(),
        Value::Bool(flag) => if *flag { "yes" } else { "no" }.to_owned(),
        Value::String(text) => text.clone(),
        Value::Number(number) if number.is_f64() => significant(number.as_f64().unwrap_or(f64::NAN), 4),
        value => value.to_string(),
    }
}

/// A share in percent, with two significant digits.
pub(super) fn percent(share: f64) -> String {
    format!("{} %", significant(100.0 * share, 2))
}

/// A span of time.
pub(super) fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 1.0 => format!("{} ms", significant(1000.0 * s, 2)),
        s if s < 60.0 => format!("{} s", significant(s, 3)),
        s if s < 3600.0 => format!("{} min {} s", (s / 60.0).floor(), (s % 60.0).floor()),
        s => format!("{} h {} min", (s / 3600.0).floor(), (s % 3600.0 / 60.0).floor()),
    }
}

/// A number with some significant digits, digits before the point whole, without zeros at the end.
fn significant(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.abs().to_string();
    }
    let decimals = digits - 1 - value.abs().log10().floor() as i32;
    if !(-15..=8).contains(&decimals) {
        return format!("{value:.1e}");
    }
    let text = format!("{value:.*}", decimals.max(0) as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn numbers_are_written_for_people() {
        let shares = [0.0, 1e-6, 0.002_23, 0.0456, 0.5, 1.0, 12.0, 1e-12].map(percent);
        assert_eq!(shares, ["0 %", "0.0001 %", "0.22 %", "4.6 %", "50 %", "100 %", "1200 %", "1.0e-10 %"]);
        let spans = [0.0, 0.012_34, 4.04, 65.2, 7260.0].map(duration);
        assert_eq!(spans, ["0 ms", "12 ms", "4.04 s", "1 min 5 s", "2 h 1 min"]);
        assert_eq!([1e30, -2.5, f64::INFINITY].map(|value| significant(value, 4)), ["1.0e30", "-2.5", "inf"]);
    }

    #[test]
    fn known_numbers_have_labels_and_unknown_ones_their_names() {
        let numbers = json!({
            "vertices": 34834, "error": 0.0022, "peak_memory_bytes": null, "seconds": { "total": 1.0 },
            "bins_free": 12, "saved": { "by_bins": 0.25, "all": true }, "list": [1, 2.5], "part": null, "long": vec![7; 20], "empty": [],
        });
        assert_eq!(known(&numbers, MESH), [("Vertices".to_owned(), "34,834".to_owned())]);
        let reasons = json!({ "faces_dropped": 3, "faces_degenerate": 3, "faces_duplicate": 0 });
        let labels: Vec<_> = known(&reasons, MESH).into_iter().map(|(label, _)| label).collect();
        assert_eq!(labels, ["Faces left out", "– without area"]);
        assert_eq!(known(&numbers, ERROR), [("Of the whole".to_owned(), "0.22 %".to_owned())]);
        assert!(known(&numbers, RESULT).is_empty());
        let others: Vec<_> = others(&numbers).into_iter().map(|(label, text)| format!("{label} = {text}")).collect();
        assert_eq!(
            others,
            [
                "Bins free = 12",
                "Empty = none",
                "List = 1, 2.5",
                "Long = 20 values, 7 … 7",
                "Saved: all = yes",
                "Saved: by bins = 0.25"
            ]
        );
        assert!(known(&json!([1]), MESH).is_empty() && super::others(&json!("text")).is_empty());
    }
}
