//! Light that a surface reflects towards a point.

use super::HitRecord;
use crate::TransferVectors;

/// The transfer of one pass, and the faces that reflect it. What a point sends out is its transfer times its albedo, which the records of
/// hits hold.
#[derive(Debug)]
pub(crate) struct Reflection<'a> {
    triangles: &'a [[u32; 3]],
    arriving: TransferVectors,
}

impl<'a> Reflection<'a> {
    /// - `arriving`: transfer at each vertex, without its albedo
    pub(crate) fn new(triangles: &'a [[u32; 3]], arriving: TransferVectors) -> Self {
        Self { triangles, arriving }
    }

    /// Length of the transfer of one vertex, `C n²`.
    pub(crate) fn row_length(&self) -> usize {
        self.arriving.channels * self.arriving.order.coeff_count()
    }

    /// What arrives along the hits `q` of one point after one more bounce, `[C, n²]`: `M_b(p) = Σ w ρ(q) M_{b-1}(q)`. `sum` is
    /// overwritten. Source: [SKS02](sh_core#references) section 5.
    pub(crate) fn gather(&self, hits: &[HitRecord], sum: &mut Vec<f64>) {
        sum.clear();
        sum.resize(self.row_length(), 0.0);
        for hit in hits {
            let triangle = self.triangles[hit.triangle() as usize];
            for ((channel, sum), weight) in
                sum.chunks_exact_mut(self.arriving.order.coeff_count()).enumerate().zip(hit.weights())
            {
                let rows = triangle.map(|vertex| self.arriving.vector(vertex as usize, channel));
                let weights = hit.corner_weights().map(|corner| (corner * f64::from(weight)) as f32);
                add_interpolated(sum, rows, weights);
            }
        }
    }
}

/// `sum += Σ weight_k row_k`.
#[multiversion::multiversion(targets("x86_64+avx+avx2"))]
fn add_interpolated(sum: &mut [f64], rows: [&[f32]; 3], weights: [f32; 3]) {
    let [a, b, c] = rows;
    for (((sum, &a), &b), &c) in sum.iter_mut().zip(a).zip(b).zip(c) {
        *sum += f64::from(weights[0] * a + weights[1] * b + weights[2] * c);
    }
}
