//! The passes of lobes against their CPU twins.

use super::scene::{Scene, look_at, noise};
use super::{assert_same, gpu, order};
use prt_gpu::{
    Error, Evaluation, Frame, Gpu, LobeRenderer, LobeSampling, LobeShape, LobeSurface, LobeTexture, Lobes, PoseFrames,
    ShadingLimits, Skin, Target, TexturedRenderer, TexturedSurface, View, ViewMap, cpu,
};

type Frame3 = [[f32; 3]; 3];

const TABLE: Evaluation = Evaluation::Table { width: 32, height: 16 };

/// A mesh with random lobes, per vertex or in a texture.
struct LobeScene {
    mesh: Scene,
    shape: LobeShape,
    explicit: Vec<f32>,
    axes: Vec<[f32; 3]>,
    coeffs: Vec<f32>,
    view_map: Vec<f32>,
    frames: Vec<Frame3>,
    light: Vec<f32>,
}

const VIEW_SIZE: usize = 8;

fn unit(a: [f32; 3]) -> [f32; 3] {
    let length = a.iter().map(|x| x * x).sum::<f32>().sqrt();
    a.map(|x| x / length)
}

fn vectors(count: usize, seed: u32) -> Vec<[f32; 3]> {
    noise(3 * count, seed).chunks_exact(3).map(|a| [a[0], a[1], a[2]]).collect()
}

/// Random orthonormal frames, every third one mirrored.
fn random_frames(count: usize, seed: u32) -> Vec<Frame3> {
    let frame = |(i, (a, b)): (usize, ([f32; 3], [f32; 3]))| {
        let x = unit(a);
        let along: f32 = (0..3).map(|i| x[i] * b[i]).sum();
        let y = unit(std::array::from_fn(|i| b[i] - along * x[i]));
        let z = [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]];
        if i % 3 == 2 { [x, y, z.map(|c| -c)] } else { [x, y, z] }
    };
    vectors(count, seed).into_iter().zip(vectors(count, seed + 1)).enumerate().map(frame).collect()
}

/// Tangent frames of a unit sphere, with mirrored ones where x < 0.
fn sphere_frames(positions: &[[f32; 3]]) -> Vec<Frame3> {
    let frame = |n: &[f32; 3]| {
        let n = unit(*n);
        let t = if n[1].abs() > 0.999 { [1.0, 0.0, 0.0] } else { unit([n[2], 0.0, -n[0]]) };
        let b = [n[1] * t[2] - n[2] * t[1], n[2] * t[0] - n[0] * t[2], n[0] * t[1] - n[1] * t[0]];
        [if n[0] < 0.0 { t.map(|x| -x) } else { t }, b, n]
    };
    positions.iter().map(frame).collect()
}

impl LobeScene {
    /// With lobes for `points`; bright enough on the whole that the mean means something.
    fn new(mesh: Scene, shape: LobeShape, points: usize) -> Self {
        let n = shape.order.get();
        let mut explicit: Vec<f32> = noise(points * shape.explicit_floats(), 1).iter().map(|x| 0.3 * x).collect();
        explicit.chunks_exact_mut(shape.explicit_count).for_each(|row| row[0] += 1.0);
        let mut coeffs: Vec<f32> = noise(points * shape.coeff_floats(), 2).iter().map(|x| 0.3 * x).collect();
        coeffs.chunks_exact_mut(n).for_each(|lobe| lobe[..shape.first_band().min(n)].fill(0.0));
        let mut light = noise(3 * n * n, 4);
        light.chunks_exact_mut(n * n).for_each(|channel| channel[0] = 2.0);
        Self {
            axes: vectors(points * shape.axis_count(), 3).into_iter().map(unit).collect(),
            view_map: noise(VIEW_SIZE * VIEW_SIZE * shape.rows, 5).iter().map(|x| 1.0 + 0.5 * x).collect(),
            frames: random_frames(mesh.positions.len(), 6),
            mesh,
            shape,
            explicit,
            coeffs,
            light,
        }
    }

    fn vertices(rings: u32, shape: LobeShape) -> Self {
        let mesh = Scene::sphere(rings, 1, 1);
        let points = mesh.positions.len();
        Self::new(mesh, shape, points)
    }

    fn lobes(&self) -> Lobes<'_> {
        let map = ViewMap { size: VIEW_SIZE, values: &self.view_map };
        let map = (self.shape.rows > 1).then_some(map);
        Lobes::new(self.shape, &self.explicit, &self.axes, &self.coeffs, map).unwrap()
    }

    fn surface(&self) -> LobeSurface<'_> {
        LobeSurface::new(&self.mesh.positions, &self.mesh.triangles, &self.mesh.albedo, self.lobes()).unwrap()
    }
}

fn shape(n: usize, rows: usize, channels: usize, lobe_count: usize, explicit_count: usize) -> LobeShape {
    LobeShape { order: order(n), rows, channels, lobe_count, explicit_count }
}

/// Compares all vertices with the twin: a share of the mean. Some hundred products are added up in two orders, 6e-8 each. Where the table
/// is used, its coordinates differ by 3e-7 of a turn, 1e-5 texels, between neighbours that differ by a tenth of the signal. Measured: 6e-6
/// on a software adapter.
fn assert_radiance(shaded: &[[f32; 3]], expected: &[[f32; 3]]) {
    let mean = expected.as_flattened().iter().map(|x| x.abs()).sum::<f32>() / (3 * expected.len()) as f32;
    for (v, (s, e)) in shaded.iter().zip(expected).enumerate() {
        let near = (0..3).all(|c| (s[c] - e[c]).abs() <= 2e-5 * mean);
        assert!(near, "vertex {v}: {s:?} is not {e:?}, mean {mean}");
    }
}

fn assert_shaded(
    renderer: &mut LobeRenderer,
    surface: &LobeSurface<'_>,
    frames: &[Frame3],
    light: (&[f32], usize),
    eye: Option<[f32; 3]>,
    evaluation: Evaluation,
) {
    let mut expected = vec![[0.0; 3]; surface.vertex_count()];
    cpu::shade_lobes(surface, frames, light.0, order(light.1), eye, evaluation, &mut expected);
    assert_radiance(&renderer.read_radiance(eye).unwrap(), &expected);
}

#[test]
fn every_shape_of_lobes_is_shaded_the_same() {
    let Some(gpu) = gpu() else { return };
    for (n, rows, channels, lobe_count, k) in [
        (1, 1, 1, 0, 1),
        (1, 1, 3, 2, 1),
        (2, 1, 1, 1, 1),
        (2, 3, 1, 2, 4),
        (3, 1, 1, 1, 1),
        (4, 3, 1, 3, 4),
        (5, 3, 3, 2, 1),
        (6, 1, 1, 4, 4),
        (6, 1, 3, 4, 4),
        (10, 1, 1, 4, 4),
        (10, 3, 3, 1, 1),
    ] {
        let scene = LobeScene::vertices(8, shape(n, rows, channels, lobe_count, k));
        let surface = scene.surface().with_local_frames(&scene.frames).unwrap();
        let mut renderer = LobeRenderer::new(&gpu, &surface).unwrap();
        let turned = random_frames(surface.vertex_count(), 20);
        for frames in [&[][..], &turned] {
            let given = Some(frames).filter(|frames| !frames.is_empty());
            renderer.set_pose(surface.positions, given).unwrap();
            for evaluation in [Evaluation::Direct, TABLE] {
                renderer.set_evaluation(evaluation).unwrap();
                for used in [n.div_ceil(2), n] {
                    let light = noise(3 * used * used, 30);
                    renderer.set_light(&light, order(used)).unwrap();
                    for eye in [None, Some([2.0, -1.0, 3.0])] {
                        assert_shaded(&mut renderer, &surface, frames, (&light, used), eye, evaluation);
                    }
                }
            }
        }
    }
}

#[test]
fn tables_are_built_the_same() {
    let Some(gpu) = gpu() else { return };
    for (n, k) in [(2, 1), (3, 4), (6, 4), (10, 1)] {
        let scene = LobeScene::vertices(4, shape(n, 1, 1, 1, k));
        let mut renderer = LobeRenderer::new(&gpu, &scene.surface()).unwrap();
        for (width, height) in [(4, 2), (6, 3), (64, 32), (256, 128)] {
            renderer.set_evaluation(Evaluation::Table { width, height }).unwrap();
            for used in [n, n - 1] {
                let light = noise(3 * used * used, 40);
                renderer.set_light(&light, order(used)).unwrap();
                let made = renderer.read_table().unwrap().unwrap();
                let expected = cpu::build_table(&light, order(used), scene.shape.first_band(), width, height);
                let sizes = |t: &prt_gpu::LobeTable| (t.width(), t.height(), t.band_count());
                assert_eq!(sizes(&made), sizes(&expected));
                let bands = made.band_count();
                for i in 0..500 {
                    let direction = unit([(i as f32).sin(), (0.7 * i as f32).cos(), (1.3 * i as f32).sin()]);
                    let [mut m, mut e] = [0, 1].map(|_| vec![[0.0; 3]; bands]);
                    made.sample(direction, &mut m);
                    expected.sample(direction, &mut e);
                    let near = m.as_flattened().iter().zip(e.as_flattened()).all(|(m, e)| (m - e).abs() < 1e-5);
                    assert!(near, "{direction:?}: {m:?} is not {e:?}");
                }
            }
        }
        renderer.set_evaluation(Evaluation::Direct).unwrap();
        assert_eq!(renderer.read_table().unwrap(), None);
    }
}

#[test]
fn lobes_split_into_pieces_give_the_same_bits() {
    let Some(gpu) = gpu() else { return };
    let scene = LobeScene::vertices(16, shape(6, 1, 1, 4, 4));
    let adapter = ShadingLimits::of(&gpu);
    let open = |limits| LobeRenderer::with_limits(&gpu, &scene.surface(), limits);
    let read = |limits| {
        let mut renderer = open(limits).unwrap();
        renderer.set_pose(&scene.mesh.positions, Some(&scene.frames)).unwrap();
        renderer.set_light(&scene.light, scene.shape.order).unwrap();
        renderer.read_radiance(None).unwrap()
    };
    let whole = read(adapter);
    // A record is 4 + 12 + 16 floats.
    for vertices_per_buffer in [1, 7, 64, 65, 200] {
        let limits = ShadingLimits { buffer_bytes: vertices_per_buffer * 32 * 4, ..adapter };
        assert_eq!(whole, read(limits), "{vertices_per_buffer} vertices per buffer");
    }
    assert_eq!(whole, read(ShadingLimits { groups_per_side: 3, ..adapter }));
    let error = open(ShadingLimits { buffer_bytes: 100, ..adapter }).unwrap_err().to_string();
    assert!(error.starts_with("lobes of one vertex needs 128 bytes in one binding; the adapter "), "{error}");
    let error = open(ShadingLimits { groups_per_side: 2, ..adapter }).unwrap_err().to_string();
    assert!(error.starts_with("shading needs 8 workgroups; the adapter "), "{error}");
}

#[test]
fn images_of_lobes_are_the_same_while_everything_changes() {
    let Some(gpu) = gpu() else { return };
    let scene = LobeScene::vertices(24, shape(4, 3, 1, 2, 4));
    let surface = scene.surface().with_local_frames(&scene.frames).unwrap();
    let mut renderer = LobeRenderer::new(&gpu, &surface).unwrap();
    renderer.set_light(&scene.light, scene.shape.order).unwrap();
    let bent: Vec<[f32; 3]> =
        scene.mesh.positions.iter().map(|p| [p[0] + 0.2 * p[1] * p[1], p[1], 0.7 * p[2]]).collect();
    for (pose, positions) in [&scene.mesh.positions, &bent, &scene.mesh.positions].into_iter().enumerate() {
        let frames = random_frames(positions.len(), 50 + pose as u32);
        renderer.set_pose(positions, Some(&frames)).unwrap();
        let posed = LobeSurface::new(positions, surface.triangles, surface.albedo, surface.lobes).unwrap();
        let posed = posed.with_local_frames(&scene.frames).unwrap();
        for (eye, side) in [([0.0, 0.0, 3.0], 64), ([1.0, 1.0, 2.0], 48)] {
            let view = View::new(look_at(eye, 1.0, 0.05), side, side, 1).unwrap();
            let drawn = renderer.render(&view, Some(eye)).unwrap();
            let expected =
                cpu::render_lobes(&posed, &frames, &scene.light, order(4), Some(eye), Evaluation::default(), &view);
            assert!(assert_near(&drawn, &expected.unwrap(), 2e-5) > 300);
        }
    }
    // Colours stay when the eye moves, until something is set.
    let view = View::new(look_at([0.0, 0.0, 3.0], 1.0, 0.05), 64, 64, 1).unwrap();
    let colors = vec![[0.25, 0.5, 1.0]; surface.vertex_count()];
    renderer.set_colors(&colors).unwrap();
    let expected = cpu::rasterize(surface.positions, surface.triangles, &colors, &view);
    for eye in [[0.0, 0.0, 3.0], [0.0, 1.0, 3.0]] {
        assert_same(&renderer.render(&view, Some(eye)).unwrap(), &expected);
    }
    let dark = vec![[0.0; 3]; surface.vertex_count()];
    renderer.set_albedo(&dark).unwrap();
    assert!(renderer.read_radiance(None).unwrap().iter().all(|r| *r == [0.0; 3]));
}

/// As [`assert_same`], with another bound for radiance.
fn assert_near(gpu: &Frame, cpu: &Frame, tolerance: f32) -> usize {
    let seen: Vec<&[f32; 4]> = cpu.pixels.iter().filter(|p| p[3] > 0.0).collect();
    let mean = seen.iter().flat_map(|p| &p[..3]).map(|x| x.abs()).sum::<f32>() / (3 * seen.len().max(1)) as f32;
    assert_eq!(gpu.depth, cpu.depth);
    for (i, (g, c)) in gpu.pixels.iter().zip(&cpu.pixels).enumerate() {
        assert_eq!(g[3], c[3], "coverage of pixel {i}");
        let difference = (0..3).map(|k| (g[k] - c[k]).abs()).fold(0.0, f32::max);
        assert!(difference <= tolerance * mean, "pixel {i}: {g:?} and {c:?}, mean {mean}");
    }
    seen.len()
}

/// A sphere with a texture of `side` texels, mapped by longitude and latitude.
struct TextureScene {
    lobes: LobeScene,
    side: [usize; 2],
    uvs: Vec<[f32; 2]>,
    texels: Vec<[f32; 3]>,
    /// Of the relief, for the view map.
    normals: Vec<[f32; 3]>,
}

impl TextureScene {
    fn new(mesh: Scene, shape: LobeShape, side: [usize; 2]) -> Self {
        let uv = |p: &[f32; 3]| [p[0].atan2(p[2]) / 3.0 - 0.2, 0.4 * p[1] - 1.7];
        let uvs = mesh.positions.iter().map(uv).collect();
        let points = side[0] * side[1];
        let texels = vectors(points, 60).into_iter().map(|t| t.map(|x| 0.6 + 0.3 * x)).collect();
        let frames = sphere_frames(&mesh.positions);
        let lobes = LobeScene { frames, ..LobeScene::new(mesh, shape, points) };
        let normals = vectors(points, 80).into_iter().map(|[x, y, z]| unit([x, y, 0.3 + z.abs()])).collect();
        Self { lobes, side, uvs, texels, normals }
    }

    fn surface(&self, has_albedo: bool) -> TexturedSurface<'_> {
        let albedo = has_albedo.then_some(&self.texels[..]);
        let texture = LobeTexture::new(self.side[0], self.side[1], albedo, self.lobes.lobes()).unwrap();
        let texture = if self.lobes.shape.rows > 1 { texture.with_normals(&self.normals).unwrap() } else { texture };
        let mesh = &self.lobes.mesh;
        TexturedSurface::new(&mesh.positions, &mesh.triangles, &self.uvs, &mesh.albedo, texture).unwrap()
    }
}

/// Interpolated frames are made orthonormal, axes and bands are evaluated per sample: some 1e-6 more than at vertices. Between texels of
/// very different lobes a share of 1e-7 of a tile counts up to 1e-5. One texel read wrongly would be 0.1.
const TEXTURE_TOLERANCE: f32 = 1e-4;

#[test]
fn textured_images_are_the_same() {
    let Some(gpu) = gpu() else { return };
    let samplings = [LobeSampling::Nearest, LobeSampling::PointLobes, LobeSampling::Bilinear];
    let cases = [
        (shape(6, 1, 1, 4, 4), [16, 8], [1.0, 1.0], true),
        (shape(4, 3, 1, 3, 4), [5, 7], [3.5, -2.0], false),
        (shape(3, 1, 3, 1, 1), [1, 1], [40.0, 40.0], true),
        (shape(3, 3, 3, 2, 1), [64, 64], [2.0, 1.0], true),
    ];
    for (case, (shape, side, repeat, has_albedo)) in cases.into_iter().enumerate() {
        let scene = TextureScene::new(Scene::sphere(24, 1, 1).with_floor(), shape, side);
        for (k, sampling) in samplings.into_iter().enumerate() {
            let surface = scene.surface(has_albedo).with_repeat(repeat).unwrap().with_sampling(sampling);
            let mut renderer = TexturedRenderer::new(&gpu, &surface).unwrap();
            renderer.set_pose(surface.positions, Some(&scene.lobes.frames)).unwrap();
            renderer.set_light(&scene.lobes.light, shape.order).unwrap();
            let evaluation = [Evaluation::Direct, TABLE, Evaluation::default()][(case + k) % 3];
            renderer.set_evaluation(evaluation).unwrap();
            for eye in [[0.3, 0.8, 2.9], [0.0, -0.9, 1.3]] {
                let view = View::new(look_at(eye, 1.0, 0.05), 64, 64, 1 + k as u32 % 2).unwrap();
                let drawn = renderer.render(&view, Some(eye)).unwrap();
                let (frames, light) = (&scene.lobes.frames, &scene.lobes.light);
                let expected =
                    cpu::render_textured(&surface, frames, light, shape.order, Some(eye), evaluation, &view).unwrap();
                assert!(assert_near(&drawn, &expected, TEXTURE_TOLERANCE) > 1000);
            }
        }
    }
}

#[test]
fn textured_surfaces_follow_what_is_set() {
    let Some(gpu) = gpu() else { return };
    let shape = shape(4, 1, 1, 2, 4);
    let scene = TextureScene::new(Scene::sphere(16, 1, 1), shape, [8, 8]);
    let surface = scene.surface(true);
    let mut renderer = TexturedRenderer::new(&gpu, &surface).unwrap();
    let view = View::new(look_at([0.0, 0.5, 3.0], 1.0, 0.05), 64, 64, 1).unwrap();
    let black = renderer.render(&view, None).unwrap();
    assert!(black.pixels.iter().all(|p| p[..3] == [0.0; 3]) && black.pixels.iter().any(|p| p[3] == 1.0));
    let bent: Vec<[f32; 3]> = surface.positions.iter().map(|p| [0.8 * p[0], p[1] + 0.1 * p[0], p[2]]).collect();
    let bright = vec![[1.0, 0.5, 0.25]; bent.len()];
    renderer.set_pose(&bent, Some(&scene.lobes.frames)).unwrap();
    renderer.set_albedo(&bright).unwrap();
    for used in [4, 1, 2] {
        let light: Vec<f32> = noise(3 * used * used, 70).iter().map(|x| 1.5 + x).collect();
        renderer.set_light(&light, order(used)).unwrap();
        let posed = TexturedSurface::new(&bent, surface.triangles, surface.uvs, &bright, surface.texture).unwrap();
        let table = Evaluation::default();
        let expected = cpu::render_textured(&posed, &scene.lobes.frames, &light, order(used), None, table, &view);
        assert!(assert_near(&renderer.render(&view, None).unwrap(), &expected.unwrap(), TEXTURE_TOLERANCE) > 500);
    }
}

fn joint(angle: f32, scale: [f32; 3], offset: [f32; 3]) -> [[f32; 4]; 4] {
    let (s, c) = angle.sin_cos();
    [
        [c * scale[0], s * scale[0], 0.0, 0.0],
        [-s * scale[1], c * scale[1], 0.0, 0.0],
        [0.0, 0.3 * scale[2], scale[2], 0.0],
        [offset[0], offset[1], offset[2], 1.0],
    ]
}

#[test]
fn skins_are_posed_the_same() {
    let Some(gpu) = gpu() else { return };
    let scene = LobeScene::vertices(16, shape(4, 1, 1, 2, 4));
    let (surface, vertices) = (scene.surface(), scene.mesh.positions.len());
    let joints: Vec<[u32; 4]> = (0..vertices as u32).map(|v| [v % 5, (v / 5) % 5, (v / 7) % 5, 4 - v % 5]).collect();
    let weights: Vec<[f32; 4]> = noise(4 * vertices, 80)
        .chunks_exact(4)
        .map(|w| {
            let w: [f32; 4] = std::array::from_fn(|k| w[k].abs() + 0.05);
            let sum: f32 = w.iter().sum();
            w.map(|w| w / sum)
        })
        .collect();
    let rest = random_frames(vertices, 81);
    let skin = Skin::new(&scene.mesh.positions, &rest, &joints, &weights).unwrap();
    let mut renderer = LobeRenderer::new(&gpu, &surface).unwrap();
    renderer.set_light(&scene.light, scene.shape.order).unwrap();
    let text = renderer.set_joints(&[]).unwrap_err().to_string();
    assert_eq!(text, "joints were set for a surface without a skin; set a skin before");
    renderer.set_skin(&skin).unwrap();
    for turn in [0.0, 1.0] {
        let matrices: Vec<_> = (0..5)
            .map(|j| joint(0.5 * turn * j as f32, [1.0, 1.0 + 0.2 * j as f32, 0.8], [0.1 * j as f32, 0.0, 0.2 * turn]))
            .collect();
        let (mut positions, mut frames) = (vec![[0.0; 3]; vertices], vec![[[0.0; 3]; 3]; vertices]);
        cpu::skin(&skin, &matrices, PoseFrames::FromRest, &mut positions, &mut frames);
        renderer.set_joints(&matrices).unwrap();
        for (v, (made, expected)) in renderer.read_frames().unwrap().iter().zip(&frames).enumerate() {
            // Some thirty roundings of numbers of size 1, divided by a normal of length 0.3 or more.
            let near = made.as_flattened().iter().zip(expected.as_flattened()).all(|(m, e)| (m - e).abs() < 2e-5);
            assert!(near, "vertex {v}: {made:?} is not {expected:?}");
        }
        let posed = LobeSurface::new(&positions, surface.triangles, surface.albedo, surface.lobes).unwrap();
        let view = View::new(look_at([0.0, 0.5, 4.0], 1.0, 0.05), 64, 64, 1).unwrap();
        let expected =
            cpu::render_lobes(&posed, &frames, &scene.light, order(4), None, Evaluation::default(), &view).unwrap();
        // Shading magnifies the difference of frames.
        assert!(assert_near(&renderer.render(&view, None).unwrap(), &expected, 2e-4) > 200);
    }
    let error = renderer.set_joints(&[[[0.0; 4]; 4]; 4]).unwrap_err().to_string();
    assert_eq!(error, "joint matrices has 4 entries; a skin whose largest joint is 4 needs 5");
    let error = renderer.set_joints(&[[[f32::NAN; 4]; 4]; 5]).unwrap_err().to_string();
    assert_eq!(error, "matrix of joint 0 is not finite");
}

#[test]
fn textured_skins_have_tangent_frames() {
    let Some(gpu) = gpu() else { return };
    let shape = shape(4, 1, 1, 2, 4);
    let scene = TextureScene::new(Scene::sphere(16, 1, 1), shape, [8, 8]);
    let (surface, vertices) = (scene.surface(false), scene.lobes.mesh.positions.len());
    let (joints, weights) = (vec![[0; 4]; vertices], vec![[1.0, 0.0, 0.0, 0.0]; vertices]);
    let skin = Skin::new(surface.positions, &scene.lobes.frames, &joints, &weights).unwrap();
    let matrices = [joint(0.7, [1.2, 0.8, 1.0], [0.1, 0.2, 0.0])];
    let (mut positions, mut frames) = (vec![[0.0; 3]; vertices], vec![[[0.0; 3]; 3]; vertices]);
    cpu::skin(&skin, &matrices, PoseFrames::Tangent, &mut positions, &mut frames);
    let mut renderer = TexturedRenderer::new(&gpu, &surface).unwrap();
    renderer.set_light(&scene.lobes.light, shape.order).unwrap();
    renderer.set_skin(&skin).unwrap();
    renderer.set_joints(&matrices).unwrap();
    let view = View::new(look_at([0.5, 0.5, 4.0], 1.0, 0.05), 64, 64, 1).unwrap();
    let posed =
        TexturedSurface::new(&positions, surface.triangles, surface.uvs, surface.albedo, surface.texture).unwrap();
    let light = &scene.lobes.light;
    let expected = cpu::render_textured(&posed, &frames, light, shape.order, None, Evaluation::default(), &view);
    assert!(assert_near(&renderer.render(&view, None).unwrap(), &expected.unwrap(), 5e-4) > 200);
}

#[test]
fn collapsed_and_broken_poses_are_finite() {
    let Some(gpu) = gpu() else { return };
    let scene = LobeScene::vertices(8, shape(3, 3, 1, 2, 4));
    let (surface, vertices) = (scene.surface(), scene.mesh.positions.len());
    let mut renderer = LobeRenderer::new(&gpu, &surface).unwrap();
    renderer.set_light(&scene.light, order(3)).unwrap();
    let view = View::new(look_at([0.0, 0.5, 4.0], 1.0, 0.05), 32, 32, 1).unwrap();
    let finite = |renderer: &mut LobeRenderer| {
        let frame = renderer.render(&view, Some([0.0, 0.5, 4.0])).unwrap();
        assert!(frame.pixels.as_flattened().iter().all(|x| x.is_finite()));
        assert!(renderer.read_radiance(None).unwrap().as_flattened().iter().all(|x| x.is_finite()));
        frame.pixels.iter().filter(|p| p[3] > 0.0).count()
    };
    let mut broken = scene.mesh.positions.clone();
    broken.iter_mut().step_by(3).for_each(|p| p[1] = f32::NAN);
    let bad = [[[0.0; 3]; 3], [[f32::NAN; 3]; 3], [[f32::INFINITY, 0.0, 0.0]; 3], [[1.0, 0.0, 0.0]; 3]];
    let frames: Vec<Frame3> = (0..vertices).map(|v| bad[v % 4]).collect();
    let whole = finite(&mut renderer);
    renderer.set_pose(&broken, Some(&frames)).unwrap();
    assert!(finite(&mut renderer) < whole, "triangles that are not finite are not drawn");
    let (joints, weights) = (vec![[0; 4]; vertices], vec![[1.0, 0.0, 0.0, 0.0]; vertices]);
    let skin = Skin::new(surface.positions, &scene.frames, &joints, &weights).unwrap();
    renderer.set_skin(&skin).unwrap();
    let flat = joint(0.0, [1.0, 1.0, 0.0], [0.0; 3]);
    let tiny = [[1e-25, 0.0, 0.0, 0.0], [0.0, 1e-25, 0.0, 0.0], [0.0, 0.0, 1e-25, 0.0], [0.0; 4]];
    let line = [[1.0, 1.0, 0.0, 0.0], [1.0, 1.0, 0.0, 0.0], [0.0; 4], [0.0; 4]];
    let mirror = joint(0.3, [-1.0, 1.0, 1.0], [0.0; 3]);
    for matrix in [flat, [[0.0; 4]; 4], tiny, line, mirror] {
        renderer.set_joints(&[matrix]).unwrap();
        finite(&mut renderer);
        for frame in renderer.read_frames().unwrap() {
            let dot = |i: usize, j: usize| (0..3).map(|k| frame[i][k] * frame[j][k]).sum::<f32>();
            let worst =
                (0..9).map(|k| (dot(k / 3, k % 3) - f32::from(u8::from(k / 3 == k % 3))).abs()).fold(0.0, f32::max);
            assert!(worst < 1e-4, "{matrix:?}: {frame:?}");
        }
    }
}

#[test]
fn wrong_input_of_lobes_is_named() {
    let Some(gpu) = gpu() else { return };
    let text = |result: Result<(), Error>| result.unwrap_err().to_string();
    let scene = LobeScene::vertices(6, shape(3, 1, 1, 1, 1));
    let vertices = scene.mesh.positions.len();
    let mut renderer = LobeRenderer::new(&gpu, &scene.surface()).unwrap();
    assert!(text(renderer.set_light(&[0.0; 48], order(4))).starts_with("order 4 was asked for"));
    assert!(text(renderer.set_evaluation(Evaluation::Table { width: 7, height: 4 })).starts_with("a table of 7 x 4"));
    assert!(text(renderer.set_pose(&[[0.0; 3]; 2], None)).starts_with("positions has 2 entries; a surface of "));
    assert!(text(renderer.set_pose(&scene.mesh.positions, Some(&[]))).starts_with("frames has 0 entries"));
    assert!(text(renderer.set_albedo(&[])).starts_with("albedo has 0 entries"));
    assert!(text(renderer.set_colors(&[])).starts_with("colors has 0 entries"));
    let (joints, weights) = ([[0; 4]; 2], [[0.25; 4]; 2]);
    let skin = Skin::new(&scene.mesh.positions[..2], &scene.frames[..2], &joints, &weights).unwrap();
    assert_eq!(
        text(renderer.set_skin(&skin)),
        format!("skin has 2 entries; a surface of {vertices} vertices needs {vertices}")
    );
    let target = Target::new(&gpu, 8, 8, 1).unwrap();
    let mut encoder = gpu.device().create_command_encoder(&Default::default());
    let other = View::new(super::scene::IDENTITY, 8, 9, 1).unwrap();
    assert!(
        text(renderer.draw(&mut encoder, &other, None, &target)).starts_with("a view of size and samples [8, 9, 1]")
    );

    let high = LobeScene::vertices(4, shape(11, 1, 1, 1, 1));
    assert_eq!(
        text(LobeRenderer::new(&gpu, &high.surface()).map(drop)),
        "lobes of order 11 were given; the GPU shades up to order 10"
    );
}

#[test]
fn devices_with_few_storage_buffers_shade_vectors_only() {
    let Some(gpu) = gpu() else { return };
    let few = gpu_with_few_storage_buffers(&gpu);
    let Some(few) = few else { return };
    let scene = LobeScene::vertices(6, shape(3, 1, 1, 1, 1));
    let error = LobeRenderer::new(&few, &scene.surface()).map(drop).unwrap_err().to_string();
    assert!(error.starts_with("shading lobes needs 8 storage buffers per shader; the adapter "), "{error}");
    let surface = scene.mesh.surface();
    assert!(prt_gpu::SurfaceRenderer::new(&few, &surface).is_ok());
}

/// A device of WebGPU's lowest limits, if the adapter gives one.
fn gpu_with_few_storage_buffers(gpu: &Gpu) -> Option<Gpu> {
    use prt_gpu::wgpu;
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
    let adapter = adapters.into_iter().find(|adapter| adapter.get_info().name == gpu.info().name)?;
    let descriptor =
        wgpu::DeviceDescriptor { required_limits: wgpu::Limits::downlevel_defaults(), ..Default::default() };
    let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).ok()?;
    Gpu::from_parts(device, queue, adapter.get_info()).ok()
}
