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
    /// Bytes of a record in a journal.
    pub(crate) const SIZE: usize = 12;

    pub(crate) fn to_bytes(self) -> [u8; Self::SIZE] {
        let [a, b, c, d] = self.triangle.to_le_bytes();
        let [[e, f], [g, h]] = self.barycentric.map(u16::to_le_bytes);
        let [i, j, k, l] = self.weight.to_le_bytes();
        [a, b, c, d, e, f, g, h, i, j, k, l]
    }

    pub(crate) fn from_bytes(&[a, b, c, d, e, f, g, h, i, j, k, l]: &[u8; Self::SIZE]) -> Self {
        Self {
            triangle: u32::from_le_bytes([a, b, c, d]),
            barycentric: [u16::from_le_bytes([e, f]), u16::from_le_bytes([g, h])],
            weight: f32::from_le_bytes([i, j, k, l]),
        }
    }

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
