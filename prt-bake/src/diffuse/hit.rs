//! What interreflection remembers of a ray.

/// A point that light may come from after a reflection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct HitRecord {
    triangle: u32,
    /// Weights of the second and the third corner, in units of 1/65535.
    barycentric: [u16; 2],
    /// `max(n·s, 0) Δω / π` of the ray that found it; see `Scratch::solid_angle` of the direct pass.
    pub(super) weight: f32,
}

impl HitRecord {
    pub(crate) fn new(triangle: u32, barycentric: [f32; 2], weight: f32) -> Self {
        let quantized = barycentric.map(|weight| (weight.clamp(0.0, 1.0) * f32::from(u16::MAX)).round() as u16);
        Self { triangle, barycentric: quantized, weight }
    }

    pub(crate) fn triangle(&self) -> u32 {
        self.triangle
    }

    /// Weights of the three corners.
    pub(crate) fn corner_weights(&self) -> [f64; 3] {
        let [b, c] = self.barycentric.map(|weight| f64::from(weight) / f64::from(u16::MAX));
        [1.0 - b - c, b, c]
    }
}
