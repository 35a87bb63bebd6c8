use crate::lobe_surface::check_albedo;
use crate::surface::{all_finite, check_length, check_triangles};
use crate::{Error, Lobes};

/// Lobes per texel, in tangent space: x is the direction of growing u, y of growing v, z the normal.
///
/// Texel (row 0, column 0) begins at uv (0, 0); u grows along columns, v along rows; texel centres are at +½; the texture tiles.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct LobeTexture<'a> {
    /// Texels along u.
    pub width: usize,
    /// Texels along v.
    pub height: usize,
    /// `[H, W]` linear, times the albedo of the surface. Interpolated bilinearly.
    pub albedo: Option<&'a [[f32; 3]]>,
    /// Lobes of `H · W` points.
    pub lobes: Lobes<'a>,
    /// `[H, W]`, unit normals of the relief in tangent space, about which a view map is looked up.
    pub normals: Option<&'a [[f32; 3]]>,
}

impl<'a> LobeTexture<'a> {
    /// Most texels along a side: coordinates stay exact to 1/1024 texel.
    pub const MAX_SIDE: usize = 16_384;

    /// Checks shapes and that the albedo is finite.
    ///
    /// # Errors
    /// [`Error::Lobes`] for a texture without texels or of more than [`LobeTexture::MAX_SIDE`], [`Error::Length`], [`Error::NotFinite`].
    pub fn new(width: usize, height: usize, albedo: Option<&'a [[f32; 3]]>, lobes: Lobes<'a>) -> Result<Self, Error> {
        let sides = 1..=Self::MAX_SIDE;
        if !sides.contains(&width) || !sides.contains(&height) {
            return Err(Error::Lobes(format!(
                "a texture of {width} x {height} texels was given; 1 to {} per side are accepted",
                Self::MAX_SIDE
            )));
        }
        let because = || format!("a texture of {width} x {height}");
        check_length("lobes", lobes.point_count(), "points", width * height, because)?;
        if let Some(albedo) = albedo {
            check_length("albedo", albedo.len(), "texels", width * height, because)?;
            check_albedo("albedo of texel", albedo)?;
        }
        Ok(Self { width, height, albedo, lobes, normals: None })
    }

    /// With the normals of the relief `[H, W]`, which glossy lobes need: a view map is looked up in the frame of the nearest texel's
    /// normal, whose x axis is that of tangent space made perpendicular to it, and y = z × x. Without them it is looked up in tangent space.
    ///
    /// # Errors
    /// [`Error::Length`], [`Error::NotFinite`].
    pub fn with_normals(self, normals: &'a [[f32; 3]]) -> Result<Self, Error> {
        let (width, height) = (self.width, self.height);
        check_length("normals", normals.len(), "texels", width * height, || {
            format!("a texture of {width} x {height}")
        })?;
        match normals.iter().position(|normal| !all_finite(normal)) {
            Some(item) => Err(Error::NotFinite { what: "normal of texel", item }),
            None => Ok(Self { normals: Some(normals), ..self }),
        }
    }
}

/// How a [`LobeTexture`] is looked up between texel centres.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LobeSampling {
    /// Everything from the nearest texel.
    Nearest,
    /// Explicit coefficients bilinearly, lobes from the nearest texel: the way of \[SLS05\] section 6, right for any lobes.
    #[default]
    PointLobes,
    /// Axes and coefficients of lobes bilinearly too: smooth, for textures whose lobes correspond between neighbouring texels.
    Bilinear,
}

/// A surface with a texture of lobes mapped onto it, borrowed from the caller and checked once.
///
/// The frame of a vertex is `[tangent, bitangent, normal]` of the current pose; left-handed ones are right where the texture is mirrored.
/// Radiance is computed at every sample of the image, from interpolated frames, positions, albedo and texture coordinates.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct TexturedSurface<'a> {
    /// `[V]`, scene units.
    pub positions: &'a [[f32; 3]],
    /// `[T]`, counterclockwise seen from the lit side. The other side is black.
    pub triangles: &'a [[u32; 3]],
    /// `[V]`.
    pub uvs: &'a [[f32; 2]],
    /// `[V]`, linear.
    pub albedo: &'a [[f32; 3]],
    /// What is mapped onto it.
    pub texture: LobeTexture<'a>,
    /// Tiles of the texture per unit of uv, along u and v.
    pub repeat: [f32; 2],
    /// How the texture is looked up.
    pub sampling: LobeSampling,
}

impl<'a> TexturedSurface<'a> {
    /// A surface with one tile of the texture per unit of uv, looked up as the paper does.
    ///
    /// Positions may be NaN or infinite: triangles that use them are not drawn.
    ///
    /// # Errors
    /// [`Error::Length`], [`Error::VertexIndex`], [`Error::NotFinite`].
    pub fn new(
        positions: &'a [[f32; 3]],
        triangles: &'a [[u32; 3]],
        uvs: &'a [[f32; 2]],
        albedo: &'a [[f32; 3]],
        texture: LobeTexture<'a>,
    ) -> Result<Self, Error> {
        let vertices = positions.len();
        let because = || format!("a surface of {vertices} vertices");
        check_length("uvs", uvs.len(), "entries", vertices, because)?;
        check_length("albedo", albedo.len(), "entries", vertices, because)?;
        check_triangles(triangles, vertices)?;
        check_albedo("albedo of vertex", albedo)?;
        if let Some(item) = uvs.iter().position(|uv| !all_finite(uv)) {
            return Err(Error::NotFinite { what: "uv of vertex", item });
        }
        Ok(Self { positions, triangles, uvs, albedo, texture, repeat: [1.0; 2], sampling: LobeSampling::default() })
    }

    /// With other tiles per unit of uv.
    ///
    /// # Errors
    /// [`Error::NotFinite`].
    pub fn with_repeat(self, repeat: [f32; 2]) -> Result<Self, Error> {
        match repeat.iter().position(|r| !r.is_finite()) {
            Some(item) => Err(Error::NotFinite { what: "repeat", item }),
            None => Ok(Self { repeat, ..self }),
        }
    }

    /// With another way to look up the texture.
    pub fn with_sampling(self, sampling: LobeSampling) -> Self {
        Self { sampling, ..self }
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }
}
