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
    assert_eq!(surface.transfer.len(), out.len() * surface.floats_per_vertex(), "length of the transfer");
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

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use proptest::prelude::*;

    /// Numbers that look random, from -1 to 1.
    fn noise(count: usize, seed: u32) -> Vec<f32> {
        (0..count as u32).map(|i| ((i * 7919 + seed * 104_729) % 2003) as f32 / 1001.0 - 1.0).collect()
    }

    fn shade(channels: usize, stored: usize, used: usize, vertices: usize) -> (Vec<[f32; 3]>, Vec<[f64; 3]>) {
        let (stored, used) = (Order::new(stored).unwrap(), Order::new(used).unwrap());
        let (n2, k2) = (stored.coeff_count(), used.coeff_count());
        let transfer = noise(vertices * channels * n2, 1);
        let light = noise(3 * k2, 2);
        let positions = vec![[0.0; 3]; vertices];
        let albedo: Vec<[f32; 3]> = noise(3 * vertices, 3).chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
        let surface = Surface::new(&positions, &[], &albedo, stored, channels, &transfer).unwrap();
        let mut out = vec![[f32::NAN; 3]; vertices];
        shade_vector(&surface, &light, used, &mut out);
        let exact = |v: usize, c: usize| -> f64 {
            let row = (v * channels + if channels == 3 { c } else { 0 }) * n2;
            let sum: f64 = (0..k2).map(|i| f64::from(transfer[row + i]) * f64::from(light[c * k2 + i])).sum();
            f64::from(albedo[v][c]) * sum
        };
        (out, (0..vertices).map(|v| std::array::from_fn(|c| exact(v, c))).collect())
    }

    proptest! {
        #[test]
        fn equals_the_plain_sum(channels in prop_oneof![Just(1_usize), Just(3)], stored in 1_usize..9, unused in 0_usize..8, vertices in 0_usize..40) {
            let used = stored.saturating_sub(unused).max(1);
            let (shaded, exact) = shade(channels, stored, used, vertices);
            for (shaded, exact) in shaded.as_flattened().iter().zip(exact.as_flattened()) {
                // At most 64 products of size 1, each rounded once and added once.
                prop_assert!((f64::from(*shaded) - exact).abs() < 64.0 * 2.0 * f64::from(f32::EPSILON));
            }
        }
    }

    /// Under a sky of radiance 1, open on all sides, a surface is as bright as its albedo. Band 0 of that light is √(4π); that of
    /// open transfer is `1/π ∫ max(n·s, 0) / (2√π) ds = 1/(2√π)`.
    #[test]
    fn an_open_sky_gives_the_albedo() {
        let root_pi = std::f32::consts::PI.sqrt();
        let (positions, albedo, transfer) = ([[0.0; 3]], [[0.25, 0.5, 1.0]], [0.5 / root_pi]);
        let surface = Surface::new(&positions, &[], &albedo, Order::new(1).unwrap(), 1, &transfer).unwrap();
        let mut out = [[0.0; 3]];
        shade_vector(&surface, &[2.0 * root_pi; 3], Order::new(1).unwrap(), &mut out);
        assert!(out[0].iter().zip(albedo[0]).all(|(x, a)| (x - a).abs() < 1e-6), "{out:?}");
    }

    #[test]
    fn no_light_no_albedo_and_huge_light_are_exact() {
        let (positions, albedo) = ([[0.0; 3]; 2], [[0.0; 3], [1.0; 3]]);
        let surface = Surface::new(&positions, &[], &albedo, Order::new(2).unwrap(), 1, &[0.5; 8]).unwrap();
        let mut out = [[f32::NAN; 3]; 2];
        shade_vector(&surface, &[0.0; 12], Order::new(2).unwrap(), &mut out);
        assert_eq!(out, [[0.0; 3]; 2]);
        shade_vector(&surface, &[1e30; 12], Order::new(2).unwrap(), &mut out);
        assert_eq!(out, [[0.0; 3], [2e30; 3]]);
    }

    #[test]
    #[should_panic(expected = "order 2 exceeds the stored order 1")]
    fn more_bands_than_stored_are_refused() {
        let surface = Surface::new(&[], &[], &[], Order::new(1).unwrap(), 1, &[]).unwrap();
        shade_vector(&surface, &[0.0; 12], Order::new(2).unwrap(), &mut []);
    }
}
