//! The fit of many points.

use std::time::Instant;

use sh_core::Order;

use super::Shape;
use crate::parallel::Threads;
use crate::search::{Counts, Found, Search};
use crate::start::Directions;
use crate::{Error, FitOptions, FitReport, LobeSet, Neighbours};

/// Sweeps over a finished fit in which the axes of neighbours are tried.
const SWEEPS: usize = 2;

/// Fits zonal lobes to the transfer of many points.
///
/// - `targets`: `[P, C, n²]`
/// - `neighbours`: which points lie beside which; their axes are tried as starts
/// - `progress`: called, from any thread, with the number of points that were finished since its last call; one pass over the
///   points for each number of lobes that is tried
///
/// Points with a coefficient that is not finite are left zero and named in the report. Lobe coefficients beyond the range of
/// `f32`, which transfer of 1e37 and more can have, become its largest number.
///
/// # Errors
/// [`Error::Option`] for settings that cannot be used, [`Error::Neighbours`] if `neighbours` has another number of points.
///
/// # Panics
/// If `targets` is not `[P, C, n²]`, or `channels` is 0.
///
/// Source: [SLS05](sh_core#references) section 4.1.
pub fn fit_lobes_many(
    order: Order,
    channels: usize,
    targets: &[f32],
    neighbours: Option<&Neighbours>,
    options: &FitOptions,
    progress: &(dyn Fn(usize) + Sync),
) -> Result<(LobeSet, FitReport), Error> {
    options.validate()?;
    let size = channels * order.coeff_count();
    assert!(channels > 0 && targets.len().is_multiple_of(size), "targets is not [P, C, n²]");
    let points = targets.len() / size;
    if let Some(neighbours) = neighbours.filter(|neighbours| neighbours.point_count() != points) {
        return Err(Error::Neighbours { neighbours: neighbours.point_count(), points });
    }
    let start = Instant::now();
    let neighbours = neighbours.filter(|_| options.warm_start);
    let job = Many {
        order,
        channels,
        targets,
        neighbours,
        options,
        progress,
        threads: Threads::new(options.threads)?,
        directions: Directions::new(order),
        unit: root_mean_square(targets, size),
    };
    let (set, mut report) = job.run();
    report.seconds = start.elapsed().as_secs_f64();
    Ok((set, report))
}

/// Root mean square of the lengths of all vectors `[size]` of finite numbers; 0 without any.
fn root_mean_square(targets: &[f32], size: usize) -> f64 {
    let finite = targets.chunks_exact(size).filter(|target| is_finite(target));
    let (count, sum) = finite.fold((0, 0.0), |(count, sum), target| {
        (count + 1, sum + target.iter().map(|&t| f64::from(t).powi(2)).sum::<f64>())
    });
    (sum / f64::from(count.max(1))).sqrt()
}

fn is_finite(target: &[f32]) -> bool {
    target.iter().all(|t| t.is_finite())
}

/// One point while it is fitted.
#[derive(Debug, Clone, Default)]
struct Point {
    found: Found,
    counts: Counts,
}

struct Many<'a> {
    order: Order,
    channels: usize,
    targets: &'a [f32],
    neighbours: Option<&'a Neighbours>,
    options: &'a FitOptions,
    progress: &'a (dyn Fn(usize) + Sync),
    threads: Threads,
    directions: Directions,
    /// Root mean square of the lengths.
    unit: f64,
}

/// A search, and room for the vector it is for.
struct Scratch<'a> {
    search: Search<'a>,
    target: Vec<f64>,
}

impl Scratch<'_> {
    /// Loads the vector of a point.
    fn load(&mut self, target: &[f32]) {
        self.target.clear();
        self.target.extend(target.iter().map(|&t| f64::from(t)));
        self.search.problem_mut().signal_mut().load(&self.target);
    }
}

impl Many<'_> {
    /// All lobes, or with a target error for the whole set as few as reach it.
    fn run(&self) -> (LobeSet, FitReport) {
        let whole = self.options.target_error.filter(|_| !self.options.per_point);
        let fewest = if whole.is_some() { 1 } else { self.options.lobe_count };
        let mut counts = Counts::default();
        for lobe_count in fewest..=self.options.lobe_count {
            let shape = Shape { order: self.order, channels: self.channels, lobe_count };
            let points = self.fit(&shape);
            points.iter().for_each(|point| counts += point.counts);
            let set = self.store(&shape, &points);
            let report = self.report(&set, &points, counts);
            if lobe_count == self.options.lobe_count || whole.is_some_and(|target| report.relative_error <= target) {
                return (set, report);
            }
        }
        unreachable!("the last number of lobes returns")
    }

    fn target(&self, point: usize) -> &[f32] {
        let size = self.channels * self.order.coeff_count();
        &self.targets[point * size..][..size]
    }

    fn scratch(&self, shape: &Shape) -> Scratch<'_> {
        Scratch { search: shape.search(self.options, &self.directions), target: Vec::new() }
    }

    /// The axes of all points.
    fn fit(&self, shape: &Shape) -> Vec<Point> {
        let mut points = vec![Point::default(); self.targets.len() / (self.channels * self.order.coeff_count())];
        self.threads.for_each(
            &mut points,
            self.progress,
            || self.scratch(shape),
            |scratch, number, point| {
                let target = self.target(number);
                if is_finite(target) {
                    scratch.load(target);
                    let length = scratch.search.problem_mut().signal().length();
                    let unit = if length > 0.0 { self.unit / length } else { 1.0 };
                    point.found = shape.find(&mut scratch.search, self.options, number as u64, unit);
                    point.counts += scratch.search.take_counts();
                }
            },
        );
        for _ in 0..SWEEPS {
            self.sweep(shape, &mut points);
        }
        points
    }

    /// Tries at each point the axes that its neighbours had before the sweep.
    fn sweep(&self, shape: &Shape, points: &mut [Point]) {
        let Some(neighbours) = self.neighbours else { return };
        let before: Vec<Vec<[f64; 3]>> = points.iter().map(|point| point.found.axes.clone()).collect();
        self.threads.for_each(
            points,
            &|_| (),
            || self.scratch(shape),
            |scratch, number, point| {
                if point.found.axes.is_empty() {
                    return;
                }
                scratch.load(self.target(number));
                for axes in neighbours.of(number).iter().map(|&neighbour| &before[neighbour as usize]) {
                    if axes.len() == point.found.axes.len() {
                        scratch.search.try_axes(axes, &mut point.found);
                    }
                }
                point.counts += scratch.search.take_counts();
            },
        );
    }

    /// The lobes about the axes, in `f32`.
    fn store(&self, shape: &Shape, points: &[Point]) -> LobeSet {
        let (n, size) = (self.order.get(), self.channels * shape.lobe_count);
        let k = shape.explicit_count();
        let mut set = LobeSet::zeros(self.order, self.channels, shape.lobe_count, k, points.len());
        let mut scratch = self.scratch(shape);
        let (mut axes, mut coeffs) = (Vec::new(), Vec::new());
        for (number, point) in points.iter().enumerate() {
            let target = self.target(number);
            if !is_finite(target) {
                continue;
            }
            scratch.load(target);
            axes.clear();
            axes.resize(shape.lobe_count, [0.0, 0.0, 1.0]);
            coeffs.clear();
            coeffs.resize(size * n, 0.0);
            shape.write(scratch.search.problem_mut(), &point.found.axes, &mut axes, &mut coeffs);
            let explicit = target.chunks_exact(self.order.coeff_count()).flat_map(|target| &target[..k]);
            set.explicit[number * self.channels * k..].iter_mut().zip(explicit).for_each(|(to, from)| *to = *from);
            let to = &mut set.axes[number * shape.lobe_count..];
            to.iter_mut().zip(&axes).for_each(|(to, from)| *to = from.map(|x| x as f32));
            let to = &mut set.coeffs[number * size * n..];
            to.iter_mut().zip(&coeffs).for_each(|(to, from)| *to = (*from as f32).clamp(f32::MIN, f32::MAX));
        }
        set
    }

    fn report(&self, set: &LobeSet, points: &[Point], counts: Counts) -> FitReport {
        let mut report = FitReport::measure(set, self.targets);
        (report.starts, report.iterations) = (counts.starts as u64, counts.iterations as u64);
        report.evaluations = counts.evaluations as u64;
        for (number, point) in points.iter().enumerate().filter(|(number, _)| is_finite(self.target(*number))) {
            debug_assert!(!report.not_finite.contains(&number));
            report.stops.add(point.found.stop);
            report.lobes_used[point.found.axes.len()] += 1;
        }
        report
    }
}
