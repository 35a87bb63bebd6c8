//! Rotation matrices of the bands, each from the one below.
//!
//! The products of the functions of band 1 and of band `l−1` contain band `l`: `y_lm` is a sum of at most five products
//! `y_1i y_l−1,a`, with factors `f` that are `u, v, w` of [IR96](crate#references) (table 1, and table 2 for the indices,
//! in the 1998 correction). Divided by `√(l(2l−1))` they are a matrix `C` with orthonormal rows, so
//!
//! ```text
//! R^l = C (R^1 ⊗ R^(l−1)) Cᵀ
//! ```
//!
//! [IR96](crate#references) keeps `C` on the left, for the rows, and on the right needs one product only, chosen so that it
//! contains nothing but `y_ln` and lower bands:
//!
//! ```text
//! R^l_mn = (u_lm U + v_lm V + w_lm W) / √d_ln,   d_ln = (l+n)(l−n), or 2l(2l−1) for |n| = l
//! ```
//!
//! where `U, V, W` are sums of values of `P(i; a, n)`, products of band 1's row `i` and row `a` of the band below. That is
//! three times faster, but the divisor makes errors grow tenfold in ten bands: 1e-11 at band 64, and nothing is left at
//! band 200. With `C` on both sides no step can enlarge an error. So the bands up to [`IVANIC_BANDS`] are made the first
//! way, those beyond the second.
//!
//! [IR96](crate#references) has no Condon-Shortley phase. With it every `y_lm` is multiplied by `(−1)^m`, which is the
//! basis seen after half a turn about z; the recurrence holds in every frame, so it is enough that band 1 is given in our
//! signs.

use alloc::vec;
use alloc::vec::Vec;
use core::mem;

use crate::Real;

/// The last band that the recurrence of [IR96](crate#references) makes: its error is below 5e-15 there, measured for all
/// entries.
const IVANIC_BANDS: usize = 16;

/// Rows and columns of band 1 by their `m`.
const MINUS: usize = 0;
const ZERO: usize = 1;
const PLUS: usize = 2;

/// The matrix of one band after the other.
#[derive(Clone, Debug)]
pub(super) struct Bands {
    l: usize,
    /// Band 1 with rows and columns `m = −1, 0, 1`.
    one: [[f64; 3]; 3],
    /// `[2l+1, 2l+1]`, row-major.
    matrix: Vec<f64>,
    /// The storage of the band before, to be overwritten by the next one.
    spare: Vec<f64>,
}

impl Bands {
    /// Begins at band 0.
    ///
    /// - `rotation`: rows of an orthogonal matrix
    pub(super) fn new(rotation: [[f64; 3]; 3]) -> Self {
        /// `m = −1, 0, 1` are −y, +z, −x.
        const AXES: [(usize, f64); 3] = [(1, -1.0), (2, 1.0), (0, -1.0)];
        let one = AXES.map(|(row, a)| AXES.map(|(column, b)| a * b * rotation[row][column]));
        Self { l: 0, one, matrix: vec![1.0], spare: Vec::new() }
    }

    /// The matrix of the current band, `[2l+1, 2l+1]`, row-major: row `m + l`, column `n + l`.
    pub(super) fn matrix(&self) -> &[f64] {
        &self.matrix
    }

    /// Goes on to the next band.
    pub(super) fn advance(&mut self) {
        self.l += 1;
        let size = 2 * self.l + 1;
        let mut next = mem::take(&mut self.spare);
        next.clear();
        next.resize(size * size, 0.0);
        match self.l {
            1 => next.copy_from_slice(self.one.as_flattened()),
            2..=IVANIC_BANDS => self.fill_by_ivanic(&mut next),
            _ => self.fill_by_coupling(&mut next),
        }
        self.spare = mem::replace(&mut self.matrix, next);
    }

    /// Row `a` of the band below, which is still in `self.matrix`.
    fn below(&self, a: isize) -> &[f64] {
        let size = 2 * self.l - 1;
        let row = (self.l - 1).wrapping_add_signed(a);
        &self.matrix[row * size..][..size]
    }

    /// `R^l_mn = (u U + v V + w W) / √d`.
    fn fill_by_ivanic(&self, next: &mut [f64]) {
        let scales = column_scales(self.l);
        for (row, m) in next.chunks_exact_mut(2 * self.l + 1).zip(-(self.l as isize)..) {
            for Term { i, a, factor } in terms(self.l as isize, m).into_iter().filter(|term| term.factor != 0.0) {
                add_products(self.one[i].map(|r| r * factor), self.below(a), row);
            }
            row.iter_mut().zip(&scales).for_each(|(r, scale)| *r *= scale);
        }
    }

    /// `R^l = C (R^1 ⊗ R^(l−1)) Cᵀ`.
    fn fill_by_coupling(&self, next: &mut [f64]) {
        let l = self.l as isize;
        let columns = Columns::new(l);
        let mut left = [(); 3].map(|()| vec![0.0; 2 * self.l + 3]);
        for (row, m) in next.chunks_exact_mut(2 * self.l + 1).zip(-l..) {
            self.multiply_left(terms(l, m), &mut left);
            columns.multiply_right(&left, row);
        }
    }

    /// A row of `C (R^1 ⊗ R^(l−1))`: for each column of band 1, a row over the columns `a` of the band below, with two
    /// zeros at either end. The one of `m = −1` is in reverse, because it is needed at `−a`.
    fn multiply_left(&self, row_of_c: [Term; 5], left: &mut [Vec<f64>; 3]) {
        for (column, left) in left.iter_mut().enumerate() {
            let left = &mut left[2..2 * self.l + 1];
            left.fill(0.0);
            for Term { i, a, factor } in row_of_c {
                let factor = factor * self.one[i][column];
                left.iter_mut().zip(self.below(a)).for_each(|(left, below)| *left += factor * below);
            }
        }
        left[MINUS][2..2 * self.l + 1].reverse();
    }
}

/// `Cᵀ`, by the columns `n = −l..=l` of the result: the factors of `P(i; a, ·)` at `a = n` for `i = 0`, and at `a = n ∓ 1`
/// for `i = ±1`.
#[derive(Clone, Debug)]
struct Columns {
    middle: Vec<f64>,
    lower_plus: Vec<f64>,
    lower_minus: Vec<f64>,
    upper_plus: Vec<f64>,
    upper_minus: Vec<f64>,
}

impl Columns {
    fn new(l: isize) -> Self {
        let scale = 1.0 / (l * (2 * l - 1)) as f64;
        // V is nearer to 0 than n, W is farther.
        let pick = |negative: usize, positive: usize| {
            (-l..=l).map(|n| scale * terms(l, n)[if n > 0 { positive } else { negative }].factor).collect()
        };
        let (u, [v_plus, v_minus], [w_plus, w_minus]) = (0, [1, 2], [3, 4]);
        Self {
            middle: pick(u, u),
            lower_plus: pick(w_plus, v_plus),
            lower_minus: pick(w_minus, v_minus),
            upper_plus: pick(v_plus, w_plus),
            upper_minus: pick(v_minus, w_minus),
        }
    }

    fn multiply_right(&self, [minus, zero, plus]: &[Vec<f64>; 3], row: &mut [f64]) {
        let size = row.len();
        let [middle, lower_plus, lower_minus, upper_plus, upper_minus] =
            [&self.middle, &self.lower_plus, &self.lower_minus, &self.upper_plus, &self.upper_minus]
                .map(|f| &f[..size]);
        let ([minus, plus], zero) = ([minus, plus].map(|p| &p[..size + 2]), &zero[..size + 2]);
        for k in 0..size {
            row[k] = middle[k] * zero[k + 1]
                + (lower_plus[k] * plus[k] + lower_minus[k] * minus[k])
                + (upper_plus[k] * plus[k + 2] + upper_minus[k] * minus[k + 2]);
        }
    }
}

/// Adds `P(i; a, n)` for all columns `n`; `one` is band 1's row `i`, `below` row `a` of the band below.
fn add_products([minus, zero, plus]: [f64; 3], below: &[f64], row: &mut [f64]) {
    let (first, last) = (below[0], below[below.len() - 1]);
    let end = row.len() - 1;
    row[0] += plus * first + minus * last;
    row[end] += plus * last - minus * first;
    for (r, b) in row[1..end].iter_mut().zip(below) {
        *r += zero * b;
    }
}

/// `1/√d_ln` for every column `n = −l..=l`.
fn column_scales(l: usize) -> Vec<f64> {
    let end = 2 * l;
    // n = column − l, so l + n = column and l − n = 2l − column.
    let squared = |column: usize| if column == 0 || column == end { end * (end - 1) } else { column * (end - column) };
    (0..=end).map(|column| 1.0 / Real::sqrt(squared(column) as f64)).collect()
}

/// `factor · P(i; a, n)`; `i` counts the rows of band 1 from 0.
#[derive(Clone, Copy, Debug)]
struct Term {
    i: usize,
    a: isize,
    factor: f64,
}

impl Term {
    fn new(i: usize, a: isize, factor: f64) -> Self {
        Self { i, a: if factor == 0.0 { 0 } else { a }, factor }
    }
}

/// The row `m` of `√(l(2l−1)) C` for band `l ≥ 2`: the sum `u U + v V + w W`. Terms that are not needed have the factor 0
/// and name row 0.
fn terms(l: isize, m: isize) -> [Term; 5] {
    let root = |product: isize| Real::sqrt(product as f64);
    let abs = m.abs();
    let u = root((l + m) * (l - m));
    let v = 0.5 * root((l + abs - 1) * (l + abs));
    let w = -0.5 * root((l - abs - 1) * (l - abs));
    let sqrt2 = core::f64::consts::SQRT_2;
    // Factors of P(1; ·) and P(−1; ·) in v V and in w W.
    let (v_plus, v_minus, w_plus, w_minus) = match m {
        0 => (-sqrt2 * v, -sqrt2 * v, 0.0, 0.0),
        1 => (sqrt2 * v, 0.0, w, w),
        -1 => (0.0, sqrt2 * v, w, -w),
        2.. => (v, -v, w, w),
        _ => (v, v, w, -w),
    };
    // The row that V takes from the band below is nearer to 0, the one of W is farther.
    let (near, far) = match m {
        0 => (1, 1),
        1.. => (m - 1, m + 1),
        _ => (m + 1, m - 1),
    };
    [
        Term::new(ZERO, m, u),
        Term::new(PLUS, near, v_plus),
        Term::new(MINUS, -near, v_minus),
        Term::new(PLUS, far, w_plus),
        Term::new(MINUS, -far, w_minus),
    ]
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;

    const ROTATION: [[f64; 3]; 3] = [[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]];

    #[test]
    fn coupling_factors_are_orthonormal() {
        for l in 2..40_isize {
            let row = |m: isize| terms(l, m).map(|t| (t.i, t.a, t.factor / Real::sqrt((l * (2 * l - 1)) as f64)));
            for (m, other) in (-l..=l).flat_map(|m| (-l..=l).map(move |other| (m, other))) {
                let pairs = row(m).into_iter().flat_map(|a| row(other).map(|b| (a, b)));
                let sum: f64 = pairs.filter(|(a, b)| (a.0, a.1) == (b.0, b.1)).map(|(a, b)| a.2 * b.2).sum();
                let expected = f64::from(u8::from(m == other));
                assert!((sum - expected).abs() < 1e-15, "l = {l}, rows {m} and {other}: {sum}");
            }
        }
    }

    #[test]
    fn both_recurrences_agree_in_every_band_of_the_faster_one() {
        let mut bands = Bands::new(ROTATION);
        bands.advance();
        for l in 2..=IVANIC_BANDS {
            // `advance` makes band l; the other way starts from the band below, which is in `spare` afterwards.
            let mut other = bands.clone();
            bands.advance();
            other.l = l;
            let mut by_coupling = vec![0.0; (2 * l + 1) * (2 * l + 1)];
            other.fill_by_coupling(&mut by_coupling);
            for (a, b) in bands.matrix().iter().zip(&by_coupling) {
                assert!((a - b).abs() < 5e-15, "band {l}: {a} {b}");
            }
        }
    }

    #[test]
    fn bands_are_orthogonal() {
        let mut bands = Bands::new(ROTATION);
        for l in 0..80 {
            let size = 2 * l + 1;
            let rows: Vec<&[f64]> = bands.matrix().chunks_exact(size).collect();
            for (i, a) in rows.iter().enumerate() {
                for (j, b) in rows.iter().enumerate() {
                    let sum: f64 = a.iter().zip(*b).map(|(a, b)| a * b).sum();
                    let expected = f64::from(u8::from(i == j));
                    assert!((sum - expected).abs() < 1e-14, "band {l}, rows {i}, {j}: {sum}");
                }
            }
            bands.advance();
        }
    }

    #[test]
    fn band_2_of_a_turn_about_z() {
        // cos and sin of m times the angle, in pairs ±m.
        let (s, c) = (0.6, 0.8);
        let mut bands = Bands::new([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]);
        bands.advance();
        bands.advance();
        let (c2, s2) = (c * c - s * s, 2.0 * s * c);
        let expected = [
            [c2, 0.0, 0.0, 0.0, s2],
            [0.0, c, 0.0, s, 0.0],
            [0.0, 0.0, 1.0, 0.0, 0.0],
            [0.0, -s, 0.0, c, 0.0],
            [-s2, 0.0, 0.0, 0.0, c2],
        ];
        for (a, b) in bands.matrix().iter().zip(expected.as_flattened()) {
            assert!((a - b).abs() < 1e-15, "{a} {b}");
        }
    }
}
