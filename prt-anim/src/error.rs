//! What can go wrong when characters are read and put together.

use std::io;
use std::path::PathBuf;

/// Why a character could not be read or put together. Every message names the item and the cause.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The operating system refused to read.
    #[error("cannot read {}: {cause}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's own reason; part of the message, and so not repeated as its source.
        cause: io::Error,
    },
    /// A file does not follow its format.
    #[error("{} is not a valid glTF file: {reason}", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// The first thing that is wrong with it.
        reason: String,
    },
    /// A file is in order, but uses something that is not read here.
    #[error("{}: {what} not supported", path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// What is missing, worded to stand before "not supported".
        what: String,
    },
    /// A file is in order, but there is no surface in it.
    #[error("{} holds no faces (and {vertices} vertices)", path.display())]
    NoFaces {
        /// The file.
        path: PathBuf,
        /// How many vertices it holds.
        vertices: usize,
    },
    /// Joints that do not form trees.
    #[error("skeleton: {0}")]
    Skeleton(String),
    /// Keys that are out of order, too few or not finite.
    #[error("clip: {0}")]
    Clip(String),
    /// Arrays of a skin that do not belong together.
    #[error("skin: {0}")]
    Skin(String),
    /// Vertices of another mesh that are not vertices of the skinned one.
    #[error(
        "{unbound} of {vertices} vertices stand where the skinned mesh has none (the first is vertex {first}; tolerance {tolerance:.3e})"
    )]
    Unbound {
        /// How many vertices found no partner.
        unbound: usize,
        /// How many there are.
        vertices: usize,
        /// The first one without a partner.
        first: usize,
        /// Largest distance between partners, scene units.
        tolerance: f64,
    },
}
