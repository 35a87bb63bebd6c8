//! A rotation as three turns: about z, y, z.

use crate::Real;

/// Cosine and sine of an angle.
pub(super) type Turn<T> = [T; 2];

/// A rotation as turns by γ about z, then β about y, then α about z: `R = Z(α) Y(β) Z(γ)`; or its negative, a mirror image.
///
/// Holds cosines and sines, so making one from a matrix takes no trigonometric function: a square root and a division.
///
/// The third column of `R` is `(cos α sin β, sin α sin β, cos β)`, with `sin β = √(R₁₃² + R₂₃²) ≥ 0`: never `√(1 − cos² β)`,
/// which has lost half the digits near 0 and π. Near these angles the matrix does not fix α well; γ is taken from
/// `Z(−α) R = Y(β) Z(γ)` and so makes up for whatever α is. Where `sin β` is 0, α is.
///
/// ```
/// use sh_core::Zyz;
///
/// let zyz = Zyz::from_angles([0.3_f64, 1.2, -2.0]);
/// let [alpha, beta, gamma] = Zyz::from_matrix(zyz.matrix()).angles();
/// assert!((alpha - 0.3).abs() < 1e-15 && (beta - 1.2).abs() < 1e-15 && (gamma + 2.0).abs() < 1e-15);
/// ```
///
/// Source: [KKP05](crate#references) section 3, for the decomposition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Zyz<T> {
    pub(super) alpha: Turn<T>,
    pub(super) beta: Turn<T>,
    pub(super) gamma: Turn<T>,
    /// The rotation is followed by `s → −s`.
    pub(super) inverted: bool,
}

impl<T: Real> Zyz<T> {
    /// From the rows of an orthogonal matrix.
    ///
    /// Mirror images (determinant −1) are rotations followed by `s → −s`, and are as good as rotations.
    ///
    /// The third column and the first two rows are read. A matrix that is off by `e` from orthogonal gives a rotation that
    /// is off by about `e`, whose cosines and sines have length 1 to `e²`: rounded matrices are safe. A matrix far from
    /// orthogonal gives a meaningless result, and one with entries that are not finite, or whose cubes are not, may give NaN.
    /// There is no panic.
    #[inline(always)]
    pub fn from_matrix(matrix: [[T; 3]; 3]) -> Self {
        if determinant(&matrix) < T::ZERO {
            return Self { inverted: true, ..Self::from_rotation(matrix.map(|row| row.map(|r| -r))) };
        }
        Self::from_rotation(matrix)
    }

    #[inline(always)]
    fn from_rotation([[xx, xy, xz], [yx, yy, yz], [_, _, zz]]: [[T; 3]; 3]) -> Self {
        let radius2 = xz * xz + yz * yz;
        let sin_beta = radius2.sqrt();
        let scale = T::ONE / sin_beta;
        // Below, products of such numbers would underflow; the angle is as good as 0 or π.
        let tiny2 = T::EPSILON * T::EPSILON * T::EPSILON * T::EPSILON;
        let ([x, y], scale) = if radius2 < tiny2 { ([T::ONE, T::ZERO], T::ONE) } else { ([xz, yz], scale) };
        let gamma = [(x * yy - y * xy) * scale, (x * yx - y * xx) * scale];
        Self {
            alpha: [x * scale, y * scale],
            beta: to_unit_length([zz, sin_beta]),
            gamma: to_unit_length(gamma),
            inverted: false,
        }
    }

    /// From a quaternion `[x, y, z, w]` of any length but 0, for which the result is NaN.
    #[inline]
    pub fn from_quaternion(quaternion: [T; 4]) -> Self {
        // Squares of the largest component are in range then.
        let largest = quaternion.iter().fold(T::ZERO, |a, q| if q.abs() > a { q.abs() } else { a });
        let [x, y, z, w] = quaternion.map(|q| q / largest);
        let two = T::ONE + T::ONE;
        let s = two / (x * x + y * y + z * z + w * w);
        Self::from_matrix([
            [T::ONE - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)],
            [s * (x * y + z * w), T::ONE - s * (x * x + z * z), s * (y * z - x * w)],
            [s * (x * z - y * w), s * (y * z + x * w), T::ONE - s * (x * x + y * y)],
        ])
    }

    /// From `[α, β, γ]` in radians.
    pub fn from_angles([alpha, beta, gamma]: [T; 3]) -> Self {
        let turn = |angle: T| [angle.cos(), angle.sin()];
        Self { alpha: turn(alpha), beta: turn(beta), gamma: turn(gamma), inverted: false }
    }

    /// `[α, β, γ]` in radians, each in `−π..=π`; made by [`Zyz::from_matrix`], β is in `0..=π`. Of a mirror image, those of
    /// the rotation before `s → −s`.
    pub fn angles(&self) -> [T; 3] {
        [self.alpha, self.beta, self.gamma].map(|[cos, sin]| sin.atan2(cos))
    }

    /// Whether this is a mirror image: the rotation, followed by `s → −s`.
    pub fn is_mirror_image(&self) -> bool {
        self.inverted
    }

    /// The rows of `Z(α) Y(β) Z(γ)`, or of its negative for a mirror image.
    pub fn matrix(&self) -> [[T; 3]; 3] {
        let ([ca, sa], [cb, sb], [cc, sc]) = (self.alpha, self.beta, self.gamma);
        let rotation = [
            [ca * cb * cc - sa * sc, -(ca * cb * sc) - sa * cc, ca * sb],
            [sa * cb * cc + ca * sc, ca * cc - sa * cb * sc, sa * sb],
            [-(sb * cc), sb * sc, cb],
        ];
        if self.inverted { rotation.map(|row| row.map(|r| -r)) } else { rotation }
    }
}

#[inline(always)]
fn determinant<T: Real>([[a, b, c], [d, e, f], [g, h, i]]: &[[T; 3]; 3]) -> T {
    *a * (*e * *i - *f * *h) - *b * (*d * *i - *f * *g) + *c * (*d * *h - *e * *g)
}

/// One Newton step for `1/√(c² + s²)` from 1: an error `e` of the length becomes `3e²/2`.
#[inline(always)]
fn to_unit_length<T: Real>([c, s]: Turn<T>) -> Turn<T> {
    let half = T::from_f64(0.5);
    let scale = T::ONE + half - half * (c * c + s * s);
    [c * scale, s * scale]
}
