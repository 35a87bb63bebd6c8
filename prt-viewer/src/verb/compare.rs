use std::borrow::Cow;
use std::path::{Path, PathBuf};

use anyhow::Context;
use prt_bake::Image;
use serde::Serialize;

use crate::difference::{self, Difference};
use crate::{arguments, output, output_file};

/// Measures how far an image is from a reference
///
/// Reads .exr, .hdr, .png and .jpg; 8-bit images are compared as linear light from 0 to 1.
///
/// mse: mean of (a - b)²; relmse: mean of (a - b)² / (b² + 0.01); psnr: 10 log10(peak² / mse), null for equal images;
/// max_abs: largest |a - b|. Means run over all pixels and channels.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// The image a
    a: PathBuf,
    /// The reference b
    b: PathBuf,
    /// Write the picture of |a - b|: .exr as it is, .png scaled so that the largest difference is white
    #[arg(short, long, value_name = "DIFF.png|exr", value_parser = arguments::picture_file)]
    output: Option<PathBuf>,
    /// The full signal of psnr; by default 1 if the reference has 8 bits, else its largest value
    #[arg(long, value_name = "VALUE", value_parser = arguments::positive)]
    peak: Option<f64>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Report<'a> {
    a: Cow<'a, str>,
    b: Cow<'a, str>,
    width: usize,
    height: usize,
    #[serde(flatten)]
    difference: Difference,
    output: Option<Cow<'a, str>>,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let Arguments { a, b, output, .. } = arguments;
    output.as_deref().map_or(Ok(()), output_file::check)?;
    let (image, reference) = (Image::load(a)?, Image::load(b)?);
    let peak = arguments.peak.or_else(|| has_8_bits(b).then_some(1.0));
    let difference = Difference::new(&image, &reference, peak)
        .with_context(|| format!("cannot compare {} with {}", a.display(), b.display()))?;
    if let Some(path) = output {
        let is_exr = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr"));
        let scale = if is_exr || difference.max_abs == 0.0 { 1.0 } else { (1.0 / difference.max_abs) as f32 };
        difference::picture(&image, &reference, scale).save(path)?;
    }
    let report = Report {
        a: a.to_string_lossy(),
        b: b.to_string_lossy(),
        width: image.width,
        height: image.height,
        difference,
        output: output.as_deref().map(Path::to_string_lossy),
    };
    output::result(arguments.json, &report, || summary(&report))
}

fn has_8_bits(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    ["png", "jpg", "jpeg"].iter().any(|eight_bits| extension.eq_ignore_ascii_case(eight_bits))
}

fn summary(report: &Report<'_>) -> String {
    let Difference { mse, relmse, psnr, max_abs, peak, mean } = report.difference;
    let psnr = psnr.map_or("infinite".to_owned(), |psnr| format!("{psnr:.2} dB"));
    let mut text = format!(
        "mse      {mse:.6e}\nrelmse   {relmse:.6e}\npsnr     {psnr} (peak {peak})\nmax_abs  {max_abs:.6e}\nmean     {:.6} of a, {:.6} of b",
        mean[0], mean[1]
    );
    if let Some(path) = &report.output {
        text += &format!("\nwrote {path}");
    }
    text
}
