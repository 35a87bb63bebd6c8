//! The GPU passes against their CPU twins. Without an adapter every test says that it is skipped; `PRT_REQUIRE_GPU=1` makes that a
//! failure. `WGPU_BACKEND=gl` runs them on OpenGL.
#![expect(clippy::unwrap_used, clippy::print_stderr, reason = "tests")]

mod lobes;
mod scene;

use prt_gpu::{
    Background, Error, Frame, Gpu, PresentOptions, Presenter, ShadingLimits, Surface, SurfaceRenderer, Target, View,
    cpu, tone_map, wgpu,
};
use scene::{Scene, look_at, noise};
use sh_core::Order;
use std::process::Command;
use std::sync::OnceLock;

/// Largest difference of a pixel, relative to the mean radiance of what is seen.
///
/// What is left when coverage and depth are equal: sums of 36 products in another order, and the rounding of nine operations of the
/// interpolation, 6e-8 each of the larger vertices around. Measured: 8e-7. The promise of the crate is 1e-4.
const PIXEL_TOLERANCE: f32 = 4e-6;

/// The adapter that all tests share, or none.
fn gpu() -> Option<Gpu> {
    static GPU: OnceLock<Result<Gpu, Error>> = OnceLock::new();
    match GPU.get_or_init(Gpu::headless) {
        Ok(gpu) => Some(gpu.clone()),
        Err(error) => {
            assert!(std::env::var("PRT_REQUIRE_GPU").as_deref() != Ok("1"), "PRT_REQUIRE_GPU is set: {error}");
            eprintln!("skipped: {error}");
            None
        }
    }
}

fn order(n: usize) -> Order {
    Order::new(n).unwrap()
}

/// Both images of a scene.
fn render_both(gpu: &Gpu, scene: &Scene, view: &View) -> (Frame, Frame) {
    let mut renderer = SurfaceRenderer::new(gpu, &scene.surface()).unwrap();
    renderer.set_light(&scene.light, scene.order).unwrap();
    (renderer.render(view).unwrap(), cpu::render(&scene.surface(), &scene.light, scene.order, view).unwrap())
}

/// Coverage and depth must be the same bits; radiance within [`PIXEL_TOLERANCE`]. Returns the number of pixels that show something.
fn assert_same(gpu: &Frame, cpu: &Frame) -> usize {
    assert_eq!((gpu.width, gpu.height), (cpu.width, cpu.height));
    assert_eq!(gpu.depth, cpu.depth, "depth");
    let seen: Vec<&[f32; 4]> = cpu.pixels.iter().filter(|p| p[3] > 0.0).collect();
    let mean = seen.iter().flat_map(|p| &p[..3]).map(|x| x.abs()).sum::<f32>() / (3 * seen.len().max(1)) as f32;
    for (i, (g, c)) in gpu.pixels.iter().zip(&cpu.pixels).enumerate() {
        assert_eq!(g[3], c[3], "coverage of pixel {i}");
        let difference = (0..3).map(|k| (g[k] - c[k]).abs()).fold(0.0, f32::max);
        assert!(difference <= PIXEL_TOLERANCE * mean, "pixel {i}: {g:?} and {c:?}, mean {mean}");
    }
    seen.len()
}

#[test]
fn a_dense_sphere_is_the_same_at_every_sampling() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene::sphere(96, 6, 1);
    for (width, height, samples) in [(256, 256, 1), (200, 120, 2), (65, 127, 3), (64, 64, 4)] {
        let view =
            View::new(look_at([0.3, 0.8, 2.9], width as f32 / height as f32, 0.1), width, height, samples).unwrap();
        let (gpu, cpu) = render_both(&gpu, &scene, &view);
        assert!(assert_same(&gpu, &cpu) > 1000);
    }
}

#[test]
fn a_camera_inside_the_surface_is_the_same() {
    let Some(gpu) = gpu() else { return };
    // From inside all is back, and triangles cross every plane of the view volume.
    let scene = Scene::sphere(24, 3, 3).with_floor();
    for eye in [[0.0, 0.9, 0.3], [0.1, -0.95, 0.9], [0.99, 0.0, 0.1], [0.0, -0.9, 4.0]] {
        let view = View::new(look_at(eye, 1.0, 0.05), 150, 150, 2).unwrap();
        let (gpu, cpu) = render_both(&gpu, &scene, &view);
        assert!(assert_same(&gpu, &cpu) > 5000);
    }
}

#[test]
fn a_soup_of_triangles_is_the_same() {
    let Some(gpu) = gpu() else { return };
    // Thousands of intersecting slivers, large and small, some behind the camera, and each with its twin of opposite winding.
    let scene = Scene::soup(3000);
    for samples in [1, 2] {
        let view = View::new(look_at([0.1, 0.2, 1.0], 1.0, 0.01), 128, 128, samples).unwrap();
        let (gpu, cpu) = render_both(&gpu, &scene, &view);
        let seen = assert_same(&gpu, &cpu);
        assert!(seen > 10_000, "{seen}");
    }
}

#[test]
fn edges_through_sample_centres_are_the_same() {
    let Some(gpu) = gpu() else { return };
    // A grid whose lines all pass through sample centres, on the image plane: nothing but ties.
    for (side, cells) in [(32_u32, 32_u32), (32, 16), (64, 32)] {
        let scene = Scene::grid(side, cells);
        let view = View::new(scene::IDENTITY, side, side, 1).unwrap();
        let (gpu, cpu) = render_both(&gpu, &scene, &view);
        assert!(assert_same(&gpu, &cpu) > 0);
    }
}

#[test]
fn wide_and_tall_images_snap_to_the_same_grid() {
    let Some(gpu) = gpu() else { return };
    let limit = gpu.device().limits().max_texture_dimension_2d.min(View::MAX_SIDE);
    let scene = Scene::sphere(96, 2, 1);
    for (width, height) in [(limit, 3), (5, limit)] {
        let view = View::new(look_at([0.0, 0.0, 3.0], 1.0, 0.1), width, height, 1).unwrap();
        let (gpu, cpu) = render_both(&gpu, &scene, &view);
        assert!(assert_same(&gpu, &cpu) > 1000);
    }
}

#[test]
fn every_order_and_both_kinds_of_transfer_are_shaded_the_same() {
    let Some(gpu) = gpu() else { return };
    for channels in [1, 3] {
        for stored in [1, 2, 3, 4, 6, 9] {
            let scene = Scene::sphere(12, stored, channels);
            let mut renderer = SurfaceRenderer::new(&gpu, &scene.surface()).unwrap();
            for used in 1..=stored {
                let light = noise(3 * used * used, 5);
                renderer.set_light(&light, order(used)).unwrap();
                assert_radiance(&mut renderer, &scene.surface(), &light, order(used));
            }
        }
    }
}

/// Compares the radiance of every vertex with the twin.
fn assert_radiance(renderer: &mut SurfaceRenderer, surface: &Surface<'_>, light: &[f32], order: Order) {
    let mut expected = vec![[0.0; 3]; surface.vertex_count()];
    cpu::shade_vector(surface, light, order, &mut expected);
    let shaded = renderer.read_radiance().unwrap();
    // Products are at most 1 here: each is rounded once and added once, in both twins.
    let limit = 4.0 * order.coeff_count() as f32 * f32::EPSILON;
    for (v, (s, e)) in shaded.iter().zip(&expected).enumerate() {
        assert!(s.iter().zip(e).all(|(s, e)| (s - e).abs() <= limit), "vertex {v}: {s:?} is not {e:?}");
    }
}

#[test]
fn shading_split_into_pieces_gives_the_same_bits() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene::sphere(16, 4, 3);
    let adapter = ShadingLimits::of(&gpu);
    let open = |limits| SurfaceRenderer::with_limits(&gpu, &scene.surface(), limits);
    let read = |limits| {
        let mut renderer = open(limits).unwrap();
        renderer.set_light(&scene.light, scene.order).unwrap();
        renderer.read_radiance().unwrap()
    };
    // 512 vertices, 8 workgroups; one vertex takes 3 x 4 blocks of 16 bytes.
    let whole = read(adapter);
    for vertices_per_buffer in [1, 7, 64, 65, 200] {
        let limits = ShadingLimits { buffer_bytes: vertices_per_buffer * 3 * 4 * 16, ..adapter };
        assert_eq!(whole, read(limits), "{vertices_per_buffer} vertices per buffer");
    }
    for groups_per_side in [3, 4, 7] {
        assert_eq!(whole, read(ShadingLimits { groups_per_side, ..adapter }), "{groups_per_side} workgroups per side");
    }
    let error = open(ShadingLimits { buffer_bytes: 100, ..adapter }).unwrap_err().to_string();
    assert!(error.starts_with("transfer of one vertex needs 192 bytes in one binding; the adapter "), "{error}");
    assert!(error.ends_with(" allows 100"), "{error}");
    let error = open(ShadingLimits { groups_per_side: 2, ..adapter }).unwrap_err().to_string();
    assert!(error.starts_with("shading needs 8 workgroups; the adapter ") && error.ends_with(" allows 4"), "{error}");
}

#[test]
fn the_smallest_surfaces_are_drawn() {
    let Some(gpu) = gpu() else { return };
    let n = order(1);
    let view = View::new(scene::IDENTITY, 1, 1, 1).unwrap();
    let (positions, albedo) = ([[-3.0, -1.0, 0.5], [3.0, -1.0, 0.5], [0.0, 3.0, 0.5]], [[0.5, 0.25, 1.0]; 3]);
    let transfer = [1.0, 1.0, 1.0];

    let nothing = Surface::new(&[], &[], &[], n, 1, &[]).unwrap();
    let mut renderer = SurfaceRenderer::new(&gpu, &nothing).unwrap();
    renderer.set_light(&[1.0; 3], n).unwrap();
    assert_eq!(renderer.render(&view).unwrap().pixels, [[0.0; 4]]);
    assert_eq!(renderer.read_radiance().unwrap(), Vec::<[f32; 3]>::new());

    let vertex = Surface::new(&positions[..1], &[], &albedo[..1], n, 1, &transfer[..1]).unwrap();
    let mut renderer = SurfaceRenderer::new(&gpu, &vertex).unwrap();
    renderer.set_light(&[2.0, 4.0, 8.0], n).unwrap();
    assert_eq!(renderer.read_radiance().unwrap(), [[1.0, 1.0, 8.0]]);
    assert_eq!(renderer.render(&view).unwrap().depth, [1.0]);

    let triangle = Surface::new(&positions, &[[0, 1, 2]], &albedo, n, 1, &transfer).unwrap();
    let mut renderer = SurfaceRenderer::new(&gpu, &triangle).unwrap();
    assert_eq!(renderer.render(&view).unwrap().pixels[0][3], 1.0, "unlit surfaces are black, not absent");
    renderer.set_light(&[2.0, 4.0, 8.0], n).unwrap();
    let pixel = renderer.render(&view).unwrap().pixels[0];
    assert!(pixel.iter().zip([1.0, 1.0, 8.0, 1.0]).all(|(p, e)| (p - e).abs() < 1e-5), "{pixel:?}");
}

#[test]
fn darkness_and_huge_light_are_the_same() {
    let Some(gpu) = gpu() else { return };
    let view = View::new(look_at([0.0, 0.0, 3.0], 1.0, 0.1), 64, 64, 2).unwrap();
    for (light, albedo) in [(0.0, 1.0), (1.0, 0.0), (1e30, 1.0), (1e-30, 1.0)] {
        let mut scene = Scene::sphere(16, 3, 1);
        scene.light.iter_mut().for_each(|l| *l *= light);
        scene.albedo.iter_mut().flatten().for_each(|a| *a *= albedo);
        let (gpu, cpu) = render_both(&gpu, &scene, &view);
        assert!(gpu.pixels.iter().flatten().all(|x| x.is_finite()));
        assert!(assert_same(&gpu, &cpu) > 100);
    }
}

#[test]
fn what_changes_between_frames_is_seen() {
    let Some(gpu) = gpu() else { return };
    let mut scene = Scene::sphere(24, 4, 1);
    let surface = scene.surface();
    let mut renderer = SurfaceRenderer::new(&gpu, &surface).unwrap();
    let views = [[0.0, 0.0, 3.0], [1.0, 1.0, 2.0], [0.0, 0.9, 0.3]].map(|eye| look_at(eye, 1.0, 0.05));
    let sizes = [(64, 1), (64, 1), (48, 2)];
    for (matrix, (side, samples)) in views.into_iter().zip(sizes) {
        let view = View::new(matrix, side, side, samples).unwrap();
        for used in [4, 1] {
            let light = noise(3 * used * used, used as u32);
            renderer.set_light(&light, order(used)).unwrap();
            assert_same(&renderer.render(&view).unwrap(), &cpu::render(&surface, &light, order(used), &view).unwrap());
        }
        let colors = scene.positions.iter().map(|p| p.map(|x| 0.5 + 0.5 * x)).collect::<Vec<_>>();
        renderer.set_colors(&colors).unwrap();
        assert_same(
            &renderer.render(&view).unwrap(),
            &cpu::rasterize(&scene.positions, &scene.triangles, &colors, &view),
        );
    }
    renderer.set_light(&scene.light, scene.order).unwrap();
    scene.albedo.reverse();
    renderer.set_albedo(&scene.albedo).unwrap();
    assert_radiance(&mut renderer, &scene.surface(), &scene.light, scene.order);
}

#[test]
fn wrong_input_is_named() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene::sphere(8, 3, 1);
    let mut renderer = SurfaceRenderer::new(&gpu, &scene.surface()).unwrap();
    let text = |result: Result<(), Error>| result.unwrap_err().to_string();
    assert_eq!(
        text(renderer.set_light(&[0.0; 48], order(4))),
        "order 4 was asked for; the transfer is stored to order 3"
    );
    assert_eq!(
        text(renderer.set_light(&[0.0; 26], order(3))),
        "light has 26 floats; order 3 in three channels needs 27"
    );
    assert!(text(renderer.set_albedo(&[[1.0; 3]; 5])).starts_with("albedo has 5 entries; a surface of "));
    assert!(text(renderer.set_colors(&[])).starts_with("colors has 0 entries"));
    let none = View { clip_from_world: scene::IDENTITY, width: 0, height: 1, samples: 1 };
    assert!(text(renderer.render(&none).map(drop)).starts_with("an image of 0 x 1"));
    let target = Target::new(&gpu, 8, 8, 1).unwrap();
    let mut encoder = gpu.device().create_command_encoder(&Default::default());
    let other = View::new(scene::IDENTITY, 8, 9, 1).unwrap();
    let mismatch = text(renderer.draw(&mut encoder, &other, &target));
    assert_eq!(mismatch, "a view of size and samples [8, 9, 1] was drawn into images made for [8, 8, 1]");
}

#[test]
fn a_lost_device_is_an_error() {
    // A device of its own: the others must not lose theirs.
    let Some(gpu) = gpu().and_then(|_| Gpu::headless().ok()) else { return };
    let scene = Scene::sphere(8, 3, 1);
    let mut renderer = SurfaceRenderer::new(&gpu, &scene.surface()).unwrap();
    let view = View::new(scene::IDENTITY, 8, 8, 1).unwrap();
    gpu.device().destroy();
    let drawn = renderer.set_light(&scene.light, scene.order).and_then(|()| renderer.render(&view));
    assert!(matches!(drawn, Err(Error::Device { .. })), "{drawn:?}");
    assert!(matches!(SurfaceRenderer::new(&gpu, &scene.surface()), Err(Error::Device { .. })));
}

#[test]
fn the_adapter_in_use_is_described() {
    let Some(gpu) = gpu() else { return };
    assert!(gpu.description().contains(&format!("{}: used", gpu.adapter_name())), "{}", gpu.description());
}

#[test]
fn the_device_of_a_window_is_used_as_it_is() {
    let Some(gpu) = gpu() else { return };
    let shared = Gpu::from_parts(gpu.device().clone(), gpu.queue().clone(), gpu.info().clone()).unwrap();
    assert_eq!(shared.description(), format!("{}: the window's adapter", gpu.adapter_name()));
    let scene = Scene::sphere(8, 2, 1);
    let view = View::new(look_at([0.0, 0.0, 3.0], 1.0, 0.1), 32, 32, 1).unwrap();
    let (gpu, cpu) = render_both(&shared, &scene, &view);
    assert!(assert_same(&gpu, &cpu) > 100);
}

/// Runs the test of this name in a process with other environment variables.
fn run_with(test: &str, variables: &[(&str, &str)]) -> String {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command.args(["--exact", test, "--nocapture"]).envs(variables.iter().copied());
    let output = command.output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{text}");
    text
}

/// The tests below run it again with other environment variables, and read what it prints.
#[test]
fn the_choice_of_adapter_is_told() {
    let account = match Gpu::headless() {
        Ok(gpu) => format!("found: {}", gpu.description()),
        Err(error) => format!("error: {error}"),
    };
    assert!(account.contains(": used") || account.contains("no usable GPU adapter"), "{account}");
    eprintln!("{account}");
}

#[test]
fn without_a_driver_there_is_an_error_and_no_panic() {
    let text = run_with(
        "the_choice_of_adapter_is_told",
        &[("VK_ICD_FILENAMES", "/nonexistent"), ("__EGL_VENDOR_LIBRARY_DIRS", "/nonexistent")],
    );
    // A machine with a driver of another kind finds that one.
    assert!(text.contains("error: no usable GPU adapter: looked for adapters") || text.contains("found: "), "{text}");
}

#[test]
fn the_environment_restricts_the_choice() {
    let text = run_with("the_choice_of_adapter_is_told", &[("WGPU_BACKEND", "dx13")]);
    assert!(text.contains("error: no usable GPU adapter: WGPU_BACKEND names no backend in \"dx13\""), "{text}");
    let text = run_with("the_choice_of_adapter_is_told", &[("WGPU_ADAPTER_NAME", "No Such Adapter")]);
    assert!(text.contains("with \"no such adapter\" in their name (WGPU_ADAPTER_NAME), found"), "{text}");
}

/// Shows an image with a [`Presenter`] and reads back the bytes.
fn present(gpu: &Gpu, target: &Target, options: &PresentOptions<'_>, format: wgpu::TextureFormat) -> Vec<[u8; 4]> {
    let size = wgpu::Extent3d { width: target.width(), height: target.height(), depth_or_array_layers: 1 };
    let screen = gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: None,
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let mut presenter = Presenter::new(gpu, format).unwrap();
    presenter.prepare(target, options).unwrap();
    let mut encoder = gpu.device().create_command_encoder(&Default::default());
    let view = screen.create_view(&Default::default());
    let attachment = wgpu::RenderPassColorAttachment {
        view: &view,
        depth_slice: None,
        resolve_target: None,
        ops: Default::default(),
    };
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &[Some(attachment)],
        ..Default::default()
    });
    presenter.paint(&mut pass);
    drop(pass);
    scene::read_bytes(gpu, encoder, &screen)
}

#[test]
fn the_window_shows_what_the_cpu_maps() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene::sphere(48, 4, 3);
    let view = View::new(look_at([0.4, 0.3, 2.6], 1.2, 0.1), 120, 100, 2).unwrap();
    let mut renderer = SurfaceRenderer::new(&gpu, &scene.surface()).unwrap();
    let bright: Vec<f32> = scene.light.iter().map(|l| 4.0 * l).collect();
    renderer.set_light(&bright, scene.order).unwrap();
    let target = Target::new(&gpu, 120, 100, 2).unwrap();
    let mut encoder = gpu.device().create_command_encoder(&Default::default());
    renderer.draw(&mut encoder, &view, &target).unwrap();
    gpu.queue().submit([encoder.finish()]);
    let frame = target.read(&gpu).unwrap();
    assert_same(&frame, &cpu::render(&scene.surface(), &bright, scene.order, &view).unwrap());

    let map = scene::sky(37, 19);
    let sky = Background::new(&gpu, 37, 19, &map).unwrap();
    for (background, exposure_stops) in [(None, 0.0), (Some((&sky, &view)), -1.0), (Some((&sky, &view)), 1.5)] {
        let options = PresentOptions { exposure_stops, background };
        let behind = |x: usize, y: usize| match background {
            Some(_) => scene::sample_sky(&map, 37, 19, scene::direction(&view, x, y)),
            None => [0.0; 3],
        };
        let expected: Vec<[f32; 3]> =
            frame.composite(behind).into_iter().map(|p| tone_map(p, exposure_stops)).collect();
        for format in [wgpu::TextureFormat::Rgba8Unorm, wgpu::TextureFormat::Rgba8UnormSrgb] {
            let shown = present(&gpu, &target, &options, format);
            for (i, (shown, expected)) in shown.iter().zip(&expected).enumerate() {
                // One step of 255 for rounding; hardware sRGB may be another half step off.
                let close = shown.iter().zip(expected).all(|(s, e)| (f32::from(*s) - 255.0 * e).abs() <= 1.1);
                assert!(close, "{format:?}, pixel {i}: {shown:?} is not {expected:?}");
            }
        }
    }
}

#[test]
fn a_background_must_fit() {
    let Some(gpu) = gpu() else { return };
    let text = |w, h, count| Background::new(&gpu, w, h, &vec![[0.0; 3]; count]).map(drop).unwrap_err().to_string();
    assert_eq!(text(4, 2, 7), "background has 7 pixels; an image of 4 x 2 needs 8");
    assert!(text(1 << 20, 0, 0).starts_with("a background of 1048576 x 0 needs"));
}
