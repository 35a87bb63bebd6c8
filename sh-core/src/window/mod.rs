//! Windows that fade the high bands out, against ringing, and how strong they must be.

#[cfg(feature = "alloc")]
mod bound;
mod laplacian;
#[cfg(feature = "alloc")]
mod minimum;
#[cfg(feature = "alloc")]
mod nonnegative;
#[cfg(feature = "alloc")]
mod turning;
mod weights;
#[cfg(feature = "alloc")]
mod zonal_minimum;

pub use laplacian::{laplacian, laplacian_lambda};
#[cfg(feature = "alloc")]
pub use minimum::{Minimum, minimum};
#[cfg(feature = "alloc")]
pub use nonnegative::nonnegative_window;
pub use weights::{Window, gaussian, hanning, lanczos};
#[cfg(feature = "alloc")]
pub use zonal_minimum::minimum_zonal;
