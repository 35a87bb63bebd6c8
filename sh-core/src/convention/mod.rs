//! To and from the conventions of other libraries.

mod complex;
mod filament;
#[cfg(feature = "alloc")]
mod frame;
mod phase;
mod splat;

pub use complex::{from_complex, to_complex};
pub use filament::{from_filament, to_filament};
#[cfg(feature = "alloc")]
pub use frame::{y_up_from_z_up, z_up_from_y_up};
pub use phase::toggle_condon_shortley;
pub use splat::{SplatLayout, from_splat, to_splat};
