//! A long reference: the basis with its derivatives (by dual numbers), and the Legendre polynomials in double-double arithmetic (about 32 digits), by the plain
//! three-term recurrence, which the crate does not use.

#![allow(dead_code, reason = "each test uses a part")]

use std::ops::{Add, Div, Mul, Neg, Sub};

/// `high + low`, with `|low|` at most half a unit in the last place of `high`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Long {
    high: f64,
    low: f64,
}

impl Long {
    fn two_sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let b_part = high - a;
        Self { high, low: (a - (high - b_part)) + (b - b_part) }
    }

    fn quick(high: f64, low: f64) -> Self {
        let sum = high + low;
        Self { high: sum, low: low - (sum - high) }
    }

    fn sqrt(self) -> Self {
        if self.high == 0.0 {
            return self;
        }
        let root = Self::from(self.high.sqrt());
        let half = Self::from(0.5);
        // One Newton step doubles the 16 digits.
        half * (root + self / root)
    }

    fn to_f64(self) -> f64 {
        self.high + self.low
    }
}

impl From<f64> for Long {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl From<usize> for Long {
    fn from(whole: usize) -> Self {
        Self::from(whole as f64)
    }
}

impl Add for Long {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let high = Self::two_sum(self.high, other.high);
        let low = Self::two_sum(self.low, other.low);
        let sum = Self::quick(high.high, high.low + low.high);
        Self::quick(sum.high, sum.low + low.low)
    }
}

impl Neg for Long {
    type Output = Self;
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for Long {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Long {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let high = self.high * other.high;
        let low = self.high.mul_add(other.high, -high);
        Self::quick(high, low + (self.high * other.low + self.low * other.high))
    }
}

impl Div for Long {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * Self::from(first);
        let second = rest.high / other.high;
        let rest = rest - other * Self::from(second);
        Self::quick(first, second) + Self::from(rest.high / other.high)
    }
}

/// What the recurrence needs of a number.
pub(crate) trait Number:
    Copy
    + From<f64>
    + From<usize>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    fn sqrt(self) -> Self;
    fn pi() -> Self;
}

impl Number for Long {
    fn sqrt(self) -> Self {
        Self::sqrt(self)
    }
    fn pi() -> Self {
        Self { high: std::f64::consts::PI, low: 1.224_646_799_147_353_2e-16 }
    }
}

/// A number with its derivative by some variable: nested, with second derivatives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dual<T> {
    pub(crate) value: T,
    pub(crate) slope: T,
}

impl<T: Number> From<f64> for Dual<T> {
    fn from(value: f64) -> Self {
        Self { value: T::from(value), slope: T::from(0.0) }
    }
}

impl<T: Number> From<usize> for Dual<T> {
    fn from(value: usize) -> Self {
        Self { value: T::from(value), slope: T::from(0.0) }
    }
}

impl<T: Number> Add for Dual<T> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, slope: self.slope + other.slope }
    }
}

impl<T: Number> Sub for Dual<T> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, slope: self.slope - other.slope }
    }
}

impl<T: Number> Neg for Dual<T> {
    type Output = Self;
    fn neg(self) -> Self {
        Self { value: -self.value, slope: -self.slope }
    }
}

impl<T: Number> Mul for Dual<T> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self { value: self.value * other.value, slope: self.slope * other.value + self.value * other.slope }
    }
}

impl<T: Number> Div for Dual<T> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, slope: (self.slope - value * other.slope) / other.value }
    }
}

impl<T: Number> Number for Dual<T> {
    fn sqrt(self) -> Self {
        let value = self.value.sqrt();
        Self { value, slope: self.slope / (value + value) }
    }
    fn pi() -> Self {
        Self { value: T::pi(), slope: T::from(0.0) }
    }
}

/// The direction, normalised.
fn normalise<T: Number>([x, y, z]: [T; 3]) -> [T; 3] {
    let length = (x * x + y * y + z * z).sqrt();
    [x / length, y / length, z / length]
}

/// All `n²` basis functions at a direction, which is normalised first.
pub(crate) fn basis(n: usize, direction: [f64; 3]) -> Vec<f64> {
    basis_of(n, direction.map(Long::from)).into_iter().map(Long::to_f64).collect()
}

/// The derivatives of all basis functions by `s_a`.
pub(crate) fn gradient(n: usize, direction: [f64; 3], a: usize) -> Vec<f64> {
    let mut s = direction.map(Dual::<Long>::from);
    s[a].slope = Long::from(1.0);
    basis_of(n, s).into_iter().map(|y| y.slope.to_f64()).collect()
}

/// The second derivatives of all basis functions by `s_a` and `s_b`.
pub(crate) fn hessian(n: usize, direction: [f64; 3], a: usize, b: usize) -> Vec<f64> {
    let mut s = direction.map(Dual::<Dual<Long>>::from);
    s[a].slope.value = Long::from(1.0);
    s[b].value.slope = Long::from(1.0);
    basis_of(n, s).into_iter().map(|y| y.slope.slope.to_f64()).collect()
}

fn basis_of<T: Number>(n: usize, direction: [T; 3]) -> Vec<T> {
    let [x, y, z] = normalise(direction);
    let mut out = vec![T::from(0.0); n * n];
    // C_m + i S_m = (−1)^m (x + iy)^m with the norm of y_mm.
    let (mut c, mut s) = (T::from(0.5) / T::pi().sqrt(), T::from(0.0));
    for m in 0..n {
        if m > 0 {
            let factor = -(T::from(2 * m + 1) / T::from(if m == 1 { 1 } else { 2 * m })).sqrt();
            (c, s) = (factor * (x * c - y * s), factor * (x * s + y * c));
        }
        // q_l = p_l / p_m with the norm of y_lm: (l−m) P_l = (2l−1) z P_l−1 − (l+m−1) P_l−2, and the norms' ratio.
        let (mut below, mut current) = (T::from(0.0), T::from(1.0));
        for l in m..n {
            if l > m {
                let norm = |l: usize| T::from((2 * l + 1) * (l - m)) / T::from((2 * l - 1) * (l + m));
                let first = norm(l).sqrt();
                let mut next = T::from(2 * l - 1) * z * current * first;
                if l > m + 1 {
                    next = next - T::from(l + m - 1) * below * first * norm(l - 1).sqrt();
                }
                (below, current) = (current, next / T::from(l - m));
            }
            out[l * l + l - m] = current * s;
            out[l * l + l + m] = current * c;
        }
    }
    out
}

/// `P_l(a·b)` for `l < n`; the directions are normalised first.
pub(crate) fn legendre(n: usize, a: [f64; 3], b: [f64; 3]) -> Vec<f64> {
    let [[ax, ay, az], [bx, by, bz]] = [a, b].map(|s| normalise(s.map(Long::from)));
    let z = ax * bx + ay * by + az * bz;
    let (mut below, mut current) = (Long::from(0.0), Long::from(1.0));
    let mut out = Vec::with_capacity(n);
    for l in 0..n {
        out.push(current.to_f64());
        let next = (Long::from(2 * l + 1) * z * current - Long::from(l) * below) / Long::from(l + 1);
        (below, current) = (current, next);
    }
    out
}
