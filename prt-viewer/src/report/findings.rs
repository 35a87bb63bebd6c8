//! What the numbers of the vertices say, counted once for the page and the file.

use std::f32::consts::PI;

use prt_bake::{BakedSurface, TransferVectors, VertexStats};
use serde_json::{Value, json};

use super::histogram::Histogram;

/// Decades of the error that the histogram tells apart.
const ERROR_DECADES: [i32; 2] = [-6, 0];
/// Bins of the other histograms.
const BINS: usize = 20;

#[derive(Debug)]
pub(super) struct Findings {
    /// Share of the light that arrives at each vertex under a constant light, `[V]`; what is reflected counts.
    pub(super) arriving: Vec<f32>,
    pub(super) arriving_histogram: Histogram,
    /// What is drawn as occlusion.
    pub(super) open: Open,
    /// Vertices inside geometry.
    pub(super) invalid: Vec<u32>,
    /// Of what was estimated; none if nothing was.
    pub(super) error: Option<ErrorSpread>,
    /// None if no ray was traced.
    pub(super) rays: Option<RaySpread>,
    /// Share of the squared length of all transfer vectors in each band.
    pub(super) band_energy: Vec<f64>,
}

/// How open each vertex is to light that comes from afar, `[V]`: the nearest to occlusion that a bake tells.
#[derive(Debug)]
pub(super) enum Open {
    /// Share of a constant light that arrives, without what is reflected.
    Direct(Vec<f32>),
    /// Share of the directions above the vertex that meet nothing.
    Directions(Vec<f32>),
    /// Share of a constant light that arrives, with what is reflected.
    Total(Vec<f32>),
}

impl Open {
    fn of(baked: &BakedSurface, vertices: &[VertexStats]) -> Self {
        match &baked.transfer_shadowed {
            Some(shadowed) => Self::Direct(arriving(shadowed)),
            None if baked.metadata.bounces == 0 => Self::Direct(arriving(&baked.transfer)),
            None if vertices.is_empty() => Self::Total(arriving(&baked.transfer)),
            None => Self::Directions(vertices.iter().map(|stats| 1.0 - stats.occluded_share()).collect()),
        }
    }

    pub(super) fn shares(&self) -> &[f32] {
        let (Self::Direct(shares) | Self::Directions(shares) | Self::Total(shares)) = self;
        shares
    }
}

/// Estimated relative error of the vertices.
#[derive(Debug)]
pub(super) struct ErrorSpread {
    /// Vertices with an estimate.
    pub(super) estimated: usize,
    /// Vertices whose estimate is 0: nothing shadows them.
    pub(super) exact: usize,
    pub(super) median: f32,
    /// 19 of 20 vertices are at most here.
    pub(super) most: f32,
    pub(super) largest: f32,
    pub(super) histogram: Histogram,
}

/// Rays traced for a vertex.
#[derive(Debug)]
pub(super) struct RaySpread {
    pub(super) fewest: u32,
    pub(super) median: u32,
    pub(super) most: u32,
    /// One of 20 vertices has at most the first, and one of 20 at least the second.
    usual: [u32; 2],
    pub(super) total: u64,
    /// Directions that the rays answered for, together.
    pub(super) directions: u64,
    pub(super) occluded: u64,
    pub(super) histogram: Histogram,
}

impl Findings {
    /// # Panics
    /// If there are numbers for other than all or none of the vertices.
    pub(super) fn of(baked: &BakedSurface, vertices: &[VertexStats]) -> Self {
        let vertex_count = baked.geometry.vertex_count();
        assert!(vertices.is_empty() || vertices.len() == vertex_count, "numbers for all vertices, or for none");
        let arriving = arriving(&baked.transfer);
        Self {
            // Rays leave a little more than all and less than nothing.
            arriving_histogram: Histogram::linear(arriving.iter().map(|share| share.clamp(0.0, 1.0)), [0.0, 1.0], BINS),
            open: Open::of(baked, vertices),
            arriving,
            invalid: invalid(baked, vertices),
            error: ErrorSpread::of(vertices),
            rays: RaySpread::of(vertices),
            band_energy: band_energy(&baked.transfer),
        }
    }

    /// Mean over the vertices of the share that arrives.
    pub(super) fn mean_arriving(&self) -> f64 {
        self.arriving.iter().map(|&share| f64::from(share)).sum::<f64>() / self.arriving.len().max(1) as f64
    }

    pub(super) fn json(&self) -> Value {
        json!({
            "arriving": { "mean": self.mean_arriving(), "histogram": self.arriving_histogram.json() },
            "invalid_vertices": self.invalid.len(),
            "error": self.error.as_ref().map(ErrorSpread::json),
            "rays": self.rays.as_ref().map(RaySpread::json),
            "band_energy": self.band_energy,
        })
    }
}

impl ErrorSpread {
    fn of(vertices: &[VertexStats]) -> Option<Self> {
        let errors = || vertices.iter().map(|stats| stats.error);
        let mut sorted: Vec<f32> = errors().filter(|error| error.is_finite()).collect();
        sorted.sort_unstable_by(f32::total_cmp);
        Some(Self {
            estimated: sorted.len(),
            exact: sorted.partition_point(|&error| error <= 0.0),
            median: quantile(&sorted, 0.5)?,
            most: quantile(&sorted, 0.95)?,
            largest: quantile(&sorted, 1.0)?,
            histogram: Histogram::logarithmic(errors(), ERROR_DECADES, 4),
        })
    }

    fn json(&self) -> Value {
        json!({
            "estimated_vertices": self.estimated,
            "exact_vertices": self.exact,
            "median": self.median,
            "percentile_95": self.most,
            "largest": self.largest,
            "histogram": self.histogram.json(),
        })
    }
}

impl RaySpread {
    fn of(vertices: &[VertexStats]) -> Option<Self> {
        let mut sorted: Vec<u32> = vertices.iter().map(|stats| stats.rays).collect();
        sorted.sort_unstable();
        let [fewest, median, most] = [0.0, 0.5, 1.0].map(|share| quantile(&sorted, share));
        let most = most.filter(|&most| most > 0)?;
        let sum = |count: fn(&VertexStats) -> u32| vertices.iter().map(|stats| u64::from(count(stats))).sum();
        Some(Self {
            fewest: fewest?,
            median: median?,
            most,
            usual: [quantile(&sorted, 0.05)?, quantile(&sorted, 0.95)?],
            total: sum(|stats| stats.rays),
            directions: sum(|stats| stats.directions),
            occluded: sum(|stats| stats.occluded),
            histogram: Histogram::linear(sorted.iter().map(|&rays| rays as f32), [0.0, f64::from(most)], BINS),
        })
    }

    /// Whether many vertices were given more rays than many others, beyond what the number of directions above each horizon differs by.
    pub(super) fn vary(&self) -> bool {
        let [low, high] = self.usual.map(f64::from);
        high > 1.1 * low
    }

    fn json(&self) -> Value {
        json!({
            "fewest": self.fewest,
            "median": self.median,
            "most": self.most,
            "total": self.total,
            "directions": self.directions,
            "occluded_directions": self.occluded,
            "histogram": self.histogram.json(),
        })
    }
}

/// The vertices that are not valid, as the bake or the file tells.
fn invalid(baked: &BakedSurface, vertices: &[VertexStats]) -> Vec<u32> {
    let bake = vertices.iter().map(|stats| stats.validity);
    let file = baked.validity.iter().flatten().copied().take(if vertices.is_empty() { usize::MAX } else { 0 });
    let all = (0_u32..).zip(bake.chain(file));
    all.filter(|&(_, validity)| validity < VertexStats::VALID).map(|(vertex, _)| vertex).collect()
}

/// The value below or at which a share of sorted values lies; none of no values.
fn quantile<T: Copy>(sorted: &[T], share: f64) -> Option<T> {
    let last = sorted.len().checked_sub(1)?;
    sorted.get((share * last as f64).ceil() as usize).copied()
}

/// Exit radiance over albedo under radiance 1 from everywhere: the first coefficient of that light is √(4π), all others are 0.
fn arriving(transfer: &TransferVectors) -> Vec<f32> {
    let length = transfer.channels * transfer.order.coeff_count();
    let scale = (4.0 * PI).sqrt() / transfer.channels as f32;
    let vectors = transfer.values.chunks_exact(length);
    vectors.map(|vector| scale * vector.iter().step_by(transfer.order.coeff_count()).sum::<f32>()).collect()
}

/// Squared length in each band over that of all; zeros if there is none.
fn band_energy(transfer: &TransferVectors) -> Vec<f64> {
    let mut energy = vec![0.0; transfer.order.get()];
    for vector in transfer.values.chunks_exact(transfer.order.coeff_count()) {
        for (l, energy) in energy.iter_mut().enumerate() {
            let band = &vector[l * l..(l + 1) * (l + 1)];
            *energy += band.iter().map(|&value| f64::from(value).powi(2)).sum::<f64>();
        }
    }
    let total: f64 = energy.iter().sum();
    energy.into_iter().map(|band| if total > 0.0 { band / total } else { 0.0 }).collect()
}
