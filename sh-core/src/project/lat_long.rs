//! Latitude-longitude maps to coefficients and back.
//!
//! A row is a circle about the map's up axis +y. In a frame whose polar axis is that axis, `y_lm` on a circle is a constant
//! times `cos(mφ)` or `sin(mφ)`; so a row is first reduced to `2n−1` Fourier sums, which take nearly all the time, and the
//! bands see those only. The frame is turned back to the basis's +z at the end, exactly.

use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::PI;

use super::circle::Circle;
use crate::order::assert_length;
use crate::rotation::rotate_channels;
use crate::{Basis, LatLong, Order, Real, index};

/// The map's frame to the scene's, rows: local +z is up (+y), local +x is the left edge (−z), local +y is −x.
///
/// The longitude of a map runs clockwise about +y: a column's azimuth in this right-handed frame is the negative of its
/// longitude.
const SCENE_FROM_MAP: [[f64; 3]; 3] = [[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]];
const MAP_FROM_SCENE: [[f64; 3]; 3] = [[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

/// Projects a latitude-longitude map: `light[c, i] = Σ radiance_c(s) y_i(s) ω(s)` over the texels, with the exact solid
/// angle ω of each.
///
/// - `pixels`: `[height, width]` row-major, oriented as [`LatLong`] says
/// - `light`: `[3, n²]`, channel-major, overwritten
///
/// Sums in `f64`. Radiance counts as constant in a texel and the basis as that at its centre: a light of order n that
/// is sampled at the centres comes back with a relative error below `(n/height)² / 10`, asserted by `tests/projection.rs`.
/// Where a texel is infinite or NaN, coefficients of that channel are.
///
/// ```
/// use sh_core::{LatLong, Order, project_lat_long, reconstruct};
///
/// let (order, map) = (Order::new(3)?, LatLong { width: 64, height: 32 });
/// let mut light = [0.0_f32; 27];
/// project_lat_long(order, map, &vec![[1.0, 2.0, 0.5]; map.texel_count()], &mut light);
/// let green = reconstruct(order, &light[9..18], [0.0, 0.0, 1.0]);
/// assert!((green - 2.0).abs() < 0.01);
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// # Panics
/// If a slice length does not match `order` or `map`.
pub fn project_lat_long<T: Real>(order: Order, map: LatLong, pixels: &[[T; 3]], light: &mut [T]) {
    let count = order.coeff_count();
    assert_length("light", light.len(), 3 * count);
    assert_length("pixels", pixels.len(), map.texel_count());
    if pixels.is_empty() {
        light.fill(T::ZERO);
        return;
    }
    let (basis, mut circle) = (Basis::<f64>::new(order), Circle::new(order, map.width));
    let mut meridian = vec![0.0; count];
    let mut local = vec![0.0; 3 * count];
    for (row, pixels) in pixels.chunks_exact(map.width).enumerate() {
        basis.eval(meridian_direction(map, row), &mut meridian);
        circle.analyse(pixels);
        let waves = circle.cosines.chunks_exact(order.get()).zip(circle.sines.chunks_exact(order.get()));
        for (waves, local) in waves.zip(local.chunks_exact_mut(count)) {
            add_row(order, &meridian, waves, map.solid_angle(row), local);
        }
    }
    let mut rotated = vec![0.0; 3 * count];
    rotate_channels(order, SCENE_FROM_MAP, &local, &mut rotated);
    light.iter_mut().zip(rotated).for_each(|(out, f)| *out = T::from_f64(f));
}

/// Draws a light as a latitude-longitude map: each texel is its value at the texel's centre.
///
/// - `light`: `[3, n²]`, channel-major
/// - `pixels`: `[height, width]` row-major, overwritten; negative where the light rings below zero
///
/// Works in `f64`, row by row.
///
/// # Panics
/// If a slice length does not match `order` or `map`.
pub fn reconstruct_lat_long<T: Real>(order: Order, light: &[T], map: LatLong, pixels: &mut [[T; 3]]) {
    let count = order.coeff_count();
    assert_length("light", light.len(), 3 * count);
    assert_length("pixels", pixels.len(), map.texel_count());
    if pixels.is_empty() {
        return;
    }
    let scene: Vec<f64> = light.iter().map(|f| f.to_f64()).collect();
    let mut local = vec![0.0; 3 * count];
    rotate_channels(order, MAP_FROM_SCENE, &scene, &mut local);

    let (basis, mut circle) = (Basis::<f64>::new(order), Circle::new(order, map.width));
    let mut meridian = vec![0.0; count];
    for (row, pixels) in pixels.chunks_exact_mut(map.width).enumerate() {
        basis.eval(meridian_direction(map, row), &mut meridian);
        let waves = circle.cosines.chunks_exact_mut(order.get()).zip(circle.sines.chunks_exact_mut(order.get()));
        for (waves, local) in waves.zip(local.chunks_exact(count)) {
            sum_row(order, &meridian, local, waves);
        }
        let [red, green, blue] = circle.synthesise();
        for (((pixel, &r), &g), &b) in pixels.iter_mut().zip(red).zip(green).zip(blue) {
            *pixel = [r, g, b].map(T::from_f64);
        }
    }
}

/// The direction of a row at azimuth 0, in the map's frame.
fn meridian_direction(map: LatLong, row: usize) -> [f64; 3] {
    let theta = PI * (row as f64 + 0.5) / map.height as f64;
    [Real::sin(theta), 0.0, Real::cos(theta)]
}

/// Adds a row's Fourier sums to the coefficients in the map's frame.
///
/// - `meridian`: `[n²]`, the basis at azimuth 0, where `y_lm` for m ≥ 0 is the constant of the circle
/// - `cosines`, `sines`: `[n]`
fn add_row(order: Order, meridian: &[f64], (cosines, sines): (&[f64], &[f64]), solid_angle: f64, local: &mut [f64]) {
    for l in 0..order.get() {
        let centre = index(l, 0);
        for m in 0..=l {
            let constant = solid_angle * meridian[centre + m];
            local[centre - m] -= constant * sines[m];
            local[centre + m] += constant * cosines[m];
        }
    }
}

/// The Fourier coefficients of a row: the adjoint of [`add_row`].
fn sum_row(order: Order, meridian: &[f64], local: &[f64], (cosines, sines): (&mut [f64], &mut [f64])) {
    cosines.fill(0.0);
    sines.fill(0.0);
    for l in 0..order.get() {
        let centre = index(l, 0);
        for m in 0..=l {
            cosines[m] += meridian[centre + m] * local[centre + m];
            sines[m] -= meridian[centre + m] * local[centre - m];
        }
    }
    sines[0] = 0.0;
}
