//! `prt render` and `prt compare`.

#![expect(clippy::unwrap_used, clippy::print_stdout, reason = "tests")]

mod program;

use program::{Place, number, pixels};
use prt_bake::Image;

/// A latitude-longitude map that is dark but for a lobe towards a direction.
fn write_lamp(place: &Place, name: &str, towards: [f64; 3]) {
    let map = sh_core::LatLong { width: 32, height: 16 };
    let texel = |i: usize| {
        let direction = map.direction((i % 32) as f64 + 0.5, (i / 32) as f64 + 0.5);
        let cosine: f64 = direction.iter().zip(towards).map(|(a, b)| a * b).sum();
        [(3.0 * (4.0 * (cosine - 1.0)).exp()) as f32; 3]
    };
    let image = Image { width: 32, height: 16, pixels: (0..32 * 16).map(texel).collect() };
    image.save(&place.path(name)).unwrap();
}

fn mean(image: &Image, columns: std::ops::Range<usize>, rows: std::ops::Range<usize>) -> f64 {
    let texels = rows.flat_map(|row| columns.clone().map(move |column| row * image.width + column));
    let values: Vec<f64> = texels.map(|i| f64::from(image.pixels[i][1])).collect();
    values.iter().sum::<f64>() / values.len() as f64
}

/// Looks down the −z axis at the sphere; the plane is seen from above.
const FRONT: [&str; 8] = ["--eye", "0,1.6,5", "--target", "0,0.7,0", "--fov", "40", "--size", "64x64"];

#[test]
fn the_report_has_what_scripts_rely_on_and_the_picture_is_there() {
    let place = Place::new();
    place.bake_scene(&[]);
    let report = place.json(&["render", "scene.prt", "--size", "48x32", "--backend", "cpu", "-o", "a.png"]);
    assert_eq!(report["backend"], "cpu");
    assert!(report["adapter"].is_null());
    assert!(number(&report, "/seconds") > 0.0);
    assert_eq!((number(&report, "/width"), number(&report, "/height")), (48.0, 32.0));
    let image = pixels(&place.path("a.png"));
    assert_eq!((image.width, image.height), (48, 32));
    assert!(mean(&image, 16..32, 8..24) > 0.05, "the object is in the middle");
    assert_eq!(image.pixels[0], [0.0; 3], "the background is black");
}

#[test]
fn light_from_the_left_brightens_the_left_and_from_the_right_the_right() {
    let place = Place::new();
    place.bake_scene(&[]);
    write_lamp(&place, "left.exr", [-1.0, 0.0, 0.0]);
    let picture = |more: &[&str]| {
        let arguments =
            [&["render", "scene.prt", "--env", "left.exr", "-o", "a.exr"] as &[&str], &FRONT, more].concat();
        place.json(&arguments);
        pixels(&place.path("a.exr"))
    };
    let halves = |image: &Image| (mean(image, 22..31, 18..34), mean(image, 33..42, 18..34));
    let (left, right) = halves(&picture(&[]));
    assert!(left > 3.0 * right.max(0.01), "{left} {right}");
    let (left, right) = halves(&picture(&["--rotate-light", "180"]));
    assert!(right > 3.0 * left.max(0.01), "{left} {right}");
    // A quarter turn counter-clockwise seen from above takes −x to +z, behind the camera.
    let (left, right) = halves(&picture(&["--rotate-light", "90"]));
    assert!((left - right).abs() < 0.1 * left && left > 0.1, "{left} {right}");
}

#[test]
fn shadows_fall_away_from_the_light() {
    let place = Place::new();
    place.bake_scene(&[]);
    // High on the left: the shadow of the sphere lies right of it.
    write_lamp(&place, "lamp.exr", [-0.6, 0.8, 0.0]);
    let arguments = ["render", "scene.prt", "--env", "lamp.exr", "--camera", "top", "--size", "64x64"];
    place.json(&[&arguments as &[&str], &["-o", "full.exr"]].concat());
    place.json(&[&arguments as &[&str], &["-o", "open.exr", "--part", "unshadowed"]].concat());
    let (full, open) = (pixels(&place.path("full.exr")), pixels(&place.path("open.exr")));
    // The plane fills the picture; x = 0.75 is 24 pixels from the middle over 2, seen from far above.
    let shade = |columns: std::ops::Range<usize>| mean(&full, columns.clone(), 28..36) / mean(&open, columns, 28..36);
    let (left, right) = (shade(12..18), shade(44..50));
    assert!(right < 0.85 && left > 0.93, "left of the sphere {left}, right of it {right}");
}

#[test]
fn the_environment_behind_the_object_is_seen_where_it_is() {
    let place = Place::new();
    place.bake_scene(&[]);
    // Behind the object to the left, seen from +z.
    write_lamp(&place, "lamp.exr", [-0.6, 0.0, -0.8]);
    let picture = |more: &[&str]| {
        let camera = ["--eye", "0,9,2", "--target", "0,9,0", "--fov", "90", "--size", "64x64", "--show-env"];
        place.json(&[&["render", "scene.prt", "--env", "lamp.exr", "-o", "a.exr"] as &[&str], &camera, more].concat());
        pixels(&place.path("a.exr"))
    };
    let brightest = |image: &Image| {
        let at = (0..64 * 64).max_by(|&a, &b| image.pixels[a][0].total_cmp(&image.pixels[b][0])).unwrap();
        (at % 64, at / 64)
    };
    // tan of the angle is 0.75 of the half width.
    let (x, y) = brightest(&picture(&[]));
    assert!(x.abs_diff(8) <= 3 && y.abs_diff(32) <= 3, "{x} {y}");
    let (x, _) = brightest(&picture(&["--rotate-light=-73.74"]));
    assert!(x.abs_diff(56) <= 3, "{x}");
}

#[test]
fn exr_is_radiance_and_png_is_tone_mapped() {
    let place = Place::new();
    place.bake_scene(&[]);
    let arguments = ["render", "scene.prt", "--env", "white", "--size", "32x32", "--samples", "1"];
    place.json(&[&arguments as &[&str], &["-o", "a.exr", "--exposure", "-9"]].concat());
    place.json(&[&arguments as &[&str], &["-o", "a.png", "--exposure=-1"]].concat());
    let (radiance, picture) = (pixels(&place.path("a.exr")), pixels(&place.path("a.png")));
    let (radiance, shown) = (mean(&radiance, 12..20, 12..20), mean(&picture, 12..20, 12..20));
    // Albedo 0.8 under radiance 1, a little of it hidden by the plane.
    assert!((0.4..0.8).contains(&radiance), "{radiance}: exposure does not touch radiance");
    assert!((shown - 0.5 * radiance).abs() < 0.01, "half of {radiance} is {shown}");
}

#[test]
fn fewer_bands_and_other_parts_are_other_pictures() {
    let place = Place::new();
    place.bake_scene(&["--bounces", "1", "--keep-shadowed"]);
    let render = |name: &str, more: &[&str]| {
        place.json(&[&["render", "scene.prt", "--size", "32x32", "-o", name] as &[&str], more].concat());
    };
    render("full.exr", &[]);
    render("order.exr", &["--order", "2"]);
    render("shadowed.exr", &["--part", "shadowed"]);
    render("unshadowed.exr", &["--part", "unshadowed"]);
    let difference = |a, b| number(&place.json(&["compare", a, b]), "/mse");
    assert!(difference("full.exr", "order.exr") > 1e-6);
    assert!(difference("full.exr", "shadowed.exr") > 1e-6);
    assert!(difference("shadowed.exr", "unshadowed.exr") > 1e-5);
    assert_eq!(difference("full.exr", "full.exr"), 0.0);
}

#[test]
fn without_a_driver_the_cpu_draws_and_says_so() {
    let place = Place::new();
    place.bake_scene(&[]);
    let run = place.run(&["render", "scene.prt", "--size", "16x16", "-o", "a.png", "--json"]);
    assert_eq!(run.status, Some(0), "{}", run.stderr);
    assert!(run.stderr.contains("CPU"), "{}", run.stderr);
    assert!(run.stdout.contains("\"backend\":\"cpu\""), "{}", run.stdout);
    place.refuses(&["render", "scene.prt", "--backend", "gpu", "-o", "b.png"], 1, &["no usable GPU adapter"]);
}

#[test]
fn the_gpu_draws_what_the_cpu_draws() {
    let place = Place::new();
    place.bake_scene(&[]);
    let arguments = ["render", "scene.prt", "--env", "studio", "--size", "64x48", "--json", "-o"];
    // With the drivers of this machine.
    let mut command = place.command(&[&arguments as &[&str], &["gpu.exr", "--backend", "gpu"]].concat());
    for variable in ["VK_ICD_FILENAMES", "VK_DRIVER_FILES", "__EGL_VENDOR_LIBRARY_DIRS"] {
        command.env_remove(variable);
    }
    let run = program::Run::from(command.output().unwrap());
    if run.status != Some(0) {
        assert_ne!(std::env::var("PRT_REQUIRE_GPU").as_deref(), Ok("1"), "{}", run.stderr);
        println!("skipped: {}", run.stderr);
        return;
    }
    assert!(run.stdout.contains("\"backend\":\"gpu\"") && !run.stdout.contains("\"adapter\":null"), "{}", run.stdout);
    place.run(&[&arguments as &[&str], &["cpu.exr", "--backend", "cpu"]].concat());
    let report = place.json(&["compare", "gpu.exr", "cpu.exr"]);
    let (largest, mean) = (number(&report, "/max_abs"), number(&report, "/mean/1"));
    assert!(largest <= 1e-4 * mean, "{largest} of {mean}");
}

#[test]
fn compare_writes_the_difference() {
    let place = Place::new();
    let image = |value: f32| Image { width: 4, height: 2, pixels: vec![[value, 0.5, 0.25]; 8] };
    image(0.5).save(&place.path("a.exr")).unwrap();
    image(0.75).save(&place.path("b.exr")).unwrap();
    let report = place.json(&["compare", "a.exr", "b.exr", "-o", "diff.exr"]);
    assert!((number(&report, "/mse") - 0.0625 / 3.0).abs() < 1e-9);
    assert!((number(&report, "/relmse") - 0.0625 / 0.5725 / 3.0).abs() < 1e-9);
    assert_eq!(number(&report, "/max_abs"), 0.25);
    assert!((number(&report, "/psnr") - 10.0 * (0.5625 * 3.0 / 0.0625_f64).log10()).abs() < 1e-6);
    assert_eq!(pixels(&place.path("diff.exr")).pixels[0], [0.25, 0.0, 0.0]);
    place.json(&["compare", "a.exr", "b.exr", "-o", "diff.png"]);
    assert_eq!(pixels(&place.path("diff.png")).pixels[0], [1.0, 0.0, 0.0], "scaled to the largest");
    assert!(place.json(&["compare", "a.exr", "a.exr"])["psnr"].is_null());
}

#[test]
fn bad_input_is_one_clear_error() {
    let place = Place::new();
    place.bake_scene(&[]);
    let png = Image { width: 3, height: 2, pixels: vec![[0.5; 3]; 6] };
    png.save(&place.path("a.png")).unwrap();
    Image { width: 2, height: 3, ..png }.save(&place.path("b.png")).unwrap();
    place.refuses(&["compare", "a.png", "b.png"], 1, &["a.png", "b.png", "3 x 2 and 2 x 3"]);
    place.refuses(&["compare", "a.png", "absent.png"], 1, &["absent.png"]);
    place.refuses(&["render", "scene.obj", "-o", "c.png"], 1, &["scene.obj", "prt bake"]);
    place.refuses(&["render", "absent.prt", "-o", "c.png"], 1, &["absent.prt"]);
    place.refuses(&["render", "scene.prt", "--env", "absent.hdr", "-o", "c.png"], 1, &["absent.hdr"]);
    place.refuses(&["render", "scene.prt", "--order", "5", "-o", "c.png"], 1, &["scene.prt", "order 5", "order 4"]);
    place.refuses(&["render", "scene.prt", "-o", "no/c.png"], 1, &["cannot write no/c.png"]);
    place.refuses(&["render", "scene.prt", "--eye", "1,1,1", "--target", "1,1,1", "-o", "c.png"], 1, &["--eye"]);
    place.refuses(&["render", "scene.prt", "--eye", "0,9,0", "--target", "0,0,0", "-o", "c.png"], 1, &["--up"]);
    place.bake_scene(&["--unshadowed"]);
    place.refuses(&["render", "scene.prt", "--part", "shadowed", "-o", "c.png"], 1, &["scene.prt", "without shadows"]);
}

#[test]
fn wrong_usage_has_status_2() {
    let place = Place::new();
    place.bake_scene(&[]);
    for wrong in [
        &["-o", "a.jpg"] as &[&str],
        &["-o", "a.png", "--size", "0x10"],
        &["-o", "a.png", "--size", "10"],
        &["-o", "a.png", "--size", "10x99999999"],
        &["-o", "a.png", "--order", "0"],
        &["-o", "a.png", "--order", "100"],
        &["-o", "a.png", "--fov", "0"],
        &["-o", "a.png", "--eye", "1,2"],
        &["-o", "a.png", "--up", "0,0,0"],
        &["-o", "a.png", "--backend", "tpu"],
        &["-o", "a.png", "--samples", "5"],
        &[],
    ] {
        place.refuses(&[&["render", "scene.prt"], wrong].concat(), 2, &[]);
    }
}
