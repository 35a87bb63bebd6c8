//! Light that arrives straight from the environment, and where it is blocked.

use glam::Vec3;

use super::{HitRecord, VertexStats};
use crate::sampling::{DirectionSet, PACKET_SIZE};
use crate::scene::{Hits, Packet, Stack};
use crate::transfer::unshadowed_vector;
use crate::{Mesh, Scene};

/// All that the rays of one bake share.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DirectPass<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) scene: &'a Scene,
    pub(crate) directions: &'a DirectionSet,
    pub(crate) normals: &'a [[f32; 3]],
    /// Origins of the rays, in the frame that is traced in.
    pub(crate) origins: &'a [Vec3],
}

/// Memory that a thread uses again for each vertex.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    /// `Δω / π`, scaled so that the weights of all rays of the vertex, `max(n·s, 0) Δω / π`, add up to 1. Then a vertex that sees
    /// nothing is black, and none receives more than there is.
    solid_angle: f64,
    /// The sum, `[n²]`.
    vector: Vec<f64>,
    /// For each packet of directions the rays above the horizon.
    above: Vec<u64>,
    /// For each packet of directions the rays above the horizon that were found to be occluded.
    occluded: Vec<u64>,
    stack: Stack,
    hits: Hits,
}

impl DirectPass<'_> {
    pub(crate) fn scratch(&self) -> Scratch {
        let coeff_count = self.directions.basis.len() / self.directions.directions.len();
        Scratch { vector: vec![0.0; coeff_count], ..Scratch::default() }
    }

    /// The shadowed transfer vector of a vertex: the unshadowed one less the occluded directions.
    pub(crate) fn shadowed_vector(&self, scratch: &mut Scratch, vertex: usize, out: &mut [f32]) -> VertexStats {
        let normal = Vec3::from_array(self.normals[vertex]);
        let stats = self.trace(scratch, vertex);
        if stats.occluded == stats.directions {
            // Black, and not the error of the quadrature.
            out.fill(0.0);
            return stats;
        }
        let order = self.directions.order;
        unshadowed_vector(order, self.normals[vertex], &mut scratch.vector);
        for ray in set_bits(&scratch.occluded) {
            let row = &self.directions.basis[ray * order.coeff_count()..][..order.coeff_count()];
            add_scaled(&mut scratch.vector, row, -scratch.solid_angle * self.cosine(normal, ray));
        }
        out.iter_mut().zip(&scratch.vector).for_each(|(value, &sum)| *value = sum as f32);
        stats
    }

    fn cosine(&self, normal: Vec3, ray: usize) -> f64 {
        f64::from(normal.dot(self.directions.directions[ray]).max(0.0))
    }

    /// Finds the occluded directions above the horizon of a vertex.
    fn trace(&self, scratch: &mut Scratch, vertex: usize) -> VertexStats {
        let normal = Vec3::from_array(self.normals[vertex]);
        scratch.above.clear();
        let mut cosines = 0.0;
        for directions in self.directions.directions.chunks(PACKET_SIZE) {
            let (above, cosine_sum) = above_horizon(normal, directions);
            cosines += f64::from(cosine_sum);
            scratch.above.push(above);
        }
        scratch.solid_angle = 1.0 / cosines;
        let (origin, above) = (self.origins[vertex], &scratch.above);
        let rays =
            self.scene.occluded_directions(origin, self.directions, above, &mut scratch.stack, &mut scratch.occluded);
        VertexStats { directions: bits(above), occluded: bits(&scratch.occluded), rays, ..VertexStats::default() }
    }

    /// The nearest hits along the directions that `shadowed_vector` has just found occluded; returns the number of rays. Hits on the
    /// back of a face are left out: they reflect nothing.
    pub(crate) fn nearest_hits(&self, scratch: &mut Scratch, vertex: usize, records: &mut Vec<HitRecord>) -> u32 {
        let normal = Vec3::from_array(self.normals[vertex]);
        let mut rays = 0;
        for (number, packet) in self.directions.packets.iter().enumerate() {
            let occluded = scratch.occluded[number];
            if occluded == 0 {
                continue;
            }
            rays += occluded.count_ones();
            self.scene.closest_packet(self.origins[vertex], packet, occluded, &mut scratch.hits, &mut scratch.stack);
            for lane in set_bits(&[occluded]) {
                let weight = scratch.solid_angle * self.cosine(normal, number * Packet::SIZE + lane);
                let hit = self.scene.hit(&scratch.hits, lane).filter(|hit| hit.is_front);
                records.extend(hit.map(|hit| {
                    let albedo = self.mesh.albedo_at(hit.triangle as usize, hit.barycentric);
                    HitRecord::new(hit.triangle, hit.barycentric, weight as f32, albedo)
                }));
            }
        }
        records.shrink_to_fit();
        rays
    }
}

/// A set bit for each direction above the plane with this normal, and the sum of their cosines.
#[multiversion::multiversion(targets("x86_64+avx+avx2"))]
fn above_horizon(normal: Vec3, directions: &[Vec3]) -> (u64, f32) {
    let (mut above, mut sum) = (0, 0.0);
    for (lane, direction) in directions.iter().enumerate() {
        let cosine = normal.dot(*direction);
        above |= u64::from(cosine > 0.0) << lane;
        sum += cosine.max(0.0);
    }
    (above, sum)
}

/// How many bits are set.
fn bits(words: &[u64]) -> u32 {
    words.iter().map(|word| word.count_ones()).sum()
}

/// The numbers of the bits that are set.
fn set_bits(words: &[u64]) -> impl Iterator<Item = usize> + '_ {
    words.iter().enumerate().flat_map(|(number, &word)| {
        let mut rest = word;
        std::iter::from_fn(move || {
            let bit = (rest != 0).then(|| rest.trailing_zeros() as usize)?;
            rest &= rest - 1;
            Some(number * PACKET_SIZE + bit)
        })
    })
}

/// `sum += factor * row`.
#[multiversion::multiversion(targets("x86_64+avx+avx2"))]
pub(crate) fn add_scaled(sum: &mut [f64], row: &[f32], factor: f64) {
    for (sum, &value) in sum.iter_mut().zip(row) {
        *sum += factor * f64::from(value);
    }
}
