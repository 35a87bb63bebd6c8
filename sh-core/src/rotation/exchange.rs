//! The matrix of a band that lets y and z change places, for any band.
//!
//! It turns a turn about z into one about y, which is how all the `ZXZXZ` rotations of this crate work:
//!
//! ```text
//! Y(β) = E Z(−β) E,   E: (x, y, z) → (x, z, y)
//! ```
//!
//! `E` is `X(90°)` of [KKP05](crate#references) and [SLS05](crate#references) after `z → −z`, which only changes signs; but it
//! is symmetric and its own inverse, so one matrix serves both sides. Three quarters of it are zero. The cosines (`m ≥ 0`) of
//! even m and the sines of odd m, called the first kind, become each other, and so do those of the second kind. An entry from
//! `m` to `k`, both ≥ 0, belongs to the first kind if `l + m + k` is even, else to the second; so one matrix `[l+1, l+1]`
//! holds all entries. They are Wigner's `d^l_km(π/2)`, up to a sign and `√2` for each of `k, m` that is not 0.

use crate::{Order, Real};

/// Room for `m = 0..=l` and one more.
const ROOM: usize = Order::MAX + 1;

/// The rows of one band's matrix, one after the other.
///
/// `d_km`, as a function of m, solves `2k d_km = −(√((l−m)(l+m+1)) d_k,m+1 + √((l+m)(l−m+1)) d_k,m−1)`, the matrix form of
/// "J_z before a quarter turn is J_x after it". Downwards from `d_kl = 2^−l √C(2l, l+k)` it is stable: there the entries grow
/// until they oscillate. In `f64` the smallest is 2^−511.
#[derive(Clone, Debug)]
pub(super) struct Rows {
    l: usize,
    /// The row that comes next.
    k: usize,
    /// `d_kl`
    last: f64,
    /// `√((l−m)(l+m+1))`, which couples m and m + 1.
    couplings: [f64; ROOM],
    /// Their reciprocals.
    inverses: [f64; ROOM],
}

impl Rows {
    /// The rows of band `l`, from `k = 0`.
    pub(super) fn new(l: usize) -> Self {
        let mut rows = Self { l, k: 0, last: 1.0, couplings: [0.0; ROOM], inverses: [0.0; ROOM] };
        for m in 0..l {
            rows.couplings[m] = Real::sqrt(((l - m) * (l + m + 1)) as f64);
            rows.inverses[m] = 1.0 / rows.couplings[m];
        }
        // 2^−2l C(2l, l) = Π (2i−1)/(2i)
        let square: f64 = (1..=l).map(|i| 1.0 - 0.5 / i as f64).product();
        rows.last = Real::sqrt(square);
        rows
    }

    /// Writes the entries of the next row, from `m = 0..=l`.
    pub(super) fn next(&mut self, row: &mut [f64]) {
        let (l, k) = (self.l, self.k);
        row[l] = self.last;
        let (twice, mut above, mut here) = (2.0 * k as f64, 0.0, self.last);
        for m in (1..=l).rev() {
            // There is no coupling at m = l.
            let below = -(twice * here + self.couplings[m] * above) * self.inverses[m - 1];
            (above, here) = (here, below);
            row[m - 1] = below;
        }
        for (m, entry) in row[..=l].iter_mut().enumerate() {
            *entry *= factor(l, k, m);
        }
        self.k += 1;
        self.last *= Real::sqrt((l - k) as f64 / (l + k + 1) as f64);
    }
}

/// What makes `d_km` the entry from `m` to `k`.
fn factor(l: usize, k: usize, m: usize) -> f64 {
    let root_two = core::f64::consts::SQRT_2;
    let size = match (k, m) {
        (0, 0) => 1.0,
        (0, _) | (_, 0) => root_two,
        _ => 2.0,
    };
    // Quarter turns about z on both sides, z → −z, and one more sign between a cosine and a sine.
    let minus = (l - m) + m / 2 + k / 2 + usize::from(l % 2 == 1 && (k + m) % 2 == 1);
    if minus.is_multiple_of(2) { size } else { -size }
}
