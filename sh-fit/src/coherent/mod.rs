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
        Self { smoothness: 1e-2, between: 1.0, stages: 3, max_iterations: 100, tolerance: 1e-3, threads: None }
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
/// The same bytes for any number of threads. On max_planck (5,384 vertices, n = 6, N = 4) the relative error at the centres of
/// faces falls from 0.164 to 0.115 by matching and to 0.027 by the default options, and that at the vertices rises from 0.0054 to
/// 0.020, in 13 s on two busy cores (`repro -- ldprt/coherence`, which draws the trade).
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

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    use sh_core::Order;

    use super::*;
    use crate::blend::unit_or_z;
    use crate::{FitOptions, fit_lobes_many};

    const SIZE: usize = 7;

    /// The lobes of a bumpy patch: a cosine lobe about a turning axis, and two sharper ones.
    fn truth(n: usize) -> LobeSet {
        let order = Order::new(n).unwrap();
        let mut set = LobeSet::zeros(order, 1, 3, 1, SIZE * SIZE);
        for point in 0..SIZE * SIZE {
            let (x, y) = ((point % SIZE) as f64 * 0.15 - 0.4, (point / SIZE) as f64 * 0.1 - 0.3);
            let lobes = [([x, y, 1.0], 0.4, 1.0), ([1.0, x, y], 0.7, 0.4 + x), ([y, 1.0, -x], 0.6, y - 0.5)];
            for (lobe, (axis, falloff, size)) in lobes.into_iter().enumerate() {
                set.axes[3 * point + lobe] = unit_or_z(axis).0.map(|x| x as f32);
                let coeffs = &mut set.coeffs[(3 * point + lobe) * n..][1..n];
                coeffs.iter_mut().zip(1..).for_each(|(g, l)| *g = (size * f64::powi(falloff, l)) as f32);
            }
            set.explicit[point] = 1.0;
        }
        set
    }

    fn targets(n: usize) -> Vec<f32> {
        let mut out = vec![0.0; SIZE * SIZE * n * n];
        out.chunks_exact_mut(n * n).enumerate().for_each(|(point, out)| truth(n).reconstruct(point, 0, out));
        out
    }

    fn triangles() -> Vec<[u32; 3]> {
        let quad = |i: usize| {
            let v = (i / (SIZE - 1) * SIZE + i % (SIZE - 1)) as u32;
            [[v, v + 1, v + SIZE as u32], [v + 1, v + SIZE as u32 + 1, v + SIZE as u32]]
        };
        (0..(SIZE - 1) * (SIZE - 1)).flat_map(quad).collect()
    }

    fn fitted(n: usize, lobe_count: usize, targets: &[f32]) -> (LobeSet, Neighbours) {
        let neighbours = Neighbours::from_triangles(SIZE * SIZE, &triangles()).unwrap();
        let options = FitOptions { lobe_count, threads: Some(1), ..FitOptions::default() };
        (fit_lobes_many(Order::new(n).unwrap(), 1, targets, None, &options, &|_| ()).unwrap().0, neighbours)
    }

    /// The sum over edges and lobes of squared differences of coefficients.
    fn roughness(set: &LobeSet, neighbours: &Neighbours) -> f64 {
        let pairs = (0..set.point_count()).flat_map(|v| neighbours.of(v).iter().map(move |&w| (v, w as usize)));
        pairs
            .map(|(v, w)| {
                let coeffs = set.coeffs_of(v, 0).iter().zip(set.coeffs_of(w, 0));
                coeffs.map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>()
            })
            .sum()
    }

    #[test]
    fn interpolated_lobes_get_better() {
        let targets = targets(5);
        let (set, neighbours) = fitted(5, 2, &targets);
        let before = interpolation_error(&set, &targets, &triangles()).unwrap();
        let mut coherent = set.clone();
        let report = make_coherent(&mut coherent, &targets, &neighbours, &CoherentOptions::default()).unwrap();
        let after = interpolation_error(&coherent, &targets, &triangles()).unwrap();
        assert!(after.at_faces < 0.7 * before.at_faces, "{before:?} {after:?} {report:?}");
        assert!(after.at_vertices < 1.3 * before.at_vertices + 1e-3, "{before:?} {after:?}");
        assert!((report.error_after - after.at_vertices).abs() < 1e-12 && report.not_finite.is_empty());
        assert_eq!(coherent.explicit, set.explicit);
    }

    /// From the lobes that the transfer was made of, so that all are in the same valley.
    #[test]
    fn smoothness_is_bought_with_error() {
        let targets = targets(5);
        let neighbours = Neighbours::from_triangles(SIZE * SIZE, &triangles()).unwrap();
        let mut last = (f64::INFINITY, 0.0);
        for smoothness in [1e-3, 1e-1, 1e1] {
            let mut set = truth(5);
            let options = CoherentOptions {
                smoothness,
                between: 0.0,
                stages: 1,
                max_iterations: 1000,
                tolerance: 1e-6,
                threads: None,
            };
            let report = make_coherent(&mut set, &targets, &neighbours, &options).unwrap();
            let now = (roughness(&set, &neighbours), report.error_after);
            assert!(now.0 < last.0 && now.1 > last.1, "{now:?} {last:?}");
            last = now;
        }
    }

    #[test]
    fn any_number_of_threads_gives_the_same_bytes() {
        let targets = targets(4);
        let (set, neighbours) = fitted(4, 2, &targets);
        let run = |threads| {
            let mut set = set.clone();
            make_coherent(&mut set, &targets, &neighbours, &CoherentOptions { threads, ..Default::default() }).unwrap();
            set
        };
        assert_eq!(run(Some(1)), run(None));
        #[cfg(feature = "parallel")]
        assert_eq!(run(Some(1)), run(Some(3)));
    }

    #[test]
    fn transfer_that_is_not_finite_is_named_and_bridged() {
        let mut targets = targets(4);
        let (mut set, neighbours) = fitted(4, 2, &targets);
        targets[16 * 10 + 3] = f32::NAN;
        let report = make_coherent(&mut set, &targets, &neighbours, &CoherentOptions::default()).unwrap();
        assert_eq!(report.not_finite, [10]);
        assert!(set.coeffs.iter().all(|g| g.is_finite()) && report.error_after < 0.5, "{report:?}");
        assert!(interpolation_error(&set, &targets, &triangles()).unwrap().at_faces.is_finite());
    }

    #[test]
    fn the_smallest_of_everything() {
        for n in [1, 2, 10] {
            let order = Order::new(n).unwrap();
            let targets: Vec<f32> = (0..n * n).map(|i| 1.0 / (1 + i) as f32).collect();
            for lobe_count in [1, 3] {
                let options = FitOptions { lobe_count, ..FitOptions::default() };
                let (mut set, _) = fit_lobes_many(order, 1, &targets, None, &options, &|_| ()).unwrap();
                let alone = Neighbours::from_triangles(1, &[]).unwrap();
                let report = make_coherent(&mut set, &targets, &alone, &CoherentOptions::default()).unwrap();
                assert!(report.error_after <= report.error_before + 1e-6 && report.matched == 0, "{n} {report:?}");
            }
        }
        let mut none = LobeSet::zeros(Order::new(3).unwrap(), 1, 2, 1, 0);
        let neighbours = Neighbours::from_triangles(0, &[]).unwrap();
        let report = make_coherent(&mut none, &[], &neighbours, &CoherentOptions::default()).unwrap();
        assert_eq!((report.error_after, report.iterations), (0.0, 0));
        assert!(interpolation_error(&none, &[], &[[0, 0, 0]]).is_err());
    }

    #[test]
    fn options_out_of_range_are_named() {
        let default = CoherentOptions::default();
        let refused = |options: CoherentOptions| options.validate().unwrap_err().to_string();
        assert!(refused(CoherentOptions { smoothness: f64::NAN, ..default.clone() }).starts_with("smoothness is NaN"));
        assert!(
            refused(CoherentOptions { between: -1.0, ..default.clone() }).starts_with("weight between vertices is -1")
        );
        assert!(refused(CoherentOptions { stages: 0, ..default.clone() }).starts_with("number of stages is 0"));
        assert!(refused(CoherentOptions { tolerance: 1.0, ..default }).starts_with("tolerance is 1"));
    }
}
