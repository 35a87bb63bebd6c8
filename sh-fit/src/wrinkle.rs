//! Wrinkles: a map of lobes over places in a groove and its depth.

use sh_core::{Order, linear_axis};

use crate::blend::interpolate;
use crate::grid::interpolated_error;
use crate::problem::{Projected, Signal};
use crate::solver::Landscape;
use crate::{Error, Grid, GridOptions, GridReport, Groove, LobeSet, explicit_count, fit_grid, groove_transfer};

/// Lobes of the model: the optimal linear lobe, and one to each side of it.
const LOBES: usize = 3;

/// What wrinkles to simulate, and how finely.
#[derive(Debug, Clone, PartialEq)]
pub struct WrinkleOptions {
    /// Number of bands `n`.
    pub order: Order,
    /// Nodes along x and along the depth. The paper's are 32×32.
    pub sizes: [usize; 2],
    /// The depth of the last row of nodes, in widths of the groove; the first row is flat.
    pub max_depth: f64,
    /// What the walls reflect onto each other; 0 is direct light alone.
    pub albedo: f64,
    /// Samples per node along each axis, 1..=16.
    pub oversampling: usize,
    /// The joint fit.
    pub fit: GridOptions,
}

impl WrinkleOptions {
    /// Checks every setting.
    ///
    /// # Errors
    /// [`Error::Parameter`] names the first setting that cannot be used.
    pub fn validate(&self) -> Result<(), Error> {
        if !(1..=16).contains(&self.oversampling) {
            let given = self.oversampling as f64;
            return Err(Error::Parameter { what: "oversampling", given, accepted: "1..=16" });
        }
        if !(0.0..=1.0).contains(&self.albedo) {
            return Err(Error::Parameter { what: "albedo", given: self.albedo, accepted: "0..=1" });
        }
        if let Some(&size) = self.sizes.iter().find(|size| !(1..=256).contains(*size)) {
            return Err(Error::Parameter { what: "size of the map", given: size as f64, accepted: "1..=256" });
        }
        Groove::new(self.max_depth)?;
        self.fit.validate()
    }
}

impl Default for WrinkleOptions {
    /// Order 6, 32×32 nodes up to a depth of one width, walls of albedo 0.8.
    fn default() -> Self {
        Self {
            order: const {
                match Order::new(6) {
                    Ok(order) => order,
                    Err(_) => unreachable!(),
                }
            },
            sizes: [32, 32],
            max_depth: 1.0,
            albedo: 0.8,
            oversampling: 2,
            fit: GridOptions::default(),
        }
    }
}

/// Diffuse transfer in a groove, by place and depth, as three lobes with band 0 and 1 explicit.
///
/// In the frame of the undisturbed surface: x across the groove, y along it, z up.
#[derive(Debug, Clone, PartialEq)]
pub struct WrinkleModel {
    /// One point per node, row-major: `x` along the columns, depth down the rows.
    pub map: LobeSet,
    /// Nodes over `(x, depth/max_depth)`; wraps along `x`.
    pub grid: Grid,
    /// The depth of the last row, in widths of the groove.
    pub max_depth: f64,
    /// How the fit went.
    pub report: WrinkleReport,
}

/// How well a map of a wrinkle fits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WrinkleReport {
    /// The joint fit over all samples.
    pub fit: GridReport,
    /// The relative error of the map in the middle between four nodes, at places that were not fitted.
    pub between_error: f64,
}

impl WrinkleModel {
    /// Simulates the groove and fits the map.
    ///
    /// The start has the optimal linear lobe at each node and one to each side of it in the cross-section, at the angle that fits
    /// best there; then all nodes are fitted together with [`fit_grid`], to samples that are denser than the nodes.
    ///
    /// Accuracy of the default, order 6 and depths up to one width: 0.046 relative L2, at fitted samples and between them, where
    /// nodes that are fitted each for itself have 0.029 at nodes and 0.37 between them (`repro -- ldprt/wrinkle`). Seconds.
    ///
    /// # Errors
    /// [`Error::Parameter`] names the first option that cannot be used.
    ///
    /// Source: [SLS05](sh_core#references) section 4.2, wrinkle model.
    pub fn fit(options: &WrinkleOptions) -> Result<Self, Error> {
        options.validate()?;
        let grid = Grid::new(options.sizes, [true, false])?;
        let start = start(options, &grid)?;
        let (places, targets) = samples(options, [0.0, 0.0])?;
        let (map, fit) = fit_grid(&start, &grid, &places, &targets, &options.fit)?;
        let (places, targets) = samples(options, [0.5, 0.5])?;
        let blends: Vec<_> = places.iter().map(|&place| grid.blend(place)).collect();
        let between_error = interpolated_error(&map, &blends, &targets);
        Ok(Self { map, grid, max_depth: options.max_depth, report: WrinkleReport { fit, between_error } })
    }

    /// The lobes at a place `x`, in widths of the groove, and a depth; one point.
    ///
    /// `x` repeats; a depth out of the range of the map counts as its end.
    #[must_use]
    pub fn sample(&self, x: f64, depth: f64) -> LobeSet {
        let y = if self.max_depth > 0.0 { depth / self.max_depth } else { 0.0 };
        interpolate(&self.map, &[self.grid.blend([x, y])])
    }

    /// The height and the unit normal of the surface that the lobes are for, for a renderer that shows it.
    ///
    /// A depth out of the range of the map counts as its end.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a depth that is not a number.
    pub fn surface(&self, x: f64, depth: f64) -> Result<(f64, [f64; 3]), Error> {
        let groove = Groove::new(depth.clamp(0.0, self.max_depth))?;
        Ok((groove.height(x), groove.normal(x)))
    }
}

/// Places and transfer, `oversampling` per node; shifted by parts of the distance of samples.
fn samples(options: &WrinkleOptions, shift: [f64; 2]) -> Result<(Vec<[f64; 2]>, Vec<f32>), Error> {
    /// Points of the simulation of each depth, at least: for the accuracy of the interreflection.
    const LEAST: usize = 128;
    let columns = options.oversampling * options.sizes[0];
    let rows = options.oversampling * (options.sizes[1] - 1) + 1;
    // The simulation has points at both, samples and the middles between them.
    let refine = LEAST.div_ceil(2 * columns).max(1) * 2;
    let skip = (shift[0] * refine as f64) as usize;
    let (mut places, mut targets) = (Vec::new(), Vec::new());
    for row in 0..rows - usize::from(shift[1] > 0.0 && rows > 1) {
        let depth = if rows > 1 { (row as f64 + shift[1]) / (rows - 1) as f64 } else { 0.0 };
        let groove = Groove::new(depth * options.max_depth)?;
        let transfer = groove_transfer(options.order, &groove, options.albedo, columns * refine)?;
        let points = transfer.chunks_exact(options.order.coeff_count()).enumerate().skip(skip).step_by(refine);
        for (point, transfer) in points {
            places.push([point as f64 / (columns * refine) as f64, depth]);
            targets.extend(transfer.iter().map(|&t| t as f32));
        }
    }
    Ok((places, targets))
}

/// Three lobes at each node.
fn start(options: &WrinkleOptions, grid: &Grid) -> Result<LobeSet, Error> {
    /// Keeps the coefficients of nearly coincident lobes from cancelling each other.
    const RIDGE: f64 = 1e-3;
    let order = options.order;
    let mut set = LobeSet::zeros(order, 1, LOBES, explicit_count(order, LOBES), grid.node_count());
    let size = LOBES * order.get();
    let mut projected = Projected::new(Signal::new(order, 1, set.explicit_count.isqrt()), RIDGE);
    for row in 0..options.sizes[1] {
        let groove = Groove::new(grid.node(row * options.sizes[0])[1] * options.max_depth)?;
        // Nodes are between points of twice as many.
        let transfer = groove_transfer(order, &groove, options.albedo, 2 * options.sizes[0])?;
        for column in 0..options.sizes[0] {
            let node = row * options.sizes[0] + column;
            let target = &transfer[(2 * column + 1) * order.coeff_count()..][..order.coeff_count()];
            let (axes, coeffs) = symmetric_lobes(order, &mut projected, target);
            let k = set.explicit_count;
            set.explicit[node * k..][..k].iter_mut().zip(target).for_each(|(to, from)| *to = *from as f32);
            set.axes[node * LOBES..][..LOBES].copy_from_slice(&axes.map(|axis| axis.map(|x| x as f32)));
            set.coeffs[node * size..][..size].iter_mut().zip(&coeffs).for_each(|(to, from)| *to = *from as f32);
        }
    }
    Ok(set)
}

/// The optimal linear lobe and two beside it in the xz plane, at the best angle, with their coefficients `[N, n]`.
fn symmetric_lobes(order: Order, projected: &mut Projected, target: &[f64]) -> ([[f64; 3]; LOBES], Vec<f64>) {
    /// Angles that are tried, of up to 90°; the first one is left out, where lobes nearly coincide.
    const ANGLES: usize = 30;
    let [x, _, z] = linear_axis(target);
    let axes = |k: usize| {
        let (sin, cos) = (std::f64::consts::FRAC_PI_2 * k as f64 / ANGLES as f64).sin_cos();
        [[x, 0.0, z], [x * cos + z * sin, 0.0, z * cos - x * sin], [x * cos - z * sin, 0.0, z * cos + x * sin]]
    };
    projected.signal_mut().load(target);
    let mut error = |k: usize| {
        projected.set_axes(&axes(k));
        projected.value()
    };
    let best = (2..=ANGLES).map(|k| (error(k), k)).min_by(|a, b| a.0.total_cmp(&b.0)).map_or(ANGLES, |best| best.1);
    projected.set_axes(&axes(best));
    let signal = projected.signal();
    let coeff = |lobe, l| if l < signal.first_band() { 0.0 } else { signal.length() * projected.lobe(l, 0, lobe) };
    (
        axes(best),
        (0..LOBES).flat_map(|lobe| (0..order.get()).map(move |l| (lobe, l))).map(|(lobe, l)| coeff(lobe, l)).collect(),
    )
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    fn small() -> WrinkleOptions {
        let fit = GridOptions { max_iterations: 60, ..GridOptions::default() };
        WrinkleOptions {
            order: Order::new(5).unwrap(),
            sizes: [12, 6],
            max_depth: 0.6,
            fit,
            ..WrinkleOptions::default()
        }
    }

    fn exact(options: &WrinkleOptions, k: usize, count: usize, depth: f64) -> Vec<f64> {
        let groove = Groove::new(depth).unwrap();
        let n2 = options.order.coeff_count();
        groove_transfer(options.order, &groove, options.albedo, count).unwrap()[k * n2..][..n2].to_vec()
    }

    fn distance(found: &[f32], exact: &[f64]) -> f64 {
        let squares = found.iter().zip(exact).map(|(a, b)| (f64::from(*a) - b).powi(2)).sum::<f64>();
        (squares / exact.iter().map(|x| x * x).sum::<f64>()).sqrt()
    }

    #[test]
    fn samples_are_near_the_simulation() {
        let options = small();
        let model = WrinkleModel::fit(&options).unwrap();
        let report = model.report;
        assert!(report.fit.relative_error < 0.05 && report.between_error < 0.05, "{report:?}");
        assert!(report.fit.relative_error < 0.9 * report.fit.start_error, "{report:?}");
        let mut found = vec![0.0; 25];
        for (k, depth) in [(3, 0.3), (50, 0.45), (70, 0.1)] {
            let lobes = model.sample(k as f64 / 100.0, depth);
            lobes.reconstruct(0, 0, &mut found);
            // Three times the mean.
            assert!(distance(&found, &exact(&options, k, 100, depth)) < 0.15, "{k} {depth}");
            assert_eq!(model.sample(k as f64 / 100.0 - 2.0, depth).axes.len(), 3);
        }
        // The explicit coefficients are bilinear, nothing else.
        model.sample(0.3, 0.3).reconstruct(0, 0, &mut found);
        assert!((f64::from(found[0]) - exact(&options, 30, 100, 0.3)[0]).abs() < 5e-3);
    }

    #[test]
    fn without_depth_it_is_nearly_the_clamped_cosine() {
        let options = WrinkleOptions { max_depth: 0.0, ..small() };
        let model = WrinkleModel::fit(&options).unwrap();
        let mut found = vec![0.0; 25];
        for x in [0.0, 0.21, 0.9] {
            model.sample(x, 0.0).reconstruct(0, 0, &mut found);
            // One of the three lobes is enough; f32.
            assert!(
                distance(&found, &exact(&options, 0, 1, 0.0)) < 1e-3,
                "{}",
                distance(&found, &exact(&options, 0, 1, 0.0))
            );
        }
    }

    #[test]
    fn the_smallest_and_deepest_are_finite() {
        for (n, sizes, max_depth) in [(1, [1, 1], 0.5), (2, [1, 3], 1e3), (3, [4, 2], 20.0), (10, [2, 2], 1.0)] {
            let order = Order::new(n).unwrap();
            let fit = GridOptions { max_iterations: 10, ..GridOptions::default() };
            let model =
                WrinkleModel::fit(&WrinkleOptions { order, sizes, max_depth, fit, ..Default::default() }).unwrap();
            let lobes = model.sample(0.4, 0.5 * max_depth);
            assert!(lobes.explicit.iter().chain(&lobes.coeffs).chain(lobes.axes.as_flattened()).all(|x| x.is_finite()));
            assert!(model.report.between_error.is_finite());
        }
    }

    #[test]
    fn the_surface_is_that_of_the_groove() {
        let model =
            WrinkleModel::fit(&WrinkleOptions { sizes: [2, 2], order: Order::new(2).unwrap(), ..small() }).unwrap();
        let (height, normal) = model.surface(0.5, 0.25).unwrap();
        assert_eq!((height, normal), (-0.25, Groove::new(0.25).unwrap().normal(0.5)));
        // Clamped to the range of the map.
        assert_eq!(model.surface(0.5, 9.0).unwrap().0, -0.6);
        assert!(model.surface(0.5, f64::NAN).is_err());
    }

    #[test]
    fn options_out_of_range_are_named() {
        let refused = |options: WrinkleOptions| WrinkleModel::fit(&options).unwrap_err().to_string();
        assert!(refused(WrinkleOptions { albedo: 1.1, ..small() }).starts_with("albedo is 1.1"));
        assert!(refused(WrinkleOptions { oversampling: 0, ..small() }).starts_with("oversampling is 0"));
        assert!(refused(WrinkleOptions { max_depth: f64::NAN, ..small() }).starts_with("depth of the groove is NaN"));
        assert!(refused(WrinkleOptions { sizes: [32, 0], ..small() }).starts_with("size of the map is 0"));
    }
}
