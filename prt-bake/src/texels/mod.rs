//! Transfer vectors for the texels of an atlas, in place of the vertices.
//!
//! A texel is a point of the surface like a vertex: position and smooth normal come from the face that its centre lies in. So a coarse
//! mesh gets shadows as fine as its texture is.

mod coverage;
#[cfg(feature = "trace")]
mod edges;
mod exr;
#[cfg(feature = "trace")]
mod finish;
mod grid;
#[cfg(feature = "trace")]
mod gutter;
#[cfg(feature = "trace")]
mod layout;
#[cfg(feature = "trace")]
mod options;
#[cfg(feature = "trace")]
mod plan;
#[cfg(feature = "trace")]
mod points;
#[cfg(feature = "trace")]
mod raster;
mod read_exr;
#[cfg(feature = "trace")]
mod report;
#[cfg(feature = "trace")]
mod seam;
#[cfg(feature = "trace")]
mod trace;
mod transfer;
#[cfg(feature = "trace")]
mod triangle;

pub use coverage::Coverage;
#[cfg(feature = "trace")]
pub(crate) use finish::Finish;
#[cfg(feature = "trace")]
pub use options::TexelOptions;
#[cfg(feature = "trace")]
pub(crate) use plan::{AtlasPlan, LaidOut};
#[cfg(feature = "trace")]
pub use report::TexelReport;
#[cfg(feature = "trace")]
pub(crate) use trace::{TexelScratch, TexelTracer};
pub use transfer::TexelTransfer;

#[cfg(all(test, feature = "trace"))]
mod tests;
