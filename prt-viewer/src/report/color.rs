//! False colours: from a number to a colour that people tell apart, in both themes and with any kind of colour vision.

/// What a surface without a value looks like, linear.
pub(super) const MISSING: [f32; 3] = [0.26, 0.27, 0.28];

/// A sequence of colours, from few to many.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Ramp {
    /// Black to white, in even steps for the eye.
    Light,
    /// Blue over rose to yellow: attention rises with it. Every eighth of matplotlib's `plasma`, less its dark end.
    Heat,
    /// Violet over green to yellow. Every eighth of matplotlib's `viridis`, less its dark end.
    Work,
}

const HEAT: [u32; 7] = [0x4c02a1, 0x7e03a8, 0xaa2395, 0xcc4778, 0xe66c5c, 0xf89540, 0xfdc527];
const WORK: [u32; 7] = [0x472d7b, 0x3b528b, 0x2c728e, 0x21918c, 0x28ae80, 0x5ec962, 0xaddc30];

impl Ramp {
    /// The linear colour of a share from 0 to 1.
    pub(super) fn color(self, share: f32) -> [f32; 3] {
        let share = share.clamp(0.0, 1.0);
        match self {
            Self::Light => [decode_srgb(share); 3],
            Self::Heat => between(&HEAT, share),
            Self::Work => between(&WORK, share),
        }
    }
}

/// Interpolates display colours, and makes the result linear.
fn between(colors: &[u32], share: f32) -> [f32; 3] {
    let at = share * (colors.len() - 1) as f32;
    let first = (at as usize).min(colors.len() - 2);
    let [a, b] = [colors[first], colors[first + 1]].map(channels);
    std::array::from_fn(|k| decode_srgb(a[k] + (at - first as f32) * (b[k] - a[k])))
}

fn channels(rgb: u32) -> [f32; 3] {
    [rgb >> 16, rgb >> 8, rgb].map(|channel| (channel & 255) as f32 / 255.0)
}

/// IEC 61966-2-1.
pub(super) fn decode_srgb(x: f32) -> f32 {
    if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

/// The inverse of [`decode_srgb`], as a byte.
pub(super) fn encode_srgb(x: f32) -> u8 {
    let x = x.clamp(0.0, 1.0);
    let encoded = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
    (255.0 * encoded).round() as u8
}

/// How a number becomes a share of a ramp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Scale {
    Linear {
        low: f64,
        high: f64,
    },
    /// Powers of ten, whole ones.
    Decades {
        first: i32,
        last: i32,
    },
}

impl Scale {
    /// Whole decades around positive numbers, at least one and at most six, the largest kept; from 1e-4 to 1e-3 for none.
    pub(super) fn decades_around(values: impl Iterator<Item = f32>) -> Self {
        let (low, high) = values
            .filter(|value| value.is_finite() && *value > 0.0)
            .fold((f32::INFINITY, 0.0_f32), |(low, high), value| (low.min(value), high.max(value)));
        if high <= 0.0 {
            return Self::Decades { first: -4, last: -3 };
        }
        let last = high.log10().ceil() as i32;
        let first = (low.log10().floor() as i32).clamp(last - 6, last - 1);
        Self::Decades { first, last }
    }

    /// The place of a value from 0 to 1: values off the scale are at its ends. None of NaN.
    pub(super) fn share(self, value: f32) -> Option<f32> {
        if value.is_nan() {
            return None;
        }
        let value = f64::from(value);
        let share = match self {
            Self::Linear { low, high } if high > low => (value - low) / (high - low),
            Self::Linear { .. } => 0.0,
            Self::Decades { first, last } => {
                (value.max(f64::MIN_POSITIVE).log10() - f64::from(first)) / f64::from(last - first)
            }
        };
        Some(share.clamp(0.0, 1.0) as f32)
    }
}

/// The linear colour of a value.
pub(super) fn false_color(ramp: Ramp, scale: Scale, value: f32) -> [f32; 3] {
    scale.share(value).map_or(MISSING, |share| ramp.color(share))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_of_the_display_is_undone() {
        for byte in 0..=255_u8 {
            assert_eq!(encode_srgb(decode_srgb(f32::from(byte) / 255.0)), byte);
        }
        assert_eq!([f32::NEG_INFINITY, f32::INFINITY].map(encode_srgb), [0, 255]);
    }

    #[test]
    fn ramps_get_brighter_without_a_break() {
        for ramp in [Ramp::Light, Ramp::Heat, Ramp::Work] {
            let luminance = |i: i32| {
                let [r, g, b] = ramp.color(i as f32 / 100.0);
                0.2126 * r + 0.7152 * g + 0.0722 * b
            };
            for i in 1..=100 {
                let step = luminance(i) - luminance(i - 1);
                assert!((0.0..0.03).contains(&step), "{ramp:?} at {i}: {step}");
            }
        }
        assert_eq!(Ramp::Heat.color(0.0).map(encode_srgb), [0x4c, 0x02, 0xa1]);
        assert_eq!(Ramp::Work.color(1.0).map(encode_srgb), [0xad, 0xdc, 0x30]);
    }

    #[test]
    fn decades_hold_the_values() {
        let around = |values: &[f32]| Scale::decades_around(values.iter().copied());
        assert_eq!(around(&[2e-4, 3e-2, f32::NAN, 0.0]), Scale::Decades { first: -4, last: -1 });
        assert_eq!(around(&[0.5]), Scale::Decades { first: -1, last: 0 });
        assert_eq!(around(&[1e-30, 0.5]), Scale::Decades { first: -6, last: 0 });
        assert_eq!(around(&[]), Scale::Decades { first: -4, last: -3 });
    }

    #[test]
    fn a_value_has_its_place() {
        let decades = Scale::Decades { first: -4, last: 0 };
        let at = |value| decades.share(value).map(|share| (share * 1000.0).round());
        assert_eq!([1e-4, 1e-2, 1.0].map(at), [0.0, 500.0, 1000.0].map(Some));
        assert_eq!([0.0, f32::INFINITY].map(at), [0.0, 1000.0].map(Some));
        assert_eq!(at(f32::NAN), None);
        assert_eq!(false_color(Ramp::Heat, decades, f32::NAN), MISSING);
        assert_eq!(Scale::Linear { low: 2.0, high: 2.0 }.share(2.0), Some(0.0));
    }
}
