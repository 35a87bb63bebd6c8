//! Shaped storage for transfer.

use sh_core::Order;

/// One transfer vector for each vertex and channel: `values[V, C, n²]`.
///
/// The dot product of a transfer vector with the light vector, both in the frame of the scene, times the albedo of the vertex is the
/// exit radiance there. The vectors hold the `1/π` of the diffuse BRDF and the albedo of *other* surfaces, never the albedo of the
/// receiving point itself.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferVectors {
    /// Number of bands `n`.
    pub order: Order,
    /// 1 where all channels have the same transfer, else 3 (red, green, blue).
    pub channels: usize,
    /// `[V, C, n²]`.
    pub values: Vec<f32>,
}

impl TransferVectors {
    /// All zero.
    #[must_use]
    pub fn zero(vertex_count: usize, channels: usize, order: Order) -> Self {
        Self { order, channels, values: vec![0.0; vertex_count * channels * order.coeff_count()] }
    }

    /// The same vectors with as many channels, or with three equal ones in place of one.
    #[cfg(feature = "trace")]
    pub(crate) fn with_channels(&self, channels: usize) -> Self {
        let rows = self.values.chunks_exact(self.order.coeff_count());
        let values = rows.flat_map(|row| std::iter::repeat_n(row, channels / self.channels)).flatten().copied();
        Self { order: self.order, channels, values: values.collect() }
    }

    /// Number of vertices.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.values.len() / (self.channels * self.order.coeff_count())
    }

    /// The transfer vector `[n²]` of a vertex for a colour channel 0, 1 or 2; with one channel it serves all three.
    ///
    /// # Panics
    /// If there is no such vertex.
    #[must_use]
    pub fn vector(&self, vertex: usize, channel: usize) -> &[f32] {
        let row = vertex * self.channels + channel.min(self.channels - 1);
        &self.values[row * self.order.coeff_count()..(row + 1) * self.order.coeff_count()]
    }

    /// The unshadowed transfer of a surface that turns to `normals`: `1/π ∫ max(n·s, 0) y(s) ds`, exact, from no rays.
    ///
    /// Source: [SKS02](sh_core#references) eq. 6, [RH01](sh_core#references).
    #[must_use]
    pub fn unshadowed(order: Order, normals: &[[f32; 3]]) -> Self {
        let mut transfer = Self::zero(normals.len(), 1, order);
        let mut vector = vec![0.0; order.coeff_count()];
        for (normal, row) in normals.iter().zip(transfer.values.chunks_exact_mut(order.coeff_count())) {
            unshadowed_vector(order, *normal, &mut vector);
            row.iter_mut().zip(&vector).for_each(|(value, &exact)| *value = exact as f32);
        }
        transfer
    }
}

/// `1/π ∫ max(n·s, 0) y(s) ds` for one normal, in `f64`.
pub(crate) fn unshadowed_vector(order: Order, normal: [f32; 3], vector: &mut [f64]) {
    let mut zonal = vec![0.0; order.get()];
    sh_core::clamped_cosine(&mut zonal);
    zonal.iter_mut().for_each(|value| *value /= std::f64::consts::PI);
    let axis = glam::DVec3::from_array(normal.map(f64::from)).normalize_or(glam::DVec3::Z);
    sh_core::expand_zonal(order, &zonal, axis.to_array(), vector);
}
