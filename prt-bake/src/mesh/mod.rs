//! The triangle mesh: as a file gives it, and as the rest of the crate trusts it.

mod appearance;
mod clean;
#[cfg(feature = "trace")]
mod content;
mod enclosed;
mod links;
mod normals;
mod source;
mod twins;
mod weld;

use crate::{Error, SurfaceMaterial};

pub use twins::TwoSided;
pub(crate) use weld::weld_positions;

/// A mesh as a file gives it, before it is checked: the input of [`Mesh::new`].
///
/// Every per-vertex array is empty or as long as `positions`, every per-face array empty or as long as `triangles`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MeshSource {
    /// Positions, scene units. Kept in `f64` so that a scene far from its origin loses nothing before it is recentred.
    pub positions: Vec<[f64; 3]>,
    /// Shading normals, of any length; `[0, 0, 0]` marks one that is to be computed from the faces.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates.
    pub uvs: Vec<[f32; 2]>,
    /// Diffuse albedo, linear; NaN in the first channel marks a vertex to which the file gives none.
    pub albedo: Vec<[f32; 3]>,
    /// Three vertex numbers a face, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// What faces look like. Where a face's material has a texture, that texture and not `albedo` tells what the face reflects onto
    /// others, and where it has holes.
    pub materials: Vec<SurfaceMaterial>,
    /// For each face the number of its material, or [`SurfaceMaterial::NONE`].
    pub face_material: Vec<u32>,
    /// Coordinates of the materials' textures, where these are others than `uvs`.
    pub texture_uvs: Vec<[f32; 2]>,
    /// Linear colour by which the materials' textures are multiplied.
    pub tints: Vec<[f32; 3]>,
    /// Names of the parts that the file is made of: nodes with a mesh in glTF, objects and groups in OBJ.
    pub parts: Vec<String>,
    /// For each face the number of its part.
    pub face_part: Vec<u32>,
    /// What the reader did otherwise than the file asks for, one sentence each.
    pub warnings: Vec<String>,
}

/// How a mesh is completed where its file is silent.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshOptions {
    /// Largest angle between the normals of two faces that share an edge at which the edge still counts as smooth, in radians.
    /// It matters only where normals are computed.
    pub crease_angle: f32,
    /// Diffuse albedo of vertices without a material, linear.
    pub albedo: [f32; 3],
    /// Ignore the file's normals and compute all of them.
    pub recompute_normals: bool,
    /// Which faces are a surface on both sides.
    pub two_sided: TwoSided,
}

impl Default for MeshOptions {
    /// Creases at 75 degrees, albedo 0.8, the file's own normals, two-sided where the file says so.
    fn default() -> Self {
        Self {
            crease_angle: 75_f32.to_radians(),
            albedo: [0.8; 3],
            recompute_normals: false,
            two_sided: TwoSided::default(),
        }
    }
}

impl MeshOptions {
    fn validate(&self) -> Result<(), Error> {
        if self.crease_angle.is_nan() || self.crease_angle < 0.0 {
            return Err(Error::Option(format!("crease angle {} must not be negative", self.crease_angle)));
        }
        if !self.albedo.iter().all(|channel| (0.0..=1.0).contains(channel)) {
            return Err(Error::Option(format!("albedo {:?} must lie between 0 and 1", self.albedo)));
        }
        Ok(())
    }
}

/// A checked mesh: finite positions, unit normals, albedo in 0 to 1, indices in range, no degenerate and no duplicate face,
/// no vertex without a face.
///
/// Vertices are those of the source in its order, without the ones that no face uses; a vertex on a crease is followed by
/// copies at the end, one for each further smooth patch that meets there. Coincident vertices are welded only for computing normals.
///
/// A two-sided face has a *twin*: the same face seen from behind, with vertices of its own whose normals point the other way, so that each
/// side has its own transfer. Faces come in the order of the source, but those with a twin after those without, and then the twins in
/// the order of their originals; the vertices of twins come last.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    positions: Vec<[f64; 3]>,
    normals: Vec<[f32; 3]>,
    albedo: Vec<[f32; 3]>,
    uvs: Option<Vec<[f32; 2]>>,
    triangles: Vec<[u32; 3]>,
    materials: Vec<SurfaceMaterial>,
    /// `[T]`, or empty if no face has a material.
    face_material: Vec<u32>,
    /// `[V]` or empty.
    texture_uvs: Vec<[f32; 2]>,
    /// `[V]` or empty.
    tints: Vec<[f32; 3]>,
    parts: Vec<String>,
    /// `[T]` or empty.
    face_part: Vec<u32>,
    /// How many faces have a twin.
    twin_count: usize,
    /// Whether the albedo of the vertices holds instead of textures.
    overrides_textures: bool,
}

/// What cleaning a mesh did.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct MeshReport {
    /// Faces without area: two corners at one position, or three on a line; or all closer together than `f32` can tell, 1e-38.
    pub degenerate: usize,
    /// Faces with the same corners, in the same sense of rotation, as an earlier one.
    pub duplicate: usize,
    /// Faces with a corner at an undefined position, or at one too large for `f32`.
    pub non_finite: usize,
    /// Vertices that no remaining face uses.
    pub vertices_unused: usize,
    /// Vertices added because patches with different normals meet in one.
    pub vertices_split: usize,
    /// Vertices whose normal was computed.
    pub normals_computed: usize,
    /// Two-sided faces that got a twin.
    pub faces_twinned: usize,
    /// Two-sided faces that need no twin because no light gets to their back; see [`TwoSided::AsFile`].
    pub faces_enclosed: usize,
    /// What was done otherwise than the file asks for ([`MeshSource::warnings`]), and what will not be exact.
    pub warnings: Vec<String>,
}

impl MeshReport {
    /// Number of faces of the source that are not in the mesh.
    #[must_use]
    pub fn faces_dropped(&self) -> usize {
        self.degenerate + self.duplicate + self.non_finite
    }
}

impl Mesh {
    /// Checks, cleans and completes a mesh.
    ///
    /// # Errors
    /// If arrays differ in length, an index points past the end, an option is out of range, or no usable face remains.
    pub fn new(mut source: MeshSource, options: &MeshOptions) -> Result<(Self, MeshReport), Error> {
        options.validate()?;
        clean::check_shapes(&source)?;
        let warnings = std::mem::take(&mut source.warnings);
        let mut report = MeshReport { warnings, ..MeshReport::default() };
        clean::drop_bad_faces(&mut source, &mut report)?;
        clean::drop_unused_vertices(&mut source, &mut report);
        if options.recompute_normals {
            source.normals.clear();
        }
        normals::complete(&mut source, options.crease_angle, &mut report);
        clean::complete_albedo(&mut source.albedo, source.positions.len(), options.albedo);
        clean::limit_tints(&mut source.tints);
        twins::add(&mut source, options.two_sided, &mut report)?;
        let mesh = Self {
            positions: source.positions,
            normals: source.normals,
            albedo: source.albedo,
            uvs: (!source.uvs.is_empty()).then_some(source.uvs),
            triangles: source.triangles,
            materials: source.materials,
            face_material: source.face_material,
            texture_uvs: source.texture_uvs,
            tints: source.tints,
            parts: source.parts,
            face_part: source.face_part,
            twin_count: report.faces_twinned,
            overrides_textures: false,
        };
        report.warnings.extend(clean::warn_of_small_faces(&mesh));
        Ok((mesh, report))
    }

    /// Positions `[V]`, scene units.
    #[must_use]
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// Shading normals `[V]`, unit length.
    #[must_use]
    pub fn normals(&self) -> &[[f32; 3]] {
        &self.normals
    }

    /// Diffuse albedo `[V]`, linear, between 0 and 1.
    #[must_use]
    pub fn albedo(&self) -> &[[f32; 3]] {
        &self.albedo
    }

    /// Texture coordinates `[V]`, if the source has them.
    #[must_use]
    pub fn uvs(&self) -> Option<&[[f32; 2]]> {
        self.uvs.as_deref()
    }

    /// Triangles `[T]`: three vertex numbers, counter-clockwise seen from outside.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Smallest box around the vertices: lower and upper corner.
    #[must_use]
    pub fn bounds(&self) -> [[f64; 3]; 2] {
        let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        for position in &self.positions {
            for axis in 0..3 {
                bounds[0][axis] = bounds[0][axis].min(position[axis]);
                bounds[1][axis] = bounds[1][axis].max(position[axis]);
            }
        }
        bounds
    }

    /// Sets one albedo for the whole mesh, in place of colours and textures; holes stay.
    ///
    /// # Errors
    /// If a channel is outside 0 to 1.
    pub fn set_albedo(&mut self, albedo: [f32; 3]) -> Result<(), Error> {
        MeshOptions { albedo, ..MeshOptions::default() }.validate()?;
        self.albedo.fill(albedo);
        self.overrides_textures = true;
        Ok(())
    }
}

/// The three corners of a face.
fn corners(positions: &[[f64; 3]], triangle: [u32; 3]) -> [glam::DVec3; 3] {
    triangle.map(|vertex| glam::DVec3::from_array(positions[vertex as usize]))
}

/// A vector scaled to unit length, however short or long it is; zero stays zero.
pub(crate) fn unit_vector(vector: glam::DVec3) -> glam::DVec3 {
    let largest = vector.abs().max_element();
    if largest > 0.0 { (vector / largest).normalize() } else { glam::DVec3::ZERO }
}

#[cfg(test)]
mod tests;
