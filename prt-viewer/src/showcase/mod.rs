//! Things of our own that deform: what `prt demo` shows, each against ray tracing.

mod bat;
mod head;
mod membrane;
mod wrinkles;

use std::path::Path;

use anyhow::Context;
use glam::{Vec3, vec3};
use prt_bake::{
    BakeOptions, BakedSurface, Mesh, MeshOptions, Metadata, TransferVectors, ZonalSurface, ZonalTexture, bake_diffuse,
    load_mesh,
};
use sh_core::Order;
use sh_fit::Neighbours;

use crate::base_surface::BaseSurface;
use crate::gloss::Reflectance;
use crate::lobes;
use crate::model::{Content, Model, Textured};
use crate::motion::{Actor, Motion};
use crate::progress_bar::BakeBar;
use crate::verb::bake_patch::{Common, PatchArguments, Pattern};
use crate::verb::fit::{self, FitArguments, Targets};

use bat::Bat;
pub(crate) use membrane::trace as trace_membrane;

/// What to show.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Name {
    /// A bent patch of bumps
    Patch,
    /// A bent and twisted vase with each texture
    Vase,
    /// A bat with wings of thin membrane that beats them
    Bat,
    /// A cylinder with wrinkles, bent
    Wrinkles,
    /// A head, bent and twisted
    Head,
    /// All of them
    All,
}

/// A model in a pose, and how to look at it.
#[derive(Debug)]
pub(crate) struct Exhibit {
    pub(crate) name: String,
    pub(crate) model: Model,
    pub(crate) motion: Motion,
    /// Direction from the model to the camera.
    pub(crate) from: Vec3,
}

/// How much work to put in.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Effort {
    pub(crate) order: Order,
    pub(crate) lobes: usize,
    pub(crate) rays: usize,
    /// Cells along a side of a texture's tile, for the mesh that its relief is raised on.
    pub(crate) cells: usize,
}

impl Name {
    /// Makes what is shown, one after the other.
    ///
    /// - `mesh`: in place of our own head
    ///
    /// # Errors
    /// If the mesh cannot be read, or the user cancels.
    pub(crate) fn exhibits(self, effort: Effort, mesh: Option<&Path>) -> anyhow::Result<Vec<Exhibit>> {
        match self {
            Self::Patch => Ok(vec![patch(effort)?]),
            Self::Vase => vases(effort),
            Self::Bat => Ok(vec![flapping_bat(effort)?]),
            Self::Wrinkles => Ok(vec![wrinkled_cylinder(effort)?]),
            Self::Head => Ok(vec![bent_head(effort, mesh)?]),
            Self::All => {
                let each = [Self::Patch, Self::Vase, Self::Bat, Self::Wrinkles, Self::Head];
                let exhibits: anyhow::Result<Vec<_>> =
                    each.into_iter().map(|name| name.exhibits(effort, mesh)).collect();
                Ok(exhibits?.into_iter().flatten().collect())
            }
        }
    }
}

/// A relief on a flat square, which is bent.
fn patch(effort: Effort) -> anyhow::Result<Exhibit> {
    let texture = texture(Pattern::Bumps, effort, &PatchArguments::diffuse(effort.lobes), 0)?;
    Ok(Exhibit {
        name: "patch: bumps".to_owned(),
        model: laid_over(texture, BaseSurface::Patch, 6, effort)?,
        motion: Motion { bend: -110.0, ..Motion::default() },
        from: vec3(0.35, 0.25, 1.0),
    })
}

/// Textures as in figure 7 of the paper.
fn vases(effort: Effort) -> anyhow::Result<Vec<Exhibit>> {
    let diffuse = PatchArguments::diffuse(effort.lobes);
    let translucent = diffuse.clone().translucent();
    let glossy = diffuse.clone().glossy(Reflectance::parse("cook-torrance:0.3").map_err(anyhow::Error::msg)?);
    let textures = [
        ("bumps", Pattern::Bumps, &diffuse, 0),
        ("weave", Pattern::Weave, &diffuse, 2),
        ("waffle", Pattern::Waffle, &diffuse, 0),
        ("waffle, translucent", Pattern::Waffle, &translucent, 0),
        ("waffle, glossy", Pattern::Waffle, &glossy, 0),
        ("swirl", Pattern::Swirl, &diffuse, 0),
    ];
    let exhibit = |(name, pattern, arguments, bounces): (&str, Pattern, &PatchArguments, usize)| {
        Ok(Exhibit {
            name: format!("vase: {name}"),
            model: laid_over(texture(pattern, effort, arguments, bounces)?, BaseSurface::Vase, 8, effort)?,
            motion: Motion { bend: 50.0, twist: 110.0, ..Motion::default() },
            from: vec3(0.3, 0.25, 1.0),
        })
    };
    textures.into_iter().map(exhibit).collect()
}

fn texture(
    pattern: Pattern,
    effort: Effort,
    arguments: &PatchArguments,
    bounces: usize,
) -> anyhow::Result<ZonalTexture> {
    let common = Common {
        output: None,
        order: effort.order,
        rays: effort.rays,
        bounces,
        seed: 0,
        threads: None,
        shadowed: true,
        albedo: None,
        json: false,
        texels: None,
    };
    let field = pattern.field(Pattern::SIZE, None)?;
    Ok(arguments.bake(&field, &common)?.texture)
}

/// A texture on one of our surfaces, on a grid that is fine enough that the relief can be traced.
fn laid_over(texture: ZonalTexture, base: BaseSurface, tiles: usize, effort: Effort) -> anyhow::Result<Model> {
    let repeat = base.repeat(tiles);
    let cells = repeat.map(|tiles| tiles * effort.cells);
    let textured = Textured::on_base(texture, base, cells, repeat)?;
    Ok(Model { content: Content::Textured(Box::new(textured)), actor: None, membrane: None })
}

/// The parametric model of a wrinkle, repeated around a cylinder.
fn wrinkled_cylinder(effort: Effort) -> anyhow::Result<Exhibit> {
    const WRINKLES: usize = 12;
    /// Cells across a wrinkle and along it: as its texels.
    const CELLS: [usize; 2] = [32, 96];
    let texture = wrinkles::texture(effort.order)?;
    let textured = Textured::on_base(texture, BaseSurface::Cylinder, [WRINKLES * CELLS[0], CELLS[1]], [WRINKLES, 1])?;
    Ok(Exhibit {
        name: "cylinder: wrinkles".to_owned(),
        model: Model { content: Content::Textured(Box::new(textured)), actor: None, membrane: None },
        motion: Motion { bend: 60.0, twist: 40.0, ..Motion::default() },
        from: vec3(0.4, 0.25, 1.0),
    })
}

/// Single lobes about the normals, in closed form.
fn flapping_bat(effort: Effort) -> anyhow::Result<Exhibit> {
    let Bat { geometry, alphas, skeleton, skin, clip } = Bat::new()?;
    let lobes = sh_fit::membrane_lobes(effort.order, &alphas, &geometry.normals)?;
    let surface = ZonalSurface { metadata: Metadata::default(), geometry, transfer: lobes::stored(lobes) };
    Ok(Exhibit {
        name: "bat: thin membrane".to_owned(),
        model: Model {
            content: Content::Lobes(surface),
            actor: Some(Actor { skeleton, skin, clips: vec![clip] }),
            membrane: Some(alphas),
        },
        motion: Motion { clip: Some((0, 0.22)), ..Motion::default() },
        from: vec3(0.5, -0.25, 1.0),
    })
}

/// Baked as it rests, fitted, then bent and twisted.
fn bent_head(effort: Effort, mesh: Option<&Path>) -> anyhow::Result<Exhibit> {
    let source = mesh.map_or_else(|| Ok(head::head()), load_mesh)?;
    let (mesh, _) = Mesh::new(source, &MeshOptions::default()).context("cannot use the mesh")?;
    let options = BakeOptions { order: effort.order, rays_per_vertex: effort.rays, ..BakeOptions::default() };
    let bar = BakeBar::new();
    let baked = bake_diffuse(&mesh, &options, &bar);
    bar.finish();
    let surface = fitted(baked?.0, effort.lobes)?;
    Ok(Exhibit {
        name: "head".to_owned(),
        model: Model { content: Content::Lobes(surface), actor: None, membrane: None },
        motion: Motion { bend: 40.0, twist: 60.0, ..Motion::default() },
        from: vec3(0.25, 0.1, 1.0),
    })
}

fn fitted(baked: BakedSurface, lobes: usize) -> anyhow::Result<ZonalSurface> {
    let neighbours = Neighbours::from_triangles(baked.geometry.vertex_count(), &baked.geometry.triangles)?;
    let TransferVectors { order, channels, values } = &baked.transfer;
    let targets = Targets { order: *order, channels: *channels, values, neighbours: &neighbours };
    let arguments = FitArguments::lobes(lobes);
    let fitted = arguments.fit(&targets, &arguments.options(0, None))?;
    Ok(fit::surface(baked, &fitted))
}
