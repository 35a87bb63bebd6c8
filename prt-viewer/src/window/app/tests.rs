//! The whole app without a display, on whatever adapter there is.

#![expect(clippy::unwrap_used, clippy::print_stdout, reason = "tests")]

use std::path::PathBuf;

use eframe::egui::{Event, Key, Modifiers, PointerButton, Pos2};
use eframe::egui_wgpu::{WgpuSetup, WgpuSetupCreateNew};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use glam::{Quat, Vec3};
use prt_bake::{BakeOptions, Mesh, MeshOptions, MeshSource, TransferVectors, bake_diffuse};
use sh_core::Order;
use sh_fit::Neighbours;

use super::*;
use crate::camera::{DEFAULT_FOV, Orbit, Side};
use crate::model::Content;
use crate::motion::Motion;
use crate::sky::BuiltIn;
use crate::verb::fit::{self, FitArguments, Targets};
use crate::window::wgpu_setup;

/// Pixels of the window, `[row][column]`.
type Picture = Vec<[u8; 4]>;

const WIDTH: usize = 480;
const HEIGHT: usize = 320;

/// A box on a plane.
fn scene() -> prt_bake::BakedSurface {
    let mut source = MeshSource::default();
    let mut quad = |corner: [f64; 3], along: [f64; 3], up: [f64; 3], cells: usize| {
        let first = source.positions.len();
        for i in 0..=cells {
            for k in 0..=cells {
                let [s, t] = [i, k].map(|step| step as f64 / cells as f64);
                source.positions.push(std::array::from_fn(|axis| corner[axis] + s * along[axis] + t * up[axis]));
            }
        }
        for i in 0..cells {
            for k in 0..cells {
                let vertex = |i: usize, k: usize| (first + i * (cells + 1) + k) as u32;
                let [a, b, c, d] = [vertex(i, k), vertex(i + 1, k), vertex(i + 1, k + 1), vertex(i, k + 1)];
                source.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    };
    quad([-2.0, 0.0, 2.0], [4.0, 0.0, 0.0], [0.0, 0.0, -4.0], 8);
    quad([-0.5, 0.0, 0.5], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], 2);
    quad([0.5, 0.0, -0.5], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], 2);
    quad([0.5, 0.0, 0.5], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0], 2);
    quad([-0.5, 0.0, -0.5], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0], 2);
    quad([-0.5, 1.0, 0.5], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0], 2);
    let (mesh, _) = Mesh::new(source, &MeshOptions::default()).unwrap();
    let order = Order::new(5).unwrap();
    let options =
        BakeOptions { order, rays_per_vertex: 128, bounces: 1, keep_shadowed: true, ..BakeOptions::default() };
    bake_diffuse(&mesh, &options, &()).unwrap().0
}

/// The scene with lobes in place of its transfer vectors.
fn lobes() -> Model {
    let baked = scene();
    let neighbours = Neighbours::from_triangles(baked.geometry.vertex_count(), &baked.geometry.triangles).unwrap();
    let TransferVectors { order, channels, values } = &baked.transfer;
    let targets = Targets { order: *order, channels: *channels, values, neighbours: &neighbours };
    let arguments = FitArguments::lobes(4);
    let fitted = arguments.fit(&targets, &arguments.options(0, None)).unwrap();
    Model { content: Content::Lobes(fit::surface(baked, &fitted)), actor: None, membrane: None }
}

fn subject(folder: &Path, model: Model) -> Subject {
    let order = model.order();
    let orbit = Orbit::framing(&model.geometry().positions, Side::ThreeQuarter, Vec3::Y, DEFAULT_FOV, 1.0);
    Subject {
        path: folder.join("scene.prt"),
        lightings: [BuiltIn::Sky, BuiltIn::White].map(|built_in| Lighting::built_in(built_in, order)).into(),
        scene_from_environment: Quat::IDENTITY,
        orbit,
        exposure: 0.0,
        motion: Motion::default(),
        part: None,
        model: Arc::new(model),
    }
}

/// Whether an adapter is there that can run the passes.
fn has_adapter() -> bool {
    match Gpu::headless() {
        Ok(_) => true,
        Err(error) => {
            assert_ne!(std::env::var("PRT_REQUIRE_GPU").as_deref(), Ok("1"), "{error}");
            println!("skipped: {error}");
            false
        }
    }
}

/// The limits of the window, and the adapter that a test prefers: one without a GPU.
fn setup() -> WgpuSetup {
    let (WgpuSetup::CreateNew(ours), WgpuSetup::CreateNew(tests)) =
        (wgpu_setup(), egui_kittest::wgpu::default_wgpu_setup())
    else {
        unreachable!("both make a new device")
    };
    WgpuSetup::CreateNew(WgpuSetupCreateNew { device_descriptor: ours.device_descriptor, ..tests })
}

fn open(folder: &Path) -> Harness<'static, App> {
    open_model(folder, Model::from(scene()))
}

fn open_model(folder: &Path, model: Model) -> Harness<'static, App> {
    let subject = subject(folder, model);
    let harness = Harness::builder().with_size([WIDTH as f32, HEIGHT as f32]).wgpu_setup(setup()).with_max_steps(30);
    harness.build_eframe(move |context| {
        let state = context.wgpu_render_state.as_ref().unwrap();
        let mut app = App::new(state, subject, None, Failure::default()).unwrap();
        app.settings.shows_help = false;
        app
    })
}

fn picture(harness: &mut Harness<'_, App>) -> Picture {
    harness.run_steps(3);
    let image = harness.render().unwrap();
    assert_eq!((image.width() as usize, image.height() as usize), (WIDTH, HEIGHT));
    assert_eq!(harness.state().message, "", "nothing went wrong");
    image.pixels().map(|pixel| pixel.0).collect()
}

/// Mean difference of the left part, where the picture is, in steps of 8 bits.
fn difference(a: &Picture, b: &Picture) -> f64 {
    let is_picture = |(i, _): &(usize, _)| i % WIDTH < WIDTH / 3;
    let pairs = a.iter().zip(b).enumerate().filter(is_picture);
    let (sum, count) = pairs.fold((0.0, 0), |(sum, count), (_, (a, b))| {
        (sum + a.iter().zip(b).map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>(), count + 3)
    });
    sum / f64::from(count)
}

fn drag(harness: &mut Harness<'_, App>, button: PointerButton, modifiers: Modifiers, by: [f32; 2]) {
    let from = Pos2::new(80.0, 160.0);
    let press = |pos, pressed| Event::PointerButton { pos, button, pressed, modifiers };
    harness.event_modifiers(Event::PointerMoved(from), modifiers);
    harness.event_modifiers(press(from, true), modifiers);
    harness.run_steps(1);
    let to = from + by.into();
    harness.event_modifiers(Event::PointerMoved(to), modifiers);
    harness.run_steps(1);
    harness.event_modifiers(press(to, false), modifiers);
    harness.run_steps(1);
    harness.remove_cursor();
}

#[test]
fn the_picture_follows_mouse_keys_and_panel() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let harness = &mut open(folder.path());
    let start = picture(harness);
    let [top, bottom] = [start[0], start[(HEIGHT - 1) * WIDTH]];
    assert!(top[2] > top[0] + 10 && bottom[2] < top[2], "there is a blue sky and ground below: {top:?} {bottom:?}");
    assert!(difference(&start, &picture(harness)) < 0.01, "nothing changes by itself");

    drag(harness, PointerButton::Secondary, Modifiers::NONE, [70.0, 0.0]);
    assert!(harness.state().settings.scene_from_environment.angle_between(Quat::IDENTITY) > 0.3);
    let turned = picture(harness);
    assert!(difference(&start, &turned) > 1.0, "the light turned");
    drag(harness, PointerButton::Primary, Modifiers::CTRL, [-70.0, 0.0]);
    assert!(difference(&start, &picture(harness)) < 0.5, "and back");
    harness.key_press(Key::L);
    assert!(difference(&start, &picture(harness)) < 0.01, "exactly, with a key");

    let camera = harness.state().settings.orbit;
    drag(harness, PointerButton::Primary, Modifiers::NONE, [50.0, 20.0]);
    assert_ne!(harness.state().settings.orbit, camera);
    assert!(difference(&start, &picture(harness)) > 1.0, "the object turned");
    drag(harness, PointerButton::Primary, Modifiers::SHIFT, [30.0, 0.0]);
    assert_ne!(harness.state().settings.orbit.target, camera.target, "and moved");
    harness.key_press(Key::R);
    assert!(difference(&start, &picture(harness)) < 0.01, "the camera is as at first");

    for (key, what) in [
        (Key::Comma, "a band less"),
        (Key::Num1, "no shadows"),
        (Key::T, "a coefficient"),
        (Key::CloseBracket, "the next"),
    ] {
        let before = picture(harness);
        harness.key_press(key);
        assert!(difference(&before, &picture(harness)) > 0.1, "{what}");
    }
    assert_eq!(harness.state().settings.order, 4);
    assert_eq!(harness.state().settings.part, Part::Unshadowed);
    harness.key_press(Key::T);
    harness.key_press(Key::Num3);
    harness.key_press(Key::Period);
    assert!(difference(&start, &picture(harness)) < 0.01, "all as at first");

    harness.get_by_label("white").click();
    let white = picture(harness);
    assert!(difference(&start, &white) > 5.0, "another environment");
    harness.get_by_label("Shadowed").click();
    assert!(difference(&white, &picture(harness)) > 0.1, "no interreflections");
    harness.get_by_label("In the background").click();
    let black = picture(harness);
    assert_eq!(black[0][..3], [0; 3], "no background");
}

#[test]
fn lobes_follow_the_sliders_and_time() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let harness = &mut open_model(folder.path(), lobes());
    let rest = picture(harness);
    let vectors = picture(&mut open(folder.path()));
    assert!(difference(&rest, &vectors) < 1.0, "at rest lobes are the transfer that they were fitted to");

    harness.state_mut().settings.motion.twist = 90.0;
    let twisted = picture(harness);
    assert!(difference(&rest, &twisted) > 1.0, "the model is twisted");
    harness.key_press(Key::Num4);
    let traced = picture(harness);
    harness.key_press(Key::Num2);
    let undeformed = picture(harness);
    let [lobes, undeformed] = [&twisted, &undeformed].map(|picture| difference(picture, &traced));
    assert!(lobes < undeformed, "from the truth: lobes {lobes}, undeformed {undeformed}");

    harness.get_by_label("Lobes").click();
    assert!(difference(&twisted, &picture(harness)) < 0.01);
    harness.state_mut().settings.uses_table = true;
    assert!(difference(&twisted, &picture(harness)) < 0.5, "the table is near");

    harness.state_mut().settings.motion = Motion::default();
    assert!(difference(&rest, &picture(harness)) < 0.5);
    harness.state_mut().settings.motion.wave = 0.1;
    let wave = picture(harness);
    harness.key_press(Key::Space);
    harness.run_steps(5);
    assert!(harness.state().settings.plays);
    assert!(difference(&wave, &picture(harness)) > 0.1, "the wave travels");
}

#[test]
fn the_wheel_comes_nearer() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let harness = &mut open(folder.path());
    harness.run_steps(2);
    let distance = harness.state().settings.orbit.distance;
    harness.hover_at(Pos2::new(80.0, 160.0));
    let unit = egui::MouseWheelUnit::Line;
    let (phase, source) = (egui::TouchPhase::Move, egui::MouseWheelSource::Unknown);
    harness.event(Event::MouseWheel { unit, delta: vec2(0.0, 3.0), phase, source, modifiers: Modifiers::NONE });
    harness.run_steps(12);
    assert!(harness.state().settings.orbit.distance < 0.9 * distance);
}

#[test]
fn pictures_are_saved_beside_the_file() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let harness = &mut open(folder.path());
    harness.run_steps(2);
    for number in 1..3 {
        harness.key_press(Key::S);
        harness.run_steps(2);
        let path = folder.path().join(format!("scene-{number}.png"));
        assert_eq!(harness.state().message, format!("wrote {}", path.display()));
        let image = prt_bake::Image::load(&path).unwrap();
        assert_eq!(image.height, HEIGHT);
        assert!(image.pixels.iter().any(|pixel| pixel != &image.pixels[0]));
    }
}

#[test]
fn dropped_files_become_environments_or_a_message() {
    if !has_adapter() {
        return;
    }
    #[derive(Debug)]
    struct File(PathBuf);
    impl egui::DroppedFile for File {
        fn path(&self) -> &Path {
            &self.0
        }
        fn bytes(&self) -> Result<Vec<u8>, String> {
            std::fs::read(&self.0).map_err(|error| error.to_string())
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let harness = &mut open(folder.path());
    let good = folder.path().join("red.exr");
    prt_bake::Image { width: 8, height: 4, pixels: vec![[1.0, 0.0, 0.0]; 32] }.save(&good).unwrap();
    harness.input_mut().dropped_files.push(Arc::new(File(good)));
    harness.run_steps(2);
    assert_eq!(harness.state().settings.environment, 2);
    let red = picture(harness);
    assert!(red.iter().take(WIDTH / 3).all(|[r, g, b, _]| r > g && g == b), "the sky is red");
    harness.input_mut().dropped_files.push(Arc::new(File(folder.path().join("no.hdr"))));
    harness.run_steps(2);
    assert_eq!(harness.state().settings.environment, 2);
    assert!(harness.state().message.contains("no.hdr"), "{}", harness.state().message);
}
