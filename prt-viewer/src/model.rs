//! What is shown: a surface with transfer of some kind, in a pose.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};
use prt_anim::{Deformed, push_tangent_frames, tangent_frames};
use prt_bake::{
    BakeOptions, BakedFile, BakedSurface, Geometry, HeightField, Material, Mesh, MeshOptions, MeshSource, Metadata,
    Progress, TransferVectors, ZonalSurface, ZonalTexture, ZonalTransfer, bake_diffuse, load_mesh,
};
use sh_core::Order;

use crate::base_surface::BaseSurface;
use crate::motion::{Actor, Motion};
use crate::shading::{Part, PartTransfer};
use crate::showcase::trace_membrane;
use crate::{arguments, lobes};

/// A surface with its transfer, and what moves it.
#[derive(Debug)]
pub(crate) struct Model {
    pub(crate) content: Content,
    pub(crate) actor: Option<Actor>,
    /// Transparency `[V]` of a thin membrane, which is then what is traced.
    pub(crate) membrane: Option<Vec<f32>>,
}

/// The surface, by the kind of its transfer.
#[derive(Debug)]
pub(crate) enum Content {
    /// A transfer vector at each vertex; it does not follow a deformation.
    Vectors(BakedSurface),
    /// Lobes at each vertex.
    Lobes(ZonalSurface),
    /// Lobes at each texel.
    Textured(Box<Textured>),
}

/// A texture of lobes on a surface.
#[derive(Debug)]
pub(crate) struct Textured {
    pub(crate) texture: ZonalTexture,
    pub(crate) geometry: Geometry,
    /// The surface, if it is one of ours; its relief can then be traced.
    pub(crate) base: Option<BaseSurface>,
    /// Columns and rows of the grid of a surface of ours.
    cells: [usize; 2],
    /// Tiles along u and v.
    pub(crate) repeat: [usize; 2],
    /// Tangent, bitangent and normal of each vertex in the rest pose.
    rest_frames: Vec<[[f32; 3]; 3]>,
}

/// What a texture is laid over.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum On {
    Base(BaseSurface),
    Mesh(PathBuf),
}

impl On {
    /// The name of a surface of ours, or a file.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let base = <BaseSurface as clap::ValueEnum>::from_str(text, true).ok().filter(|_| !Path::new(text).exists());
        Ok(base.map_or_else(|| Self::Mesh(text.into()), Self::Base))
    }
}

/// The file to show, on the command line.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct ModelArguments {
    /// The baked file
    pub(crate) file: PathBuf,
    /// What a texture is laid over: patch, cylinder, vase, or a mesh with texture coordinates
    #[arg(long, value_name = "SURFACE|FILE", default_value = "vase", value_parser = On::parse)]
    on: On,
    /// Tiles of a texture around its surface, or along each unit of a mesh's texture coordinates
    #[arg(long, value_name = "COUNT", default_value = "8", value_parser = arguments::tiles)]
    tiles: usize,
}

impl ModelArguments {
    /// # Errors
    /// As [`Model::read`].
    pub(crate) fn read(&self) -> anyhow::Result<Model> {
        Model::read(&self.file, &self.on, self.tiles)
    }
}

impl Textured {
    /// Lays a texture over one of our surfaces.
    ///
    /// - `cells`: columns and rows of the grid
    /// - `repeat`: tiles along u and v
    pub(crate) fn on_base(
        texture: ZonalTexture,
        base: BaseSurface,
        cells: [usize; 2],
        repeat: [usize; 2],
    ) -> anyhow::Result<Self> {
        let geometry = geometry_of(base.grid(cells), texture.albedo)?;
        Self::new(texture, geometry, Some(base), cells, repeat)
    }

    /// Lays a texture over a mesh with texture coordinates.
    fn on_mesh(texture: ZonalTexture, path: &Path, tiles: usize) -> anyhow::Result<Self> {
        let mut source = load_mesh(path)?;
        if !path
            .extension()
            .is_some_and(|extension| ["glb", "gltf"].iter().any(|gltf| extension.eq_ignore_ascii_case(gltf)))
        {
            // Only in glTF v runs down, as the rows of an image do.
            source.uvs.iter_mut().for_each(|[_, v]| *v = 1.0 - *v);
        }
        ensure!(!source.uvs.is_empty(), "cannot lay a texture over {}: it has no texture coordinates", path.display());
        let geometry = geometry_of(source, texture.albedo).with_context(|| format!("cannot use {}", path.display()))?;
        Self::new(texture, geometry, None, [0; 2], [tiles; 2])
    }

    fn new(
        texture: ZonalTexture,
        geometry: Geometry,
        base: Option<BaseSurface>,
        cells: [usize; 2],
        repeat: [usize; 2],
    ) -> anyhow::Result<Self> {
        let uvs = geometry.uvs.as_deref().context("the surface has no texture coordinates")?;
        let rest_frames = tangent_frames(&geometry.positions, &geometry.normals, uvs, &geometry.triangles);
        Ok(Self { rest_frames, texture, geometry, base, cells, repeat })
    }

    /// The mesh with the relief of the texture raised on it, on the same grid.
    fn relief(&self) -> anyhow::Result<MeshSource> {
        let Some(base) = self.base else { bail!("the relief of a texture is traced on our own surfaces alone") };
        let ZonalTexture { width, height, heights, .. } = &self.texture;
        let field = HeightField::new(*width, *height, heights.clone())?;
        Ok(base.relief(self.cells, self.repeat, |[u, v]| field.height_at(u, v)))
    }
}

fn geometry_of(source: MeshSource, albedo: [f32; 3]) -> anyhow::Result<Geometry> {
    let (mesh, _) = Mesh::new(source, &MeshOptions { albedo, ..MeshOptions::default() })?;
    Ok(Geometry::of(&mesh))
}

impl From<BakedSurface> for Model {
    fn from(surface: BakedSurface) -> Self {
        Self { content: Content::Vectors(surface), actor: None, membrane: None }
    }
}

impl Model {
    /// Reads a baked file; a mesh gets told what to do first.
    ///
    /// - `on`: what a texture is laid over, and the tiles along u
    ///
    /// # Errors
    /// If the file cannot be read, or shows nothing.
    pub(crate) fn read(path: &Path, on: &On, tiles: usize) -> anyhow::Result<Self> {
        const MESHES: [&str; 5] = ["glb", "gltf", "obj", "ply", "off"];
        let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
        let is_mesh = MESHES.iter().any(|mesh| extension.eq_ignore_ascii_case(mesh));
        ensure!(!is_mesh, "cannot show {}: it is a mesh; bake it first, with `prt bake`", path.display());
        let content = match BakedFile::read(path)? {
            BakedFile::Vectors(surface) => Content::Vectors(surface),
            BakedFile::Zonal(surface) => Content::Lobes(surface),
            BakedFile::Texture(texture) => Content::Textured(Box::new(match on {
                On::Base(base) => {
                    let repeat = base.repeat(tiles);
                    let cells = BaseSurface::cells(repeat, [texture.width, texture.height]);
                    Textured::on_base(texture, *base, cells, repeat)?
                }
                On::Mesh(mesh) => Textured::on_mesh(texture, mesh, tiles)?,
            })),
        };
        let model = Self { content, actor: None, membrane: None };
        ensure!(!model.geometry().triangles.is_empty(), "cannot show {}: it has no triangles", path.display());
        Ok(model)
    }

    /// The model in the pose that was baked.
    pub(crate) fn geometry(&self) -> &Geometry {
        match &self.content {
            Content::Vectors(surface) => &surface.geometry,
            Content::Lobes(surface) => &surface.geometry,
            Content::Textured(textured) => &textured.geometry,
        }
    }

    pub(crate) fn metadata(&self) -> &Metadata {
        match &self.content {
            Content::Vectors(surface) => &surface.metadata,
            Content::Lobes(surface) => &surface.metadata,
            Content::Textured(textured) => &textured.texture.metadata,
        }
    }

    pub(crate) fn order(&self) -> Order {
        match &self.content {
            Content::Vectors(surface) => surface.transfer.order,
            Content::Lobes(surface) => surface.transfer.order,
            Content::Textured(textured) => textured.texture.transfer.order,
        }
    }

    /// What is said of the transfer in a word.
    pub(crate) fn kind(&self) -> String {
        match &self.content {
            Content::Vectors(_) => "transfer vectors".to_owned(),
            Content::Lobes(surface) => describe(&surface.transfer),
            Content::Textured(textured) => {
                let ZonalTexture { width, height, transfer, .. } = &textured.texture;
                let material = match textured.texture.material {
                    Material::Diffuse => "",
                    Material::Glossy => "glossy ",
                    Material::Translucent => "translucent ",
                };
                format!("{material}texture {width}x{height} of {}", describe(transfer))
            }
        }
    }

    /// Whether transfer can follow a deformation.
    pub(crate) fn is_deformable(&self) -> bool {
        !matches!(self.content, Content::Vectors(_))
    }

    /// The parts that can be shown, the fullest last; the traced one, which takes time, comes first.
    pub(crate) fn parts(&self) -> Vec<Part> {
        match &self.content {
            Content::Vectors(surface) => {
                let is_there = |part: &Part| match part {
                    Part::Full => surface.metadata.bounces > 0,
                    part => part.vectors(surface).is_ok(),
                };
                [Part::Unshadowed, Part::Shadowed, Part::Full].into_iter().filter(is_there).collect()
            }
            // A membrane casts no shadow on itself: its lobes are the unshadowed ones.
            Content::Lobes(_) if self.membrane.is_some() => vec![Part::Traced, Part::Undeformed, Part::Full],
            Content::Lobes(_) => vec![Part::Traced, Part::Unshadowed, Part::Undeformed, Part::Full],
            Content::Textured(textured) if textured.texture.material != Material::Diffuse => {
                vec![Part::Undeformed, Part::Full]
            }
            Content::Textured(textured) if textured.base.is_some() => {
                vec![Part::Traced, Part::Unshadowed, Part::Undeformed, Part::Full]
            }
            Content::Textured(_) => vec![Part::Unshadowed, Part::Undeformed, Part::Full],
        }
    }

    /// The model in a pose.
    pub(crate) fn pose(&self, motion: &Motion) -> Deformed {
        motion.pose(self.geometry(), self.actor.as_ref())
    }

    /// The transfer of a part.
    ///
    /// - `motion`: the pose that a traced part is traced in
    /// - `rays`: per vertex, for a traced part
    ///
    /// # Errors
    /// If the file does not hold the part, or it cannot be traced.
    pub(crate) fn transfer(
        &self,
        part: Part,
        motion: &Motion,
        rays: usize,
        progress: &dyn Progress,
    ) -> anyhow::Result<PartTransfer<'_>> {
        if self.is_deformable() && !self.parts().contains(&part) {
            bail!("{part} transfer of {} is not known", self.kind());
        }
        if part == Part::Traced {
            return Ok(PartTransfer::Vectors(Cow::Owned(self.trace(motion, rays, progress)?)));
        }
        match &self.content {
            Content::Vectors(_) if part != Part::Undeformed && *motion != Motion::default() => {
                bail!("it holds transfer vectors, which follow no deformation: fit lobes to them, with `prt fit`")
            }
            Content::Vectors(surface) => Ok(PartTransfer::Vectors(part.vectors(surface)?)),
            Content::Lobes(surface) => {
                lobes_of(part, &surface.transfer, &surface.geometry.normals).map(PartTransfer::Lobes)
            }
            Content::Textured(textured) => {
                let ZonalTexture { transfer, normals, .. } = &textured.texture;
                // Unshadowed lobes are about the normals, which are smooth.
                let is_coherent = textured.texture.is_coherent || part == Part::Unshadowed;
                let transfer = lobes_of(part, transfer, normals)?;
                Ok(PartTransfer::Textured { transfer, is_coherent })
            }
        }
    }

    /// The frames that lobes of a part are turned by, in a pose.
    pub(crate) fn frames(&self, part: Part, posed: &Deformed) -> Vec<[[f32; 3]; 3]> {
        const REST: [[f32; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        match (&self.content, part) {
            (Content::Textured(textured), Part::Undeformed) => textured.rest_frames.clone(),
            (Content::Textured(textured), _) => {
                let mut frames = vec![REST; posed.frames.len()];
                push_tangent_frames(&posed.frames, &textured.rest_frames, &mut frames);
                frames
            }
            (_, Part::Undeformed) => vec![REST; posed.frames.len()],
            _ => posed.frames.clone(),
        }
    }

    /// Transfer vectors of the pose, by ray tracing; for a texture with its relief.
    fn trace(&self, motion: &Motion, rays: usize, progress: &dyn Progress) -> anyhow::Result<TransferVectors> {
        let source = match &self.content {
            Content::Textured(textured) => posed_relief(textured, motion)?,
            _ => posed_source(self.geometry(), self.pose(motion)),
        };
        let vertex_count = source.positions.len();
        if let Some(alphas) = &self.membrane {
            return Ok(trace_membrane(self.order(), &source, alphas, rays)?);
        }
        // All faces round off: the vertices must stay those of the model.
        let smooth = MeshOptions { crease_angle: std::f32::consts::PI, ..MeshOptions::default() };
        let (mesh, _) = Mesh::new(source, &smooth).context("cannot trace this pose")?;
        ensure!(mesh.positions().len() == vertex_count, "cannot trace this pose: it has faces without area");
        let metadata = self.metadata();
        let options = BakeOptions {
            order: self.order(),
            rays_per_vertex: rays,
            shadowed: metadata.shadowed,
            bounces: metadata.bounces,
            seed: metadata.seed,
            ..BakeOptions::default()
        };
        Ok(bake_diffuse(&mesh, &options, progress)?.0.transfer)
    }
}

/// Lobes of a part.
///
/// - `normals`: in the frame of the lobes
fn lobes_of<'a>(
    part: Part,
    transfer: &'a ZonalTransfer,
    normals: &[[f32; 3]],
) -> anyhow::Result<Cow<'a, ZonalTransfer>> {
    match part {
        Part::Full | Part::Undeformed => Ok(Cow::Borrowed(transfer)),
        Part::Unshadowed => lobes::unshadowed(transfer.order, normals).map(Cow::Owned),
        Part::Shadowed | Part::Traced => bail!("it holds lobes of one kind of transfer: full, undeformed, unshadowed"),
    }
}

/// The mesh of a pose, with its normals.
fn posed_source(geometry: &Geometry, posed: Deformed) -> MeshSource {
    MeshSource {
        positions: posed.positions.iter().map(|position| position.map(f64::from)).collect(),
        normals: posed.normals,
        albedo: geometry.albedo.clone(),
        triangles: geometry.triangles.clone(),
        ..MeshSource::default()
    }
}

/// The mesh of a texture's surface with its relief, deformed.
fn posed_relief(textured: &Textured, motion: &Motion) -> anyhow::Result<MeshSource> {
    let mut source = textured.relief()?;
    if let Some(deformation) = motion.deformation(&textured.geometry) {
        source.positions.iter_mut().for_each(|position| *position = deformation.apply(*position));
    }
    source.uvs.clear();
    source.albedo.clone_from(&textured.geometry.albedo);
    Ok(source)
}

fn describe(transfer: &ZonalTransfer) -> String {
    let ZonalTransfer { rows, channels, lobe_count, .. } = transfer;
    let lobes = if *lobe_count == 1 { "1 lobe".to_owned() } else { format!("{lobe_count} lobes") };
    let rows = if *rows == 1 { String::new() } else { format!(" in {rows} glossy rows") };
    let channels = if *channels == 1 { "" } else { ", 3 channels" };
    format!("{lobes}{rows}{channels}")
}
