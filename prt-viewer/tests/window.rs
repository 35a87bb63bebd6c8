//! `prt view` and the main job where there is no display, and in a virtual one.

#![expect(clippy::unwrap_used, clippy::print_stdout, reason = "tests")]

mod program;

use program::Place;

#[test]
fn without_a_display_there_is_a_plain_message() {
    let place = Place::new();
    place.bake_scene(&[]);
    place.refuses(&["view", "scene.prt"], 1, &["cannot open a window", "no display"]);
    place.refuses(&["view", "absent.prt"], 1, &["absent.prt"]);
    place.refuses(&["view", "scene.obj"], 1, &["prt bake"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_display_that_does_not_answer_is_told() {
    let place = Place::new();
    place.bake_scene(&[]);
    let mut command = place.command(&["view", "scene.prt"]);
    let run = program::Run::from(command.env("DISPLAY", ":4711").output().unwrap());
    assert_eq!(run.status, Some(1), "{}", run.stderr);
    assert!(
        run.stderr.starts_with("prt: error: cannot open a window") && !run.stderr.contains("panicked"),
        "{}",
        run.stderr
    );
    assert_eq!(run.stderr.lines().count(), 1, "{}", run.stderr);
}

#[test]
fn help_lists_mouse_and_keys() {
    let run = Place::new().run(&["view", "--help"]);
    assert_eq!(run.status, Some(0));
    for words in ["turn the light", "screenshot", "one band more", "Shift+drag", "close"] {
        assert!(run.stdout.contains(words), "{words} in {}", run.stdout);
    }
}

#[test]
fn every_verb_has_help() {
    let place = Place::new();
    assert!(place.run(&["--version"]).stdout.starts_with("prt "));
    for verb in ["bake", "render", "view", "compare", "info"] {
        assert!(place.run(&["--help"]).stdout.contains(verb));
        assert_eq!(place.run(&[verb, "--help"]).status, Some(0));
    }
}

#[test]
fn the_main_job_needs_no_gpu_and_no_display() {
    let place = Place::new();
    let run = place.run(&["--rays", "8"]);
    assert_eq!(run.status, Some(0), "{}", run.stderr);
    assert!(run.stderr.contains("shading on the CPU") && run.stderr.contains("no display"), "{}", run.stderr);
    assert!(run.stdout.contains("prt-demo.png") && run.stdout.contains("prt-demo.prt"), "{}", run.stdout);
    assert_eq!(place.files(), ["prt-demo.png", "prt-demo.prt"]);
    let image = program::pixels(&place.path("prt-demo.png"));
    assert_eq!((image.width, image.height), (1280, 800));
    // The knot in the middle is red, the sky above it blue.
    let [knot, sky] = [image.pixels[400 * 1280 + 730], image.pixels[10 * 1280 + 640]];
    assert!(knot[0] > 1.5 * knot[2] && sky[2] > sky[0], "{knot:?} {sky:?}");
    let report = place.json(&["--rays", "8", "--no-window"]);
    assert_eq!((&report["backend"], &report["bounces"]), (&"cpu".into(), &2.into()));
    assert!(program::number(&report, "/seconds/total") > 0.0);
}

/// An X server without a screen, for as long as it lives.
#[cfg(target_os = "linux")]
struct Display {
    server: std::process::Child,
    name: String,
}

#[cfg(target_os = "linux")]
impl Display {
    /// `None` where `Xvfb` is not installed.
    fn open() -> Option<Self> {
        use std::io::{BufRead, BufReader};
        use std::process::{Command, Stdio};
        let arguments = ["-displayfd", "1", "-screen", "0", "800x600x24", "-nolisten", "tcp"];
        let mut command = Command::new("Xvfb");
        let mut server = command.args(arguments).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().ok()?;
        let mut number = String::new();
        BufReader::new(server.stdout.take()?).read_line(&mut number).ok()?;
        Some(Self { server, name: format!(":{}", number.trim()) })
    }
}

#[cfg(target_os = "linux")]
impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

#[cfg(target_os = "linux")]
#[test]
fn the_window_opens_draws_and_closes() {
    let Some(display) = Display::open() else {
        println!("skipped: Xvfb is not installed");
        return;
    };
    let place = Place::new();
    place.bake_scene(&["--bounces", "1"]);
    let arguments =
        ["view", "scene.prt", "--env", "white", "--size", "640x480", "--screenshot", "shot.png", "--frames", "3"];
    // With the drivers of this machine.
    let mut command = place.command(&arguments);
    for variable in ["VK_ICD_FILENAMES", "VK_DRIVER_FILES", "__EGL_VENDOR_LIBRARY_DIRS"] {
        command.env_remove(variable);
    }
    let run = program::Run::from(command.env("DISPLAY", &display.name).output().unwrap());
    if run.status != Some(0) {
        assert_ne!(std::env::var("PRT_REQUIRE_GPU").as_deref(), Ok("1"), "{}", run.stderr);
        println!("skipped: {}", run.stderr);
        return;
    }
    let image = program::pixels(&place.path("shot.png"));
    assert_eq!((image.width, image.height), (640, 480));
    let [sky, panel] = [image.pixels[470 * 640 + 5], image.pixels[470 * 640 + 630]];
    assert!(sky[0] > 0.7, "the white environment is behind the object: {sky:?}");
    assert!(panel[0] < 0.1, "the panel is dark: {panel:?}");

    let driverless = place.command(&arguments).env("DISPLAY", &display.name).output().unwrap();
    let run = program::Run::from(driverless);
    assert_eq!(run.status, Some(1), "{}", run.stderr);
    assert!(run.stderr.contains("cannot open a window: no usable GPU adapter"), "{}", run.stderr);
    assert!(!run.stderr.contains("panicked"), "{}", run.stderr);
}
