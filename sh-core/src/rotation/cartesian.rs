//! Bands 1 and 2 without angles: a vector and a symmetric matrix without trace, which a rotation multiplies.

use crate::Real;

/// Rotates the bands of an expansion of order 3 or less; a mirror image is as good as a rotation. Slices `[n²]`.
#[inline]
pub(super) fn rotate<T: Real>(r: &[[T; 3]; 3], coeffs: &[T], out: &mut [T]) {
    out[0] = coeffs[0];
    if let (Some(&[_, f1, f2, f3]), Some(out)) = (coeffs.first_chunk(), out.first_chunk_mut::<4>()) {
        // −y, z, −x
        let v = [-f3, -f1, f2];
        [out[1], out[2], out[3]] = [-dot(&r[1], &v), dot(&r[2], &v), -dot(&r[0], &v)];
    }
    if let (Some(coeffs), Some(out)) = (coeffs.first_chunk::<9>(), out.first_chunk_mut::<9>()) {
        rotate_band_2(r, [coeffs[4], coeffs[5], coeffs[6], coeffs[7], coeffs[8]], out);
    }
}

/// `f(s) = ¼√(15/π) sᵀ Q s` becomes `sᵀ R Q Rᵀ s`.
#[inline(always)]
fn rotate_band_2<T: Real>(r: &[[T; 3]; 3], [xy, minus_yz, f6, minus_xz, f8]: [T; 5], out: &mut [T; 9]) {
    let half = T::from_f64(0.5);
    // 3z² − 1 = 2z² − x² − y², and ¼√(5/π) = ¼√(15/π) / √3
    let third = f6 * T::from_f64(0.577_350_269_189_625_8);
    let (yz, xz) = (-minus_yz, -minus_xz);
    let q = [[f8 - third, xy, xz], [xy, -f8 - third, yz], [xz, yz, third + third]];
    // Rows of R Q; Q is symmetric.
    let p = |i: usize| [dot(&r[i], &q[0]), dot(&r[i], &q[1]), dot(&r[i], &q[2])];
    let (px, py, pz) = (p(0), p(1), p(2));
    out[4] = dot(&px, &r[1]);
    out[5] = -dot(&py, &r[2]);
    out[6] = T::from_f64(0.866_025_403_784_438_6) * dot(&pz, &r[2]);
    out[7] = -dot(&px, &r[2]);
    out[8] = half * (dot(&px, &r[0]) - dot(&py, &r[1]));
}

#[inline(always)]
fn dot<T: Real>(a: &[T; 3], b: &[T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
