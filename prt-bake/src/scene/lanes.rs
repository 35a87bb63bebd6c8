//! Numbers that are worked on together.
//!
//! All loops over lanes do the same operations in the same order whatever the instruction set, and multiplications and additions are
//! never contracted, so that every machine finds the same hits. They are plain loops: closures inside iterators may be left out
//! of line, and then miss the instruction set that their caller is compiled for. A loop over triangles does all for one of them: many
//! short loops are unrolled and then put together again in odd ways. AVX2 is the most that is asked for: with AVX-512 the compiler (1.95)
//! makes code that takes twice as long.

/// Rays of a block.
pub(super) const LANES: usize = 16;

/// Blocks of a packet.
pub(super) const BLOCKS: usize = 4;

/// One number for each ray of a block.
pub(super) type Lanes<T> = [T; LANES];

/// Children of a node, and triangles of a leaf.
pub(super) const WIDTH: usize = 8;

/// One number for each child of a node or triangle of a leaf.
pub(super) type Wide<T> = [T; WIDTH];

// `f32::min` and `max` treat NaN specially and cost more; no NaN reaches these.
#[inline(always)]
pub(super) fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
pub(super) fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// All bits set, or none.
#[inline(always)]
pub(super) fn mask(condition: bool) -> u32 {
    0_u32.wrapping_sub(u32::from(condition))
}

#[inline(always)]
pub(super) fn any<const N: usize>(lanes: &[u32; N]) -> bool {
    let mut any = 0;
    for lane in lanes {
        any |= lane;
    }
    any != 0
}

/// Whether any ray is marked.
#[inline(always)]
pub(super) fn any_ray(masks: &[Lanes<u32>; BLOCKS]) -> bool {
    let mut any = [0; LANES];
    for lane in 0..LANES {
        any[lane] = masks[0][lane] | masks[1][lane] | masks[2][lane] | masks[3][lane];
    }
    self::any(&any)
}

/// A bit for each child or triangle whose mask is set.
#[inline(always)]
pub(super) fn wide_bits(lanes: &Wide<u32>) -> u32 {
    const BIT: Wide<u32> = [1, 2, 4, 8, 16, 32, 64, 128];
    let mut bits = 0;
    for lane in 0..WIDTH {
        bits |= lanes[lane] & BIT[lane];
    }
    bits
}

/// A bit for each ray whose mask is set.
#[inline(always)]
pub(super) fn ray_bits(masks: &[Lanes<u32>; BLOCKS]) -> u64 {
    let (mut low, mut high) = ([0; LANES], [0; LANES]);
    for lane in 0..LANES {
        let bit = 1_u32 << lane;
        low[lane] = masks[0][lane] & bit | masks[1][lane] & bit << LANES;
        high[lane] = masks[2][lane] & bit | masks[3][lane] & bit << LANES;
    }
    u64::from(union(low)) | u64::from(union(high)) << (2 * LANES)
}

/// The bits that are set in any lane.
#[inline(always)]
fn union(mut lanes: Lanes<u32>) -> u32 {
    for half in [8, 4, 2, 1] {
        for lane in 0..half {
            lanes[lane] |= lanes[lane + half];
        }
    }
    lanes[0]
}

/// The bits of the rays of a block.
#[inline(always)]
pub(super) fn block_bits(rays: u64, block: usize) -> u32 {
    (rays >> (block * LANES)) as u32 & ((1 << LANES) - 1)
}

/// Takes the lowest bit that is set; returns its number.
#[inline(always)]
pub(super) fn take_bit(bits: &mut u64) -> usize {
    let bit = bits.trailing_zeros() as usize;
    *bits &= *bits - 1;
    bit
}
