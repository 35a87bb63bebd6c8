//! Maps between the unit square, the unit disk and the upper hemisphere, all of which keep areas.
//!
//! A view map is indexed through them: texel (row `j`, column `i`) of a map of `size` rows is centred at
//! `((i+½)/size, (j+½)/size)` of the unit square.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// The concentric map from the unit square to the unit disk: `[0, 1]²` to `x² + y² ≤ 1`.
///
/// With `(a, b) = 2 square − 1`: `r = a`, `φ = π/4 · b/a` where `|a| > |b|`, else `r = b`, `φ = π/2 − π/4 · a/b`; squares about the
/// middle become circles. Equal areas stay equal: densities are divided by `π`, everywhere. Continuous, with an inverse,
/// [`disk_to_square`].
///
/// Source: Shirley and Chiu, *A Low Distortion Map Between Disk and Square*, Journal of Graphics Tools 2(3), 1997, as in
/// [SLS05](sh_core#references) section 3.2; the radius here is signed, so that four cases become two.
#[must_use]
pub fn square_to_disk(square: [f64; 2]) -> [f64; 2] {
    let [a, b] = square.map(|s| 2.0 * s - 1.0);
    let (r, phi) = match (a, b) {
        (0.0, 0.0) => (0.0, 0.0),
        _ if a.abs() > b.abs() => (a, FRAC_PI_4 * (b / a)),
        _ => (b, FRAC_PI_2 - FRAC_PI_4 * (a / b)),
    };
    [r * phi.cos(), r * phi.sin()]
}

/// The inverse of [`square_to_disk`].
#[must_use]
pub fn disk_to_square(disk: [f64; 2]) -> [f64; 2] {
    let [x, y] = disk;
    let [a, b] = match (x, y) {
        (0.0, 0.0) => [0.0, 0.0],
        _ if x.abs() > y.abs() => {
            let r = x.hypot(y).copysign(x);
            [r, r * (y / x).atan() / FRAC_PI_4]
        }
        _ => {
            let r = x.hypot(y).copysign(y);
            [r * (x / y).atan() / FRAC_PI_4, r]
        }
    };
    [0.5 * (a + 1.0), 0.5 * (b + 1.0)]
}

/// The map from the unit disk to the hemisphere about +z that keeps areas: `r` becomes `cos θ = 1 − r²`.
///
/// The middle becomes +z, the rim the horizon; solid angles are twice the areas of the disk.
///
/// Source: Lambert's azimuthal projection, [SLS05](sh_core#references) section 3.2.
#[must_use]
pub fn disk_to_hemisphere(disk: [f64; 2]) -> [f64; 3] {
    let [x, y] = disk;
    // A point of the rim may have been rounded outwards.
    let r2 = (x * x + y * y).min(1.0);
    let stretch = (2.0 - r2).sqrt();
    [stretch * x, stretch * y, 1.0 - r2]
}

/// The inverse of [`disk_to_hemisphere`]; a direction below the horizon is taken for the point of the horizon above it.
#[must_use]
pub fn hemisphere_to_disk(direction: [f64; 3]) -> [f64; 2] {
    let [x, y, z] = direction;
    if z >= 0.0 {
        let stretch = (1.0 + z).sqrt();
        return [x / stretch, y / stretch];
    }
    let length = x.hypot(y);
    if length > 0.0 { [x / length, y / length] } else { [1.0, 0.0] }
}

/// [`square_to_disk`], then [`disk_to_hemisphere`]: the direction at a point of a view map.
///
/// ```
/// assert_eq!(sh_fit::square_to_hemisphere([0.5, 0.5]), [0.0, 0.0, 1.0]);
/// assert_eq!(sh_fit::square_to_hemisphere([1.0, 0.5]), [1.0, 0.0, 0.0]);
/// ```
#[must_use]
pub fn square_to_hemisphere(square: [f64; 2]) -> [f64; 3] {
    disk_to_hemisphere(square_to_disk(square))
}

/// The inverse of [`square_to_hemisphere`]: the point of a view map for a direction. Below the horizon as in
/// [`hemisphere_to_disk`].
#[must_use]
pub fn hemisphere_to_square(direction: [f64; 3]) -> [f64; 2] {
    disk_to_square(hemisphere_to_disk(direction))
}

/// The four texels of a map `[size, size]` around a point of the unit square, with bilinear weights; clamped at the border.
///
/// Each is `(row · size + column, weight)`; the weights add up to 1.
pub(crate) fn bilinear(size: usize, square: [f64; 2]) -> [(usize, f64); 4] {
    let [(left, right, x), (top, bottom, y)] = square.map(|s| {
        let at = (s * size as f64 - 0.5).clamp(0.0, (size - 1) as f64);
        let low = (at as usize).min(size.saturating_sub(2));
        (low, (low + 1).min(size - 1), at - low as f64)
    });
    [
        (top * size + left, (1.0 - x) * (1.0 - y)),
        (top * size + right, x * (1.0 - y)),
        (bottom * size + left, (1.0 - x) * y),
        (bottom * size + right, x * y),
    ]
}

/// The texel centres of a map `[size, size]`, row by row.
pub(crate) fn texel_centres(size: usize) -> impl Iterator<Item = [f64; 2]> {
    let at = move |k: usize| (k as f64 + 0.5) / size as f64;
    (0..size * size).map(move |k| [at(k % size), at(k / size)])
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn near<const N: usize>(a: [f64; N], b: [f64; N], tolerance: f64) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance)
    }

    proptest! {
        #[test]
        fn maps_are_inverse(a in 0.0..=1.0, b in 0.0..=1.0) {
            prop_assert!(near(disk_to_square(square_to_disk([a, b])), [a, b], 1e-15));
            let direction = square_to_hemisphere([a, b]);
            let length: f64 = direction.iter().map(|x| x * x).sum();
            prop_assert!((length - 1.0).abs() < 1e-15 && direction[2] >= 0.0);
            prop_assert!(near(hemisphere_to_square(direction), [a, b], 1e-14));
        }

        /// The determinant of the Jacobian, by central differences, is 4 · π/4 and 2 · π.
        #[test]
        fn areas_are_kept(a in 0.01..0.99, b in 0.01..0.99) {
            // A difference must not cross a diagonal, where the map has a crease.
            prop_assume!(f64::abs(a - b) > 1e-3 && f64::abs(a + b - 1.0) > 1e-3);
            let step = 1e-5;
            let difference = |axis: usize| {
                let mut ends = [[a, b], [a, b]];
                ends[0][axis] += step;
                ends[1][axis] -= step;
                let [high, low] = ends.map(square_to_hemisphere);
                std::array::from_fn::<f64, 3, _>(|k| (high[k] - low[k]) / (2.0 * step))
            };
            let ([ux, uy, uz], [vx, vy, vz]) = (difference(0), difference(1));
            let cross = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
            let area = cross.iter().map(|x| x * x).sum::<f64>().sqrt();
            // Second differences of the map are below 100, so this is 1e-8 with room.
            prop_assert!((area - std::f64::consts::TAU).abs() < 1e-6, "{area}");
        }
    }

    #[test]
    fn the_concentric_map_is_that_of_the_paper() {
        // Corners of the square become diagonals of the disk, sides its axes.
        let half = std::f64::consts::FRAC_1_SQRT_2;
        assert!(near(square_to_disk([1.0, 1.0]), [half, half], 1e-15));
        assert!(near(square_to_disk([0.0, 1.0]), [-half, half], 1e-15));
        assert!(near(square_to_disk([0.5, 1.0]), [0.0, 1.0], 1e-15));
        assert!(near(square_to_disk([0.0, 0.5]), [-1.0, 0.0], 1e-15));
        // A quarter of the way along an edge: φ = π/8.
        let phi = std::f64::consts::FRAC_PI_8;
        assert!(near(square_to_disk([1.0, 0.75]), [phi.cos(), phi.sin()], 1e-15));
    }

    #[test]
    fn below_the_horizon_is_the_horizon() {
        assert_eq!(hemisphere_to_disk([0.0, -0.6, -0.8]), [0.0, -1.0]);
        assert_eq!(hemisphere_to_disk([0.0, 0.0, -1.0]), [1.0, 0.0]);
    }

    #[test]
    fn bilinear_weights_reproduce_a_plane_and_are_clamped() {
        let size = 8;
        let plane: Vec<f64> = texel_centres(size).map(|[a, b]| 3.0 * a - b + 0.25).collect();
        let at = |square| bilinear(size, square).iter().map(|&(k, weight)| weight * plane[k]).sum::<f64>();
        assert!((at([0.4, 0.7]) - (1.2 - 0.7 + 0.25)).abs() < 1e-14);
        assert!((at([0.0, 1.0]) - at([0.0625, 0.9375])).abs() < 1e-14);
        assert_eq!(bilinear(1, [0.3, 0.9]).iter().map(|(k, weight)| *k as f64 + weight).sum::<f64>(), 1.0);
    }
}
