//! What to bake of a patch, and how.

use sh_core::Order;

use super::field::HeightField;
use super::medium::Medium;
use crate::{BakeOptions, Error};

/// Settings of a bake of a height field.
#[derive(Debug, Clone, PartialEq)]
pub struct PatchOptions {
    /// Number of bands `n`; 1 to [`BakeOptions::MAX_ORDER`].
    pub order: Order,
    /// Directions over the hemisphere above each texel, or paths that start there if the patch is translucent; 1 to
    /// [`BakeOptions::MAX_RAYS`].
    pub rays_per_texel: usize,
    /// Diffuse interreflections that are followed; 0 is direct light alone. Needs `shadowed`. Must be 0 for a translucent patch,
    /// whose paths follow them all.
    pub bounces: usize,
    /// Whether the relief shadows itself. Without, transfer follows from the normals alone, exactly, and no ray is traced.
    pub shadowed: bool,
    /// Diffuse albedo of the whole patch, red, green, blue: what one texel reflects to another. An opaque patch alone has one.
    pub albedo: [f32; 3],
    /// The medium below the surface; `None` is an opaque patch.
    pub scattering: Option<Medium>,
    /// The medium ends in a plane this far below height 0, in units of the tile's width; `None` is without end. The plane must lie
    /// below the whole surface.
    pub thickness: Option<f32>,
    /// Glossy rows; empty is the one diffuse row, cos/π.
    ///
    /// Each is an expansion `[n_out²]` of a response `ψ_r(s)`, cosine included, in the frame of the texel's own micro-surface: z is
    /// [`HeightField::normal`], x the tile's x made perpendicular to it, y = z × x. It counts on the hemisphere above the micro-surface alone:
    /// row `r` of the transfer is `∫ V(s) ψ_r(s) y(s) ds` over that hemisphere. With bounces the other texels reflect diffusely.
    pub responses: Vec<Vec<f64>>,
    /// Same seed and options, same bytes, for any number of threads.
    pub seed: u64,
    /// Number of threads; all that the machine has if `None`.
    pub threads: Option<usize>,
}

impl PatchOptions {
    /// Most numbers of a result: 4 GiB.
    pub const MAX_VALUES: usize = 1 << 30;

    /// A quick look: 256 rays, order 5.
    #[must_use]
    pub fn preview() -> Self {
        Self { rays_per_texel: 256, order: Order::new(5).expect("5 is an order"), ..Self::default() }
    }

    /// A thin translucent sheet, lit from both sides: the default [`Medium`], down to 0.05 below height 0.
    #[must_use]
    pub fn thin() -> Self {
        Self { scattering: Some(Medium::default()), thickness: Some(0.05), ..Self::default() }
    }

    /// A translucent block without end, lit from above: the default [`Medium`].
    #[must_use]
    pub fn thick() -> Self {
        Self { scattering: Some(Medium::default()), ..Self::default() }
    }

    /// Number of rows of the result.
    #[must_use]
    pub fn row_count(&self) -> usize {
        self.responses.len().max(1)
    }

    /// Number of channels of the result: 3 if the channels differ, else 1.
    #[must_use]
    pub fn channel_count(&self) -> usize {
        let [r, g, b] = self.albedo;
        let is_colored = match self.scattering {
            Some(medium) => medium.is_colored(),
            None => self.bounces > 0 && (r != g || g != b),
        };
        if is_colored { 3 } else { 1 }
    }

    pub(super) fn validate(&self, field: &HeightField) -> Result<(), Error> {
        self.as_bake_options().validate()?;
        let fail = |reason: String| Err(Error::Option(reason));
        if !self.albedo.iter().all(|channel| (0.0..=1.0).contains(channel)) {
            return fail(format!("albedo {:?} must lie between 0 and 1", self.albedo));
        }
        let values = field.texel_count() * self.row_count() * self.channel_count() * self.order.coeff_count();
        if values > Self::MAX_VALUES {
            return fail(format!("a result of {values} numbers; at most {} are possible", Self::MAX_VALUES));
        }
        self.validate_responses()?;
        self.validate_scattering(field)
    }

    fn as_bake_options(&self) -> BakeOptions {
        BakeOptions {
            order: self.order,
            rays_per_vertex: self.rays_per_texel,
            shadowed: self.shadowed,
            bounces: self.bounces,
            seed: self.seed,
            threads: self.threads,
            ..BakeOptions::default()
        }
    }

    fn validate_responses(&self) -> Result<(), Error> {
        for (row, response) in self.responses.iter().enumerate() {
            let n = response.len().isqrt();
            if n == 0 || n * n != response.len() || n > BakeOptions::MAX_ORDER {
                return Err(Error::Option(format!(
                    "response {row} has {} coefficients; n² for an order n of 1 to {} are needed",
                    response.len(),
                    BakeOptions::MAX_ORDER
                )));
            }
            if let Some(i) = response.iter().position(|value| !value.is_finite()) {
                return Err(Error::Option(format!("coefficient {i} of response {row} is {}", response[i])));
            }
        }
        Ok(())
    }

    fn validate_scattering(&self, field: &HeightField) -> Result<(), Error> {
        let fail = |reason: String| Err(Error::Option(reason));
        let Some(medium) = self.scattering else {
            return match self.thickness {
                Some(_) => fail("a thickness without a medium: an opaque patch has none".to_owned()),
                None => Ok(()),
            };
        };
        medium.validate()?;
        if !self.shadowed || self.bounces > 0 {
            return fail("a translucent patch is shadowed, and its paths follow all bounces: set none".to_owned());
        }
        if !self.responses.is_empty() {
            return fail("responses with a medium: a translucent patch has one row".to_owned());
        }
        let [lowest, _] = field.range();
        match self.thickness {
            Some(thickness) if !(-thickness < lowest && thickness <= HeightField::MAX_HEIGHT) => fail(format!(
                "thickness {thickness}: the plane below must lie under the lowest height, {lowest}, and not under -{}",
                HeightField::MAX_HEIGHT
            )),
            _ => Ok(()),
        }
    }
}

impl Default for PatchOptions {
    /// An opaque patch of albedo 0.8: shadowed diffuse transfer of order 6 from 4,096 rays a texel, direct light alone, seed 0, all
    /// threads.
    fn default() -> Self {
        let BakeOptions { order, rays_per_vertex, shadowed, bounces, seed, threads, .. } = BakeOptions::default();
        Self {
            order,
            rays_per_texel: rays_per_vertex,
            bounces,
            shadowed,
            albedo: [0.8; 3],
            scattering: None,
            thickness: None,
            responses: Vec::new(),
            seed,
            threads,
        }
    }
}
