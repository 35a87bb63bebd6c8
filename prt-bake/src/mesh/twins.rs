//! Faces that are a surface on both sides.

use std::collections::HashMap;

use super::enclosed::enclosed_faces;
use super::{Mesh, MeshReport, MeshSource};
use crate::Error;

/// Which faces are a surface on both sides: lit, seen and reflecting from behind as well.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TwoSided {
    /// Those whose material says so, if light can get to their back: many exporters mark everything. The back of a face is left out if
    /// the faces that hang together with it by their edges close off a volume without holes, two at each edge in the same sense, and
    /// the face looks out of it: in there all is dark whatever the light.
    #[default]
    AsFile,
    /// All.
    Always,
    /// None: the back of every face occludes and is black.
    Never,
}

/// Puts the two-sided faces behind the others, and their twins behind all.
pub(super) fn add(source: &mut MeshSource, two_sided: TwoSided, report: &mut MeshReport) -> Result<(), Error> {
    let selected = select(source, two_sided, report);
    report.faces_twinned = selected.iter().filter(|&&selected| selected).count();
    if report.faces_twinned == 0 {
        return Ok(());
    }
    if 2 * source.positions.len() > u32::MAX as usize {
        let vertices = source.positions.len();
        return Err(Error::InconsistentMesh(format!(
            "{vertices} vertices of two-sided faces; at most {} are supported",
            u32::MAX / 2
        )));
    }
    source.move_faces_to_end(&selected);
    let mut twin_of = HashMap::new();
    for face in source.triangles.len() - report.faces_twinned..source.triangles.len() {
        let [a, b, c] = source.triangles[face].map(|vertex| {
            *twin_of.entry(vertex).or_insert_with(|| {
                let twin = source.copy_vertex(vertex);
                source.normals[twin as usize] = source.normals[twin as usize].map(|component| -component);
                twin
            })
        });
        source.copy_face(face, [a, c, b]);
    }
    Ok(())
}

fn select(source: &MeshSource, two_sided: TwoSided, report: &mut MeshReport) -> Vec<bool> {
    let as_file = || -> Vec<bool> {
        let material = |face: usize| source.materials.get(*source.face_material.get(face)? as usize);
        (0..source.triangles.len()).map(|face| material(face).is_some_and(|material| material.two_sided)).collect()
    };
    match two_sided {
        TwoSided::Never => Vec::new(),
        TwoSided::Always => vec![true; source.triangles.len()],
        TwoSided::AsFile => {
            let mut selected = as_file();
            if selected.contains(&true) {
                for (selected, enclosed) in selected.iter_mut().zip(enclosed_faces(source)) {
                    report.faces_enclosed += usize::from(*selected && enclosed);
                    *selected &= !enclosed;
                }
            }
            selected
        }
    }
}

impl Mesh {
    /// How many faces have a twin. Of the `T` faces the last `2 · twin_count` are those, and the last `twin_count` the twins.
    #[must_use]
    pub fn twin_count(&self) -> usize {
        self.twin_count
    }

    /// The faces that are not twins: each surface once.
    #[must_use]
    pub fn original_triangles(&self) -> &[[u32; 3]] {
        &self.triangles[..self.triangles.len() - self.twin_count]
    }
}
