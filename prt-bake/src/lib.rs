//! Bakes precomputed radiance transfer of triangle meshes, and reads and writes baked files.

mod atomic;
#[cfg(feature = "trace")]
mod diffuse;
mod environment;
mod error;
mod file;
mod image;
mod input;
mod load;
mod mesh;
mod options;
#[cfg(feature = "trace")]
mod parallel;
mod progress;
#[cfg(feature = "trace")]
mod sampling;
#[cfg(feature = "trace")]
mod scene;
mod transfer;

#[cfg(feature = "trace")]
pub use diffuse::{BakeReport, bake_diffuse};
pub use environment::Environment;
pub use error::Error;
pub use file::{BakedSurface, FileInfo, Metadata, Source, TensorInfo, file_info};
pub use image::{ExrPrecision, Image, save_png};
pub use load::load_mesh;
pub use mesh::{Mesh, MeshOptions, MeshReport, MeshSource};
pub use options::BakeOptions;
pub use progress::{Pass, Progress};
#[cfg(feature = "trace")]
pub use scene::{Hit, Scene};
pub use transfer::TransferVectors;
