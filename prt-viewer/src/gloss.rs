//! Glossy reflection of textures: which, and its factors.

use prt_bake::ViewMap;
use sh_core::Order;
use sh_fit::{Brdf, BrdfFactors, CookTorrance, FactorOptions, Fresnel, Ggx, Phong, factor_brdf};

/// A reflectance by name and parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Reflectance {
    Phong(Phong),
    CookTorrance(CookTorrance),
    Ggx(Ggx),
}

impl Reflectance {
    /// `phong:EXPONENT`, `cook-torrance:ROUGHNESS` or `ggx:ROUGHNESS`.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        const ACCEPTED: &str = "phong:EXPONENT, cook-torrance:ROUGHNESS or ggx:ROUGHNESS is needed, like ggx:0.3";
        let (name, parameter) = text.split_once(':').ok_or(ACCEPTED)?;
        let parameter: f64 = parameter.parse().map_err(|_| ACCEPTED)?;
        let brdf = match name {
            "phong" => Phong::new(parameter).map(Self::Phong),
            "cook-torrance" => CookTorrance::new(parameter, Fresnel::One).map(Self::CookTorrance),
            "ggx" => Ggx::new(parameter, Fresnel::One).map(Self::Ggx),
            _ => return Err(ACCEPTED.to_owned()),
        };
        brdf.map_err(|error| error.to_string())
    }

    fn brdf(&self) -> &dyn Brdf {
        match self {
            Self::Phong(brdf) => brdf,
            Self::CookTorrance(brdf) => brdf,
            Self::Ggx(brdf) => brdf,
        }
    }
}

/// A reflectance as a sum of products of functions of the view and of the light.
#[derive(Debug)]
pub(crate) struct Gloss(BrdfFactors);

impl Gloss {
    /// What the rows may leave of a reflectance where their number is not given, and the most rows then.
    const ERROR: f64 = 0.2;
    const MOST_ROWS: usize = 16;

    /// Factors a reflectance for light of an order.
    ///
    /// - `rows`: as many as [`Self::ERROR`] needs if `None`
    ///
    /// # Errors
    /// Those of the factoring.
    pub(crate) fn new(reflectance: Reflectance, order: Order, rows: Option<usize>) -> Result<Self, sh_fit::Error> {
        let factor = |rows| factor_brdf(reflectance.brdf(), order, rows, &FactorOptions::default());
        let Some(rows) = rows else {
            let all = factor(1)?;
            let needed = (1..Self::MOST_ROWS).find(|&rows| all.error(rows) <= Self::ERROR);
            return factor(needed.unwrap_or(Self::MOST_ROWS)).map(Self);
        };
        factor(rows).map(Self)
    }

    /// Relative error of the sum.
    pub(crate) fn error(&self) -> f64 {
        self.0.error(self.0.row_count)
    }

    /// The functions of the light, cosine included.
    pub(crate) fn responses(&self) -> Vec<Vec<f64>> {
        self.0.light.chunks_exact(self.0.order.coeff_count()).map(<[f64]>::to_vec).collect()
    }

    /// The functions of the view.
    pub(crate) fn into_view_map(self) -> ViewMap {
        ViewMap { size: self.0.map_size, values: self.0.view_map }
    }
}
