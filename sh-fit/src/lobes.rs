//! Sums of lobes: shaped storage.

use sh_core::{Order, expand_lobe};

/// The number of transfer coefficients that are stored as they are beside `lobe_count` lobes: band 0, and from 3 lobes on
/// also band 1, which three lobes could reproduce without error. At most `n²`.
///
/// Source: [SLS05](sh_core#references) section 3.3.
#[must_use]
pub fn explicit_count(order: Order, lobe_count: usize) -> usize {
    let bands = if lobe_count < 3 { 1 } else { 2 };
    (bands * bands).min(order.coeff_count())
}

/// Transfer of many points as sums of zonal lobes.
///
/// The approximated transfer of a point is `t̃_i = explicit_i` for `i < k`, plus `Σ g*_l y_lm(axis)` over its lobes
/// ([SLS05](sh_core#references) eq. 11). All channels of a point share the axes.
#[derive(Debug, Clone, PartialEq)]
pub struct LobeSet {
    /// Number of bands `n`.
    pub order: Order,
    /// Channels `C`: 1, or 3 for colours.
    pub channels: usize,
    /// Lobes per point, `N`.
    pub lobe_count: usize,
    /// Explicit coefficients `k`, see [`explicit_count`].
    pub explicit_count: usize,
    /// `[P, C, k]`: the first coefficients of the transfer.
    pub explicit: Vec<f32>,
    /// `[P, N]`: unit length; +z where a lobe is not used.
    pub axes: Vec<[f32; 3]>,
    /// `[P, C, N, n]`: lobe coefficients `g*_l`; 0 in the explicit bands and for unused lobes.
    pub coeffs: Vec<f32>,
}

impl LobeSet {
    /// Points without any transfer: zeros, and axes along +z.
    #[must_use]
    pub fn zeros(order: Order, channels: usize, lobe_count: usize, explicit_count: usize, point_count: usize) -> Self {
        let coeffs = vec![0.0; point_count * channels * lobe_count * order.get()];
        let (explicit, axes) =
            (vec![0.0; point_count * channels * explicit_count], vec![[0.0, 0.0, 1.0]; point_count * lobe_count]);
        Self { order, channels, lobe_count, explicit_count, explicit, axes, coeffs }
    }

    /// Number of points `P`.
    #[must_use]
    pub fn point_count(&self) -> usize {
        self.explicit.len() / (self.channels * self.explicit_count).max(1)
    }

    /// The explicit coefficients of a point and channel, `[k]`.
    #[must_use]
    pub fn explicit_of(&self, point: usize, channel: usize) -> &[f32] {
        let k = self.explicit_count;
        &self.explicit[(point * self.channels + channel) * k..][..k]
    }

    /// The axes of a point, `[N]`.
    #[must_use]
    pub fn axes_of(&self, point: usize) -> &[[f32; 3]] {
        &self.axes[point * self.lobe_count..][..self.lobe_count]
    }

    /// The lobe coefficients of a point and channel, `[N, n]`.
    #[must_use]
    pub fn coeffs_of(&self, point: usize, channel: usize) -> &[f32] {
        let count = self.lobe_count * self.order.get();
        &self.coeffs[(point * self.channels + channel) * count..][..count]
    }

    /// Writes the approximated transfer `t̃` of a point and channel.
    ///
    /// - `out`: `[n²]`, overwritten
    ///
    /// # Panics
    /// If `out` is not `[n²]`, or there is no such point or channel.
    ///
    /// Source: [SLS05](sh_core#references) eq. 11.
    pub fn reconstruct(&self, point: usize, channel: usize, out: &mut [f32]) {
        let count = self.order.coeff_count();
        assert!(out.len() == count, "out has {} elements, it needs {count}", out.len());
        out.fill(0.0);
        let mut lobe = vec![0.0; count];
        let lobes = self.coeffs_of(point, channel).chunks_exact(self.order.get());
        for (&axis, coeffs) in self.axes_of(point).iter().zip(lobes) {
            expand_lobe(self.order, coeffs, axis, &mut lobe);
            out.iter_mut().zip(&lobe).for_each(|(out, lobe)| *out += lobe);
        }
        out.iter_mut().zip(self.explicit_of(point, channel)).for_each(|(out, explicit)| *out += explicit);
    }

    /// Turns the transfer of a point with its surface: the axes and the explicit linear band, which is all that a rotation
    /// changes.
    ///
    /// - `matrix`: the rows of a rotation `R`; a feature in the direction `d` is afterwards in the direction `R d`
    ///
    /// # Panics
    /// If there is no such point.
    ///
    /// Source: [SLS05](sh_core#references) eq. 10.
    pub fn rotate(&mut self, point: usize, matrix: [[f32; 3]; 3]) {
        let turn = |d: [f32; 3]| matrix.map(|row| row[0] * d[0] + row[1] * d[1] + row[2] * d[2]);
        self.axes[point * self.lobe_count..][..self.lobe_count].iter_mut().for_each(|axis| *axis = turn(*axis));
        let k = self.explicit_count;
        for explicit in self.explicit[point * self.channels * k..][..self.channels * k].chunks_exact_mut(k) {
            // Band 1 is (−y, z, −x) of its axis.
            if let [_, y, z, x] = explicit {
                let turned = turn([-*x, -*y, *z]);
                (*x, *y, *z) = (-turned[0], -turned[1], turned[2]);
            }
        }
    }
}
