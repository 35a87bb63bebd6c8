//! How far an image is from a reference.

use anyhow::ensure;
use prt_bake::Image;
use serde::Serialize;

/// Added to the square of the reference in the relative error, so that black pixels do not weigh without limit. The value is the one that
/// image viewers for rendering (tev among them) and denoising papers use.
const RELATIVE_FLOOR: f64 = 1e-2;

/// Differences of an image `a` from a reference `b`, over all pixels and channels, of linear values.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct Difference {
    /// Mean of `(a − b)²`.
    pub(crate) mse: f64,
    /// Mean of `(a − b)² / (b² + 0.01)`.
    pub(crate) relmse: f64,
    /// `10 log10(peak² / mse)`, decibels; `None` if the images are equal.
    pub(crate) psnr: Option<f64>,
    /// Largest `|a − b|`.
    pub(crate) max_abs: f64,
    /// What PSNR counts as full signal.
    pub(crate) peak: f64,
    /// Mean of `a`, and of `b`.
    pub(crate) mean: [f64; 2],
}

impl Difference {
    /// - `peak`: what PSNR counts as full signal; the largest value of the reference if `None`
    ///
    /// # Errors
    /// If the sizes differ or there are no pixels.
    pub(crate) fn new(a: &Image, b: &Image, peak: Option<f64>) -> anyhow::Result<Self> {
        check_sizes(a, b)?;
        let values =
            || a.pixels.as_flattened().iter().zip(b.pixels.as_flattened()).map(|(&a, &b)| (f64::from(a), f64::from(b)));
        let mean = |f: fn((f64, f64)) -> f64| values().map(f).sum::<f64>() / (3 * a.pixels.len()) as f64;
        let mse = mean(|(a, b)| (a - b).powi(2));
        let peak = peak.unwrap_or_else(|| values().map(|(_, b)| b).fold(0.0, f64::max));
        Ok(Self {
            mse,
            relmse: mean(|(a, b)| (a - b).powi(2) / (b * b + RELATIVE_FLOOR)),
            psnr: Some(10.0 * (peak * peak / mse).log10()).filter(|psnr| psnr.is_finite()),
            max_abs: values().map(|(a, b)| (a - b).abs()).fold(0.0, f64::max),
            peak,
            mean: [mean(|(a, _)| a), mean(|(_, b)| b)],
        })
    }
}

/// `|a − b| / |b|`, L2 over all pixels and channels.
///
/// # Errors
/// If the sizes differ or there are no pixels.
pub(crate) fn relative_l2(a: &Image, b: &Image) -> anyhow::Result<f64> {
    let Difference { mse, .. } = Difference::new(a, b, None)?;
    let values = b.pixels.as_flattened();
    let signal = values.iter().map(|&value| f64::from(value).powi(2)).sum::<f64>() / values.len() as f64;
    Ok(if signal > 0.0 { (mse / signal).sqrt() } else { 0.0 })
}

/// `scale · |a − b|` per channel.
pub(crate) fn picture(a: &Image, b: &Image, scale: f32) -> Image {
    let pixel = |(a, b): (&[f32; 3], &[f32; 3])| std::array::from_fn(|i| scale * (a[i] - b[i]).abs());
    Image { width: a.width, height: a.height, pixels: a.pixels.iter().zip(&b.pixels).map(pixel).collect() }
}

fn check_sizes(a: &Image, b: &Image) -> anyhow::Result<()> {
    let sizes = format!("{} x {} and {} x {}", a.width, a.height, b.width, b.height);
    ensure!([a.width, a.height] == [b.width, b.height], "the images differ in size, {sizes}");
    ensure!(!a.pixels.is_empty(), "the images have no pixels");
    Ok(())
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;

    fn image(pixels: &[[f32; 3]]) -> Image {
        Image { width: pixels.len(), height: 1, pixels: pixels.to_vec() }
    }

    #[test]
    fn metrics_are_their_formulas() {
        let (a, b) = (image(&[[1.0, 0.0, 3.0], [0.5; 3]]), image(&[[1.0, 0.5, 2.0], [0.5; 3]]));
        let difference = Difference::new(&a, &b, None).unwrap();
        assert!((difference.mse - 1.25 / 6.0).abs() < 1e-12);
        assert!((difference.relmse - (0.25 / 0.26 + 1.0 / 4.01) / 6.0).abs() < 1e-12);
        assert_eq!((difference.max_abs, difference.peak), (1.0, 2.0));
        assert!((difference.psnr.unwrap() - 10.0 * (4.0 * 6.0 / 1.25_f64).log10()).abs() < 1e-12);
        assert_eq!(difference.mean, [5.5 / 6.0, 5.0 / 6.0]);
        assert_eq!(picture(&a, &b, 2.0).pixels[0], [0.0, 1.0, 2.0]);
    }

    #[test]
    fn equal_images_have_no_difference_and_no_psnr() {
        let a = image(&[[0.25; 3]]);
        let difference = Difference::new(&a, &a, Some(1.0)).unwrap();
        assert_eq!((difference.mse, difference.relmse, difference.max_abs, difference.psnr), (0.0, 0.0, 0.0, None));
    }

    #[test]
    fn sizes_must_agree() {
        let error = Difference::new(&image(&[[0.0; 3]]), &image(&[[0.0; 3]; 2]), None).unwrap_err();
        assert_eq!(error.to_string(), "the images differ in size, 1 x 1 and 2 x 1");
    }
}
