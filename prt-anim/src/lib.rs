//! What moves a model, and the frames by which precomputed radiance transfer follows it: skeletons, clips, skinning and deformations,
//! after [SLS05](sh_core#references).
//!
//! The way through the crate: [`load_character`] reads a [`Character`]: a [`Skeleton`], its [`Clip`]s and a [`SkinnedMesh`]. [`Clip::sample`] makes a
//! [`Pose`], and [`Skin::deform`] writes positions, normals and frames into a [`Deformed`], once for each picture. Models without a skeleton
//! are moved by a [`Deformation`], or by anything else and [`frames_from_mesh`]. [`SkinnedMesh::bind_to`] gives the joints of
//! a character to the vertices of a mesh that was baked from the same file.
//!
//! # Frames
//!
//! A frame is three columns `[c0, c1, c2]`; `c0·x + c1·y + c2·z` takes a vector into the world. The frame of a *vertex* is the rotation from
//! the rest pose to the deformed one ([`rotation_of`]): a zonal lobe with axis `a` in the rest pose has the axis `frame · a` now, and its
//! coefficients stay. The *tangent* frame of a textured surface is `[tangent, bitangent, normal]` of the current pose ([`tangent_frames`]);
//! lobes baked in tangent space are turned by it. Tangent frames are left-handed where texture coordinates are mirrored.
//!
//! # Conventions
//!
//! Those of [`sh_core`]. Lengths are scene units, angles radians, times seconds; matrices are arrays of columns; quaternions are `x y z w`.
//! Arrays are `f32`, transforms and everything between are `f64`.
//!
//! # Features
//!
//! - `parallel` (default): several threads. Without it everything runs on the calling thread, with the same result.

mod affine;
mod binding;
mod clip;
mod deform;
mod deformed;
mod error;
mod frame;
mod linear;
mod load;
mod mesh;
mod parallel;
mod pose;
mod skeleton;
mod skin;
mod skinning;

pub use affine::Affine;
pub use binding::Binding;
pub use clip::{Channel, Clip, Interpolation, Keys, Playback, Track};
pub use deform::Deformation;
pub use deformed::Deformed;
pub use error::Error;
pub use frame::{
    frames_from_mesh, frames_from_skin, push_tangent_frame, push_tangent_frames, rotation_of, tangent_frames,
};
pub use load::{Character, LoadReport, load_character};
pub use mesh::SkinnedMesh;
pub use pose::{Pose, Transform};
pub use skeleton::{Joint, Skeleton};
pub use skin::{Bone, Skin, SkinSource};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
