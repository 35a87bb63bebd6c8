//! Whether the two sides of a cut in the atlas agree.

use glam::DVec2;

use super::TexelTransfer;
use super::edges::{Side, edges, is_smooth};
use super::layout::Layout;

/// Two places of a vertex on the atlas that are nearer than this, in texels, are one.
const SAME_PLACE: f64 = 1e-3;

/// Most points of an edge that are compared.
const MAX_SAMPLES: usize = 256;

/// What was found along all cuts.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct SeamCheck {
    pub(super) edges: usize,
    /// Root mean square difference over root mean square length.
    pub(super) error: f64,
    /// Largest difference over root mean square length.
    pub(super) max: f64,
}

/// A smooth edge that lies at two places of the atlas: from where to where on each of its sides.
pub(super) type Cut = [[DVec2; 2]; 2];

/// The smooth edges that lie at two places.
pub(super) fn cuts(layout: &Layout) -> Vec<Cut> {
    let cut = |sides: &Vec<Side>| {
        let [first, second] = sides.as_slice() else { return None };
        let is_compared = is_cut(layout, first, second) && is_smooth(layout, first, second);
        is_compared.then(|| [first, second].map(|side| side.vertices.map(|vertex| layout.place(vertex))))
    };
    edges(layout).values().filter_map(cut).collect()
}

/// Compares bilinear lookups at matching points of both sides of every cut, about one a texel.
pub(super) fn check(atlas: &TexelTransfer, cuts: &[Cut]) -> SeamCheck {
    let mut sums = Sums { edges: cuts.len(), ..Sums::default() };
    cuts.iter().for_each(|cut| compare(atlas, cut, &mut sums));
    sums.finish()
}

fn is_cut(layout: &Layout, first: &Side, second: &Side) -> bool {
    let size = layout.grid.size();
    [0, 1].iter().any(|&end| {
        let [a, b] = [first, second].map(|side| layout.place(side.vertices[end]));
        let mut apart = (a - b).abs();
        for axis in (0..2).filter(|&axis| layout.grid.wraps[axis]) {
            apart[axis] -= size[axis] * (apart[axis] / size[axis]).round();
        }
        apart.abs().max_element() > SAME_PLACE
    })
}

/// Running sums over the points that are compared.
#[derive(Debug, Default)]
struct Sums {
    edges: usize,
    points: usize,
    difference: f64,
    length: f64,
    max: f64,
}

impl Sums {
    fn finish(self) -> SeamCheck {
        let mean_length = (self.length / self.points.max(1) as f64).max(f64::MIN_POSITIVE);
        SeamCheck {
            edges: self.edges,
            error: (self.difference / self.points.max(1) as f64 / mean_length).sqrt(),
            max: (self.max / mean_length).sqrt(),
        }
    }
}

fn compare(atlas: &TexelTransfer, places: &Cut, sums: &mut Sums) {
    let longest = places.map(|[from, to]| from.distance(to)).into_iter().fold(0.0, f64::max);
    let count = (longest.ceil() as usize).clamp(1, MAX_SAMPLES);
    for k in 0..count {
        let share = (k as f64 + 0.5) / count as f64;
        let [a, b] = places.map(|[from, to]| lookup(atlas, from.lerp(to, share)));
        let squared = |values: &mut dyn Iterator<Item = f64>| values.map(|value| value * value).sum::<f64>();
        let difference = squared(&mut a.iter().zip(&b).map(|(a, b)| a - b));
        sums.points += 1;
        sums.difference += difference;
        sums.length += 0.5 * (squared(&mut a.iter().copied()) + squared(&mut b.iter().copied()));
        sums.max = sums.max.max(difference);
    }
}

/// Bilinear lookup of all channels, `[C, n²]`.
fn lookup(atlas: &TexelTransfer, place: DVec2) -> Vec<f64> {
    let length = atlas.transfer.channels * atlas.transfer.order.coeff_count();
    let mut sum = vec![0.0; length];
    for (texel, weight) in atlas.grid().bilinear(place) {
        let row = &atlas.transfer.values[texel * length..][..length];
        sum.iter_mut().zip(row).for_each(|(sum, &value)| *sum += weight * f64::from(value));
    }
    sum
}
