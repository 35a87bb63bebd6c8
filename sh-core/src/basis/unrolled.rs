//! Straight-line kernels for small orders. Written by `tests/unrolled_source.rs`: change that program, not this file.
//!
//! For m ≥ 0, `y_lm = p cos`, `y_l−m = p sin`, with `cos + i sin = (x + iy)^m` and `p` a polynomial: `p(v)` for even l − m,
//! `z p(v)` for odd, where `v = 2z² − 1`. In `v` the coefficients are small, and its rounding near the poles costs a
//! quarter of that of z. Column `m` of every order is one function, cut off at the constant order `N`.

use crate::{Order, Real, dot};

/// The largest order that has a kernel.
#[cfg(feature = "alloc")]
pub(super) const MAX_ORDER: usize = 10;

/// Evaluates an order that has a kernel; returns whether it did. `out` is `[n²]`.
#[inline]
pub(super) fn eval<T: Real>(order: Order, direction: [T; 3], out: &mut [T]) -> bool {
    match order.get() {
        1 => kernel::<T, 1>(direction, out),
        2 => kernel::<T, 2>(direction, out),
        3 => kernel::<T, 3>(direction, out),
        4 => kernel::<T, 4>(direction, out),
        5 => kernel::<T, 5>(direction, out),
        6 => kernel::<T, 6>(direction, out),
        7 => kernel::<T, 7>(direction, out),
        8 => kernel::<T, 8>(direction, out),
        9 => kernel::<T, 9>(direction, out),
        10 => kernel::<T, 10>(direction, out),
        _ => return false,
    }
    true
}

/// The value of an expansion of an order that has a kernel. `coeffs` is `[n²]`.
#[inline]
pub(super) fn reconstruct<T: Real>(order: Order, coeffs: &[T], direction: [T; 3]) -> Option<T> {
    match order.get() {
        1 => sum::<T, 1, 1>(coeffs, direction),
        2 => sum::<T, 2, 4>(coeffs, direction),
        3 => sum::<T, 3, 9>(coeffs, direction),
        4 => sum::<T, 4, 16>(coeffs, direction),
        5 => sum::<T, 5, 25>(coeffs, direction),
        6 => sum::<T, 6, 36>(coeffs, direction),
        7 => sum::<T, 7, 49>(coeffs, direction),
        8 => sum::<T, 8, 64>(coeffs, direction),
        9 => sum::<T, 9, 81>(coeffs, direction),
        10 => sum::<T, 10, 100>(coeffs, direction),
        _ => None,
    }
}

/// Order `N`; `N2 = N²`.
#[inline(always)]
fn sum<T: Real, const N: usize, const N2: usize>(coeffs: &[T], direction: [T; 3]) -> Option<T> {
    let mut y = [T::ZERO; N2];
    kernel::<T, N>(direction, &mut y);
    Some(dot(coeffs, &y))
}

#[inline(always)]
fn kernel<T: Real, const N: usize>([x, y, z]: [T; 3], out: &mut [T]) {
    assert!(out.len() == N * N, "length checked by the caller");
    let zv = [z, polynomial_argument([x, y, z])];
    column_0::<T, N>(zv, out);
    let (mut c, mut s) = (x, y);
    if N > 1 {
        column_1::<T, N>([c, s], zv, out);
    }
    if N > 2 {
        (c, s) = (x * c - y * s, x * s + y * c);
        column_2::<T, N>([c, s], zv, out);
    }
    if N > 3 {
        (c, s) = (x * c - y * s, x * s + y * c);
        column_3::<T, N>([c, s], zv, out);
    }
    if N > 4 {
        (c, s) = (x * c - y * s, x * s + y * c);
        column_4::<T, N>([c, s], zv, out);
    }
    if N > 5 {
        (c, s) = (x * c - y * s, x * s + y * c);
        column_5::<T, N>([c, s], zv, out);
    }
    if N > 6 {
        (c, s) = (x * c - y * s, x * s + y * c);
        column_6::<T, N>([c, s], zv, out);
    }
    if N > 7 {
        (c, s) = (x * c - y * s, x * s + y * c);
        column_7::<T, N>([c, s], zv, out);
    }
    if N > 8 {
        (c, s) = (x * c - y * s, x * s + y * c);
        column_8::<T, N>([c, s], zv, out);
    }
    if N > 9 {
        (c, s) = (x * c - y * s, x * s + y * c);
        column_9::<T, N>([c, s], zv, out);
    }
}

/// `2z² − 1`, near the poles from x and y, where z has lost digits.
#[inline(always)]
fn polynomial_argument<T: Real>([x, y, z]: [T; 3]) -> T {
    let two = T::ONE + T::ONE;
    let (radius2, height2) = (x * x + y * y, z * z);
    if radius2 < height2 { T::ONE - two * radius2 } else { two * height2 - T::ONE }
}

#[inline(always)]
fn column_0<T: Real, const N: usize>([z, v]: [T; 2], out: &mut [T]) {
    let k = T::from_f64;
    let p = k(0.28209479177387814);
    out[0] = p;
    if N > 1 {
        let p = k(0.4886025119029199);
        let p = p * z;
        out[2] = p;
    }
    if N > 2 {
        let p = k(0.47308734787878004);
        let p = p * v + k(0.15769578262626002);
        out[6] = p;
    }
    if N > 3 {
        let p = k(0.9329408314752885);
        let p = p * v + k(-0.1865881662950577);
        let p = p * z;
        out[12] = p;
    }
    if N > 4 {
        let p = k(0.9256235355080377);
        let p = p * v + k(0.26446386728801075);
        let p = p * v + k(-0.343803027474414);
        out[20] = p;
    }
    if N > 5 {
        let p = k(1.8419675786414218);
        let p = p * v + k(-0.4093261285869826);
        let p = p * v + k(-0.4970388704270503);
        let p = p * z;
        out[30] = p;
    }
    if N > 6 {
        let p = k(1.8355607154777707);
        let p = p * v + k(0.5006074678575738);
        let p = p * v + k(-1.1680840916676722);
        let p = p * v + k(-0.1509768553856175);
        out[42] = p;
    }
    if N > 7 {
        let p = k(3.6617443494062654);
        let p = p * v + k(-0.8450179267860612);
        let p = p * v + k(-1.9204952881501391);
        let p = p * v + k(0.19631729612201423);
        let p = p * z;
        out[56] = p;
    }
    if N > 8 {
        let p = k(3.654585507076297);
        let p = p * v + k(0.9745561352203459);
        let p = p * v + k(-3.261014760160388);
        let p = p * v + k(-0.5520213073625735);
        let p = p * v + k(0.3470010481466383);
        out[72] = p;
    }
    if N > 9 {
        let p = k(7.2978827124136885);
        let p = p * v + k(-1.7171488735091032);
        let p = p * v + k(-5.666591282580041);
        let p = p * v + k(0.8189479242889569);
        let p = p * v + k(0.49653220922798197);
        let p = p * z;
        out[90] = p;
    }
}

#[inline(always)]
fn column_1<T: Real, const N: usize>([c, s]: [T; 2], [z, v]: [T; 2], out: &mut [T]) {
    let k = T::from_f64;
    let p = k(-0.4886025119029199);
    out[1] = p * s;
    out[3] = p * c;
    if N > 2 {
        let p = k(-1.0925484305920792);
        let p = p * z;
        out[5] = p * s;
        out[7] = p * c;
    }
    if N > 3 {
        let p = k(-1.1426144986611644);
        let p = p * v + k(-0.6855686991966986);
        out[11] = p * s;
        out[13] = p * c;
    }
    if N > 4 {
        let p = k(-2.341662902450512);
        let p = p * v + k(-0.33452327177864455);
        let p = p * z;
        out[19] = p * s;
        out[21] = p * c;
    }
    if N > 5 {
        let p = k(-2.377969918777409);
        let p = p * v + k(-1.5853132791849394);
        let p = p * v + k(0.33970998839677274);
        out[29] = p * s;
        out[31] = p * c;
    }
    if N > 6 {
        let p = k(-4.806626240779534);
        let p = p * v + k(-0.8739320437780971);
        let p = p * v + k(1.01958738440778);
        let p = p * z;
        out[41] = p * s;
        out[43] = p * c;
    }
    if N > 7 {
        let p = k(-4.844032456612491);
        let p = p * v + k(-3.3535609315009554);
        let p = p * v + k(1.7275919950156438);
        let p = p * v + k(0.6887785078166946);
        out[55] = p * s;
        out[57] = p * c;
    }
    if N > 8 {
        let p = k(-9.74556135220346);
        let p = p * v + k(-1.9491122704406918);
        let p = p * v + k(4.348019680213851);
        let p = p * v + k(0.3680142049083824);
        let p = p * z;
        out[71] = p * s;
        out[73] = p * c;
    }
    if N > 9 {
        let p = k(-9.791137102066536);
        let p = p * v + k(-6.911390895576377);
        let p = p * v + k(5.759492412980315);
        let p = p * v + k(3.0126575698666263);
        let p = p * v + k(-0.3181817486891223);
        out[89] = p * s;
        out[91] = p * c;
    }
}

#[inline(always)]
fn column_2<T: Real, const N: usize>([c, s]: [T; 2], [z, v]: [T; 2], out: &mut [T]) {
    let k = T::from_f64;
    let p = k(0.5462742152960396);
    out[4] = p * s;
    out[8] = p * c;
    if N > 3 {
        let p = k(1.4453057213202771);
        let p = p * z;
        out[10] = p * s;
        out[14] = p * c;
    }
    if N > 4 {
        let p = k(1.65580571757573);
        let p = p * v + k(1.18271836969695);
        out[18] = p * s;
        out[22] = p * c;
    }
    if N > 5 {
        let p = k(3.595152588729993);
        let p = p * v + k(1.198384196243331);
        let p = p * z;
        out[28] = p * s;
        out[32] = p * c;
    }
    if N > 6 {
        let p = k(3.7999716954990594);
        let p = p * v + k(3.454519723180963);
        let p = p * v + k(0.11515065743936544);
        out[40] = p * s;
        out[44] = p * c;
    }
    if N > 7 {
        let p = k(7.910271877454065);
        let p = p * v + k(3.6508947126711067);
        let p = p * v + k(-0.9403819714455881);
        let p = p * z;
        out[54] = p * s;
        out[58] = p * c;
    }
    if N > 8 {
        let p = k(8.153721619524006);
        let p = p * v + k(8.153721619524006);
        let p = p * v + k(-0.6272093553480005);
        let p = p * v + k(-1.0833616137829098);
        out[70] = p * s;
        out[74] = p * c;
    }
    if N > 9 {
        let p = k(16.699819552772645);
        let p = p * v + k(8.841080939703165);
        let p = p * v + k(-4.911711633168425);
        let p = p * v + k(-1.2846015040594343);
        let p = p * z;
        out[88] = p * s;
        out[92] = p * c;
    }
}

#[inline(always)]
fn column_3<T: Real, const N: usize>([c, s]: [T; 2], [z, v]: [T; 2], out: &mut [T]) {
    let k = T::from_f64;
    let p = k(-0.5900435899266435);
    out[9] = p * s;
    out[15] = p * c;
    if N > 4 {
        let p = k(-1.7701307697799307);
        let p = p * z;
        out[17] = p * s;
        out[23] = p * c;
    }
    if N > 5 {
        let p = k(-2.201572347458627);
        let p = p * v + k(-1.7123340480233764);
        out[27] = p * s;
        out[33] = p * c;
    }
    if N > 6 {
        let p = k(-5.066628927332079);
        let p = p * v + k(-2.3030131487873087);
        let p = p * z;
        out[39] = p * s;
        out[45] = p * c;
    }
    if N > 7 {
        let p = k(-5.5934068855770125);
        let p = p * v + k(-6.023668953698321);
        let p = p * v + k(-0.8996388697081908);
        out[53] = p * s;
        out[59] = p * c;
    }
    if N > 8 {
        let p = k(-12.043845014131556);
        let p = p * v + k(-8.029230009421036);
        let p = p * v + k(0.30881653882388604);
        let p = p * z;
        out[69] = p * s;
        out[75] = p * c;
    }
    if N > 9 {
        let p = k(-12.75469786544737);
        let p = p * v + k(-15.755803245552634);
        let p = p * v + k(-2.2508290350789477);
        let p = p * v + k(1.2119848650425105);
        out[87] = p * s;
        out[93] = p * c;
    }
}

#[inline(always)]
fn column_4<T: Real, const N: usize>([c, s]: [T; 2], [z, v]: [T; 2], out: &mut [T]) {
    let k = T::from_f64;
    let p = k(0.6258357354491761);
    out[16] = p * s;
    out[24] = p * c;
    if N > 5 {
        let p = k(2.0756623148810416);
        let p = p * z;
        out[26] = p * s;
        out[34] = p * c;
    }
    if N > 6 {
        let p = k(2.775106954007983);
        let p = p * v + k(2.2705420532792586);
        out[38] = p * s;
        out[46] = p * c;
    }
    if N > 7 {
        let p = k(6.745902523363385);
        let p = p * v + k(3.6324090510418223);
        let p = p * z;
        out[52] = p * s;
        out[60] = p * c;
    }
    if N > 8 {
        let p = k(7.774268527339124);
        let p = p * v + k(9.329122232806949);
        let p = p * v + k(2.0332702302271555);
        out[68] = p * s;
        out[76] = p * c;
    }
    if N > 9 {
        let p = k(17.33022176459899);
        let p = p * v + k(14.271947335552106);
        let p = p * v + k(1.0194248096822933);
        let p = p * z;
        out[86] = p * s;
        out[94] = p * c;
    }
}

#[inline(always)]
fn column_5<T: Real, const N: usize>([c, s]: [T; 2], [z, v]: [T; 2], out: &mut [T]) {
    let k = T::from_f64;
    let p = k(-0.6563820568401701);
    out[25] = p * s;
    out[35] = p * c;
    if N > 6 {
        let p = k(-2.366619162231752);
        let p = p * z;
        out[37] = p * s;
        out[47] = p * c;
    }
    if N > 7 {
        let p = k(-3.372951261681692);
        let p = p * v + k(-2.854035682961432);
        out[51] = p * s;
        out[61] = p * c;
    }
    if N > 8 {
        let p = k(-8.62477655524527);
        let p = p * v + k(-5.174865933147162);
        let p = p * z;
        out[67] = p * s;
        out[77] = p * c;
    }
    if N > 9 {
        let p = k(-10.356788429579144);
        let p = p * v + k(-13.40290267357301);
        let p = p * v + k(-3.5334925230328844);
        out[85] = p * s;
        out[95] = p * c;
    }
}

#[inline(always)]
fn column_6<T: Real, const N: usize>([c, s]: [T; 2], [z, v]: [T; 2], out: &mut [T]) {
    let k = T::from_f64;
    let p = k(0.6831841051919143);
    out[36] = p * s;
    out[48] = p * c;
    if N > 7 {
        let p = k(2.6459606618019);
        let p = p * z;
        out[50] = p * s;
        out[62] = p * c;
    }
    if N > 8 {
        let p = k(3.9924957454465693);
        let p = p * v + k(3.460162979387027);
        out[66] = p * s;
        out[78] = p * c;
    }
    if N > 9 {
        let p = k(10.696445095454319);
        let p = p * v + k(6.921229179411618);
        let p = p * z;
        out[84] = p * s;
        out[96] = p * c;
    }
}

#[inline(always)]
fn column_7<T: Real, const N: usize>([c, s]: [T; 2], [z, v]: [T; 2], out: &mut [T]) {
    let k = T::from_f64;
    let p = k(-0.7071627325245963);
    out[49] = p * s;
    out[63] = p * c;
    if N > 8 {
        let p = k(-2.9157066406993195);
        let p = p * z;
        out[65] = p * s;
        out[79] = p * c;
    }
    if N > 9 {
        let p = k(-4.631696591424452);
        let p = p * v + k(-4.086791110080399);
        out[83] = p * s;
        out[97] = p * c;
    }
}

#[inline(always)]
fn column_8<T: Real, const N: usize>([c, s]: [T; 2], [z, _]: [T; 2], out: &mut [T]) {
    let k = T::from_f64;
    let p = k(0.7289266601748299);
    out[64] = p * s;
    out[80] = p * c;
    if N > 9 {
        let p = k(3.1773176489546975);
        let p = p * z;
        out[82] = p * s;
        out[98] = p * c;
    }
}

#[inline(always)]
fn column_9<T: Real, const N: usize>([c, s]: [T; 2], _: [T; 2], out: &mut [T]) {
    let k = T::from_f64;
    let p = k(-0.7489009518531884);
    out[81] = p * s;
    out[99] = p * c;
}
