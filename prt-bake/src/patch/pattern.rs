//! The paper's relief patterns, made by formula.

use std::f64::consts::{PI, TAU};

use super::field::HeightField;
use crate::Error;

impl HeightField {
    /// Round bumps on a plane: two staggered rows of two, `(1 − r²/R²)²` with R = 0.22.
    ///
    /// - `size`: texels on a side
    /// - `height_scale`: height of the highest point, in units of the tile's width
    ///
    /// # Errors
    /// Those of [`HeightField::new`].
    pub fn bumps(size: usize, height_scale: f32) -> Result<Self, Error> {
        const RADIUS: f64 = 0.22;
        const CENTERS: [[f64; 2]; 4] = [[0.25, 0.25], [0.75, 0.25], [0.0, 0.75], [0.5, 0.75]];
        let bump = |u: f64, v: f64| {
            let distance = |[a, b]: [f64; 2]| periodic(u - a).hypot(periodic(v - b));
            let nearest = CENTERS.into_iter().map(distance).fold(f64::INFINITY, f64::min);
            (1.0 - (nearest / RADIUS).powi(2)).max(0.0).powi(2)
        };
        Self::from_function([size; 2], height_scale, bump)
    }

    /// A plain weave: four strands each way, over one and under the next. Arguments and errors as [`bumps`](Self::bumps).
    ///
    /// # Errors
    /// Those of [`HeightField::new`].
    pub fn weave(size: usize, height_scale: f32) -> Result<Self, Error> {
        const STRANDS: f64 = 4.0;
        // A strand along `along`, the one at `across`: round in section, up and down like a wave, and 0 between two strands.
        let strand = |along: f64, across: f64, phase: f64| {
            let (number, offset) = ((across * STRANDS).floor(), (across * STRANDS).fract() - 0.5);
            let section = (1.0 - (offset / 0.45).powi(2)).max(0.0).sqrt();
            let wave = 0.5 + 0.5 * (PI * (along * STRANDS - 0.5 + number) + phase).cos();
            section * (0.4 + 0.6 * wave)
        };
        Self::from_function([size; 2], height_scale, |u, v| strand(u, v, 0.0).max(strand(v, u, PI)))
    }

    /// A waffle: four by four square pits with a flat bottom at 0 between walls. Arguments and errors as [`bumps`](Self::bumps).
    ///
    /// # Errors
    /// Those of [`HeightField::new`].
    pub fn waffle(size: usize, height_scale: f32) -> Result<Self, Error> {
        const PITS: f64 = 4.0;
        // 1 on the wall, in the middle between two pits, 0 on the bottom; in between a smooth slope.
        let wall = |x: f64| {
            let from_wall = (periodic(x * PITS)).abs() * 2.0;
            let t = ((from_wall - 0.15) / 0.35).clamp(0.0, 1.0);
            1.0 - t * t * (3.0 - 2.0 * t)
        };
        Self::from_function([size; 2], height_scale, |u, v| wall(u).max(wall(v)))
    }

    /// A spiral of three arms in the middle of the tile, level at its border. Arguments and errors as [`bumps`](Self::bumps).
    ///
    /// # Errors
    /// Those of [`HeightField::new`].
    pub fn swirl(size: usize, height_scale: f32) -> Result<Self, Error> {
        const ARMS: f64 = 3.0;
        const TURNS: f64 = 1.5;
        let swirl = |u: f64, v: f64| {
            let (x, y) = (u - 0.5, v - 0.5);
            let r = 2.0 * x.hypot(y);
            // The arms meet in the middle, where the angle has no value, and fade at both ends.
            let fade = (1.0 - r * r).max(0.0) * (r / 0.2).min(1.0);
            0.5 + 0.5 * fade * (ARMS * (y.atan2(x) + TAU * TURNS / ARMS * r)).cos()
        };
        Self::from_function([size; 2], height_scale, swirl)
    }

    /// A field from a function of texture coordinates, evaluated at the texel centres.
    ///
    /// - `size`: columns and rows
    /// - `function`: height at (u, v); it should repeat with period 1 in both
    ///
    /// # Errors
    /// Those of [`HeightField::new`].
    pub fn from_function(
        size: [usize; 2],
        height_scale: f32,
        function: impl Fn(f64, f64) -> f64,
    ) -> Result<Self, Error> {
        let [width, height] = size;
        if width.saturating_mul(height) > Self::MAX_TEXELS {
            return Self::new(width, height, Vec::new());
        }
        let center = |index: usize, count: usize| (index as f64 + 0.5) / count as f64;
        let texels = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
        let heights = texels.map(|(column, row)| function(center(column, width), center(row, height)));
        Self::new(width, height, heights.map(|height| (height * f64::from(height_scale)) as f32).collect())
    }
}

/// The distance from the nearest whole number, with its sign.
fn periodic(x: f64) -> f64 {
    x - x.round()
}
