//! Shaped storage for transfer as sums of zonal lobes.

use sh_core::Order;

use crate::Error;

/// Transfer of `P` points (vertices, or texels row by row) as sums of zonal lobes.
///
/// Each point has `R` rows (1 for diffuse surfaces, `n_b` for glossy ones), each row `N` lobes whose axes its `C` channels share, and
/// the first `k` coefficients explicitly: 1 for band 0, 4 for bands 0 and 1. The transfer vector of a point, row and channel is
/// `t_i = explicit_i` for `i < k`, plus `Σ_lobes g*_l y_lm(axis)`, where `g*` are the lobe coefficients, zero in the explicit bands. It
/// includes `1/π` and leaves out the point's own albedo, as [`TransferVectors`](crate::TransferVectors) do.
///
/// Source: [SLS05](sh_core#references) eq. 11, section 3.3.
#[derive(Debug, Clone, PartialEq)]
pub struct ZonalTransfer {
    /// Number of bands `n`.
    pub order: Order,
    /// Rows `R` a point.
    pub rows: usize,
    /// Channels `C` a row: 1, or 3 for red, green and blue.
    pub channels: usize,
    /// Lobes `N` a row. Rows that need fewer have lobes without coefficients.
    pub lobe_count: usize,
    /// Explicit coefficients `k`: 1 or 4.
    pub explicit_count: usize,
    /// `[P, R, C, k]`.
    pub explicit: Vec<f32>,
    /// `[P, R, N]`, unit length.
    pub axes: Vec<[f32; 3]>,
    /// `[P, R, C, N, n]`.
    pub coeffs: Vec<f32>,
    /// What weighs the rows as the view changes, where there are several.
    pub view_map: Option<ViewMap>,
}

/// Weights of the rows of glossy transfer over the directions of view.
///
/// The unit square covers the hemisphere about the normal (+z) of the frame that the lobes are in: Shirley and Chiu's concentric map
/// to the disk, and from there to the hemisphere keeping areas (radius `r` to `cos θ = 1 − r²`). Texel `(row j, column i)` has its
/// centre at `((i + ½)/size, (j + ½)/size)`. Source: [SLS05](sh_core#references) section 3.2.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewMap {
    /// Texels along each side.
    pub size: usize,
    /// `[size, size, R]`.
    pub values: Vec<f32>,
}

impl ZonalTransfer {
    /// Number of points `P`.
    #[must_use]
    pub fn point_count(&self) -> usize {
        self.explicit.len() / (self.rows * self.channels * self.explicit_count).max(1)
    }

    /// Checks that the arrays have the lengths that the counts ask for.
    pub(crate) fn check_shape(&self, points: usize) -> Result<(), Error> {
        let (rows, lobes) = (points * self.rows, self.lobe_count);
        let expected = [
            ("explicit coefficients", self.explicit.len(), rows * self.channels * self.explicit_count),
            ("lobe axes", self.axes.len(), rows * lobes),
            ("lobe coefficients", self.coeffs.len(), rows * self.channels * lobes * self.order.get()),
            (
                "weights in the view map",
                self.view_map.as_ref().map_or(0, |map| map.values.len()),
                self.view_map.as_ref().map_or(0, |map| map.size * map.size * self.rows),
            ),
        ];
        match expected.into_iter().find(|&(_, given, needed)| given != needed) {
            Some((what, given, needed)) => {
                Err(Error::InconsistentMesh(format!("{given} {what} for {points} points; {needed} are needed")))
            }
            None => Ok(()),
        }
    }
}
