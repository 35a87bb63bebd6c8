//! The order that a scene needs.

use sh_core::Order;

use super::pilot::{bake_vertices, spread};
use crate::{BakeOptions, Error, Mesh};

/// Where the energy of transfer lies, band by band, at some vertices.
#[derive(Debug, Clone, PartialEq)]
pub struct OrderReport {
    /// Share of the squared length of the transfer vectors that each band has, `[n]`; adds to 1.
    pub transfer: Vec<f64>,
    /// Share of the squared length of the light vectors that each band has, `[n]`; `None` without a light.
    pub light: Option<Vec<f64>>,
    /// Mean square of what each band adds to exit radiance, over that of exit radiance, `[n]`; `None` without a light. Bands can cancel, so
    /// these need not add to 1.
    pub radiance: Option<Vec<f64>>,
    /// Relative root-mean-square error of order 1, 2, ..., beside order [`OrderReport::PILOT_ORDER`]: `[n]`. With a light, the error of exit
    /// radiance; without, of the transfer vectors, which is that of radiance under light that is equally strong in all bands.
    pub errors: Vec<f64>,
    /// The smallest order whose error is at most the tolerance.
    pub order: Order,
}

impl OrderReport {
    /// Tolerance with a light: an error of one percent of the radiance, RMS. Five meshes need order 6 to 9 for it in the Uffizi gallery, 5 to 8 at
    /// Pisa, and 13 or more in Grace Cathedral, whose windows are small and bright.
    pub const TOLERANCE: f64 = 0.01;
    /// Tolerance without a light. Natural light is much weaker in high bands than in low ones; so this gives order 5 (`lilium`, `nefertiti`) to
    /// 11 (`dragon_100k`), near to what [`TOLERANCE`](Self::TOLERANCE) gives under daylight.
    pub const TRANSFER_TOLERANCE: f64 = 0.1;
    /// Order that stands for all.
    pub const PILOT_ORDER: usize = 16;
}

/// Vertices that are looked at.
const SAMPLES: usize = 384;

/// Rays of each: their error at the order of the pilot is about 0.004, well below what is looked for.
const RAYS: usize = 4096;

/// Finds the order that a scene needs, from a pilot over some hundred vertices.
///
/// - `light`: `[3, m²]` for any order m, in the frame of the scene, as [`Environment::light`](crate::Environment::light) gives; `None` for transfer
///   alone
/// - `tolerance`: largest relative error; `None` takes [`OrderReport::TOLERANCE`] or [`OrderReport::TRANSFER_TOLERANCE`]
///
/// Interreflections are left out: they are smooth, and lower the error. The order of `options` is not used.
///
/// # Errors
/// If an option is out of range, the light is not `[3, m²]`, or the tolerance is not above 0.
pub fn recommend_order(
    mesh: &Mesh,
    options: &BakeOptions,
    light: Option<&[f32]>,
    tolerance: Option<f64>,
) -> Result<OrderReport, Error> {
    options.validate()?;
    let fallback = if light.is_some() { OrderReport::TOLERANCE } else { OrderReport::TRANSFER_TOLERANCE };
    let tolerance = tolerance.unwrap_or(fallback);
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return Err(Error::Option(format!("a tolerance of {tolerance} for the order; it is above 0")));
    }
    let order = Order::new(OrderReport::PILOT_ORDER).expect("16 is an order");
    let light = light.map(|light| padded(light, order)).transpose()?;
    let pilot_options = BakeOptions { order, rays_per_vertex: RAYS, target_error: None, ..options.clone() };
    let transfer = bake_vertices(mesh, &pilot_options, &spread(mesh.positions().len(), SAMPLES))?.transfer;
    let rows = || transfer.values.chunks_exact(order.coeff_count());
    let bands = energy(order, rows());
    let (radiance, errors) = match &light {
        None => (None, tails(&bands)),
        Some(light) => {
            let (radiance, errors) = radiance(order, rows(), light);
            (Some(radiance), errors)
        }
    };
    let needed = 1 + errors.iter().position(|&error| error <= tolerance).unwrap_or(order.get() - 1);
    Ok(OrderReport {
        transfer: bands,
        light: light.map(|light| energy(order, light.chunks_exact(order.coeff_count()))),
        radiance,
        errors,
        order: Order::new(needed).expect("1 to 16 is an order"),
    })
}

/// A light `[3, m²]` as `[3, n²]`, with zeros or cut off.
fn padded(light: &[f32], order: Order) -> Result<Vec<f32>, Error> {
    let count = light.len() / 3;
    let is_whole = count > 0 && light.len().is_multiple_of(3) && count.isqrt().pow(2) == count;
    if !is_whole || light.iter().any(|value| !value.is_finite()) {
        let given = light.len();
        return Err(Error::Option(format!(
            "a light of {given} coefficients; 3 m² finite ones are needed for an order m"
        )));
    }
    let used = count.min(order.coeff_count());
    let mut padded = vec![0.0; 3 * order.coeff_count()];
    for (out, channel) in padded.chunks_exact_mut(order.coeff_count()).zip(light.chunks_exact(count)) {
        out[..used].copy_from_slice(&channel[..used]);
    }
    Ok(padded)
}

/// Share of the squared length of all rows that each band has.
fn energy<'a>(order: Order, rows: impl Iterator<Item = &'a [f32]>) -> Vec<f64> {
    let mut total = vec![0.0; order.get()];
    let mut bands = vec![0.0_f32; order.get()];
    for row in rows {
        sh_core::band_energy(order, row, &mut bands);
        total.iter_mut().zip(&bands).for_each(|(total, &band)| *total += f64::from(band));
    }
    let sum = total.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    total.iter().map(|band| band / sum).collect()
}

/// `√ Σ_{l >= n} E_l` for n = 1, 2, ...
fn tails(bands: &[f64]) -> Vec<f64> {
    (1..=bands.len()).map(|n| bands[n..].iter().fold(0.0, |sum, band| sum + band).sqrt()).collect()
}

/// What each band adds to radiance, and the error of each order, both relative to radiance.
fn radiance<'a>(order: Order, rows: impl Iterator<Item = &'a [f32]>, light: &[f32]) -> (Vec<f64>, Vec<f64>) {
    let (mut bands, mut errors, mut total) = (vec![0.0; order.get()], vec![0.0; order.get()], 0.0);
    for row in rows {
        for light in light.chunks_exact(order.coeff_count()) {
            // What the bands from l on add.
            let mut rest = 0.0;
            for (l, band) in order.bands().rev() {
                errors[l] += rest * rest;
                let part = sh_core::dot(&row[band.clone()], &light[band]);
                bands[l] += f64::from(part).powi(2);
                rest += f64::from(part);
            }
            total += rest * rest;
        }
    }
    let relative = |value: f64| value / f64::max(total, f64::MIN_POSITIVE);
    (bands.into_iter().map(relative).collect(), errors.into_iter().map(|error| relative(error).sqrt()).collect())
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]

    use super::*;
    use crate::{MeshOptions, MeshSource};

    /// One triangle, which sees the whole sky.
    fn open() -> Mesh {
        let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let source = MeshSource { positions, triangles: vec![[0, 1, 2]], ..MeshSource::default() };
        Mesh::new(source, &MeshOptions::default()).unwrap().0
    }

    fn recommend(light: Option<&[f32]>, tolerance: f64) -> OrderReport {
        recommend_order(&open(), &BakeOptions::default(), light, Some(tolerance)).unwrap()
    }

    #[test]
    fn the_open_sky_has_the_energy_of_the_clamped_cosine() {
        let report = recommend(None, 0.05);
        // ∫ max(cos, 0)² = 2π/3; of its energy bands 0 to 2 have 3/8, 1/2 and 15/128 (Ramamoorthi and Hanrahan 2001: 37.5, 50 and 11.7 %).
        for (band, expected) in [3.0 / 8.0, 0.5, 15.0 / 128.0, 0.0].into_iter().enumerate() {
            // The bands beyond 15, which are left out, have 1e-4 of the energy.
            assert!((report.transfer[band] - expected).abs() < 1e-4, "{band}: {:?}", report.transfer);
        }
        // 0.88 % of energy beyond band 2, a length of 9 %: order 3 is not enough for 5 %; band 4 has 0.7 %.
        assert!((report.errors[2] - (1.0_f64 - 127.0 / 128.0).sqrt()).abs() < 1e-3, "{:?}", report.errors);
        assert_eq!((report.order.get(), report.light), (5, None));
        assert_eq!(recommend(None, 0.1).order.get(), 3);
    }

    #[test]
    fn a_light_of_few_bands_needs_few() {
        let constant = [1.0_f32, 2.0, 3.0];
        let report = recommend(Some(&constant), 1e-6);
        assert_eq!(report.order.get(), 1);
        assert_eq!((report.light.unwrap()[0], report.radiance.unwrap()[0]), (1.0, 1.0));
        // Only y_20 = index 6 of 9, in the red channel: the normal is the axis.
        let mut light = vec![0.0; 27];
        light[6] = 1.0;
        let report = recommend(Some(&light), 1e-6);
        assert_eq!((report.order.get(), report.errors[1], report.errors[2]), (3, 1.0, 0.0));
    }

    #[test]
    fn what_is_no_light_is_an_error() {
        let recommend =
            |light: &[f32], tolerance| recommend_order(&open(), &BakeOptions::default(), Some(light), tolerance);
        for light in [&[][..], &[1.0], &[1.0; 6], &[f32::NAN; 3]] {
            assert!(matches!(recommend(light, None), Err(Error::Option(_))), "{light:?}");
        }
        assert!(recommend(&[1.0; 3], Some(0.0)).is_err() && recommend(&[1.0; 3], Some(f64::NAN)).is_err());
    }
}
