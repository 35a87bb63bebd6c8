//! The surface that transfer belongs to.

use crate::{Error, Mesh};

/// A surface as it is shaded: vertices, faces, and what each vertex looks like apart from its transfer.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Geometry {
    /// Positions `[V]`, scene units.
    pub positions: Vec<[f32; 3]>,
    /// Shading normals `[V]`, unit length.
    pub normals: Vec<[f32; 3]>,
    /// Three vertex numbers a face.
    pub triangles: Vec<[u32; 3]>,
    /// Diffuse albedo `[V]`, linear. It is not part of the transfer of its own vertex.
    pub albedo: Vec<[f32; 3]>,
    /// Texture coordinates `[V]`.
    pub uvs: Option<Vec<[f32; 2]>>,
}

impl Geometry {
    /// The geometry of a mesh, positions rounded to `f32`.
    #[must_use]
    pub fn of(mesh: &Mesh) -> Self {
        Self {
            positions: mesh.positions().iter().map(|position| position.map(|coordinate| coordinate as f32)).collect(),
            normals: mesh.normals().to_vec(),
            triangles: mesh.triangles().to_vec(),
            albedo: mesh.albedo().to_vec(),
            uvs: mesh.uvs().map(<[_]>::to_vec),
        }
    }

    /// Number of vertices.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// Checks that all arrays over the vertices are as long as the positions.
    pub(crate) fn check_lengths(&self) -> Result<(), Error> {
        let uv_count = self.uvs.as_ref().map_or(self.vertex_count(), Vec::len);
        let counts = [("normals", self.normals.len()), ("albedo", self.albedo.len()), ("uvs", uv_count)];
        counts.into_iter().try_for_each(|(what, count)| self.check_count(what, count))
    }

    /// Checks that something comes once for each vertex.
    pub(crate) fn check_count(&self, what: &str, count: usize) -> Result<(), Error> {
        match self.vertex_count() {
            vertices if vertices == count => Ok(()),
            vertices => Err(Error::InconsistentMesh(format!("{count} {what} for {vertices} vertices"))),
        }
    }
}
