//! Lobes of many points, fitted at once to signals at the points and between them.

use sh_core::{BasisGradient, Order};

use crate::LobeSet;
use crate::blend::{Blend, unit_or_z};
use crate::conjugate::{Limits, Search, minimise};
use crate::parallel::Threads;
use crate::problem::lobe_norm;

/// Samples that are worked on together.
const CHUNK: usize = 8;

/// A signal at a place, and how much it counts.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sample<'a> {
    pub(crate) blend: Blend,
    pub(crate) weight: f64,
    /// `[C, n²]`; finite.
    pub(crate) target: &'a [f32],
}

/// A penalty on the difference of the lobes of two points.
#[derive(Debug, Clone)]
pub(crate) struct Link {
    pub(crate) points: [usize; 2],
    pub(crate) weight: f64,
}

/// Minimises `Σ weight |t̃ − t|²` over the bands that are not explicit, plus the penalties of the links.
///
/// The variables of a point are its axes, which are normalised (eq. 21), and its lobe coefficients beyond the explicit bands. An
/// axis between points is the normalised mean of unit axes.
#[derive(Debug)]
pub(crate) struct Field<'a> {
    order: Order,
    channels: usize,
    lobe_count: usize,
    /// The first band of the lobes.
    first: usize,
    samples: &'a [Sample<'a>],
    links: &'a [Link],
    threads: &'a Threads,
    /// `[links, N]`: what a change of the axis is worth, see [`axis_energy`].
    axis_weights: Vec<f64>,
    basis: BasisGradient<f64>,
}

/// The squared L2 length of the change of a lobe whose axis turns by a small angle, over the square of it:
/// `Σ_l (2l+1)/(4π) · l(l+1)/2 · g*_l²`.
///
/// From `|f − f'|² = Σ (2l+1)/(4π) g*_l² · 2 (1 − P_l(cos δ))` and `P_l(cos δ) ≈ 1 − l(l+1)/4 δ²`.
pub(crate) fn axis_energy(lobe: impl Iterator<Item = f64>) -> f64 {
    lobe.enumerate().map(|(l, g)| lobe_norm(l) * 0.5 * (l * (l + 1)) as f64 * g * g).sum()
}

/// Refits the lobes of `set`, from where they are. The explicit coefficients stay.
pub(crate) fn refine(
    set: &mut LobeSet,
    samples: &[Sample<'_>],
    links: &[Link],
    limits: Limits,
    threads: &Threads,
) -> Search {
    let mut field = Field::new(set, samples, links, threads);
    let mut variables = field.variables(set);
    field.axis_weights = field.link_weights(&variables);
    let scale = field.scale(&variables);
    let search = minimise(&mut variables, &scale, |x, gradient| field.cost(x, gradient), limits);
    field.store(&variables, set);
    search
}

impl<'a> Field<'a> {
    fn new(set: &LobeSet, samples: &'a [Sample<'a>], links: &'a [Link], threads: &'a Threads) -> Self {
        Self {
            order: set.order,
            channels: set.channels,
            lobe_count: set.lobe_count,
            first: set.explicit_count.isqrt(),
            samples,
            links,
            threads,
            axis_weights: Vec::new(),
            basis: BasisGradient::new(set.order),
        }
    }

    /// Bands per lobe and channel.
    fn bands(&self) -> usize {
        self.order.get() - self.first
    }

    /// Variables per point: `[N, 3]` axes, then `[C, N, bands]` coefficients.
    fn stride(&self) -> usize {
        self.lobe_count * (3 + self.channels * self.bands())
    }

    fn variables(&self, set: &LobeSet) -> Vec<f64> {
        let mut variables = Vec::with_capacity(set.point_count() * self.stride());
        for point in 0..set.point_count() {
            variables.extend(set.axes_of(point).as_flattened().iter().map(|&x| f64::from(x)));
            for channel in 0..self.channels {
                let lobes = set.coeffs_of(point, channel).chunks_exact(self.order.get());
                variables.extend(lobes.flat_map(|lobe| &lobe[self.first..]).map(|&g| f64::from(g)));
            }
        }
        variables
    }

    fn store(&self, variables: &[f64], set: &mut LobeSet) {
        let (lobes, n) = (self.lobe_count, self.order.get());
        for (point, variables) in variables.chunks_exact(self.stride().max(1)).enumerate() {
            let (axes, coeffs) = variables.split_at(3 * lobes);
            for (to, from) in set.axes[point * lobes..].iter_mut().zip(axes.as_chunks().0) {
                *to = unit_or_z(*from).0.map(|x| x as f32);
            }
            let size = self.channels * lobes * n;
            let to = set.coeffs[point * size..][..size].chunks_exact_mut(n).flat_map(|lobe| &mut lobe[self.first..]);
            to.zip(coeffs).for_each(|(to, from)| *to = *from as f32);
        }
    }

    /// The coefficients of a lobe in the variables of a point.
    fn lobe<'v>(&self, variables: &'v [f64], channel: usize, lobe: usize) -> &'v [f64] {
        let start = 3 * self.lobe_count + (channel * self.lobe_count + lobe) * self.bands();
        &variables[start..][..self.bands()]
    }

    /// [`axis_energy`] of a lobe, over all channels.
    fn energy(&self, variables: &[f64], lobe: usize) -> f64 {
        let zeros = std::iter::repeat_n(0.0, self.first);
        let of = |channel| axis_energy(zeros.clone().chain(self.lobe(variables, channel, lobe).iter().copied()));
        (0..self.channels).map(of).sum()
    }

    /// The mean energy of both ends, as it is at the start: it stays, so that the penalty is a square.
    fn link_weights(&self, variables: &[f64]) -> Vec<f64> {
        let of = |point: usize, lobe| self.energy(&variables[point * self.stride()..][..self.stride()], lobe);
        let mean = |link: &Link, lobe| 0.5 * (of(link.points[0], lobe) + of(link.points[1], lobe));
        self.links.iter().flat_map(|link| (0..self.lobe_count).map(move |lobe| mean(link, lobe))).collect()
    }

    /// The inverse of the curvature along each variable, other things staying as they are.
    fn scale(&self, variables: &[f64]) -> Vec<f64> {
        /// Part of the mean energy that a lobe without any counts as, so that its axis does not run away at the first step.
        const LEAST_ENERGY: f64 = 1e-2;
        let (stride, points) = (self.stride().max(1), variables.len() / self.stride().max(1));
        let counts = self.counts(points);
        let energies: Vec<f64> = variables
            .chunks_exact(stride)
            .flat_map(|point| (0..self.lobe_count).map(move |lobe| self.energy(point, lobe)))
            .collect();
        let mean = energies.iter().sum::<f64>() / energies.len().max(1) as f64;
        let least = (LEAST_ENERGY * mean).max(f64::MIN_POSITIVE.sqrt());
        let mut scale = Vec::with_capacity(variables.len());
        for (count, energies) in counts.iter().zip(energies.chunks_exact(self.lobe_count.max(1))) {
            scale.extend(energies.iter().flat_map(|energy| [0.5 / (count * energy.max(least)); 3]));
            let bands = (self.first..self.order.get()).map(|l| 0.5 / (count * lobe_norm(l)));
            let lobes = (0..self.channels * self.lobe_count).flat_map(|_| bands.clone());
            scale.extend(lobes);
        }
        scale
    }

    /// How much weight is on each point.
    fn counts(&self, points: usize) -> Vec<f64> {
        let mut counts = vec![0.0; points];
        for sample in self.samples {
            sample.blend.parts().for_each(|(point, weight)| counts[point] += sample.weight * weight * weight);
        }
        for link in self.links {
            link.points.iter().for_each(|&point| counts[point] += link.weight);
        }
        // A point without any weight does not move.
        counts.into_iter().map(|count| if count > 0.0 { count } else { 1.0 }).collect()
    }

    fn cost(&self, variables: &[f64], gradient: &mut [f64]) -> f64 {
        let units = self.units(variables);
        let stride = self.stride().max(1);
        gradient.fill(0.0);
        let (costs, slopes) = self.sample_slopes(variables, &units);
        for (sample, slopes) in self.samples.iter().zip(slopes.chunks_exact(stride)) {
            for (point, weight) in sample.blend.parts() {
                let to = &mut gradient[point * stride..][..stride];
                to.iter_mut().zip(slopes).for_each(|(to, slope)| *to += weight * slope);
            }
        }
        let penalty = self.penalty(variables, &units, gradient);
        self.through_normalisation(variables, &units, gradient);
        costs.iter().sum::<f64>() + penalty
    }

    /// Unit axes `[P, N]`.
    fn units(&self, variables: &[f64]) -> Vec<[f64; 3]> {
        let axes = |point: &'_ [f64]| -> Vec<[f64; 3]> {
            point[..3 * self.lobe_count].as_chunks().0.iter().map(|axis| unit_or_z(*axis).0).collect()
        };
        variables.chunks_exact(self.stride().max(1)).flat_map(axes).collect()
    }

    /// The cost of each chunk of samples, and the derivatives by the lobes at each sample `[S, stride]`.
    fn sample_slopes(&self, variables: &[f64], units: &[[f64; 3]]) -> (Vec<f64>, Vec<f64>) {
        let stride = self.stride().max(1);
        let mut slopes = vec![0.0; self.samples.len() * stride];
        let chunks = self.samples.chunks(CHUNK).zip(slopes.chunks_mut(CHUNK * stride));
        let mut chunks: Vec<_> = chunks.map(|(samples, slopes)| (samples, slopes, 0.0)).collect();
        let work = |worker: &mut Worker<'_>, _, (samples, slopes, cost): &mut (&[Sample<'_>], &mut [f64], f64)| {
            let samples = samples.iter().zip(slopes.chunks_exact_mut(stride));
            *cost = samples.map(|(sample, slopes)| worker.slopes(sample, variables, units, slopes)).sum();
        };
        self.threads.for_each(&mut chunks, &|_| (), || Worker::new(self), work);
        let costs = chunks.iter().map(|chunk| chunk.2).collect();
        (costs, slopes)
    }

    /// `Σ weight (e |a − b|² + Σ (2l+1)/(4π) (g*_l − h*_l)²)` over links and lobes.
    fn penalty(&self, variables: &[f64], units: &[[f64; 3]], gradient: &mut [f64]) -> f64 {
        let (stride, lobes) = (self.stride(), self.lobe_count);
        let mut sum = 0.0;
        for (link, energies) in self.links.iter().zip(self.axis_weights.chunks_exact(lobes.max(1))) {
            let [p, q] = link.points;
            let mut add = |weight: f64, difference: f64, index: usize| {
                sum += weight * difference * difference;
                gradient[p * stride + index] += 2.0 * weight * difference;
                gradient[q * stride + index] -= 2.0 * weight * difference;
            };
            for (lobe, energy) in energies.iter().enumerate() {
                let axes = units[p * lobes + lobe].iter().zip(units[q * lobes + lobe]).enumerate();
                axes.for_each(|(k, (a, b))| add(link.weight * energy, a - b, 3 * lobe + k));
            }
            for index in 3 * lobes..stride {
                let l = self.first + (index - 3 * lobes) % self.bands();
                let difference = variables[p * stride + index] - variables[q * stride + index];
                add(link.weight * lobe_norm(l), difference, index);
            }
        }
        sum
    }

    /// The derivatives by unit axes become those by axes of any length: `(I − a aᵀ) / |a|`, eq. 21.
    fn through_normalisation(&self, variables: &[f64], units: &[[f64; 3]], gradient: &mut [f64]) {
        let stride = self.stride().max(1);
        let points = variables.chunks_exact(stride).zip(gradient.chunks_exact_mut(stride));
        for ((variables, gradient), units) in points.zip(units.chunks_exact(self.lobe_count.max(1))) {
            let axes = variables.as_chunks().0.iter().zip(gradient.as_chunks_mut().0);
            for ((axis, slope), unit) in axes.zip(units) {
                *slope = tangential(*slope, *unit, unit_or_z(*axis).1);
            }
        }
    }
}

fn tangential(slope: [f64; 3], unit: [f64; 3], length: f64) -> [f64; 3] {
    let along: f64 = slope.iter().zip(unit).map(|(s, u)| s * u).sum();
    std::array::from_fn(|k| (slope[k] - along * unit[k]) / length)
}

/// Room for the work on one sample.
struct Worker<'f> {
    field: &'f Field<'f>,
    /// The lobes at the sample, laid out as the variables of a point.
    blended: Vec<f64>,
    lengths: Vec<f64>,
    /// `[N, n²]` and `[N, 3, n²]`.
    values: Vec<f64>,
    gradients: Vec<f64>,
    residual: Vec<f64>,
}

impl<'f> Worker<'f> {
    fn new(field: &'f Field<'f>) -> Self {
        let (count, lobes) = (field.order.coeff_count(), field.lobe_count);
        Self {
            field,
            blended: vec![0.0; field.stride()],
            lengths: vec![0.0; lobes],
            values: vec![0.0; lobes * count],
            gradients: vec![0.0; 3 * lobes * count],
            residual: vec![0.0; count],
        }
    }

    /// Writes the derivatives of the sample's cost by its blended lobes, and returns the cost.
    fn slopes(&mut self, sample: &Sample<'_>, variables: &[f64], units: &[[f64; 3]], out: &mut [f64]) -> f64 {
        out.fill(0.0);
        self.blend(&sample.blend, variables, units);
        let count = self.field.order.coeff_count();
        let mut cost = 0.0;
        for (channel, target) in sample.target.chunks_exact(count).enumerate() {
            self.set_residual(channel, target);
            cost += self.residual.iter().map(|r| r * r).sum::<f64>();
            self.add_slopes(channel, 2.0 * sample.weight, out);
        }
        // By the axis before it was normalised.
        for (lobe, slope) in out.as_chunks_mut::<3>().0[..self.field.lobe_count].iter_mut().enumerate() {
            *slope = slope.map(|s| s / self.lengths[lobe]);
        }
        sample.weight * cost
    }

    fn blend(&mut self, blend: &Blend, variables: &[f64], units: &[[f64; 3]]) {
        let (field, count) = (self.field, self.field.order.coeff_count());
        let (stride, lobes) = (field.stride(), field.lobe_count);
        self.blended.fill(0.0);
        for (point, weight) in blend.parts() {
            let (axes, coeffs) = self.blended.split_at_mut(3 * lobes);
            let units = &units[point * lobes..][..lobes];
            axes.iter_mut().zip(units.as_flattened()).for_each(|(to, from)| *to += weight * from);
            let from = &variables[point * stride + 3 * lobes..][..stride - 3 * lobes];
            coeffs.iter_mut().zip(from).for_each(|(to, from)| *to += weight * from);
        }
        for lobe in 0..lobes {
            let (axis, length) = unit_or_z(self.blended.as_chunks().0[lobe]);
            self.lengths[lobe] = length;
            let values = &mut self.values[lobe * count..][..count];
            field.basis.eval(axis, values, &mut self.gradients[3 * lobe * count..][..3 * count]);
        }
    }

    /// `t̃ − t`, 0 in the explicit bands.
    fn set_residual(&mut self, channel: usize, target: &[f32]) {
        let field = self.field;
        self.residual.iter_mut().zip(target).for_each(|(r, t)| *r = -f64::from(*t));
        self.residual[..field.first * field.first].fill(0.0);
        for (lobe, values) in self.values.chunks_exact(self.residual.len()).enumerate() {
            let coeffs = field.lobe(&self.blended, channel, lobe);
            for ((_, band), g) in field.order.bands().skip(field.first).zip(coeffs) {
                self.residual[band.clone()].iter_mut().zip(&values[band]).for_each(|(r, y)| *r += g * y);
            }
        }
    }

    /// Eq. 19 and 20; `∇y` is along the sphere already.
    fn add_slopes(&self, channel: usize, factor: f64, out: &mut [f64]) {
        let (field, count) = (self.field, self.residual.len());
        let (axes, coeffs) = out.split_at_mut(3 * field.lobe_count);
        let coeffs = coeffs[channel * field.lobe_count * field.bands()..].chunks_exact_mut(field.bands().max(1));
        let lobes = axes.as_chunks_mut::<3>().0.iter_mut().zip(coeffs);
        for (lobe, (axis, slopes)) in lobes.enumerate() {
            let values = &self.values[lobe * count..][..count];
            let gradients = &self.gradients[3 * lobe * count..][..3 * count];
            let bands = field.order.bands().skip(field.first).zip(field.lobe(&self.blended, channel, lobe));
            for (((_, band), g), slope) in bands.zip(slopes) {
                let residual = &self.residual[band.clone()];
                let along = |from: &[f64]| factor * residual.iter().zip(from).map(|(r, y)| r * y).sum::<f64>();
                *slope += along(&values[band.clone()]);
                for (k, axis) in axis.iter_mut().enumerate() {
                    *axis += g * along(&gradients[k * count..][band.clone()]);
                }
            }
        }
    }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn set(numbers: &[f64], channels: usize, lobe_count: usize, first: usize) -> LobeSet {
        let mut set = LobeSet::zeros(Order::new(4).unwrap(), channels, lobe_count, first * first, 3);
        let mut numbers = numbers.iter().cycle();
        let mut next = || *numbers.next().unwrap() as f32;
        set.axes.iter_mut().for_each(|axis| *axis = [next(), next(), 1.0]);
        for (i, g) in set.coeffs.iter_mut().enumerate().filter(|(i, _)| i % 4 >= first) {
            *g = next() / (1 + i % 4) as f32;
        }
        set
    }

    proptest! {
        /// The gradient is that of central differences, for samples at points and between them, and for links.
        #[test]
        fn the_gradient_is_that_of_differences(
            numbers in prop::collection::vec(-1.0_f64..1.0, 97),
            (channels, first) in (1_usize..=2, 1_usize..=2),
        ) {
            let set = set(&numbers, channels, 2, first);
            let targets: Vec<f32> = numbers.iter().cycle().skip(5).take(3 * channels * 16).map(|&x| x as f32).collect();
            let blends = [Blend::at(0), Blend::barycentric([0, 1, 2], [0.5, 0.2, 0.3]), Blend::midpoint(1, 2)];
            let samples = blends.iter().zip(targets.chunks_exact(channels * 16)).zip([1.0, 0.7, 2.0]);
            let samples: Vec<Sample<'_>> =
                samples.map(|((&blend, target), weight)| Sample { blend, weight, target }).collect();
            let links = [Link { points: [0, 1], weight: 0.3 }, Link { points: [1, 2], weight: 0.9 }];
            let threads = Threads::new(Some(1)).unwrap();
            let mut field = Field::new(&set, &samples, &links, &threads);
            let mut x = field.variables(&set);
            field.axis_weights = field.link_weights(&x);
            let (mut gradient, mut unused) = (vec![0.0; x.len()], vec![0.0; x.len()]);
            field.cost(&x, &mut gradient);
            for i in 0..x.len() {
                let step = 1e-5;
                let here = x[i];
                x[i] = here + step;
                let high = field.cost(&x, &mut unused);
                x[i] = here - step;
                let low = field.cost(&x, &mut unused);
                x[i] = here;
                let difference = (high - low) / (2.0 * step);
                // Third derivatives are below 1e3.
                prop_assert!((gradient[i] - difference).abs() < 1e-6, "{i}: {} {difference}", gradient[i]);
            }
        }

        /// The cost is the squared error that reconstruction has.
        #[test]
        fn the_cost_is_the_squared_error(numbers in prop::collection::vec(-1.0_f64..1.0, 53)) {
            let mut set = set(&numbers, 1, 3, 2);
            set.axes.iter_mut().for_each(|axis| *axis = unit_or_z(axis.map(f64::from)).0.map(|x| x as f32));
            let mut target: Vec<f32> = numbers[..16].iter().map(|&x| x as f32).collect();
            let mut found = vec![0.0; 16];
            set.reconstruct(1, 0, &mut found);
            target[..4].copy_from_slice(&found[..4]);
            let expected: f64 = found.iter().zip(&target).map(|(a, b)| f64::from(a - b).powi(2)).sum();
            let samples = [Sample { blend: Blend::at(1), weight: 3.0, target: &target }];
            let threads = Threads::new(Some(1)).unwrap();
            let field = Field::new(&set, &samples, &[], &threads);
            let x = field.variables(&set);
            let cost = field.cost(&x, &mut vec![0.0; x.len()]);
            prop_assert!((cost - 3.0 * expected).abs() < 1e-5 * (1.0 + expected), "{cost} {expected}");
        }
    }
}
