//! The bake of an atlas, step by step.

use std::time::Instant;

use super::edges::smooth_neighbors;
use super::layout::Layout;
use super::raster::Raster;
use super::trace::TexelBake;
use super::{Coverage, TexelOptions, TexelReport, TexelTransfer, gutter, seam};
use crate::diffuse::Ladder;
use crate::diffuse::{Reflection, ValidityTest};
use crate::parallel::Threads;
use crate::{
    BakeOptions, BakedSurface, Error, InsidePolicy, Mesh, Metadata, Progress, Scene, TransferVectors, bake_diffuse,
};

/// Bakes diffuse transfer for every texel of an atlas that the texture coordinates of a mesh lay out.
///
/// A texel whose centre lies on a face holds the transfer of the point of the surface there: its position and its smooth normal are
/// interpolated, and rays start outside of the face, above it where the smooth normals make it bulge, so that the edges of a coarse mesh do
/// not show in its own shadow. Texels that a bilinear lookup on a face can read but whose
/// centre lies outside of the chart hold the transfer of the surface as far beyond the chart's edge, so that lookups on both sides of a
/// cut agree; where the surface ends or has a crease, that of the face's nearest point. Where faces overlap, the one with the lowest number is
/// baked; of a two-sided face its front is. Faces may be mirrored. Where faces leave 0 to 1 the atlas wraps round, as textures do.
///
/// Shadowed transfer is that of [`bake_diffuse`] at these points. With `b` bounces the vertices are baked first, with `b − 1` of them, and
/// each texel gathers from its own hits what the vertices' transfer sends there (final gathering): `T(p) = T_direct(p) + Σ w ρ(q) T(q)`.
/// Texels inside of solids are treated as [`BakeOptions::inside`] says; filled ones count as empty, and the gutter reaches into them.
///
/// Cost: as many rays as that number of vertices. Memory: the atlas, 9 bytes a texel, the mesh and its tree; while the vertices are baked
/// what that takes. Same options, same bytes, for any number of threads.
///
/// # Errors
/// [`Error::Option`] if an option is out of range, the result would be larger than [`TexelOptions::MAX_VALUES`], or `keep_shadowed` is set;
/// [`Error::Atlas`] if the mesh has no texture coordinates, they are not finite, a texture would repeat over a face, or no face has an
/// area; [`Error::Cancelled`].
pub fn bake_texels(
    mesh: &Mesh,
    options: &BakeOptions,
    texels: &TexelOptions,
    progress: &dyn Progress,
) -> Result<(TexelTransfer, TexelReport), Error> {
    options.validate()?;
    if options.keep_shadowed {
        return Err(Error::Option("texels hold one transfer; bake twice to keep the shadowed one".to_owned()));
    }
    let channels = channel_count(mesh, options);
    texels.validate(options.order, channels)?;
    let start = Instant::now();
    let layout = Layout::new(mesh, texels)?;
    let raster = Raster::new(&layout, progress)?;
    let mut report = TexelReport { build: start.elapsed(), ..TexelReport::default() };
    let vertices = bake_vertices(mesh, options, progress, &mut report)?;
    let mut atlas = empty_atlas(&layout, &raster, options, channels);
    trace(&layout, &raster, options, vertices.as_ref(), progress, &mut atlas, &mut report)?;
    gutter::fill(&mut atlas, texels.gutter);
    describe(&atlas, &layout, &raster, &mut report);
    Ok((atlas, report))
}

/// Colour is carried only if it is reflected.
fn channel_count(mesh: &Mesh, options: &BakeOptions) -> usize {
    if options.bounces > 0 { mesh.channel_count() } else { 1 }
}

/// What the vertices send out, if texels are to gather it: their transfer with one bounce less than the texels get.
fn bake_vertices(
    mesh: &Mesh,
    options: &BakeOptions,
    progress: &dyn Progress,
    report: &mut TexelReport,
) -> Result<Option<BakedSurface>, Error> {
    let Some(bounces) = options.bounces.checked_sub(1) else { return Ok(None) };
    let (baked, vertices) = bake_diffuse(mesh, &BakeOptions { bounces, ..options.clone() }, progress)?;
    report.vertices = Some(vertices);
    Ok(Some(baked))
}

fn empty_atlas(layout: &Layout, raster: &Raster, options: &BakeOptions, channels: usize) -> TexelTransfer {
    TexelTransfer {
        metadata: Metadata {
            rays: if options.shadowed { options.rays_per_vertex } else { 0 },
            seed: options.seed,
            shadowed: options.shadowed,
            ..Metadata::default()
        },
        width: layout.grid.width,
        height: layout.grid.height,
        wraps: layout.grid.wraps,
        v_up: layout.grid.v_up,
        coverage: raster.coverage.clone(),
        transfer: TransferVectors::zero(layout.grid.texel_count(), channels, options.order),
    }
}

/// Fills the texels that have a face.
fn trace(
    layout: &Layout,
    raster: &Raster,
    options: &BakeOptions,
    vertices: Option<&BakedSurface>,
    progress: &dyn Progress,
    atlas: &mut TexelTransfer,
    report: &mut TexelReport,
) -> Result<(), Error> {
    let start = Instant::now();
    let threads = Threads::new(options.threads)?;
    let scene = Scene::new(layout.mesh);
    let ladder = Ladder::new(options);
    let bake = TexelBake {
        layout,
        raster,
        scene: &scene,
        neighbors: smooth_neighbors(layout),
        ladder: &ladder,
        shadowed: options.shadowed,
        validity: ValidityTest::new(&scene, layout.mesh),
        reflection: vertices.map(|baked| {
            let arriving = baked.transfer.with_channels(atlas.transfer.channels);
            Reflection::new(layout.mesh.triangles(), arriving)
        }),
    };
    report.build += start.elapsed();
    report.threads = threads.count();

    let start = Instant::now();
    let found = bake.run(&threads, progress, &mut atlas.transfer)?;
    report.rays_traced = found.rays;
    report.occluded_share = found.occluded as f64 / (found.directions as f64).max(1.0);
    report.texels_invalid = found.invalid.len();
    replace_invalid(options.inside, &found.invalid, atlas);
    report.error = options.shadowed.then(|| bake.estimate_error(options));
    atlas.metadata.error = report.error;
    atlas.metadata.bounces = vertices.map_or(0, |baked| baked.metadata.bounces + 1);
    report.trace = start.elapsed();
    Ok(())
}

/// Empties the texels inside of solids where they are not to be kept; the gutter then reaches into them where they are to be filled. If all
/// are inside, nothing is replaced.
fn replace_invalid(policy: InsidePolicy, invalid: &[usize], atlas: &mut TexelTransfer) {
    let is_all = invalid.len() == atlas.coverage.iter().filter(|coverage| coverage.is_baked()).count();
    if policy == InsidePolicy::Keep || is_all {
        return;
    }
    let length = atlas.transfer.channels * atlas.transfer.order.coeff_count();
    for &texel in invalid {
        atlas.transfer.values[texel * length..][..length].fill(0.0);
        if policy == InsidePolicy::Fill {
            atlas.coverage[texel] = Coverage::Empty;
        }
    }
}

/// Takes down what the atlas has become.
fn describe(atlas: &TexelTransfer, layout: &Layout, raster: &Raster, report: &mut TexelReport) {
    let count = |kind: Coverage| atlas.coverage.iter().filter(|&&coverage| coverage == kind).count();
    report.texels_inside = count(Coverage::Inside);
    report.texels_border = count(Coverage::Border);
    report.texels_filled = count(Coverage::Filled);
    report.texels_empty = count(Coverage::Empty);
    report.texels_overlapping = raster.overlapping;
    report.faces_degenerate = raster.is_degenerate.iter().filter(|&&degenerate| degenerate).count();
    report.faces_wrapped = (0..layout.face_count()).filter(|&face| layout.is_wrapped(face)).count();
    let counts = raster.texels_of_faces().into_iter().zip(&raster.is_degenerate);
    let mut counts: Vec<usize> = counts.filter(|&(_, &degenerate)| !degenerate).map(|(count, _)| count).collect();
    counts.sort_unstable();
    report.faces_without_center = counts.partition_point(|&count| count == 0);
    report.texels_per_face = counts.get(counts.len() / 2).copied().unwrap_or_default();
    let seams = seam::check(atlas, layout);
    (report.seam_edges, report.seam_error, report.seam_max) = (seams.edges, seams.error, seams.max);
}
