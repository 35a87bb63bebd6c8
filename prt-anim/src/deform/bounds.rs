//! The sides of a bounding box.

use glam::DVec3;

/// Center, longest and shortest side of a box.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sides {
    pub(super) center: [f64; 3],
    /// Unit vector.
    pub(super) longest: [f64; 3],
    /// Unit vector, orthogonal to `longest`.
    pub(super) shortest: [f64; 3],
    /// Length of the longest side; 1 for a box that is a point, is not finite or is turned inside out.
    pub(super) length: f64,
}

impl Sides {
    pub(super) fn of([low, high]: [[f64; 3]; 2]) -> Self {
        let (low, high) = (DVec3::from(low), DVec3::from(high));
        let (center, size) = (low.midpoint(high), high - low);
        let (center, size) = if size.is_finite() { (center, size) } else { (DVec3::ZERO, DVec3::ONE) };
        let longest = first_best([1, 0, 2], |axis| size[axis]);
        let shortest = first_best([2, 0, 1], |axis| if axis == longest { f64::NEG_INFINITY } else { -size[axis] });
        let length = if size[longest] > 0.0 { size[longest] } else { 1.0 };
        Self {
            center: center.to_array(),
            longest: DVec3::AXES[longest].to_array(),
            shortest: DVec3::AXES[shortest].to_array(),
            length,
        }
    }
}

/// The first of the axes with the largest value.
fn first_best(axes: [usize; 3], value: impl Fn(usize) -> f64) -> usize {
    axes.into_iter().reduce(|best, axis| if value(axis) > value(best) { axis } else { best }).unwrap_or_default()
}
