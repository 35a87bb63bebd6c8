//! Straight-line rotations of small orders. Written by `tests/rotation_source.rs`: change that program, not this file.
//!
//! Each step is a function of its own, which reads quads and writes quads; see `quad.rs` for the reason.

use super::quad::{Constants, Quad};
use super::turn::{self, Turns};
use super::zyz::Zyz;
use crate::{Order, Real};

/// Rotates an expansion of an order that has a kernel; returns whether it did. Leaves out `s → −s`.
#[inline(always)]
pub(super) fn rotate<T: Real>(order: Order, zyz: &Zyz<T>, coeffs: &[T], out: &mut [T]) -> bool {
    match order.get() {
        1 => out[0] = coeffs[0],
        2 => kernel::<T, 4, 1, 1>(zyz, coeffs, out),
        3 => kernel::<T, 9, 2, 3>(zyz, coeffs, out),
        4 => kernel::<T, 16, 2, 5>(zyz, coeffs, out),
        5 => kernel::<T, 25, 3, 8>(zyz, coeffs, out),
        6 => kernel::<T, 36, 3, 11>(zyz, coeffs, out),
        7 => kernel::<T, 49, 4, 15>(zyz, coeffs, out),
        8 => kernel::<T, 64, 4, 19>(zyz, coeffs, out),
        9 => kernel::<T, 81, 5, 24>(zyz, coeffs, out),
        10 => kernel::<T, 100, 5, 29>(zyz, coeffs, out),
        _ => return false,
    }
    true
}

/// `N2 = N²` for the order `N`; `K` quads in the last band; `Q` quads in all bands from 1.
#[inline(always)]
fn kernel<T: Real, const N2: usize, const K: usize, const Q: usize>(zyz: &Zyz<T>, coeffs: &[T], out: &mut [T]) {
    let coeffs: &[T; N2] = coeffs.try_into().expect("length checked by the caller");
    let out: &mut [T; N2] = out.try_into().expect("length checked by the caller");
    let constants = T::constants();
    let mut turns = [Turns::<T, K>::ZERO; 3];
    // The exchange turns the sense of β.
    let [cos_beta, sin_beta] = zyz.beta;
    turn::fill(&mut turns, zyz.alpha, [cos_beta, -sin_beta], zyz.gamma, constants);
    let (mut a, mut b) = ([Quad::ZERO; Q], [Quad::ZERO; Q]);
    gamma_and_exchange(&turns[2], constants, coeffs, &mut a);
    beta_and_exchange(&turns[1], constants, &a, &mut b);
    out[0] = coeffs[0];
    alpha(&turns[0], &b, out);
}

/// `E Z(γ)`, but for the swap of lanes.
#[inline(never)]
fn gamma_and_exchange<T: Real, const N2: usize, const K: usize, const Q: usize>(
    gamma: &Turns<T, K>,
    constants: &Constants<T>,
    coeffs: &[T; N2],
    out: &mut [Quad<T>; Q],
) {
    let e = &constants.exchange;
    if Q > 0 {
        let band = &coeffs[1..4];
        let v0 = gamma.turn(0, Quad::load(1, 0, band));
        out[0] = v0 * e[0];
    }
    if Q > 1 {
        let band = &coeffs[4..9];
        let v0 = gamma.turn(0, Quad::load(2, 0, band));
        let v1 = gamma.turn(1, Quad::load(2, 1, band));
        out[1] = v0 * e[1] + v1 * e[2];
        out[2] = v0 * e[3] + v1 * e[4];
    }
    if Q > 3 {
        let band = &coeffs[9..16];
        let v0 = gamma.turn(0, Quad::load(3, 0, band));
        let v1 = gamma.turn(1, Quad::load(3, 1, band));
        out[3] = v0 * e[5] + v1 * e[6];
        out[4] = v0 * e[7] + v1 * e[8];
    }
    if Q > 5 {
        let band = &coeffs[16..25];
        let v0 = gamma.turn(0, Quad::load(4, 0, band));
        let v1 = gamma.turn(1, Quad::load(4, 1, band));
        let v2 = gamma.turn(2, Quad::load(4, 2, band));
        out[5] = v0 * e[9] + v1 * e[10] + v2 * e[11];
        out[6] = v0 * e[12] + v1 * e[13] + v2 * e[14];
        out[7] = v0 * e[15] + v1 * e[16] + v2 * e[17];
    }
    if Q > 8 {
        let band = &coeffs[25..36];
        let v0 = gamma.turn(0, Quad::load(5, 0, band));
        let v1 = gamma.turn(1, Quad::load(5, 1, band));
        let v2 = gamma.turn(2, Quad::load(5, 2, band));
        out[8] = v0 * e[18] + v1 * e[19] + v2 * e[20];
        out[9] = v0 * e[21] + v1 * e[22] + v2 * e[23];
        out[10] = v0 * e[24] + v1 * e[25] + v2 * e[26];
    }
    if Q > 11 {
        let band = &coeffs[36..49];
        let v0 = gamma.turn(0, Quad::load(6, 0, band));
        let v1 = gamma.turn(1, Quad::load(6, 1, band));
        let v2 = gamma.turn(2, Quad::load(6, 2, band));
        let v3 = gamma.turn(3, Quad::load(6, 3, band));
        out[11] = v0 * e[27] + v1 * e[28] + v2 * e[29] + v3 * e[30];
        out[12] = v0 * e[31] + v1 * e[32] + v2 * e[33] + v3 * e[34];
        out[13] = v0 * e[35] + v1 * e[36] + v2 * e[37] + v3 * e[38];
        out[14] = v0 * e[39] + v1 * e[40] + v2 * e[41] + v3 * e[42];
    }
    if Q > 15 {
        let band = &coeffs[49..64];
        let v0 = gamma.turn(0, Quad::load(7, 0, band));
        let v1 = gamma.turn(1, Quad::load(7, 1, band));
        let v2 = gamma.turn(2, Quad::load(7, 2, band));
        let v3 = gamma.turn(3, Quad::load(7, 3, band));
        out[15] = v0 * e[43] + v1 * e[44] + v2 * e[45] + v3 * e[46];
        out[16] = v0 * e[47] + v1 * e[48] + v2 * e[49] + v3 * e[50];
        out[17] = v0 * e[51] + v1 * e[52] + v2 * e[53] + v3 * e[54];
        out[18] = v0 * e[55] + v1 * e[56] + v2 * e[57] + v3 * e[58];
    }
    if Q > 19 {
        let band = &coeffs[64..81];
        let v0 = gamma.turn(0, Quad::load(8, 0, band));
        let v1 = gamma.turn(1, Quad::load(8, 1, band));
        let v2 = gamma.turn(2, Quad::load(8, 2, band));
        let v3 = gamma.turn(3, Quad::load(8, 3, band));
        let v4 = gamma.turn(4, Quad::load(8, 4, band));
        out[19] = v0 * e[59] + v1 * e[60] + v2 * e[61] + v3 * e[62] + v4 * e[63];
        out[20] = v0 * e[64] + v1 * e[65] + v2 * e[66] + v3 * e[67] + v4 * e[68];
        out[21] = v0 * e[69] + v1 * e[70] + v2 * e[71] + v3 * e[72] + v4 * e[73];
        out[22] = v0 * e[74] + v1 * e[75] + v2 * e[76] + v3 * e[77] + v4 * e[78];
        out[23] = v0 * e[79] + v1 * e[80] + v2 * e[81] + v3 * e[82] + v4 * e[83];
    }
    if Q > 24 {
        let band = &coeffs[81..100];
        let v0 = gamma.turn(0, Quad::load(9, 0, band));
        let v1 = gamma.turn(1, Quad::load(9, 1, band));
        let v2 = gamma.turn(2, Quad::load(9, 2, band));
        let v3 = gamma.turn(3, Quad::load(9, 3, band));
        let v4 = gamma.turn(4, Quad::load(9, 4, band));
        out[24] = v0 * e[84] + v1 * e[85] + v2 * e[86] + v3 * e[87] + v4 * e[88];
        out[25] = v0 * e[89] + v1 * e[90] + v2 * e[91] + v3 * e[92] + v4 * e[93];
        out[26] = v0 * e[94] + v1 * e[95] + v2 * e[96] + v3 * e[97] + v4 * e[98];
        out[27] = v0 * e[99] + v1 * e[100] + v2 * e[101] + v3 * e[102] + v4 * e[103];
        out[28] = v0 * e[104] + v1 * e[105] + v2 * e[106] + v3 * e[107] + v4 * e[108];
    }
}

/// `E Z(−β)`, but for the last swap of lanes.
#[inline(never)]
fn beta_and_exchange<T: Real, const K: usize, const Q: usize>(
    beta: &Turns<T, K>,
    constants: &Constants<T>,
    quads: &[Quad<T>; Q],
    out: &mut [Quad<T>; Q],
) {
    let e = &constants.exchange;
    if Q > 0 {
        let v0 = beta.turn(0, quads[0].after_odd_band());
        out[0] = v0 * e[0];
    }
    if Q > 1 {
        let v0 = beta.turn(0, quads[1].after_even_band());
        let v1 = beta.turn(1, quads[2].after_even_band());
        out[1] = v0 * e[1] + v1 * e[2];
        out[2] = v0 * e[3] + v1 * e[4];
    }
    if Q > 3 {
        let v0 = beta.turn(0, quads[3].after_odd_band());
        let v1 = beta.turn(1, quads[4].after_odd_band());
        out[3] = v0 * e[5] + v1 * e[6];
        out[4] = v0 * e[7] + v1 * e[8];
    }
    if Q > 5 {
        let v0 = beta.turn(0, quads[5].after_even_band());
        let v1 = beta.turn(1, quads[6].after_even_band());
        let v2 = beta.turn(2, quads[7].after_even_band());
        out[5] = v0 * e[9] + v1 * e[10] + v2 * e[11];
        out[6] = v0 * e[12] + v1 * e[13] + v2 * e[14];
        out[7] = v0 * e[15] + v1 * e[16] + v2 * e[17];
    }
    if Q > 8 {
        let v0 = beta.turn(0, quads[8].after_odd_band());
        let v1 = beta.turn(1, quads[9].after_odd_band());
        let v2 = beta.turn(2, quads[10].after_odd_band());
        out[8] = v0 * e[18] + v1 * e[19] + v2 * e[20];
        out[9] = v0 * e[21] + v1 * e[22] + v2 * e[23];
        out[10] = v0 * e[24] + v1 * e[25] + v2 * e[26];
    }
    if Q > 11 {
        let v0 = beta.turn(0, quads[11].after_even_band());
        let v1 = beta.turn(1, quads[12].after_even_band());
        let v2 = beta.turn(2, quads[13].after_even_band());
        let v3 = beta.turn(3, quads[14].after_even_band());
        out[11] = v0 * e[27] + v1 * e[28] + v2 * e[29] + v3 * e[30];
        out[12] = v0 * e[31] + v1 * e[32] + v2 * e[33] + v3 * e[34];
        out[13] = v0 * e[35] + v1 * e[36] + v2 * e[37] + v3 * e[38];
        out[14] = v0 * e[39] + v1 * e[40] + v2 * e[41] + v3 * e[42];
    }
    if Q > 15 {
        let v0 = beta.turn(0, quads[15].after_odd_band());
        let v1 = beta.turn(1, quads[16].after_odd_band());
        let v2 = beta.turn(2, quads[17].after_odd_band());
        let v3 = beta.turn(3, quads[18].after_odd_band());
        out[15] = v0 * e[43] + v1 * e[44] + v2 * e[45] + v3 * e[46];
        out[16] = v0 * e[47] + v1 * e[48] + v2 * e[49] + v3 * e[50];
        out[17] = v0 * e[51] + v1 * e[52] + v2 * e[53] + v3 * e[54];
        out[18] = v0 * e[55] + v1 * e[56] + v2 * e[57] + v3 * e[58];
    }
    if Q > 19 {
        let v0 = beta.turn(0, quads[19].after_even_band());
        let v1 = beta.turn(1, quads[20].after_even_band());
        let v2 = beta.turn(2, quads[21].after_even_band());
        let v3 = beta.turn(3, quads[22].after_even_band());
        let v4 = beta.turn(4, quads[23].after_even_band());
        out[19] = v0 * e[59] + v1 * e[60] + v2 * e[61] + v3 * e[62] + v4 * e[63];
        out[20] = v0 * e[64] + v1 * e[65] + v2 * e[66] + v3 * e[67] + v4 * e[68];
        out[21] = v0 * e[69] + v1 * e[70] + v2 * e[71] + v3 * e[72] + v4 * e[73];
        out[22] = v0 * e[74] + v1 * e[75] + v2 * e[76] + v3 * e[77] + v4 * e[78];
        out[23] = v0 * e[79] + v1 * e[80] + v2 * e[81] + v3 * e[82] + v4 * e[83];
    }
    if Q > 24 {
        let v0 = beta.turn(0, quads[24].after_odd_band());
        let v1 = beta.turn(1, quads[25].after_odd_band());
        let v2 = beta.turn(2, quads[26].after_odd_band());
        let v3 = beta.turn(3, quads[27].after_odd_band());
        let v4 = beta.turn(4, quads[28].after_odd_band());
        out[24] = v0 * e[84] + v1 * e[85] + v2 * e[86] + v3 * e[87] + v4 * e[88];
        out[25] = v0 * e[89] + v1 * e[90] + v2 * e[91] + v3 * e[92] + v4 * e[93];
        out[26] = v0 * e[94] + v1 * e[95] + v2 * e[96] + v3 * e[97] + v4 * e[98];
        out[27] = v0 * e[99] + v1 * e[100] + v2 * e[101] + v3 * e[102] + v4 * e[103];
        out[28] = v0 * e[104] + v1 * e[105] + v2 * e[106] + v3 * e[107] + v4 * e[108];
    }
}

/// `Z(α)`, and back to coefficients.
#[inline(never)]
fn alpha<T: Real, const N2: usize, const K: usize, const Q: usize>(
    alpha: &Turns<T, K>,
    quads: &[Quad<T>; Q],
    out: &mut [T; N2],
) {
    if Q > 0 {
        let band = &mut out[1..4];
        alpha.turn(0, quads[0].after_odd_band()).store(1, 0, band);
    }
    if Q > 1 {
        let band = &mut out[4..9];
        alpha.turn(0, quads[1].after_even_band()).store(2, 0, band);
        alpha.turn(1, quads[2].after_even_band()).store(2, 1, band);
    }
    if Q > 3 {
        let band = &mut out[9..16];
        alpha.turn(0, quads[3].after_odd_band()).store(3, 0, band);
        alpha.turn(1, quads[4].after_odd_band()).store(3, 1, band);
    }
    if Q > 5 {
        let band = &mut out[16..25];
        alpha.turn(0, quads[5].after_even_band()).store(4, 0, band);
        alpha.turn(1, quads[6].after_even_band()).store(4, 1, band);
        alpha.turn(2, quads[7].after_even_band()).store(4, 2, band);
    }
    if Q > 8 {
        let band = &mut out[25..36];
        alpha.turn(0, quads[8].after_odd_band()).store(5, 0, band);
        alpha.turn(1, quads[9].after_odd_band()).store(5, 1, band);
        alpha.turn(2, quads[10].after_odd_band()).store(5, 2, band);
    }
    if Q > 11 {
        let band = &mut out[36..49];
        alpha.turn(0, quads[11].after_even_band()).store(6, 0, band);
        alpha.turn(1, quads[12].after_even_band()).store(6, 1, band);
        alpha.turn(2, quads[13].after_even_band()).store(6, 2, band);
        alpha.turn(3, quads[14].after_even_band()).store(6, 3, band);
    }
    if Q > 15 {
        let band = &mut out[49..64];
        alpha.turn(0, quads[15].after_odd_band()).store(7, 0, band);
        alpha.turn(1, quads[16].after_odd_band()).store(7, 1, band);
        alpha.turn(2, quads[17].after_odd_band()).store(7, 2, band);
        alpha.turn(3, quads[18].after_odd_band()).store(7, 3, band);
    }
    if Q > 19 {
        let band = &mut out[64..81];
        alpha.turn(0, quads[19].after_even_band()).store(8, 0, band);
        alpha.turn(1, quads[20].after_even_band()).store(8, 1, band);
        alpha.turn(2, quads[21].after_even_band()).store(8, 2, band);
        alpha.turn(3, quads[22].after_even_band()).store(8, 3, band);
        alpha.turn(4, quads[23].after_even_band()).store(8, 4, band);
    }
    if Q > 24 {
        let band = &mut out[81..100];
        alpha.turn(0, quads[24].after_odd_band()).store(9, 0, band);
        alpha.turn(1, quads[25].after_odd_band()).store(9, 1, band);
        alpha.turn(2, quads[26].after_odd_band()).store(9, 2, band);
        alpha.turn(3, quads[27].after_odd_band()).store(9, 3, band);
        alpha.turn(4, quads[28].after_odd_band()).store(9, 4, band);
    }
}

/// Factors of the exchange of y and z: for each band, those of its quads `i, j`.
pub(super) const EXCHANGE: [[f64; 4]; FACTOR_COUNT] = [
    [-1.0, 1.0, -1.0, 0.0],
    [-0.5, 0.0, 1.0, 0.0],
    [-0.8660254037844386, 0.0, 0.0, -1.0],
    [-0.8660254037844386, -1.0, 0.0, 0.0],
    [0.5, 0.0, 0.0, 0.0],
    [0.6123724356957945, -0.25, 0.6123724356957945, 0.0],
    [0.7905694150420949, -0.9682458365518541, 0.7905694150420949, 0.0],
    [0.7905694150420949, -0.9682458365518543, 0.7905694150420949, 0.0],
    [-0.6123724356957945, 0.25, -0.6123724356957945, 1.0],
    [0.375, 0.0, -0.75, 0.0],
    [0.5590169943749475, 0.0, -0.6614378277661476, 0.3535533905932738],
    [0.7395099728874519, 0.0, 0.0, 0.9354143466934854],
    [0.5590169943749475, 0.3535533905932738, -0.6614378277661477, 0.0],
    [0.5, 0.9354143466934854, 0.75, 0.9354143466934853],
    [-0.6614378277661476, 0.0, 0.0, -0.3535533905932738],
    [0.739509972887452, 0.9354143466934853, 0.0, 0.0],
    [-0.6614378277661477, -0.3535533905932738, 0.0, 0.0],
    [0.125, 0.0, 0.0, 0.0],
    [-0.4841229182759271, 0.125, -0.4841229182759271, 0.0],
    [-0.6614378277661476, 0.4050462936504913, -0.5229125165837972, 0.0],
    [-0.57282196186948, 0.9057110466368399, -0.701560760020114, 0.0],
    [-0.5229125165837972, 0.4050462936504913, -0.6614378277661477, 0.0],
    [-0.30618621784789724, 0.8125, -0.30618621784789724, -0.5],
    [0.795495128834866, -0.4192627457812106, 0.6846531968814575, -0.8660254037844386],
    [-0.701560760020114, 0.9057110466368399, -0.57282196186948, 0.0],
    [0.6846531968814576, -0.4192627457812106, 0.795495128834866, -0.8660254037844386],
    [-0.19764235376052372, 0.0625, -0.19764235376052372, 0.5],
    [-0.3125, 0.0, 0.625, 0.0],
    [-0.45285552331841994, 0.0, 0.5929270612815711, -0.19764235376052372],
    [-0.4960783708246107, 0.0, 0.5077524002897476, -0.4330127018922193],
    [-0.6716932893813962, 0.0, 0.0, -0.8794529549668931],
    [-0.45285552331841994, -0.19764235376052372, 0.5929270612815711, 0.0],
    [-0.53125, -0.5625, 0.0625, -0.5625],
    [-0.17116329922036438, -0.8028270361665706, -0.8028270361665705, -0.6846531968814575],
    [0.6952686081652184, 0.0, 0.0, 0.46351240544347894],
    [-0.49607837082461076, -0.4330127018922193, 0.5077524002897476, 0.0],
    [-0.1711632992203644, -0.6846531968814576, -0.8028270361665706, -0.8028270361665706],
    [0.8125, 0.5863019699779287, 0.3125, 0.5863019699779287],
    [-0.2538762001448738, 0.0, 0.0, -0.10825317547305482],
    [-0.6716932893813962, -0.879452954966893, 0.0, 0.0],
    [0.6952686081652184, 0.46351240544347894, 0.0, 0.0],
    [-0.2538762001448738, -0.10825317547305482, 0.0, 0.0],
    [0.03125, 0.0, 0.0, 0.0],
    [0.41339864235384227, -0.078125, 0.41339864235384227, 0.0],
    [0.5740991584648074, -0.24356964481437335, 0.42961647140211, 0.0],
    [0.5385527481129402, -0.44879395676078354, 0.47495887979908324, 0.0],
    [0.4576818286211503, -0.8562442974262661, 0.6472598492877494, 0.0],
    [0.42961647140210996, -0.24356964481437335, 0.5740991584648073, 0.0],
    [0.4198446513295126, -0.609375, 0.4198446513295126, 0.3125],
    [-0.10364452469860624, -0.5700448858423344, 0.07328774624724109, 0.5863019699779287],
    [-0.7927281808728638, 0.4943528756111367, -0.6991205412874092, 0.7473912964438374],
    [0.47495887979908324, -0.4487939567607835, 0.5385527481129402, 0.0],
    [0.07328774624724109, -0.5700448858423344, -0.10364452469860624, 0.5863019699779287],
    [-0.78125, 0.671875, -0.78125, 0.5],
    [0.3983608994994363, -0.14905300022139775, 0.2981060004427955, -0.6373774391990982],
    [0.6472598492877494, -0.8562442974262661, 0.4576818286211503, 0.0],
    [-0.6991205412874092, 0.4943528756111367, -0.7927281808728639, 0.7473912964438374],
    [0.2981060004427955, -0.14905300022139775, 0.3983608994994363, -0.6373774391990981],
    [-0.05846339666834283, 0.015625, -0.05846339666834284, 0.1875],
    [0.2734375, 0.0, -0.546875, 0.0],
    [0.39218438743784795, 0.0, -0.5310201708739509, 0.1307281291459493],
    [0.4113264556590058, 0.0, -0.4943528756111367, 0.2742176371060038],
    [0.4576818286211503, 0.0, -0.4178044361600293, 0.4576818286211503],
    [0.626706654240044, 0.0, 0.0, 0.8356088723200586],
    [0.3921843874378479, 0.1307281291459493, -0.5310201708739509, 0.0],
    [0.5, 0.38081430021731066, -0.265625, 0.3808143002173106],
    [0.32775276505317236, 0.5908647000371574, 0.2181912506838897, 0.6051536478449089],
    [0.0, 0.6991205412874092, 0.7745021082121081, 0.47134697278119864],
    [-0.6991205412874092, 0.0, 0.0, -0.516334738808072],
    [0.4113264556590057, 0.2742176371060038, -0.49435287561113667, 0.0],
    [0.3277527650531724, 0.6051536478449089, 0.2181912506838897, 0.5908647000371574],
    [-0.28125, 0.338020432074749, 0.703125, 0.33802043207474897],
    [-0.7302075903467451, -0.6665852814906732, -0.4621937330546575, -0.7088310138883597],
    [0.3332926407453366, 0.0, 0.0, 0.18487749322186298],
    [0.4576818286211503, 0.45768182862115026, -0.4178044361600293, 0.0],
    [0.0, 0.47134697278119864, 0.774502108212108, 0.6991205412874092],
    [-0.7302075903467451, -0.7088310138883598, -0.4621937330546575, -0.6665852814906732],
    [0.5, 0.2567449488305466, 0.109375, 0.2567449488305466],
    [-0.08558164961018219, 0.0, 0.0, -0.03125],
    [0.6267066542400439, 0.8356088723200586, 0.0, 0.0],
    [-0.6991205412874092, -0.516334738808072, 0.0, 0.0],
    [0.3332926407453366, 0.184877493221863, 0.0, 0.0],
    [-0.0855816496101822, -0.03125, 0.0, 0.0],
    [0.0078125, 0.0, 0.0, 0.0],
    [-0.36685490255855924, 0.0546875, -0.36685490255855924, 0.0],
    [-0.5130142237306876, 0.16792332234534904, -0.3754879637718099, 0.0],
    [-0.4943528756111367, 0.2954323500185787, -0.396364090436432, 0.0],
    [-0.4576818286211503, 0.4624247721758372, -0.44314852502786806, 0.0],
    [-0.38519665736315783, 0.8171255055356399, -0.6090493921755238, 0.0],
    [-0.37548796377180993, 0.16792332234534904, -0.5130142237306876, 0.0],
    [-0.42961647140210996, 0.453125, -0.42961647140211, -0.21875],
    [-0.1379962635363726, 0.5772797875597239, -0.25194555463432966, -0.4215855488510013],
    [0.2981060004427955, 0.38725105410605404, 0.05633673867912484, -0.5854685623498498],
    [0.7526807559068452, -0.5322256665703468, 0.6968469725305548, -0.656993626300895],
    [-0.39636409043643195, 0.2954323500185787, -0.49435287561113667, 0.0],
    [-0.2519455546343297, 0.577279787559724, -0.1379962635363726, -0.4215855488510013],
    [0.3921843874378479, 0.140625, 0.3921843874378479, -0.5625],
    [0.6051536478449088, -0.7162405240429014, 0.6723290616859426, -0.20252314682524564],
    [-0.509312687906457, 0.216083073217802, -0.3615761395439417, 0.6817945071647322],
    [-0.44314852502786806, 0.4624247721758373, -0.4576818286211503, 0.0],
    [0.05633673867912483, 0.38725105410605404, 0.2981060004427955, -0.5854685623498499],
    [0.6723290616859425, -0.7162405240429014, 0.6051536478449089, -0.20252314682524564],
    [-0.5683291712335379, 0.34765625, -0.5683291712335379, 0.71875],
    [0.1594400908746762, -0.04831764405020696, 0.11158481919598202, -0.3156095293238149],
    [-0.6090493921755238, 0.8171255055356399, -0.38519665736315783, 0.0],
    [0.6968469725305549, -0.5322256665703469, 0.7526807559068451, -0.656993626300895],
    [-0.3615761395439417, 0.21608307321780204, -0.509312687906457, 0.6817945071647321],
    [0.11158481919598204, -0.048317644050206957, 0.1594400908746762, -0.315609529323815],
    [-0.016572815184059706, 0.00390625, -0.016572815184059706, 0.0625],
];

/// Quads of factors.
pub(super) const FACTOR_COUNT: usize = 109;
