//! Zonal-lobe fits of transfer vectors, after [SLS05](sh_core#references).
//!
//! A sum of zonal lobes about a few axes approximates a transfer vector and can be rotated with a deforming surface by rotating
//! its axes. [`fit_lobes`] finds the lobes of one vector, [`fit_lobes_many`] those of a mesh or texture;
//! [`optimal_linear_lobe`] needs no search and finds a single lobe.

mod blend;
mod brdf;
mod coherent;
mod conjugate;
mod error;
mod field;
mod fit;
mod grid;
mod groove;
mod hemisphere;
mod linear_lobe;
mod lobes;
mod membrane;
mod misfit;
mod neighbours;
mod options;
mod parallel;
mod problem;
mod random;
mod report;
mod search;
mod solver;
mod start;
mod wrinkle;

pub use blend::{Blend, interpolate};
pub use brdf::{
    Brdf, BrdfFactors, CookTorrance, FactorOptions, Fresnel, Ggx, Lambert, Phong, TabulatedBrdf, factor_brdf,
};
pub use coherent::{BetweenError, CoherentOptions, CoherentReport, interpolation_error, make_coherent, match_lobes};
pub use error::Error;
pub use fit::{LobeFit, fit_lobes, fit_lobes_many};
pub use grid::{Grid, GridOptions, GridReport, fit_grid};
pub use groove::{Groove, groove_transfer};
pub use hemisphere::{
    disk_to_hemisphere, disk_to_square, hemisphere_to_disk, hemisphere_to_square, square_to_disk, square_to_hemisphere,
};
pub use linear_lobe::{ZonalLobe, optimal_linear_lobe};
pub use lobes::{LobeSet, explicit_count};
pub use membrane::{membrane_lobe, membrane_lobes};
pub use misfit::relative_error;
pub use neighbours::Neighbours;
pub use options::{FitOptions, Method};
pub use report::{Distribution, FitReport, Stop, StopCounts};
pub use wrinkle::{WrinkleModel, WrinkleOptions, WrinkleReport};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
