//! What the colours of a picture mean.

use std::fmt::Write;

use super::color::{MISSING, Ramp, Scale, encode_srgb};
use super::html::escape;
use super::numbers::percent;
use super::raster::BACK;
use crate::output;

/// Colours by which the bar of a legend is approximated.
const STOPS: usize = 13;
/// Most labels at a bar.
const LABELS: i32 = 4;

/// A bar of colours with labels, and single colours.
#[derive(Debug)]
pub(super) struct Legend {
    /// None for a picture that only marks.
    pub(super) bar: Option<(Ramp, Scale, Unit)>,
    /// Colour as in CSS, and what it stands for.
    pub(super) keys: Vec<(String, &'static str)>,
}

/// How the numbers at a bar are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Unit {
    Percent,
    Count,
}

impl Legend {
    pub(super) fn of(ramp: Ramp, scale: Scale, unit: Unit) -> Self {
        Self { bar: Some((ramp, scale, unit)), keys: Vec::new() }
    }

    /// Adds the colour of vertices without a value.
    pub(super) fn with_missing(mut self, meaning: &'static str) -> Self {
        self.keys.push((css(MISSING), meaning));
        self
    }

    /// The colour of backs.
    pub(super) fn backs() -> (String, &'static str) {
        (css(BACK), "backs of faces")
    }

    pub(super) fn html(&self) -> String {
        let bar = self.bar.map(|(ramp, scale, unit)| bar(ramp, scale, unit)).unwrap_or_default();
        let key = |(color, meaning): &(String, &str)| {
            format!("<span class=\"key\"><i style=\"background:{color}\"></i>{}</span>", escape(meaning))
        };
        let keys: String = self.keys.iter().map(key).collect();
        format!("<div class=\"legend\">{bar}<div class=\"keys\">{keys}</div></div>\n")
    }
}

fn bar(ramp: Ramp, scale: Scale, unit: Unit) -> String {
    let stop = |i: usize| css(ramp.color(i as f32 / (STOPS - 1) as f32));
    let stops = (0..STOPS).map(stop).collect::<Vec<_>>().join(",");
    let mut labels = String::new();
    for (share, text) in ticks(scale, unit) {
        // Writing to a string does not fail.
        let _ = write!(labels, "<span style=\"left:{:.2}%\">{}</span>", 100.0 * share, escape(&text));
    }
    format!(
        "<div class=\"bar\"><div class=\"ramp\" style=\"background:linear-gradient(to right,{stops})\"></div><div class=\"ticks\">{labels}</div></div>"
    )
}

/// Places from 0 to 1 and what stands there.
fn ticks(scale: Scale, unit: Unit) -> Vec<(f64, String)> {
    let text = |value: f64| match unit {
        Unit::Percent => percent(value),
        Unit::Count => output::count(value.round() as u64),
    };
    match scale {
        Scale::Linear { low, high } => [0.0, 0.5, 1.0].map(|share| (share, text(low + share * (high - low)))).to_vec(),
        Scale::Decades { first, last } => {
            let step = (last - first + LABELS - 1) / LABELS;
            let at = |decade: i32| (f64::from(decade - first) / f64::from(last - first), text(10_f64.powi(decade)));
            // From the end that matters most.
            (first..=last).rev().step_by(step as usize).map(at).collect()
        }
    }
}

pub(super) fn css(linear: [f32; 3]) -> String {
    let [r, g, b] = linear.map(encode_srgb);
    format!("#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_stand_at_their_values() {
        let decades = ticks(Scale::Decades { first: -4, last: -1 }, Unit::Percent);
        let texts: Vec<_> = decades.iter().map(|(share, text)| (format!("{share:.3}"), text.as_str())).collect();
        let expected = [("1.000", "10 %"), ("0.667", "1 %"), ("0.333", "0.1 %"), ("0.000", "0.01 %")];
        assert_eq!(texts, expected.map(|(share, text)| (share.to_owned(), text)));
        assert_eq!(ticks(Scale::Decades { first: -6, last: 0 }, Unit::Percent).len(), 4);
        let counts = ticks(Scale::Linear { low: 100.0, high: 4100.0 }, Unit::Count);
        assert_eq!(counts[1], (0.5, "2,100".to_owned()));
    }

    #[test]
    fn the_bar_ends_in_the_colours_of_the_ramp() {
        let html = bar(Ramp::Heat, Scale::Decades { first: -3, last: 0 }, Unit::Percent);
        assert!(html.contains("(to right,#4c02a1,") && html.contains(",#fdc527)"), "{html}");
        assert_eq!(css([0.0, 1.0, 0.5]), "#00ffbc");
    }
}
