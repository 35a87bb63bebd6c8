//! What can go wrong when scenes are read, baked and written.

use std::io;
use std::path::PathBuf;

/// Why a scene could not be read, baked or written. Every message names the item and the cause.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The operating system refused to read or write.
    #[error("cannot {action} {}: {cause}", path.display())]
    Io {
        /// What was tried, as a verb phrase: `read`, `write`.
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// The system's own reason; part of the message, and so not repeated as its source.
        cause: io::Error,
    },
    /// A file does not follow its format.
    #[error("{} is not a valid {format} file: {reason}", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// The format it was read as.
        format: &'static str,
        /// The first thing that is wrong with it.
        reason: String,
    },
    /// A file is in order, but uses something that is not read here.
    #[error("{}: {what} not supported", path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// What is missing, worded to stand before "not supported": `DWAB compression is`.
        what: String,
    },
    /// The extension of a file does not tell how to read or write it.
    #[error("{}: unknown extension; {what} may be one of {accepted}", path.display())]
    UnknownExtension {
        /// The file.
        path: PathBuf,
        /// What was asked for, with its article: `a mesh`, `an image`.
        what: &'static str,
        /// The extensions that are known.
        accepted: &'static str,
    },
    /// A baked file is in order, but of another kind than is needed.
    #[error("{} is a baked file of kind {given}; {wanted} is needed", path.display())]
    Kind {
        /// The file.
        path: PathBuf,
        /// Its kind.
        given: &'static str,
        /// The kind that is needed.
        wanted: &'static str,
    },
    /// A file is in order, but there is no surface in it.
    #[error("{} holds no faces (and {vertices} vertices)", path.display())]
    NoFaces {
        /// The file.
        path: PathBuf,
        /// How many vertices it holds.
        vertices: usize,
    },
    /// Nothing is left to bake.
    #[error("the mesh has no usable triangle ({reason})")]
    EmptyMesh {
        /// How the triangles were lost.
        reason: String,
    },
    /// Two arrays that belong together have different lengths, or an index points past the end.
    #[error("inconsistent mesh: {0}")]
    InconsistentMesh(String),
    /// Texture coordinates do not lay a mesh out on an atlas.
    #[error("cannot bake texels: {0}")]
    Atlas(String),
    /// Heights do not make a field.
    #[error("invalid height field: {0}")]
    HeightField(String),
    /// A setting is out of its range.
    #[error("invalid option: {0}")]
    Option(String),
    /// There is the journal of a bake that did not come to its end.
    #[error("{} holds an unfinished bake, which would be lost; resume it, or discard it", path.display())]
    Unfinished {
        /// The journal.
        path: PathBuf,
    },
    /// A journal or a part belongs to another bake.
    #[error("{} is of another bake: {difference}", path.display())]
    OtherBake {
        /// The journal or the part.
        path: PathBuf,
        /// What is not the same.
        difference: String,
    },
    /// Parts do not make a whole.
    #[error("parts do not fit: {0}")]
    Parts(String),
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
}
