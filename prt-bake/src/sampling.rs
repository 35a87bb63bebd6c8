//! Directions to trace: one set for the whole bake, sorted so that neighbours in the list are neighbours on the sphere.

mod bisection;

use glam::{DQuat, DVec3, Vec3};
use sh_core::Order;

use crate::scene::{Bins, Packet};

/// Number of directions that are traced together.
pub(crate) const PACKET_SIZE: usize = Packet::SIZE;

/// Directions evenly spread over the sphere, each with the same weight, and the basis functions there.
///
/// A spherical Fibonacci set, rotated by a random rotation drawn from the seed and sorted by bisection of the sphere. One set serves every
/// vertex: basis functions are tabulated once, and consecutive directions make coherent packets.
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
        bisection::sort(&mut directions);
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

#[cfg(test)]
mod tests {
    use super::*;

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
