//! Affine maps.

use glam::{DMat3, DVec3};

/// An affine map `p ↦ linear · p + translation`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Affine {
    /// Columns of the linear part: the images of the three axes.
    pub linear: [[f64; 3]; 3],
    /// The image of the origin.
    pub translation: [f64; 3],
}

impl Affine {
    /// The map that changes nothing.
    pub const IDENTITY: Self =
        Self { linear: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], translation: [0.0; 3] };

    /// From the four columns of a 4×4 matrix; its last row is taken to be `0 0 0 1`.
    #[must_use]
    pub fn from_columns(columns: [[f64; 4]; 4]) -> Self {
        let [x, y, z, w] = columns.map(|[a, b, c, _]| [a, b, c]);
        Self { linear: [x, y, z], translation: w }
    }

    /// The four columns of a 4×4 matrix, as graphics APIs take them.
    #[must_use]
    pub fn to_columns(&self) -> [[f32; 4]; 4] {
        let column = |v: [f64; 3], last: f32| [v[0] as f32, v[1] as f32, v[2] as f32, last];
        let [x, y, z] = self.linear;
        [column(x, 0.0), column(y, 0.0), column(z, 0.0), column(self.translation, 1.0)]
    }

    /// `self ∘ inner`: first `inner`, then `self`.
    #[must_use]
    pub fn after(&self, inner: &Self) -> Self {
        let (outer_linear, outer_translation) = self.parts();
        let (linear, translation) = inner.parts();
        Self::from_parts(outer_linear * linear, outer_linear * translation + outer_translation)
    }

    /// The image of a point.
    #[must_use]
    pub fn apply(&self, point: [f64; 3]) -> [f64; 3] {
        let (linear, translation) = self.parts();
        (linear * DVec3::from(point) + translation).to_array()
    }

    pub(crate) fn parts(&self) -> (DMat3, DVec3) {
        (DMat3::from_cols_array_2d(&self.linear), DVec3::from(self.translation))
    }

    pub(crate) fn from_parts(linear: DMat3, translation: DVec3) -> Self {
        Self { linear: linear.to_cols_array_2d(), translation: translation.to_array() }
    }
}

impl Default for Affine {
    fn default() -> Self {
        Self::IDENTITY
    }
}
