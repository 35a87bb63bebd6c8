//! A triangle mesh that follows a skeleton.

use crate::Skin;

/// A triangle mesh whose vertices follow joints. All per-vertex arrays are `[V]`, in the order of the [`Skin`].
#[derive(Debug, Clone, PartialEq)]
pub struct SkinnedMesh {
    /// How vertices follow joints, and their positions and normals in the rest pose.
    pub skin: Skin,
    /// Texture coordinates, `v` running down as in glTF; zero where there are none.
    pub uvs: Vec<[f32; 2]>,
    /// Factor of the base colour, linear; textures and vertex colours are left out. 0.8 without a material.
    pub albedo: Vec<[f32; 3]>,
    /// Three vertex numbers each, counter-clockwise seen from outside in the rest pose.
    pub triangles: Vec<[u32; 3]>,
}

impl SkinnedMesh {
    /// Positions `[V]` in the rest pose, in the scene.
    #[must_use]
    pub fn positions(&self) -> &[[f32; 3]] {
        self.skin.rest_positions()
    }

    /// Normals `[V]` in the rest pose, unit length.
    #[must_use]
    pub fn normals(&self) -> &[[f32; 3]] {
        self.skin.rest_normals()
    }
}
