//! From the statements of an OBJ file to a mesh with one index per corner.

use std::collections::HashMap;

use super::statements::{Corner, Face, NONE, Statements};
use crate::image::srgb_to_linear;
use crate::input::Fault;
use crate::load::polygon::Polygons;
use crate::mesh::MeshSource;

/// A vertex of the result: a corner and the material that colours it.
type Key = (Corner, u32);

pub(super) fn mesh(statements: &Statements) -> Result<MeshSource, Fault> {
    let keeps_order = statements.corners.iter().all(|corner| corner.uv == NONE && corner.normal == NONE);
    let mut vertices = Vertices::default();
    if keeps_order {
        vertices.keep_all(statements);
    }
    let mut polygons = Polygons::with_capacity(statements.faces.len());
    let mut corners = statements.corners.iter();
    for face in &statements.faces {
        let corners = corners.by_ref().take(face.corner_count as usize);
        polygons.push(corners.map(|&corner| vertices.index(corner, face.material)));
    }
    vertices.into_mesh(statements, &polygons)
}

#[derive(Default)]
struct Vertices {
    keys: Vec<Key>,
    indices: HashMap<Key, u32>,
    /// In a file that keeps its order: whether the vertex of the same number as the position is taken by a face yet.
    taken: Vec<bool>,
}

impl Vertices {
    /// Begins with the positions as they stand in the file.
    fn keep_all(&mut self, statements: &Statements) {
        let corner = |position| Corner { position, uv: NONE, normal: NONE };
        self.keys = (0..statements.positions.len() as u32).map(|position| (corner(position), NONE)).collect();
        self.taken = vec![false; self.keys.len()];
    }

    fn index(&mut self, corner: Corner, material: u32) -> u32 {
        let own = corner.position as usize;
        match self.taken.get(own) {
            Some(false) => {
                self.taken[own] = true;
                self.keys[own].1 = material;
                corner.position
            }
            Some(true) if self.keys[own].1 == material => corner.position,
            _ => self.shared_index((corner, material)),
        }
    }

    fn shared_index(&mut self, key: Key) -> u32 {
        *self.indices.entry(key).or_insert_with(|| {
            self.keys.push(key);
            (self.keys.len() - 1) as u32
        })
    }

    fn into_mesh(self, statements: &Statements, polygons: &Polygons) -> Result<MeshSource, Fault> {
        if self.keys.len() > NONE as usize {
            return Err(Fault::unsupported(format!("a mesh of {} vertices is", self.keys.len())));
        }
        let positions: Vec<_> =
            self.keys.iter().map(|(corner, _)| statements.positions[corner.position as usize]).collect();
        let (triangles, faces) = polygons.triangulate_numbered(&positions)?;
        let of_faces = |is_given: bool, value: fn(&Face) -> u32| match is_given {
            true => faces.iter().map(|&face| value(&statements.faces[face as usize])).collect(),
            false => Vec::new(),
        };
        Ok(MeshSource {
            face_material: of_faces(!statements.materials.is_empty(), |face| face.material),
            face_part: of_faces(!statements.parts.is_empty(), |face| face.part),
            materials: statements.materials.clone(),
            parts: statements.parts.clone(),
            warnings: statements.warnings.clone(),
            normals: self.gather(&statements.normals, |(corner, _)| corner.normal, [0.0; 3]),
            uvs: self.gather(&statements.uvs, |(corner, _)| corner.uv, [0.0; 2]),
            albedo: self.albedo(statements),
            positions,
            triangles,
            ..MeshSource::default()
        })
    }

    /// One value for each vertex, or nothing when no vertex names one.
    fn gather<T: Copy>(&self, values: &[T], index: impl Fn(&Key) -> u32, missing: T) -> Vec<T> {
        if self.keys.iter().all(|key| index(key) == NONE) {
            return Vec::new();
        }
        self.keys.iter().map(|key| values.get(index(key) as usize).copied().unwrap_or(missing)).collect()
    }

    /// The material's colour, else the vertex's own, else NaN.
    fn albedo(&self, statements: &Statements) -> Vec<[f32; 3]> {
        if statements.materials.is_empty() && statements.colors.is_empty() {
            return Vec::new();
        }
        let colors = linear_colors(&statements.colors);
        let vertex_color = |position: u32| colors.get(position as usize).copied().unwrap_or([f32::NAN; 3]);
        self.keys
            .iter()
            .map(|&(corner, material)| match statements.materials.get(material as usize) {
                Some(material) => match statements.uvs.get(corner.uv as usize) {
                    Some(&uv) => material.color(uv),
                    None => [0, 1, 2].map(|channel| material.base_color[channel]),
                },
                None => vertex_color(corner.position),
            })
            .collect()
    }
}

/// Vertex colours to linear; a file with a value above 1 counts to 255. A colour with a part that is no number is none.
fn linear_colors(colors: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let counts_to_255 = colors.iter().flatten().any(|&value| value > 1.0);
    let scale = if counts_to_255 { 1.0 / 255.0 } else { 1.0 };
    colors
        .iter()
        .map(|color| {
            let color = color.map(|value| srgb_to_linear((value * scale).clamp(0.0, 1.0)));
            if color.iter().any(|value| value.is_nan()) { [f32::NAN; 3] } else { color }
        })
        .collect()
}
