use crate::Surface;
use rayon::prelude::*;
use sh_core::Order;

/// Exit radiance of every vertex: `out[v] = albedo[v] · Σ_i transfer[v][i] · light[i]` per channel, over `order²` coefficients.
///
/// Negative values, which ringing of a light can cause, stay.
///
/// - `light`: `[3, k²]` for the `order` of `k` bands in use, at most the order of the surface
/// - `out`: `[V]`, overwritten
///
/// Does not allocate. The result does not depend on the number of threads. Cost: `3 k²` multiply-adds per vertex.
///
/// # Panics
/// If a slice length does not match, or `order` exceeds the surface's.
///
/// Source: \[SKS02\] section 4.1; the twin of `shaders/shade_vector.wgsl`.
pub fn shade_vector(surface: &Surface<'_>, light: &[f32], order: Order, out: &mut [[f32; 3]]) {
    assert!(order <= surface.order, "order {order} exceeds the stored order {}", surface.order);
    assert_eq!(light.len(), 3 * order.coeff_count(), "length of the light");
    assert_eq!(out.len(), surface.vertex_count(), "length of the output");
    let rows = surface.transfer.par_chunks_exact(surface.floats_per_vertex());
    let vertices = rows.zip(surface.albedo).zip(out).with_min_len(1024);
    vertices.for_each(|((transfer, albedo), out)| *out = shade_vertex(surface, transfer, *albedo, light, order));
}

fn shade_vertex(surface: &Surface<'_>, transfer: &[f32], albedo: [f32; 3], light: &[f32], order: Order) -> [f32; 3] {
    let (stored, used) = (surface.order.coeff_count(), order.coeff_count());
    std::array::from_fn(|channel| {
        let start = if surface.channels == 3 { channel * stored } else { 0 };
        albedo[channel] * sh_core::dot(&transfer[start..start + used], &light[channel * used..(channel + 1) * used])
    })
}
