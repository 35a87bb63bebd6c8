//! Approximate rotation: the turn about y by its Taylor polynomial.

use alloc::vec;
use alloc::vec::Vec;

use super::about_z::turn_in_place;
use super::zxzxz::invert;
use super::zyz::Zyz;
use crate::order::assert_length;
use crate::{Order, Real};

/// The largest order whose bands are all worked on together, on the stack.
const SMALL_ORDER: usize = 10;

/// Where the Taylor polynomial of `Y(β)` at 0 ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TaylorDegree {
    /// `I + βD`
    One,
    /// `I + βD + ½β² diag D²`: the degree "1.5" of [KKP05](crate#references), which the paper uses.
    OneAndHalf,
    /// `I + βD + ½β² D²`
    Two,
}

/// Rotation by `Z(α) Ỹ(β) Z(γ)`, where the Taylor polynomial `Ỹ` stands for the turn about y: O(n²), for small β.
///
/// The first derivative `D = dY/dβ(0)` couples neighbours `m, m+1` of a kind (cosines or sines) only:
///
/// ```text
/// D_m+1,m = −½ √((l−m)(l+m+1)) = −D_m,m+1,   times √2 for m = 0 (cosines)
/// ```
///
/// This is the generator of turns about y, and all derivatives are its powers, because `Y(β) = exp(βD)`; so the tables need
/// no recurrence over bands as in Appendix A of the paper. `D²` has a diagonal and entries two beside it.
///
/// Error for an expansion of unit length: at worst `|e^imβ − p(imβ)|` with `m = n−1` and the polynomial `p`, for degrees 1 and
/// 2, so about `½((n−1)β)²` and `((n−1)β)³/6`; degree 1.5 is between them. n = 5 and β = 10°: worst 0.240 / 0.123 / 0.056, mean
/// 0.060 / 0.035 / 0.010 for degree 1 / 1.5 / 2; asserted by `tests/rotation_taylor.rs`.
///
/// For n ≤ 10 it does not pay on a CPU: the straight-line kernels of [`rotate`](crate::rotate) are exact and 1.3 to 2 times faster
/// than any degree. Against tables ([`Zxzxz`](crate::Zxzxz)), which is what the paper compares with, degree 1.5 is 2.3 times faster for
/// n = 6 and 10, 1.5 for n = 16, 3.5 for n = 64, where its error is below 1 % only up to β = 0.2°. What is left is hardware
/// that lacks the registers or the program size for the exact way. `cargo run --release -p prt-benches --bin repro --
/// kkp/trade` of the workspace measures all this.
///
/// ```
/// use sh_core::{Order, Taylor, TaylorDegree, Zyz, rotate_zyz, taylor_angle_limit};
///
/// let order = Order::new(5)?;
/// let taylor = Taylor::<f32>::new(order, TaylorDegree::OneAndHalf);
/// let limit = taylor_angle_limit(order, 0.01_f32);
/// let zyz = Zyz::from_angles([0.4, 0.8 * limit, -1.0]);
/// let f = [0.2; 25]; // of length 1
/// let (mut fast, mut exact) = ([0.0; 25], [0.0; 25]);
/// taylor.rotate(&zyz, &f, &mut fast);
/// rotate_zyz(order, &zyz, &f, &mut exact);
/// let error: f32 = fast.iter().zip(exact).map(|(a, b)| (a - b).powi(2)).sum();
/// assert!(error.sqrt() < 0.01);
/// # Ok::<(), sh_core::Error>(())
/// ```
///
/// Source: [KKP05](crate#references) section 3.
#[derive(Clone, Debug)]
pub struct Taylor<T> {
    order: Order,
    degree: TaylorDegree,
    /// `D_i,i−1`, and a 0 at the end.
    first: Vec<T>,
    /// `½ (D²)_ii`
    diagonal: Vec<T>,
    /// `½ (D²)_i,i−2`, and two 0 at the end.
    second: Vec<T>,
}

impl<T: Real> Taylor<T> {
    /// Builds the tables, in `f64`.
    pub fn new(order: Order, degree: TaylorDegree) -> Self {
        let count = order.coeff_count();
        let mut first = vec![0.0; count + 1];
        for (l, band) in order.bands() {
            let (l, size) = (l as isize, band.len());
            for (m, first) in (-l..=l).zip(&mut first[band]).take(size) {
                *first = coupling(l, m);
            }
        }
        let diagonal = (0..count).map(|i| -0.5 * (first[i] * first[i] + first[i + 1] * first[i + 1]));
        let second = (0..count + 2).map(|i| if (2..count).contains(&i) { 0.5 * first[i] * first[i - 1] } else { 0.0 });
        Self {
            order,
            degree,
            diagonal: diagonal.map(T::from_f64).collect(),
            second: second.map(T::from_f64).collect(),
            first: first.into_iter().map(T::from_f64).collect(),
        }
    }

    /// The order of the expansions that it rotates.
    pub fn order(&self) -> Order {
        self.order
    }

    /// Where the polynomial ends.
    pub fn degree(&self) -> TaylorDegree {
        self.degree
    }

    /// Rotates an expansion, approximately: see the type. Does not allocate. α and γ are exact, whatever they are.
    /// Infinite or NaN coefficients may spoil the ends of the next bands too.
    ///
    /// - `zyz`: the rotation or mirror image
    /// - `coeffs`: `[n²]`
    /// - `out`: `[n²]`, overwritten
    ///
    /// # Panics
    /// If a slice length does not match the order.
    pub fn rotate(&self, zyz: &Zyz<T>, coeffs: &[T], out: &mut [T]) {
        assert_length("coeffs", coeffs.len(), self.order.coeff_count());
        assert_length("out", out.len(), self.order.coeff_count());
        let [cos, sin] = zyz.beta;
        out.copy_from_slice(coeffs);
        turn_in_place(self.order, zyz.gamma, out);
        self.turn_y(sin.atan2(cos), out);
        turn_in_place(self.order, zyz.alpha, out);
        if zyz.inverted {
            invert(self.order, out);
        }
    }

    /// Turns an expansion about y alone, approximately.
    ///
    /// - `beta`: in radians
    /// - `coeffs`: `[n²]`
    /// - `out`: `[n²]`, overwritten
    ///
    /// # Panics
    /// If a slice length does not match the order.
    pub fn rotate_y(&self, beta: T, coeffs: &[T], out: &mut [T]) {
        assert_length("coeffs", coeffs.len(), self.order.coeff_count());
        assert_length("out", out.len(), self.order.coeff_count());
        out.copy_from_slice(coeffs);
        self.turn_y(beta, out);
    }

    /// In place. Bands do not mix, whether they are worked on together or one by one.
    fn turn_y(&self, beta: T, coeffs: &mut [T]) {
        if self.order.get() <= SMALL_ORDER {
            let mut padded = [T::ZERO; SMALL_ORDER * SMALL_ORDER + 4];
            return self.turn_part(beta, 0, coeffs, &mut padded);
        }
        let mut padded = [T::ZERO; 2 * Order::MAX + 3];
        for (_, band) in self.order.bands() {
            self.turn_part(beta, band.start, &mut coeffs[band], &mut padded);
        }
    }

    /// Some whole bands, from the coefficient `start` on.
    ///
    /// - `padded`: room for them and two zeros on either side; zero, or left by a smaller part
    #[inline(always)]
    fn turn_part(&self, beta: T, start: usize, part: &mut [T], padded: &mut [T]) {
        let size = part.len();
        let padded = &mut padded[..size + 4];
        padded[2..size + 2].copy_from_slice(part);
        let first = &self.first[start..start + size + 1];
        for i in 0..size {
            part[i] = padded[i + 2] + beta * (first[i] * padded[i + 1] - first[i + 1] * padded[i + 3]);
        }
        if self.degree == TaylorDegree::One {
            return;
        }
        let (beta2, diagonal) = (beta * beta, &self.diagonal[start..start + size]);
        for i in 0..size {
            part[i] += beta2 * (diagonal[i] * padded[i + 2]);
        }
        if self.degree == TaylorDegree::OneAndHalf {
            return;
        }
        let second = &self.second[start..start + size + 2];
        for i in 0..size {
            part[i] += beta2 * (second[i] * padded[i] + second[i + 2] * padded[i + 4]);
        }
    }
}

/// `D_i,i−1` for `i = l(l+1) + m`.
fn coupling(l: isize, m: isize) -> f64 {
    let half_root = |lower: isize| 0.5 * Real::sqrt(((l - lower) * (l + lower + 1)) as f64);
    match m {
        // Between a sine and the cosine of 0 there is nothing, nor between bands.
        0 => 0.0,
        1 => -Real::sqrt((l * (l + 1)) as f64 / 2.0),
        2.. => -half_root(m - 1),
        _ => half_root(-m),
    }
}

/// The angle up to which a Taylor polynomial of degree 1.5 keeps the error of an expansion of unit length near a tolerance:
/// `2√tolerance / (n−1)`, in radians; infinite for n = 1, NaN for a negative tolerance.
///
/// The worst error is `¼((n−1)β)²` for small angles: within 2 % of the tolerance to 0.1, asserted by
/// `tests/rotation_taylor.rs`, and about half as much again at a tolerance of 1, which is no approximation any more. There
/// degree 2 is no better; to 0.1 its error is below that of degree 1.5.
///
/// Source: the erratum to [KKP05](crate#references) on the crate's page.
pub fn taylor_angle_limit<T: Real>(order: Order, tolerance: T) -> T {
    (tolerance.sqrt() + tolerance.sqrt()) / T::from_f64((order.get() - 1) as f64)
}

/// The limit of the paper, for radiance caching: `1.25 a` radians, where `a` is the error that the cache allows itself. It
/// keeps the share of approximate rotations constant in a scene; it does not know the order, and is no bound of the error. A
/// negative error gives a negative angle.
///
/// Source: [KKP05](crate#references) Appendix B, with `R/r = 10`.
pub fn radiance_cache_angle_limit<T: Real>(allowed_error: T) -> T {
    T::from_f64(1.25) * allowed_error
}
