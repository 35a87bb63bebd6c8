//! The fit of one vector and of many.

mod many;

use sh_core::{Order, expand_lobe, linear_axis};

use crate::problem::{Projected, Signal, dot3, lobe_norm};
use crate::search::{Found, Search};
use crate::start::Directions;
use crate::{Error, FitOptions, Stop, explicit_count};
pub use many::fit_lobes_many;

/// Zonal lobes that approximate one vector.
#[derive(Debug, Clone, PartialEq)]
pub struct LobeFit {
    /// Number of bands `n`.
    pub order: Order,
    /// Channels `C`.
    pub channels: usize,
    /// Coefficients that are kept as they are, `[C, k]`.
    pub explicit: Vec<f64>,
    /// `[N]`: unit length; +z where a lobe is not used.
    pub axes: Vec<[f64; 3]>,
    /// `[C, N, n]`: lobe coefficients `g*_l`; 0 in the explicit bands and for unused lobes.
    pub coeffs: Vec<f64>,
    /// How many lobes are used; they come first.
    pub lobes_used: usize,
    /// L2 length of `t̃ − t`, over all channels.
    pub error: f64,
    /// The error over the length of `t`; 0 for a zero vector.
    pub relative_error: f64,
    /// Starts from which axes were searched for.
    pub starts: usize,
    /// Iterations, over all starts.
    pub iterations: usize,
    /// Evaluations of the error, over all starts.
    pub evaluations: usize,
    /// Why the best minimisation ended.
    pub stop: Stop,
}

impl LobeFit {
    /// Writes the approximation `t̃` of a channel.
    ///
    /// - `out`: `[n²]`, overwritten
    ///
    /// # Panics
    /// If `out` is not `[n²]`, or there is no such channel.
    pub fn reconstruct(&self, channel: usize, out: &mut [f64]) {
        let (n, count) = (self.order.get(), self.order.coeff_count());
        assert!(out.len() == count, "out has {} elements, it needs {count}", out.len());
        assert!(channel < self.channels, "channel {channel} of {}", self.channels);
        out.fill(0.0);
        let mut lobe = vec![0.0; count];
        let lobes = self.coeffs[channel * self.axes.len() * n..].chunks_exact(n);
        for (&axis, coeffs) in self.axes.iter().zip(lobes) {
            expand_lobe(self.order, coeffs, axis, &mut lobe);
            out.iter_mut().zip(&lobe).for_each(|(out, lobe)| *out += lobe);
        }
        let k = self.explicit.len() / self.channels;
        out.iter_mut().zip(&self.explicit[channel * k..][..k]).for_each(|(out, explicit)| *out += explicit);
    }
}

/// Fits zonal lobes to one vector.
///
/// - `target`: `[C, n²]`; the channels share the axes
///
/// # Errors
/// [`Error::Option`] for settings that cannot be used, [`Error::NotFinite`] for a coefficient that is not finite.
///
/// # Panics
/// If `target` is not `[C, n²]`, or `channels` is 0.
///
/// Source: [SLS05](sh_core#references) section 4.1.
pub fn fit_lobes(order: Order, channels: usize, target: &[f64], options: &FitOptions) -> Result<LobeFit, Error> {
    options.validate()?;
    let count = order.coeff_count();
    assert!(channels > 0 && target.len() == channels * count, "target is not [C, n²]");
    if let Some(i) = target.iter().position(|t| !t.is_finite()) {
        return Err(Error::NotFinite { channel: i / count, index: i % count, value: target[i] });
    }
    let shape = Shape { order, channels, lobe_count: options.lobe_count };
    let directions = Directions::new(order);
    let mut search = shape.search(options, &directions);
    search.problem_mut().signal_mut().load(target);
    let found = shape.find(&mut search, options, 0, 1.0);
    let counts = search.take_counts();
    let mut fit = LobeFit {
        order,
        channels,
        explicit: target.chunks_exact(count).flat_map(|target| &target[..shape.explicit_count()]).copied().collect(),
        axes: vec![[0.0, 0.0, 1.0]; options.lobe_count],
        coeffs: vec![0.0; channels * options.lobe_count * order.get()],
        lobes_used: found.axes.len(),
        error: 0.0,
        relative_error: 0.0,
        starts: counts.starts,
        iterations: counts.iterations,
        evaluations: counts.evaluations,
        stop: found.stop,
    };
    shape.write(search.problem_mut(), &found.axes, &mut fit.axes, &mut fit.coeffs);
    fit.measure(target);
    Ok(fit)
}

impl LobeFit {
    /// The error, relative to the largest coefficient first: squares of neither huge nor tiny numbers are infinite or zero.
    fn measure(&mut self, target: &[f64]) {
        let scale = target.iter().fold(0.0_f64, |max, t| max.max(t.abs()));
        if scale == 0.0 {
            return;
        }
        let mut approximation = vec![0.0; self.order.coeff_count()];
        let (mut error, mut length) = (0.0, 0.0);
        for (channel, target) in target.chunks_exact(approximation.len()).enumerate() {
            self.reconstruct(channel, &mut approximation);
            error += target.iter().zip(&approximation).map(|(t, a)| ((t - a) / scale).powi(2)).sum::<f64>();
            length += target.iter().map(|t| (t / scale).powi(2)).sum::<f64>();
        }
        self.error = error.sqrt() * scale;
        self.relative_error = (error / length).sqrt();
    }
}

/// What is fitted to each point.
#[derive(Debug, Clone, Copy)]
struct Shape {
    order: Order,
    channels: usize,
    lobe_count: usize,
}

impl Shape {
    fn explicit_count(&self) -> usize {
        explicit_count(self.order, self.lobe_count)
    }

    fn search<'a>(&self, options: &'a FitOptions, directions: &'a Directions) -> Search<'a> {
        let signal = Signal::new(self.order, self.channels, self.explicit_count().isqrt());
        Search::new(options, directions, Projected::new(signal, options.regularisation))
    }

    /// The best axes of the vector that is loaded; with a target error as few as reach it.
    ///
    /// - `unit`: what the target error is relative to, over the length of the vector
    fn find(&self, search: &mut Search<'_>, options: &FitOptions, stream: u64, unit: f64) -> Found {
        let Some(target) = options.target_error.filter(|_| options.per_point) else {
            return search.run(self.lobe_count, stream);
        };
        let mut found = search.run(0, stream);
        for lobes in 1..=self.lobe_count {
            if search.relative_error(&found.axes) <= target * unit {
                found.stop = Stop::Target;
                break;
            }
            found = search.run(lobes, stream);
        }
        found
    }

    /// Writes the axes, and the coefficients of the lobes about them, of the vector that is loaded: the lobe with most energy
    /// first, and axes on the side of the linear band.
    fn write(&self, problem: &mut Projected, found: &[[f64; 3]], axes: &mut [[f64; 3]], coeffs: &mut [f64]) {
        let n = self.order.get();
        problem.set_axes(found);
        problem.refine();
        let first = self.explicit_count().isqrt();
        let energy = |lobe: usize| {
            let bands = (first..n).flat_map(|l| (0..self.channels).map(move |c| (l, c)));
            bands.map(|(l, c)| lobe_norm(l) * problem.lobe(l, c, lobe).powi(2)).sum::<f64>()
        };
        let mut by_energy: Vec<(usize, f64)> = (0..found.len()).map(|lobe| (lobe, energy(lobe))).collect();
        by_energy.sort_by(|a, b| b.1.total_cmp(&a.1));
        let up = linear_axis(&problem.signal().target()[..self.order.coeff_count()]);
        let length = problem.signal().length();
        for (place, &(lobe, _)) in by_energy.iter().enumerate() {
            let flip = if dot3(found[lobe], up) < 0.0 { -1.0 } else { 1.0 };
            axes[place] = found[lobe].map(|x| flip * x);
            for (l, c) in (first..n).flat_map(|l| (0..self.channels).map(move |c| (l, c))) {
                let sign = if l % 2 == 1 { flip } else { 1.0 };
                coeffs[(c * self.lobe_count + place) * n + l] = sign * length * problem.lobe(l, c, lobe);
            }
        }
    }
}
