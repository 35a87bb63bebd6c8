//! Zonal-lobe fits of transfer vectors, after [SLS05](sh_core#references).
//!
//! This version holds the one fit that needs no solver, the optimal linear lobe; sums of several lobes come with the general fit.

mod linear_lobe;

pub use linear_lobe::{ZonalLobe, optimal_linear_lobe};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
