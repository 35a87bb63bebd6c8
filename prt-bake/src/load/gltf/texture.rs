//! Base colour textures.

use gltf::json::texture::{Sampler, WrappingMode};
use gltf::json::validation::Checked;
use gltf::json::{Index, Texture as Json};

use super::document::Document;
use super::uri;
use crate::image::decode_rgba8;
use crate::input::Fault;
use crate::{Texture, TextureWrap};

pub(super) fn load(document: &Document<'_>, index: Index<Json>) -> Result<Texture, Fault> {
    let texture = document.get(index, "texture")?;
    let image = document.get(texture.source, "image")?;
    let bytes = match (&image.uri, image.buffer_view) {
        (_, Some(view)) => document.view(view)?.0.to_vec(),
        (Some(uri), None) => uri::load(uri, document.folder)?,
        (None, None) => return Err(Fault::malformed(format!("image {} has no data", texture.source))),
    };
    let (width, height, pixels) = decode_rgba8(&bytes).map_err(|fault| in_image(fault, texture.source.value()))?;
    let sampler = texture.sampler.map(|sampler| document.get(sampler, "sampler")).transpose()?;
    Ok(Texture::new(width, height, pixels, wrap_modes(sampler)))
}

fn wrap_modes(sampler: Option<&Sampler>) -> [TextureWrap; 2] {
    let mode = |mode: Checked<WrappingMode>| match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => TextureWrap::ClampToEdge,
        Checked::Valid(WrappingMode::MirroredRepeat) => TextureWrap::MirroredRepeat,
        Checked::Valid(WrappingMode::Repeat) | Checked::Invalid => TextureWrap::Repeat,
    };
    sampler.map_or([TextureWrap::Repeat; 2], |sampler| [mode(sampler.wrap_s), mode(sampler.wrap_t)])
}

fn in_image(fault: Fault, index: usize) -> Fault {
    match fault {
        Fault::Malformed(reason) => Fault::Malformed(format!("image {index}: {reason}")),
        Fault::Unsupported(what) => Fault::Unsupported(format!("image {index}: {what}")),
        elsewhere @ Fault::Elsewhere(_) => elsewhere,
    }
}
