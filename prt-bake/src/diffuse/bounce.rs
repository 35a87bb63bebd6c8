//! Light that arrives after reflections, pass by pass.

use super::{HitRecord, InsidePlan};
use crate::parallel::Threads;
use crate::{Error, Progress, TransferVectors};

/// The transfer of the last bounce, and of all together.
#[derive(Debug)]
pub(crate) struct Bounces<'a> {
    triangles: &'a [[u32; 3]],
    /// Of each vertex.
    albedo: &'a [[f32; 3]],
    /// Transfer of the last pass, times the albedo of the vertex: what it sends out.
    outgoing: TransferVectors,
    total: TransferVectors,
    direct_length: f64,
    inside: Option<&'a InsidePlan>,
}

impl<'a> Bounces<'a> {
    /// Starts from direct transfer, of one channel. Colour is carried only if a surface has it.
    pub(crate) fn new(triangles: &'a [[u32; 3]], albedo: &'a [[f32; 3]], direct: &TransferVectors) -> Self {
        let channels = if albedo.iter().all(|[r, g, b]| r == g && g == b) { 1 } else { 3 };
        let total = with_channels(direct, channels);
        let outgoing = reflected(albedo, &total);
        Self { triangles, albedo, outgoing, direct_length: length(&total), total, inside: None }
    }

    /// Replaces what arrives at vertices inside of solids after every pass, so that they do not darken what faces reflect that reach to
    /// them.
    pub(crate) fn with_inside(self, plan: &'a InsidePlan) -> Self {
        Self { inside: Some(plan), ..self }
    }

    /// One more bounce: `M_b(p) = Σ w ρ(q) M_{b-1}(q)` over the hits `q` of `p`. Returns the length of what it added, relative
    /// to the direct transfer. Source: [SKS02](sh_core#references) section 5.
    pub(crate) fn next(
        &mut self,
        hits: &[Vec<HitRecord>],
        threads: &Threads,
        progress: &dyn Progress,
    ) -> Result<f64, Error> {
        let row_length = self.total.channels * self.total.order.coeff_count();
        let mut arriving = TransferVectors::zero(hits.len(), self.total.channels, self.total.order);
        let mut rows: Vec<&mut [f32]> = arriving.values.chunks_exact_mut(row_length).collect();
        threads.for_each(
            &mut rows,
            progress,
            || vec![0.0; row_length],
            |sum, vertex, row| {
                self.gather(&hits[vertex], sum);
                row.iter_mut().zip(&*sum).for_each(|(value, &sum)| *value = sum as f32);
                0
            },
        )?;
        self.inside.into_iter().for_each(|plan| plan.apply(&mut arriving));
        self.total.values.iter_mut().zip(&arriving.values).for_each(|(total, added)| *total += added);
        self.outgoing = reflected(self.albedo, &arriving);
        Ok(length(&arriving) / self.direct_length.max(f64::MIN_POSITIVE))
    }

    /// What arrives along the hits of one vertex, `[C, n²]`.
    fn gather(&self, hits: &[HitRecord], sum: &mut [f64]) {
        sum.fill(0.0);
        for hit in hits {
            let triangle = self.triangles[hit.triangle() as usize];
            let weights = hit.corner_weights().map(|weight| (weight * f64::from(hit.weight)) as f32);
            let rows = triangle.map(|vertex| &self.outgoing.values[vertex as usize * sum.len()..][..sum.len()]);
            add_interpolated(sum, rows, weights);
        }
    }

    pub(crate) fn into_total(self) -> TransferVectors {
        self.total
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

/// The same vectors with one channel or three.
fn with_channels(transfer: &TransferVectors, channels: usize) -> TransferVectors {
    let rows = transfer.values.chunks_exact(transfer.order.coeff_count());
    let values = rows.flat_map(|row| std::iter::repeat_n(row, channels)).flatten().copied().collect();
    TransferVectors { order: transfer.order, channels, values }
}

/// Transfer times the albedo of its vertex.
fn reflected(albedo: &[[f32; 3]], transfer: &TransferVectors) -> TransferVectors {
    let mut reflected = transfer.clone();
    let vertices = reflected.values.chunks_exact_mut(transfer.channels * transfer.order.coeff_count());
    for (rows, albedo) in vertices.zip(albedo) {
        for (row, albedo) in rows.chunks_exact_mut(transfer.order.coeff_count()).zip(albedo) {
            row.iter_mut().for_each(|value| *value *= albedo);
        }
    }
    reflected
}

fn length(transfer: &TransferVectors) -> f64 {
    transfer.values.iter().map(|&value| f64::from(value).powi(2)).sum::<f64>().sqrt()
}
