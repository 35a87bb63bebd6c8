//! Fingerprints of meshes.

use super::Mesh;
use crate::hash::Content;

impl Mesh {
    /// SHA-256 of all in the mesh that decides what a bake makes of it, in hexadecimal: names do not.
    pub(crate) fn content_hash(&self) -> String {
        // Without `..`: what is added must be thought of here.
        let Self {
            positions,
            normals,
            albedo,
            uvs,
            triangles,
            materials,
            face_material,
            texture_uvs,
            tints,
            parts: _,
            face_part: _,
            twin_count,
            overrides_textures,
        } = self;
        let mut content = Content::default();
        content.array(positions.as_flattened(), f64::to_le_bytes);
        content.array(normals.as_flattened(), f32::to_le_bytes);
        content.array(albedo.as_flattened(), f32::to_le_bytes);
        content.array(uvs.as_deref().unwrap_or_default().as_flattened(), f32::to_le_bytes);
        content.array(triangles.as_flattened(), u32::to_le_bytes);
        content.array(face_material, u32::to_le_bytes);
        content.array(texture_uvs.as_flattened(), f32::to_le_bytes);
        content.array(tints.as_flattened(), f32::to_le_bytes);
        content.array(&[*twin_count as u64, u64::from(*overrides_textures)], u64::to_le_bytes);
        materials.iter().for_each(|material| material.add_to(&mut content));
        content.finish()
    }
}
