//! What interreflection remembers of a ray.

/// A point that light may come from after a reflection, and how much of it: all that a pass of interreflection needs besides the
/// transfer of the last one and the faces, neither materials nor textures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct HitRecord {
    triangle: u32,
    /// Weights of the second and the third corner, in units of 1/65535; together at most 1.
    barycentric: [u16; 2],
    /// The weight of the ray that found it, `max(n·s, 0) Δω / π` (see `Scratch::solid_angle` of the direct pass), times the largest
    /// channel of the albedo at the point.
    weight: f32,
    hue: Hue,
}

/// A colour relative to its largest channel: which one that is, and the two others in units of [`Hue::FULL`]. Grey is exact, no channel
/// exceeds the largest, and the error is below 1.6e-5.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Hue(u32);

impl Hue {
    const BITS: u32 = 15;
    const FULL: u32 = (1 << Self::BITS) - 1;

    /// The largest channel, and the hue.
    fn split(color: [f32; 3]) -> (f32, Self) {
        let largest =
            (1..3).fold(0, |largest, channel| if color[channel] > color[largest] { channel } else { largest });
        let full = color[largest];
        if full <= 0.0 {
            return (0.0, Self(Self::FULL << Self::BITS | Self::FULL));
        }
        let quantized = |channel: usize| ((color[channel] / full).clamp(0.0, 1.0) * Self::FULL as f32).round() as u32;
        let [second, third] = [quantized((largest + 1) % 3), quantized((largest + 2) % 3)];
        (full, Self((largest as u32) << (2 * Self::BITS) | second << Self::BITS | third))
    }

    fn channels(self) -> [f32; 3] {
        let largest = (self.0 >> (2 * Self::BITS)) as usize % 3;
        let share = |bits: u32| (bits & Self::FULL) as f32 / Self::FULL as f32;
        let mut channels = [1.0; 3];
        channels[(largest + 1) % 3] = share(self.0 >> Self::BITS);
        channels[(largest + 2) % 3] = share(self.0);
        channels
    }
}

impl HitRecord {
    /// Bytes of a record in a journal.
    pub(crate) const SIZE: usize = 16;

    /// - `barycentric`: weights of the second and the third corner
    /// - `weight`: of the ray
    /// - `albedo`: at the point, 0 to 1
    pub(crate) fn new(triangle: u32, barycentric: [f32; 2], weight: f32, albedo: [f32; 3]) -> Self {
        let [b, c] = barycentric.map(|weight| (weight.clamp(0.0, 1.0) * f32::from(u16::MAX)).round() as u16);
        let (full, hue) = Hue::split(albedo);
        Self { triangle, barycentric: [b, c.min(u16::MAX - b)], weight: weight * full, hue }
    }

    pub(crate) fn triangle(&self) -> u32 {
        self.triangle
    }

    /// Weights of the three corners; none is negative, and they add up to 1.
    pub(crate) fn corner_weights(&self) -> [f64; 3] {
        let [b, c] = self.barycentric.map(u32::from);
        [u32::from(u16::MAX) - b - c, b, c].map(|weight| f64::from(weight) / f64::from(u16::MAX))
    }

    /// The weight of the ray times the albedo, for each channel.
    pub(crate) fn weights(&self) -> [f32; 3] {
        self.hue.channels().map(|share| share * self.weight)
    }

    pub(crate) fn to_bytes(self) -> [u8; Self::SIZE] {
        let [a, b, c, d] = self.triangle.to_le_bytes();
        let [[e, f], [g, h]] = self.barycentric.map(u16::to_le_bytes);
        let [i, j, k, l] = self.weight.to_le_bytes();
        let [m, n, o, p] = self.hue.0.to_le_bytes();
        [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p]
    }

    pub(crate) fn from_bytes(&[a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p]: &[u8; Self::SIZE]) -> Self {
        let [second, third] = [[e, f], [g, h]].map(u16::from_le_bytes);
        Self {
            triangle: u32::from_le_bytes([a, b, c, d]),
            barycentric: [second, third.min(u16::MAX - second)],
            weight: f32::from_le_bytes([i, j, k, l]),
            hue: Hue(u32::from_le_bytes([m, n, o, p])),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const WHITE: [f32; 3] = [1.0; 3];

    #[test]
    fn a_record_takes_sixteen_bytes() {
        assert_eq!(size_of::<HitRecord>(), HitRecord::SIZE);
        let record = HitRecord::new(0x0403_0201, [0.0, 1.0], 1.0, [1.0, 0.0, 1.0]);
        let hue = Hue::FULL.to_le_bytes();
        assert_eq!(record.to_bytes(), [1, 2, 3, 4, 0, 0, 255, 255, 0, 0, 128, 63, hue[0], hue[1], hue[2], hue[3]]);
    }

    #[test]
    fn grey_is_exact_and_black_reflects_nothing() {
        for albedo in [1.0, 0.8, 1e-3, 1e-30] {
            assert_eq!(HitRecord::new(7, [0.2, 0.3], 0.125, [albedo; 3]).weights(), [0.125 * albedo; 3]);
        }
        assert_eq!(HitRecord::new(7, [0.2, 0.3], 0.125, [0.0; 3]).weights(), [0.0; 3]);
    }

    proptest! {
        #[test]
        fn no_channel_exceeds_the_albedo_by_more_than_a_step(
            albedo in prop::array::uniform3(0.0_f32..=1.0),
            weight in 0.0_f32..1.0,
        ) {
            let record = HitRecord::new(1, [0.5, 0.5], weight, albedo);
            let largest = albedo.iter().copied().fold(0.0, f32::max);
            for (given, kept) in albedo.iter().zip(record.weights()) {
                prop_assert!((kept - weight * given).abs() <= 1.6e-5 * weight * largest + 1e-9);
                prop_assert!(kept <= weight * largest, "a channel above the largest");
            }
        }

        #[test]
        fn corner_weights_mix(b in -0.1_f32..1.1, c in -0.1_f32..1.1) {
            let weights = HitRecord::new(1, [b, c], 1.0, WHITE).corner_weights();
            prop_assert!(weights.iter().all(|&weight| weight >= 0.0), "{weights:?}");
            prop_assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-15);
        }

        #[test]
        fn bytes_and_back(bytes in prop::array::uniform16(any::<u8>()), albedo in prop::array::uniform3(0.0_f32..=1.0)) {
            let record = HitRecord::new(u32::from(bytes[0]) << 24, [0.1, 0.7], 0.3, albedo);
            prop_assert_eq!(HitRecord::from_bytes(&record.to_bytes()), record);
            // Damage makes no weights that a sum could not stand.
            let damaged = HitRecord::from_bytes(&bytes);
            prop_assert!(damaged.corner_weights().iter().all(|&weight| weight >= 0.0));
            prop_assert!(damaged.hue.channels().iter().all(|share| (0.0..=1.0).contains(share)));
        }
    }
}
