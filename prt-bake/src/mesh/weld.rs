//! Which vertices stand at the same position.

use std::collections::HashMap;

/// For each vertex the number of the first one at exactly the same position (`-0` equals `0`).
pub(crate) fn weld_positions(positions: &[[f64; 3]]) -> Vec<u32> {
    let mut first_at = HashMap::with_capacity(positions.len());
    let numbers = 0..u32::MAX;
    positions.iter().zip(numbers).map(|(position, number)| *first_at.entry(key(position)).or_insert(number)).collect()
}

fn key(position: &[f64; 3]) -> [u64; 3] {
    position.map(|coordinate| (coordinate + 0.0).to_bits())
}
