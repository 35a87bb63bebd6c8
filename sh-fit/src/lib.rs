//! Zonal-lobe fits of transfer vectors, after [SLS05].
//!
//! This version holds the one fit that needs no solver, the optimal linear lobe; sums of several lobes come with the general fit.
//!
//! [SLS05]: P.-P. Sloan, B. Luna, J. Snyder. *Local, Deformable Precomputed Radiance Transfer*. SIGGRAPH 2005.

mod linear_lobe;

pub use linear_lobe::{ZonalLobe, optimal_linear_lobe};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
