//! Lobes between points.

use crate::LobeSet;

/// A place between up to four points of a [`LobeSet`], by weights that add up to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blend {
    /// Points with their weights; an unused part has the weight 0.
    parts: [(u32, f64); 4],
}

impl Blend {
    /// At a point.
    #[must_use]
    pub fn at(point: u32) -> Self {
        Self { parts: [(point, 1.0), (point, 0.0), (point, 0.0), (point, 0.0)] }
    }

    /// Half way between two points.
    #[must_use]
    pub fn midpoint(a: u32, b: u32) -> Self {
        Self { parts: [(a, 0.5), (b, 0.5), (a, 0.0), (a, 0.0)] }
    }

    /// In a triangle, by barycentric coordinates.
    #[must_use]
    pub fn barycentric([a, b, c]: [u32; 3], [u, v, w]: [f64; 3]) -> Self {
        Self { parts: [(a, u), (b, v), (c, w), (a, 0.0)] }
    }

    /// Between four points, as [`Grid::blend`](crate::Grid::blend) finds them.
    #[must_use]
    pub fn bilinear(parts: [(u32, f64); 4]) -> Self {
        Self { parts }
    }

    /// The points with their weights.
    pub fn parts(&self) -> impl Iterator<Item = (usize, f64)> {
        self.parts.iter().map(|&(point, weight)| (point as usize, weight)).filter(|(_, weight)| *weight != 0.0)
    }
}

/// The lobes at places between points: weighted means of explicit and lobe coefficients, and of the axes, which are then
/// normalised.
///
/// What shaders do that interpolate lobes. Lobe `j` of all points must stand for the same thing, which is what
/// [`make_coherent`](crate::make_coherent) and [`fit_grid`](crate::fit_grid) are for. Axes that cancel become +z.
///
/// # Panics
/// If a blend names a point that does not exist.
///
/// Source: [SLS05](sh_core#references) section 4.2.
#[must_use]
pub fn interpolate(set: &LobeSet, blends: &[Blend]) -> LobeSet {
    let LobeSet { order, channels, lobe_count, explicit_count, .. } = *set;
    let mut out = LobeSet::zeros(order, channels, lobe_count, explicit_count, blends.len());
    let mean = |from: &[f32], to: &mut [f32], size: usize| {
        for (to, blend) in to.chunks_exact_mut(size.max(1)).zip(blends) {
            for (k, to) in to.iter_mut().enumerate() {
                *to =
                    blend.parts().map(|(point, weight)| weight * f64::from(from[point * size + k])).sum::<f64>() as f32;
            }
        }
    };
    mean(&set.explicit, &mut out.explicit, channels * explicit_count);
    mean(&set.coeffs, &mut out.coeffs, channels * lobe_count * order.get());
    mean(set.axes.as_flattened(), out.axes.as_flattened_mut(), 3 * lobe_count);
    out.axes.iter_mut().for_each(|axis| *axis = unit_or_z(axis.map(f64::from)).0.map(|x| x as f32));
    out
}

/// A vector at unit length, and the length; +z and 1 for none.
pub(crate) fn unit_or_z(vector: [f64; 3]) -> ([f64; 3], f64) {
    /// Below this length the direction of a mean of unit vectors is that of rounding.
    const NONE: f64 = 1e-12;
    let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > NONE { (vector.map(|x| x / length), length) } else { ([0.0, 0.0, 1.0], 1.0) }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    use sh_core::Order;

    use super::*;

    #[test]
    fn means_are_weighted_and_axes_unit() {
        let mut set = LobeSet::zeros(Order::new(2).unwrap(), 1, 1, 1, 3);
        set.explicit.copy_from_slice(&[1.0, 2.0, 4.0]);
        set.coeffs.copy_from_slice(&[0.0, 1.0, 0.0, 3.0, 0.0, 5.0]);
        set.axes.copy_from_slice(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0]]);
        let between = interpolate(
            &set,
            &[
                Blend::at(1),
                Blend::barycentric([0, 1, 2], [0.5, 0.25, 0.25]),
                Blend::midpoint(1, 2),
                Blend::midpoint(0, 1),
            ],
        );
        assert_eq!(between.explicit, [2.0, 2.0, 3.0, 1.5]);
        assert_eq!(between.coeffs, [0.0, 3.0, 0.0, 2.5, 0.0, 4.0, 0.0, 2.0]);
        let half = std::f32::consts::FRAC_1_SQRT_2;
        assert_eq!(between.axes, [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [half, half, 0.0]]);
    }
}
