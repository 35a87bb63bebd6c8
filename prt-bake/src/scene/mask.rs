//! Holes in triangles.

use super::tree::NO_TRIANGLE;
use crate::{Mesh, SurfaceMaterial};

/// The triangles whose material may have holes, by their place in the order of the leaves.
#[derive(Debug, Clone, Default)]
pub(super) struct Masks {
    /// For each triangle its number in `faces`, or [`OPAQUE`]; empty if all are opaque.
    slots: Vec<u32>,
    faces: Vec<MaskedFace>,
    materials: Vec<SurfaceMaterial>,
}

/// A triangle in its texture.
#[derive(Debug, Clone, Copy)]
struct MaskedFace {
    uvs: [[f32; 2]; 3],
    material: u32,
}

/// In place of a number: the triangle has no holes.
const OPAQUE: u32 = u32::MAX;

impl Masks {
    /// - `numbers`: the faces of the mesh in the order of the leaves, [`NO_TRIANGLE`] where there is none
    pub(super) fn new(mesh: &Mesh, numbers: &[u32]) -> Self {
        let holed: Vec<bool> = mesh.materials().iter().map(SurfaceMaterial::may_have_holes).collect();
        if !holed.contains(&true) {
            return Self::default();
        }
        let mut masks = Self { materials: mesh.materials().to_vec(), ..Self::default() };
        for &number in numbers {
            if number == NO_TRIANGLE {
                masks.slots.push(OPAQUE);
                continue;
            }
            let material = mesh.material_number(number as usize);
            let slot = if holed.get(material as usize) == Some(&true) {
                let corner = |barycentric| mesh.texture_uv(number as usize, barycentric);
                masks.faces.push(MaskedFace { uvs: [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(corner), material });
                masks.faces.len() as u32 - 1
            } else {
                OPAQUE
            };
            masks.slots.push(slot);
        }
        masks
    }

    /// Whether a triangle may have holes.
    #[inline(always)]
    pub(super) fn may_have_holes(&self, slot: usize) -> bool {
        self.slots.get(slot).is_some_and(|&face| face != OPAQUE)
    }

    /// Whether a point of a triangle is no hole.
    ///
    /// - `weights`: barycentric weights of the three corners, times any common positive factor
    #[inline(never)]
    pub(super) fn is_opaque(&self, slot: usize, weights: [f32; 3]) -> bool {
        let Some(face) = self.slots.get(slot).and_then(|&face| self.faces.get(face as usize)) else { return true };
        // Where the triangle is seen edge on they may be small and negative.
        let [a, b, c] = weights.map(|weight| weight.max(0.0));
        let sum = (a + b + c).max(f32::MIN_POSITIVE);
        let [p, q, r] = face.uvs;
        let uv = [0, 1].map(|k| (a * p[k] + b * q[k] + c * r[k]) / sum);
        self.materials[face.material as usize].is_there(uv)
    }

    pub(super) fn memory_bytes(&self) -> usize {
        size_of_val(&*self.slots) + size_of_val(&*self.faces)
    }
}
