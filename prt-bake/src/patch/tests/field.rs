//! Height fields: what is refused, and what the surface between texels is.

use proptest::prelude::*;

use super::*;

#[test]
fn wrong_fields_are_refused_by_name() {
    let wrong = [
        (HeightField::new(0, 3, vec![]), "0 × 3"),
        (HeightField::new(2, 2, vec![0.0; 3]), "3 heights for 2 × 2"),
        (HeightField::new(3, 2, vec![0.0, 0.0, 0.0, 0.0, f32::NAN, 0.0]), "column 1, row 1 is NaN"),
        (HeightField::new(2, 1, vec![0.0, f32::INFINITY]), "column 1, row 0 is inf"),
        (HeightField::new(1, 1, vec![-2e6]), "-2000000"),
        (HeightField::new(usize::MAX, 2, vec![]), "its size is"),
        (HeightField::new(1 << 13, 1 << 13, vec![]), "at most 16777216"),
        (HeightField::bumps(0, 0.1), "0 × 0"),
        (HeightField::swirl(1 << 40, 0.1), "1099511627776"),
        (HeightField::weave(8, f32::NAN), "column 0, row 0 is NaN"),
    ];
    for (result, reason) in wrong {
        let message = result.unwrap_err().to_string();
        assert!(message.contains(reason), "{message}");
    }
}

#[test]
fn options_out_of_range_are_errors() {
    let medium = |change: fn(&mut Medium)| {
        let mut medium = Medium::default();
        change(&mut medium);
        PatchOptions { scattering: Some(medium), ..options(2, 4) }
    };
    let wrong = [
        (options(33, 4), "order 33"),
        (PatchOptions { rays_per_texel: 0, ..options(2, 4) }, "0 rays"),
        (PatchOptions { albedo: [0.5, 1.5, 0.5], ..options(2, 4) }, "albedo"),
        (PatchOptions { bounces: 1, shadowed: false, ..options(2, 4) }, "without shadows"),
        (PatchOptions { thickness: Some(0.1), ..options(2, 4) }, "without a medium"),
        (PatchOptions { thickness: Some(-0.25), ..PatchOptions::thin() }, "thickness -0.25"),
        (PatchOptions { thickness: Some(f32::NAN), ..PatchOptions::thin() }, "thickness NaN"),
        (PatchOptions { bounces: 1, ..PatchOptions::thin() }, "paths follow all bounces"),
        (PatchOptions { responses: vec![vec![1.0]], ..PatchOptions::thin() }, "responses with a medium"),
        (PatchOptions { responses: vec![vec![1.0], vec![1.0; 3]], ..options(2, 4) }, "response 1 has 3"),
        (PatchOptions { responses: vec![vec![]], ..options(2, 4) }, "response 0 has 0"),
        (
            PatchOptions { responses: vec![vec![1.0, 0.0, f64::NAN, 0.0]], ..options(2, 4) },
            "coefficient 2 of response 0",
        ),
        (medium(|medium| medium.sigma_s[1] = -1.0), "sigma_s"),
        (medium(|medium| medium.sigma_a[2] = f32::NAN), "sigma_a"),
        (medium(|medium| medium.g = 1.0), "g 1"),
        (medium(|medium| medium.ior = 0.0), "refraction 0"),
    ];
    for (options, reason) in wrong {
        let message = bake_patch(&flat(2, 2), &options, &()).unwrap_err().to_string();
        assert!(message.contains(reason), "{message}");
    }
}

#[test]
fn patterns_tile_and_fill_their_range() {
    type Pattern = fn(usize, f32) -> Result<HeightField, Error>;
    let patterns: [(&str, Pattern); 4] = [
        ("bumps", HeightField::bumps),
        ("weave", HeightField::weave),
        ("waffle", HeightField::waffle),
        ("swirl", HeightField::swirl),
    ];
    for (name, pattern) in patterns {
        let field = pattern(64, 0.3).unwrap();
        let [lowest, highest] = field.range();
        assert!((0.0..0.03).contains(&lowest) && (0.27..=0.3).contains(&highest), "{name} {lowest} {highest}");
        let step = |texel: usize, by| (field.heights()[texel] - field.heights()[moved(&field, texel, by)]).abs();
        let steps =
            |texels: &mut dyn Iterator<Item = usize>, by| texels.map(|texel| step(texel, by)).fold(0.0, f32::max);
        // The step across the border is no larger than the largest inside.
        assert!(
            steps(&mut (0..64).map(|row| row * 64 + 63), [1, 0])
                <= steps(&mut (0..64 * 64 - 1).filter(|t| t % 64 != 63), [1, 0]),
            "{name}"
        );
        assert!(steps(&mut (63 * 64..64 * 64), [0, 1]) <= steps(&mut (0..63 * 64), [0, 1]), "{name}");
    }
}

#[test]
fn an_image_becomes_heights() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("grey.png");
    // 16 bits, 2 × 2: 0, 1/3, 2/3, 1 of the range; read as stored, not through the sRGB curve.
    let pixels: [u16; 4] = [0, 21845, 43690, 65535];
    let bytes: Vec<u8> = pixels.iter().flat_map(|value| value.to_be_bytes()).collect();
    ::image::save_buffer(&path, &bytes_in_native_order(&bytes), 2, 2, ::image::ExtendedColorType::L16).unwrap();
    let field = HeightField::from_image(&path, 0.3, None).unwrap();
    for (height, expected) in field.heights().iter().zip([0.0, 0.1, 0.2, 0.3]) {
        // A step of 16 bits is 4.6e-6.
        assert!((height - expected).abs() < 1e-6, "{height} {expected}");
    }
    let mean = HeightField::from_image(&path, 0.3, Some([1, 1])).unwrap();
    assert!((mean.heights()[0] - 0.15).abs() < 1e-6);
    let wide = HeightField::from_image(&path, 0.3, Some([4, 1])).unwrap();
    for (height, expected) in wide.heights().iter().zip([0.1, 0.1, 0.2, 0.2]) {
        assert!((height - expected).abs() < 1e-6, "{height} {expected}");
    }
    assert!(HeightField::from_image(&path, 0.3, Some([0, 4])).is_err());
    assert!(HeightField::from_image(&path, 0.3, Some([1 << 40, 4])).is_err());
    let missing = HeightField::from_image(&folder.path().join("none.png"), 0.3, None).unwrap_err().to_string();
    assert!(missing.contains("none.png"), "{missing}");
}

fn bytes_in_native_order(big_endian: &[u8]) -> Vec<u8> {
    big_endian.chunks_exact(2).flat_map(|pair| u16::from_be_bytes([pair[0], pair[1]]).to_ne_bytes()).collect()
}

#[test]
fn normals_of_a_plane_wave_are_its_gradient() {
    let wave = HeightField::from_function([64, 32], 0.1, |u, v| (std::f64::consts::TAU * (u + v)).sin()).unwrap();
    for texel in 0..wave.texel_count() {
        let [x, y, _] = wave.position(texel);
        // A tile of 1 × ½: v = 2y. Central differences on 64 columns are off by (2π/64)²/6 of the slope, on 32 rows by four times that.
        let slope = 0.1 * std::f64::consts::TAU * (std::f64::consts::TAU * (x + 2.0 * y)).cos();
        let expected = glam::DVec3::new(-slope, -2.0 * slope, 1.0).normalize();
        let normal = glam::Vec3::from_array(wave.normal(texel)).as_dvec3();
        assert!((normal - expected).length() < 0.01, "{normal} {expected}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn heights_are_those_of_the_mesh_and_repeat(
        width in 1_usize..6,
        height in 1_usize..6,
        seed in any::<u64>(),
        weights in prop::array::uniform2(0.01_f64..1.0),
    ) {
        let field = rough(width, height, 0.5, seed);
        let mesh = field.mesh([2, 1]);
        prop_assert_eq!(mesh.triangles.len(), 2 * field.texel_count() * 2);
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|vertex| glam::DVec3::from_array(mesh.positions[vertex as usize]));
            prop_assert!((b - a).cross(c - a).z > 0.0);
            let (s, t) = (weights[0] * (1.0 - weights[1]), weights[0] * weights[1]);
            let p = a + s * (b - a) + t * (c - a);
            let (u, v) = (p.x, p.y * width as f64 / height as f64);
            for (u, v) in [(u, v), (u + 3.0, v - 2.0)] {
                prop_assert!((field.height_at(u, v) - p.z).abs() < 1e-10);
            }
        }
    }
}
