//! Lobes that correspond between neighbouring vertices.

mod assignment;
mod between;
mod matching;

pub use between::{BetweenError, interpolation_error};
pub use matching::match_lobes;

use crate::blend::Blend;
use crate::conjugate::{Limits, Search};
use crate::field::{Link, Sample, refine};
use crate::grid::validate;
use crate::misfit::{assert_targets, finite, relative_error};
use crate::parallel::Threads;
use crate::{Error, LobeSet, Neighbours};

/// How lobes are made to correspond.
#[derive(Debug, Clone, PartialEq)]
pub struct CoherentOptions {
    /// What a difference of the lobes of neighbours costs, in units of an error of the same size: the mean over the neighbours of
    /// the squared length of the difference, lobe by lobe, times this is added to the squared error of each vertex.
    pub smoothness: f64,
    /// What an error half way along an edge costs, in units of an error at a vertex: lobes are fitted there to the mean of both
    /// ends.
    pub between: f64,
    /// Stages of the fit, each with a tenth of the smoothness of the one before, ending at `smoothness`. The first ones move
    /// vertices that were fitted to different minima into the same one.
    pub stages: usize,
    /// Most iterations of the conjugate gradients in each stage; 0 only matches order and sign.
    pub max_iterations: usize,
    /// Three iterations in a row that lower the cost by less than this part of it end a stage.
    pub tolerance: f64,
    /// Number of threads; all that the machine has if `None`. The result is the same for any number.
    pub threads: Option<usize>,
}

impl CoherentOptions {
    /// Checks every setting.
    ///
    /// # Errors
    /// [`Error::Parameter`] names the first setting that cannot be used.
    pub fn validate(&self) -> Result<(), Error> {
        for (what, given) in [("smoothness", self.smoothness), ("weight between vertices", self.between)] {
            if !(0.0..=1e6).contains(&given) {
                return Err(Error::Parameter { what, given, accepted: "0..=1e6" });
            }
        }
        if !(1..=10).contains(&self.stages) {
            return Err(Error::Parameter { what: "number of stages", given: self.stages as f64, accepted: "1..=10" });
        }
        validate(self.max_iterations, self.tolerance)
    }
}

impl Default for CoherentOptions {
    fn default() -> Self {
        Self { smoothness: 1e-3, between: 1.0, stages: 3, max_iterations: 100, tolerance: 1e-3, threads: None }
    }
}

/// What was done to make lobes correspond.
#[derive(Debug, Clone, PartialEq)]
pub struct CoherentReport {
    /// Vertices whose lobes changed places or sides.
    pub matched: usize,
    /// The relative error at the vertices before.
    pub error_before: f64,
    /// The relative error at the vertices afterwards.
    pub error_after: f64,
    /// Iterations of all stages.
    pub iterations: usize,
    /// Evaluations of all stages.
    pub evaluations: usize,
    /// Whether the last stage ended because the cost stood still.
    pub converged: bool,
    /// Vertices whose transfer is not finite; their lobes follow their neighbours.
    pub not_finite: Vec<usize>,
}

/// Makes lobe `j` of every vertex correspond to lobe `j` of its neighbours, so that lobes can be interpolated.
///
/// First order and sign are matched ([`match_lobes`]), which changes no error. Then all vertices are refitted together, from
/// where they are, by conjugate gradients on
///
/// ```text
/// Σ_v |t̃_v − t_v|² + between · Σ_vw ½ (1/d_v + 1/d_w) |t̃_½ − ½(t_v + t_w)|²
///   + smoothness · Σ_vw ½ (1/d_v + 1/d_w) Σ_j |lobe_vj − lobe_wj|²
/// ```
///
/// over vertices `v` and edges `vw`, with the number `d` of neighbours. `t̃_½` is interpolated half way; the difference of two
/// lobes is counted in coefficients and axes, for small ones as the L2 distance of the functions. Explicit coefficients stay.
///
/// - `targets`: `[V, C, n²]`
///
/// The same bytes for any number of threads. On a closed mesh it takes seconds for ten thousand vertices.
///
/// # Errors
/// [`Error::Parameter`] and [`Error::Option`] for options that cannot be used, [`Error::Neighbours`] if `neighbours` has another number of points.
///
/// # Panics
/// If `targets` is not `[V, C, n²]`.
///
/// Source: [SLS05](sh_core#references) section 4.2 does this for textures, by fitting between the nodes.
pub fn make_coherent(
    set: &mut LobeSet,
    targets: &[f32],
    neighbours: &Neighbours,
    options: &CoherentOptions,
) -> Result<CoherentReport, Error> {
    options.validate()?;
    assert_targets(set, targets);
    let error_before = relative_error(set, targets);
    let matched = match_lobes(set, neighbours)?;
    let signal = Signal::new(set, targets, neighbours, options.between);
    let samples = signal.samples();
    let mut total = Search { cost: 0.0, iterations: 0, evaluations: 0, converged: true };
    let threads = Threads::new(options.threads)?;
    let limits = Limits { iterations: options.max_iterations, tolerance: options.tolerance };
    for stage in (0..options.stages).rev().filter(|_| options.max_iterations > 0) {
        let smoothness = options.smoothness * 10_f64.powi(stage as i32);
        let links: Vec<Link> = signal.edges.iter().map(|edge| edge.link(smoothness)).collect();
        let search = refine(set, &samples, &links, limits, &threads);
        total.iterations += search.iterations;
        total.evaluations += search.evaluations;
        total.converged = search.converged;
    }
    Ok(CoherentReport {
        matched,
        error_before,
        error_after: relative_error(set, targets),
        iterations: total.iterations,
        evaluations: total.evaluations,
        converged: total.converged,
        not_finite: signal.not_finite,
    })
}

/// An edge of the mesh and its part of the whole.
#[derive(Debug, Clone, Copy)]
struct Edge {
    ends: [u32; 2],
    weight: f64,
}

impl Edge {
    fn link(&self, smoothness: f64) -> Link {
        Link { points: self.ends.map(|end| end as usize), weight: smoothness * self.weight }
    }
}

/// What is fitted: transfer at vertices and half way along edges.
#[derive(Debug)]
struct Signal<'a> {
    targets: &'a [f32],
    size: usize,
    edges: Vec<Edge>,
    /// `[edges, C, n²]`, if they count.
    middles: Vec<f32>,
    between: f64,
    not_finite: Vec<usize>,
}

impl<'a> Signal<'a> {
    fn new(set: &LobeSet, targets: &'a [f32], neighbours: &Neighbours, between: f64) -> Self {
        let size = set.channels * set.order.coeff_count();
        let edges = edges(neighbours);
        let not_finite = targets.chunks_exact(size).enumerate().filter(|(_, t)| !finite(t)).map(|(v, _)| v).collect();
        let of = |v: u32| &targets[v as usize * size..][..size];
        let mean = |edge: &Edge| of(edge.ends[0]).iter().zip(of(edge.ends[1])).map(|(a, b)| 0.5 * (a + b));
        let middles = if between > 0.0 { edges.iter().flat_map(mean).collect() } else { Vec::new() };
        Self { targets, size, edges, middles, between, not_finite }
    }

    fn samples(&self) -> Vec<Sample<'_>> {
        let vertices = self.targets.chunks_exact(self.size).enumerate();
        let vertices = vertices.map(|(v, target)| Sample { blend: Blend::at(v as u32), weight: 1.0, target });
        let middles = self.edges.iter().zip(self.middles.chunks_exact(self.size));
        let middles = middles.map(|(edge, target)| Sample {
            blend: Blend::midpoint(edge.ends[0], edge.ends[1]),
            weight: self.between * edge.weight,
            target,
        });
        vertices.chain(middles).filter(|sample| finite(sample.target)).collect()
    }
}

/// Every edge once, weighted by the mean of what it is to both of its ends.
fn edges(neighbours: &Neighbours) -> Vec<Edge> {
    let part = |v: u32| 1.0 / neighbours.of(v as usize).len() as f64;
    let from = |v: u32| neighbours.of(v as usize).iter().filter(move |&&w| v < w).map(move |&w| [v, w]);
    let ends = (0..neighbours.point_count() as u32).flat_map(from);
    ends.map(|ends| Edge { ends, weight: 0.5 * (part(ends[0]) + part(ends[1])) }).collect()
}
