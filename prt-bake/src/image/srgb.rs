//! The sRGB transfer curve (IEC 61966-2-1).

use std::sync::LazyLock;

/// Display value in 0..1 to linear.
pub(crate) fn srgb_to_linear(value: f32) -> f32 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// Linear value to display value in 0..1; what lies outside is clamped.
pub(crate) fn linear_to_srgb(value: f32) -> f32 {
    let value = value.clamp(0.0, 1.0);
    if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 }
}

/// 8-bit display value to linear.
pub(crate) fn srgb8_to_linear(value: u8) -> f32 {
    static TABLE: LazyLock<[f32; 256]> =
        LazyLock::new(|| std::array::from_fn(|value| srgb_to_linear(value as f32 / 255.0)));
    TABLE[usize::from(value)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values_and_round_trip() {
        assert_eq!(srgb8_to_linear(0), 0.0);
        assert_eq!(srgb8_to_linear(255), 1.0);
        // 188/255 is the display value nearest to half the light.
        assert!((srgb8_to_linear(188) - 0.502_886_5).abs() < 1e-6);
        for value in 0..=255 {
            assert_eq!((linear_to_srgb(srgb8_to_linear(value)) * 255.0).round() as u8, value);
        }
    }
}
