//! The sum of the basis functions over occluded directions.

use glam::Vec3;
use sh_core::{Basis, Order};

use crate::sampling::PACKET_SIZE;

/// Adds up `max(n·s, 0) y(s)` over some of the directions of a set, packet by packet.
///
/// Where more than half of a packet is occluded it is cheaper to add the whole packet and take away the rest: because `n·s` is linear in
/// the normal, the sum over a packet is `Σ_k n_k Σ_s s_k y(s)`, three rows that are known beforehand. A packet is added up in `f32`, and
/// packets in `f64`: `the_sum_is_that_of_single_directions` bounds the rounding.
///
/// Basis functions are in tables where there is room, and evaluated when they are needed where not; the sums have the same bytes.
#[derive(Debug)]
pub(crate) struct Projection {
    basis: Basis<f32>,
    tables: Option<Tables>,
}

#[derive(Debug)]
struct Tables {
    /// `[D, n²]`
    rows: Vec<f32>,
    /// `[D / 64, 3, n²]`
    moments: Vec<f32>,
}

/// Memory that is used again for each packet.
#[derive(Debug, Default)]
pub(crate) struct ProjectionScratch {
    rows: Vec<f32>,
    moments: Vec<f32>,
    sum: Vec<f32>,
    lanes: Vec<(usize, f32)>,
}

impl Projection {
    /// Bytes that the tables of a set take.
    pub(crate) fn table_bytes(order: Order, direction_count: usize) -> usize {
        size_of::<f32>() * order.coeff_count() * (direction_count + 3 * direction_count.div_ceil(PACKET_SIZE))
    }

    pub(crate) fn new(order: Order, directions: &[Vec3], has_tables: bool) -> Self {
        let basis = Basis::new(order);
        let tables = has_tables.then(|| Tables::new(&basis, directions));
        Self { basis, tables }
    }

    /// Bytes that its tables take.
    #[cfg(test)]
    pub(super) fn bytes(&self) -> usize {
        self.tables.as_ref().map_or(0, |tables| size_of_val(&*tables.rows) + size_of_val(&*tables.moments))
    }

    /// `sum += factor Σ (n·s) y(s)` over the directions whose bit is set in `occluded`, all of them above the horizon.
    pub(crate) fn add(
        &self,
        scratch: &mut ProjectionScratch,
        directions: &[Vec3],
        normal: Vec3,
        occluded: &[u64],
        factor: f64,
        sum: &mut [f64],
    ) {
        for (packet, (directions, &occluded)) in directions.chunks(PACKET_SIZE).zip(occluded).enumerate() {
            if occluded != 0 {
                self.add_packet(scratch, packet, directions, normal, occluded);
                sum.iter_mut().zip(&scratch.sum).for_each(|(sum, &value)| *sum += factor * f64::from(value));
            }
        }
    }

    /// Leaves the sum over a packet in `scratch.sum`.
    fn add_packet(
        &self,
        scratch: &mut ProjectionScratch,
        packet: usize,
        directions: &[Vec3],
        normal: Vec3,
        occluded: u64,
    ) {
        let ProjectionScratch { rows, moments, sum, lanes } = scratch;
        let is_mostly_occluded = occluded.count_ones() as usize > directions.len() / 2;
        let selected = if is_mostly_occluded { !occluded } else { occluded };
        let sign = if is_mostly_occluded { -1.0 } else { 1.0 };
        let is_selected = |lane: &usize| selected >> lane & 1 == 1;
        lanes.clear();
        lanes.extend((0..directions.len()).filter(is_selected).map(|lane| (lane, sign * normal.dot(directions[lane]))));
        let (rows, moments) = match &self.tables {
            Some(tables) => tables.packet(packet, directions.len(), self.basis.order()),
            None => {
                evaluate(&self.basis, directions, rows);
                if is_mostly_occluded {
                    moments.resize(3 * self.basis.order().coeff_count(), 0.0);
                    packet_moments(directions, rows, moments);
                }
                (&**rows, &**moments)
            }
        };
        sum.clear();
        sum.resize(self.basis.order().coeff_count(), 0.0);
        if is_mostly_occluded {
            add_rows(sum, moments, &[(0, normal.x), (1, normal.y), (2, normal.z)]);
        }
        add_rows(sum, rows, lanes);
    }
}

impl Tables {
    fn new(basis: &Basis<f32>, directions: &[Vec3]) -> Self {
        let length = basis.order().coeff_count();
        let mut rows = Vec::new();
        evaluate(basis, directions, &mut rows);
        let mut moments = vec![0.0; 3 * length * directions.len().div_ceil(PACKET_SIZE)];
        let packets = directions.chunks(PACKET_SIZE).zip(rows.chunks(PACKET_SIZE * length));
        for ((directions, rows), moments) in packets.zip(moments.chunks_exact_mut(3 * length)) {
            packet_moments(directions, rows, moments);
        }
        Self { rows, moments }
    }

    fn packet(&self, packet: usize, size: usize, order: Order) -> (&[f32], &[f32]) {
        let length = order.coeff_count();
        (
            &self.rows[packet * PACKET_SIZE * length..][..size * length],
            &self.moments[packet * 3 * length..][..3 * length],
        )
    }
}

fn evaluate(basis: &Basis<f32>, directions: &[Vec3], rows: &mut Vec<f32>) {
    rows.resize(directions.len() * basis.order().coeff_count(), 0.0);
    // Some at a time, so that no second array of the size of the result is needed.
    for (directions, rows) in
        directions.chunks(PACKET_SIZE).zip(rows.chunks_mut(PACKET_SIZE * basis.order().coeff_count()))
    {
        let mut components = [[0.0; 3]; PACKET_SIZE];
        components.iter_mut().zip(directions).for_each(|(out, direction)| *out = direction.to_array());
        basis.eval_batch(&components[..directions.len()], rows);
    }
}

/// `Σ_s s_k y(s)` for k = x, y, z; `moments[3, n²]` is overwritten.
fn packet_moments(directions: &[Vec3], rows: &[f32], moments: &mut [f32]) {
    let length = moments.len() / 3;
    for (k, moments) in moments.chunks_exact_mut(length).enumerate() {
        for (i, moment) in moments.iter_mut().enumerate() {
            let terms =
                directions.iter().enumerate().map(|(lane, s)| f64::from(s[k]) * f64::from(rows[lane * length + i]));
            *moment = terms.sum::<f64>() as f32;
        }
    }
}

/// Coefficients that are summed in registers.
const BLOCK: usize = 8;

/// `sum += Σ factor_k row_k`, in the order of the rows for every coefficient.
#[multiversion::multiversion(targets("x86_64+avx+avx2"))]
fn add_rows(sum: &mut [f32], rows: &[f32], lanes: &[(usize, f32)]) {
    let length = sum.len();
    let whole = length - length % BLOCK;
    let mut start = 0;
    while start < whole {
        let mut block = [0.0_f32; BLOCK];
        block.copy_from_slice(&sum[start..start + BLOCK]);
        for &(lane, factor) in lanes {
            let row: &[f32] = &rows[lane * length + start..][..BLOCK];
            for i in 0..BLOCK {
                block[i] += factor * row[i];
            }
        }
        sum[start..start + BLOCK].copy_from_slice(&block);
        start += BLOCK;
    }
    for &(lane, factor) in lanes {
        for i in whole..length {
            sum[i] += factor * rows[lane * length + i];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{DirectionSet, Random};

    #[test]
    fn the_sum_is_that_of_single_directions() {
        let normal = Vec3::new(0.48, -0.6, 0.64);
        for n in [1, 2, 5, 6, 32] {
            let order = Order::new(n).expect("valid");
            let directions = DirectionSet::new(512, Order::new(1).expect("valid"), 3).directions;
            let tabulated = Projection::new(order, &directions, true);
            let evaluated = Projection::new(order, &directions, false);
            let mut random = Random::new(n as u64);
            // None, few, half, most and all of those above the horizon.
            for share in [0.0, 0.1, 0.5, 0.9, 1.0] {
                let is_occluded: Vec<bool> =
                    directions.iter().map(|s| s.dot(normal) > 0.0 && random.unit() < share).collect();
                let word = |lanes: &[bool]| (0..lanes.len()).fold(0, |word, k| word | u64::from(lanes[k]) << k);
                let words: Vec<u64> = is_occluded.chunks(PACKET_SIZE).map(word).collect();
                let sum = |projection: &Projection| {
                    let mut sum = vec![1.0; order.coeff_count()];
                    projection.add(&mut ProjectionScratch::default(), &directions, normal, &words, -0.01, &mut sum);
                    sum
                };
                let (found, mut plain) = (sum(&tabulated), vec![1.0; order.coeff_count()]);
                let mut row = vec![0.0; order.coeff_count()];
                for (s, _) in directions.iter().zip(&is_occluded).filter(|(_, is_occluded)| **is_occluded) {
                    sh_core::eval(order, s.as_dvec3().to_array(), &mut row);
                    let cosine = f64::from(normal.dot(*s));
                    plain.iter_mut().zip(&row).for_each(|(sum, &y)| *sum -= 0.01 * cosine * y);
                }
                // Sums of 64 in `f32`: 8 packets of 64 terms of up to 9 err by less than 64 · 9 · 6e-8 · 0.01 each.
                let worst = found.iter().zip(&plain).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(worst < 2e-6, "order {n}, share {share}: {worst}");
                assert_eq!(found, sum(&evaluated), "order {n}, share {share}");
            }
        }
    }
}
