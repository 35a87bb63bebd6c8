//! What the faces of a mesh look like.

use super::Mesh;
use crate::SurfaceMaterial;
use crate::material::texture_bytes;

impl Mesh {
    /// What faces look like.
    #[must_use]
    pub fn materials(&self) -> &[SurfaceMaterial] {
        &self.materials
    }

    /// The material of a face, if it has one.
    ///
    /// # Panics
    /// If there is no such face.
    #[must_use]
    pub fn material(&self, face: usize) -> Option<&SurfaceMaterial> {
        assert!(face < self.triangles.len(), "face {face} of {}", self.triangles.len());
        self.materials.get(*self.face_material.get(face)? as usize)
    }

    /// The number of the material of a face, or [`SurfaceMaterial::NONE`].
    #[cfg(feature = "trace")]
    pub(crate) fn material_number(&self, face: usize) -> u32 {
        self.face_material.get(face).copied().unwrap_or(SurfaceMaterial::NONE)
    }

    /// Names of the parts that the file is made of.
    #[must_use]
    pub fn parts(&self) -> &[String] {
        &self.parts
    }

    /// For each face the number of its part; empty if the file tells nothing of parts.
    #[must_use]
    pub fn face_parts(&self) -> &[u32] {
        &self.face_part
    }

    /// Diffuse albedo at a point of a face, linear, between 0 and 1: from the texture if the face has one, else from its vertices.
    ///
    /// - `barycentric`: weights of the second and the third corner
    ///
    /// # Panics
    /// If there is no such face.
    #[must_use]
    pub fn albedo_at(&self, face: usize, barycentric: [f32; 2]) -> [f32; 3] {
        let corners = self.triangles[face];
        match self.material(face).filter(|material| material.texture.is_some() && !self.overrides_textures) {
            Some(material) => {
                let color = material.color(self.texture_uv(face, barycentric));
                let Some(tint) = interpolated(&self.tints, corners, barycentric) else { return color };
                [0, 1, 2].map(|channel| (color[channel] * tint[channel]).clamp(0.0, 1.0))
            }
            None => {
                let albedo = interpolated(&self.albedo, corners, barycentric).unwrap_or_default();
                albedo.map(|channel| channel.clamp(0.0, 1.0))
            }
        }
    }

    /// The coordinate of the texture of a face; NaN, for which textures are white, if the mesh has none.
    pub(crate) fn texture_uv(&self, face: usize, barycentric: [f32; 2]) -> [f32; 2] {
        let uvs = if self.texture_uvs.is_empty() { self.uvs.as_deref().unwrap_or_default() } else { &self.texture_uvs };
        interpolated(uvs, self.triangles[face], barycentric).unwrap_or([f32::NAN; 2])
    }

    /// 1 if no surface of the mesh has a hue, so that light of all colours is reflected alike, else 3.
    #[must_use]
    pub fn channel_count(&self) -> usize {
        let is_gray = |color: &[f32; 3]| color[0] == color[1] && color[1] == color[2];
        let textured = |material: &&SurfaceMaterial| material.texture.is_some() && !self.overrides_textures;
        let materials_are_gray = self.materials.iter().filter(textured).all(SurfaceMaterial::is_gray);
        let is_gray = materials_are_gray && self.albedo.iter().all(is_gray) && self.tints.iter().all(is_gray);
        if is_gray { 1 } else { 3 }
    }

    /// Bytes held, textures included.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.positions)
            + size_of_val(&*self.normals)
            + size_of_val(&*self.albedo)
            + self.uvs.as_ref().map_or(0, |uvs| size_of_val(&**uvs))
            + size_of_val(&*self.triangles)
            + size_of_val(&*self.face_material)
            + size_of_val(&*self.texture_uvs)
            + size_of_val(&*self.tints)
            + size_of_val(&*self.face_part)
            + texture_bytes(&self.materials)
    }
}

/// `Σ w_k value_k` over the corners, exact where they are alike; nothing where there are no values.
fn interpolated<const N: usize>(values: &[[f32; N]], corners: [u32; 3], [b, c]: [f32; 2]) -> Option<[f32; N]> {
    let at = |vertex: u32| values.get(vertex as usize);
    let [p, q, r] = [at(corners[0])?, at(corners[1])?, at(corners[2])?];
    Some(std::array::from_fn(|k| p[k] + b * (q[k] - p[k]) + c * (r[k] - p[k])))
}
