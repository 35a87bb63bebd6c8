//! The order of directions: neighbours in the list are neighbours on the sphere.
//!
//! The sphere is cut along x, y and z, and each part on and on across its longer side. Parts of 64 directions, of 4 times and of 16
//! times as many are compact. In the order of a Hilbert curve over the octahedral map, which is stretched, they are less so: tracing
//! takes 11 to 17 % longer.

use glam::Vec3;

use super::PACKET_SIZE;
use crate::scene::Rectangle;

/// Parts with no more directions are not halved.
const SMALLEST: usize = 8;

/// The shape of a part is told by no more directions than about this.
const SAMPLES: usize = 64;

/// A part that reaches farther from its middle than the angle with this cosine is not seen as a plane figure. An octant reaches to 0.577.
const WIDEST_COSINE: f32 = 0.5;

/// Sorts directions of unit length.
pub(super) fn sort(directions: &mut [Vec3]) {
    if directions.len() <= SMALLEST {
        return;
    }
    let step = directions.len().div_ceil(SAMPLES);
    let samples: Vec<Vec3> = directions.iter().step_by(step).copied().collect();
    let middle = samples.iter().sum::<Vec3>().normalize_or_zero();
    let first = first_half(directions.len());
    if samples.iter().all(|sample| sample.dot(middle) > WIDEST_COSINE) {
        let axis = Rectangle::around(&samples, middle).long_axis();
        let slope = |direction: &Vec3| direction.dot(axis) / direction.dot(middle);
        directions.select_nth_unstable_by(first, |a, b| slope(a).total_cmp(&slope(b)));
    } else {
        let axis = longest_extent(directions);
        directions.select_nth_unstable_by(first, |a, b| a[axis].total_cmp(&b[axis]));
    }
    let (a, b) = directions.split_at_mut(first);
    sort(a);
    sort(b);
}

/// The coordinate that differs most.
fn longest_extent(directions: &[Vec3]) -> usize {
    let lower = directions.iter().copied().fold(Vec3::INFINITY, Vec3::min);
    let upper = directions.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
    (upper - lower).max_position()
}

/// How many directions of `count` belong to the first half: a power of two of packets, so that bins, which are groups of 4, 16 … packets,
/// are parts too.
fn first_half(count: usize) -> usize {
    let packets = count / PACKET_SIZE;
    if packets > 1 { packets.next_power_of_two() / 2 * PACKET_SIZE } else { count / 2 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sorted(count: usize) -> Vec<Vec3> {
        let mut directions: Vec<Vec3> =
            sh_core::fibonacci(count).into_iter().map(|s| Vec3::from_array(s.map(|x| x as f32)).normalize()).collect();
        sort(&mut directions);
        directions
    }

    #[test]
    fn every_direction_stays() {
        for count in [64, 1792, 5440] {
            let key = |s: &Vec3| s.to_array().map(f32::to_bits);
            let mut found: Vec<_> = sorted(count).iter().map(key).collect();
            let mut given: Vec<_> = sh_core::fibonacci(count)
                .into_iter()
                .map(|s| key(&Vec3::from_array(s.map(|x| x as f32)).normalize()))
                .collect();
            found.sort_unstable();
            given.sort_unstable();
            assert_eq!(found, given, "{count}");
        }
    }

    #[test]
    fn parts_of_any_size_are_compact() {
        // A round part that is a share p of the sphere has a radius r with sin²(r/2) = p. The corners of a square are 1.25 r from its middle, those
        // of an octant 1.3 r, of rectangles of 2:1 and 3:1 1.4 and 1.6 r. Measured: half an octant 1.74, other sizes up to 1.5 in the mean.
        for count in [8192, 5440, 4160] {
            let directions = sorted(count);
            for size in [8, 16, 32, 64, 128, 256, 512, 1024] {
                let radius = 2.0 * (size as f32 / count as f32).sqrt().asin();
                let ratios: Vec<f32> = directions
                    .chunks_exact(size)
                    .map(|part| {
                        let middle = part.iter().sum::<Vec3>().normalize();
                        part.iter().map(|s| s.angle_between(middle)).fold(0.0, f32::max) / radius
                    })
                    .collect();
                let average = ratios.iter().sum::<f32>() / ratios.len() as f32;
                let largest = ratios.iter().copied().fold(0.0, f32::max);
                assert!(largest < 2.0 && average < 1.8, "{count} {size}: mean {average}, largest {largest}");
            }
        }
    }
}
