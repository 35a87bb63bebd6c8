//! Measured or otherwise tabulated reflectance.

use super::Brdf;
use crate::Error;
use crate::hemisphere::{bilinear, hemisphere_to_square, square_to_hemisphere, texel_centres};

/// A reflectance given at the texel centres of a map of views and a map of lights, bilinear between them in both.
///
/// Both maps are those of [`square_to_hemisphere`]. The table need not be reciprocal.
#[derive(Debug, Clone, PartialEq)]
pub struct TabulatedBrdf {
    sizes: [usize; 2],
    values: Vec<f32>,
}

impl TabulatedBrdf {
    /// A table `[view_size², light_size²]`, texels row by row, of values in 1/sr without the cosine.
    ///
    /// # Errors
    /// [`Error::TableSize`] if a size is 0 or the count of values is another; [`Error::Item`] names the first value that is
    /// negative or not finite.
    pub fn new(sizes: [usize; 2], values: Vec<f32>) -> Result<Self, Error> {
        let texels = |size: usize| size.checked_mul(size).filter(|&count| count > 0);
        let needed = texels(sizes[0]).zip(texels(sizes[1])).and_then(|(a, b)| a.checked_mul(b));
        if needed != Some(values.len()) {
            return Err(Error::TableSize { sizes, given: values.len() });
        }
        match values.iter().position(|value| !(value.is_finite() && *value >= 0.0)) {
            Some(item) => {
                let given = f64::from(values[item]);
                Err(Error::Item { what: "reflectance", item, given, accepted: "a finite number from 0" })
            }
            None => Ok(Self { sizes, values }),
        }
    }

    /// Tabulates another reflectance; `sizes` of the maps of views and lights.
    ///
    /// # Panics
    /// If a size is 0.
    #[must_use]
    pub fn tabulate(brdf: &dyn Brdf, sizes: [usize; 2]) -> Self {
        assert!(sizes.iter().all(|&size| size > 0), "a map of size 0 has no texels");
        let row =
            |view: [f64; 3]| texel_centres(sizes[1]).map(move |s| brdf.eval(view, square_to_hemisphere(s)) as f32);
        Self { sizes, values: texel_centres(sizes[0]).flat_map(|s| row(square_to_hemisphere(s))).collect() }
    }

    /// Texels along a side of the maps of views and lights.
    #[must_use]
    pub fn sizes(&self) -> [usize; 2] {
        self.sizes
    }
}

impl Brdf for TabulatedBrdf {
    fn eval(&self, view: [f64; 3], light: [f64; 3]) -> f64 {
        if view[2] < 0.0 || light[2] < 0.0 {
            return 0.0;
        }
        let [view_size, light_size] = self.sizes;
        let lights = bilinear(light_size, hemisphere_to_square(light));
        let row = |view: usize| {
            let start = view * light_size * light_size;
            lights.iter().map(|&(light, weight)| weight * f64::from(self.values[start + light])).sum::<f64>()
        };
        bilinear(view_size, hemisphere_to_square(view)).iter().map(|&(view, weight)| weight * row(view)).sum()
    }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    #[test]
    fn values_at_texel_centres_are_those_of_the_table() {
        let brdf = |view: [f64; 3], light: [f64; 3]| 1.0 + view[0] * light[1] + 0.3 * light[2];
        let table = TabulatedBrdf::tabulate(&brdf, [3, 5]);
        for view in texel_centres(3).map(square_to_hemisphere) {
            for light in texel_centres(5).map(square_to_hemisphere) {
                assert!((table.eval(view, light) - brdf(view, light)).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn a_finer_table_is_nearer() {
        let brdf = |view: [f64; 3], light: [f64; 3]| 1.0 + view[0] * light[1];
        let error = |size| {
            let table = TabulatedBrdf::tabulate(&brdf, [size, size]);
            let (view, light) = ([0.48, 0.36, 0.8], [0.6, -0.48, 0.64]);
            (table.eval(view, light) - brdf(view, light)).abs()
        };
        assert!(error(32) < 0.2 * error(8) && error(32) < 1e-2, "{} {}", error(32), error(8));
    }

    #[test]
    fn wrong_tables_are_named() {
        assert!(TabulatedBrdf::new([2, 2], vec![0.0; 15]).unwrap_err().to_string().contains("15"));
        assert!(TabulatedBrdf::new([0, 2], vec![]).is_err());
        assert!(TabulatedBrdf::new([usize::MAX, 2], vec![]).is_err());
        let mut values = vec![0.0; 16];
        for bad in [f32::NAN, f32::INFINITY, -1.0] {
            values[7] = bad;
            assert!(TabulatedBrdf::new([2, 2], values.clone()).unwrap_err().to_string().contains("reflectance 7 is"));
        }
    }
}
