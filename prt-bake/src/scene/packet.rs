//! Up to 64 rays from one origin, traced together.

use glam::Vec3;

use super::beam::Beam;
use super::lanes::{BLOCKS, LANES, Lanes};

/// Directions of up to 64 rays, and the beam that encloses them.
#[derive(Debug, Clone)]
pub(crate) struct Packet {
    /// Components of the directions: `[x, y, z]` of each block.
    pub(super) direction: [[Lanes<f32>; 3]; BLOCKS],
    /// Their reciprocals, finite.
    pub(super) reciprocal: [[Lanes<f32>; 3]; BLOCKS],
    /// If all directions lie in one octant, for each axis the side of a box at which they enter.
    pub(super) entrance: Option<[usize; 3]>,
    pub(super) beam: Beam,
    count: usize,
}

/// If no more rays of a packet than this are asked for, they are traced one by one.
const SINGLE_RAYS: u32 = 3;

/// A component smaller than this is replaced before it is inverted, so that `0 · ∞` never appears in the box test.
const SMALLEST_COMPONENT: f32 = 1e-20;

impl Packet {
    pub(crate) const SIZE: usize = LANES * BLOCKS;

    /// # Panics
    /// If there are no directions or more than [`Packet::SIZE`].
    pub(crate) fn new(directions: &[Vec3]) -> Self {
        assert!((1..=Self::SIZE).contains(&directions.len()), "1 to 64 directions");
        let mut packet = Self {
            direction: [[[0.0; LANES]; 3]; BLOCKS],
            reciprocal: [[[0.0; LANES]; 3]; BLOCKS],
            entrance: common_entrance(directions),
            beam: Beam::new(directions),
            count: directions.len(),
        };
        for ray in 0..Self::SIZE {
            // Lanes without a ray repeat the last one; their answers are masked away.
            let direction = directions[ray.min(directions.len() - 1)];
            for axis in 0..3 {
                packet.direction[ray / LANES][axis][ray % LANES] = direction[axis];
                packet.reciprocal[ray / LANES][axis][ray % LANES] = finite_reciprocal(direction[axis]);
            }
        }
        packet
    }

    /// A set bit for each ray.
    pub(crate) fn all(&self) -> u64 {
        u64::MAX >> (Self::SIZE - self.count)
    }

    /// Whether `rays` of the packet are traced together faster than one by one: if they are many, and none leaves the others by much. The
    /// answers are the same.
    pub(super) fn is_worth_a_packet(&self, rays: u64) -> bool {
        self.beam.is_narrow && rays.count_ones() > SINGLE_RAYS
    }

    #[inline(always)]
    pub(super) fn direction(&self, ray: usize) -> Vec3 {
        let [x, y, z] = &self.direction[ray / LANES % BLOCKS];
        Vec3::new(x[ray % LANES], y[ray % LANES], z[ray % LANES])
    }

    #[inline(always)]
    pub(super) fn reciprocal(&self, ray: usize) -> [f32; 3] {
        let [x, y, z] = &self.reciprocal[ray / LANES % BLOCKS];
        [x[ray % LANES], y[ray % LANES], z[ray % LANES]]
    }
}

/// The side of a box at which a ray enters, by the reciprocal of its direction along an axis.
#[inline(always)]
fn entrance(reciprocal: f32) -> usize {
    usize::from(reciprocal < 0.0)
}

fn common_entrance(directions: &[Vec3]) -> Option<[usize; 3]> {
    let of = |direction: &Vec3| direction.to_array().map(|component| entrance(finite_reciprocal(component)));
    let first = of(&directions[0]);
    directions.iter().all(|direction| of(direction) == first).then_some(first)
}

#[inline(always)]
pub(super) fn finite_reciprocal(component: f32) -> f32 {
    1.0 / component.abs().max(SMALLEST_COMPONENT).copysign(component)
}
