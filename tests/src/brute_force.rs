//! Transfer by the shortest program that can compute it: random directions, every triangle, `f64`.

use glam::DVec3;
use prt_bake::Mesh;
use sh_core::Order;

/// A Monte Carlo estimate of a vector, and the standard error of its entries together.
#[derive(Debug, Clone)]
pub struct Estimate {
    /// Mean of the samples `[n²]`.
    pub mean: Vec<f64>,
    /// Root of the sum of the variances of the means: the expected length of the error.
    pub standard_error: f64,
}

/// The shadowed transfer vector of one vertex from `samples` independent cosine-distributed directions. The faces at the vertex itself are left out.
#[must_use]
pub fn brute_force_transfer(mesh: &Mesh, vertex: usize, order: Order, samples: usize, seed: u64) -> Estimate {
    let origin = DVec3::from_array(mesh.positions()[vertex]);
    let normal = DVec3::from_array(mesh.normals()[vertex].map(f64::from)).normalize();
    let corners = |triangle: &[u32; 3]| triangle.map(|vertex| DVec3::from_array(mesh.positions()[vertex as usize]));
    let triangles: Vec<_> = mesh.triangles().iter().map(corners).filter(|face| !face.contains(&origin)).collect();
    let mut random = Random(seed ^ (vertex as u64) << 32);
    let (mut sum, mut squares) = (vec![0.0; order.coeff_count()], 0.0);
    let mut basis = vec![0.0; order.coeff_count()];
    for _ in 0..samples {
        let direction = random.cosine_direction(normal);
        if triangles.iter().any(|face| is_hit(face, origin, direction)) {
            continue;
        }
        // The density is cos / π, so that the sample of 1/π V cos y is y itself.
        sh_core::eval(order, direction.to_array(), &mut basis);
        sum.iter_mut().zip(&basis).for_each(|(sum, y)| *sum += y);
        squares += basis.iter().map(|y| y * y).sum::<f64>();
    }
    let count = samples as f64;
    let mean: Vec<f64> = sum.iter().map(|sum| sum / count).collect();
    let variance = squares / count - mean.iter().map(|mean| mean * mean).sum::<f64>();
    Estimate { mean, standard_error: (variance / count).sqrt() }
}

/// Möller and Trumbore's test.
fn is_hit([a, b, c]: &[DVec3; 3], origin: DVec3, direction: DVec3) -> bool {
    let p = direction.cross(c - a);
    let determinant = p.dot(b - a);
    let u = p.dot(origin - a) / determinant;
    let q = (origin - a).cross(b - a);
    let (v, t) = (q.dot(direction) / determinant, q.dot(c - a) / determinant);
    u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0
}

/// xorshift64* (Vigna 2016): another generator than the library's.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = if self.0 == 0 { 0x9e37_79b9 } else { self.0 };
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn cosine_direction(&mut self, normal: DVec3) -> DVec3 {
        let (radius, angle) = (self.unit().sqrt(), std::f64::consts::TAU * self.unit());
        let (u, v) = normal.any_orthonormal_pair();
        radius * (angle.cos() * u + angle.sin() * v) + (1.0 - radius * radius).sqrt() * normal
    }
}
