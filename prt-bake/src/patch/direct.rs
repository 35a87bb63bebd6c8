//! Light that reaches the texels of an opaque patch straight from the environment, and where the relief blocks it.

use glam::{DVec3, Vec3};

use super::surface::{Side, Surface};
use crate::VertexStats;
use crate::diffuse::{HitRecord, add_scaled};
use crate::sampling::DirectionSet;
use crate::transfer::unshadowed_vector;

/// All that the rays of one bake share.
#[derive(Debug, Clone, Copy)]
pub(super) struct DirectPass<'a> {
    pub(super) surface: &'a Surface,
    pub(super) directions: &'a DirectionSet,
    pub(super) normals: &'a [[f32; 3]],
    pub(super) heights: &'a [f32],
}

/// What the rays of one texel found.
#[derive(Debug, Default)]
pub(super) struct Found {
    /// Rays above the horizon of the texel.
    pub(super) rays: u64,
    /// Sum of their cosines.
    cosines: f64,
    /// Those that met the surface: the number of the direction, its cosine, and where.
    pub(super) occluded: Vec<Occluded>,
}

/// A ray that met the surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Occluded {
    pub(super) direction: usize,
    cosine: f32,
    triangle: u32,
    barycentric: [f32; 2],
}

impl Occluded {
    /// A record of where light may come from, weighted.
    pub(super) fn record(&self, weight: f64, albedo: [f32; 3]) -> HitRecord {
        HitRecord::new(self.triangle, self.barycentric, weight as f32, albedo)
    }
}

impl DirectPass<'_> {
    /// Traces all directions above the horizon of a texel.
    pub(super) fn trace(&self, texel: usize, found: &mut Found) {
        let normal = Vec3::from_array(self.normals[texel]);
        let origin = self.surface.texel(texel, self.heights[texel]);
        found.occluded.clear();
        (found.rays, found.cosines) = (0, 0.0);
        for (number, direction) in self.directions.directions.iter().enumerate() {
            let cosine = normal.dot(*direction);
            if cosine <= 0.0 {
                continue;
            }
            found.rays += 1;
            found.cosines += f64::from(cosine);
            let point = self.surface.follow(origin, unit(*direction), f64::INFINITY, Side::Above).point;
            found.occluded.extend(point.map(|point| Occluded {
                direction: number,
                cosine,
                triangle: point.triangle as u32,
                barycentric: point.barycentric,
            }));
        }
    }

    /// Basis functions `[n²]` at a direction.
    pub(super) fn basis(&self, direction: usize) -> &[f32] {
        let coeff_count = self.directions.order.coeff_count();
        &self.directions.basis[direction * coeff_count..][..coeff_count]
    }

    /// The diffuse transfer vector of a texel: the unshadowed one less the occluded directions.
    pub(super) fn diffuse_vector(&self, texel: usize, found: &mut Found) -> Vec<f64> {
        self.trace(texel, found);
        let mut vector = vec![0.0; self.directions.order.coeff_count()];
        unshadowed_vector(self.directions.order, self.normals[texel], &mut vector);
        for ray in &found.occluded {
            add_scaled(&mut vector, self.basis(ray.direction), -found.weight(ray));
        }
        vector
    }
}

impl Found {
    /// `max(n·s, 0) Δω / π` of a ray, scaled so that those of all rays of the texel add up to 1: a texel that sees nothing is black.
    fn weight(&self, ray: &Occluded) -> f64 {
        f64::from(ray.cosine) / self.cosines
    }

    /// Rays and how many of them were occluded.
    pub(super) fn stats(&self) -> VertexStats {
        let rays = u32::try_from(self.rays).expect("fewer directions than 2^32");
        VertexStats { directions: rays, rays, occluded: self.occluded.len() as u32, ..VertexStats::default() }
    }

    /// Where diffuse light may come from after a reflection.
    pub(super) fn records(&self, albedo: [f32; 3]) -> Vec<HitRecord> {
        self.occluded.iter().map(|ray| ray.record(self.weight(ray), albedo)).collect()
    }
}

/// A direction in `f64`, of unit length there.
pub(super) fn unit(direction: Vec3) -> DVec3 {
    direction.as_dvec3().normalize()
}
