//! Laws of textures of lobes and of skinning, on the CPU twins.
#![expect(clippy::unwrap_used, reason = "tests")]

use proptest::prelude::*;
use prt_gpu::{
    Evaluation, Frame, LobeSampling, LobeShape, LobeSurface, LobeTexture, Lobes, PoseFrames, Skin, TexturedSurface,
    View, ViewMap, cpu,
};
use sh_core::Order;

type Frame3 = [[f32; 3]; 3];

const IDENTITY: Frame3 = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const CAMERA: [[f32; 4]; 4] = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];

/// A square that fills the image: x to the right, y up; uv grows with them, v from the bottom.
const SQUARE: [[f32; 3]; 4] = [[-1.0, -1.0, 0.5], [1.0, -1.0, 0.5], [1.0, 1.0, 0.5], [-1.0, 1.0, 0.5]];
const UVS: [[f32; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
const TRIANGLES: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];
const WHITE: [[f32; 3]; 4] = [[1.0; 3]; 4];

fn order(n: usize) -> Order {
    Order::new(n).unwrap()
}

/// The light that gives each explicit DC coefficient as radiance.
fn constant_light() -> [f32; 3] {
    [1.0; 3]
}

/// Radiance of a texture of DC coefficients on the square, in an image of `side` pixels.
fn draw(
    size: [usize; 2],
    dc: &[f32],
    uvs: &[[f32; 2]; 4],
    change: impl Fn(TexturedSurface<'_>) -> TexturedSurface<'_>,
    side: u32,
) -> Frame {
    let shape = LobeShape { order: order(1), rows: 1, channels: 1, lobe_count: 0, explicit_count: 1 };
    let lobes = Lobes::new(shape, dc, &[], &[], None).unwrap();
    let texture = LobeTexture::new(size[0], size[1], None, lobes).unwrap();
    let surface = change(TexturedSurface::new(&SQUARE, &TRIANGLES, uvs, &WHITE, texture).unwrap());
    let view = View::new(CAMERA, side, side, 1).unwrap();
    cpu::render_textured(&surface, &[IDENTITY; 4], &constant_light(), order(1), None, Evaluation::Direct, &view)
        .unwrap()
}

/// The pixel in a column from the left and a row from the bottom, as v grows.
fn pixel(frame: &Frame, column: usize, row: usize) -> f32 {
    frame.pixels[(frame.height - 1 - row) * frame.width + column][0]
}

/// Equal but for the rounding of the interpolated albedo, 1: a texel read wrongly would be 1 off.
fn is(a: f32, b: f32) -> bool {
    (a - b).abs() <= 1e-6 * b.abs()
}

fn nearest(surface: TexturedSurface<'_>) -> TexturedSurface<'_> {
    surface.with_sampling(LobeSampling::Nearest)
}

#[test]
fn texels_lie_where_the_convention_says() {
    let dc: Vec<f32> = (0..12).map(|i| (i + 1) as f32).collect();
    // 4 columns, 3 rows; texel (0, 0) at uv (0, 0).
    let frame = draw([4, 3], &dc, &UVS, nearest, 12);
    for row in 0..12 {
        for column in 0..12 {
            assert!(is(pixel(&frame, column, row), dc[row / 4 * 4 + column / 3]), "{column} {row}");
        }
    }
}

#[test]
fn explicit_coefficients_are_linear_between_centres_and_wrap() {
    let dc = [1.0, 2.0, 5.0, 10.0];
    let frame = draw([4, 1], &dc, &UVS, |surface| surface, 16);
    for column in 0..16 {
        // Pixel centres in texels, from the centre of texel 0.
        let at = (column as f32 + 0.5) / 4.0 - 0.5;
        let (first, share) = (at.floor(), at - at.floor());
        let texel = |i: f32| dc[(i as i32).rem_euclid(4) as usize];
        let expected = (1.0 - share) * texel(first) + share * texel(first + 1.0);
        assert!((pixel(&frame, column, 7) - expected).abs() < 1e-5, "{column}");
    }
}

#[test]
fn textures_tile_and_mirror_with_their_coordinates() {
    let dc = [1.0, 2.0, 5.0, 10.0];
    let repeated = draw([4, 1], &dc, &UVS, |surface| nearest(surface.with_repeat([2.0, 3.0]).unwrap()), 16);
    let moved = UVS.map(|[u, v]| [u - 3.0, v + 5.0]);
    let moved = draw([4, 1], &dc, &moved, nearest, 16);
    let flipped = draw([4, 1], &dc, &UVS.map(|[u, v]| [-u, v]), nearest, 16);
    for column in 0..16 {
        assert!(is(pixel(&repeated, column, 3), dc[column / 2 % 4]), "{column}");
        assert!(is(pixel(&moved, column, 3), dc[column / 4]), "{column}");
        assert!(is(pixel(&flipped, column, 3), dc[3 - column / 4]), "{column}");
    }
}

#[test]
fn albedo_of_texels_and_vertices_multiply() {
    let shape = LobeShape { order: order(1), rows: 1, channels: 1, lobe_count: 0, explicit_count: 1 };
    let lobes = Lobes::new(shape, &[2.0; 2], &[], &[], None).unwrap();
    let texels = [[1.0, 0.5, 0.25], [0.0, 1.0, 0.75]];
    let texture = LobeTexture::new(2, 1, Some(&texels), lobes).unwrap();
    let albedo = [[0.5, 1.0, 2.0]; 4];
    let surface = TexturedSurface::new(&SQUARE, &TRIANGLES, &UVS, &albedo, texture).unwrap();
    let view = View::new(CAMERA, 4, 4, 1).unwrap();
    let render = |surface: &TexturedSurface<'_>| {
        let frames = [IDENTITY; 4];
        cpu::render_textured(surface, &frames, &constant_light(), order(1), None, Evaluation::Direct, &view).unwrap()
    };
    let sharp = render(&nearest(surface));
    for (pixel, expected) in [(0, [1.0, 1.0, 1.0, 1.0]), (3, [0.0, 2.0, 3.0, 1.0])] {
        let pixel = sharp.pixels[pixel];
        assert!((0..4).all(|c| is(pixel[c], expected[c])), "{pixel:?} is not {expected:?}");
    }
    // Pixel 1 lies a quarter of the way from the first centre to the second.
    let smooth = render(&surface).pixels[1];
    assert!(smooth.iter().zip([0.75, 1.25, 1.5, 1.0]).all(|(s, e)| (s - e).abs() < 1e-5), "{smooth:?}");
}

/// Numbers that look random, from -1 to 1.
fn noise(count: usize, seed: u32) -> Vec<f32> {
    let hash = |i: u32| {
        let mut x = (i + 1).wrapping_mul(0x9e37_79b9) ^ seed.wrapping_mul(0x85eb_ca6b);
        x = (x ^ (x >> 16)).wrapping_mul(0x045d_9f3b);
        x ^ (x >> 16)
    };
    (0..count as u32).map(|i| (hash(i) >> 8) as f32 / (1 << 23) as f32 - 1.0).collect()
}

fn unit(a: &[f32]) -> [f32; 3] {
    let length = a.iter().map(|x| x * x).sum::<f32>().sqrt();
    [a[0] / length, a[1] / length, a[2] / length]
}

/// A texture of one texel is lobes in tangent space: as the same lobes at vertices, in the same frame, left-handed ones too.
#[test]
fn one_texel_is_a_vertex_in_its_frame() {
    let n = 5;
    let shape = LobeShape { order: order(n), rows: 1, channels: 3, lobe_count: 3, explicit_count: 4 };
    let explicit = noise(12, 1);
    let axes: Vec<[f32; 3]> = noise(9, 2).chunks_exact(3).map(unit).collect();
    let mut coeffs = noise(shape.coeff_floats(), 3);
    coeffs.chunks_exact_mut(n).for_each(|lobe| lobe[..2].fill(0.0));
    let lobes = Lobes::new(shape, &explicit, &axes, &coeffs, None).unwrap();
    let texture = LobeTexture::new(1, 1, None, lobes).unwrap();
    let (c, s) = (0.6, 0.8);
    let frames = [
        [[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]],
        [[c, 0.0, s], [0.0, -1.0, 0.0], [-s, 0.0, c]],
        [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
    ];
    let light = noise(3 * n * n, 4);
    let view = View::new(CAMERA, 3, 3, 1).unwrap();
    for frame in frames {
        for sampling in [LobeSampling::Nearest, LobeSampling::PointLobes, LobeSampling::Bilinear] {
            let surface =
                TexturedSurface::new(&SQUARE, &TRIANGLES, &UVS, &WHITE, texture).unwrap().with_sampling(sampling);
            let direct = Evaluation::Direct;
            let image = cpu::render_textured(&surface, &[frame; 4], &light, order(n), None, direct, &view).unwrap();
            let mut expected = [[0.0; 3]];
            let vertex = LobeSurface::new(&SQUARE[..1], &[], &WHITE[..1], lobes).unwrap();
            cpu::shade_lobes(&vertex, &[frame], &light, order(n), None, direct, &mut expected);
            for pixel in &image.pixels {
                assert!(
                    (0..3).all(|c| (pixel[c] - expected[0][c]).abs() < 1e-4),
                    "{frame:?}: {pixel:?} is not {expected:?}"
                );
            }
        }
    }
}

/// Gloss about the normal of a relief is gloss of a flat surface whose frame is tilted as the relief is.
#[test]
fn relief_tilts_the_frame_of_the_view() {
    const SIZE: usize = 4;
    let shape = LobeShape { order: order(2), rows: 2, channels: 1, lobe_count: 0, explicit_count: 1 };
    let values: Vec<f32> = noise(2 * SIZE * SIZE, 11);
    let map = ViewMap { size: SIZE, values: &values };
    let lobes = Lobes::new(shape, &[1.0, 2.0], &[], &[], Some(map)).unwrap();
    let flat = LobeTexture::new(1, 1, None, lobes).unwrap();
    let normals = [unit(&[0.5, -0.3, 0.8])];
    let relief = flat.with_normals(&normals).unwrap();
    // z the normal, x that of the tangent made perpendicular to it.
    let n = normals[0];
    let x = unit(&[1.0 - n[0] * n[0], -n[0] * n[1], -n[0] * n[2]]);
    let y = [n[1] * x[2] - n[2] * x[1], n[2] * x[0] - n[0] * x[2], n[0] * x[1] - n[1] * x[0]];
    let view = View::new(CAMERA, 3, 3, 1).unwrap();
    let light = noise(12, 12);
    let draw = |texture, frame| {
        let surface = TexturedSurface::new(&SQUARE, &TRIANGLES, &UVS, &WHITE, texture).unwrap();
        let eye = Some([0.4, 0.9, 2.0]);
        cpu::render_textured(&surface, &[frame; 4], &light, order(2), eye, Evaluation::Direct, &view).unwrap()
    };
    let (tilted, expected, level) = (draw(relief, IDENTITY), draw(flat, [x, y, n]), draw(flat, IDENTITY));
    let mut moved = 0.0_f32;
    for ((a, b), c) in tilted.pixels.iter().zip(&expected.pixels).zip(&level.pixels) {
        assert!((a[0] - b[0]).abs() < 1e-5, "{a:?} {b:?}");
        moved = moved.max((a[0] - c[0]).abs());
    }
    assert!(moved > 0.01, "the relief counts: {moved}");
    let error = flat.with_normals(&[]).unwrap_err().to_string();
    assert_eq!(error, "normals has 0 texels; a texture of 1 x 1 needs 1");
}

/// Interpolated lobes of corresponding texels: between two axes lies the axis in the middle.
#[test]
fn corresponding_lobes_are_interpolated_when_asked() {
    let n = 4;
    let shape = LobeShape { order: order(n), rows: 1, channels: 1, lobe_count: 1, explicit_count: 1 };
    let axes = [[0.6, 0.0, 0.8], [-0.6, 0.0, 0.8]];
    let coeffs = [0.0, 1.0, 2.0, 3.0, 0.0, 3.0, 2.0, 1.0];
    let lobes = Lobes::new(shape, &[0.0; 2], &axes, &coeffs, None).unwrap();
    let texture = LobeTexture::new(2, 1, None, lobes).unwrap();
    // The whole square lies half-way between the centres of both texels.
    let uvs = [[0.5, 0.0], [0.5, 0.0], [0.5, 1.0], [0.5, 1.0]];
    let surface = TexturedSurface::new(&SQUARE, &TRIANGLES, &uvs, &WHITE, texture).unwrap();
    let surface = surface.with_sampling(LobeSampling::Bilinear);
    let light = noise(3 * n * n, 5);
    let view = View::new(CAMERA, 1, 1, 1).unwrap();
    let image =
        cpu::render_textured(&surface, &[IDENTITY; 4], &light, order(n), None, Evaluation::Direct, &view).unwrap();
    let middle = Lobes::new(shape, &[0.0], &[[0.0, 0.0, 1.0]], &[0.0, 2.0, 2.0, 2.0], None).unwrap();
    let mut expected = [[0.0; 3]];
    let vertex = LobeSurface::new(&SQUARE[..1], &[], &WHITE[..1], middle).unwrap();
    cpu::shade_lobes(&vertex, &[IDENTITY], &light, order(n), None, Evaluation::Direct, &mut expected);
    assert!((0..3).all(|c| (image.pixels[0][c] - expected[0][c]).abs() < 1e-5), "{:?} {expected:?}", image.pixels[0]);
}

#[test]
fn wild_coordinates_and_frames_are_finite() {
    let dc = [1.0, 2.0, 5.0, 10.0];
    for uv in [1e30, -1e30, 1e9, 123_456.79] {
        let uvs = [[uv, uv], [-uv, uv], [uv, 0.0], [0.0, uv]];
        let frame = draw([4, 1], &dc, &uvs, |surface| surface.with_repeat([1e6, -1e6]).unwrap(), 8);
        assert!(frame.pixels.as_flattened().iter().all(|x| x.is_finite()), "{uv}");
    }
}

#[test]
fn wrong_textures_are_named() {
    let shape = LobeShape { order: order(1), rows: 1, channels: 1, lobe_count: 0, explicit_count: 1 };
    let lobes = Lobes::new(shape, &[1.0; 4], &[], &[], None).unwrap();
    let text = |w, h, albedo: Option<&[[f32; 3]]>| LobeTexture::new(w, h, albedo, lobes).unwrap_err().to_string();
    assert_eq!(text(0, 4, None), "a texture of 0 x 4 texels was given; 1 to 16384 per side are accepted");
    assert_eq!(text(3, 1, None), "lobes has 4 points; a texture of 3 x 1 needs 3");
    assert_eq!(text(2, 2, Some(&[[1.0; 3]; 3])), "albedo has 3 texels; a texture of 2 x 2 needs 4");
    assert_eq!(text(2, 2, Some(&[[1.0, f32::NAN, 1.0]; 4])), "albedo of texel 0 is not finite");
    let texture = LobeTexture::new(2, 2, None, lobes).unwrap();
    let surface = |uvs: &[[f32; 2]]| {
        TexturedSurface::new(&SQUARE, &TRIANGLES, uvs, &WHITE, texture).map(drop).unwrap_err().to_string()
    };
    assert_eq!(surface(&UVS[..3]), "uvs has 3 entries; a surface of 4 vertices needs 4");
    assert_eq!(surface(&[[0.0; 2], [0.0, f32::NAN], [0.0; 2], [0.0; 2]]), "uv of vertex 1 is not finite");
    let good = TexturedSurface::new(&SQUARE, &TRIANGLES, &UVS, &WHITE, texture).unwrap();
    assert_eq!(good.with_repeat([1.0, f32::INFINITY]).unwrap_err().to_string(), "repeat 1 is not finite");
    let view = View::new(CAMERA, 1, 1, 1).unwrap();
    let frames = cpu::render_textured(&good, &[IDENTITY; 3], &[1.0; 3], order(1), None, Evaluation::Direct, &view);
    assert_eq!(frames.unwrap_err().to_string(), "frames has 3 entries; a surface of 4 vertices needs 4");
}

/// Column-major with a zero fourth row.
fn matrix(columns: Frame3, offset: [f32; 3]) -> [[f32; 4]; 4] {
    let [x, y, z] = columns.map(|[a, b, c]| [a, b, c, 0.0]);
    [x, y, z, [offset[0], offset[1], offset[2], 1.0]]
}

fn rotation(angles: [f32; 3]) -> Frame3 {
    let rows = sh_core::Zyz::from_angles(angles).matrix();
    std::array::from_fn(|c| std::array::from_fn(|r| rows[r][c]))
}

fn apply(columns: &Frame3, v: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|i| (0..3).map(|k| columns[k][i] * v[k]).sum())
}

/// Poses one vertex by one matrix.
fn pose(linear: Frame3, rest: Frame3, kind: PoseFrames) -> ([f32; 3], Frame3) {
    let (mut positions, mut frames) = ([[f32::NAN; 3]], [[[f32::NAN; 3]; 3]]);
    let (position, joints, weights) = ([[1.0, 2.0, 3.0]], [[0, 1, 1, 1]], [[1.0, 0.0, 0.0, 0.0]]);
    let rest = [rest];
    let skin = Skin::new(&position, &rest, &joints, &weights).unwrap();
    cpu::skin(&skin, &[matrix(linear, [0.5, 0.0, -1.0]), [[9.0; 4]; 4]], kind, &mut positions, &mut frames);
    (positions[0], frames[0])
}

fn near(a: &Frame3, b: &Frame3, tolerance: f32) -> bool {
    a.as_flattened().iter().zip(b.as_flattened()).all(|(a, b)| (a - b).abs() <= tolerance)
}

fn angles() -> impl Strategy<Value = [f32; 3]> {
    prop::array::uniform3(-3.0_f32..3.0)
}

proptest! {
    /// A rigid motion, of any size, turns frames by itself, mirrored ones too.
    #[test]
    fn rigid_motions_turn_frames(turn in angles(), rest in angles(), scale in 1e-3_f32..1e3, mirrored in any::<bool>()) {
        let turn = rotation(turn);
        let mut rest = rotation(rest);
        if mirrored {
            rest[1] = rest[1].map(|x| -x);
        }
        let linear = turn.map(|column| column.map(|x| scale * x));
        let (position, frame) = pose(linear, rest, PoseFrames::FromRest);
        prop_assert!(near(&frame, &turn, 3e-6), "{frame:?} is not {turn:?}");
        let (_, tangent) = pose(linear, rest, PoseFrames::Tangent);
        prop_assert!(near(&tangent, &rest.map(|v| apply(&turn, v)), 3e-6));
        let moved = apply(&linear, [1.0, 2.0, 3.0]);
        prop_assert!((0..3).all(|i| (position[i] - (moved[i] + [0.5, 0.0, -1.0][i])).abs() <= 1e-6 * (1.0 + 10.0 * scale)));
    }

    /// The normal is that of the mapped surface, and no other orthonormal pair is nearer to the mapped tangents.
    #[test]
    fn frames_are_the_nearest_to_the_mapped_tangents(rest in angles(), numbers in prop::array::uniform9(-1.0_f32..1.0), off in -0.5_f32..0.5) {
        let linear: Frame3 = std::array::from_fn(|k| std::array::from_fn(|i| numbers[3 * k + i]));
        let rest = rotation(rest);
        let (ft, fb) = (apply(&linear, rest[0]), apply(&linear, rest[1]));
        let cross = |a: [f32; 3], b: [f32; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        let dot = |a: [f32; 3], b: [f32; 3]| (0..3).map(|i| a[i] * b[i]).sum::<f32>();
        let normal = cross(ft, fb);
        prop_assume!(dot(normal, normal) > 1e-2);
        let (_, [t, b, n]) = pose(linear, rest, PoseFrames::Tangent);
        prop_assert!(dot(n, normal) > (1.0 - 1e-5) * dot(normal, normal).sqrt());
        let fit = |angle: f32| {
            let (s, c) = angle.sin_cos();
            let turned_t = std::array::from_fn(|i| c * t[i] + s * b[i]);
            let turned_b = std::array::from_fn(|i| c * b[i] - s * t[i]);
            dot(turned_t, ft) + dot(turned_b, fb)
        };
        prop_assert!(fit(0.0) >= fit(off) - 1e-5, "{} {}", fit(0.0), fit(off));
        // A frame that turns about the rest normal gives the same rotation.
        let (s, c) = 0.8_f32.sin_cos();
        let other = [
            std::array::from_fn(|i| c * rest[0][i] + s * rest[1][i]),
            std::array::from_fn(|i| c * rest[1][i] - s * rest[0][i]),
            rest[2],
        ];
        let [one, two] = [rest, other].map(|rest| pose(linear, rest, PoseFrames::FromRest).1);
        let sharpness = fit(0.0);
        prop_assume!(sharpness > 0.05);
        prop_assert!(near(&one, &two, 2e-4), "{one:?} {two:?}");
    }
}

#[test]
fn weights_blend_matrices() {
    let (position, rest, joints) = ([[1.0, 0.0, 0.0]], [IDENTITY], [[0, 1, 2, 3]]);
    let weights = [[0.1, 0.2, 0.3, 0.4]];
    let skin = Skin::new(&position, &rest, &joints, &weights).unwrap();
    assert_eq!(skin.joint_count(), 4);
    let matrices: Vec<_> =
        (0..4).map(|j| matrix(IDENTITY.map(|c| c.map(|x| x * j as f32)), [0.0, j as f32, 0.0])).collect();
    let (mut positions, mut frames) = ([[0.0; 3]], [[[0.0; 3]; 3]]);
    cpu::skin(&skin, &matrices, PoseFrames::FromRest, &mut positions, &mut frames);
    assert!((0..3).all(|i| (positions[0][i] - [2.0, 2.0, 0.0][i]).abs() < 1e-6), "{positions:?}");
    assert_eq!(frames, [IDENTITY]);
}

#[test]
fn wrong_skins_are_named() {
    let text = |frames: &[Frame3], joints: &[[u32; 4]], weights: &[[f32; 4]]| {
        Skin::new(&SQUARE[..2], frames, joints, weights).unwrap_err().to_string()
    };
    let (frames, joints, weights) = ([IDENTITY; 2], [[0; 4]; 2], [[0.25; 4]; 2]);
    assert!(text(&frames[..1], &joints, &weights).starts_with("frames has 1 entries"));
    assert_eq!(text(&frames, &joints[..1], &weights), "joints has 1 entries; a skin of 2 vertices needs 2");
    assert_eq!(text(&frames, &joints, &weights[..1]), "weights has 1 entries; a skin of 2 vertices needs 2");
    assert_eq!(text(&frames, &joints, &[[f32::NAN; 4]; 2]), "joint weights of vertex 0 is not finite");
}
