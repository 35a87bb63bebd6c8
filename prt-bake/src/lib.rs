//! Bakes precomputed radiance transfer of triangle meshes, and reads and writes baked files.
//!
//! The way through the crate: [`load_mesh`] reads a file into a [`MeshSource`]; [`Mesh::new`] checks, cleans and completes it;
//! [`bake_diffuse`] makes a [`BakedSurface`], which [`BakedSurface::write`] puts into one file `*.prt`. [`Environment`] gives the light
//! vectors that a baked surface is lit with. [`Scene`] answers rays. [`bake_patch`] bakes a [`HeightField`] that tiles the plane, opaque
//! or translucent, as a texture of transfer.
//!
//! # Conventions
//!
//! Those of [`sh_core`]. Transfer is `1/π ∫ V(s) max(n·s, 0) y(s) ds` plus what other surfaces reflect, with *their* albedo: it holds
//! the `1/π` of the diffuse BRDF and never the albedo of the receiving vertex, so that exit radiance is `albedo · (transfer · light)`.
//! Radiance is linear and relative to the scene. The back of a face occludes and is black, unless the face has a
//! twin that looks the other way ([`TwoSided`]); rays pass through the holes of alpha-masked materials ([`SurfaceMaterial`]).
//!
//! # Features
//!
//! - `trace` (default): ray tracing and baking. Without it meshes, images and the baked file remain.
//! - `parallel` (default): several threads. Without it baking runs on the calling thread, with the same result.

mod atomic;
#[cfg(feature = "trace")]
mod diffuse;
mod environment;
mod error;
mod file;
mod geometry;
mod hash;
mod image;
mod input;
#[cfg(feature = "trace")]
mod job;
mod load;
mod material;
mod mesh;
mod options;
#[cfg(feature = "trace")]
mod parallel;
#[cfg(feature = "trace")]
mod patch;
mod progress;
#[cfg(feature = "trace")]
mod sampling;
#[cfg(feature = "trace")]
mod scene;
mod texels;
mod transfer;
mod zonal;

#[cfg(feature = "trace")]
pub use diffuse::{
    BakeReport, LevelCount, OrderReport, Savings, TimePlan, VertexSample, VertexStats, bake_diffuse, bake_vertices,
    error_for_time, error_for_time_of_texels, ray_origins, recommend_order,
};
pub use environment::Environment;
pub use error::Error;
pub use file::{
    BakedFile, BakedSurface, FileInfo, Material, Metadata, Source, TensorInfo, ZonalSurface, ZonalTexture, file_info,
};
pub use geometry::Geometry;
pub use image::{ExrPrecision, Image, save_png};
#[cfg(feature = "trace")]
pub use job::{
    BakeTarget, FileReport, JournalInfo, Part, Unfinished, bake_texels, bake_texels_to_file, bake_to_file, is_journal,
    journal_info, merge_parts,
};
pub use load::load_mesh;
pub use material::{SurfaceMaterial, Texture, TextureMap, TextureWrap};
pub use mesh::{Mesh, MeshOptions, MeshReport, MeshSource, TwoSided};
pub use options::{BakeOptions, InsidePolicy};
#[cfg(feature = "trace")]
pub use patch::{HeightField, Medium, PatchOptions, PatchReport, PatchTransfer, ScatteringReport, bake_patch};
pub use progress::{Pass, Progress};
#[cfg(feature = "trace")]
pub use sampling::DirectionSet;
#[cfg(feature = "trace")]
pub use scene::{Answered, DirectionTracer, Hit, Scene};
pub use texels::{Coverage, TexelTransfer};
#[cfg(feature = "trace")]
pub use texels::{TexelOptions, TexelReport};
pub use transfer::TransferVectors;
pub use zonal::{ViewMap, ZonalTransfer};

#[cfg(all(doctest, feature = "trace"))]
#[doc = include_str!("../README.md")]
struct Readme;
