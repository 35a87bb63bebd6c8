//! Small charts as inline SVG. Widths are shares of the page and heights are pixels, so that text keeps its size on any screen.

use std::fmt::Write;

use super::histogram::Histogram;
use super::html::escape;

/// Pixels: a row of a bar chart, and its bar.
const ROW: usize = 26;
const BAR: usize = 10;
/// Pixels: the bars of a histogram, and the labels below them.
const PLOT: f64 = 120.0;
const FOOT: f64 = 22.0;

/// A bar of a chart: what it is, its length, and the number as text.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Bar {
    pub(super) label: String,
    pub(super) value: f64,
    pub(super) text: String,
}

/// Horizontal bars, the longest as wide as there is room.
pub(super) fn bars(title: &str, bars: &[Bar]) -> String {
    let longest = bars.iter().map(|bar| bar.value).filter(|value| value.is_finite()).fold(0.0, f64::max);
    let mut rows = String::new();
    for (i, bar) in bars.iter().enumerate() {
        let y = i * ROW;
        let share = if bar.value > 0.0 && longest > 0.0 { (bar.value / longest).min(1.0) } else { 0.0 };
        // Writing to a string does not fail.
        let _ = write!(
            rows,
            "<text x=\"0\" y=\"{}\">{}</text><text class=\"value\" x=\"100%\" y=\"{}\">{}</text>\
             <rect class=\"track\" x=\"0\" y=\"{y3}\" width=\"100%\" height=\"3\"/>\
             <rect class=\"fill\" x=\"0\" y=\"{y3}\" width=\"{:.2}%\" height=\"3\"/>",
            y + BAR + 2,
            escape(&bar.label),
            y + BAR + 2,
            escape(&bar.text),
            100.0 * share,
            y3 = y + BAR + 7,
        );
    }
    figure(title, bars.len() * ROW, &rows)
}

/// Columns of a histogram from its first to its last bin in use; the highest as high as there is room. Labels are those of the ends.
pub(super) fn columns(title: &str, histogram: &Histogram, label: impl Fn(f64) -> String) -> String {
    let bins = histogram.occupied();
    let highest = histogram.counts[bins.clone()].iter().copied().max().unwrap_or(0).max(1) as f64;
    let width = 100.0 / bins.len() as f64;
    let mut columns = String::new();
    for (i, bin) in bins.clone().enumerate() {
        let height = PLOT * histogram.counts[bin] as f64 / highest;
        let _ = write!(
            columns,
            "<rect class=\"fill\" x=\"{:.3}%\" y=\"{:.1}\" width=\"{:.3}%\" height=\"{height:.1}\"><title>{} to {}: {}</title></rect>",
            width * (i as f64 + 0.04),
            PLOT - height,
            width * 0.92,
            escape(&label(histogram.edges[bin])),
            escape(&label(histogram.edges[bin + 1])),
            histogram.counts[bin],
        );
    }
    let _ = write!(
        columns,
        "<rect class=\"track\" x=\"0\" y=\"{PLOT}\" width=\"100%\" height=\"1\"/><text class=\"low\" x=\"0\" y=\"{0}\">{1}</text>\
         <text class=\"value\" x=\"100%\" y=\"{0}\">{2}</text>",
        PLOT + 16.0,
        escape(&label(histogram.edges[bins.start])),
        escape(&label(histogram.edges[bins.end])),
    );
    figure(title, (PLOT + FOOT) as usize, &columns)
}

fn figure(title: &str, height: usize, content: &str) -> String {
    format!(
        "<svg class=\"chart\" role=\"img\" aria-label=\"{}\" width=\"100%\" height=\"{height}\">{content}</svg>\n",
        escape(title)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bar(label: &str, value: f64) -> Bar {
        Bar { label: label.to_owned(), value, text: value.to_string() }
    }

    #[test]
    fn bars_are_as_long_as_their_values() {
        let svg = bars("energy", &[bar("direct <1>", 2.0), bar("bounce 1", 0.5), bar("broken", f64::NAN)]);
        let widths: Vec<&str> =
            svg.split("class=\"fill\"").skip(1).filter_map(|part| part.split("width=\"").nth(1)).collect();
        assert!(widths[0].starts_with("100.00%") && widths[1].starts_with("25.00%"), "{svg}");
        assert!(svg.contains("direct &lt;1&gt;") && !svg.contains("NaN%"), "{svg}");
        assert!(bars("none", &[]).contains("height=\"0\""));
        assert!(bars("dark", &[bar("a", 0.0)]).contains("width=\"0.00%\""));
    }

    #[test]
    fn columns_are_as_high_as_their_counts() {
        let histogram = Histogram::linear([0.1, 0.1, 0.1, 0.1, 0.6], [0.0, 1.0], 4);
        let svg = columns("errors", &histogram, |edge| format!("{edge}"));
        assert!(svg.contains("height=\"120.0\"") && svg.contains("height=\"30.0\""), "{svg}");
        assert!(svg.contains(">0</text>") && svg.contains(">0.75</text>"), "empty bins at the end are cut off: {svg}");
    }
}
