//! All directions of a point at once.

use glam::Vec3;

use super::{Answered, Hit, Hits, Scene, Stack};
use crate::sampling::{DirectionSet, PACKET_SIZE};

/// Answers for one point after another which directions of a set are occluded, and by what. Keeps memory to be used again: one for
/// each thread.
///
/// Points are in the frame of [`Scene::to_unit_cube`]. Directions are given as bits, one word for each 64 consecutive directions of
/// the set.
#[derive(Debug, Clone)]
pub struct DirectionTracer<'a> {
    scene: &'a Scene,
    directions: &'a DirectionSet,
    stack: Stack,
    hits: Hits,
    occluded: Vec<u64>,
}

impl<'a> DirectionTracer<'a> {
    /// For the directions of a set in a scene.
    #[must_use]
    pub fn new(scene: &'a Scene, directions: &'a DirectionSet) -> Self {
        Self { scene, directions, stack: Stack::default(), hits: Hits::default(), occluded: Vec::new() }
    }

    /// Which of the directions `above` meet anything. Whole bins of directions are answered together where that can be proven; the
    /// answers are the same as ray by ray (but for the tips of needles, which rounding widens).
    ///
    /// - `normal`: no direction of `above` has a negative product with it; zero if there is no such vector
    ///
    /// # Panics
    /// If `above` has not one word for each 64 directions.
    pub fn occluded(&mut self, origin: Vec3, normal: Vec3, above: &[u64]) -> (&[u64], Answered) {
        assert_eq!(above.len(), self.directions.packets.len(), "one word for each packet");
        let (scene, directions) = (self.scene, self.directions);
        let answered =
            scene.occluded_directions(origin, normal, directions, above, &mut self.stack, &mut self.occluded);
        (&self.occluded, answered)
    }

    /// The same, with every ray traced.
    ///
    /// # Panics
    /// If `above` has not one word for each 64 directions.
    pub fn occluded_ray_by_ray(&mut self, origin: Vec3, above: &[u64]) -> &[u64] {
        assert_eq!(above.len(), self.directions.packets.len(), "one word for each packet");
        self.occluded.clear();
        for (packet, &rays) in self.directions.packets.iter().zip(above) {
            let occluded =
                if rays == 0 { 0 } else { self.scene.occluded_packet(origin, packet, rays, &mut self.stack) };
            self.occluded.push(occluded);
        }
        &self.occluded
    }

    /// The nearest hit of each of the `rays`: calls `found` with the number of the direction.
    ///
    /// # Panics
    /// If `rays` has not one word for each 64 directions.
    pub fn closest(&mut self, origin: Vec3, rays: &[u64], mut found: impl FnMut(usize, Option<Hit>)) {
        assert_eq!(rays.len(), self.directions.packets.len(), "one word for each packet");
        for (number, (packet, &rays)) in self.directions.packets.iter().zip(rays).enumerate() {
            if rays == 0 {
                continue;
            }
            self.scene.closest_packet(origin, packet, rays, &mut self.hits, &mut self.stack);
            for lane in (0..PACKET_SIZE).filter(|lane| rays >> lane & 1 == 1) {
                found(number * PACKET_SIZE + lane, self.scene.hit(&self.hits, lane));
            }
        }
    }

    /// The nearest hit of a single ray.
    #[must_use]
    pub fn closest_of_ray(&mut self, origin: Vec3, direction: Vec3) -> Option<Hit> {
        self.scene.closest_ray(origin, direction, &mut self.stack)
    }
}
