//! Sets of directions from coarse to fine.

use sh_core::Order;

use super::guide::Guide;
use super::projection::Projection;
use crate::BakeOptions;
use crate::sampling::{DirectionSet, PACKET_SIZE};

/// All tables of basis functions of one bake together take no more than this.
const TABLE_BYTES: usize = 32 << 20;

/// The coarsest set has this many directions over the hemisphere times the inverse of the target error, at least.
const COARSEST: f64 = 0.5;

/// The seeds of two sets differ by this: the multiplier of Knuth's MMIX generator, so that no small seed meets another one's.
const SEED_STEP: u64 = 0x5851_f42d_4c95_7f2d;

/// Fewest directions over the hemisphere: a packet over the sphere.
const FEWEST: usize = 32;

/// Sets of directions, each with twice as many as the one before, each rotated on its own; the last has as many as a vertex may use. A
/// bake with the same rays for all vertices has one.
#[derive(Debug)]
pub(crate) struct Ladder {
    pub(crate) order: Order,
    pub(crate) target_error: Option<f64>,
    /// The rung that vertices begin with.
    pub(crate) first: usize,
    /// Coarse to fine.
    pub(crate) rungs: Vec<Rung>,
}

/// One set of directions.
#[derive(Debug)]
pub(crate) struct Rung {
    pub(crate) directions: DirectionSet,
    pub(crate) projection: Projection,
    /// From the set before, and from the one before that.
    pub(crate) guides: [Option<Guide>; 2],
    /// From the set to itself.
    pub(crate) neighbors: Guide,
}

impl Ladder {
    pub(crate) fn new(options: &BakeOptions) -> Self {
        Self::with_tables(options, TABLE_BYTES)
    }

    /// As [`new`](Self::new), with another limit for the tables. The limit decides nothing but the time.
    pub(super) fn with_tables(options: &BakeOptions, table_bytes: usize) -> Self {
        let sizes = set_sizes(options);
        let mut ladder = Self { order: options.order, target_error: options.target_error, first: 0, rungs: Vec::new() };
        let mut room = table_bytes;
        for (number, &size) in sizes.iter().enumerate() {
            // A set is the same whatever the coarsest one is.
            let below_finest = (sizes.len() - 1 - number) as u64;
            let seed = options.seed.wrapping_add(below_finest.wrapping_mul(SEED_STEP));
            let bytes = Projection::table_bytes(options.order, size);
            ladder.add_rung(size, seed, bytes <= room);
            room = room.checked_sub(bytes).unwrap_or(room);
        }
        ladder
    }

    fn add_rung(&mut self, size: usize, seed: u64, has_tables: bool) {
        // The basis of the set itself is not used: a set of order 1 holds little of it.
        let directions = DirectionSet::new(size, Order::new(1).expect("1 is an order"), seed);
        let projection = Projection::new(self.order, &directions.directions, has_tables);
        let guides = [1, 2].map(|back| {
            let coarse = &self.rungs[self.rungs.len().checked_sub(back)?].directions;
            Some(Guide::new(&coarse.directions, &directions.directions))
        });
        let neighbors = Guide::new(&directions.directions, &directions.directions);
        self.rungs.push(Rung { directions, projection, guides, neighbors });
    }

    /// Lets vertices begin where they would with this target error; the ladder must have been made for a larger one.
    pub(super) fn aim(&mut self, options: &BakeOptions) {
        self.target_error = options.target_error;
        self.first = self.rungs.len().saturating_sub(counts(options).len());
    }
}

/// Directions over the sphere of each set.
pub(super) fn set_sizes(options: &BakeOptions) -> Vec<usize> {
    counts(options).into_iter().map(|count| (2 * count).next_multiple_of(PACKET_SIZE)).collect()
}

/// Directions over the hemisphere of each set. At least three, so that a step can be skipped.
fn counts(options: &BakeOptions) -> Vec<usize> {
    let most = options.rays_per_vertex;
    let Some(error) = options.target_error else { return vec![most] };
    let coarsest = ((COARSEST / error) as usize).max(FEWEST);
    let halves = |number: u32| most.checked_shr(number).unwrap_or(0).max(FEWEST);
    let below = (1..).take_while(|&number| number < 3 || most >> number.min(usize::BITS - 1) >= coarsest).map(halves);
    let mut counts: Vec<usize> = std::iter::once(most).chain(below).collect();
    counts.reverse();
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options(order: usize, rays_per_vertex: usize, target_error: Option<f64>) -> BakeOptions {
        let order = Order::new(order).expect("valid");
        BakeOptions { order, rays_per_vertex, target_error, ..BakeOptions::default() }
    }

    #[test]
    fn sets_double_from_half_the_inverse_error_to_the_rays_of_a_vertex() {
        assert_eq!(counts(&options(1, 4096, Some(0.002))), [256, 512, 1024, 2048, 4096]);
        assert_eq!(counts(&options(1, 4096, Some(1.0))), [32, 64, 128, 256, 512, 1024, 2048, 4096]);
        assert_eq!(counts(&options(1, 4096, Some(1e-9))), [1024, 2048, 4096]);
        assert_eq!(counts(&options(1, 1, Some(0.1))), [32, 32, 1]);
        assert_eq!(counts(&options(1, 4096, None)), [4096]);
        assert_eq!(set_sizes(&options(1, 100, Some(0.1))), [64, 128, 256]);
    }

    #[test]
    fn tables_stay_within_their_room() {
        for (order, rays) in [(6, 4096), (6, 1 << 16), (32, 1 << 15)] {
            let ladder = Ladder::new(&options(order, rays, Some(0.001)));
            let bytes: usize = ladder.rungs.iter().map(|rung| rung.projection.bytes()).sum();
            assert!(bytes <= TABLE_BYTES && bytes > TABLE_BYTES / 32, "order {order}, {rays} rays: {bytes}");
        }
    }

    #[test]
    fn a_ladder_begins_where_its_error_says_and_its_sets_are_the_same() {
        let fine = Ladder::new(&options(1, 4096, Some(0.002)));
        let mut all = Ladder::new(&options(1, 4096, Some(1.0)));
        all.aim(&options(1, 4096, Some(0.002)));
        assert_eq!((all.first, fine.first), (3, 0));
        for (rung, same) in fine.rungs.iter().zip(&all.rungs[3..]) {
            assert_eq!(rung.directions.directions, same.directions.directions);
        }
        // The finest is the set of a bake with a fixed count.
        let fixed = Ladder::new(&options(1, 4096, None));
        assert_eq!(fixed.rungs[0].directions.directions, fine.rungs[4].directions.directions);
    }
}
