//! Angular scaling of expansions about an axis.

#[cfg(feature = "alloc")]
mod about;
#[cfg(feature = "alloc")]
mod integral;
#[cfg(feature = "alloc")]
mod matrix;
#[cfg(feature = "alloc")]
mod table;
mod tau;

#[cfg(feature = "alloc")]
pub use matrix::ScalingMatrix;
#[cfg(feature = "alloc")]
pub use table::{Interpolation, ScalingTable, geometric_nodes};
pub use tau::{Preserve, Tau};
