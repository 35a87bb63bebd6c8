//! Diffuse transfer vectors: unshadowed, shadowed, interreflected.
//!
//! `T = 1/π ∫ V(s) max(n·s, 0) y(s) ds`, plus what other surfaces reflect towards the point. Source: [SKS02](sh_core#references) sections 4.1 and 5.

mod adaptive;
mod bounce;
mod budget;
mod direct;
mod guide;
mod hit;
mod inside;
mod ladder;
mod nearest;
mod origin;
mod pilot;
mod probe;
mod projection;
mod recommend;
mod savings;
mod stats;
mod validity;

use std::time::Duration;

use crate::{BakeOptions, BakedSurface, Error, Geometry, Mesh, Metadata, Progress, TexelReport, TransferVectors};
pub(crate) use bounce::Reflection;
pub use budget::{TimePlan, error_for_time, error_for_time_of_texels};
pub(crate) use direct::{DirectPass, Scratch, add_scaled};
pub(crate) use hit::HitRecord;
pub(crate) use inside::InsidePlan;
pub(crate) use ladder::Ladder;
pub(crate) use origin::face_origin;
pub use origin::ray_origins;
pub use pilot::{VertexSample, bake_vertices};
pub(crate) use probe::ErrorProbe;
pub use recommend::{OrderReport, recommend_order};
pub use savings::{LevelCount, Savings};
pub use stats::VertexStats;
pub(crate) use validity::ValidityTest;

/// What a bake did.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BakeReport {
    /// Rays traced, for shadows and for interreflection, in all runs of the bake.
    pub rays_traced: u64,
    /// Vertices that an earlier run had traced from.
    pub vertices_resumed: usize,
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
    /// What was saved by stopping early; counts nothing where no ray was traced.
    pub savings: Savings,
    /// What was found at each vertex; empty where no ray was traced.
    pub vertices: Vec<VertexStats>,
    /// What became of the atlas, if texels were baked in place of vertices.
    pub texels: Option<TexelReport>,
}

impl BakeReport {
    /// Takes down what was found at the vertices.
    pub(crate) fn count(&mut self, options: &BakeOptions, vertices: Vec<VertexStats>) {
        let sum = |count: fn(&VertexStats) -> u32| vertices.iter().map(|stats| u64::from(count(stats))).sum::<u64>();
        self.rays_traced = sum(|stats| stats.rays);
        self.occluded_share = sum(|stats| stats.occluded) as f64 / (sum(|stats| stats.directions) as f64).max(1.0);
        let errors = vertices.iter().map(|stats| f64::from(stats.error)).filter(|error| !error.is_nan());
        let (count, squares) = errors.fold((0_u32, 0.0), |(count, sum), error| (count + 1, sum + error * error));
        self.error = (count > 0).then(|| (squares / f64::from(count)).sqrt());
        self.invalid_vertices = vertices.iter().filter(|stats| !stats.is_valid()).count();
        self.savings = Savings::of(options, &vertices);
        self.vertices = vertices;
    }
}

/// Bakes diffuse transfer for every vertex of a mesh.
///
/// Shadowed transfer is the analytic unshadowed vector less the sum over the occluded directions, so that a vertex that sees the whole
/// sky is exact. The error at 4,096 rays and order 6 is about 2e-3 of the unshadowed vector; the report estimates it for the mesh
/// at hand, and `repro -- prt/error-against-rays` of `prt-benches` draws its curve. Sums are in `f64`. Same options, same bytes, for any number of threads.
///
/// The back of a face occludes and reflects nothing, unless the face has a twin; see [`Mesh`]. Rays pass through the holes of materials
/// (see [`SurfaceMaterial`](crate::SurfaceMaterial)), and what a point reflects has the colour of its texture there. Where the smooth normal sees below the true surface, the
/// surface itself occludes. That never happens at the vertices of convex parts, which lie below the tangent plane: there coarse meshes are
/// exact. In the hole of a torus of 48 × 24 vertices coarse faces change transfer by 1.4e-3 (root mean square over the torus), of 24 × 12 by 4.6e-3,
/// of 12 × 6 by 1.4e-2; `tests/tests/closed_forms.rs` asserts it. Vertices inside of solids are treated as [`BakeOptions::inside`] says.
///
/// # Errors
/// If an option is out of range, or the caller cancels.
pub fn bake_diffuse(
    mesh: &Mesh,
    options: &BakeOptions,
    progress: &dyn Progress,
) -> Result<(BakedSurface, BakeReport), Error> {
    options.validate()?;
    crate::job::bake_in_memory(mesh, options, progress)
}

pub(crate) fn unshadowed(mesh: &Mesh, options: &BakeOptions) -> BakedSurface {
    BakedSurface {
        metadata: Metadata { seed: options.seed, ..Metadata::default() },
        geometry: Geometry::of(mesh),
        transfer: TransferVectors::unshadowed(options.order, mesh.normals()),
        transfer_shadowed: None,
        validity: None,
    }
}

#[cfg(test)]
mod tests;
