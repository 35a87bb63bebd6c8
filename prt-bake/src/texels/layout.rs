//! The faces of a mesh as they lie on an atlas.

use glam::DVec2;

use super::TexelOptions;
use super::grid::Grid;
use crate::{Error, Mesh};

/// A texture coordinate may leave 0 to 1 by this much and still count as rounded.
const ROUNDING: f32 = 1e-5;

/// The faces of a mesh, laid out on texels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) grid: Grid,
    uvs: &'a [[f32; 2]],
}

impl<'a> Layout<'a> {
    /// Checks that every face has one place. The atlas wraps round along u, or v, if a face leaves 0 to 1 there.
    pub(super) fn new(mesh: &'a Mesh, texels: &TexelOptions) -> Result<Self, Error> {
        let fail = |reason: String| Err(Error::Atlas(reason));
        let Some(uvs) = mesh.uvs() else { return fail("the mesh has no texture coordinates".to_owned()) };
        if let Some(vertex) = uvs.iter().position(|uv| !uv.iter().all(|coordinate| coordinate.is_finite())) {
            return fail(format!("vertex {vertex} has the texture coordinates {:?}", uvs[vertex]));
        }
        let leaves = |axis: usize| uvs.iter().any(|uv| !(-ROUNDING..=1.0 + ROUNDING).contains(&uv[axis]));
        let grid =
            Grid { width: texels.width, height: texels.height, wraps: [leaves(0), leaves(1)], v_up: texels.v_up };
        let layout = Self { mesh, grid, uvs };
        layout.check_extents()?;
        Ok(layout)
    }

    /// Refuses faces over which the texture would repeat.
    fn check_extents(&self) -> Result<(), Error> {
        let repeats = |uvs: [[f32; 2]; 3]| {
            [0, 1].iter().any(|&axis| {
                let at = uvs.map(|uv| f64::from(uv[axis]));
                at.into_iter().fold(f64::MIN, f64::max) - at.into_iter().fold(f64::MAX, f64::min)
                    > 1.0 + 2.0 * f64::from(ROUNDING)
            })
        };
        let faces = || (0..self.face_count()).filter(|&face| repeats(self.face_uvs(face)));
        match faces().next() {
            Some(first) => Err(Error::Atlas(format!(
                "the texture repeats over {} of {} faces (the first is face {first}, with the texture coordinates {:?}); each point of the surface needs a place of its own",
                faces().count(),
                self.face_count(),
                self.face_uvs(first)
            ))),
            None => Ok(()),
        }
    }

    pub(super) fn face_count(&self) -> usize {
        self.mesh.original_triangles().len()
    }

    fn uv(&self, vertex: u32) -> [f32; 2] {
        self.uvs[vertex as usize]
    }

    /// The place of a vertex.
    pub(super) fn place(&self, vertex: u32) -> DVec2 {
        self.grid.place(self.uv(vertex))
    }

    fn face_uvs(&self, face: usize) -> [[f32; 2]; 3] {
        self.mesh.triangles()[face].map(|vertex| self.uv(vertex))
    }

    /// The places of a face's corners. Where the atlas wraps round, the one nearest to the first row and column begins on it.
    pub(super) fn corners(&self, face: usize) -> [DVec2; 3] {
        let corners = self.face_uvs(face).map(|uv| self.grid.place(uv));
        let size = self.grid.size();
        let lower = corners[0].min(corners[1]).min(corners[2]);
        let turns = (lower / size).floor() * DVec2::from(self.grid.wraps.map(|wraps| f64::from(u8::from(wraps))));
        corners.map(|corner| corner - turns * size)
    }

    /// Whether a face leaves the atlas on one side and enters it on the other, or lies outside.
    pub(super) fn is_wrapped(&self, face: usize) -> bool {
        self.face_uvs(face).iter().flatten().any(|coordinate| !(-ROUNDING..=1.0 + ROUNDING).contains(coordinate))
    }
}
