//! Curves on logarithmic axes, as SVG.

use std::fmt::Write;

/// One curve.
#[derive(Debug)]
pub(crate) struct Curve {
    pub(crate) name: String,
    /// Both coordinates positive.
    pub(crate) points: Vec<[f64; 2]>,
}

const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 600.0;
/// Left, right, top, bottom.
const MARGINS: [f64; 4] = [80.0, 140.0, 50.0, 60.0];
const COLORS: [&str; 8] = ["#4477aa", "#ee6677", "#228833", "#ccbb44", "#66ccee", "#aa3377", "#777777", "#222222"];

/// Whole decades around the values of one coordinate.
#[derive(Clone, Copy, Debug)]
struct Axis {
    decades: [i32; 2],
    /// Pixels of the first and the last decade.
    pixels: [f64; 2],
}

impl Axis {
    fn new(values: impl Iterator<Item = f64> + Clone, pixels: [f64; 2]) -> Self {
        let lowest = values.clone().fold(f64::INFINITY, f64::min).log10().floor();
        let highest = values.fold(0.0, f64::max).log10().ceil();
        Self { decades: [lowest as i32, (highest as i32).max(lowest as i32 + 1)], pixels }
    }

    fn at(&self, value: f64) -> f64 {
        let [low, high] = self.decades.map(f64::from);
        self.pixels[0] + (value.log10() - low) / (high - low) * (self.pixels[1] - self.pixels[0])
    }

    /// Powers of ten, with their pixels.
    fn ticks(&self) -> impl Iterator<Item = (i32, f64)> {
        let axis = *self;
        (axis.decades[0]..=axis.decades[1]).map(move |decade| (decade, axis.at(10_f64.powi(decade))))
    }
}

/// Draws curves with both axes logarithmic.
pub(crate) fn log_log(title: &str, [x_label, y_label]: [&str; 2], curves: &[Curve]) -> String {
    let values = |k: usize| curves.iter().flat_map(move |curve| curve.points.iter().map(move |point| point[k]));
    let [left, right, top, bottom] = MARGINS;
    let x = Axis::new(values(0), [left, WIDTH - right]);
    let y = Axis::new(values(1), [HEIGHT - bottom, top]);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    text(&mut svg, [WIDTH / 2.0, 25.0], title);
    text(&mut svg, [WIDTH / 2.0, HEIGHT - 15.0], x_label);
    text(&mut svg, [90.0, 40.0], y_label);
    for (decade, pixel) in x.ticks() {
        line(&mut svg, [pixel, top], [pixel, HEIGHT - bottom]);
        text(&mut svg, [pixel, HEIGHT - bottom + 18.0], &format!("1e{decade}"));
    }
    for (decade, pixel) in y.ticks() {
        line(&mut svg, [left, pixel], [WIDTH - right, pixel]);
        text(&mut svg, [left - 28.0, pixel + 4.0], &format!("1e{decade}"));
    }
    for (i, curve) in curves.iter().enumerate() {
        draw(&mut svg, curve, COLORS[i % COLORS.len()], &x, &y);
        let height = top + 20.0 * (i + 1) as f64;
        let name = [WIDTH - right + 60.0, height];
        append(
            &mut svg,
            format_args!(
                "<circle cx=\"{}\" cy=\"{}\" r=\"4\" fill=\"{}\"/>\n",
                name[0] - 45.0,
                height - 4.0,
                COLORS[i % COLORS.len()]
            ),
        );
        text(&mut svg, name, &curve.name);
    }
    svg + "</svg>\n"
}

fn draw(svg: &mut String, curve: &Curve, color: &str, x: &Axis, y: &Axis) {
    let points: Vec<String> = curve.points.iter().map(|p| format!("{:.1},{:.1}", x.at(p[0]), y.at(p[1]))).collect();
    append(svg, format_args!("<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\"/>\n", points.join(" ")));
    for [px, py] in curve.points.iter().map(|p| [x.at(p[0]), y.at(p[1])]) {
        append(svg, format_args!("<circle cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"4\" fill=\"{color}\"/>\n"));
    }
}

fn line(svg: &mut String, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2]) {
    append(
        svg,
        format_args!("<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke=\"#dddddd\"/>\n"),
    );
}

fn text(svg: &mut String, [x, y]: [f64; 2], words: &str) {
    append(svg, format_args!("<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\">{words}</text>\n"));
}

fn append(svg: &mut String, element: std::fmt::Arguments<'_>) {
    svg.write_fmt(element).expect("writing to a string cannot fail");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_logarithmic() {
        let axis = Axis::new([0.02, 30.0].into_iter(), [100.0, 500.0]);
        assert_eq!(axis.decades, [-2, 2]);
        assert!((axis.at(0.1) - 200.0).abs() < 1e-9 && (axis.at(100.0) - 500.0).abs() < 1e-9);
    }

    #[test]
    fn every_point_is_drawn() {
        let curve = |name: &str| Curve { name: name.into(), points: vec![[1.0, 2.0], [10.0, 20.0]] };
        let svg = log_log("title", ["x", "y"], &[curve("first"), curve("second")]);
        assert_eq!((svg.matches("<polyline").count(), svg.matches("<circle").count()), (2, 6));
        assert!(svg.contains(">second<") && svg.ends_with("</svg>\n"));
    }
}
