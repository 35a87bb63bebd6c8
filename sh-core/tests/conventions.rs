//! Converters against the numbers of other libraries (`references/conventions.py` made them), and there and back.
#![cfg(feature = "alloc")]
#![expect(clippy::unwrap_used, reason = "tests")]

use std::f64::consts::PI;

use proptest::prelude::*;
use sh_core::{
    Order, Quadrature, SplatLayout, clamped_cosine, convolve, eval, from_complex, from_filament, from_splat,
    project_function, reconstruct, to_complex, to_filament, to_splat, toggle_condon_shortley, y_up_from_z_up,
    z_up_from_y_up,
};

const N: usize = 5;

fn order(n: usize) -> Order {
    Order::new(n).unwrap()
}

/// The numbers of a line of `references/conventions.txt`.
fn reference(name: &str) -> Vec<f64> {
    let file = include_str!("references/conventions.txt");
    let line = file.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(' ')).unwrap();
    line.split(' ').map(|number| number.parse().unwrap()).collect()
}

fn directions() -> Vec<[f64; 3]> {
    reference("directions").as_chunks::<3>().0.to_vec()
}

fn pairs(name: &str) -> Vec<[f64; 2]> {
    reference(name).as_chunks::<2>().0.to_vec()
}

#[track_caller]
fn assert_close(a: &[f64], b: &[f64], tolerance: f64) {
    assert_eq!(a.len(), b.len());
    for (i, (a, b)) in a.iter().zip(b).enumerate() {
        assert!((a - b).abs() < tolerance, "{i}: {a} {b}");
    }
}

#[test]
fn no_phase_is_sphericart() {
    for (direction, expected) in directions().into_iter().zip(reference("sphericart").chunks_exact(N * N)) {
        let mut y = [0.0; N * N];
        eval(order(N), direction, &mut y);
        toggle_condon_shortley(order(N), &mut y);
        // Ours has up to 2e-15; sphericart normalises the direction again, a rounding that enters up to four times.
        assert_close(&y, expected, 4e-15);
    }
}

#[test]
fn complex_is_scipy() {
    // The value of an expansion, by SciPy's basis and our coefficients in it.
    let coeffs: Vec<f64> = (0..N * N).map(|i| (1.0 + 1.7 * i as f64).sin()).collect();
    let mut complex = [[f64::NAN; 2]; N * N];
    to_complex(order(N), &coeffs, &mut complex);
    for (direction, basis) in directions().into_iter().zip(pairs("scipy").chunks_exact(N * N)) {
        let (mut re, mut im) = (0.0, 0.0);
        for ([a, b], [c, d]) in complex.iter().zip(basis) {
            re += a * c - b * d;
            im += a * d + b * c;
        }
        assert_close(&[re, im], &[reconstruct(order(N), &coeffs, direction), 0.0], 5e-15);
    }
    // And the real part of a function with any complex coefficients.
    let mut real = [f64::NAN; N * N];
    from_complex(order(N), &pairs("complex"), &mut real);
    for (direction, expected) in directions().into_iter().zip(reference("complex_value")) {
        assert_close(&[reconstruct(order(N), &real, direction)], &[expected], 1e-14);
    }
}

#[test]
fn splats_have_their_colours() {
    let dc: [f64; 3] = reference("splat_dc").try_into().unwrap();
    let (planar, interleaved) = (reference("splat_rest"), reference("splat_features_rest"));
    for (layout, rest) in [(SplatLayout::Planar, &planar), (SplatLayout::Interleaved, &interleaved)] {
        let mut colour = [f64::NAN; 48];
        from_splat(order(4), dc, rest, layout, &mut colour);
        for (direction, expected) in directions().into_iter().zip(reference("splat_colour").chunks_exact(3)) {
            let channels: Vec<f64> = colour.chunks_exact(16).map(|f| reconstruct(order(4), f, direction)).collect();
            assert_close(&channels, expected, 1e-14);
        }
        let mut back = [f64::NAN; 45];
        let back_dc = to_splat(order(4), &colour, layout, &mut back);
        assert_eq!(&back[..], &rest[..]);
        assert_close(&back_dc, &dc, 1e-15);
    }
}

#[test]
fn filament_gets_its_numbers() {
    let channels: [fn([f64; 3]) -> f64; 3] =
        [|[x, y, z]| 1.0 + x + 2.0 * y + 3.0 * x * z, |[x, y, z]| 2.0 - z + x * y, |[_, y, z]| 3.0 + y * y + z.powi(4)];
    let mut light = [0.0; 3 * N * N];
    for (coeffs, channel) in light.chunks_exact_mut(N * N).zip(channels) {
        project_function(order(N), &Quadrature::new(10), channel, coeffs);
    }
    let mut colours = [[f64::NAN; 3]; 9];
    to_filament(order(N), &light, &mut colours);
    assert_close(colours.as_flattened(), &reference("filament"), 1e-14);
    // Back: three bands of radiance, whose irradiance over π is what the shader finds.
    let mut radiance = [f64::NAN; 27];
    from_filament(&colours, &mut radiance);
    let mut kernel = [0.0; 3];
    clamped_cosine(&mut kernel);
    for (channel, coeffs) in radiance.chunks_exact_mut(9).enumerate() {
        assert_close(coeffs, &light[channel * N * N..][..9], 1e-14);
        convolve(order(3), &kernel, coeffs);
    }
    for (normal, expected) in directions().into_iter().zip(reference("filament_shaded").chunks_exact(3)) {
        let shaded: Vec<f64> = radiance.chunks_exact(9).map(|f| reconstruct(order(3), f, normal) / PI).collect();
        assert_close(&shaded, expected, 1e-14);
    }
}

#[test]
fn filament_takes_every_order() {
    let mut colours = [[f64::NAN; 3]; 9];
    to_filament(order(2), &[1.0; 12], &mut colours);
    assert!(colours[..4].iter().flatten().all(|c| *c != 0.0 && c.is_finite()));
    assert!(colours[4..].iter().flatten().all(|c| *c == 0.0));
}

#[test]
fn up_changes_as_scipy_projects() {
    let (y_up, z_up) = (reference("y_up"), reference("z_up"));
    let mut out = [f64::NAN; N * N];
    z_up_from_y_up(order(N), &y_up, &mut out);
    assert_close(&out, &z_up, 1e-13);
    y_up_from_z_up(order(N), &z_up, &mut out);
    assert_close(&out, &y_up, 1e-13);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn there_and_back(n in 1..13_usize, seed in prop::collection::vec(-1.0..1.0_f64, 3 * 144)) {
        let (order, count) = (order(n), n * n);
        let coeffs = &seed[..count];
        let mut out = coeffs.to_vec();
        toggle_condon_shortley(order, &mut out);
        toggle_condon_shortley(order, &mut out);
        prop_assert_eq!(&out[..], coeffs);

        let mut complex = vec![[f64::NAN; 2]; count];
        to_complex(order, coeffs, &mut complex);
        from_complex(order, &complex, &mut out);
        assert_close(&out, coeffs, 4e-16);
        // Unitary: the length stays.
        let length = |f: &[f64]| f.iter().map(|f| f * f).sum::<f64>();
        prop_assert!((length(complex.as_flattened()) / length(coeffs) - 1.0).abs() < 1e-14);

        let mut turned = vec![f64::NAN; count];
        z_up_from_y_up(order, coeffs, &mut turned);
        y_up_from_z_up(order, &turned, &mut out);
        assert_close(&out, coeffs, 1e-14);

        let colour = &seed[..3 * count];
        for layout in [SplatLayout::Planar, SplatLayout::Interleaved] {
            let (mut rest, mut back) = (vec![f64::NAN; 3 * (count - 1)], vec![f64::NAN; 3 * count]);
            let dc = to_splat(order, colour, layout, &mut rest);
            from_splat(order, dc, &rest, layout, &mut back);
            assert_close(&back, colour, 4e-16);
        }
    }

    /// Of a function that is not real, the real part is taken: `to` after `from` makes it real, and does nothing twice.
    #[test]
    fn complex_coefficients_become_those_of_the_real_part(n in 1..8_usize, seed in prop::collection::vec(-1.0..1.0_f64, 98)) {
        let (order, count) = (order(n), n * n);
        let complex = &seed.as_chunks::<2>().0[..count];
        let (mut real, mut again) = (vec![0.0; count], vec![0.0; count]);
        let mut symmetric = vec![[0.0; 2]; count];
        from_complex(order, complex, &mut real);
        to_complex(order, &real, &mut symmetric);
        from_complex(order, &symmetric, &mut again);
        assert_close(&real, &again, 1e-15);
    }
}
