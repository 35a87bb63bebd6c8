//! Tests of the file readers and writers, through the public functions alone: small files made here, files that lie or are
//! damaged, real ones from the data folder, and a short run of random damage.
#![expect(clippy::unwrap_used, clippy::print_stdout, reason = "tests, and what they skip is printed")]
#![expect(clippy::needless_pass_by_value, reason = "documents are built where they are passed")]

#[path = "readers/damage.rs"]
mod damage;
#[path = "readers/data.rs"]
mod data;
#[path = "readers/environment.rs"]
mod environment;
#[path = "readers/exr.rs"]
mod exr;
#[path = "readers/gltf.rs"]
mod gltf;
#[path = "readers/gltf_bad.rs"]
mod gltf_bad;
#[path = "readers/hdr.rs"]
mod hdr;
#[path = "readers/materials.rs"]
mod materials;
#[path = "readers/obj.rs"]
mod obj;
#[path = "readers/off.rs"]
mod off;
#[path = "readers/paths.rs"]
mod paths;
#[path = "readers/ply.rs"]
mod ply;
#[path = "readers/save.rs"]
mod save;
#[path = "readers/scratch.rs"]
mod scratch;
#[path = "readers/standard.rs"]
mod standard;
