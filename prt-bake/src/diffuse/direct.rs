//! Light that arrives straight from the environment, and where it is blocked.

use glam::Vec3;

use super::ladder::{Ladder, Rung};
use super::projection::ProjectionScratch;
use super::{HitRecord, VertexStats};
use crate::sampling::PACKET_SIZE;
use crate::scene::{Hits, Packet, Stack};
use crate::transfer::unshadowed_vector;
use crate::{Mesh, Scene};

/// All that the rays of one bake share.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DirectPass<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) scene: &'a Scene,
    pub(crate) ladder: &'a Ladder,
    pub(crate) normals: &'a [[f32; 3]],
    /// Origins of the rays, in the frame that is traced in.
    pub(crate) origins: &'a [Vec3],
}

/// Memory that a thread uses again for each vertex.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    /// What is seen along the directions of each rung of the ladder.
    pub(super) seen: Vec<Seen>,
    /// The rung that the vertex ended on.
    pub(super) last: usize,
    /// The sum, `[n²]`.
    pub(super) vector: Vec<f64>,
    /// The sum of the rungs before, `[n²]`.
    pub(super) before: Vec<f64>,
    /// Directions that no ray has answered.
    guessed: Vec<u64>,
    /// Directions that need a ray.
    unknown: Vec<u64>,
    /// Directions that a ray found occluded.
    found: Vec<u64>,
    projection: ProjectionScratch,
    stack: Stack,
    hits: Hits,
}

/// What is seen from a vertex along a set of directions.
#[derive(Debug, Default)]
pub(super) struct Seen {
    /// `Δω / π`, scaled so that the weights of all directions, `max(n·s, 0) Δω / π`, add up to 1. Then a vertex that sees nothing is
    /// black, and none receives more than there is.
    solid_angle: f64,
    /// For each packet of directions those above the horizon.
    above: Vec<u64>,
    /// For each packet of directions those above the horizon that are occluded.
    occluded: Vec<u64>,
}

impl Seen {
    /// No direction is occluded.
    pub(super) fn is_open(&self) -> bool {
        self.occluded.iter().all(|&word| word == 0)
    }

    /// All directions are occluded.
    pub(super) fn is_blocked(&self) -> bool {
        self.occluded == self.above
    }

    pub(super) fn stats(&self, rays: u32, error: f32) -> VertexStats {
        let (directions, occluded) = (bits(&self.above), bits(&self.occluded));
        VertexStats { directions, occluded, rays, error, ..VertexStats::default() }
    }
}

impl DirectPass<'_> {
    pub(crate) fn scratch(&self) -> Scratch {
        Scratch::default()
    }

    /// The shadowed transfer vector of a vertex: the unshadowed one less the occluded directions.
    pub(crate) fn shadowed_vector(&self, scratch: &mut Scratch, vertex: usize, out: &mut [f32]) -> VertexStats {
        let rung_count = self.ladder.rungs.len();
        scratch.seen.resize_with(rung_count.max(scratch.seen.len()), Seen::default);
        scratch.vector.resize(self.ladder.order.coeff_count(), 0.0);
        let stats = match self.ladder.target_error {
            Some(error) => self.refine(scratch, vertex, error),
            None => {
                let rays = self.look(scratch, vertex, 0, None);
                self.project(scratch, vertex, 0);
                scratch.last = 0;
                scratch.seen[0].stats(rays, f32::NAN)
            }
        };
        out.iter_mut().zip(&scratch.vector).for_each(|(value, &sum)| *value = sum as f32);
        stats
    }

    /// Finds which directions of a rung are occluded; with a coarser rung only where that leaves a doubt. Returns the number of rays.
    pub(super) fn look(&self, scratch: &mut Scratch, vertex: usize, rung: usize, coarser: Option<usize>) -> u32 {
        let Scratch { seen, guessed, unknown, found, stack, .. } = scratch;
        let Rung { directions, guides, neighbors, .. } = &self.ladder.rungs[rung];
        let (coarse, fine) = seen.split_at_mut(rung);
        let Seen { solid_angle, above, occluded } = &mut fine[0];
        *solid_angle = all_above_horizon(self.normals[vertex], &directions.directions, above);
        let (origin, normal) = (self.origins[vertex], Vec3::from_array(self.normals[vertex]));
        let guide = coarser.and_then(|coarser| Some((&coarse[coarser], guides[rung - coarser - 1].as_ref()?)));
        let Some((coarse, guide)) = guide else {
            return self.scene.occluded_directions(origin, normal, directions, above, stack, occluded).traced;
        };
        guide.guess([&coarse.above, &coarse.occluded], above, occluded, unknown);
        let mut rays = self.scene.occluded_directions(origin, normal, directions, unknown, stack, found).traced;
        occluded.iter_mut().zip(&*found).for_each(|(occluded, found)| *occluded |= found);
        // Outlines are followed to where the coarse directions did not see them: no guess stays beside its opposite.
        guessed.clear();
        guessed.extend(above.iter().zip(&*unknown).map(|(above, unknown)| above & !unknown));
        while neighbors.doubt([above, occluded], guessed, unknown) {
            rays += self.scene.occluded_directions(origin, normal, directions, unknown, stack, found).traced;
            for (((occluded, guessed), unknown), found) in
                occluded.iter_mut().zip(&mut *guessed).zip(&*unknown).zip(&*found)
            {
                *occluded = *occluded & !unknown | found;
                *guessed &= !unknown;
            }
        }
        rays
    }

    /// Leaves the transfer vector of what is seen on a rung in `scratch.vector`. Exact if all or nothing is occluded.
    pub(super) fn project(&self, scratch: &mut Scratch, vertex: usize, rung: usize) {
        let Scratch { seen, vector, projection, .. } = scratch;
        let Seen { solid_angle, occluded, .. } = &seen[rung];
        if seen[rung].is_blocked() {
            return vector.fill(0.0);
        }
        unshadowed_vector(self.ladder.order, self.normals[vertex], vector);
        let Rung { directions, projection: basis, .. } = &self.ladder.rungs[rung];
        let normal = Vec3::from_array(self.normals[vertex]);
        basis.add(projection, &directions.directions, normal, occluded, -solid_angle, vector);
    }

    /// The nearest hits along the directions that `shadowed_vector` has just found occluded, of the last set of directions that it used;
    /// returns the number of rays. Hits on the back of a face are left out: they reflect nothing.
    pub(crate) fn nearest_hits(&self, scratch: &mut Scratch, vertex: usize, records: &mut Vec<HitRecord>) -> u32 {
        let normal = Vec3::from_array(self.normals[vertex]);
        let Scratch { seen, last, hits, stack, .. } = scratch;
        let Seen { solid_angle, occluded, .. } = &seen[*last];
        let directions = &self.ladder.rungs[*last].directions;
        let mut rays = 0;
        for ((number, packet), &occluded) in directions.packets.iter().enumerate().zip(occluded) {
            if occluded == 0 {
                continue;
            }
            rays += occluded.count_ones();
            self.scene.closest_packet(self.origins[vertex], packet, occluded, hits, stack);
            for lane in set_bits(&[occluded]) {
                let cosine = normal.dot(directions.directions[number * Packet::SIZE + lane]).max(0.0);
                let weight = solid_angle * f64::from(cosine);
                let hit = self.scene.hit(hits, lane).filter(|hit| hit.is_front);
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

/// Finds the directions above the plane with this normal; returns `1 / Σ max(n·s, 0)`.
fn all_above_horizon(normal: [f32; 3], directions: &[Vec3], above: &mut Vec<u64>) -> f64 {
    above.clear();
    let mut cosines = 0.0;
    for directions in directions.chunks(PACKET_SIZE) {
        let (packet_above, cosine_sum) = above_horizon(Vec3::from_array(normal), directions);
        cosines += f64::from(cosine_sum);
        above.push(packet_above);
    }
    1.0 / cosines
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
