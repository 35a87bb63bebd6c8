//! Lobes as bilinear functions on a rectangle of parameters: a texture, or places and depths of a wrinkle.

use crate::blend::{Blend, interpolate};
use crate::conjugate::{Limits, Search, minimise};
use crate::field::{Sample, refine};
use crate::misfit::{assert_targets, finite, relative_error};
use crate::parallel::Threads;
use crate::{Error, LobeSet};

/// A rectangle of nodes over the unit square, between which everything is bilinear.
///
/// Nodes are row-major. Along an axis that wraps they are texel centres, node `i` of `count` at `(i + ½)/count`, so that a
/// repeating texture has the parameter as its coordinate. Along one that does not they reach from end to end, node `i` at
/// `i/(count − 1)`: the coordinate of a clamped texture is then `(t (count − 1) + ½)/count`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Grid {
    sizes: [usize; 2],
    wraps: [bool; 2],
}

impl Grid {
    /// Nodes along x and along y, and whether the axes wrap.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a count is 0 or above 4096.
    pub fn new(sizes: [usize; 2], wraps: [bool; 2]) -> Result<Self, Error> {
        match sizes.iter().find(|size| !(1..=4096).contains(*size)) {
            Some(&size) => Err(Error::Parameter { what: "size of the grid", given: size as f64, accepted: "1..=4096" }),
            None => Ok(Self { sizes, wraps }),
        }
    }

    /// Nodes along x and along y.
    #[must_use]
    pub fn sizes(&self) -> [usize; 2] {
        self.sizes
    }

    /// The number of nodes.
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.sizes[0] * self.sizes[1]
    }

    /// Where a node is, in the unit square.
    #[must_use]
    pub fn node(&self, index: usize) -> [f64; 2] {
        let at = [index % self.sizes[0], index / self.sizes[0]];
        std::array::from_fn(|axis| match (self.wraps[axis], self.sizes[axis]) {
            (true, size) => (at[axis] as f64 + 0.5) / size as f64,
            (false, 1) => 0.0,
            (false, size) => at[axis] as f64 / (size - 1) as f64,
        })
    }

    /// The nodes around a place, with bilinear weights. Beyond the end of an axis that does not wrap the end counts.
    #[must_use]
    pub fn blend(&self, place: [f64; 2]) -> Blend {
        let [(left, right, x), (top, bottom, y)] = std::array::from_fn(|axis| self.between(axis, place[axis]));
        let at = |row: usize, column: usize| (row * self.sizes[0] + column) as u32;
        Blend::bilinear([
            (at(top, left), (1.0 - x) * (1.0 - y)),
            (at(top, right), x * (1.0 - y)),
            (at(bottom, left), (1.0 - x) * y),
            (at(bottom, right), x * y),
        ])
    }

    /// The nodes before and after a coordinate, and how far it is from the one to the other.
    fn between(&self, axis: usize, t: f64) -> (usize, usize, f64) {
        let size = self.sizes[axis];
        if self.wraps[axis] {
            let at = (t - t.floor()) * size as f64 + size as f64 - 0.5;
            return (at as usize % size, (at as usize + 1) % size, at.fract());
        }
        let at = t.clamp(0.0, 1.0) * (size - 1) as f64;
        let low = (at as usize).min(size.saturating_sub(2));
        (low, (low + 1).min(size - 1), at - low as f64)
    }
}

/// How much effort a fit over a grid is worth.
#[derive(Debug, Clone, PartialEq)]
pub struct GridOptions {
    /// Most iterations of the conjugate gradients.
    pub max_iterations: usize,
    /// Three iterations in a row that lower the squared error by less than this part of it end the fit.
    pub tolerance: f64,
    /// Number of threads; all that the machine has if `None`. The result is the same for any number.
    pub threads: Option<usize>,
}

impl GridOptions {
    /// Checks every setting.
    ///
    /// # Errors
    /// [`Error::Parameter`] names the first setting that cannot be used.
    pub fn validate(&self) -> Result<(), Error> {
        validate(self.max_iterations, self.tolerance)
    }
}

impl Default for GridOptions {
    fn default() -> Self {
        Self { max_iterations: 500, tolerance: 1e-4, threads: None }
    }
}

pub(crate) fn validate(max_iterations: usize, tolerance: f64) -> Result<(), Error> {
    if max_iterations > 1_000_000 {
        let given = max_iterations as f64;
        return Err(Error::Parameter { what: "number of iterations", given, accepted: "0..=1000000" });
    }
    if !(0.0..1.0).contains(&tolerance) {
        return Err(Error::Parameter { what: "tolerance", given: tolerance, accepted: "0..1" });
    }
    Ok(())
}

/// What a fit over a grid says about itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridReport {
    /// The relative L2 error over all samples at the start, with the explicit coefficients fitted already.
    pub start_error: f64,
    /// The same at the end: of bilinear lobes against the samples.
    pub relative_error: f64,
    /// Iterations.
    pub iterations: usize,
    /// Evaluations of the error and its gradient.
    pub evaluations: usize,
    /// Whether the fit ended because the error stood still.
    pub converged: bool,
}

/// Fits the lobes at the nodes of a grid so that, interpolated, they are near a signal that is sampled more densely.
///
/// All nodes are fitted at once, which penalises lobes that do not correspond between neighbours: interpolated, they are wrong.
/// First the explicit coefficients by linear least squares, then axes and coefficients of the lobes by conjugate gradients.
///
/// - `start`: one point per node; its axes and coefficients are where the search begins
/// - `places`: `[S]`, in the unit square
/// - `targets`: `[S, C, n²]`
///
/// A node that no sample reaches stays as it is. The result is the same for any number of threads.
///
/// # Errors
/// [`Error::Parameter`] and [`Error::Option`] for options that cannot be used, [`Error::Item`] names the first sample that is not finite.
///
/// # Panics
/// If `start` does not have one point per node, or `targets` is not `[S, C, n²]`.
///
/// Source: [SLS05](sh_core#references) section 4.2.
pub fn fit_grid(
    start: &LobeSet,
    grid: &Grid,
    places: &[[f64; 2]],
    targets: &[f32],
    options: &GridOptions,
) -> Result<(LobeSet, GridReport), Error> {
    options.validate()?;
    let size = start.channels * start.order.coeff_count();
    assert!(start.point_count() == grid.node_count(), "{} points for {} nodes", start.point_count(), grid.node_count());
    assert!(targets.len() == places.len() * size, "targets is not [S, C, n²]");
    check_samples(places, targets, size)?;
    let blends: Vec<Blend> = places.iter().map(|&place| grid.blend(place)).collect();
    let mut set = start.clone();
    fit_explicit(&mut set, &blends, targets);
    let start_error = interpolated_error(&set, &blends, targets);
    let sample = |(blend, target)| Sample { blend, weight: 1.0, target };
    let samples: Vec<Sample<'_>> = blends.iter().copied().zip(targets.chunks_exact(size)).map(sample).collect();
    let threads = Threads::new(options.threads)?;
    let limits = Limits { iterations: options.max_iterations, tolerance: options.tolerance };
    let Search { iterations, evaluations, converged, .. } = refine(&mut set, &samples, &[], limits, &threads);
    let relative_error = interpolated_error(&set, &blends, targets);
    Ok((set, GridReport { start_error, relative_error, iterations, evaluations, converged }))
}

fn check_samples(places: &[[f64; 2]], targets: &[f32], size: usize) -> Result<(), Error> {
    let accepted = "a finite number";
    if let Some(item) = places.iter().position(|place| place.iter().any(|t| !t.is_finite())) {
        let given = places[item].iter().copied().find(|t| !t.is_finite()).unwrap_or(f64::NAN);
        return Err(Error::Item { what: "place of sample", item, given, accepted });
    }
    match targets.chunks_exact(size).position(|target| !finite(target)) {
        Some(item) => {
            let target = &targets[item * size..][..size];
            let given = target.iter().find(|t| !t.is_finite()).map_or(f64::NAN, |&t| f64::from(t));
            Err(Error::Item { what: "transfer of sample", item, given, accepted })
        }
        None => Ok(()),
    }
}

/// The relative error of lobes between the nodes.
pub(crate) fn interpolated_error(set: &LobeSet, blends: &[Blend], targets: &[f32]) -> f64 {
    let between = interpolate(set, blends);
    assert_targets(&between, targets);
    relative_error(&between, targets)
}

/// Linear least squares for each explicit coefficient: the bilinear function nearest to the samples.
fn fit_explicit(set: &mut LobeSet, blends: &[Blend], targets: &[f32]) {
    /// A square is minimised to rounding within this.
    const LIMITS: Limits = Limits { iterations: 1000, tolerance: 1e-12 };
    let (k, count) = (set.explicit_count, set.order.coeff_count());
    let mut weights = vec![0.0; set.point_count()];
    blends.iter().flat_map(Blend::parts).for_each(|(node, weight)| weights[node] += weight);
    let scale: Vec<f64> = weights.iter().map(|weight| if *weight > 0.0 { 0.5 / weight } else { 1.0 }).collect();
    for column in 0..set.channels * k {
        let target = |sample: usize| f64::from(targets[(sample * set.channels + column / k) * count + column % k]);
        let mut nodes: Vec<f64> =
            set.explicit.iter().skip(column).step_by(set.channels * k).map(|&x| x.into()).collect();
        let cost = |nodes: &[f64], gradient: &mut [f64]| {
            gradient.fill(0.0);
            let mut sum = 0.0;
            for (sample, blend) in blends.iter().enumerate() {
                let rest = blend.parts().map(|(node, weight)| weight * nodes[node]).sum::<f64>() - target(sample);
                sum += rest * rest;
                blend.parts().for_each(|(node, weight)| gradient[node] += 2.0 * weight * rest);
            }
            sum
        };
        minimise(&mut nodes, &scale, cost, LIMITS);
        let to = set.explicit.iter_mut().skip(column).step_by(set.channels * k);
        to.zip(&nodes).for_each(|(to, from)| *to = *from as f32);
    }
}
