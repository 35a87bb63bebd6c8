use crate::surface::{all_finite, check_length, check_triangles};
use crate::{Error, Lobes};

/// A surface with lobes per vertex, borrowed from the caller and checked once.
///
/// The lobes' axes stand in the frame of the scene, in the rest pose. When the surface deforms, the frame of a vertex is the rotation
/// from its rest to its deformed pose.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct LobeSurface<'a> {
    /// `[V]`, scene units.
    pub positions: &'a [[f32; 3]],
    /// `[T]`, counterclockwise seen from the lit side. The other side is black.
    pub triangles: &'a [[u32; 3]],
    /// `[V]`, linear.
    pub albedo: &'a [[f32; 3]],
    /// Lobes of `V` points.
    pub lobes: Lobes<'a>,
    /// `[V]`, tangent, bitangent and normal in the rest pose: the frames in which a view map is looked up.
    pub local_frames: Option<&'a [[[f32; 3]; 3]]>,
}

impl<'a> LobeSurface<'a> {
    /// Checks shapes, indices and that the albedo is finite.
    ///
    /// Positions may be NaN or infinite: triangles that use them are not drawn.
    ///
    /// # Errors
    /// [`Error::Length`], [`Error::VertexIndex`], [`Error::NotFinite`].
    pub fn new(
        positions: &'a [[f32; 3]],
        triangles: &'a [[u32; 3]],
        albedo: &'a [[f32; 3]],
        lobes: Lobes<'a>,
    ) -> Result<Self, Error> {
        let vertices = positions.len();
        let because = || format!("a surface of {vertices} vertices");
        check_length("albedo", albedo.len(), "entries", vertices, because)?;
        check_length("lobes", lobes.point_count(), "points", vertices, because)?;
        check_triangles(triangles, vertices)?;
        check_albedo("albedo of vertex", albedo)?;
        Ok(Self { positions, triangles, albedo, lobes, local_frames: None })
    }

    /// With the rest pose's tangent frames `[V]`, which glossy lobes need: a view map is looked up there. Without them it is looked up
    /// in the frame of the scene. Frames that are not orthonormal are replaced, as in [`crate::cpu::shade_lobes`].
    ///
    /// # Errors
    /// [`Error::Length`].
    pub fn with_local_frames(self, frames: &'a [[[f32; 3]; 3]]) -> Result<Self, Error> {
        let vertices = self.vertex_count();
        check_length("local frames", frames.len(), "entries", vertices, || {
            format!("a surface of {vertices} vertices")
        })?;
        Ok(Self { local_frames: Some(frames), ..self })
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }
}

pub(crate) fn check_albedo(what: &'static str, albedo: &[[f32; 3]]) -> Result<(), Error> {
    match albedo.iter().position(|a| !all_finite(a)) {
        Some(item) => Err(Error::NotFinite { what, item }),
        None => Ok(()),
    }
}
