use crate::Error;
use crate::angle::atan_unit;
use crate::surface::{all_finite, check_length};
use std::f32::consts::FRAC_PI_4;

/// How much each row of a glossy transfer counts in a direction of view: `u_r(v)` of eq. 15 of \[SLS05\].
///
/// Texel (row `j`, column `i`) lies at `((i + ½)/size, (j + ½)/size)` of the unit square, which Shirley and Chiu's concentric map
/// takes to the disk, and `cos θ = 1 − r²` from the disk to the hemisphere, preserving area. Sampled bilinearly, clamped at the border.
///
/// Source: P. Shirley, K. Chiu, "A low distortion map between disk and square", Journal of Graphics Tools 2(3), 1997.
#[derive(Debug, Clone, Copy)]
pub struct ViewMap<'a> {
    /// Texels of a side; 32 in the paper.
    pub size: usize,
    /// `[size, size, R]`.
    pub values: &'a [f32],
}

impl ViewMap<'_> {
    pub(crate) fn check(&self, rows: usize) -> Result<(), Error> {
        let size = self.size;
        if size == 0 {
            return Err(Error::Lobes("a view map of size 0 was given; at least 1 is needed".into()));
        }
        let needed = size.saturating_mul(size).saturating_mul(rows);
        check_length("view map", self.values.len(), "floats", needed, || format!("size {size} and {rows} rows"))?;
        match all_finite(self.values) {
            true => Ok(()),
            false => Err(Error::NotFinite {
                what: "view map entry",
                item: self.values.iter().position(|u| !u.is_finite()).unwrap_or_default(),
            }),
        }
    }

    /// The factors of all rows for a direction, `out[r] = u_r(direction)`.
    ///
    /// - `direction`: from the surface to the eye, unit length, in the local frame; below the horizon it counts as on the horizon
    /// - `out`: `[R]`, overwritten
    ///
    /// # Panics
    /// If the length of `out` does not match the map.
    pub fn sample(&self, direction: [f32; 3], out: &mut [f32]) {
        let (size, rows) = (self.size, out.len());
        assert_eq!(self.values.len(), size * size * rows, "rows of the view map");
        let last = (size - 1) as f32;
        let [x, y] = square_from_hemisphere(direction).map(|s| (s * size as f32 - 0.5).clamp(0.0, last));
        let (column, row) = (x as usize, y as usize);
        let (next_column, next_row) = ((column + 1).min(size - 1), (row + 1).min(size - 1));
        let (s, t) = (x - column as f32, y - row as f32);
        for (r, out) in out.iter_mut().enumerate() {
            let texel = |row: usize, column: usize| self.values[(row * size + column) * rows + r];
            let top = texel(row, column) + s * (texel(row, next_column) - texel(row, column));
            let bottom = texel(next_row, column) + s * (texel(next_row, next_column) - texel(next_row, column));
            *out = top + t * (bottom - top);
        }
    }
}

/// Where a direction lies in the unit square of a [`ViewMap`]. The twin of the function in `shaders/shared/view_map.wgsl`.
pub(crate) fn square_from_hemisphere([x, y, z]: [f32; 3]) -> [f32; 2] {
    // On the sphere x² + y² = (1 − z)(1 + z), and the radius on the disk is √(1 − z); below the horizon it is 1.
    let length = (x * x + y * y).sqrt();
    let [dx, dy] = match (z >= 0.0, length > 0.0) {
        (true, _) => [x, y].map(|d| d / (1.0 + z).sqrt()),
        (false, true) => [x, y].map(|d| d / length),
        (false, false) => [1.0, 0.0],
    };
    square_from_disk([dx, dy]).map(|s| 0.5 + 0.5 * s)
}

/// The inverse of the concentric map, from the unit disk to `[−1, 1]²`.
fn square_from_disk([x, y]: [f32; 2]) -> [f32; 2] {
    let radius = (x * x + y * y).sqrt();
    if radius == 0.0 {
        return [0.0; 2];
    }
    match x.abs() >= y.abs() {
        true => {
            let a = radius.copysign(x);
            [a, a * (atan_unit(y / x) / FRAC_PI_4)]
        }
        false => {
            let b = radius.copysign(y);
            [b * (atan_unit(x / y) / FRAC_PI_4), b]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::FRAC_PI_4;

    /// From the square to the hemisphere, as the papers write it.
    fn hemisphere_from_square([a, b]: [f64; 2]) -> [f64; 3] {
        let (radius, phi) = match (a.abs() > b.abs(), a == 0.0 && b == 0.0) {
            (_, true) => (0.0, 0.0),
            (true, _) => (a, FRAC_PI_4 * b / a),
            (false, _) => (b, 2.0 * FRAC_PI_4 - FRAC_PI_4 * a / b),
        };
        let (x, y, z) = (radius * phi.cos(), radius * phi.sin(), 1.0 - radius * radius);
        let stretch = (1.0 + z).sqrt();
        [x * stretch, y * stretch, z]
    }

    proptest! {
        #[test]
        fn the_map_is_the_inverse_of_the_papers(a in -1.0_f64..1.0, b in -1.0_f64..1.0) {
            let [s, t] = square_from_hemisphere(hemisphere_from_square([a, b]).map(|x| x as f32));
            // Rounding of z near the horizon moves √(1 − z) by some 6e-8.
            prop_assert!((f64::from(s) - (0.5 + 0.5 * a)).abs() < 1e-6 && (f64::from(t) - (0.5 + 0.5 * b)).abs() < 1e-6, "{s} {t}");
        }

        #[test]
        fn below_the_horizon_counts_as_on_it(phi in 0.0_f32..6.3, z in -1.0_f32..-1e-3) {
            let below = square_from_hemisphere([phi.cos() * (1.0 - z * z).sqrt(), phi.sin() * (1.0 - z * z).sqrt(), z]);
            let on = square_from_hemisphere([phi.cos(), phi.sin(), 0.0]);
            prop_assert!((0..2).all(|i| (below[i] - on[i]).abs() < 1e-4), "{below:?} {on:?}");
        }
    }

    #[test]
    fn texels_hold_at_their_centres_and_between_them_linearly() {
        // One row, u = column + 10 row.
        let values: Vec<f32> = (0..16).map(|i| (i % 4) as f32 + 10.0 * (i / 4) as f32).collect();
        let map = ViewMap { size: 4, values: &values };
        let sample = |s: f64, t: f64| {
            let mut out = [f32::NAN];
            let direction = hemisphere_from_square([2.0 * s - 1.0, 2.0 * t - 1.0]).map(|x| x as f32);
            map.sample(direction, &mut out);
            out[0]
        };
        for (s, t, u) in
            [(0.125, 0.125, 0.0), (0.375, 0.875, 31.0), (0.5, 0.125, 1.5), (0.625, 0.5, 17.0), (0.01, 0.99, 30.0)]
        {
            assert!((sample(s, t) - u).abs() < 1e-4, "{s} {t}: {} is not {u}", sample(s, t));
        }
    }

    #[test]
    fn every_direction_has_finite_factors() {
        let map = ViewMap { size: 1, values: &[2.0, 3.0] };
        for direction in [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0; 3]] {
            let mut out = [f32::NAN; 2];
            map.sample(direction, &mut out);
            assert_eq!(out, [2.0, 3.0]);
        }
    }
}
