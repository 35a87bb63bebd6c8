//! Band 3 by its values: a rotated function is known at seven directions, where the original is looked up.
//!
//! With `G_ki = y_3i(d_k)` the coefficients `f` become `G⁻¹ (f(R⁻¹ d_k))_k`. The seven directions are lanes of one register,
//! so nothing waits for anything, and there are no angles. The directions are chosen so that `G` has the condition 1.75.

use crate::Real;
use crate::simd::{Kernel, Lanes, dispatch_narrow};

/// Seven directions, by components; one lane is idle. Written by `tests/references/rotation_band_3.py`.
const DIRECTIONS: [[f64; 8]; 3] = [
    [
        0.3513024111816198,
        -0.9209180362829525,
        -0.9628021915825693,
        -0.7177435665984049,
        0.06360975930533776,
        -0.4870319705632848,
        0.7928827511180093,
        0.0,
    ],
    [
        0.7242922683849146,
        -0.1521669234886635,
        0.04524183816947571,
        -0.6945951382849543,
        -0.9856924561603198,
        0.6767061969856695,
        -0.608847905039713,
        0.0,
    ],
    [
        -0.5932851977386719,
        0.3588247453071566,
        -0.2663927851178569,
        0.04880334494178064,
        0.15609029562965526,
        -0.5521490583261336,
        -0.025321364660886605,
        0.0,
    ],
];

/// The inverse of the values of the functions of band 3 there: a row for each direction. Written by the same program.
const INVERSE: [[f64; 8]; 7] = [
    [
        -0.15419508450144784,
        -0.8142641085000853,
        -0.48071945614753536,
        0.8017158914783952,
        -0.15434487072991082,
        0.7810041310391743,
        0.08750930261416134,
        0.0,
    ],
    [
        0.022518020852668394,
        0.676915092360286,
        -0.02271890593672971,
        -0.7724390972570866,
        -0.43035912731486886,
        0.752986748478393,
        0.6276878231531104,
        0.0,
    ],
    [
        0.13375738292596642,
        0.5085252815420918,
        0.04870250055310169,
        0.6337024054225073,
        -0.7200829881350203,
        -0.717159166782423,
        0.6991516533983615,
        0.0,
    ],
    [
        0.5334125282845537,
        0.005631601311182228,
        -0.7008255143222516,
        -0.22746981760025572,
        -0.9942602038301238,
        -0.3062970675981376,
        -0.5406094919437602,
        0.0,
    ],
    [
        -0.6804434337874762,
        0.0175425411743749,
        -1.1251254052863715,
        -0.6142783963430946,
        0.11865044981503037,
        -0.2530534209777732,
        0.13198252757622086,
        0.0,
    ],
    [
        -0.2965877796246938,
        1.0005206482717903,
        -0.3235712955504002,
        0.8342655297957109,
        0.10647364692550176,
        0.5410444757185324,
        -0.09121696528480153,
        0.0,
    ],
    [
        0.684961547880501,
        0.0861332280872637,
        -0.5783303181720466,
        0.01798831244321951,
        1.0366884989088965,
        -0.41907938713401227,
        0.37464381523063905,
        0.0,
    ],
];

/// The tables in a scalar type.
pub trait BandValues: Sized {
    /// [`DIRECTIONS`].
    const DIRECTIONS: [[Self; 8]; 3];
    /// [`INVERSE`].
    const INVERSE: [[Self; 8]; 7];
}

impl BandValues for f64 {
    const DIRECTIONS: [[Self; 8]; 3] = DIRECTIONS;
    const INVERSE: [[Self; 8]; 7] = INVERSE;
}

impl BandValues for f32 {
    const DIRECTIONS: [[Self; 8]; 3] = rounded(DIRECTIONS);
    const INVERSE: [[Self; 8]; 7] = rounded(INVERSE);
}

const fn rounded<const ROWS: usize>(table: [[f64; 8]; ROWS]) -> [[f32; 8]; ROWS] {
    let mut out = [[0.0; 8]; ROWS];
    let mut at = 0;
    while at < 8 * ROWS {
        out[at / 8][at % 8] = table[at / 8][at % 8] as f32;
        at += 1;
    }
    out
}

/// Rotates band 3, `[7]`, by the rows of a matrix; a mirror image is as good as a rotation.
#[inline]
pub(super) fn rotate_band_3<T: Real>(r: &[[T; 3]; 3], coeffs: &[T; 7], out: &mut [T; 7]) {
    dispatch_narrow(Rotation { r, coeffs, out });
}

struct Rotation<'a, T> {
    r: &'a [[T; 3]; 3],
    coeffs: &'a [T; 7],
    out: &'a mut [T; 7],
}

impl<T: Real> Kernel<T> for Rotation<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes<T>>(self) {
        let (mut looked_up, mut rotated) = ([T::ZERO; 8], [T::ZERO; 8]);
        for lane in (0..8).step_by(V::WIDTH) {
            let direction = back_turned::<T, V>(self.r, lane);
            values(self.coeffs, direction).store(&mut looked_up[lane..]);
        }
        for lane in (0..8).step_by(V::WIDTH) {
            let term = |k: usize, sum: V| V::splat(looked_up[k]).mul_add(V::load(&T::INVERSE[k][lane..]), sum);
            let zero = V::splat(T::ZERO);
            // Two sums, so that a product need not wait for the one before.
            let (even, odd) = (term(4, term(2, term(0, zero))), term(5, term(3, term(1, zero))));
            (term(6, even) + odd).store(&mut rotated[lane..]);
        }
        self.out.copy_from_slice(&rotated[..7]);
    }
}

/// `Rᵀ d` for the directions from `lane` on.
#[inline(always)]
fn back_turned<T: Real, V: Lanes<T>>(r: &[[T; 3]; 3], lane: usize) -> [V; 3] {
    let [dx, dy, dz] = &T::DIRECTIONS;
    let (dx, dy, dz) = (V::load(&dx[lane..]), V::load(&dy[lane..]), V::load(&dz[lane..]));
    let mut turned = [V::splat(T::ZERO); 3];
    for (axis, out) in turned.iter_mut().enumerate() {
        let [x, y, z] = [V::splat(r[0][axis]), V::splat(r[1][axis]), V::splat(r[2][axis])];
        *out = x.mul_add(dx, y.mul_add(dy, z * dz));
    }
    turned
}

/// The values of the function at unit directions.
#[inline(always)]
fn values<T: Real, V: Lanes<T>>(coeffs: &[T; 7], [x, y, z]: [V; 3]) -> V {
    // −√(35/(32π)), √(105/(4π)), −√(21/(32π)), √(7/(16π)), √(105/(16π))
    const A: f64 = -0.590_043_589_926_643_5;
    const B: f64 = 2.890_611_442_640_554;
    const C: f64 = -0.457_045_799_464_465_8;
    const E: f64 = 0.373_176_332_590_115_4;
    const F: f64 = 1.445_305_721_320_277;
    const NORMS: [f64; 7] = [A, B, C, E, C, F, A];
    let f = |i: usize| V::splat(coeffs[i] * T::from_f64(NORMS[i]));
    let number = |number: f64| V::splat(T::from_f64(number));
    let (xx, yy, zz) = (x * x, y * y, z * z);
    let tall = number(4.0).mul_add(zz, -(xx + yy));
    let sines = f(0).mul_add(number(3.0).mul_add(xx, -yy), f(2) * tall);
    let cosines = f(6).mul_add(number(-3.0).mul_add(yy, xx), f(4) * tall);
    let upright = number(-3.0).mul_add(xx + yy, zz + zz);
    let rest = f(1).mul_add(x * y, f(3).mul_add(upright, f(5) * (xx - yy)));
    y.mul_add(sines, x.mul_add(cosines, z * rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tables_are_each_others_inverse() {
        for i in 0..7 {
            let mut unit = [0.0_f64; 7];
            unit[i] = 1.0;
            let at: [f64; 7] =
                core::array::from_fn(|k| values(&unit, [DIRECTIONS[0][k], DIRECTIONS[1][k], DIRECTIONS[2][k]]));
            for (j, expected) in unit.into_iter().enumerate() {
                let sum: f64 = INVERSE.iter().zip(at).map(|(row, value)| row[j] * value).sum();
                assert!((sum - expected).abs() < 1e-15, "{i} {j}: {sum}");
            }
        }
    }

    #[test]
    fn values_are_those_of_the_basis() {
        let order = crate::Order::new(4).unwrap_or_else(|_| unreachable!());
        for s in [[0.36, 0.48, 0.8], [0.0, 0.0, -1.0], [-0.6, 0.8, 0.0]] {
            let mut y = [0.0_f64; 16];
            crate::eval(order, s, &mut y);
            for i in 0..7 {
                let mut unit = [0.0; 7];
                unit[i] = 1.0;
                assert!((values(&unit, s) - y[9 + i]).abs() < 1e-15, "{i} {s:?}");
            }
        }
    }
}
