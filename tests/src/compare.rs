//! Holding a picture against a reference away from silhouettes.

use prt_bake::Image;

/// How far a picture is from a reference.
#[derive(Debug, Clone, Copy)]
pub struct Comparison {
    /// Sum of squared differences over sum of squared values of the reference, over the pixels compared and the three channels.
    pub relative_mse: f64,
    /// Mean over pixels and channels of the squared difference over the squared value: every pixel counts alike.
    pub mean_relative_square: f64,
    /// Share of the picture that was compared.
    pub share: f64,
}

/// Compares the pixels all of whose neighbours in a window of 5 by 5 belong to the same surface: covered, with distances that
/// change from neighbour to neighbour by less than `step` of the distance.
///
/// - `distance`: distance from the eye along the view axis for each pixel, infinite where nothing is seen
///
/// # Panics
/// If the sizes differ.
#[must_use]
pub fn compare_inside(image: &Image, reference: &Image, distance: &[f32], step: f32) -> Comparison {
    assert_eq!((image.width, image.height), (reference.width, reference.height), "pictures of one size");
    assert_eq!(distance.len(), image.pixels.len(), "a distance for each pixel");
    let (mut difference, mut signal, mut relative, mut count) = (0.0, 0.0, 0.0, 0);
    for y in 0..image.height {
        for x in 0..image.width {
            if !is_inside(distance, image.width, image.height, x, y, step) {
                continue;
            }
            count += 1;
            let place = y * image.width + x;
            for (a, b) in image.pixels[place].iter().zip(reference.pixels[place]) {
                let (a, b) = (f64::from(*a), f64::from(b));
                difference += (a - b) * (a - b);
                signal += b * b;
                relative += ((a - b) / b).powi(2) / 3.0;
            }
        }
    }
    Comparison {
        relative_mse: difference / signal,
        mean_relative_square: relative / f64::from(count),
        share: f64::from(count) / image.pixels.len() as f64,
    }
}

fn is_inside(distance: &[f32], width: usize, height: usize, x: usize, y: usize, step: f32) -> bool {
    if x < 2 || y < 2 || x + 2 >= width || y + 2 >= height {
        return false;
    }
    let at = |x: usize, y: usize| distance[y * width + x];
    let is_smooth = |a: f32, b: f32| a.is_finite() && (a - b).abs() <= step * a.min(b);
    (y - 2..=y + 2).all(|row| (x - 2..x + 2).all(|column| is_smooth(at(column, row), at(column + 1, row))))
        && (y - 2..y + 2).all(|row| (x - 2..=x + 2).all(|column| is_smooth(at(column, row), at(column, row + 1))))
}
