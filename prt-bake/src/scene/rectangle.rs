//! Rectangles around directions.

use glam::Vec3;

/// A rectangle that holds directions, seen as points on a plane at distance 1 along a middle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rectangle {
    /// Unit length, perpendicular to the middle.
    pub(super) axes: [Vec3; 2],
    /// The smallest and the largest slope along each axis.
    pub(super) slopes: [[f32; 2]; 2],
}

/// How many rectangles are tried.
const TURNS: u32 = 16;

impl Rectangle {
    /// The smallest of some that are turned in equal steps.
    ///
    /// - `middle`: unit length, less than a right angle from each direction
    pub(crate) fn around(directions: &[Vec3], middle: Vec3) -> Self {
        let (x, y) = middle.any_orthonormal_pair();
        let turned = |step: u32| {
            let (sin, cos) = (step as f32 * std::f32::consts::FRAC_PI_2 / TURNS as f32).sin_cos();
            let axes = [cos * x + sin * y, cos * y - sin * x];
            Self { axes, slopes: axes.map(|axis| slopes(directions, middle, axis)) }
        };
        let rest = (1..TURNS).map(turned);
        rest.fold(turned(0), |smallest, other| if other.area() < smallest.area() { other } else { smallest })
    }

    fn width(&self, axis: usize) -> f32 {
        self.slopes[axis][1] - self.slopes[axis][0]
    }

    fn area(&self) -> f32 {
        self.width(0) * self.width(1)
    }

    /// The axis along which it is wider.
    pub(crate) fn long_axis(&self) -> Vec3 {
        self.axes[usize::from(self.width(1) > self.width(0))]
    }
}

/// The smallest and the largest slope of directions along an axis against the middle.
fn slopes(directions: &[Vec3], middle: Vec3, axis: Vec3) -> [f32; 2] {
    let (mut lower, mut upper) = (f32::INFINITY, f32::NEG_INFINITY);
    for direction in directions {
        let slope = direction.dot(axis) / direction.dot(middle);
        (lower, upper) = (lower.min(slope), upper.max(slope));
    }
    [lower, upper]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turned_rectangle_is_found() {
        let middle = Vec3::new(1.0, -2.0, 0.5).normalize();
        let (x, y) = middle.any_orthonormal_pair();
        // Turned by an angle that is one of those tried, 3 times as long as it is wide.
        let (sin, cos) = (5.0 * std::f32::consts::FRAC_PI_2 / 16.0).sin_cos();
        let (long, short) = (cos * x + sin * y, cos * y - sin * x);
        let corner = |a: f32, b: f32| (middle + 0.3 * a * long + 0.1 * b * short).normalize();
        let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0), corner(0.2, 0.4)];
        let rectangle = Rectangle::around(&corners, middle);
        assert!((rectangle.area() - 0.6 * 0.2).abs() < 1e-5, "{}", rectangle.area());
        assert!((rectangle.long_axis().dot(long).abs() - 1.0).abs() < 1e-5);
    }
}
