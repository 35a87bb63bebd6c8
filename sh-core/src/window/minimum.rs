//! The smallest value of an expansion.

use alloc::vec::Vec;

use super::bound::{Local, Surface, normalized};
use super::zonal_minimum::minimum_zonal;
use crate::order::assert_length;
use crate::{Order, Real, index};

/// The search ends when every part of the sphere is proved to hold nothing lower than what was found, by more than this
/// fraction of the largest swing that the coefficients allow. A smaller one costs more where an expansion is flat, and is
/// not needed: what was found is then the lowest of all minima that differ by more, refined until it no longer falls.
const CERTAINTY: f64 = 1e-6;

/// The smallest value of an expansion, and where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Minimum<T> {
    /// The value.
    pub value: T,
    /// A unit direction in which the expansion has it.
    pub direction: [T; 3],
}

/// The minimum of an expansion over the sphere.
///
/// A search through six cube faces, whose squares are dropped as soon as they are proved to hold nothing lower than what is
/// known, and halved until they are; the proof is Taylor's formula with Bernstein's bound of the third derivative. What is
/// known comes from Newton's method, begun at the lowest square of each size. It works in `f64`.
///
/// - `coeffs`: `[n²]`
///
/// Guarantee: the value is one that the expansion takes, and no value anywhere is lower by more than 1e-6 of
/// `Σ_(l>0) √((2l+1)/4π) |f_l|`, which no expansion's distance from its mean exceeds. In practice it is the minimum to
/// rounding, 1e-13 of that, asserted by `tests/window.rs`.
///
/// Cost: some hundred to some thousand evaluations; an expansion that is nearly flat where it is lowest needs many times more
/// (a power of a cosine, at n = 6 forty times, at n = 10 a hundred times).
///
/// Special answers: a constant, and so any expansion of order 1, has its minimum in direction +z; order 2 is solved in closed
/// form; a zonal function (zero wherever m ≠ 0) by [`minimum_zonal`], in the half-plane y = 0, x ≥ 0. If a coefficient is not
/// finite, the value is NaN and the direction +z.
///
/// ```
/// use sh_core::{Order, minimum};
///
/// // 1 + 2x, in the signs of this crate.
/// let pi = std::f64::consts::PI;
/// let lowest = minimum(Order::new(2)?, &[(4.0 * pi).sqrt(), 0.0, 0.0, -2.0 * (4.0 * pi / 3.0).sqrt()]);
/// assert!((lowest.value + 1.0).abs() < 1e-14);
/// assert_eq!(lowest.direction, [-1.0, 0.0, 0.0]);
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If `coeffs` is not `[n²]`.
///
/// Source of the bound: Bernstein's inequality, [Zyg02](crate#references) chapter X.
pub fn minimum<T: Real>(order: Order, coeffs: &[T]) -> Minimum<T> {
    assert_length("coeffs", coeffs.len(), order.coeff_count());
    let (value, direction) = if coeffs.iter().all(|f| f.is_finite()) {
        minimum_of_finite(order, coeffs.iter().map(|f| f.to_f64()).collect())
    } else {
        (f64::NAN, UP)
    };
    Minimum { value: T::from_f64(value), direction: direction.map(T::from_f64) }
}

const UP: [f64; 3] = [0.0, 0.0, 1.0];

fn minimum_of_finite(order: Order, coeffs: Vec<f64>) -> (f64, [f64; 3]) {
    if is_zonal(order, &coeffs) {
        let zonal: Vec<f64> = (0..order.get()).map(|l| coeffs[index(l, 0)]).collect();
        let (value, z) = minimum_zonal(&zonal);
        return (value, [Real::sqrt((1.0 - z) * (1.0 + z)), 0.0, z]);
    }
    if order.get() == 2 {
        return minimum_of_linear(&coeffs);
    }
    let (mean, size, swinging) = split(coeffs);
    let best = search(Surface::new(order, swinging), None);
    (mean + size * best.value, best.direction)
}

/// Whether an expansion with finite coefficients is nowhere negative: what [`minimum`] says of it, without looking for the
/// lowest value once one is negative, nor among those that are positive.
pub(super) fn is_nonnegative(order: Order, coeffs: Vec<f64>) -> bool {
    if order.get() <= 2 || is_zonal(order, &coeffs) {
        return minimum_of_finite(order, coeffs).0 >= 0.0;
    }
    let (mean, size, swinging) = split(coeffs);
    let floor = -mean / size;
    search(Surface::new(order, swinging), Some(floor)).value >= floor
}

fn is_zonal(order: Order, coeffs: &[f64]) -> bool {
    order.bands().all(|(l, band)| band.filter(|&i| i != index(l, 0)).all(|i| coeffs[i] == 0.0))
}

/// The mean, the largest of the other coefficients, and the rest over that: so the square of none overflows or vanishes.
fn split(mut coeffs: Vec<f64>) -> (f64, f64, Vec<f64>) {
    let mean = coeffs[0] * Real::sqrt(0.25 / core::f64::consts::PI);
    let size = coeffs[1..].iter().map(|f| f.abs()).fold(0.0, f64::max);
    coeffs[0] = 0.0;
    coeffs.iter_mut().for_each(|f| *f /= size);
    (mean, size, coeffs)
}

/// `f_00 y_00 − |b|` against the gradient `b` of the linear part, which is not zero.
fn minimum_of_linear(coeffs: &[f64]) -> (f64, [f64; 3]) {
    let scale = Real::sqrt(3.0 / (4.0 * core::f64::consts::PI));
    let gradient = [-scale * coeffs[3], -scale * coeffs[1], scale * coeffs[2]];
    let length = Real::hypot(Real::hypot(gradient[0], gradient[1]), gradient[2]);
    let mean = coeffs[0] * Real::sqrt(0.25 / core::f64::consts::PI);
    (mean - length, gradient.map(|g| if g == 0.0 { 0.0 } else { -g / length }))
}

/// A square on a face of the cube: the centre and half of the side, on a face with the corners ±1.
#[derive(Clone, Copy, Debug)]
struct Square {
    face: usize,
    centre: [f64; 2],
    half: f64,
}

impl Square {
    fn direction(self) -> [f64; 3] {
        let [u, v] = self.centre;
        let sign = if self.face < 3 { 1.0 } else { -1.0 };
        let mut direction = [sign, u, v];
        direction.rotate_right(self.face % 3);
        normalized(direction)
    }

    /// No less than the angle between the centre and any point of the square: central projection shortens lengths by the
    /// distance from the cube's centre, at least.
    fn radius(self) -> f64 {
        let nearest = self.centre.map(|c| (c.abs() - self.half).max(0.0));
        core::f64::consts::SQRT_2 * self.half / Real::sqrt(1.0 + nearest[0] * nearest[0] + nearest[1] * nearest[1])
    }

    fn quarters(self) -> impl Iterator<Item = Self> {
        let half = 0.5 * self.half;
        [[-half, -half], [half, -half], [-half, half], [half, half]].into_iter().map(move |[u, v]| Self {
            centre: [self.centre[0] + u, self.centre[1] + v],
            half,
            ..self
        })
    }
}

/// - `floor`: if given, only values below it are looked for, and the first is good enough
fn search(mut surface: Surface, floor: Option<f64>) -> Local {
    let mut best = surface.at(UP);
    let certain = CERTAINTY * surface.swing;
    let mut squares: Vec<Square> = (0..6).map(|face| Square { face, centre: [0.0; 2], half: 1.0 }).collect();
    while !squares.is_empty() && floor.is_none_or(|floor| best.value >= floor) {
        let quarters = squares.iter().flat_map(|square| square.quarters());
        let known: Vec<_> = quarters.map(|square| (square, surface.at(square.direction()))).collect();
        if let Some((_, lowest)) = known.iter().min_by(|a, b| a.1.value.total_cmp(&b.1.value)) {
            let lowest = surface.descend(*lowest);
            if lowest.value < best.value {
                best = lowest;
            }
        }
        let wanted = floor.unwrap_or(best.value) - certain;
        let open = known.iter().filter(|(square, local)| surface.lower_bound(local, square.radius()) < wanted);
        squares = open.map(|(square, _)| *square).collect();
    }
    best
}
