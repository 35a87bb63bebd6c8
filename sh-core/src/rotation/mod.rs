//! Rotation of expansions.

mod about_z;
mod cartesian;
#[cfg(feature = "alloc")]
mod exact;
mod exchange;
#[cfg(feature = "alloc")]
mod ivanic;
#[cfg(feature = "alloc")]
mod many;
mod quad;
#[cfg(feature = "alloc")]
mod tables;
#[cfg(feature = "alloc")]
mod taylor;
mod turn;
mod unrolled;
mod values;
mod zxzxz;
mod zyz;

pub use about_z::rotate_z;
#[cfg(feature = "alloc")]
pub use exact::ShRotation;
#[cfg(feature = "alloc")]
pub(crate) use exact::rotate_channels;
pub(crate) use quad::Quads;
#[cfg(feature = "alloc")]
pub use tables::Zxzxz;
#[cfg(feature = "alloc")]
pub use taylor::{Taylor, TaylorDegree, radiance_cache_angle_limit, taylor_angle_limit};
pub(crate) use values::BandValues;
pub use zxzxz::{rotate, rotate_quaternion, rotate_zyz};
pub use zyz::Zyz;
