//! Zonal-lobe fits of transfer vectors, after [SLS05](sh_core#references).
//!
//! A sum of zonal lobes about a few axes approximates a transfer vector and can be rotated with a deforming surface by rotating
//! its axes. [`fit_lobes`] finds the lobes of one vector, [`fit_lobes_many`] those of a mesh or texture, and
//! [`optimal_linear_lobe`] a single lobe without a search.
//!
//! ```
//! use sh_core::Order;
//! use sh_fit::{FitOptions, Neighbours, fit_lobes_many};
//!
//! // Two points with the transfer of an open sky, above which the horizon tilts.
//! let order = Order::new(6)?;
//! let mut cosine = [0.0_f32; 6];
//! sh_core::clamped_cosine(&mut cosine);
//! let mut transfer = vec![0.0; 2 * 36];
//! sh_core::expand_zonal(order, &cosine, [0.0, 0.6, 0.8], &mut transfer[..36]);
//! sh_core::expand_zonal(order, &cosine, [0.0, 0.8, 0.6], &mut transfer[36..]);
//!
//! let neighbours = Neighbours::grid(2, 1, false);
//! let options = FitOptions { lobe_count: 1, ..FitOptions::default() };
//! let (mut lobes, report) = fit_lobes_many(order, 1, &transfer, Some(&neighbours), &options, &|_| ())?;
//! assert!(report.relative_error < 1e-4);
//! // The surface turns by 90° about x: one axis per lobe turns with it.
//! lobes.rotate(0, [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]);
//! assert!((lobes.axes_of(0)[0][1] + 0.8).abs() < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # How lobes are found
//!
//! With the axes fixed, bands decouple and the coefficients follow by linear least squares, so only the axes are searched for
//! ([`Method::VariableProjection`]): by Newton's method, since the second derivatives of what is left are closed-form too. The
//! first start adds one lobe after the other where it takes most of what is left; further ones begin with another axis. On a
//! surface the axes of the neighbours are tried afterwards. A small penalty keeps lobes from cancelling with huge coefficients.
//!
//! Lobes of one point are ordered by their energy, and their axes lie on the side of the linear band. Those of two points do not
//! correspond: interpolate what they make of the light and not the lobes, or make them correspond with [`make_coherent`].
//!
//! # What else is here
//!
//! | to | with |
//! |---|---|
//! | interpolate lobes on a mesh | [`make_coherent`], [`match_lobes`], [`interpolate`], [`interpolation_error`] |
//! | fit lobes that are bilinear over a texture or over parameters | [`Grid`], [`fit_grid`] |
//! | shade glossy surfaces | [`Brdf`], [`factor_brdf`]; views by [`square_to_hemisphere`] |
//! | shade leaves and wings without a simulation | [`membrane_lobe`], [`membrane_lobes`] |
//! | shade wrinkles by place and depth | [`WrinkleModel`]; the simulation is [`groove_transfer`] |
//!
//! # Features
//!
//! | feature | default | gives |
//! |---|---|---|
//! | `parallel` | yes | several threads; without it the same bytes from one |

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
