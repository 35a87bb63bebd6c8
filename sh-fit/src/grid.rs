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

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    use proptest::prelude::*;
    use sh_core::Order;

    use super::*;

    fn grid(sizes: [usize; 2], wraps: [bool; 2]) -> Grid {
        Grid::new(sizes, wraps).unwrap()
    }

    fn value(grid: &Grid, place: [f64; 2], f: impl Fn([f64; 2]) -> f64) -> f64 {
        grid.blend(place).parts().map(|(node, weight)| weight * f(grid.node(node))).sum()
    }

    proptest! {
        #[test]
        fn weights_add_up_and_reproduce_nodes(w in 1_usize..6, h in 1_usize..6, wx: bool, wy: bool, x in -2.0_f64..3.0, y in -2.0_f64..3.0) {
            let grid = grid([w, h], [wx, wy]);
            prop_assert!((value(&grid, [x, y], |_| 1.0) - 1.0).abs() < 1e-12);
            prop_assert!(grid.blend([x, y]).parts().all(|(node, weight)| node < w * h && weight > 0.0));
            for node in 0..w * h {
                let at: f64 = grid.blend(grid.node(node)).parts().filter(|part| part.0 == node).map(|part| part.1).sum();
                prop_assert!((at - 1.0).abs() < 1e-12, "{node} {at}");
            }
        }

        /// A linear function is reproduced between nodes, and a wrapping axis repeats.
        #[test]
        fn between_nodes_it_is_linear(x in 0.0_f64..1.0, y in 0.0_f64..1.0) {
            let open = grid([4, 7], [false, false]);
            prop_assert!((value(&open, [x, y], |[x, y]| 2.0 * x - y) - (2.0 * x - y)).abs() < 1e-12);
            let tile = grid([8, 5], [true, false]);
            let f = |[x, y]: [f64; 2]| (std::f64::consts::TAU * x).sin() + y;
            prop_assert!((value(&tile, [x, y], f) - value(&tile, [x + 3.0, y], f)).abs() < 1e-12);
            // Second derivative 4π², distance 1/8.
            prop_assert!((value(&tile, [x, y], f) - f([x, y])).abs() < 40.0 / 8.0 / 64.0);
        }
    }

    /// A smooth field of lobes on a grid.
    fn truth(grid: &Grid, n: usize, lobe_count: usize) -> LobeSet {
        let order = Order::new(n).unwrap();
        let k = crate::explicit_count(order, lobe_count);
        let mut set = LobeSet::zeros(order, 1, lobe_count, k, grid.node_count());
        for node in 0..grid.node_count() {
            let [x, y] = grid.node(node);
            for i in 0..k {
                set.explicit[node * k + i] = (x * y + i as f64) as f32;
            }
            for lobe in 0..lobe_count {
                let axis = [(x + 1.3 * lobe as f64).sin(), (y + lobe as f64).cos(), 0.5];
                set.axes[node * lobe_count + lobe] = unit(axis);
                for l in k.isqrt()..n {
                    set.coeffs[(node * lobe_count + lobe) * n + l] =
                        ((1.0 + x - 0.5 * y) / (1 + l + lobe) as f64) as f32;
                }
            }
        }
        set
    }

    fn unit(axis: [f64; 3]) -> [f32; 3] {
        crate::blend::unit_or_z(axis).0.map(|x| x as f32)
    }

    fn sampled(grid: &Grid, set: &LobeSet, size: usize) -> (Vec<[f64; 2]>, Vec<f32>) {
        let places: Vec<[f64; 2]> =
            (0..size * size).map(|i| [(i % size) as f64, (i / size) as f64].map(|t| (t + 0.5) / size as f64)).collect();
        let blends: Vec<Blend> = places.iter().map(|&place| grid.blend(place)).collect();
        let between = interpolate(set, &blends);
        let mut targets = vec![0.0; places.len() * set.order.coeff_count()];
        for (i, target) in targets.chunks_exact_mut(set.order.coeff_count()).enumerate() {
            between.reconstruct(i, 0, target);
        }
        (places, targets)
    }

    #[test]
    fn a_bilinear_field_is_found_again() {
        for (sizes, n, lobe_count) in [([4, 3], 4, 2), ([1, 1], 3, 1), ([3, 1], 5, 3), ([2, 2], 2, 1)] {
            let grid = grid(sizes, [true, false]);
            let truth = truth(&grid, n, lobe_count);
            let (places, targets) = sampled(&grid, &truth, 12);
            let mut start = truth.clone();
            start.explicit.fill(0.0);
            for (i, axis) in start.axes.iter_mut().enumerate() {
                let by = 0.1 * (i as f64).sin();
                *axis = unit([f64::from(axis[0]) + by, f64::from(axis[1]) - by, f64::from(axis[2])]);
            }
            start.coeffs.iter_mut().for_each(|g| *g *= 0.9);
            let options = GridOptions { max_iterations: 3000, tolerance: 1e-9, threads: Some(1) };
            let (found, report) = fit_grid(&start, &grid, &places, &targets, &options).unwrap();
            assert!(report.relative_error < 1e-4, "{sizes:?} {report:?}");
            assert!(report.start_error > 20.0 * report.relative_error || n == 2, "{report:?}");
            for (a, b) in found.explicit.iter().zip(&truth.explicit) {
                assert!((a - b).abs() < 1e-4, "{a} {b}");
            }
        }
    }

    #[test]
    fn nodes_without_samples_stay() {
        let grid = grid([5, 1], [false, false]);
        let truth = truth(&grid, 4, 1);
        let (_, targets) = sampled(&grid, &truth, 4);
        let places = [[0.0, 0.0], [0.1, 0.0], [0.2, 0.0], [0.25, 0.0]];
        let (found, _) = fit_grid(&truth, &grid, &places, &targets[..4 * 16], &GridOptions::default()).unwrap();
        assert_eq!(found.axes_of(4), truth.axes_of(4));
        assert_eq!(found.coeffs_of(3, 0), truth.coeffs_of(3, 0));
        assert_eq!(found.explicit_of(4, 0), truth.explicit_of(4, 0));
        assert_ne!(found.coeffs_of(0, 0), truth.coeffs_of(0, 0));
    }

    #[test]
    fn bad_input_is_named() {
        let grid_ok = grid([2, 2], [false, false]);
        let start = truth(&grid_ok, 2, 1);
        let (mut places, mut targets) = sampled(&grid_ok, &start, 3);
        let options = GridOptions::default();
        targets[4 * 5 + 2] = f32::NAN;
        let message = fit_grid(&start, &grid_ok, &places, &targets, &options).unwrap_err().to_string();
        assert!(message.starts_with("transfer of sample 5 is NaN"), "{message}");
        targets[4 * 5 + 2] = 0.0;
        places[7][1] = f64::INFINITY;
        let message = fit_grid(&start, &grid_ok, &places, &targets, &options).unwrap_err().to_string();
        assert!(message.starts_with("place of sample 7 is inf"), "{message}");
        assert!(Grid::new([0, 3], [false; 2]).is_err() && Grid::new([3, 5000], [false; 2]).is_err());
        assert!(GridOptions { tolerance: f64::NAN, ..options }.validate().is_err());
        // Nothing to fit to.
        let (same, report) = fit_grid(&start, &grid_ok, &[], &[], &GridOptions::default()).unwrap();
        assert_eq!((same, report.relative_error), (start, 0.0));
    }
}
