//! The page of a report: HTML that is well-formed XML too, with its style and its pictures inside.

use serde_json::Value;

use super::ReportInput;
use super::advice::{Advice, Weight};
use super::chart::{self, Bar};
use super::findings::{ErrorSpread, Findings, RaySpread};
use super::html::escape;
use super::numbers::{self, Row, duration, percent};
use super::pictures::{Panel, Picture, Pictures};
use crate::output;

/// The steps of a bake, as the numbers name them.
const STEPS: [&str; 6] = ["load", "plan", "build", "trace", "bounce", "write"];
const STYLE: &str = include_str!("page.css");

pub(super) fn page(input: &ReportInput<'_>, findings: &Findings, pictures: &Pictures, advice: &[Advice]) -> String {
    let title = escape(input.scene);
    let panels: String = pictures.panels.iter().map(panel).collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<title>{title}: bake report</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n{}{}{panels}<div class=\"cards\">\n{}</div>\n{}{}</main>\n</body>\n</html>\n",
        header(input, findings, pictures),
        advice_list(advice),
        cards(input, findings),
        section("Repeat it", &format!("<pre>{}</pre>\n", escape(input.command))),
        footer(),
    )
}

fn header(input: &ReportInput<'_>, findings: &Findings, pictures: &Pictures) -> String {
    let picture = |picture: &Picture| {
        let alt = format!("{}, lit by the built-in sky, {}", input.scene, picture.side);
        format!("<div class=\"hero\">{}</div>\n", image(picture, &alt))
    };
    let fact = |(name, value): (&str, String)| format!("<div><dt>{name}</dt><dd>{}</dd></div>\n", escape(&value));
    let facts: String = facts(input, findings).into_iter().map(fact).collect();
    format!(
        "<header>\n{}<div>\n<h1>{}</h1>\n<p class=\"soft\">Report of a bake of precomputed radiance transfer</p>\n\
         <dl class=\"facts\">\n{facts}</dl>\n</div>\n</header>\n",
        pictures.title.as_ref().map(picture).unwrap_or_default(),
        escape(input.scene),
    )
}

/// The numbers that everybody wants.
fn facts(input: &ReportInput<'_>, findings: &Findings) -> Vec<(&'static str, String)> {
    let error = input.numbers.get("error").and_then(Value::as_f64).or(input.baked.metadata.error);
    let seconds = input.numbers.pointer("/seconds/total").or_else(|| input.numbers.get("seconds"));
    let seconds = seconds.and_then(Value::as_f64);
    let mut facts = vec![
        ("Vertices", output::count(input.baked.geometry.vertex_count() as u64)),
        ("Triangles", output::count(input.baked.geometry.triangles.len() as u64)),
        ("Order", input.baked.transfer.order.to_string()),
        ("Light that arrives", percent(findings.mean_arriving())),
    ];
    facts.extend(error.map(|error| ("Estimated error", percent(error))));
    facts.extend(seconds.map(|seconds| ("Time", duration(seconds))));
    facts
}

fn advice_list(advice: &[Advice]) -> String {
    let item = |advice: &Advice| {
        let (class, word) = match advice.weight {
            Weight::Warning => ("warning", "Check:"),
            Weight::Note => ("note", "Note:"),
        };
        format!("<li class=\"{class}\"><b>{word}</b> {}</li>\n", escape(&advice.text))
    };
    let items: String = advice.iter().map(item).collect();
    let nothing =
        "<li class=\"note\">Nothing stands out: no vertex lies inside geometry, and no face was left out.</li>\n";
    format!("<ul class=\"advice\">\n{}</ul>\n", if items.is_empty() { nothing } else { &items })
}

fn panel(panel: &Panel) -> String {
    let figure = |picture: &Picture| {
        let alt = format!("{}, {}", panel.heading, picture.side);
        let image = image(picture, &alt);
        format!("<figure><div>{image}</div><figcaption>{}</figcaption></figure>\n", escape(picture.side))
    };
    let figures: String = panel.pictures.iter().map(figure).collect();
    format!(
        "<section id=\"{}\">\n<h2>{}</h2>\n<p>{}</p>\n{}<div class=\"views views-{}\">\n{figures}</div>\n</section>\n",
        panel.name,
        escape(panel.heading),
        escape(&panel.explanation),
        panel.legend.html(),
        panel.pictures.len(),
    )
}

fn image(picture: &Picture, alt: &str) -> String {
    format!("<img alt=\"{}\" src=\"data:image/png;base64,{}\"/>", escape(alt), picture.data)
}

fn cards(input: &ReportInput<'_>, findings: &Findings) -> String {
    let numbers = input.numbers;
    let mut rays = numbers::known(numbers, numbers::RAYS);
    rays.extend(findings.rays.iter().flat_map(ray_rows));
    let mut errors = numbers::known(numbers, numbers::ERROR);
    errors.extend(findings.error.iter().flat_map(error_rows));
    [
        card("Mesh", &table(&numbers::known(numbers, numbers::MESH))),
        card("Settings", &table(&numbers::known(numbers, numbers::SETTINGS))),
        card("Time", &time(numbers)),
        card("Rays", &table(&rays)),
        card("Estimated error", &(table(&errors) + &error_columns(findings))),
        card("Light that arrives", &arriving_columns(findings)),
        card("Energy of each bounce", &bounces(numbers)),
        card("Energy of each band", &bands(findings)),
        card("Result", &table(&numbers::known(numbers, numbers::RESULT))),
        card("More numbers", &table(&numbers::others(numbers))),
    ]
    .concat()
}

fn ray_rows(spread: &RaySpread) -> Vec<Row> {
    let count = |value: u32| output::count(u64::from(value));
    let range = format!("{} … {} … {}", count(spread.fewest), count(spread.median), count(spread.most));
    let mut rows = vec![
        ("For a vertex: fewest, median, most".to_owned(), range),
        ("Directions answered".to_owned(), output::count(spread.directions)),
    ];
    if spread.total < spread.directions {
        let saved = 1.0 - spread.total as f64 / spread.directions as f64;
        rows.push(("Directions answered without a ray of their own".to_owned(), percent(saved)));
    }
    rows
}

fn error_rows(spread: &ErrorSpread) -> Vec<Row> {
    let share = |error: f32| percent(f64::from(error));
    [
        ("Median", share(spread.median)),
        ("19 of 20 are below", share(spread.most)),
        ("Largest", share(spread.largest)),
        ("Vertices with an estimate", output::count(spread.estimated as u64)),
        ("– without any shadow, exact", output::count(spread.exact as u64)),
    ]
    .map(|(label, text)| (label.to_owned(), text))
    .to_vec()
}

fn error_columns(findings: &Findings) -> String {
    let spread = findings.error.as_ref().filter(|spread| spread.histogram.counts.iter().any(|&count| count > 0));
    spread.map(|spread| chart::columns("Vertices by estimated error", &spread.histogram, percent)).unwrap_or_default()
}

fn arriving_columns(findings: &Findings) -> String {
    chart::columns("Vertices by the light that arrives", &findings.arriving_histogram, percent)
}

/// Every step, and the total.
fn time(numbers: &Value) -> String {
    let mut steps: Vec<_> = numbers.get("seconds").and_then(Value::as_object).into_iter().flatten().collect();
    // In the order in which they happen, those not known here behind them, and the total last.
    let place = |name: &str| STEPS.iter().position(|&step| step == name).unwrap_or(STEPS.len());
    steps.sort_by_key(|(name, _)| if *name == "total" { usize::MAX } else { place(name) });
    let bar = |(name, value): (&String, &Value)| {
        value.as_f64().map(|value| Bar { label: numbers::label(name), value, text: duration(value) })
    };
    let bars: Vec<Bar> = steps.into_iter().filter_map(bar).collect();
    if bars.is_empty() { String::new() } else { chart::bars("Time of each step", &bars) }
}

fn bounces(numbers: &Value) -> String {
    let energies = numbers.get("bounce_energy").and_then(Value::as_array).filter(|energies| !energies.is_empty());
    let Some(energies) = energies else { return String::new() };
    let later =
        energies.iter().enumerate().map(|(i, energy)| (format!("Bounce {}", i + 1), energy.as_f64().unwrap_or(0.0)));
    let all = std::iter::once(("Direct".to_owned(), 1.0)).chain(later);
    let bars: Vec<Bar> = all.map(|(label, value)| Bar { label, value, text: percent(value) }).collect();
    chart::bars("Energy of each bounce, relative to the direct light", &bars)
}

fn bands(findings: &Findings) -> String {
    let bar = |(l, &value): (usize, &f64)| Bar { label: format!("Band {l}"), value, text: percent(value) };
    chart::bars("Energy of each band", &findings.band_energy.iter().enumerate().map(bar).collect::<Vec<_>>())
}

fn table(rows: &[Row]) -> String {
    let row =
        |(label, text): &Row| format!("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", escape(label), escape(text));
    let rows: String = rows.iter().map(row).collect();
    if rows.is_empty() { rows } else { format!("<table>\n<tbody>\n{rows}</tbody>\n</table>\n") }
}

/// A section, or nothing if there is nothing in it.
fn card(heading: &str, content: &str) -> String {
    if content.is_empty() { String::new() } else { section(heading, content) }
}

fn section(heading: &str, content: &str) -> String {
    format!("<section>\n<h2>{}</h2>\n{content}</section>\n", escape(heading))
}

fn footer() -> String {
    format!(
        "<footer>Written by prt {}. The same numbers are in the JSON file beside this page.</footer>\n",
        env!("CARGO_PKG_VERSION")
    )
}
