//! Height fields from images.

use std::path::Path;

use super::field::HeightField;
use crate::image::linear_to_srgb;
use crate::input::extension;
use crate::{Error, Image};

/// Weights of red, green and blue in the brightness of a pixel (ITU-R BT.709).
const LUMA: [f64; 3] = [0.2126, 0.7152, 0.0722];

impl HeightField {
    /// A field from an image: brightness 0 is height 0, brightness 1 is `height_scale`, in units of the tile's width.
    ///
    /// The brightness of PNG and JPEG is that of the stored numbers, not made linear, in all of 16 bits where there are; HDR and EXR are
    /// taken as they are and may go beyond 1. Row 0 is the image's top row.
    ///
    /// - `size`: columns and rows to resample to, by averaging over each texel's area (which repeats pixels where there are fewer);
    ///   `None` keeps the image's own
    ///
    /// # Errors
    /// Those of [`Image::load`] and of [`HeightField::new`].
    ///
    /// Source: "the simple technique of mapping albedo to height", [SLS05](sh_core#references) section 6.
    pub fn from_image(path: &Path, height_scale: f32, size: Option<[usize; 2]>) -> Result<Self, Error> {
        let image = Image::load(path)?;
        let is_stored_linear = !matches!(extension(path).as_str(), "png" | "jpg" | "jpeg");
        let stored = |value: f32| f64::from(if is_stored_linear { value } else { linear_to_srgb(value) });
        let brightness = |pixel: &[f32; 3]| pixel.iter().zip(LUMA).map(|(&value, weight)| weight * stored(value)).sum();
        let grey: Vec<f64> = image.pixels.iter().map(brightness).collect();
        let [width, height] = size.unwrap_or([image.width, image.height]);
        if width.saturating_mul(height) > Self::MAX_TEXELS {
            return Self::new(width, height, Vec::new());
        }
        let columns = area_weights(image.width, width);
        let rows = area_weights(image.height, height);
        let heights = resample(&grey, image.width, &columns, &rows);
        Self::new(width, height, heights.iter().map(|value| (value * f64::from(height_scale)) as f32).collect())
    }
}

/// For each new cell the old cells that it covers, with weights that add up to 1.
fn area_weights(old: usize, new: usize) -> Vec<Vec<(usize, f64)>> {
    let scale = old as f64 / new as f64;
    let cell = |index: usize| {
        let (start, end) = (index as f64 * scale, (index + 1) as f64 * scale);
        let last = (end.ceil() as usize).clamp(1, old);
        let covered = (start as usize..last).map(|k| (k, (end.min((k + 1) as f64) - start.max(k as f64)) / scale));
        covered.filter(|&(_, weight)| weight > 0.0).collect()
    };
    (0..new).map(cell).collect()
}

fn resample(grey: &[f64], width: usize, columns: &[Vec<(usize, f64)>], rows: &[Vec<(usize, f64)>]) -> Vec<f64> {
    let weighted_row = |row: usize, columns: &[(usize, f64)]| -> f64 {
        columns.iter().map(|&(column, weight)| weight * grey[row * width + column]).sum()
    };
    let texel = |rows: &[(usize, f64)], columns: &[(usize, f64)]| -> f64 {
        rows.iter().map(|&(row, weight)| weight * weighted_row(row, columns)).sum()
    };
    rows.iter().flat_map(|rows| columns.iter().map(|columns| texel(rows, columns))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_are_shared_out_completely() {
        for (old, new) in [(1, 1), (7, 3), (3, 7), (512, 100), (5, 1), (1, 5)] {
            let weights = area_weights(old, new);
            let mut received = vec![0.0; old];
            for cell in &weights {
                assert!((cell.iter().map(|(_, weight)| weight).sum::<f64>() - 1.0).abs() < 1e-12, "{old} {new}");
                cell.iter().for_each(|&(k, weight)| received[k] += weight);
            }
            assert!(received.iter().all(|sum| (sum - new as f64 / old as f64).abs() < 1e-12), "{old} {new}");
        }
        // Cell 1 of 3 covers 7/3 … 14/3 of 7: two thirds of cell 2, all of 3, two thirds of 4.
        let expected = [(2, 2.0 / 7.0), (3, 3.0 / 7.0), (4, 2.0 / 7.0)];
        for ((k, weight), (expected_k, expected)) in area_weights(7, 3)[1].iter().zip(expected) {
            assert!(*k == expected_k && (weight - expected).abs() < 1e-12);
        }
    }
}
