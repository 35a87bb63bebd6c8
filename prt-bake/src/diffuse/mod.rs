//! Diffuse transfer vectors: unshadowed, shadowed, interreflected.
//!
//! `T = 1/π ∫ V(s) max(n·s, 0) y(s) ds`, plus what other surfaces reflect towards the point. Source: [SKS02](sh_core#references) sections 4.1 and 5.

mod bounce;
mod direct;
mod hit;
mod inside;
mod nearest;
mod origin;
mod stats;
mod validity;

use std::time::{Duration, Instant};

use crate::parallel::Threads;
use crate::sampling::DirectionSet;
use crate::{BakeOptions, BakedSurface, Error, Geometry, Mesh, Metadata, Pass, Progress, Scene, TransferVectors};
pub(crate) use bounce::Bounces;
use direct::DirectPass;
pub(crate) use direct::add_scaled;
pub(crate) use hit::HitRecord;
pub(crate) use inside::InsidePlan;
pub use stats::VertexStats;
use validity::ValidityTest;

/// What a bake did.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BakeReport {
    /// Rays traced, for shadows and for interreflection.
    pub rays_traced: u64,
    /// Share of the rays towards the light that met something.
    pub occluded_share: f64,
    /// Time to build the tree and the set of directions.
    pub build: Duration,
    /// Time to trace and sum.
    pub trace: Duration,
    /// Threads used.
    pub threads: usize,
    /// Estimated relative root-mean-square error of the shadowed transfer vectors; see [`Metadata::error`].
    pub error: Option<f64>,
    /// Mean length of what each bounce added, relative to the direct transfer.
    pub bounce_energy: Vec<f64>,
    /// Vertices that lie inside of solids: those that are not [valid](VertexStats::is_valid).
    pub invalid_vertices: usize,
    /// What was found at each vertex; empty where no ray was traced.
    pub vertices: Vec<VertexStats>,
}

/// Bakes diffuse transfer for every vertex of a mesh.
///
/// Shadowed transfer is the analytic unshadowed vector less the sum over the occluded directions, so that a vertex that sees the whole
/// sky is exact. The error at 4,096 rays and order 6 is about 2e-3 of the unshadowed vector; the report estimates it for the mesh
/// at hand, and `repro -- prt/error-against-rays` of `prt-benches` draws its curve. Sums are in `f64`. Same options, same bytes, for any number of threads.
///
/// Surfaces are one-sided: the back of a face occludes and reflects nothing. Where the smooth normal sees below the true surface, the
/// surface itself occludes, so there is no light from below but the shadow terminator can show on coarse meshes.
///
/// # Errors
/// If an option is out of range, or the caller cancels.
pub fn bake_diffuse(
    mesh: &Mesh,
    options: &BakeOptions,
    progress: &dyn Progress,
) -> Result<(BakedSurface, BakeReport), Error> {
    options.validate()?;
    let mut report = BakeReport::default();
    if !options.shadowed {
        return Ok((surface(mesh, options, TransferVectors::unshadowed(options.order, mesh.normals())), report));
    }
    let start = Instant::now();
    let threads = Threads::new(options.threads)?;
    let scene = Scene::new(mesh);
    let origins = origin::ray_origins(mesh, &scene);
    let directions = DirectionSet::new(2 * options.rays_per_vertex, options.order, options.seed);
    report.build = start.elapsed();
    report.threads = threads.count();

    let start = Instant::now();
    let direct = DirectPass { scene: &scene, directions: &directions, normals: mesh.normals(), origins: &origins };
    let validity = ValidityTest::new(&scene, mesh);
    let (mut shadowed, hits) = shadowed(&direct, &validity, options, &threads, progress, &mut report)?;
    report.error = Some(estimate_error(&direct, options, &shadowed));
    let plan = inside_plan(mesh, options, &mut report);
    plan.apply(&mut shadowed);
    let mut baked = surface(mesh, options, shadowed);
    if options.bounces > 0 {
        interreflect(mesh, options, &plan, &hits, &mut baked, &threads, progress, &mut report)?;
    }
    baked.metadata.bounces = report.bounce_energy.len();
    report.trace = start.elapsed();
    baked.metadata.error = report.error;
    Ok((baked, report))
}

fn surface(mesh: &Mesh, options: &BakeOptions, transfer: TransferVectors) -> BakedSurface {
    BakedSurface {
        metadata: Metadata {
            rays: if options.shadowed { options.rays_per_vertex } else { 0 },
            bounces: options.bounces,
            seed: options.seed,
            shadowed: options.shadowed,
            ..Metadata::default()
        },
        geometry: Geometry::of(mesh),
        transfer,
        transfer_shadowed: None,
    }
}

/// Traces towards the light from every vertex; remembers the hits if light is to be reflected.
fn shadowed(
    direct: &DirectPass,
    validity: &ValidityTest,
    options: &BakeOptions,
    threads: &Threads,
    progress: &dyn Progress,
    report: &mut BakeReport,
) -> Result<(TransferVectors, Vec<Vec<HitRecord>>), Error> {
    let mut transfer = TransferVectors::zero(direct.normals.len(), 1, options.order);
    let mut hits = vec![Vec::new(); direct.normals.len()];
    let rows = transfer.values.chunks_exact_mut(options.order.coeff_count());
    let mut items: Vec<_> = rows.zip(&mut hits).map(|(row, hits)| (row, hits, VertexStats::default())).collect();
    progress.start(Pass::Direct, items.len());
    threads.for_each(
        &mut items,
        progress,
        || direct.scratch(),
        |scratch, vertex, (row, hits, stats)| {
            *stats = direct.shadowed_vector(scratch, vertex, row);
            validity.complete(vertex, direct.origins[vertex], stats);
            if options.bounces > 0 {
                stats.rays += direct.nearest_hits(scratch, vertex, hits);
            }
            u64::from(stats.rays)
        },
    )?;
    report.vertices = items.into_iter().map(|(.., stats)| stats).collect();
    let sum = |count: fn(&VertexStats) -> u32| report.vertices.iter().map(|stats| u64::from(count(stats))).sum::<u64>();
    report.rays_traced = sum(|stats| stats.rays);
    report.occluded_share = sum(|stats| stats.occluded) as f64 / (sum(|stats| stats.directions) as f64).max(1.0);
    Ok((transfer, hits))
}

/// Counts the vertices inside of solids, and says what becomes of them.
fn inside_plan(mesh: &Mesh, options: &BakeOptions, report: &mut BakeReport) -> InsidePlan {
    let is_valid: Vec<bool> = report.vertices.iter().map(VertexStats::is_valid).collect();
    report.invalid_vertices = is_valid.iter().filter(|&&is_valid| !is_valid).count();
    InsidePlan::new(options.inside, mesh.triangles(), mesh.positions(), &is_valid)
}

/// Adds the bounces to a surface that holds direct transfer.
#[expect(clippy::too_many_arguments, reason = "the parts of one bake")]
fn interreflect(
    mesh: &Mesh,
    options: &BakeOptions,
    plan: &InsidePlan,
    hits: &[Vec<HitRecord>],
    baked: &mut BakedSurface,
    threads: &Threads,
    progress: &dyn Progress,
    report: &mut BakeReport,
) -> Result<(), Error> {
    let mut bounces = Bounces::new(mesh.triangles(), mesh.albedo(), &baked.transfer).with_inside(plan);
    for bounce in 1..=options.bounces {
        progress.start(Pass::Bounce(bounce), mesh.positions().len());
        let added = bounces.next(hits, threads, progress)?;
        report.bounce_energy.push(added);
        if options.bounce_threshold.is_some_and(|threshold| added < threshold) {
            break;
        }
    }
    let shadowed = std::mem::replace(&mut baked.transfer, bounces.into_total());
    baked.transfer_shadowed = options.keep_shadowed.then_some(shadowed);
    Ok(())
}

/// Vertices at which the error is estimated.
const ERROR_SAMPLES: usize = 64;

/// Bakes some vertices again with another rotation of the directions. Two independent results differ by √2 times the error of one.
fn estimate_error(direct: &DirectPass, options: &BakeOptions, transfer: &TransferVectors) -> f64 {
    let seed = options.seed.wrapping_add(0x5bd1_e995);
    let directions = DirectionSet::new(2 * options.rays_per_vertex, options.order, seed);
    let again = DirectPass { directions: &directions, ..*direct };
    let mut scratch = again.scratch();
    let mut row = vec![0.0; options.order.coeff_count()];
    let mut unshadowed = vec![0.0; options.order.coeff_count()];
    let (mut difference, mut signal) = (0.0, 0.0);
    let vertex_count = direct.normals.len();
    for vertex in (0..vertex_count).step_by(vertex_count.div_ceil(ERROR_SAMPLES)) {
        again.shadowed_vector(&mut scratch, vertex, &mut row);
        crate::transfer::unshadowed_vector(options.order, direct.normals[vertex], &mut unshadowed);
        difference += row.iter().zip(transfer.vector(vertex, 0)).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>();
        signal += unshadowed.iter().map(|value| value * value).sum::<f64>();
    }
    (0.5 * difference / signal).sqrt()
}

#[cfg(test)]
mod tests;
