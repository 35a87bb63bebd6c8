//! Several numbers at once: kernels written once, run with the widest registers of the machine.
//!
//! A [`Kernel`] is generic over [`Lanes`], which a scalar is too (of width 1). [`dispatch`] picks the implementation when
//! the program runs, so nothing has to be compiled for a given machine:
//!
//! | level | registers | where |
//! |---|---|---|
//! | portable | four numbers in an array, which compilers map to SSE2 or NEON | everywhere |
//! | AVX2 and FMA | 256 bits | x86-64, if detected (needs the feature `std`) |
//! | AVX-512F | 512 bits | the same |
//!
//! Results of the levels differ by rounding only: the x86 ones fuse `a·b + c`.
//!
//! # Soundness
//!
//! This is the one module with `unsafe` code, in two places. (1) The methods of the x86 registers call intrinsics that need
//! a CPU feature. Their types are private to this module; they reach a kernel only as the type parameter of
//! [`Kernel::run`], which only [`run_at`] names, after the feature was detected. (2) Loads and stores go through pointers:
//! each is preceded by an assertion of the slice's length, or has an array reference of that length.

use core::ops::{Add, Mul, Neg, Sub};

use crate::Real;

/// Numbers that are worked on at once.
#[cfg_attr(
    not(all(target_arch = "x86_64", feature = "std")),
    allow(
        unreachable_pub,
        reason = "public in name as the bound of the registers of a sealed trait, where there are some"
    )
)]
pub trait Lanes<T>:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self> + core::fmt::Debug
{
    /// How many.
    const WIDTH: usize;
    /// The same number in every lane.
    fn splat(value: T) -> Self;
    /// The first [`Self::WIDTH`] numbers. Panics if there are fewer.
    fn load(values: &[T]) -> Self;
    /// Writes the first [`Self::WIDTH`] numbers. Panics if there is less room.
    fn store(self, out: &mut [T]);
    /// `self · factor + summand`, fused where the machine can.
    fn mul_add(self, factor: Self, summand: Self) -> Self;
    /// `self / divisor`.
    fn div(self, divisor: Self) -> Self;
    /// In each lane `then` where `self < other`, else `otherwise`; a NaN is not less.
    fn select_less(self, other: Self, then: Self, otherwise: Self) -> Self;
    /// The components of the first [`Self::WIDTH`] directions. Panics if there are fewer.
    fn load_directions(directions: &[[T; 3]]) -> [Self; 3];
    /// Asks for memory that will be written soon.
    #[inline(always)]
    fn prefetch(_: &mut [T]) {}
    /// Writes lane `d` of `rows[j]` to `out[d · stride + j]`, for [`Self::WIDTH`] rows. Panics if there are fewer, or `out`
    /// ends before that.
    fn store_square(rows: &[Self], stride: usize, out: &mut [T]);
    /// The same for any number of rows.
    fn store_transposed(rows: &[Self], stride: usize, out: &mut [T]);
    /// Reads `values[d · stride + j]` into lane `d` of `rows[j]`. Panics if `values` ends before that.
    fn load_transposed(rows: &mut [Self], stride: usize, values: &[T]);
}

/// Work that can be done in lanes of any width. `run` and what it calls must be `#[inline(always)]`: a function that is not
/// inlined is compiled without the CPU features.
pub(crate) trait Kernel<T> {
    /// The result.
    type Output;
    /// Does the work.
    fn run<V: Lanes<T>>(self) -> Self::Output;
}

/// What [`dispatch`] can choose from, from the plainest to the widest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Level {
    Portable,
    #[cfg(all(target_arch = "x86_64", feature = "std"))]
    Avx2,
    #[cfg(all(target_arch = "x86_64", feature = "std"))]
    Avx512,
}

impl Level {
    /// The widest that this machine has.
    #[inline]
    fn best() -> Self {
        #[cfg(all(target_arch = "x86_64", feature = "std"))]
        if std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma") {
            return if std::is_x86_feature_detected!("avx512f") { Self::Avx512 } else { Self::Avx2 };
        }
        Self::Portable
    }

    /// The same without registers of 512 bits.
    #[inline]
    fn narrow(self) -> Self {
        match self {
            #[cfg(all(target_arch = "x86_64", feature = "std"))]
            Self::Avx512 => Self::Avx2,
            level => level,
        }
    }

    /// All that this machine has.
    #[cfg(test)]
    pub(crate) fn available() -> impl Iterator<Item = Self> {
        let levels = [
            Self::Portable,
            #[cfg(all(target_arch = "x86_64", feature = "std"))]
            Self::Avx2,
            #[cfg(all(target_arch = "x86_64", feature = "std"))]
            Self::Avx512,
        ];
        let count = levels.iter().position(|&level| level == Self::best()).map_or(1, |best| best + 1);
        levels.into_iter().take(count)
    }
}

/// Runs a kernel with the widest registers of this machine.
#[inline]
pub(crate) fn dispatch<T: Real, K: Kernel<T>>(kernel: K) -> K::Output {
    run_at(Level::best(), kernel)
}

/// Runs a kernel with registers of at most eight numbers.
#[inline]
pub(crate) fn dispatch_narrow<T: Real, K: Kernel<T>>(kernel: K) -> K::Output {
    run_at(Level::best().narrow(), kernel)
}

/// Runs a kernel at a level. One that the machine does not have is replaced by the portable one.
#[inline]
#[cfg_attr(all(target_arch = "x86_64", feature = "std"), expect(unsafe_code, reason = "see the head of this module"))]
pub(crate) fn run_at<T: Real, K: Kernel<T>>(level: Level, kernel: K) -> K::Output {
    match level {
        // SAFETY: the features that the function is compiled for are detected right here.
        #[cfg(all(target_arch = "x86_64", feature = "std"))]
        Level::Avx512 if Level::best() == Level::Avx512 => unsafe { x86::with_avx512::<T, K>(kernel) },
        // SAFETY: as above; every machine of a wider level has this one.
        #[cfg(all(target_arch = "x86_64", feature = "std"))]
        Level::Avx2 if Level::best() != Level::Portable => unsafe { x86::with_avx2::<T, K>(kernel) },
        _ => kernel.run::<Four<T>>(),
    }
}

/// The registers of a scalar type.
pub trait Registers: Sized {
    /// 256 bits.
    #[cfg(all(target_arch = "x86_64", feature = "std"))]
    type Avx2: Lanes<Self>;
    /// 512 bits.
    #[cfg(all(target_arch = "x86_64", feature = "std"))]
    type Avx512: Lanes<Self>;
}

#[cfg(not(all(target_arch = "x86_64", feature = "std")))]
impl Registers for f32 {}
#[cfg(not(all(target_arch = "x86_64", feature = "std")))]
impl Registers for f64 {}

/// A scalar is one lane. Not fused: without hardware for it, `mul_add` is a slow function call.
impl<T: Real> Lanes<T> for T {
    const WIDTH: usize = 1;

    #[inline(always)]
    fn splat(value: T) -> Self {
        value
    }
    #[inline(always)]
    fn load(values: &[T]) -> Self {
        values[0]
    }
    #[inline(always)]
    fn store(self, out: &mut [T]) {
        out[0] = self;
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, summand: Self) -> Self {
        self * factor + summand
    }
    #[inline(always)]
    fn div(self, divisor: Self) -> Self {
        self / divisor
    }
    #[inline(always)]
    fn select_less(self, other: Self, then: Self, otherwise: Self) -> Self {
        if self < other { then } else { otherwise }
    }
    #[inline(always)]
    fn load_directions(directions: &[[T; 3]]) -> [Self; 3] {
        directions[0]
    }
    #[inline(always)]
    fn store_square(rows: &[Self], _: usize, out: &mut [T]) {
        out[0] = rows[0];
    }
    #[inline(always)]
    fn store_transposed(rows: &[Self], _: usize, out: &mut [T]) {
        out[..rows.len()].copy_from_slice(rows);
    }
    #[inline(always)]
    fn load_transposed(rows: &mut [Self], _: usize, values: &[T]) {
        rows.copy_from_slice(&values[..rows.len()]);
    }
}

/// Four numbers, for every machine.
#[derive(Clone, Copy, Debug)]
#[repr(align(16))]
struct Four<T>([T; 4]);

impl<T: Real> Four<T> {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(T, T) -> T) -> Self {
        let ([a, b, c, d], [e, g, h, i]) = (self.0, other.0);
        Self([f(a, e), f(b, g), f(c, h), f(d, i)])
    }
}

impl<T: Real> Add for Four<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl<T: Real> Sub for Four<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl<T: Real> Mul for Four<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl<T: Real> Neg for Four<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0.map(|a| -a))
    }
}

impl<T: Real> Lanes<T> for Four<T> {
    const WIDTH: usize = 4;

    #[inline(always)]
    fn splat(value: T) -> Self {
        Self([value; 4])
    }
    #[inline(always)]
    fn load(values: &[T]) -> Self {
        Self([values[0], values[1], values[2], values[3]])
    }
    #[inline(always)]
    fn store(self, out: &mut [T]) {
        out[..4].copy_from_slice(&self.0);
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, summand: Self) -> Self {
        self * factor + summand
    }
    #[inline(always)]
    fn div(self, divisor: Self) -> Self {
        self.zip(divisor, |a, b| a / b)
    }
    #[inline(always)]
    fn select_less(self, other: Self, then: Self, otherwise: Self) -> Self {
        Self(core::array::from_fn(|d| if self.0[d] < other.0[d] { then.0[d] } else { otherwise.0[d] }))
    }
    #[inline(always)]
    fn load_directions(directions: &[[T; 3]]) -> [Self; 3] {
        let directions = &directions[..4];
        core::array::from_fn(|axis| Self(core::array::from_fn(|d| directions[d][axis])))
    }
    #[inline(always)]
    fn store_square(rows: &[Self], stride: usize, out: &mut [T]) {
        Self::store_transposed(&rows[..4], stride, out);
    }
    #[inline(always)]
    fn store_transposed(rows: &[Self], stride: usize, out: &mut [T]) {
        for d in 0..4 {
            out[d * stride..][..rows.len()].iter_mut().zip(rows).for_each(|(out, row)| *out = row.0[d]);
        }
    }
    #[inline(always)]
    fn load_transposed(rows: &mut [Self], stride: usize, values: &[T]) {
        assert!(values.len() >= 3 * stride + rows.len(), "a value for every lane");
        for d in 0..4 {
            rows.iter_mut().zip(&values[d * stride..]).for_each(|(row, &value)| row.0[d] = value);
        }
    }
}

#[cfg(all(target_arch = "x86_64", feature = "std"))]
#[expect(unsafe_code, reason = "see the head of the module")]
mod x86 {
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
                        $half::store_transposed(
                            &rows_of_half[..rows.len()],
                            stride,
                            &mut out[half * $width * stride..],
                        );
                    }
                }

                #[inline(always)]
                pub(super) fn load(rows: &mut [$whole], stride: usize, values: &[$scalar]) {
                    if rows.is_empty() {
                        return;
                    }
                    let mut halves = [[$half::splat(0.0); 2 * $width]; 2];
                    for (half, rows_of_half) in halves.iter_mut().enumerate() {
                        $half::load_transposed(
                            &mut rows_of_half[..rows.len()],
                            stride,
                            &values[half * $width * stride..],
                        );
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
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec;
    use std::vec::Vec;

    use super::*;

    /// Every operation on some numbers, lane by lane against the scalar; returns the width.
    struct Everything;

    impl<T: Real> Kernel<T> for Everything {
        type Output = usize;

        fn run<V: Lanes<T>>(self) -> usize {
            let width = V::WIDTH;
            let numbers = |from: f64| -> Vec<T> {
                (0..width).map(|d| T::from_f64(from + 1.5 * d as f64 + 0.1 * (d * d) as f64)).collect()
            };
            let (a, b, c) = (numbers(-3.0), numbers(2.0), numbers(0.7));
            let [va, vb, vc] = [&a, &b, &c].map(|values| V::load(values));
            let lanes = |value: V| {
                let mut out = vec![T::ZERO; width];
                value.store(&mut out);
                out
            };
            let each = |f: &dyn Fn(usize) -> T| (0..width).map(f).collect::<Vec<T>>();
            assert_eq!(lanes(V::splat(a[0])), vec![a[0]; width]);
            assert_eq!(lanes(va + vb), each(&|d| a[d] + b[d]));
            assert_eq!(lanes(va - vb), each(&|d| a[d] - b[d]));
            assert_eq!(lanes(va * vb), each(&|d| a[d] * b[d]));
            assert_eq!(lanes(-va), each(&|d| -a[d]));
            assert_eq!(lanes(va.div(vb)), each(&|d| a[d] / b[d]));
            assert_eq!(lanes(va.select_less(vc, va, vb)), each(&|d| if a[d] < c[d] { a[d] } else { b[d] }));
            for (fused, d) in lanes(va.mul_add(vb, vc)).into_iter().zip(0..) {
                let bound = T::EPSILON * ((a[d] * b[d]).abs() + c[d].abs());
                assert!((fused - (a[d] * b[d] + c[d])).abs() <= bound);
            }
            directions::<T, V>();
            transposes::<T, V>();
            width
        }
    }

    fn directions<T: Real, V: Lanes<T>>() {
        let numbers: Vec<[T; 3]> =
            (0..V::WIDTH).map(|d| core::array::from_fn(|axis| T::from_f64((10 * d + axis) as f64))).collect();
        for (axis, values) in V::load_directions(&numbers).into_iter().enumerate() {
            let mut out = vec![T::ZERO; V::WIDTH];
            values.store(&mut out);
            assert!(out.iter().zip(&numbers).all(|(out, direction)| *out == direction[axis]), "{out:?}");
        }
    }

    fn transposes<T: Real, V: Lanes<T>>() {
        for (count, stride) in [(1, 1), (4, 4), (9, 9), (16, 16), (16, 20), (36, 36), (37, 40)] {
            let rows: Vec<V> = (0..count)
                .map(|j| V::load(&(0..V::WIDTH).map(|d| T::from_f64((100 * d + j) as f64)).collect::<Vec<T>>()))
                .collect();
            let mut out = vec![T::from_f64(-1.0); (V::WIDTH - 1) * stride + count];
            V::store_transposed(&rows, stride, &mut out);
            for (at, value) in out.iter().enumerate() {
                let (d, j) = (at / stride, at % stride);
                let expected = if j < count { (100 * d + j) as f64 } else { -1.0 };
                assert_eq!(value.to_f64(), expected, "{count} {stride} {d} {j}");
            }
            let mut back = vec![V::splat(T::ZERO); count];
            V::load_transposed(&mut back, stride, &out);
            for (j, row) in back.iter().enumerate() {
                let mut lanes = vec![T::ZERO; V::WIDTH];
                row.store(&mut lanes);
                assert!(lanes.iter().enumerate().all(|(d, lane)| lane.to_f64() == (100 * d + j) as f64));
            }
        }
    }

    #[test]
    fn every_level_computes_the_same() {
        assert_eq!((Kernel::<f32>::run::<f32>(Everything), Kernel::<f64>::run::<f64>(Everything)), (1, 1));
        for level in Level::available() {
            let widths = (run_at::<f32, _>(level, Everything), run_at::<f64, _>(level, Everything));
            let expected = match level {
                Level::Portable => (4, 4),
                #[cfg(all(target_arch = "x86_64", feature = "std"))]
                Level::Avx2 => (8, 4),
                #[cfg(all(target_arch = "x86_64", feature = "std"))]
                Level::Avx512 => (16, 8),
            };
            assert_eq!(widths, expected, "{level:?}");
        }
    }

    #[test]
    fn the_widest_level_is_chosen() {
        assert_eq!(Some(Level::best()), Level::available().last());
    }
}
