/// Radiance up to here is shown as it is; above, highlights are compressed.
///
/// Written once here and once in `shaders/shared/tone_map.wgsl`; a test holds them together.
const SHOULDER_START: f32 = 0.532;

/// Linear radiance to display-referred sRGB, 0 to 1.
///
/// Radiance times `2^exposure_stops` is kept exactly up to 0.532 and approaches 1 above by an exponential shoulder of equal slope,
/// `1 − (1 − s) exp(−(x − s)/(1 − s))` with s = 0.532, for each channel. Then the sRGB transfer function encodes it.
/// So mid-tones and their ratios are those of the scene, which pictures for comparison need. Negative numbers and NaN give 0,
/// infinity gives 1 within rounding.
///
/// Source: H. Uchimura, "HDR theory and practice", CEDEC 2017: his curve with a = 1, m = 0.22, l = 0.4, P = 1 and without its toe
/// (c = 1, b = 0), so that s = m + (P − m) l; IEC 61966-2-1 for sRGB.
pub fn tone_map(pixel: [f32; 3], exposure_stops: f32) -> [f32; 3] {
    let exposure = exposure_stops.exp2();
    pixel.map(|x| encode_srgb(compress(x * exposure)))
}

fn compress(x: f32) -> f32 {
    const RANGE: f32 = 1.0 - SHOULDER_START;
    // `max` drops NaN.
    let x = x.max(0.0);
    let shoulder = 1.0 - RANGE * (-(x - SHOULDER_START) / RANGE).exp();
    if x <= SHOULDER_START { x } else { shoulder }
}

fn encode_srgb(x: f32) -> f32 {
    if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mid_tones_are_plain_srgb() {
        // sRGB of linear 0.18 and 0.5, IEC 61966-2-1.
        let [dark, grey, half] = tone_map([0.0, 0.18, 0.5], 0.0);
        assert_eq!(dark, 0.0);
        assert!((grey - 0.461_356).abs() < 1e-5);
        assert!((half - 0.735_357).abs() < 1e-5);
    }

    #[test]
    fn the_curve_is_smooth_and_increasing_up_to_one() {
        let curve: Vec<f32> = (0..4000).map(|i| compress(i as f32 * 0.001)).collect();
        assert!(curve.windows(2).all(|pair| pair[1] >= pair[0]));
        assert!(curve.windows(3).all(|w| (w[2] - 2.0 * w[1] + w[0]).abs() < 4e-6), "slope jumps");
        assert!(curve[3999] < 1.0 && curve[3999] > 0.99);
    }

    #[test]
    fn exposure_counts_in_stops() {
        let close = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).all(|(x, y)| (x - y).abs() < 1e-6);
        assert!(close(tone_map([0.1, 0.2, 0.4], 1.0), tone_map([0.2, 0.4, 0.8], 0.0)));
        assert!(close(tone_map([0.1, 0.2, 0.4], -3.0), tone_map([0.0125, 0.025, 0.05], 0.0)));
    }

    #[test]
    fn extremes_stay_in_range() {
        let [negative, nan, infinite] = tone_map([-1.0, f32::NAN, f32::INFINITY], 0.0);
        assert_eq!((negative, nan), (0.0, 0.0));
        let [huge, largest, tiny] = tone_map([1e30, f32::MAX, 1e-30], 10.0);
        // 1.055 - 0.055 rounds to the number below 1.
        assert!([infinite, huge, largest].iter().all(|x| (1.0 - 1e-7..=1.0).contains(x)));
        assert!((0.0..1e-20).contains(&tiny));
    }
}
