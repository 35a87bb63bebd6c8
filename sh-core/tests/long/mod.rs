//! A long reference: the basis and the Legendre polynomials in double-double arithmetic (about 32 digits), by the plain
//! three-term recurrence, which the crate does not use.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// `high + low`, with `|low|` at most half a unit in the last place of `high`.
#[derive(Clone, Copy, Debug)]
struct Long {
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

/// The direction, normalised.
fn normalise(direction: [f64; 3]) -> [Long; 3] {
    let [x, y, z] = direction.map(Long::from);
    let length = (x * x + y * y + z * z).sqrt();
    [x / length, y / length, z / length]
}

/// All `n²` basis functions at a direction, which is normalised first.
pub(crate) fn basis(n: usize, direction: [f64; 3]) -> Vec<f64> {
    let [x, y, z] = normalise(direction);
    let mut out = vec![0.0; n * n];
    let pi = Long { high: std::f64::consts::PI, low: 1.224_646_799_147_353_2e-16 };
    // C_m + i S_m = (−1)^m (x + iy)^m with the norm of y_mm.
    let (mut c, mut s) = (Long::from(0.5) / pi.sqrt(), Long::from(0.0));
    for m in 0..n {
        if m > 0 {
            let factor = -(Long::from(2 * m + 1) / Long::from(if m == 1 { 1 } else { 2 * m })).sqrt();
            (c, s) = (factor * (x * c - y * s), factor * (x * s + y * c));
        }
        // q_l = p_l / p_m with the norm of y_lm: (l−m) P_l = (2l−1) z P_l−1 − (l+m−1) P_l−2, and the norms' ratio.
        let (mut below, mut current) = (Long::from(0.0), Long::from(1.0));
        for l in m..n {
            if l > m {
                let norm = |l: usize| Long::from((2 * l + 1) * (l - m)) / Long::from((2 * l - 1) * (l + m));
                let first = norm(l).sqrt();
                let mut next = Long::from(2 * l - 1) * z * current * first;
                if l > m + 1 {
                    next = next - Long::from(l + m - 1) * below * first * norm(l - 1).sqrt();
                }
                (below, current) = (current, next / Long::from(l - m));
            }
            out[l * l + l - m] = (current * s).to_f64();
            out[l * l + l + m] = (current * c).to_f64();
        }
    }
    out
}

/// `P_l(a·b)` for `l < n`; the directions are normalised first.
pub(crate) fn legendre(n: usize, a: [f64; 3], b: [f64; 3]) -> Vec<f64> {
    let ([ax, ay, az], [bx, by, bz]) = (normalise(a), normalise(b));
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
