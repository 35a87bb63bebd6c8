//! The base colour of a material, as an albedo at single points.

use std::collections::HashMap;
use std::rc::Rc;

use gltf::json::{Index, Material, Texture as TextureJson, texture};

use super::document::Document;
use super::texture::Texture;
use crate::input::Fault;

/// Linear factor × texture.
#[derive(Debug, Clone)]
pub(super) struct BaseColor {
    factor: [f64; 3],
    texture: Option<TextureUse>,
}

/// A texture, and how a primitive's coordinates become the texture's.
#[derive(Debug, Clone)]
struct TextureUse {
    texture: Rc<Texture>,
    /// Which `TEXCOORD_n`.
    set: u32,
    scale: [f64; 2],
    rotation: f64,
    offset: [f64; 2],
}

/// Textures read so far.
pub(super) type Textures = HashMap<usize, Rc<Texture>>;

impl BaseColor {
    /// The diffuse colour of KHR_materials_pbrSpecularGlossiness where a material has that, else the base colour.
    pub(super) fn load(
        document: &Document<'_>,
        index: Index<Material>,
        textures: &mut Textures,
    ) -> Result<Self, Fault> {
        let material = document.get(index, "material")?;
        let specular_glossiness = material.extensions.as_ref().and_then(|all| all.pbr_specular_glossiness.as_ref());
        let (factor, info) = match specular_glossiness {
            Some(diffuse) => (diffuse.diffuse_factor.0, &diffuse.diffuse_texture),
            None => {
                let base = &material.pbr_metallic_roughness;
                (base.base_color_factor.0, &base.base_color_texture)
            }
        };
        let [red, green, blue, _] = factor.map(f64::from);
        let texture = info.as_ref().map(|info| TextureUse::load(document, info, textures)).transpose()?;
        Ok(Self { factor: [red, green, blue], texture })
    }

    /// The number of the texture coordinates that are needed.
    pub(super) fn uv_set(&self) -> Option<u32> {
        self.texture.as_ref().map(|texture| texture.set)
    }

    /// Linear colour.
    ///
    /// - `uv`: of the set [`uv_set`](Self::uv_set); `None`: the texture is left out
    pub(super) fn at(&self, uv: Option<[f64; 2]>) -> [f64; 3] {
        match self.texture.as_ref().zip(uv) {
            Some((texture, uv)) => {
                let texel = texture.sample(uv);
                [0, 1, 2].map(|channel| self.factor[channel] * texel[channel])
            }
            None => self.factor,
        }
    }
}

impl TextureUse {
    fn load(document: &Document<'_>, info: &texture::Info, textures: &mut Textures) -> Result<Self, Fault> {
        let texture = load_once(document, info.index, textures)?;
        let transform = info.extensions.as_ref().and_then(|all| all.texture_transform.as_ref());
        Ok(Self {
            texture,
            set: transform.and_then(|transform| transform.tex_coord).unwrap_or(info.tex_coord),
            scale: transform.map_or([1.0; 2], |transform| transform.scale.0.map(f64::from)),
            rotation: transform.map_or(0.0, |transform| f64::from(transform.rotation.0)),
            offset: transform.map_or([0.0; 2], |transform| transform.offset.0.map(f64::from)),
        })
    }

    /// KHR_texture_transform: translation × rotation × scale. The rotation is counter-clockwise as seen with v running
    /// down, as the extension's words, Khronos's sample viewer and three.js have it (its GLSL sample turns the other way).
    fn sample(&self, uv: [f64; 2]) -> [f64; 3] {
        let [u, v] = [uv[0] * self.scale[0], uv[1] * self.scale[1]];
        let (sin, cos) = self.rotation.sin_cos();
        self.texture.sample([cos * u + sin * v + self.offset[0], cos * v - sin * u + self.offset[1]])
    }
}

fn load_once(
    document: &Document<'_>,
    index: Index<TextureJson>,
    textures: &mut Textures,
) -> Result<Rc<Texture>, Fault> {
    if let Some(texture) = textures.get(&index.value()) {
        return Ok(Rc::clone(texture));
    }
    let texture = Rc::new(Texture::load(document, index)?);
    textures.insert(index.value(), Rc::clone(&texture));
    Ok(texture)
}
