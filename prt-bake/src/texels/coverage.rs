//! What a texel holds.

/// What a texel holds, and how it came by it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Coverage {
    /// Nothing: no face is near.
    #[default]
    Empty,
    /// A copy of the nearest texels that were baked: gutter.
    Filled,
    /// Its centre lies off the charts, but a bilinear lookup on a face can read it. It holds the transfer of the surface beyond the edge of
    /// the chart, or of the edge where the surface ends or has a crease.
    Border,
    /// The transfer of the point of the surface that lies at the centre of the texel.
    Inside,
}

impl Coverage {
    const VALUES: [(Self, f32); 4] =
        [(Self::Empty, 0.0), (Self::Filled, 0.25), (Self::Border, 0.5), (Self::Inside, 1.0)];

    /// How it is stored in an image: 0 for empty, 0.25 for filled, 0.5 for border, 1 for inside.
    #[must_use]
    pub fn value(self) -> f32 {
        Self::VALUES.into_iter().find(|(coverage, _)| *coverage == self).map_or(0.0, |(_, value)| value)
    }

    /// Whether a point of the surface was baked for the texel.
    #[must_use]
    pub fn is_baked(self) -> bool {
        matches!(self, Self::Border | Self::Inside)
    }

    pub(super) fn of_value(value: f32) -> Option<Self> {
        Self::VALUES.into_iter().find(|(_, own)| *own == value).map(|(coverage, _)| coverage)
    }
}
