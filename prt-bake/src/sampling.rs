//! Directions to trace: one set for the whole bake, sorted so that neighbours in the list are neighbours on the sphere.

use glam::{DQuat, DVec3, Vec3};
use sh_core::Order;

use crate::scene::{Bins, Packet};

/// Number of directions that are traced together.
pub(crate) const PACKET_SIZE: usize = Packet::SIZE;

/// Directions evenly spread over the sphere, each with the same weight, and the basis functions there.
///
/// A spherical Fibonacci set, rotated by a random rotation drawn from the seed and sorted along a Hilbert curve on the octahedral
/// map. One set serves every vertex: basis functions are tabulated once, and consecutive directions make coherent packets.
#[derive(Debug, Clone)]
pub struct DirectionSet {
    /// `[D]`, unit length; `D` is a multiple of [`PACKET_SIZE`].
    pub(crate) directions: Vec<Vec3>,
    /// The directions in groups of [`PACKET_SIZE`], ready to be traced.
    pub(crate) packets: Vec<Packet>,
    /// The packets in groups.
    pub(crate) bins: Bins,
    /// Number of bands of `basis`.
    pub(crate) order: Order,
    /// Basis functions `[D, n²]`.
    pub(crate) basis: Vec<f32>,
}

impl DirectionSet {
    /// A set with at least `count` directions over the whole sphere: the next multiple of 64.
    #[must_use]
    pub fn new(count: usize, order: Order, seed: u64) -> Self {
        let count = count.next_multiple_of(PACKET_SIZE);
        let rotation = random_rotation(&mut Random::new(seed));
        let rotated = sh_core::fibonacci(count).into_iter().map(|s| rotation * DVec3::from_array(s));
        let mut directions: Vec<Vec3> = rotated.map(|s| s.normalize().as_vec3()).collect();
        bisect(&mut directions, 0);
        let mut basis = vec![0.0; count * order.coeff_count()];
        for (direction, row) in directions.iter().zip(basis.chunks_exact_mut(order.coeff_count())) {
            sh_core::eval(order, direction.to_array(), row);
        }
        let packets = directions.chunks(PACKET_SIZE).map(Packet::new).collect();
        let bins = Bins::new(&directions, PACKET_SIZE);
        Self { directions, packets, bins, order, basis }
    }

    /// `[D]`, unit length, neighbours beside each other.
    #[must_use]
    pub fn directions(&self) -> &[Vec3] {
        &self.directions
    }
}

fn bisect(directions: &mut [Vec3], depth: usize) {
    let len = directions.len();
    if len <= 8 {
        return;
    }
    let first = if len > PACKET_SIZE { (len / PACKET_SIZE).next_power_of_two() / 2 * PACKET_SIZE } else { len / 2 };
    if depth < 3 {
        directions.select_nth_unstable_by(first, |a, b| a[depth].total_cmp(&b[depth]));
    } else {
        let step = len.div_ceil(64);
        let samples: Vec<Vec3> = directions.iter().step_by(step).copied().collect();
        let mean = samples.iter().sum::<Vec3>().normalize();
        let (u, v, [l, h]) = crate::scene::smallest_rectangle(&samples, mean);
        let axis = if h[0] - l[0] > h[1] - l[1] { u } else { v };
        let slope = |d: &Vec3| d.dot(axis) / d.dot(mean);
        directions.select_nth_unstable_by(first, |a, b| slope(a).total_cmp(&slope(b)));
    }
    let (a, b) = directions.split_at_mut(first);
    bisect(a, depth + 1);
    bisect(b, depth + 1);
}

/// A random number generator of 64 bits of state: SplitMix64 (Steele, Lea, Flood 2014). It seeds rotations, and drives random walks:
/// its period of 2^64 and its tests (BigCrush) are enough for some 10^10 numbers a bake.
#[derive(Debug, Clone)]
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in `[0, 1)`.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// A rotation drawn uniformly from all of them (Shoemake, Graphics Gems III, 1992).
fn random_rotation(random: &mut Random) -> DQuat {
    use std::f64::consts::TAU;
    let (u, a, b) = (random.unit(), TAU * random.unit(), TAU * random.unit());
    let (r, s) = ((1.0 - u).sqrt(), u.sqrt());
    DQuat::from_xyzw(r * a.sin(), r * a.cos(), s * b.sin(), s * b.cos())
}

/// Position of a direction along a Hilbert curve over the octahedral map of the sphere.
fn hilbert_number(direction: Vec3) -> u32 {
    const BITS: u32 = 15;
    let side = ((1 << BITS) - 1) as f32;
    let [u, v] = octahedral(direction).map(|x| ((0.5 * x + 0.5) * side) as u32);
    hilbert_curve(u, v, BITS)
}

/// The sphere unfolded onto the square `[-1, 1]²`.
fn octahedral(s: Vec3) -> [f32; 2] {
    let p = s / (s.x.abs() + s.y.abs() + s.z.abs());
    if p.z >= 0.0 { [p.x, p.y] } else { [(1.0 - p.y.abs()).copysign(p.x), (1.0 - p.x.abs()).copysign(p.y)] }
}

/// Distance along the Hilbert curve that fills a square of `2^bits` cells a side.
fn hilbert_curve(mut x: u32, mut y: u32, bits: u32) -> u32 {
    let mut distance = 0;
    for bit in (0..bits).rev() {
        let (right, upper) = (x >> bit & 1, y >> bit & 1);
        distance += ((3 * right) ^ upper) << (2 * bit);
        if upper == 0 {
            if right == 1 {
                (x, y) = (!x, !y);
            }
            (x, y) = (y, x);
        }
    }
    distance
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_visits_every_cell_once_and_steps_to_a_neighbour() {
        let mut cells: Vec<_> = (0..64).flat_map(|x| (0..64).map(move |y| (hilbert_curve(x, y, 6), x, y))).collect();
        cells.sort_unstable();
        for (number, pair) in cells.windows(2).enumerate() {
            let [(d, x0, y0), (_, x1, y1)] = [pair[0], pair[1]];
            assert_eq!(d as usize, number);
            assert_eq!(x0.abs_diff(x1) + y0.abs_diff(y1), 1);
        }
    }

    #[test]
    fn a_set_integrates_the_basis_and_depends_on_its_seed_alone() {
        let order = Order::new(5).expect("valid");
        let set = DirectionSet::new(8000, order, 7);
        assert_eq!(set.directions.len(), 8000_usize.next_multiple_of(PACKET_SIZE));
        for i in 0..order.coeff_count() {
            let sum: f64 = set.basis.iter().skip(i).step_by(order.coeff_count()).map(|&y| f64::from(y)).sum();
            let expected = if i == 0 { (4.0 * std::f64::consts::PI).sqrt() } else { 0.0 };
            // Measured 2.2e-5: the error of spherical Fibonacci for smooth functions.
            let integral = sum * 4.0 * std::f64::consts::PI / set.directions.len() as f64;
            assert!((integral - expected).abs() < 1e-4, "{i}: {integral}");
        }
        assert_eq!(set.directions, DirectionSet::new(8000, order, 7).directions);
        assert_ne!(set.directions, DirectionSet::new(8000, order, 8).directions);
    }

    #[test]
    fn packets_are_narrow() {
        let set = DirectionSet::new(8192, Order::new(1).expect("valid"), 0);
        let widest = |packet: &[Vec3]| packet.iter().map(|s| s.angle_between(packet[0])).fold(0.0, f32::max);
        let mut angles: Vec<f32> = set.directions.chunks_exact(PACKET_SIZE).map(widest).collect();
        angles.sort_by(f32::total_cmp);
        // A square of 64/8192 of the sphere is 0.31 rad wide and 0.44 from corner to corner; measured 0.47. In random order it would be near π.
        assert!(angles[angles.len() / 2] < 0.5, "median {}", angles[angles.len() / 2]);
    }
}
