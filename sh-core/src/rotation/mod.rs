//! Rotation of expansions.

mod exact;
mod ivanic;

pub use exact::ShRotation;
pub(crate) use exact::rotate_channels;
