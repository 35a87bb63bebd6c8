//! The matter inside a translucent patch.

use crate::Error;

/// A homogeneous medium below the surface.
///
/// Light in it takes random walks: it enters by Snell's law with the chance that Fresnel's formula for unpolarised light leaves, flies as far
/// as `exp(−σ_t s)` lets it, loses the share `σ_a/σ_t` at each collision and turns by Henyey and Greenstein's phase function. The
/// surface, and the plane below if there is one, reflect from inside too, totally beyond the critical angle. Light that comes out and meets
/// the relief again goes on there. What the surface mirrors before light enters is part of the result; an index of 1 mirrors nothing.
///
/// Far from all boundaries (8 transport mean free paths) in a medium that absorbs less than 2 % per transport mean free path, walks take
/// spheres at once by the law of diffusion; all else is unbiased but for paths that are given up after
/// [`ScatteringReport::MAX_EVENTS`](crate::ScatteringReport::MAX_EVENTS) flights, whose weight is reported.
///
/// Coefficients are per tile width and per channel (red, green, blue): `σ_s = 20` means that light is scattered about 20 times on a
/// straight way through a tile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Medium {
    /// Scattering coefficient `σ_s`, per tile width.
    pub sigma_s: [f32; 3],
    /// Absorption coefficient `σ_a`, per tile width.
    pub sigma_a: [f32; 3],
    /// Mean cosine of the scattering angle (Henyey-Greenstein), between -1 and 1, both excluded: positive is forward.
    pub g: f32,
    /// Index of refraction relative to what is outside.
    pub ior: f32,
}

impl Medium {
    /// Largest coefficient, per tile width.
    pub const MAX_SIGMA: f32 = 1e6;
    /// Largest `|g|`.
    pub const MAX_G: f32 = 0.999;
    /// Smallest and largest index of refraction.
    pub const IOR: [f32; 2] = [0.25, 4.0];

    /// The same coefficients in all channels.
    #[must_use]
    pub fn grey(sigma_s: f32, sigma_a: f32) -> Self {
        Self { sigma_s: [sigma_s; 3], sigma_a: [sigma_a; 3], ..Self::default() }
    }

    /// Whether the channels differ.
    pub(super) fn is_colored(&self) -> bool {
        [self.sigma_s, self.sigma_a].iter().any(|[r, g, b]| r != g || g != b)
    }

    pub(super) fn validate(&self) -> Result<(), Error> {
        let fail = |reason: String| Err(Error::Option(reason));
        for (name, sigma) in [("sigma_s", self.sigma_s), ("sigma_a", self.sigma_a)] {
            if !sigma.iter().all(|value| (0.0..=Self::MAX_SIGMA).contains(value)) {
                return fail(format!("{name} {sigma:?} must lie between 0 and {}", Self::MAX_SIGMA));
            }
        }
        if !(0.0..=Self::MAX_G).contains(&self.g.abs()) {
            return fail(format!("g {} must lie between -{} and {}", self.g, Self::MAX_G, Self::MAX_G));
        }
        let [lowest, highest] = Self::IOR;
        if !(lowest..=highest).contains(&self.ior) {
            return fail(format!("index of refraction {} must lie between {lowest} and {highest}", self.ior));
        }
        Ok(())
    }
}

impl Default for Medium {
    /// Wax-like: `σ_s` 40, `σ_a` 0.4 per tile width in all channels, isotropic, index of refraction 1.3.
    fn default() -> Self {
        Self { sigma_s: [40.0; 3], sigma_a: [0.4; 3], g: 0.0, ior: 1.3 }
    }
}
