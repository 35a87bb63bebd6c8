//! Changes to all that belongs to a vertex, or to a face, at once.

use super::MeshSource;

impl MeshSource {
    /// Keeps the vertices that are marked.
    pub(super) fn retain_vertices(&mut self, keep: &[bool]) {
        retain(&mut self.positions, keep);
        retain(&mut self.normals, keep);
        retain(&mut self.uvs, keep);
        retain(&mut self.albedo, keep);
        retain(&mut self.texture_uvs, keep);
        retain(&mut self.tints, keep);
    }

    /// Appends a copy of a vertex; returns its number.
    pub(super) fn copy_vertex(&mut self, original: u32) -> u32 {
        let number = self.positions.len();
        append_copy(&mut self.positions, original);
        append_copy(&mut self.normals, original);
        append_copy(&mut self.uvs, original);
        append_copy(&mut self.albedo, original);
        append_copy(&mut self.texture_uvs, original);
        append_copy(&mut self.tints, original);
        u32::try_from(number).expect("fewer vertices than u32::MAX: every corner adds at most one")
    }

    /// Keeps the faces that are marked.
    pub(super) fn retain_faces(&mut self, keep: &[bool]) {
        retain(&mut self.triangles, keep);
        retain(&mut self.face_material, keep);
        retain(&mut self.face_part, keep);
    }

    /// Puts the faces that are marked behind the others.
    pub(super) fn move_faces_to_end(&mut self, moved: &[bool]) {
        move_to_end(&mut self.triangles, moved);
        move_to_end(&mut self.face_material, moved);
        move_to_end(&mut self.face_part, moved);
    }

    /// Appends a copy of a face with other corners.
    pub(super) fn copy_face(&mut self, original: usize, corners: [u32; 3]) {
        self.triangles.push(corners);
        append_copy(&mut self.face_material, original as u32);
        append_copy(&mut self.face_part, original as u32);
    }
}

/// Arrays may be empty.
fn append_copy<T: Copy>(values: &mut Vec<T>, original: u32) {
    values.extend(values.get(original as usize).copied());
}

fn retain<T>(values: &mut Vec<T>, keep: &[bool]) {
    let mut keep = keep.iter();
    values.retain(|_| *keep.next().unwrap_or(&false));
}

fn move_to_end<T: Copy>(values: &mut Vec<T>, moved: &[bool]) {
    let of = |which: bool| values.iter().zip(moved).filter(move |&(_, &moved)| moved == which).map(|(&value, _)| value);
    *values = of(false).chain(of(true)).collect();
}
