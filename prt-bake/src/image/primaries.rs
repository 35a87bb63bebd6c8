//! From other primaries to those of sRGB.

use glam::{DMat3, DVec3};

/// Chromaticities x, y of red, green, blue and white.
pub(super) type Chromaticities = [[f64; 2]; 4];

/// Those of Rec. 709 and sRGB, with D65.
const SRGB: Chromaticities = [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06], [0.3127, 0.3290]];

/// The white of equal energy.
const EQUAL_ENERGY: [f64; 2] = [1.0 / 3.0, 1.0 / 3.0];

/// Primaries this near to sRGB's are taken for them. Radiance's own differ by 0.01 in one coordinate, and its programs
/// write them over data of whatever origin, so a conversion would do more harm than good.
const TOLERANCE: f64 = 0.012;

/// What takes linear colours in these primaries to linear sRGB; `None` where nothing need be done, or nothing can be,
/// because the primaries do not span the colours (Photoshop writes eight zeros).
///
/// White stays neutral: only the primaries differ, both sets taken about the file's own white.
pub(super) fn to_srgb(from: Chromaticities) -> Option<DMat3> {
    let near = |[a, b]: [[f64; 2]; 2]| (a[0] - b[0]).abs() <= TOLERANCE && (a[1] - b[1]).abs() <= TOLERANCE;
    if (0..3).all(|i| near([from[i], SRGB[i]])) {
        return None;
    }
    let conversion = xyz_from_rgb(with_white(SRGB, from[3])).inverse() * xyz_from_rgb(from);
    Some(conversion).filter(|matrix| matrix.is_finite())
}

/// CIE XYZ to linear sRGB about the white of equal energy.
pub(super) fn from_xyz() -> DMat3 {
    xyz_from_rgb(with_white(SRGB, EQUAL_ENERGY)).inverse()
}

/// Converts a pixel.
pub(super) fn convert(matrix: DMat3, pixel: [f32; 3]) -> [f32; 3] {
    (matrix * DVec3::from(pixel.map(f64::from))).as_vec3().to_array()
}

fn with_white([red, green, blue, _]: Chromaticities, white: [f64; 2]) -> Chromaticities {
    [red, green, blue, white]
}

/// The primaries as columns, scaled so that they add up to white of luminance 1.
fn xyz_from_rgb([red, green, blue, white]: Chromaticities) -> DMat3 {
    let xyz = |[x, y]: [f64; 2]| DVec3::new(x, y, 1.0 - x - y) / y;
    let unscaled = DMat3::from_cols(xyz(red), xyz(green), xyz(blue));
    unscaled * DMat3::from_diagonal(unscaled.inverse() * xyz(white))
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]

    use super::*;

    #[test]
    fn equal_energy_becomes_gray() {
        assert!((from_xyz() * DVec3::ONE - DVec3::ONE).length() < 1e-12);
    }

    /// The matrix printed in IEC 61966-2-1 for D65, 4 digits.
    #[test]
    fn srgb_matrix() {
        let expected =
            DMat3::from_cols_array_2d(&[[0.4124, 0.2126, 0.0193], [0.3576, 0.7152, 0.1192], [0.1805, 0.0722, 0.9505]]);
        assert!(xyz_from_rgb(SRGB).abs_diff_eq(expected, 1e-4));
    }

    #[test]
    fn conversion_keeps_white_and_maps_primaries() {
        let acescg = [[0.713, 0.293], [0.165, 0.830], [0.128, 0.044], [0.321_68, 0.337_67]];
        let matrix = to_srgb(acescg).unwrap();
        assert!((matrix * DVec3::ONE - DVec3::ONE).length() < 1e-12);
        // The red of the wider set has negative green and blue in the narrower one.
        let red = matrix * DVec3::X;
        assert!(red.x > 1.5 && red.y < 0.0 && red.z < 0.0, "{red}");
    }

    #[test]
    fn radiance_primaries_and_nonsense_change_nothing() {
        for primaries in [
            [[0.64, 0.33], [0.29, 0.60], [0.15, 0.06], [0.3333, 0.3333]],
            [[0.0; 2]; 4],
            [[0.3, 0.3]; 4],
            [[0.6, 0.0], [0.3, 0.6], [0.15, 0.06], [0.3, 0.3]],
            [[f64::NAN; 2]; 4],
        ] {
            assert_eq!(to_srgb(primaries), None, "{primaries:?}");
        }
    }
}
