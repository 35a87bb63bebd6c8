//! Rows of glossy transfer: `∫ V(s) ψ_r(s) y(s) ds` over the hemisphere of the micro-surface, and what other texels reflect there.

use glam::{Mat3, Vec3};
use sh_core::{Order, Quadrature};

use super::direct::{DirectPass, Found};
use super::opaque::Opaque;
use super::{PatchReport, PatchTransfer};
use crate::diffuse::{HitRecord, add_scaled};
use crate::{Error, Pass, Progress, TransferVectors};

/// The responses, ready to be evaluated and expanded.
#[derive(Debug)]
struct Responses {
    /// The highest order of them.
    order: Order,
    /// `[R, n_out²]`, padded with zeros.
    coeffs: Vec<Vec<f64>>,
    /// What each is on the upper hemisphere, 0 below, expanded to the transfer's order: `[R, n²]`, in the micro-surface's frame.
    clipped: Vec<Vec<f64>>,
}

/// The diffuse transfer of the texels, and the triangles between them.
#[derive(Debug)]
struct Reflected {
    total: TransferVectors,
    triangles: Vec<[u32; 3]>,
}

/// Bakes all rows of `transfer`.
pub(super) fn bake(
    opaque: &Opaque,
    transfer: &mut PatchTransfer,
    progress: &dyn Progress,
    report: &mut PatchReport,
) -> Result<(), Error> {
    let glossy = Glossy {
        opaque,
        responses: Responses::new(&opaque.options.responses, opaque.options.order),
        channels: transfer.channels,
    };
    if !opaque.options.shadowed {
        glossy.bake_unshadowed(transfer);
        return Ok(());
    }
    let reflected = Reflected::new(opaque, progress, report)?;
    glossy.bake_shadowed(transfer, reflected.as_ref(), progress, report)?;
    let direct = |pass: &DirectPass, texel: usize| glossy.texel(pass, &mut Found::default(), texel, None);
    report.error = Some(opaque.estimate_error(direct, |texel| glossy.unshadowed(texel)));
    Ok(())
}

/// A bake of glossy rows.
#[derive(Debug)]
struct Glossy<'a> {
    opaque: &'a Opaque<'a>,
    responses: Responses,
    channels: usize,
}

impl Glossy<'_> {
    fn bake_unshadowed(&self, transfer: &mut PatchTransfer) {
        let length = transfer.values.len() / transfer.texel_count();
        for (texel, values) in transfer.values.chunks_exact_mut(length).enumerate() {
            values.iter_mut().zip(self.unshadowed(texel)).for_each(|(value, exact)| *value = exact as f32);
        }
    }

    fn bake_shadowed(
        &self,
        transfer: &mut PatchTransfer,
        reflected: Option<&Reflected>,
        progress: &dyn Progress,
        report: &mut PatchReport,
    ) -> Result<(), Error> {
        let pass = self.opaque.direct(&self.opaque.directions);
        let length = transfer.values.len() / transfer.texel_count();
        let mut items: Vec<_> = transfer.values.chunks_exact_mut(length).map(|values| (values, 0, 0)).collect();
        progress.start(Pass::Texels, items.len());
        self.opaque.threads.for_each(&mut items, progress, Found::default, |found, texel, item| {
            let (values, rays, occluded) = item;
            let rows = self.texel(&pass, found, texel, reflected);
            values.iter_mut().zip(rows).for_each(|(value, sum)| *value = sum as f32);
            (*rays, *occluded) = (found.rays, found.occluded.len() as u64);
            *rays
        })?;
        report.add_rays(items.iter().map(|(_, rays, occluded)| (*rays, *occluded)));
        Ok(())
    }

    /// `[R, C, n²]` without shadows, in the tile's frame, exact.
    fn unshadowed(&self, texel: usize) -> Vec<f64> {
        let order = self.opaque.options.order;
        let columns = micro_frame(self.opaque.normals[texel]).to_cols_array_2d().map(|column| column.map(f64::from));
        let rows = [0, 1, 2].map(|k| columns.map(|column| column[k]));
        let mut turned = vec![0.0; order.coeff_count()];
        let mut all = Vec::with_capacity(self.responses.clipped.len() * self.channels * order.coeff_count());
        for clipped in &self.responses.clipped {
            sh_core::rotate(order, rows, clipped, &mut turned);
            (0..self.channels).for_each(|_| all.extend_from_slice(&turned));
        }
        all
    }

    /// `[R, C, n²]`: the unshadowed rows less the occluded directions, plus what is reflected from there.
    fn texel(&self, pass: &DirectPass, found: &mut Found, texel: usize, reflected: Option<&Reflected>) -> Vec<f64> {
        pass.trace(texel, found);
        let coeff_count = pass.directions.order.coeff_count();
        let to_local = micro_frame(pass.normals[texel]).transpose();
        let solid_angle = 4.0 * std::f64::consts::PI / pass.directions.directions.len() as f64;
        let mut rows = self.unshadowed(texel);
        let mut values = vec![0.0; self.responses.coeffs.len()];
        for ray in &found.occluded {
            self.responses.evaluate(to_local * pass.directions.directions[ray.direction], &mut values);
            for (value, row) in values.iter().zip(rows.chunks_exact_mut(self.channels * coeff_count)) {
                for channel in row.chunks_exact_mut(coeff_count) {
                    add_scaled(channel, pass.basis(ray.direction), -solid_angle * value);
                }
                if let Some(reflected) = reflected {
                    reflected.add(&ray.record(1.0, self.opaque.options.albedo), solid_angle * value, row);
                }
            }
        }
        rows
    }
}

impl Reflected {
    /// What light that takes one bounce less sends out; `None` if no bounce is asked for.
    fn new(opaque: &Opaque, progress: &dyn Progress, report: &mut PatchReport) -> Result<Option<Self>, Error> {
        let Some(bounces) = opaque.options.bounces.checked_sub(1) else { return Ok(None) };
        let total = opaque.diffuse(bounces, progress, report)?;
        Ok(Some(Self { total, triangles: opaque.field.tile_triangles() }))
    }
}

impl Responses {
    fn new(responses: &[Vec<f64>], order: Order) -> Self {
        let longest = responses.iter().map(Vec::len).max().unwrap_or(1);
        let own = Order::new(longest.isqrt()).expect("validated");
        let padded = |response: &Vec<f64>| {
            let mut coeffs = response.clone();
            coeffs.resize(own.coeff_count(), 0.0);
            coeffs
        };
        let coeffs: Vec<_> = responses.iter().map(padded).collect();
        let clipped = coeffs.iter().map(|coeffs| clip_to_hemisphere(own, coeffs, order)).collect();
        Self { order: own, coeffs, clipped }
    }

    /// The value of each response at a direction of the micro-surface's frame.
    fn evaluate(&self, direction: Vec3, values: &mut [f64]) {
        let mut basis = vec![0.0; self.order.coeff_count()];
        sh_core::eval(self.order, direction.as_dvec3().normalize().to_array(), &mut basis);
        values.iter_mut().zip(&self.coeffs).for_each(|(value, coeffs)| *value = sh_core::dot(coeffs, &basis));
    }
}

impl Reflected {
    /// Adds `weight` times what comes from a point of the surface to `sum`, `[C, n²]`.
    fn add(&self, hit: &HitRecord, weight: f64, sum: &mut [f64]) {
        let triangle = self.triangles[hit.triangle() as usize];
        let coeff_count = self.total.order.coeff_count();
        for (texel, corner) in triangle.into_iter().zip(hit.corner_weights()) {
            for ((channel, sum), reflected) in sum.chunks_exact_mut(coeff_count).enumerate().zip(hit.weights()) {
                add_scaled(sum, self.total.vector(texel as usize, channel), weight * corner * f64::from(reflected));
            }
        }
    }
}

/// Columns: the tile's x made perpendicular to the normal, z × x, and the normal.
fn micro_frame(normal: [f32; 3]) -> Mat3 {
    let z = Vec3::from_array(normal);
    let x = Vec3::X.reject_from_normalized(z).normalize_or(Vec3::NEG_Z);
    Mat3::from_cols(x, z.cross(x), z)
}

/// Expands what is left of a function when its lower hemisphere is set to 0. Exact: for m alike the product of two basis functions is a
/// polynomial in z, which the quadrature integrates over half its range.
fn clip_to_hemisphere(own: Order, coeffs: &[f64], order: Order) -> Vec<f64> {
    let quadrature = Quadrature::new(own.get() + order.get());
    let mut clipped = vec![0.0; order.coeff_count()];
    let (mut from, mut to) = (vec![0.0; own.coeff_count()], vec![0.0; order.coeff_count()]);
    for &([x, y, z], weight) in quadrature.points() {
        let upper = 0.5 * (z + 1.0);
        let scale = ((1.0 - upper * upper) / (x * x + y * y)).sqrt();
        let direction = [x * scale, y * scale, upper];
        sh_core::eval(own, direction, &mut from);
        sh_core::eval(order, direction, &mut to);
        let value = 0.5 * weight * sh_core::dot(coeffs, &from);
        clipped.iter_mut().zip(&to).for_each(|(sum, &y)| *sum += value * y);
    }
    clipped
}
