//! Radiance pictures.

use prt_bake::Image;

use crate::scratch::{assert_near, assert_refused, image};

/// A file of flat pixels.
fn flat(header: &str, size: &str, pixels: &[[u8; 4]]) -> Vec<u8> {
    [format!("#?RADIANCE\n{header}\n{size}\n").as_bytes(), pixels.as_flattened()].concat()
}

const RGBE: &str = "FORMAT=32-bit_rle_rgbe\n";

/// A picture of 2 × 3 pixels whose red counts up in reading order.
fn counted() -> Vec<[u8; 4]> {
    (1..=6).map(|i| [i, 0, 0, 136]).collect()
}

#[test]
fn values_are_mantissa_times_power_of_two() {
    let pixels = [[128, 64, 255, 129], [1, 2, 3, 0], [255, 255, 255, 255], [1, 0, 0, 1]];
    let picture = image("hdr", flat(RGBE, "-Y 1 +X 4", &pixels)).unwrap();
    let largest = 255.0 * 2_f32.powi(119);
    // The smallest unit, 2^-135, is subnormal in f32 and still exact.
    assert_eq!(picture.pixels, [[1.0, 0.5, 255.0 / 128.0], [0.0; 3], [largest; 3], [2_f32.powi(-135), 0.0, 0.0]]);
}

#[test]
fn eight_orientations() {
    // The red of each pixel of the picture, row by row from the top, when the file counts from 1.
    for (size, width, expected) in [
        ("-Y 3 +X 2", 2, [1, 2, 3, 4, 5, 6]),
        ("-Y 3 -X 2", 2, [2, 1, 4, 3, 6, 5]),
        ("+Y 3 +X 2", 2, [5, 6, 3, 4, 1, 2]),
        ("+Y 3 -X 2", 2, [6, 5, 4, 3, 2, 1]),
        ("+X 2 -Y 3", 2, [1, 4, 2, 5, 3, 6]),
        ("-X 2 -Y 3", 2, [4, 1, 5, 2, 6, 3]),
        ("+X 2 +Y 3", 2, [3, 6, 2, 5, 1, 4]),
        ("-X 2 +Y 3", 2, [6, 3, 5, 2, 4, 1]),
    ] {
        let picture = image("hdr", flat(RGBE, size, &counted())).unwrap();
        assert_eq!((picture.width, picture.height), (width, 3), "{size}");
        let reds: Vec<_> = picture.pixels.iter().map(|pixel| pixel[0] as i32).collect();
        assert_eq!(reds, expected, "{size}");
    }
}

#[test]
fn exposure_and_colour_correction_are_undone() {
    let header = "EXPOSURE=2\n EXPOSURE = 4\nCOLORCORR= 1 2 0.5\n# comment\nVIEW= -vf x\n";
    let picture = image("hdr", flat(&format!("{header}{RGBE}"), "-Y 1 +X 1", &[[16, 32, 64, 136]])).unwrap();
    assert_eq!(picture.pixels, [[2.0, 2.0, 16.0]]);
    for bad in ["EXPOSURE=0\n", "EXPOSURE=-1\n", "EXPOSURE=nan\n", "COLORCORR=1 1 0\n"] {
        assert_refused(image("hdr", flat(bad, "-Y 1 +X 1", &[[1; 4]])), "its exposure is");
    }
    assert_refused(image("hdr", flat("EXPOSURE=bright\n", "-Y 1 +X 1", &[[1; 4]])), "its EXPOSURE is not 1 numbers");
    assert_refused(image("hdr", flat("COLORCORR=1 1\n", "-Y 1 +X 1", &[[1; 4]])), "its COLORCORR is not 3 numbers");
}

#[test]
fn xyz_and_other_primaries() {
    let xyze = "FORMAT=32-bit_rle_xyze\n";
    let white = image("hdr", flat(xyze, "-Y 1 +X 1", &[[128, 128, 128, 129]])).unwrap();
    assert_near(&white.pixels[0], &[1.0; 3], 1e-6);
    // Red of chromaticity (0.64, 0.33) has X : Y : Z = 64 : 33 : 3.
    let red = image("hdr", flat(xyze, "-Y 1 +X 1", &[[64, 33, 3, 136]])).unwrap().pixels[0];
    assert!(red[0] > 50.0 && red[1].abs() < 1e-4 && red[2].abs() < 1e-4, "{red:?}");

    let zeros = "PRIMARIES=0 0 0 0 0 0 0 0\n";
    assert_eq!(image("hdr", flat(zeros, "-Y 1 +X 1", &[[3, 2, 1, 136]])).unwrap().pixels, [[3.0, 2.0, 1.0]]);
    let acescg = "PRIMARIES=0.713 0.293 0.165 0.830 0.128 0.044 0.32168 0.33767\n";
    let gray = image("hdr", flat(acescg, "-Y 1 +X 2", &[[7, 7, 7, 136], [100, 0, 0, 136]])).unwrap();
    assert_near(&gray.pixels[0], &[7.0; 3], 1e-5);
    assert!(gray.pixels[1][0] > 150.0 && gray.pixels[1][1] < 0.0, "{:?}", gray.pixels[1]);
}

/// Encodes lines of at least 8 pixels with the new run lengths.
pub(crate) fn new_runs(width: usize, lines: &[Vec<[u8; 4]>]) -> Vec<u8> {
    let mut bytes = flat(RGBE, &format!("-Y {} +X {width}", lines.len()), &[]);
    for line in lines {
        bytes.extend([2, 2, (width >> 8) as u8, width as u8]);
        for channel in 0..4 {
            let mut values: Vec<u8> = line.iter().map(|pixel| pixel[channel]).collect();
            while let Some(&first) = values.first() {
                let run = values.iter().take_while(|&&value| value == first).count().min(127);
                if run > 2 {
                    bytes.extend([128 + run as u8, first]);
                    values.drain(..run);
                } else {
                    let count = values.len().min(5);
                    bytes.push(count as u8);
                    bytes.extend(values.drain(..count));
                }
            }
        }
    }
    bytes
}

#[test]
fn old_and_new_run_lengths_agree_with_flat_pixels() {
    let line = |seed: usize| -> Vec<[u8; 4]> {
        (0..300)
            .map(|x| if (x / 40 + seed).is_multiple_of(2) { [9, 8, 7, 140] } else { [x as u8, seed as u8, 0, 130] })
            .collect()
    };
    let lines = [line(0), line(1)];
    let expected = image("hdr", flat(RGBE, "-Y 2 +X 300", &lines.concat())).unwrap();
    assert_eq!(image("hdr", new_runs(300, &lines)).unwrap(), expected);
    assert_eq!(image("HDR", [b"#?RGBE\n\n-Y 2 +X 300\n", lines.concat().as_flattened()].concat()).unwrap(), expected);

    // Old: 300 = 1 + 0x2b + (0x01 << 8), the low byte first.
    let old = flat(RGBE, "-Y 1 +X 300", &[[5, 5, 5, 136], [1, 1, 1, 0x2b], [1, 1, 1, 1]]);
    assert_eq!(image("hdr", old).unwrap(), Image { width: 300, height: 1, pixels: vec![[5.0; 3]; 300] });
    let twice = flat(RGBE, "-Y 1 +X 5", &[[5, 5, 5, 136], [1, 1, 1, 1], [7, 7, 7, 136], [1, 1, 1, 2]]);
    let reds: Vec<_> = image("hdr", twice).unwrap().pixels.iter().map(|pixel| pixel[0]).collect();
    assert_eq!(reds, [5.0, 5.0, 7.0, 7.0, 7.0]);
}

#[test]
fn truncation_at_any_byte_is_an_error() {
    let bytes = new_runs(20, &[(0..20).map(|x| [x, x / 4, 3, 128 + x / 9]).collect(), vec![[4, 4, 4, 140]; 20]]);
    image("hdr", &bytes).unwrap();
    for length in 0..bytes.len() {
        assert_refused(image("hdr", &bytes[..length]), "is not a valid Radiance HDR file");
    }
}

#[test]
fn bad_input() {
    let runs = |body: &[u8]| [flat(RGBE, "-Y 1 +X 8", &[]), body.to_vec()].concat();
    for (bytes, words) in [
        (Vec::new(), "it is empty"),
        (b"P6\n".to_vec(), "does not begin with `#?RADIANCE`"),
        (
            flat("FORMAT=32-bit_rle_luv\n", "-Y 1 +X 1", &[]),
            "the format `32-bit_rle_luv` of Radiance pictures is not supported",
        ),
        (flat(RGBE, "-Y 1 +X", &[]), "`-Y 1 +X` is not a picture size"),
        (flat(RGBE, "-Y 1 +Y 1", &[]), "is not a picture size"),
        (flat(RGBE, "-Y 1 +X -5", &[]), "is not a picture size"),
        (flat(RGBE, "-Y 0 +X 4", &[]), "its size is 4 × 0"),
        (flat(RGBE, "-Y 2147483647 +X 2147483647", &[[1; 4]]), "more than its 4 bytes can hold"),
        (flat(RGBE, "-Y 99999999999 +X 99999999999", &[[1; 4]]), "99999999999 × 99999999999 (more than"),
        (flat(RGBE, "-Y 1 +X 2", &[[9; 4]]), "line 0 of 1 ends early"),
        (flat(RGBE, "-Y 1 +X 2", &[[1, 1, 1, 9]]), "line 0 of 1 begins with a repeat"),
        (flat(RGBE, "-Y 1 +X 2", &[[9; 4], [1, 1, 1, 9]]), "a run of 9 pixels where 1 are left"),
        (
            flat(RGBE, "-Y 1 +X 9", &[[9; 4], [1, 1, 1, 0], [1, 1, 1, 0], [1, 1, 1, 0], [1, 1, 1, 255]]),
            "a run of 4278190080 pixels",
        ),
        (runs(&[2, 2, 0, 9]), "claims 9 pixels in place of 8"),
        (runs(&[2, 2, 0, 8, 0]), "a run of 0 pixels where 8 are left"),
        (runs(&[2, 2, 0, 8, 137, 1]), "a run of 9 pixels where 8 are left"),
        (runs(&[2, 2, 0, 8, 4, 1]), "ends early"),
    ] {
        assert_refused(image("hdr", bytes), words);
    }
}
