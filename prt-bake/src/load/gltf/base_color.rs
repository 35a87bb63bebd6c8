//! Materials: the base colour, its texture, and what is said of holes and backs.

use std::collections::HashMap;
use std::sync::Arc;

use gltf::json::material::AlphaMode;
use gltf::json::validation::Checked;
use gltf::json::{Index, Material, Texture as TextureJson, texture};

use super::document::Document;
use super::texture as texture_file;
use crate::input::Fault;
use crate::{SurfaceMaterial, Texture, TextureMap};

/// Where a blended surface counts as there: where it hides more than it shows.
const BLEND_CUTOFF: f32 = 0.5;

/// Materials read so far.
#[derive(Debug, Default)]
pub(super) struct Materials {
    list: Vec<SurfaceMaterial>,
    /// By the number of the document's material, and whether it is used with its texture.
    numbers: HashMap<(usize, bool), u32>,
    textures: HashMap<usize, Arc<Texture>>,
    warnings: Vec<String>,
}

impl Materials {
    /// The number of a material, for a primitive that has the coordinates of its texture or has not; then the texture is left out.
    pub(super) fn number(
        &mut self,
        document: &Document<'_>,
        index: Index<Material>,
        has_uvs: bool,
    ) -> Result<u32, Fault> {
        if let Some(&number) = self.numbers.get(&(index.value(), has_uvs)) {
            return Ok(number);
        }
        let material = self.load(document, index, has_uvs)?;
        let number = self.list.len() as u32;
        self.list.push(material);
        self.numbers.insert((index.value(), has_uvs), number);
        Ok(number)
    }

    pub(super) fn get(&self, number: u32) -> &SurfaceMaterial {
        &self.list[number as usize]
    }

    /// The materials, and what was done otherwise than they ask for.
    pub(super) fn into_parts(self) -> (Vec<SurfaceMaterial>, Vec<String>) {
        (self.list, self.warnings)
    }

    fn load(
        &mut self,
        document: &Document<'_>,
        index: Index<Material>,
        has_uvs: bool,
    ) -> Result<SurfaceMaterial, Fault> {
        let material = document.get(index, "material")?;
        let (factor, info) = base_color(material);
        let map = info.map(|info| self.texture_map(document, info)).transpose()?.filter(|_| has_uvs);
        let name = material.name.clone().unwrap_or_default();
        let alpha_cutoff = match material.alpha_mode {
            Checked::Valid(AlphaMode::Mask) => {
                Some(material.alpha_cutoff.map_or(0.5, |cutoff| cutoff.0.clamp(0.0, f32::MAX)))
            }
            Checked::Valid(AlphaMode::Blend) => Some(BLEND_CUTOFF),
            _ => None,
        };
        let loaded = SurfaceMaterial {
            name,
            base_color: factor.map(|value| value.clamp(0.0, f32::MAX)),
            texture: map,
            alpha_cutoff,
            two_sided: material.double_sided,
        };
        if material.alpha_mode == Checked::Valid(AlphaMode::Blend) && loaded.may_have_holes() {
            self.warnings.push(format!(
                "material {index} `{}` is blended; it is taken as opaque where alpha is at least {BLEND_CUTOFF}, elsewhere as a hole",
                loaded.name
            ));
        }
        Ok(loaded)
    }

    fn texture_map(&mut self, document: &Document<'_>, info: &texture::Info) -> Result<TextureMap, Fault> {
        let texture = self.texture(document, info.index)?;
        let transform = info.extensions.as_ref().and_then(|all| all.texture_transform.as_ref());
        Ok(TextureMap {
            texture,
            scale: transform.map_or([1.0; 2], |transform| transform.scale.0),
            rotation: transform.map_or(0.0, |transform| transform.rotation.0),
            offset: transform.map_or([0.0; 2], |transform| transform.offset.0),
        })
    }

    fn texture(&mut self, document: &Document<'_>, index: Index<TextureJson>) -> Result<Arc<Texture>, Fault> {
        if let Some(texture) = self.textures.get(&index.value()) {
            return Ok(Arc::clone(texture));
        }
        let texture = Arc::new(texture_file::load(document, index)?);
        self.textures.insert(index.value(), Arc::clone(&texture));
        Ok(texture)
    }
}

/// The number of the texture coordinates that a material's base colour needs, if any.
pub(super) fn uv_set(document: &Document<'_>, index: Index<Material>) -> Result<Option<u32>, Fault> {
    let (_, info) = base_color(document.get(index, "material")?);
    Ok(info.map(|info| {
        let transform = info.extensions.as_ref().and_then(|all| all.texture_transform.as_ref());
        transform.and_then(|transform| transform.tex_coord).unwrap_or(info.tex_coord)
    }))
}

/// The diffuse colour of KHR_materials_pbrSpecularGlossiness where a material has that, else the base colour.
fn base_color(material: &Material) -> ([f32; 4], Option<&texture::Info>) {
    let specular_glossiness = material.extensions.as_ref().and_then(|all| all.pbr_specular_glossiness.as_ref());
    match specular_glossiness {
        Some(diffuse) => (diffuse.diffuse_factor.0, diffuse.diffuse_texture.as_ref()),
        None => {
            let base = &material.pbr_metallic_roughness;
            (base.base_color_factor.0, base.base_color_texture.as_ref())
        }
    }
}
