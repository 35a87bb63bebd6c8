//! Transfer of a translucent patch, from the random walks that start in each texel.

use std::array::from_fn;

use sh_core::Order;

use super::field::HeightField;
use super::options::PatchOptions;
use super::surface::Surface;
use super::walk::{End, Walk, about};
use super::{PatchReport, PatchTransfer, ScatteringReport};
use crate::parallel::Threads;
use crate::sampling::Random;
use crate::transfer::unshadowed_vector;
use crate::{Error, Pass, Progress};

/// A bake is made of so many independent parts; how they differ tells the error.
const HALVES: usize = 2;

/// What the paths of one texel, channel and half found.
#[derive(Debug, Clone)]
struct Tally {
    /// `Σ w y(d)` over the paths that left, `[n²]`.
    vector: Vec<f64>,
    paths: usize,
    /// Weight that left above and below, and that was given up.
    above: f64,
    below: f64,
    given_up: f64,
    events: u64,
}

/// Bakes one row of transfer.
///
/// The transfer vector of a texel is the mean of `w y(d)` over paths that start in it: at points spread evenly over its square in u and
/// v, in directions `ω` spread over the hemisphere of the triangle there with density `cos θ/π`. A path runs against the light that leaves
/// along `ω`; where it leaves the patch at last, in the direction `d`, it has the weight `w`, so that the mean of `w L(d)` is the
/// radiance along `ω`, and the mean over `ω` is radiosity over π: for a light `L = Σ l_i y_i` the sum of `l_i` times the mean of `w y_i(d)`.
pub(super) fn bake(
    field: &HeightField,
    options: &PatchOptions,
    transfer: &mut PatchTransfer,
    progress: &dyn Progress,
    report: &mut PatchReport,
) -> Result<(), Error> {
    let Some(medium) = options.scattering else { return Ok(()) };
    let surface = Surface::new(field);
    let threads = Threads::new(options.threads)?;
    let walk = |channel| Walk::new(&surface, &medium, channel, options.thickness, ScatteringReport::MAX_EVENTS);
    let walks: Vec<Walk> = (0..transfer.channels).map(walk).collect();
    let mut texels: Vec<Vec<[Tally; HALVES]>> = vec![Vec::new(); field.texel_count()];
    progress.start(Pass::Texels, texels.len());
    threads.for_each(
        &mut texels,
        progress,
        || (),
        |(), texel, tallies| {
            *tallies = walks.iter().map(|walk| trace_texel(&surface, walk, texel, options)).collect();
            (options.rays_per_texel * walks.len()) as u64
        },
    )?;
    report.threads = threads.count();
    report.rays_traced = (options.rays_per_texel * walks.len() * texels.len()) as u64;
    report.error = (options.rays_per_texel >= HALVES).then(|| estimate_error(&texels, transfer));
    report.scattering = Some(summary(&texels, transfer.channels));
    let rows = transfer.values.chunks_exact_mut(options.order.coeff_count());
    for (row, halves) in rows.zip(texels.iter().flatten()) {
        let paths = halves.iter().map(|half| half.paths).sum::<usize>() as f64;
        for (i, value) in row.iter_mut().enumerate() {
            *value = (halves.iter().map(|half| half.vector[i]).sum::<f64>() / paths) as f32;
        }
    }
    Ok(())
}

/// All paths of a texel in one channel. The channels' paths start alike, so that their noise has little colour.
fn trace_texel(surface: &Surface, walk: &Walk, texel: usize, options: &PatchOptions) -> [Tally; HALVES] {
    let number = (texel as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mut random = Random::new(Random::new(options.seed ^ number).next());
    from_fn(|half| {
        let paths = (options.rays_per_texel + half) / HALVES;
        let mut tally = Tally::new(options.order, paths);
        let starts = Starts::new(&mut random);
        let mut basis = vec![0.0; options.order.coeff_count()];
        for number in 0..paths {
            trace_path(surface, walk, texel, starts.get(number), &mut random, &mut tally, &mut basis);
        }
        tally
    })
}

fn trace_path(
    surface: &Surface,
    walk: &Walk,
    texel: usize,
    [u, v, spread, turn]: [f64; 4],
    random: &mut Random,
    tally: &mut Tally,
    basis: &mut [f32],
) {
    let (position, point) = surface.point_of_texel(texel, [u - 0.5, v - 0.5]);
    // Malley's method: cos²θ is uniform.
    let outgoing = about(point.normal, (1.0 - spread).sqrt(), turn);
    let path = walk.follow(position, &point, -outgoing, random);
    tally.events += u64::from(path.events);
    let direction = match path.end {
        End::Lost => return,
        End::GivenUp => return tally.given_up += path.weight,
        End::Above(direction) => {
            tally.above += path.weight;
            direction
        }
        End::Below(direction) => {
            tally.below += path.weight;
            direction
        }
    };
    sh_core::eval(tally.order(), direction.as_vec3().normalize().to_array(), basis);
    tally.vector.iter_mut().zip(&*basis).for_each(|(sum, &y)| *sum += path.weight * f64::from(y));
}

impl Tally {
    fn new(order: Order, paths: usize) -> Self {
        Self { vector: vec![0.0; order.coeff_count()], paths, above: 0.0, below: 0.0, given_up: 0.0, events: 0 }
    }

    fn order(&self) -> Order {
        Order::new(self.vector.len().isqrt()).expect("made from an order")
    }
}

/// Points spread evenly over the unit cube of four dimensions: where in the texel a path starts, and in which direction.
///
/// Additive recurrence with the powers of the root of `x⁵ = x + 1` (M. Roberts, 2018), shifted at random.
#[derive(Debug)]
struct Starts {
    shift: [f64; 4],
}

impl Starts {
    const ROOT: f64 = 1.167_303_978_261_418_7;

    fn new(random: &mut Random) -> Self {
        Self { shift: from_fn(|_| random.unit()) }
    }

    fn get(&self, number: usize) -> [f64; 4] {
        from_fn(|k| (self.shift[k] + number as f64 * Self::ROOT.powi(-1 - k as i32)).fract())
    }
}

/// The root-mean-square error of the mean of the halves, which is half the difference of two, relative to the unshadowed vectors.
fn estimate_error(texels: &[Vec<[Tally; HALVES]>], transfer: &PatchTransfer) -> f64 {
    let (mut difference, mut signal) = (0.0, 0.0);
    let mut unshadowed = vec![0.0; transfer.order.coeff_count()];
    for (channels, normal) in texels.iter().zip(&transfer.normals) {
        unshadowed_vector(transfer.order, *normal, &mut unshadowed);
        for [a, b] in channels {
            let pairs = a.vector.iter().zip(&b.vector);
            difference += pairs.map(|(x, y)| (x / a.paths as f64 - y / b.paths as f64).powi(2)).sum::<f64>();
            signal += unshadowed.iter().map(|value| value * value).sum::<f64>();
        }
    }
    0.5 * (difference / signal).sqrt()
}

/// Means over all texels.
fn summary(texels: &[Vec<[Tally; HALVES]>], channels: usize) -> ScatteringReport {
    let mean = |value: fn(&Tally) -> f64| -> Vec<f64> {
        let tallies = |channel: usize| texels.iter().flat_map(move |channels| &channels[channel]);
        let paths = |channel| tallies(channel).map(|tally| tally.paths).sum::<usize>() as f64;
        (0..channels).map(|channel| tallies(channel).map(value).sum::<f64>() / paths(channel)).collect()
    };
    ScatteringReport {
        from_above: mean(|tally| tally.above),
        from_below: mean(|tally| tally.below),
        given_up: mean(|tally| tally.given_up),
        mean_events: mean(|tally| tally.events as f64),
    }
}
