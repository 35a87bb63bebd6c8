//! Cube maps to coefficients and back.
//!
//! A cube map has the same texels after mirroring x, y or z, and each `y_i` is even or odd in each of them. So the eight
//! mirror images of a texel share one evaluation of the basis, and their radiances enter as eight sums, one per pattern of
//! signs, of which `y_i` needs one. The result is the same for an eighth of the work.

use alloc::vec;
use alloc::vec::Vec;

use crate::maps::FACES;
use crate::order::assert_length;
use crate::{Basis, CubeMap, Order, Real};

/// Radiance of the eight mirror images of a texel; bits 0, 1, 2 of the index say whether x, y, z is mirrored. The fourth
/// channel is idle.
type Octants = [[f64; 4]; 8];

/// Projects a cube map: `light[c, i] = Σ radiance_c(s) y_i(s) ω(s)` over the texels, with the exact solid angle ω of each.
///
/// - `faces`: +x −x +y −y +z −z, each `[size, size]` row-major, oriented as [`CubeMap`] says
/// - `light`: `[3, n²]`, channel-major, overwritten
///
/// Sums in `f64`. Radiance counts as constant in a texel and the basis as that at its centre: a light of order n that
/// is sampled at the centres comes back with a relative error below `(n/size)² / 10`, asserted by `tests/projection.rs`.
/// Where a texel is infinite or NaN, coefficients of that channel are.
///
/// # Panics
/// If a slice length does not match `order` or `map`.
pub fn project_cube<T: Real>(order: Order, map: CubeMap, faces: [&[[T; 3]]; 6], light: &mut [T]) {
    let count = order.coeff_count();
    assert_length("light", light.len(), 3 * count);
    faces.iter().for_each(|face| assert_length("face", face.len(), map.size * map.size));

    let (basis, parities) = (Basis::<f64>::new(order), parities(order));
    let mut y = vec![0.0; count];
    let mut sums = vec![[0.0; 4]; count];
    for_each_quarter_texel(map, |column, row, weight| {
        for axis in 0..3 {
            basis.eval(map.direction(2 * axis, column as f64 + 0.5, row as f64 + 0.5), &mut y);
            let patterns = sign_patterns(gather(map, &faces, axis, [column, row], weight));
            for ((sum, &y), &parity) in sums.iter_mut().zip(&y).zip(&parities) {
                let pattern = &patterns[usize::from(parity)];
                sum.iter_mut().zip(pattern).for_each(|(sum, radiance)| *sum += y * radiance);
            }
        }
    });
    for (channel, light) in light.chunks_exact_mut(count).enumerate() {
        light.iter_mut().zip(&sums).for_each(|(out, sum)| *out = T::from_f64(sum[channel]));
    }
}

/// Draws a light as a cube map: each texel is its value at the texel's centre.
///
/// - `light`: `[3, n²]`, channel-major
/// - `faces`: +x −x +y −y +z −z, each `[size, size]` row-major, overwritten; negative where the light rings below zero
///
/// Works in `f64`, row by row.
///
/// # Panics
/// If a slice length does not match `order` or `map`.
pub fn reconstruct_cube<T: Real>(order: Order, light: &[T], map: CubeMap, faces: [&mut [[T; 3]]; 6]) {
    assert_length("light", light.len(), 3 * order.coeff_count());
    faces.iter().for_each(|face| assert_length("face", face.len(), map.size * map.size));
    let (basis, light) = (Basis::<f64>::new(order), light.iter().map(|f| f.to_f64()).collect::<Vec<f64>>());
    let mut radiance = vec![[0.0; 3]; map.size];
    for (face, pixels) in faces.into_iter().enumerate() {
        for (row, pixels) in pixels.chunks_exact_mut(map.size.max(1)).enumerate() {
            let direction = |column: usize| map.direction(face, column as f64 + 0.5, row as f64 + 0.5);
            let directions: Vec<[f64; 3]> = (0..map.size).map(direction).collect();
            basis.reconstruct(&light, &directions, &mut radiance);
            pixels.iter_mut().zip(&radiance).for_each(|(pixel, radiance)| *pixel = radiance.map(T::from_f64));
        }
    }
}

/// The texels of the top left quarter of a face, with the weight of each of their mirror images.
///
/// The middle row and column of an odd size are their own mirror image: they are met twice, with half the weight.
fn for_each_quarter_texel(map: CubeMap, mut visit: impl FnMut(usize, usize, f64)) {
    let half = map.size.div_ceil(2);
    let share = |i: usize| if 2 * i + 1 == map.size { 0.5 } else { 1.0 };
    for row in 0..half {
        for column in 0..half {
            visit(column, row, map.solid_angle(column, row) * share(column) * share(row));
        }
    }
}

/// The weighted radiance of a texel of the face `+axis` and of its mirror images.
fn gather<T: Real>(map: CubeMap, faces: &[&[[T; 3]]; 6], axis: usize, texel: [usize; 2], weight: f64) -> Octants {
    core::array::from_fn(|mirror| {
        let face = 2 * axis + (mirror >> axis & 1);
        let [column, row] =
            core::array::from_fn(
                |edge| {
                    if is_flipped(axis, mirror, edge) { map.size - 1 - texel[edge] } else { texel[edge] }
                },
            );
        let [r, g, b] = faces[face][row * map.size + column].map(|c| weight * c.to_f64());
        [r, g, b, 0.0]
    })
}

/// Whether mirroring turns the direction of an edge of the face `+axis` around (0: columns, 1: rows).
#[inline]
fn is_flipped(axis: usize, mirror: usize, edge: usize) -> bool {
    const FLIPS: [[[bool; 2]; 8]; 3] = flips();
    FLIPS[axis][mirror][edge]
}

/// All answers of [`is_flipped`].
const fn flips() -> [[[bool; 2]; 8]; 3] {
    let mut flips = [[[false; 2]; 8]; 3];
    let mut i = 0;
    while i < 3 * 8 * 2 {
        let (axis, mirror, edge) = (i / 16, i / 2 % 8, i % 2);
        let (face, mirrored_face) = (2 * axis, 2 * axis + (mirror >> axis & 1));
        // The world axis along which the edge runs on both faces.
        let mut along = 0;
        while FACES[face][along][edge] == 0.0 {
            along += 1;
        }
        let faces_differ = FACES[face][along][edge] != FACES[mirrored_face][along][edge];
        flips[axis][mirror][edge] = faces_differ != (mirror >> along & 1 == 1);
        i += 1;
    }
    flips
}

/// For each pattern of parities `p`, the sum over the mirror images `k` with the sign `(−1)^|k & p|`: a Hadamard transform.
fn sign_patterns(mut octants: Octants) -> Octants {
    for bit in [1, 2, 4] {
        for k in (0..8).filter(|k| k & bit == 0) {
            let (a, b) = (octants[k], octants[k | bit]);
            octants[k] = core::array::from_fn(|c| a[c] + b[c]);
            octants[k | bit] = core::array::from_fn(|c| a[c] - b[c]);
        }
    }
    octants
}

/// For each coefficient, bits 0, 1, 2: whether `y_i` is odd in x, y, z.
fn parities(order: Order) -> Vec<u8> {
    let band = |l: isize| (-l..=l).map(move |m| parity(l, m));
    (0..order.get() as isize).flat_map(band).collect()
}

fn parity(l: isize, m: isize) -> u8 {
    // cos(m phi) is Re (x+iy)^m, sin(|m| phi) is Im (x+iy)^|m|; the rest is a polynomial in z of the parity of l+m.
    let sine = u8::from(m < 0);
    let odd_m = u8::from(m % 2 != 0);
    let odd_z = u8::from((l + m) % 2 != 0);
    (odd_m ^ sine) | sine << 1 | odd_z << 2
}
