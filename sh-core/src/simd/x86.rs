//! The registers of x86-64, as [`Lanes`]. See the head of the module above for why this is sound.

use core::arch::x86_64::*;
use core::ops::{Add, Mul, Neg, Sub};

use super::{Kernel, Lanes, Registers};

/// Everything that a kernel calls is inlined here and compiled for AVX2 and FMA.
#[target_feature(enable = "avx2,fma")]
pub(super) fn with_avx2<T: Registers, K: Kernel<T>>(kernel: K) -> K::Output {
    kernel.run::<T::Avx2>()
}

/// The same for AVX-512F.
#[target_feature(enable = "avx2,fma,avx512f")]
pub(super) fn with_avx512<T: Registers, K: Kernel<T>>(kernel: K) -> K::Output {
    kernel.run::<T::Avx512>()
}

impl Registers for f32 {
    type Avx2 = F32x8;
    type Avx512 = F32x16;
}

impl Registers for f64 {
    type Avx2 = F64x4;
    type Avx512 = F64x8;
}

/// Rows beyond whole squares, number by number.
mod narrow {
    use super::super::Lanes;

    /// Room for the lanes of a register.
    const LANES: usize = 8;

    #[inline(always)]
    pub(super) fn store<T: crate::Real, V: Lanes<T>>(rows: &[V], stride: usize, out: &mut [T]) {
        for (j, row) in rows.iter().enumerate() {
            let mut lanes = [T::ZERO; LANES];
            row.store(&mut lanes);
            for (d, &lane) in lanes[..V::WIDTH].iter().enumerate() {
                out[d * stride + j] = lane;
            }
        }
    }

    #[inline(always)]
    pub(super) fn load<T: crate::Real, V: Lanes<T>>(rows: &mut [V], stride: usize, values: &[T]) {
        for (j, row) in rows.iter_mut().enumerate() {
            let mut lanes = [T::ZERO; LANES];
            for (d, lane) in lanes[..V::WIDTH].iter_mut().enumerate() {
                *lane = values[d * stride + j];
            }
            *row = V::load(&lanes);
        }
    }
}

/// Rows beyond whole squares, as two halves of half the width: their squares are smaller.
macro_rules! wide {
    ($module:ident, $whole:ident, $half:ident, $scalar:ident, $width:literal, $split:path, $join:path) => {
        mod $module {
            use super::super::Lanes;
            use super::*;

            #[inline(always)]
            pub(super) fn store(rows: &[$whole], stride: usize, out: &mut [$scalar]) {
                if rows.is_empty() {
                    return;
                }
                let mut halves = [[$half::splat(0.0); 2 * $width]; 2];
                for (j, row) in rows.iter().enumerate() {
                    // SAFETY: the feature is there, see the head of the module.
                    let [low, high] = unsafe { $split(row.0) };
                    (halves[0][j], halves[1][j]) = ($half(low), $half(high));
                }
                for (half, rows_of_half) in halves.iter().enumerate() {
                    $half::store_transposed(&rows_of_half[..rows.len()], stride, &mut out[half * $width * stride..]);
                }
            }

            #[inline(always)]
            pub(super) fn load(rows: &mut [$whole], stride: usize, values: &[$scalar]) {
                if rows.is_empty() {
                    return;
                }
                let mut halves = [[$half::splat(0.0); 2 * $width]; 2];
                for (half, rows_of_half) in halves.iter_mut().enumerate() {
                    $half::load_transposed(&mut rows_of_half[..rows.len()], stride, &values[half * $width * stride..]);
                }
                for (j, row) in rows.iter_mut().enumerate() {
                    // SAFETY: the feature is there, see the head of the module.
                    row.0 = unsafe { $join(halves[0][j].0, halves[1][j].0) };
                }
            }
        }
    };
}

wide!(wide_f32, F32x16, F32x8, f32, 8, split_f32x16, join_f32x16);
wide!(wide_f64, F64x8, F64x4, f64, 4, split_f64x8, join_f64x8);

#[inline]
#[target_feature(enable = "avx2,avx512f")]
fn split_f32x16(a: __m512) -> [__m256; 2] {
    let a = _mm512_castps_pd(a);
    [_mm512_castpd512_pd256(a), _mm512_extractf64x4_pd::<1>(a)].map(|half| _mm256_castpd_ps(half))
}

#[inline]
#[target_feature(enable = "avx2,avx512f")]
fn join_f32x16(low: __m256, high: __m256) -> __m512 {
    _mm512_castpd_ps(join_f64x8(_mm256_castps_pd(low), _mm256_castps_pd(high)))
}

#[inline]
#[target_feature(enable = "avx2,avx512f")]
fn split_f64x8(a: __m512d) -> [__m256d; 2] {
    [_mm512_castpd512_pd256(a), _mm512_extractf64x4_pd::<1>(a)]
}

#[inline]
#[target_feature(enable = "avx2,avx512f")]
fn join_f64x8(low: __m256d, high: __m256d) -> __m512d {
    _mm512_insertf64x4::<1>(_mm512_castpd256_pd512(low), high)
}

/// Bytes in a line of the caches.
const LINE: usize = 64;

/// Rows beyond whole squares that are worth no square more.
const FEW_ROWS: usize = 1;

macro_rules! operator {
    ($name:ident, $trait:ident, $method:ident, $intrinsic:ident) => {
        impl $trait for $name {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: the feature is there, see the head of the module.
                Self(unsafe { $intrinsic(self.0, other.0) })
            }
        }
    };
}

/// A register type with its intrinsics.
macro_rules! register {
    ($name:ident, $scalar:ident, $register:ident, $width:literal, $set1:ident, $load:ident, $store:ident, $add:ident,
     $sub:ident, $mul:ident, $fma:ident, $div:ident, $select:path, $directions:path, $transpose:path,
     $rest:ident) => {
        #[doc = concat!(stringify!($width), " numbers of type `", stringify!($scalar), "`.")]
        #[derive(Clone, Copy, Debug)]
        pub struct $name($register);

        operator!($name, Add, add, $add);
        operator!($name, Sub, sub, $sub);
        operator!($name, Mul, mul, $mul);

        impl Neg for $name {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self::splat(-0.0) - self
            }
        }

        impl $name {
            #[inline(always)]
            fn from_array(values: &[$scalar; $width]) -> Self {
                // SAFETY: the array is as long as the register; the feature is there.
                Self(unsafe { $load(values.as_ptr()) })
            }

            #[inline(always)]
            fn to_array(self, out: &mut [$scalar; $width]) {
                // SAFETY: the array is as long as the register; the feature is there.
                unsafe { $store(out.as_mut_ptr(), self.0) }
            }

            #[inline(always)]
            fn load_square(rows: &mut [Self], stride: usize, values: &[$scalar]) {
                let mut columns = [Self::load(values).0; $width];
                for d in 1..$width {
                    columns[d] = Self::load(&values[d * stride..]).0;
                }
                let rows = rows.first_chunk_mut::<$width>().expect("a square");
                // SAFETY: the feature is there, see the head of the module.
                let columns = unsafe { $transpose(columns) };
                for j in 0..$width {
                    rows[j] = Self(columns[j]);
                }
            }
        }

        impl Lanes<$scalar> for $name {
            const WIDTH: usize = $width;

            #[inline(always)]
            fn splat(value: $scalar) -> Self {
                // SAFETY: the feature is there, see the head of the module.
                Self(unsafe { $set1(value) })
            }
            #[inline(always)]
            fn load(values: &[$scalar]) -> Self {
                Self::from_array(values.first_chunk().expect("a whole register"))
            }
            #[inline(always)]
            fn store(self, out: &mut [$scalar]) {
                self.to_array(out.first_chunk_mut().expect("room for a whole register"));
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, summand: Self) -> Self {
                // SAFETY: the feature is there, see the head of the module.
                Self(unsafe { $fma(self.0, factor.0, summand.0) })
            }
            #[inline(always)]
            fn div(self, divisor: Self) -> Self {
                // SAFETY: the feature is there, see the head of the module.
                Self(unsafe { $div(self.0, divisor.0) })
            }
            #[inline(always)]
            fn select_less(self, other: Self, then: Self, otherwise: Self) -> Self {
                // SAFETY: the feature is there, see the head of the module.
                Self(unsafe { $select(self.0, other.0, then.0, otherwise.0) })
            }
            #[inline(always)]
            fn load_directions(directions: &[[$scalar; 3]]) -> [Self; 3] {
                let directions = directions.first_chunk::<$width>().expect("a direction for every lane");
                // SAFETY: the feature is there, see the head of the module.
                unsafe { $directions(directions) }.map(Self)
            }
            #[inline(always)]
            fn prefetch(out: &mut [$scalar]) {
                for line in out.chunks(LINE / size_of::<$scalar>()) {
                    // SAFETY: reads and writes nothing.
                    unsafe { _mm_prefetch::<_MM_HINT_ET0>(line.as_ptr().cast()) };
                }
            }
            #[inline(always)]
            fn store_square(rows: &[Self], stride: usize, out: &mut [$scalar]) {
                let rows = rows.first_chunk::<$width>().expect("a square");
                // SAFETY: the feature is there, see the head of the module.
                let mut registers = [rows[0].0; $width];
                for j in 1..$width {
                    registers[j] = rows[j].0;
                }
                // SAFETY: the feature is there, see the head of the module.
                let columns = unsafe { $transpose(registers) };
                for d in 0..$width {
                    Self(columns[d]).store(&mut out[d * stride..]);
                }
            }
            #[inline(always)]
            fn store_transposed(rows: &[Self], stride: usize, out: &mut [$scalar]) {
                let mut done = 0;
                while rows.len() - done >= $width {
                    Self::store_square(&rows[done..], stride, &mut out[done..]);
                    done += $width;
                }
                // A few rows are written number by number, more of them once more together with some before them.
                if rows.len() - done > FEW_ROWS && rows.len() >= $width {
                    done = rows.len() - $width;
                    Self::store_square(&rows[done..], stride, &mut out[done..]);
                    done = rows.len();
                }
                $rest::store(&rows[done..], stride, &mut out[done..]);
            }
            #[inline(always)]
            fn load_transposed(rows: &mut [Self], stride: usize, values: &[$scalar]) {
                let mut done = 0;
                while rows.len() - done >= $width {
                    Self::load_square(&mut rows[done..], stride, &values[done..]);
                    done += $width;
                }
                if rows.len() - done > FEW_ROWS && rows.len() >= $width {
                    done = rows.len() - $width;
                    Self::load_square(&mut rows[done..], stride, &values[done..]);
                    done = rows.len();
                }
                $rest::load(&mut rows[done..], stride, &values[done..]);
            }
        }
    };
}

register!(
    F32x8,
    f32,
    __m256,
    8,
    _mm256_set1_ps,
    _mm256_loadu_ps,
    _mm256_storeu_ps,
    _mm256_add_ps,
    _mm256_sub_ps,
    _mm256_mul_ps,
    _mm256_fmadd_ps,
    _mm256_div_ps,
    select_f32x8,
    directions_f32x8,
    transpose_f32x8,
    narrow
);
register!(
    F64x4,
    f64,
    __m256d,
    4,
    _mm256_set1_pd,
    _mm256_loadu_pd,
    _mm256_storeu_pd,
    _mm256_add_pd,
    _mm256_sub_pd,
    _mm256_mul_pd,
    _mm256_fmadd_pd,
    _mm256_div_pd,
    select_f64x4,
    directions_f64x4,
    transpose_f64x4,
    narrow
);
register!(
    F32x16,
    f32,
    __m512,
    16,
    _mm512_set1_ps,
    _mm512_loadu_ps,
    _mm512_storeu_ps,
    _mm512_add_ps,
    _mm512_sub_ps,
    _mm512_mul_ps,
    _mm512_fmadd_ps,
    _mm512_div_ps,
    select_f32x16,
    directions_f32x16,
    transpose_f32x16,
    wide_f32
);
register!(
    F64x8,
    f64,
    __m512d,
    8,
    _mm512_set1_pd,
    _mm512_loadu_pd,
    _mm512_storeu_pd,
    _mm512_add_pd,
    _mm512_sub_pd,
    _mm512_mul_pd,
    _mm512_fmadd_pd,
    _mm512_div_pd,
    select_f64x8,
    directions_f64x8,
    transpose_f64x8,
    wide_f64
);

#[inline]
#[target_feature(enable = "avx2")]
fn select_f32x8(a: __m256, b: __m256, then: __m256, otherwise: __m256) -> __m256 {
    _mm256_blendv_ps(otherwise, then, _mm256_cmp_ps::<_CMP_LT_OQ>(a, b))
}

#[inline]
#[target_feature(enable = "avx2")]
fn select_f64x4(a: __m256d, b: __m256d, then: __m256d, otherwise: __m256d) -> __m256d {
    _mm256_blendv_pd(otherwise, then, _mm256_cmp_pd::<_CMP_LT_OQ>(a, b))
}

#[inline]
#[target_feature(enable = "avx512f")]
fn select_f32x16(a: __m512, b: __m512, then: __m512, otherwise: __m512) -> __m512 {
    _mm512_mask_blend_ps(_mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b), otherwise, then)
}

#[inline]
#[target_feature(enable = "avx512f")]
fn select_f64x8(a: __m512d, b: __m512d, then: __m512d, otherwise: __m512d) -> __m512d {
    _mm512_mask_blend_pd(_mm512_cmp_pd_mask::<_CMP_LT_OQ>(a, b), otherwise, then)
}

/// `x y z x y z ...` into three registers: each half register takes four directions from 12 numbers.
#[inline]
#[target_feature(enable = "avx2")]
fn directions_f32x8(directions: &[[f32; 3]; 8]) -> [__m256; 3] {
    let numbers = directions.as_flattened();
    let (low, high) = numbers.split_at(12);
    let load = |k: usize| -> __m256 {
        let (low, high) = (&low[4 * k..4 * k + 4], &high[4 * k..4 * k + 4]);
        // SAFETY: four numbers each.
        let (low, high) = unsafe { (_mm_loadu_ps(low.as_ptr()), _mm_loadu_ps(high.as_ptr())) };
        _mm256_insertf128_ps::<1>(_mm256_castps128_ps256(low), high)
    };
    // a = x0 y0 z0 x1, b = y1 z1 x2 y2, c = z2 x3 y3 z3
    let (a, b, c) = (load(0), load(1), load(2));
    let xy = _mm256_shuffle_ps::<0b10_01_11_10>(b, c); // x2 y2 x3 y3
    let yz = _mm256_shuffle_ps::<0b01_00_10_01>(a, b); // y0 z0 y1 z1
    let x = _mm256_shuffle_ps::<0b10_00_11_00>(a, xy); // x0 x1 x2 x3
    let y = _mm256_shuffle_ps::<0b11_01_10_00>(yz, xy); // y0 y1 y2 y3
    let z = _mm256_shuffle_ps::<0b11_00_11_01>(yz, c); // z0 z1 z2 z3
    [x, y, z]
}

#[inline]
#[target_feature(enable = "avx2,avx512f")]
fn directions_f32x16(directions: &[[f32; 3]; 16]) -> [__m512; 3] {
    let numbers = directions.as_flattened();
    // SAFETY: 48 numbers are three registers.
    let [a, b, c] = [0, 1, 2].map(|k| unsafe { _mm512_loadu_ps(numbers[16 * k..16 * k + 16].as_ptr()) });
    let pick = |[near, far]: &[[i32; 16]; 2]| -> __m512 {
        // SAFETY: 16 indices each.
        let (near, far) = unsafe { (_mm512_loadu_epi32(near.as_ptr()), _mm512_loadu_epi32(far.as_ptr())) };
        _mm512_permutex2var_ps(_mm512_permutex2var_ps(a, near, b), far, c)
    };
    [pick(&PICK_F32[0]), pick(&PICK_F32[1]), pick(&PICK_F32[2])]
}

/// For each component the indices of two permutations: from the first two registers of numbers, and of their result with
/// the third. Component `k` of direction `d` is number `3d + k`.
const PICK_F32: [[[i32; 16]; 2]; 3] = {
    let mut picks = [[[0; 16]; 2]; 3];
    let mut at = 0;
    while at < 48 {
        let (d, k) = (at / 3, at % 3);
        picks[k][0][d] = if at < 32 { at as i32 } else { 0 };
        // Indices below 16 keep the lane of the first result, those above read the third register.
        picks[k][1][d] = if at < 32 { d as i32 } else { 16 + at as i32 - 32 };
        at += 1;
    }
    picks
};

/// The same for eight directions.
const PICK_F64: [[[i64; 8]; 2]; 3] = {
    let mut picks = [[[0; 8]; 2]; 3];
    let mut at = 0;
    while at < 24 {
        let (d, k) = (at / 3, at % 3);
        picks[k][0][d] = if at < 16 { at as i64 } else { 0 };
        picks[k][1][d] = if at < 16 { d as i64 } else { 8 + at as i64 - 16 };
        at += 1;
    }
    picks
};

#[inline]
#[target_feature(enable = "avx2")]
fn directions_f64x4(directions: &[[f64; 3]; 4]) -> [__m256d; 3] {
    let numbers = directions.as_flattened();
    // SAFETY: 12 numbers are three registers.
    let [a, b, c] = [0, 1, 2].map(|k| unsafe { _mm256_loadu_pd(numbers[4 * k..4 * k + 4].as_ptr()) });
    // a = x0 y0 z0 x1, b = y1 z1 x2 y2, c = z2 x3 y3 z3
    let low = _mm256_permute2f128_pd::<0x30>(a, b); // x0 y0 | x2 y2
    let middle = _mm256_permute2f128_pd::<0x21>(a, c); // z0 x1 | z2 x3
    let high = _mm256_permute2f128_pd::<0x30>(b, c); // y1 z1 | y3 z3
    let x = _mm256_shuffle_pd::<0b1010>(low, middle); // x0 x1 | x2 x3
    let y = _mm256_shuffle_pd::<0b0101>(low, high); // y0 y1 | y2 y3
    let z = _mm256_shuffle_pd::<0b1010>(middle, high); // z0 z1 | z2 z3
    [x, y, z]
}

#[inline]
#[target_feature(enable = "avx2,avx512f")]
fn directions_f64x8(directions: &[[f64; 3]; 8]) -> [__m512d; 3] {
    let numbers = directions.as_flattened();
    // SAFETY: 24 numbers are three registers.
    let [a, b, c] = [0, 1, 2].map(|k| unsafe { _mm512_loadu_pd(numbers[8 * k..8 * k + 8].as_ptr()) });
    let pick = |[near, far]: &[[i64; 8]; 2]| -> __m512d {
        // SAFETY: 8 indices each.
        let (near, far) = unsafe { (_mm512_loadu_epi64(near.as_ptr()), _mm512_loadu_epi64(far.as_ptr())) };
        _mm512_permutex2var_pd(_mm512_permutex2var_pd(a, near, b), far, c)
    };
    [pick(&PICK_F64[0]), pick(&PICK_F64[1]), pick(&PICK_F64[2])]
}

#[inline]
#[target_feature(enable = "avx2")]
fn transpose_f32x8(rows: [__m256; 8]) -> [__m256; 8] {
    let [a, b, c, d, e, f, g, h] = rows;
    let pair = |a, b| -> [__m256; 2] { [_mm256_unpacklo_ps(a, b), _mm256_unpackhi_ps(a, b)] };
    let quad = |[al, ah]: [__m256; 2], [bl, bh]: [__m256; 2]| -> [__m256; 4] {
        [
            _mm256_shuffle_ps::<0x44>(al, bl),
            _mm256_shuffle_ps::<0xee>(al, bl),
            _mm256_shuffle_ps::<0x44>(ah, bh),
            _mm256_shuffle_ps::<0xee>(ah, bh),
        ]
    };
    let [p0, p1, p2, p3] = quad(pair(a, b), pair(c, d));
    let [q0, q1, q2, q3] = quad(pair(e, f), pair(g, h));
    let low = |p, q| -> __m256 { _mm256_permute2f128_ps::<0x20>(p, q) };
    let high = |p, q| -> __m256 { _mm256_permute2f128_ps::<0x31>(p, q) };
    [low(p0, q0), low(p1, q1), low(p2, q2), low(p3, q3), high(p0, q0), high(p1, q1), high(p2, q2), high(p3, q3)]
}

#[inline]
#[target_feature(enable = "avx2")]
fn transpose_f64x4([a, b, c, d]: [__m256d; 4]) -> [__m256d; 4] {
    let (p0, p1) = (_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
    let (q0, q1) = (_mm256_unpacklo_pd(c, d), _mm256_unpackhi_pd(c, d));
    [
        _mm256_permute2f128_pd::<0x20>(p0, q0),
        _mm256_permute2f128_pd::<0x20>(p1, q1),
        _mm256_permute2f128_pd::<0x31>(p0, q0),
        _mm256_permute2f128_pd::<0x31>(p1, q1),
    ]
}

#[inline]
#[target_feature(enable = "avx2,avx512f")]
fn transpose_f32x16(rows: [__m512; 16]) -> [__m512; 16] {
    // Within 128 bits: 4×4 blocks of four rows.
    let quad = |r: [__m512; 4]| -> [__m512; 4] {
        let [al, ah, bl, bh] = [
            _mm512_unpacklo_ps(r[0], r[1]),
            _mm512_unpackhi_ps(r[0], r[1]),
            _mm512_unpacklo_ps(r[2], r[3]),
            _mm512_unpackhi_ps(r[2], r[3]),
        ];
        [
            _mm512_shuffle_ps::<0x44>(al, bl),
            _mm512_shuffle_ps::<0xee>(al, bl),
            _mm512_shuffle_ps::<0x44>(ah, bh),
            _mm512_shuffle_ps::<0xee>(ah, bh),
        ]
    };
    let quads: [[__m512; 4]; 4] =
        core::array::from_fn(|q| quad([rows[4 * q], rows[4 * q + 1], rows[4 * q + 2], rows[4 * q + 3]]));
    // Then the 4×4 matrix of 128-bit parts, for each column of a block.
    let mut out = rows;
    for k in 0..4 {
        let [a, b, c, d] = [quads[0][k], quads[1][k], quads[2][k], quads[3][k]];
        let (p, q) = (_mm512_shuffle_f32x4::<0x88>(a, b), _mm512_shuffle_f32x4::<0x88>(c, d));
        let (r, s) = (_mm512_shuffle_f32x4::<0xdd>(a, b), _mm512_shuffle_f32x4::<0xdd>(c, d));
        out[k] = _mm512_shuffle_f32x4::<0x88>(p, q);
        out[4 + k] = _mm512_shuffle_f32x4::<0x88>(r, s);
        out[8 + k] = _mm512_shuffle_f32x4::<0xdd>(p, q);
        out[12 + k] = _mm512_shuffle_f32x4::<0xdd>(r, s);
    }
    out
}

#[inline]
#[target_feature(enable = "avx2,avx512f")]
fn transpose_f64x8(rows: [__m512d; 8]) -> [__m512d; 8] {
    let mut out = rows;
    for k in 0..2 {
        // Rows in pairs: columns k, 2 + k, 4 + k, 6 + k of two rows each.
        let pair = |j: usize| -> __m512d {
            let (a, b) = (rows[2 * j], rows[2 * j + 1]);
            if k == 0 { _mm512_unpacklo_pd(a, b) } else { _mm512_unpackhi_pd(a, b) }
        };
        let [a, b, c, d] = [pair(0), pair(1), pair(2), pair(3)];
        let (p, q) = (_mm512_shuffle_f64x2::<0x88>(a, b), _mm512_shuffle_f64x2::<0x88>(c, d));
        let (r, s) = (_mm512_shuffle_f64x2::<0xdd>(a, b), _mm512_shuffle_f64x2::<0xdd>(c, d));
        out[k] = _mm512_shuffle_f64x2::<0x88>(p, q);
        out[2 + k] = _mm512_shuffle_f64x2::<0x88>(r, s);
        out[4 + k] = _mm512_shuffle_f64x2::<0xdd>(p, q);
        out[6 + k] = _mm512_shuffle_f64x2::<0xdd>(r, s);
    }
    out
}
