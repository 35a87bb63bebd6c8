//! Products of ratios that come from above.

use super::lobe_factor;
use crate::Real;

/// Ratios that are kept at a time, so that nothing is allocated.
const BLOCK: usize = 64;

/// Writes `scale · A_l / lobe_factor(l)` with `A_0 = 1`, `A_l = r_l A_(l−1)`, where each ratio follows from the one above it.
///
/// - `lead`: how many bands above a wanted one the recurrence starts, so that its start is forgotten
/// - `start`: the state there, `step(l, state) = (state, r_l)` from the state of `l + 1`
pub(super) fn write_from_above<T: Real>(
    lead: usize,
    start: f64,
    step: impl Fn(f64, f64) -> (f64, f64),
    scale: f64,
    zonal: &mut [T],
) {
    let mut mean = scale;
    for (block, first) in zonal.chunks_mut(BLOCK).zip((0..).step_by(BLOCK)) {
        let mut ratios = [1.0; BLOCK];
        let mut state = start;
        for l in (first.max(1)..first + block.len() + lead).rev() {
            let (new_state, ratio) = step(l as f64, state);
            state = new_state;
            if let Some(kept) = ratios[..block.len()].get_mut(l - first) {
                *kept = ratio;
            }
        }
        for ((g, ratio), l) in block.iter_mut().zip(ratios).zip(first..) {
            mean *= ratio;
            *g = T::from_f64(mean / lobe_factor(l));
        }
    }
}
