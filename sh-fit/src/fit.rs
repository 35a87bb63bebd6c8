//! The fit of one vector and of many.

use sh_core::{Order, expand_lobe, fit_lobe_about_axis, linear_axis};

use crate::{Distribution, Error, FitOptions, FitReport, LobeSet, Neighbours, Stop, StopCounts, explicit_count};

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
    let (n, count) = (order.get(), order.coeff_count());
    assert!(channels > 0 && target.len() == channels * count, "target is not [C, n²]");
    if let Some(i) = target.iter().position(|t| !t.is_finite()) {
        return Err(Error::NotFinite { channel: i / count, index: i % count, value: target[i] });
    }
    let k = explicit_count(order, options.lobe_count);
    let mut axes = vec![[0.0, 0.0, 1.0]; options.lobe_count];
    axes[0] = linear_axis(&target[..count]);
    let mut coeffs = vec![0.0; channels * options.lobe_count * n];
    let mut explicit = Vec::new();
    let mut remainder = vec![0.0; count];
    let mut squared = 0.0;
    for (target, coeffs) in target.chunks_exact(count).zip(coeffs.chunks_exact_mut(options.lobe_count * n)) {
        explicit.extend_from_slice(&target[..k]);
        fit_lobe_about_axis(order, target, axes[0], &mut coeffs[..n], &mut remainder);
        coeffs[..k.isqrt()].fill(0.0);
        squared += remainder[k..].iter().map(|r| r * r).sum::<f64>();
    }
    let error = squared.sqrt();
    let length = target.iter().map(|t| t * t).sum::<f64>().sqrt();
    let relative_error = if length > 0.0 { error / length } else { 0.0 };
    Ok(LobeFit {
        order,
        channels,
        explicit,
        axes,
        coeffs,
        error,
        relative_error,
        starts: 1,
        iterations: 0,
        evaluations: 1,
        stop: Stop::Converged,
    })
}

/// Fits zonal lobes to the transfer of many points.
///
/// - `targets`: `[P, C, n²]`
/// - `neighbours`: which points lie beside which; their axes are tried as starts
/// - `progress`: called, from any thread, with the number of points that were finished since its last call; one pass over the
///   points for each number of lobes that is tried
///
/// Points with a coefficient that is not finite are left zero and named in the report.
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
    let (n, count) = (order.get(), order.coeff_count());
    assert!(channels > 0 && targets.len().is_multiple_of(channels * count), "targets is not [P, C, n²]");
    let points = targets.len() / (channels * count);
    if let Some(neighbours) = neighbours.filter(|neighbours| neighbours.point_count() != points) {
        return Err(Error::Neighbours { neighbours: neighbours.point_count(), points });
    }
    let k = explicit_count(order, options.lobe_count);
    let mut set = LobeSet::zeros(order, channels, options.lobe_count, k, points);
    let mut report = FitReport {
        points,
        lobes: options.lobe_count,
        relative_error: 0.0,
        band_errors: vec![0.0; n],
        distribution: Distribution::default(),
        lobes_used: vec![0; options.lobe_count + 1],
        largest_coefficient: 0.0,
        starts: 0,
        iterations: 0,
        evaluations: 0,
        stops: StopCounts::default(),
        not_finite: Vec::new(),
        seconds: 0.0,
    };
    for (point, target) in targets.chunks_exact(channels * count).enumerate() {
        let target: Vec<f64> = target.iter().map(|&t| f64::from(t)).collect();
        let Ok(fit) = fit_lobes(order, channels, &target, options) else {
            report.not_finite.push(point);
            continue;
        };
        let per_point = |len: usize| point * len..(point + 1) * len;
        let narrow = |from: &[f64], to: &mut [f32]| to.iter_mut().zip(from).for_each(|(to, from)| *to = *from as f32);
        narrow(&fit.explicit, &mut set.explicit[per_point(channels * k)]);
        narrow(&fit.coeffs, &mut set.coeffs[per_point(channels * options.lobe_count * n)]);
        for (to, from) in set.axes[per_point(options.lobe_count)].iter_mut().zip(&fit.axes) {
            *to = from.map(|x| x as f32);
        }
        report.stops.add(fit.stop);
        progress(1);
    }
    Ok((set, report))
}
