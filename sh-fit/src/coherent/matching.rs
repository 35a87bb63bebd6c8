//! Which lobe of a vertex is which lobe of its neighbour.

use std::collections::VecDeque;

use super::assignment::assign;
use crate::problem::lobe_norm;
use crate::{Error, LobeSet, Neighbours};

/// Sweeps over all vertices. Each lowers the sum of the distances, so they end by themselves; two or three
/// are usual.
const MAX_SWEEPS: usize = 20;

/// Reorders the lobes of each vertex, and turns them to the other side, so that they are near those of its neighbours.
///
/// Both leave the function as it is: a lobe with the opposite axis and negated odd bands is the same lobe. What counts is the squared
/// error of lobes that are interpolated half way between two vertices, lobe by lobe; its sum over all edges never grows. Vertices
/// are matched to all their neighbours until nothing changes, from the order as it is and from one that spreads over each
/// connected part from its first vertex; the better of both is kept. Returns how many vertices changed.
///
/// # Errors
/// [`Error::Neighbours`] if `neighbours` has another number of points.
pub fn match_lobes(set: &mut LobeSet, neighbours: &Neighbours) -> Result<usize, Error> {
    let points = set.point_count();
    if neighbours.point_count() != points {
        return Err(Error::Neighbours { neighbours: neighbours.point_count(), points });
    }
    let before = (set.axes.clone(), set.coeffs.clone());
    // From the order as it is, and from one that spreads over the mesh: both end in a local optimum.
    let mut spread = set.clone();
    for (v, earlier) in breadth_first(neighbours) {
        match_vertex(&mut spread, v, &earlier);
    }
    sweep(&mut spread, neighbours);
    sweep(set, neighbours);
    if total_distance(&spread, neighbours) < total_distance(set, neighbours) {
        *set = spread;
    }
    Ok((0..points).filter(|&v| differs(set, &before, v)).count())
}

/// Matches all vertices to all their neighbours until nothing changes.
fn sweep(set: &mut LobeSet, neighbours: &Neighbours) {
    for _ in 0..MAX_SWEEPS {
        let changed = (0..set.point_count()).filter(|&v| match_vertex(set, v, neighbours.of(v))).count();
        if changed == 0 {
            break;
        }
    }
}

/// The sum of the distances over all edges, from both ends.
fn total_distance(set: &LobeSet, neighbours: &Neighbours) -> f64 {
    let lobes = |v: usize| (0..set.lobe_count).map(move |lobe| Lobe::of(set, v, lobe));
    let between = |v: usize, w: u32| lobes(v).zip(lobes(w as usize)).map(|(a, b)| a.distances(&b)[0]).sum::<f64>();
    (0..set.point_count()).map(|v| neighbours.of(v).iter().map(|&w| between(v, w)).sum::<f64>()).sum()
}

fn differs(set: &LobeSet, (axes, coeffs): &(Vec<[f32; 3]>, Vec<f32>), v: usize) -> bool {
    let (n, size) = (set.lobe_count, set.channels * set.lobe_count * set.order.get());
    set.axes_of(v) != &axes[v * n..][..n] || set.coeffs[v * size..][..size] != coeffs[v * size..][..size]
}

/// All vertices, each with its neighbours that come before it.
fn breadth_first(neighbours: &Neighbours) -> Vec<(usize, Vec<u32>)> {
    let mut place = vec![usize::MAX; neighbours.point_count()];
    let mut order = Vec::with_capacity(place.len());
    for first in 0..place.len() {
        let mut queue = VecDeque::from([first as u32]);
        while let Some(v) = queue.pop_front() {
            if place[v as usize] != usize::MAX {
                continue;
            }
            place[v as usize] = order.len();
            let earlier = |w: &&u32| place[**w as usize] < order.len();
            let earlier: Vec<u32> = neighbours.of(v as usize).iter().filter(earlier).copied().collect();
            queue.extend(neighbours.of(v as usize).iter().filter(|w| place[**w as usize] == usize::MAX));
            order.push((v as usize, earlier));
        }
    }
    order
}

/// Matches one vertex to some others. True if it changed.
fn match_vertex(set: &mut LobeSet, v: usize, others: &[u32]) -> bool {
    let count = set.lobe_count;
    if others.is_empty() || count == 0 {
        return false;
    }
    let lobes: Vec<Lobe> = (0..count).map(|lobe| Lobe::of(set, v, lobe)).collect();
    // [N, N] distance of each lobe to each place, from the nearer side.
    let mut distances = vec![[0.0; 2]; count * count];
    for &w in others {
        for (place, other) in (0..count).map(|place| (place, Lobe::of(set, w as usize, place))) {
            for (lobe, here) in lobes.iter().enumerate() {
                let [same, opposite] = here.distances(&other);
                distances[lobe * count + place][0] += same;
                distances[lobe * count + place][1] += opposite;
            }
        }
    }
    let nearer: Vec<f64> = distances.iter().map(|[same, opposite]| same.min(*opposite)).collect();
    let places = assign(&nearer, count);
    let total: f64 = places.iter().enumerate().map(|(lobe, place)| nearer[lobe * count + place]).sum();
    let stays: f64 = (0..count).map(|lobe| distances[lobe * count + lobe][0]).sum();
    // A tie must not turn lobes for ever.
    if total >= stays * (1.0 - 1e-9) {
        return false;
    }
    for (lobe, (here, place)) in lobes.iter().zip(places).enumerate() {
        let [same, opposite] = distances[lobe * count + place];
        here.store(set, v, place, opposite < same);
    }
    true
}

/// Legendre polynomials `P_0, P_1, …` by Bonnet's recurrence.
fn legendre(x: f64) -> impl Iterator<Item = f64> {
    let (mut l, mut here, mut next) = (0.0, 1.0, x);
    std::iter::repeat_with(move || {
        l += 1.0;
        let current = here;
        (here, next) = (next, ((2.0 * l + 1.0) * x * next - l * here) / (l + 1.0));
        current
    })
}

/// A lobe of a vertex, for all channels.
#[derive(Debug)]
struct Lobe {
    axis: [f64; 3],
    /// `[C, n]`
    coeffs: Vec<f64>,
    bands: usize,
}

impl Lobe {
    fn of(set: &LobeSet, point: usize, lobe: usize) -> Self {
        let n = set.order.get();
        let channel = |channel| set.coeffs_of(point, channel)[lobe * n..][..n].iter().map(|&g| f64::from(g));
        let coeffs: Vec<f64> = (0..set.channels).flat_map(channel).collect();
        Self { axis: set.axes_of(point)[lobe].map(f64::from), coeffs, bands: n }
    }

    /// What interpolation half way to another lobe costs, as it is and from the other side: the squared L2 distance of the lobe
    /// with the mean axis and mean coefficients from the mean of both functions.
    ///
    /// With lobes `g` about `a`, `h` about `b` and their mean `m`, whose products are `Σ (2l+1)/(4π) g*_l h*_l P_l(a·b)`:
    /// `|m|² + ¼ |g + h|² − m·(g + h)`.
    fn distances(&self, other: &Self) -> [f64; 2] {
        let cosine: f64 = self.axis.iter().zip(other.axis).map(|(a, b)| a * b).sum();
        [1.0, -1.0].map(|side| {
            let whole: Vec<f64> = legendre(side * cosine).take(self.bands).collect();
            let half: Vec<f64> = legendre((0.5 * (1.0 + side * cosine)).max(0.0).sqrt()).take(self.bands).collect();
            let terms = self.coeffs.iter().zip(&other.coeffs).enumerate().map(|(i, (&g, &h))| {
                let l = i % self.bands;
                let h = if l % 2 == 1 { side * h } else { h };
                let mean = 0.5 * (g + h);
                lobe_norm(l)
                    * (mean * mean + 0.25 * (g * g + h * h + 2.0 * g * h * whole[l]) - 2.0 * mean * mean * half[l])
            });
            terms.sum::<f64>().max(0.0)
        })
    }

    fn store(&self, set: &mut LobeSet, point: usize, place: usize, other_side: bool) {
        let (n, lobes) = (self.bands, set.lobe_count);
        let sign = if other_side { -1.0 } else { 1.0 };
        set.axes[point * lobes + place] = self.axis.map(|x| (sign * x) as f32);
        for (channel, coeffs) in self.coeffs.chunks_exact(n).enumerate() {
            let to = &mut set.coeffs[((point * set.channels + channel) * lobes + place) * n..][..n];
            for (l, (to, from)) in to.iter_mut().zip(coeffs).enumerate() {
                *to = (if l % 2 == 1 { sign * from } else { *from }) as f32;
            }
        }
    }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    use proptest::prelude::*;
    use sh_core::Order;

    use super::*;

    /// Lobes that change slowly over a grid of points.
    fn smooth(width: usize, height: usize, lobe_count: usize) -> LobeSet {
        let mut set = LobeSet::zeros(Order::new(4).unwrap(), 2, lobe_count, 1, width * height);
        for point in 0..width * height {
            let (x, y) = ((point % width) as f64 / 20.0, (point / width) as f64 / 20.0);
            for lobe in 0..lobe_count {
                let angle = 2.0 * lobe as f64 + x;
                set.axes[point * lobe_count + lobe] =
                    [angle.cos() * y.cos(), angle.sin() * y.cos(), y.sin()].map(|x| x as f32);
                for (channel, l) in (0..2).flat_map(|channel| (1..4).map(move |l| (channel, l))) {
                    let g = (1.0 + x) / (1 + l + lobe + channel) as f64;
                    set.coeffs[((point * 2 + channel) * lobe_count + lobe) * 4 + l] = g as f32;
                }
            }
        }
        set
    }

    /// Puts lobe `j` in the place `j + shift` and turns some of them round.
    fn disturb(set: &mut LobeSet, point: usize, shift: usize, turned: usize) {
        let lobes: Vec<Lobe> = (0..set.lobe_count).map(|lobe| Lobe::of(set, point, lobe)).collect();
        for (j, lobe) in lobes.iter().enumerate() {
            lobe.store(set, point, (j + shift) % set.lobe_count, (turned >> j) & 1 == 1);
        }
    }

    fn reconstructed(set: &LobeSet) -> Vec<f32> {
        let mut out = vec![0.0; set.point_count() * 2 * 16];
        for (i, out) in out.chunks_exact_mut(16).enumerate() {
            set.reconstruct(i / 2, i % 2, out);
        }
        out
    }

    proptest! {
        /// Whatever was exchanged and turned round is put right, and the function is left as it is.
        #[test]
        fn order_and_sides_are_found_again(changes in prop::collection::vec((0_usize..3, 0_usize..8), 30)) {
            let neighbours = Neighbours::grid(6, 5, false);
            let original = smooth(6, 5, 3);
            let mut set = original.clone();
            changes.iter().enumerate().for_each(|(v, &(shift, turned))| disturb(&mut set, v, shift, turned));
            let before = reconstructed(&set);
            match_lobes(&mut set, &neighbours).unwrap();
            let (found, expected) = (total_distance(&set, &neighbours), total_distance(&original, &neighbours));
            prop_assert!((found - expected).abs() < 1e-9 * expected, "{found} {expected}");
            for (a, b) in before.iter().zip(reconstructed(&set)) {
                prop_assert!((a - b).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn halfway_errors_are_those_of_the_functions() {
        let mut set = smooth(2, 1, 1);
        disturb(&mut set, 1, 0, 1);
        let mut middle = crate::interpolate(&set, &[crate::Blend::midpoint(0, 1)]);
        let lobes = [Lobe::of(&set, 0, 0), Lobe::of(&set, 1, 0)];
        for side in 0..2 {
            let (found, ends) = (reconstructed(&middle), reconstructed(&set));
            let mean = ends[..32].iter().zip(&ends[32..]).map(|(a, b)| 0.5 * (a + b));
            let expected: f64 = mean.zip(found).map(|(a, b)| f64::from(a - b).powi(2)).sum();
            let distance = lobes[0].distances(&lobes[1])[side];
            assert!((distance - expected).abs() < 1e-5 * (1.0 + expected), "{side} {distance} {expected}");
            disturb(&mut set, 1, 0, 1);
            middle = crate::interpolate(&set, &[crate::Blend::midpoint(0, 1)]);
        }
    }

    #[test]
    fn parts_without_connection_are_matched_on_their_own() {
        // Two triangles and a lonely vertex.
        let neighbours = Neighbours::from_triangles(7, &[[0, 1, 2], [3, 4, 5]]).unwrap();
        let mut set = smooth(7, 1, 2);
        let original = set.clone();
        disturb(&mut set, 1, 1, 2);
        disturb(&mut set, 4, 1, 0);
        disturb(&mut set, 5, 0, 3);
        disturb(&mut set, 6, 1, 1);
        let lonely = set.axes_of(6).to_vec();
        assert!(match_lobes(&mut set, &neighbours).unwrap() >= 3);
        let (found, expected) = (total_distance(&set, &neighbours), total_distance(&original, &neighbours));
        assert!((found - expected).abs() < 1e-9 * expected, "{found} {expected}");
        assert_eq!(set.axes_of(6), lonely);
    }

    #[test]
    fn what_corresponds_stays() {
        let mut set = smooth(5, 5, 4);
        let before = set.clone();
        assert_eq!(match_lobes(&mut set, &Neighbours::grid(5, 5, false)).unwrap(), 0);
        assert_eq!(set, before);
        assert!(match_lobes(&mut set, &Neighbours::grid(5, 4, false)).is_err());
        // Zero lobes are all alike.
        let mut zero = LobeSet::zeros(Order::new(3).unwrap(), 1, 3, 4, 25);
        assert_eq!(match_lobes(&mut zero, &Neighbours::grid(5, 5, false)).unwrap(), 0);
    }
}
