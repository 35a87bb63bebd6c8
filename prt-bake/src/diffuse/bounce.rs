//! Light that a surface reflects towards a point.

use super::HitRecord;
use crate::TransferVectors;

/// What a surface sends out: the transfer of one pass, times albedo.
#[derive(Debug)]
pub(crate) struct Reflection<'a> {
    triangles: &'a [[u32; 3]],
    outgoing: TransferVectors,
}

impl<'a> Reflection<'a> {
    /// - `albedo`: of each vertex
    /// - `arriving`: transfer at each vertex, without its albedo
    pub(crate) fn new(triangles: &'a [[u32; 3]], albedo: &[[f32; 3]], mut arriving: TransferVectors) -> Self {
        let coeff_count = arriving.order.coeff_count();
        for (rows, albedo) in arriving.values.chunks_exact_mut(arriving.channels * coeff_count).zip(albedo) {
            for (row, albedo) in rows.chunks_exact_mut(coeff_count).zip(albedo) {
                row.iter_mut().for_each(|value| *value *= albedo);
            }
        }
        Self { triangles, outgoing: arriving }
    }

    /// Length of the transfer of one vertex, `C n²`.
    pub(crate) fn row_length(&self) -> usize {
        self.outgoing.channels * self.outgoing.order.coeff_count()
    }

    /// What arrives along the hits `q` of one point after one more bounce, `[C, n²]`: `M_b(p) = Σ w ρ(q) M_{b-1}(q)`. `sum` is
    /// overwritten. Source: [SKS02](sh_core#references) section 5.
    pub(crate) fn gather(&self, hits: &[HitRecord], sum: &mut Vec<f64>) {
        sum.clear();
        sum.resize(self.row_length(), 0.0);
        for hit in hits {
            let triangle = self.triangles[hit.triangle() as usize];
            let weights = hit.corner_weights().map(|weight| (weight * f64::from(hit.weight)) as f32);
            let rows = triangle.map(|vertex| &self.outgoing.values[vertex as usize * sum.len()..][..sum.len()]);
            add_interpolated(sum, rows, weights);
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
