//! Laws of shading with zonal lobes, on the CPU twins: against expansions in spherical harmonics by sh-core.
#![expect(clippy::unwrap_used, reason = "tests")]

use proptest::prelude::*;
use prt_gpu::{Evaluation, LobeShape, LobeSurface, Lobes, Surface, ViewMap, cpu};
use sh_core::Order;

type Frame3 = [[f32; 3]; 3];

const IDENTITY: Frame3 = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Numbers that look random, from -1 to 1.
fn noise(count: usize, seed: u32) -> Vec<f32> {
    let hash = |i: u32| {
        let mut x = (i + 1).wrapping_mul(0x9e37_79b9) ^ seed.wrapping_mul(0x85eb_ca6b);
        x = (x ^ (x >> 16)).wrapping_mul(0x045d_9f3b);
        x ^ (x >> 16)
    };
    (0..count as u32).map(|i| (hash(i) >> 8) as f32 / (1 << 23) as f32 - 1.0).collect()
}

fn order(n: usize) -> Order {
    Order::new(n).unwrap()
}

fn shape(n: usize, rows: usize, channels: usize, lobe_count: usize, explicit_count: usize) -> LobeShape {
    LobeShape { order: order(n), rows, channels, lobe_count, explicit_count }
}

/// The arrays of random lobes for some points.
struct Arrays {
    shape: LobeShape,
    explicit: Vec<f32>,
    axes: Vec<[f32; 3]>,
    coeffs: Vec<f32>,
}

impl Arrays {
    fn random(shape: LobeShape, points: usize, seed: u32) -> Self {
        let unit = |a: &[f32]| {
            let length = a.iter().map(|x| x * x).sum::<f32>().sqrt();
            [a[0] / length, a[1] / length, a[2] / length]
        };
        let mut coeffs = noise(points * shape.coeff_floats(), seed + 2);
        coeffs
            .chunks_exact_mut(shape.order.get())
            .for_each(|lobe| lobe[..shape.first_band().min(shape.order.get())].fill(0.0));
        Self {
            shape,
            explicit: noise(points * shape.explicit_floats(), seed),
            axes: noise(3 * points * shape.axis_count(), seed + 1).chunks_exact(3).map(unit).collect(),
            coeffs,
        }
    }

    fn lobes(&self) -> Lobes<'_> {
        Lobes::new(self.shape, &self.explicit, &self.axes, &self.coeffs, None).unwrap()
    }

    /// The transfer vectors `[P, C, n²]` that the lobes of one row stand for.
    fn expanded(&self) -> Vec<f32> {
        let LobeShape { order, channels, lobe_count, explicit_count, .. } = self.shape;
        let (n, n2) = (order.get(), order.coeff_count());
        let points = self.explicit.len() / (channels * explicit_count);
        let mut out = vec![0.0; points * channels * n2];
        let mut lobe = vec![0.0; n2];
        for (vector, out) in out.chunks_exact_mut(n2).enumerate() {
            out[..explicit_count]
                .copy_from_slice(&self.explicit[vector * explicit_count..(vector + 1) * explicit_count]);
            for j in 0..lobe_count {
                let start = (vector * lobe_count + j) * n;
                let axis = self.axes[vector / channels * lobe_count + j];
                sh_core::expand_lobe(order, &self.coeffs[start..start + n], axis, &mut lobe);
                out.iter_mut().zip(&lobe).for_each(|(out, l)| *out += l);
            }
        }
        out
    }
}

/// Radiance of all points of `lobes` with albedo 1 in given frames.
fn shade(lobes: Lobes<'_>, frames: &[Frame3], light: &[f32], used: usize, evaluation: Evaluation) -> Vec<[f32; 3]> {
    let points = lobes.point_count();
    let (positions, albedo) = (vec![[0.0; 3]; points], vec![[1.0; 3]; points]);
    let surface = LobeSurface::new(&positions, &[], &albedo, lobes).unwrap();
    let mut out = vec![[f32::NAN; 3]; points];
    cpu::shade_lobes(&surface, frames, light, order(used), None, evaluation, &mut out);
    out
}

/// Radiance from transfer vectors.
fn shade_vectors(shape: &LobeShape, transfer: &[f32], light: &[f32], used: usize) -> Vec<[f32; 3]> {
    let points = transfer.len() / (shape.channels * shape.order.coeff_count());
    let (positions, albedo) = (vec![[0.0; 3]; points], vec![[1.0; 3]; points]);
    let surface = Surface::new(&positions, &[], &albedo, shape.order, shape.channels, transfer).unwrap();
    let mut out = vec![[f32::NAN; 3]; points];
    cpu::shade_vector(&surface, light, order(used), &mut out);
    out
}

/// A rotation, in columns, and the rows of the same matrix.
fn rotation(angles: [f32; 3]) -> (Frame3, Frame3) {
    let rows = sh_core::Zyz::from_angles(angles).matrix();
    (std::array::from_fn(|c| std::array::from_fn(|r| rows[r][c])), rows)
}

fn assert_near(a: &[[f32; 3]], b: &[[f32; 3]], tolerance: f32) {
    assert_eq!(a.len(), b.len());
    for (v, (a, b)) in a.iter().zip(b).enumerate() {
        assert!((0..3).all(|c| (a[c] - b[c]).abs() <= tolerance), "point {v}: {a:?} is not {b:?}");
    }
}

/// Up to 4 lobes of bands of size 1 under a light of size 1 per coefficient, all rounded: some 150 products of size up to 2, in two orders
/// of summation, and a rotation in between. Measured: 2.9e-6 in 2000 cases.
const ROUNDING: f32 = 1e-5;

fn shapes() -> impl Strategy<Value = (LobeShape, usize)> {
    (1_usize..=10, prop_oneof![Just(1_usize), Just(3)], 0_usize..=4, prop_oneof![Just(1_usize), Just(4)], 0_usize..10)
        .prop_map(|(n, channels, lobes, k, unused)| {
            let k = if n == 1 { 1 } else { k };
            (shape(n, 1, channels, lobes, k), n.saturating_sub(unused).max(1))
        })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// The lobes' radiance is that of the vectors they stand for, rotated by sh-core.
    #[test]
    fn turned_lobes_are_the_rotated_expansion((shape, used) in shapes(), angles in prop::array::uniform3(-3.0_f32..3.0), seed in 0_u32..1000) {
        let arrays = Arrays::random(shape, 3, seed);
        let light = noise(3 * used * used, seed + 9);
        let (frame, rows) = rotation(angles);
        let mut transfer = arrays.expanded();
        let mut rotated = vec![0.0; shape.order.coeff_count()];
        for vector in transfer.chunks_exact_mut(shape.order.coeff_count()) {
            sh_core::rotate(shape.order, rows, vector, &mut rotated);
            vector.copy_from_slice(&rotated);
        }
        let exact = shade_vectors(&shape, &transfer, &light, used);
        assert_near(&shade(arrays.lobes(), &[frame; 3], &light, used, Evaluation::Direct), &exact, ROUNDING);
    }

    /// From a table, whatever the shape: the sum of its samples. More points than are placed at once, and some that are left over.
    #[test]
    fn lobes_add_up_the_samples_of_the_table((shape, used) in shapes(), seed in 0_u32..1000) {
        let arrays = Arrays::random(shape, 69, seed);
        let light = noise(3 * used * used, seed + 9);
        let table = Evaluation::Table { width: 16, height: 8 };
        let exact = shade_by_samples(&arrays, &light, used, (16, 8));
        assert_near(&shade(arrays.lobes(), &[], &light, used, table), &exact, ROUNDING);
    }

    /// Turning the surface is turning the light the other way: exact for both kinds of transfer.
    #[test]
    fn turning_the_frame_is_turning_the_light_back((shape, used) in shapes(), angles in prop::array::uniform3(-3.0_f32..3.0), seed in 0_u32..1000) {
        let arrays = Arrays::random(shape, 2, seed);
        let light = noise(3 * used * used, seed + 9);
        let (frame, _) = rotation(angles);
        // The columns of a rotation are the rows of its inverse.
        let mut back = vec![0.0; light.len()];
        for (light, back) in light.chunks_exact(used * used).zip(back.chunks_exact_mut(used * used)) {
            sh_core::rotate(order(used), frame, light, back);
        }
        let turned = shade(arrays.lobes(), &[frame; 2], &light, used, Evaluation::Direct);
        assert_near(&turned, &shade(arrays.lobes(), &[], &back, used, Evaluation::Direct), ROUNDING);
    }
}

/// Radiance in the rest pose from the samples of a table, in the plainest way.
fn shade_by_samples(arrays: &Arrays, light: &[f32], used: usize, (width, height): (usize, usize)) -> Vec<[f32; 3]> {
    let LobeShape { order: stored, channels, lobe_count, explicit_count, .. } = arrays.shape;
    let (first_band, n) = (arrays.shape.first_band(), stored.get());
    let table = cpu::build_table(light, order(used), first_band, width, height);
    let mut bands = vec![[0.0; 3]; table.band_count()];
    let mut radiance = |point: usize, c: usize| {
        let vector = point * channels + c % channels;
        let explicit = &arrays.explicit[vector * explicit_count..(vector + 1) * explicit_count];
        let mut sum: f32 =
            explicit.iter().zip(&light[c * used * used..(c + 1) * used * used]).map(|(t, e)| t * e).sum();
        for j in 0..lobe_count {
            table.sample(arrays.axes[point * lobe_count + j], &mut bands);
            let lobe = &arrays.coeffs[(vector * lobe_count + j) * n..][first_band.min(n)..n];
            sum += lobe.iter().zip(&bands).map(|(g, e)| g * e[c]).sum::<f32>();
        }
        sum
    };
    let points = arrays.explicit.len() / arrays.shape.explicit_floats();
    (0..points).map(|point| [0, 1, 2].map(|c| radiance(point, c))).collect()
}

/// Mirrors are legal frames: `g(s) = f(F⁻¹ s)` for them too. Under x → −x every basis function keeps its size, and some turn their sign.
#[test]
fn mirrored_frames_mirror_the_expansion() {
    let n = 6;
    let arrays = Arrays::random(shape(n, 1, 1, 4, 4), 5, 3);
    let light = noise(3 * n * n, 4);
    let generic = [0.36_f64, 0.48, 0.8];
    let (mut y, mut mirrored) = (vec![0.0; n * n], vec![0.0; n * n]);
    sh_core::eval(order(n), generic, &mut y);
    sh_core::eval(order(n), [-generic[0], generic[1], generic[2]], &mut mirrored);
    let mut transfer = arrays.expanded();
    for vector in transfer.chunks_exact_mut(n * n) {
        for i in 0..n * n {
            assert!((y[i].abs() - mirrored[i].abs()).abs() < 1e-14);
            vector[i] *= (y[i] * mirrored[i]).signum() as f32;
        }
    }
    let frame = [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let exact = shade_vectors(&arrays.shape, &transfer, &light, n);
    assert_near(&shade(arrays.lobes(), &[frame; 5], &light, n, Evaluation::Direct), &exact, ROUNDING);
}

/// One lobe is exact for unshadowed transfer: the clamped cosine about the normal, over π.
#[test]
fn a_cosine_lobe_is_the_unshadowed_transfer() {
    let n = 6;
    let mut lobe = vec![0.0_f32; n];
    sh_core::clamped_cosine(&mut lobe);
    sh_core::lobe_from_zonal(&mut lobe);
    lobe.iter_mut().for_each(|g| *g *= std::f32::consts::FRAC_1_PI);
    let normals: Vec<[f32; 3]> = sh_core::fibonacci(200).into_iter().map(|d| d.map(|x| x as f32)).collect();
    let mut transfer = vec![0.0; normals.len() * n * n];
    for (vector, normal) in transfer.chunks_exact_mut(n * n).zip(&normals) {
        sh_core::expand_lobe(order(n), &lobe, *normal, vector);
    }
    let shape = shape(n, 1, 1, 1, 1);
    let explicit: Vec<f32> = transfer.chunks_exact(n * n).map(|vector| vector[0]).collect();
    lobe[0] = 0.0;
    let coeffs = lobe.repeat(normals.len());
    let lobes = Lobes::new(shape, &explicit, &normals, &coeffs, None).unwrap();
    let light = noise(3 * n * n, 8);
    let exact = shade_vectors(&shape, &transfer, &light, n);
    // Measured: 6e-8.
    assert_near(&shade(lobes, &[], &light, n, Evaluation::Direct), &exact, 5e-7);
}

/// Bilinear interpolation of a smooth function: halving the texels' sides divides the error by four.
#[test]
fn the_tables_error_falls_with_the_square_of_its_side() {
    let n = 6;
    let arrays = Arrays::random(shape(n, 1, 3, 4, 4), 400, 5);
    let light = noise(3 * n * n, 6);
    let direct = shade(arrays.lobes(), &[], &light, n, Evaluation::Direct);
    let rms = |evaluation| {
        let table = shade(arrays.lobes(), &[], &light, n, evaluation);
        let sum = table.iter().zip(&direct).flat_map(|(a, b)| (0..3).map(|c| f64::from(a[c] - b[c]).powi(2)));
        (sum.sum::<f64>() / (3.0 * direct.len() as f64)).sqrt()
    };
    let errors = [4, 5, 6, 7, 8].map(|k| rms(Evaluation::Table { width: 1 << k, height: 1 << (k - 1) }));
    for pair in errors.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((3.2..5.0).contains(&ratio), "{ratio} in {errors:?}");
    }
    let signal =
        (direct.as_flattened().iter().map(|x| f64::from(*x).powi(2)).sum::<f64>() / (3.0 * direct.len() as f64)).sqrt();
    assert!(errors[2] < 0.02 * signal, "{} of {signal}", errors[2]);
}

/// The band sums at a direction, in `f64`.
fn bands(light: &[f32], n: usize, direction: [f32; 3]) -> Vec<[f64; 3]> {
    let mut y = vec![0.0; n * n];
    sh_core::eval(order(n), direction.map(f64::from), &mut y);
    let sum = |range: std::ops::Range<usize>, c: usize| range.map(|i| y[i] * f64::from(light[c * n * n + i])).sum();
    order(n).bands().map(|(_, range)| [0, 1, 2].map(|c| sum(range.clone(), c))).collect()
}

/// Around the seam and over the poles a table is as good as elsewhere. At the centres of texels it is exact.
#[test]
fn the_seam_and_the_poles_are_places_like_others() {
    let (n, width, height) = (5, 32, 16);
    let light = noise(3 * n * n, 7);
    let table = cpu::build_table(&light, order(n), 1, width, height);
    assert_eq!((table.width(), table.height(), table.band_count()), (width, height, n - 1));
    let error = |direction: [f32; 3]| {
        let mut out = vec![[f32::NAN; 3]; n - 1];
        table.sample(direction, &mut out);
        let exact = bands(&light, n, direction);
        let pairs = out.iter().zip(&exact[1..]);
        pairs.flat_map(|(o, e)| (0..3).map(|c| (f64::from(o[c]) - e[c]).abs())).fold(0.0, f64::max)
    };
    let map = sh_core::LatLong { width, height };
    let at = |x: f64, y: f64| map.direction(x, y).map(|x| x as f32);
    for row in 0..height {
        for column in 0..width {
            // Rounding of coordinates moves by 1e-6 of a texel.
            let worst = error(at(column as f64 + 0.5, row as f64 + 0.5));
            assert!(worst < 2e-5, "texel {column} {row}: {worst}");
        }
    }
    let anywhere =
        (0..400).map(|i| error(at(7.3 + 0.03 * f64::from(i), 3.0 + 0.025 * f64::from(i)))).fold(0.0, f64::max);
    assert!(anywhere > 0.01, "{anywhere}");
    for i in 0..200 {
        let along = f64::from(i) / 200.0;
        let seam = error(at(31.0 + 2.0 * along, 8.0 + 3.0 * along));
        let poles = [at(32.0 * along, 0.45 * along), at(32.0 * along, 16.0 - 0.45 * along)].map(error);
        assert!(seam.max(poles[0]).max(poles[1]) < 1.5 * anywhere, "{i}: {seam} {poles:?}, elsewhere {anywhere}");
    }
    for pole in [
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [-0.0, 1.0, -0.0],
        [1e-30, -1.0, 1e-30],
        [-0.0, 0.0, -1.0],
        [-1e-9, 0.0, -1.0],
    ] {
        assert!(error(pole) < 1.5 * anywhere, "{pole:?}");
    }
}

/// All that a table holds is finite, also where an axis is not a direction at all.
#[test]
fn every_axis_has_a_place_in_the_table() {
    let light = noise(27, 1);
    for (width, height) in [(2, 1), (4, 2), (64, 32)] {
        let table = cpu::build_table(&light, order(3), 1, width, height);
        for axis in [[0.0; 3], [f32::NAN; 3], [f32::INFINITY, 0.0, 0.0], [0.0, -2.0, 0.0], [1e-40, 1e-40, -1e-40]] {
            table.sample(axis, &mut [[0.0; 3]; 2]);
        }
    }
}

#[test]
fn rows_add_up_as_the_view_map_says() {
    let n = 4;
    let arrays = Arrays::random(shape(n, 3, 1, 3, 4), 6, 11);
    let light = noise(3 * n * n, 12);
    // Constant factors: the sum of the rows, each shaded alone.
    let factors = [0.5, -2.0, 3.0];
    let values = factors.repeat(16);
    let map = ViewMap { size: 4, values: &values };
    let glossy = Lobes::new(arrays.shape, &arrays.explicit, &arrays.axes, &arrays.coeffs, Some(map)).unwrap();
    let (frame, _) = rotation([0.3, 1.0, -2.0]);
    let all = shade(glossy, &[frame; 6], &light, n, Evaluation::Direct);
    let mut sum = vec![[0.0; 3]; 6];
    for (r, factor) in factors.into_iter().enumerate() {
        let pick = |values: &[f32], size: usize| -> Vec<f32> {
            values.chunks_exact(3 * size).flat_map(|point| point[r * size..(r + 1) * size].to_vec()).collect()
        };
        let axes: Vec<[f32; 3]> =
            arrays.axes.chunks_exact(9).flat_map(|point| point[r * 3..(r + 1) * 3].to_vec()).collect();
        let one = Arrays {
            shape: LobeShape { rows: 1, ..arrays.shape },
            explicit: pick(&arrays.explicit, 4),
            axes,
            coeffs: pick(&arrays.coeffs, 3 * n),
        };
        let row = shade(one.lobes(), &[frame; 6], &light, n, Evaluation::Direct);
        sum.iter_mut().zip(row).for_each(|(sum, row)| (0..3).for_each(|c| sum[c] += factor * row[c]));
    }
    assert_near(&all, &sum, ROUNDING);
}

/// The view factor is looked up towards the eye in the local frame of the pose.
#[test]
fn the_eye_is_seen_from_the_posed_local_frame() {
    let shape = shape(1, 1, 1, 0, 1);
    // u = 1 on the left half of the map, where local x < 0, and 3 on the right half.
    let values: Vec<f32> = (0..64).map(|i| if i % 8 < 4 { 1.0 } else { 3.0 }).collect();
    let map = ViewMap { size: 8, values: &values };
    let lobes = Lobes::new(shape, &[1.0], &[], &[], Some(map)).unwrap();
    // Local x is world y in the rest pose; the pose turns world y to world z.
    let local = [[[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]];
    let frame = [[[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]];
    let surface =
        LobeSurface::new(&[[5.0, 6.0, 7.0]], &[], &[[1.0; 3]], lobes).unwrap().with_local_frames(&local).unwrap();
    let seen = |offset: [f32; 3]| {
        let mut out = [[f32::NAN; 3]];
        let eye = Some([5.0 + offset[0], 6.0 + offset[1], 7.0 + offset[2]]);
        cpu::shade_lobes(&surface, &frame, &[1.0; 3], order(1), eye, Evaluation::Direct, &mut out);
        out[0][0]
    };
    // The posed normal is world y, the posed tangent world z.
    assert_eq!([seen([0.0, 1.0, 2.0]), seen([0.0, 1.0, -2.0])], [3.0, 1.0]);
    assert_eq!([seen([0.0, -0.1, 2.0]), seen([0.0, -5.0, -2.0])], [3.0, 1.0], "below the horizon as on it");
    assert_eq!(seen([0.0, 4.0, 0.0]), 2.0);
}

#[test]
fn degenerate_frames_and_positions_give_finite_radiance() {
    let n = 3;
    let nan = f32::NAN;
    let frames: [Frame3; 6] = [
        [[0.0; 3]; 3],
        [[nan; 3]; 3],
        [[1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]],
        [[f32::INFINITY, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [[0.0; 3], [0.0; 3], [0.0, 0.0, 1e-30]],
        IDENTITY,
    ];
    let positions = [[0.0; 3], [1.0, 2.0, nan], [f32::INFINITY; 3], [1.0; 3], [3e38; 3], [nan; 3]];
    let values = noise(3 * 16, 1);
    let arrays = Arrays::random(shape(n, 3, 1, 2, 4), 6, 2);
    let map = Some(ViewMap { size: 4, values: &values });
    let lobes = Lobes::new(arrays.shape, &arrays.explicit, &arrays.axes, &arrays.coeffs, map).unwrap();
    let surface = LobeSurface::new(&positions, &[], &[[1.0; 3]; 6], lobes).unwrap();
    let surface = surface.with_local_frames(&frames).unwrap();
    let light = noise(3 * n * n, 3);
    for evaluation in [Evaluation::Direct, Evaluation::default()] {
        for eye in [None, Some([1.0; 3]), Some([-3e38; 3]), Some([nan; 3])] {
            let mut out = [[nan; 3]; 6];
            cpu::shade_lobes(&surface, &frames, &light, order(n), eye, evaluation, &mut out);
            assert!(out.as_flattened().iter().all(|x| x.is_finite()), "{out:?}");
        }
    }
}

#[test]
fn wrong_lobes_are_named() {
    let text = |shape: LobeShape, explicit: &[f32], axes: &[[f32; 3]], coeffs: &[f32]| {
        Lobes::new(shape, explicit, axes, coeffs, None).unwrap_err().to_string()
    };
    let z = [0.0, 0.0, 1.0];
    assert_eq!(
        text(shape(2, 1, 2, 1, 1), &[], &[], &[]),
        "transfer has 2 channels; 1 (grey) and 3 (red, green, blue) are accepted"
    );
    assert!(text(shape(2, 0, 1, 1, 1), &[], &[], &[]).starts_with("lobes with 0 rows"));
    assert!(text(shape(2, 1, 1, 1, 9), &[], &[], &[]).starts_with("9 explicit coefficients were given; 1, or 4"));
    assert!(text(shape(1, 1, 1, 1, 4), &[], &[], &[]).starts_with("4 explicit coefficients were given"));
    let one = shape(3, 1, 1, 1, 1);
    assert_eq!(
        text(one, &[1.0; 2], &[z], &[0.0; 6]),
        "axes has 1 entries; 2 points of 1 rows, 1 channels, 1 explicit coefficients and 1 lobes of order 3 needs 2"
    );
    assert!(text(one, &[1.0; 2], &[z; 2], &[0.0; 5]).starts_with("coeffs has 5 floats; 2 points"));
    assert_eq!(text(one, &[1.0, f32::NAN], &[z; 2], &[0.0; 6]), "explicit coefficients of point 1 is not finite");
    assert_eq!(
        text(one, &[1.0; 2], &[z; 2], &[0.0, 0.0, 0.0, 0.0, 0.0, f32::INFINITY]),
        "lobe coefficients of point 1 is not finite"
    );
    assert_eq!(
        text(one, &[1.0; 2], &[z, [0.0, 0.0, 0.9]], &[0.0; 6]),
        "axis 0 of point 1 is [0.0, 0.0, 0.9]; unit length is needed"
    );
    assert!(text(one, &[1.0], &[[f32::NAN; 3]], &[0.0; 3]).starts_with("axis 0 of point 0 is [NaN"));
    assert!(
        text(one, &[1.0; 2], &[z; 2], &[0.0, 0.0, 0.0, 0.5, 0.0, 0.0])
            .starts_with("a lobe of point 1 has a coefficient")
    );
    assert_eq!(text(shape(1, 2, 1, 0, 1), &[1.0; 2], &[], &[]), "lobes of 2 rows need a view map");
    let map = |size, values: &[f32]| {
        Lobes::new(shape(1, 2, 1, 0, 1), &[1.0; 2], &[], &[], Some(ViewMap { size, values })).unwrap_err().to_string()
    };
    assert_eq!(map(2, &[0.0; 7]), "view map has 7 floats; size 2 and 2 rows needs 8");
    assert!(map(0, &[]).starts_with("a view map of size 0"));
    assert_eq!(map(1, &[0.0, f32::NAN]), "view map entry 1 is not finite");
}

#[test]
fn wrong_tables_are_named() {
    let text = |width, height| Evaluation::Table { width, height }.check().unwrap_err().to_string();
    assert_eq!(
        text(63, 32),
        "a table of 63 x 32 was asked for; an even width of 4 to 1024 and a height of 2 to 1024 are accepted"
    );
    for (width, height) in [(0, 0), (2, 2), (64, 1), (2048, 32), (64, 1025)] {
        assert!(text(width, height).starts_with(&format!("a table of {width} x {height}")));
    }
    assert_eq!(Evaluation::Direct.check(), Ok(()));
    assert_eq!(Evaluation::default(), Evaluation::Table { width: 64, height: 32 });
}
