//! `prt fit`, textures from height fields, and what they look like when they are deformed.

#![expect(clippy::unwrap_used, clippy::print_stdout, reason = "tests")]

mod program;

use std::path::Path;

use program::{Place, number, pixels};

/// `|a − b| / |b|` of two pictures, L2.
fn distance(a: &Path, b: &Path) -> f64 {
    let (a, b) = (pixels(a).pixels, pixels(b).pixels);
    let squares = |f: fn(f32, f32) -> f32| -> f64 {
        a.as_flattened().iter().zip(b.as_flattened()).map(|(&a, &b)| f64::from(f(a, b))).sum()
    };
    (squares(|a, b| (a - b).powi(2)) / squares(|_, b| b * b)).sqrt()
}

/// Renders to `NAME.exr`.
fn render(place: &Place, name: &str, arguments: &[&str]) -> std::path::PathBuf {
    let output = format!("{name}.exr");
    let picture = ["-o", &output, "--size", "96x96", "--backend", "cpu"];
    place.json(&[&["render"], arguments, &picture].concat());
    place.path(&output)
}

#[test]
fn the_report_of_a_fit_has_what_scripts_rely_on() {
    let place = Place::new();
    place.bake_scene(&[]);
    let report = place.json(&["fit", "scene.prt", "--lobes", "3", "-o", "lobes.prt"]);
    assert_eq!((number(&report, "/lobes"), number(&report, "/vertices")), (3.0, 189.0));
    assert!((1e-4..0.1).contains(&number(&report, "/relative_error")), "{report}");
    assert!(number(&report, "/seconds") > 0.0);
    let bands: f64 = (0..4).map(|l| number(&report, &format!("/error_per_band/{l}")).powi(2)).sum();
    assert!((bands.sqrt() / number(&report, "/relative_error") - 1.0).abs() < 1e-3, "the bands make up the error");
    assert_eq!(number(&report, "/error_per_band/0"), 0.0, "band 0 is explicit");

    let info = place.json(&["info", "lobes.prt"]);
    assert_eq!(info["metadata"]["kind"], "zonal");
    let tensors = info["tensors"].to_string();
    for (name, shape) in [("explicit", "[189,4]"), ("lobe_axis", "[189,3,3]"), ("lobe_coeff", "[189,3,4]")] {
        assert!(tensors.contains(name) && tensors.contains(shape), "{name} {shape}: {tensors}");
    }
}

#[test]
fn more_lobes_are_nearer_and_a_target_takes_no_more_than_it_needs() {
    let place = Place::new();
    place.bake_scene(&[]);
    let error = |lobes: &str| number(&place.json(&["fit", "scene.prt", "--lobes", lobes]), "/relative_error");
    let errors = ["1", "2", "3", "4"].map(error);
    assert!(errors.is_sorted_by(|a, b| a > b), "{errors:?}");
    let target = 0.5 * (errors[1] + errors[2]);
    let report = place.json(&["fit", "scene.prt", "--lobes", "6", "--target-error", &target.to_string()]);
    assert!(number(&report, "/relative_error") <= target, "{report}");
    assert_eq!(number(&report, "/lobes"), 3.0);
}

#[test]
fn the_same_seed_is_the_same_file_for_any_number_of_threads() {
    let place = Place::new();
    place.bake_scene(&[]);
    let bytes = |threads: &str| {
        place.json(&["fit", "scene.prt", "-o", "lobes.prt", "--smooth", "0.001", "--threads", threads]);
        std::fs::read(place.path("lobes.prt")).unwrap()
    };
    assert!(bytes("1") == bytes("3"));
}

#[test]
fn coloured_interreflection_is_fitted_in_three_channels() {
    let place = Place::new();
    place.bake_scene(&["--bounces", "2", "--albedo", "0.9,0.5,0.1"]);
    let report = place.json(&["fit", "scene.prt", "-o", "lobes.prt"]);
    assert_eq!(number(&report, "/channels"), 3.0);
    assert!(number(&report, "/relative_error") < 0.05, "{report}");
    let [lobes, vectors] = ["lobes", "scene"].map(|name| render(&place, name, &[&format!("{name}.prt")]));
    assert!(distance(&lobes, &vectors) < 0.05);
}

#[test]
fn lobes_follow_a_deformation_and_are_nearer_to_ray_tracing_than_those_that_do_not() {
    let place = Place::new();
    place.bake_scene(&[]);
    place.json(&["fit", "scene.prt", "-o", "lobes.prt"]);
    let part = |part: &str| {
        render(&place, part, &["lobes.prt", "--part", part, "--twist", "90", "--bend", "40", "--rays", "512"])
    };
    let traced = part("traced");
    let [lobes, undeformed] = ["full", "undeformed"].map(|name| distance(&part(name), &traced));
    println!("from the truth: lobes {lobes:.3}, undeformed {undeformed:.3}");
    assert!(lobes < 0.5 * undeformed, "{lobes} {undeformed}");

    let rest = render(&place, "rest", &["lobes.prt"]);
    let vectors = render(&place, "vectors", &["scene.prt"]);
    assert!(distance(&rest, &vectors) < 0.03, "at rest lobes are the transfer that they were fitted to");
}

/// What was baked without shadows is traced without them.
#[test]
fn unshadowed_lobes_are_their_own_truth() {
    let place = Place::new();
    place.bake_scene(&["--unshadowed"]);
    place.json(&["fit", "scene.prt", "-o", "lobes.prt", "--lobes", "1"]);
    let [lobes, traced] =
        ["full", "traced"].map(|part| render(&place, part, &["lobes.prt", "--twist", "90", "--part", part]));
    assert!(distance(&lobes, &traced) < 1e-3, "{}", distance(&lobes, &traced));
}

#[test]
fn the_table_of_the_light_costs_little_accuracy() {
    let place = Place::new();
    place.bake_scene(&[]);
    place.json(&["fit", "scene.prt", "-o", "lobes.prt"]);
    let with = |table: &str| render(&place, table, &["lobes.prt", "--table", table, "--env", "sunset"]);
    let direct = with("direct");
    let [coarse, paper, fine] = ["16x8", "64x32", "256x128"].map(|table| distance(&with(table), &direct));
    assert!(coarse > 4.0 * paper && paper > 4.0 * fine && paper < 5e-3, "{coarse} {paper} {fine}");
    place.refuses(&["render", "lobes.prt", "-o", "x.png", "--table", "3x2"], 2, &["table", "even width"]);
}

#[test]
fn a_pattern_becomes_a_texture_of_lobes() {
    let place = Place::new();
    let report =
        place.json(&["bake", "bumps", "--texels", "24x24", "--rays", "128", "-o", "bumps.prt", "--order", "5"]);
    assert_eq!((number(&report, "/texels"), number(&report, "/lobes")), (576.0, 4.0));
    assert!((1e-4..0.05).contains(&number(&report, "/relative_error")), "{report}");
    assert_eq!(place.json(&["info", "bumps.prt"])["metadata"]["kind"], "texture-zonal");
    place.json(&["bake", "bumps", "--texels", "24x24", "--rays", "128", "-o", "bumps.exr"]);
    let header = std::fs::read(place.path("bumps.exr")).unwrap();
    assert!(header.windows(11).any(|window| window == b"lobe0.axis."), "an image with named channels");

    let part = |part: &str| render(&place, part, &["bumps.prt", "--on", "cylinder", "--bend", "40", "--part", part]);
    let [lobes, unshadowed, undeformed] = ["full", "unshadowed", "undeformed"].map(part);
    assert!(distance(&lobes, &unshadowed) > 0.02 && distance(&lobes, &undeformed) > 0.02);
}

#[test]
fn an_image_is_a_height_field() {
    let place = Place::new();
    let pixels: Vec<[f32; 3]> = (0..256).map(|i| [if i % 16 < 8 { 0.0 } else { 1.0 }; 3]).collect();
    prt_bake::Image { width: 16, height: 16, pixels }.save(&place.path("steps.png")).unwrap();
    let bake = ["bake", "steps.png", "--height", "0.3", "--texels", "16x16", "--rays", "64", "--bounces", "1"];
    let report = place.json(&bake);
    assert!(number(&report, "/occluded_share") > 0.02, "the steps hide the sky from one another: {report}");
    assert!(number(&report, "/bounce_energy/0") > 0.001);
    assert_eq!(place.files(), ["steps.png", "steps.prt"], "the default name is that of the image");

    // Wide images stay wide, and large ones are made smaller.
    for (size, texels) in [([32, 8], [32.0, 8.0]), ([160, 40], [64.0, 16.0])] {
        let [width, height] = size;
        let pixels = vec![[0.5; 3]; width * height];
        prt_bake::Image { width, height, pixels }.save(&place.path("wide.png")).unwrap();
        let report = place.json(&["bake", "wide.png", "--rays", "16", "--order", "2"]);
        assert_eq!([number(&report, "/width"), number(&report, "/height")], texels);
    }
}

/// A ridge along the upper edge of an image is at the upper edge of what it is laid over, whichever way its texture coordinates run.
#[test]
fn an_image_stands_upright() {
    let place = Place::new();
    let pixels: Vec<[f32; 3]> = (0..256).map(|i| [if (32..64).contains(&i) { 1.0 } else { 0.0 }; 3]).collect();
    prt_bake::Image { width: 16, height: 16, pixels }.save(&place.path("ridge.png")).unwrap();
    place.json(&["bake", "ridge.png", "--height", "0.1", "--texels", "16x16", "--rays", "64"]);
    // In OBJ v runs up.
    place.write(
        "square.obj",
        "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n",
    );
    for on in ["patch", "square.obj"] {
        let camera = ["--on", on, "--tiles", "1", "--camera", "front"];
        let picture = pixels_of(&render(&place, "ridge", &[&["ridge.prt"], camera.as_slice()].concat()));
        // Differences between neighbouring rows, in the middle column.
        let change = |from: usize, to: usize| -> f32 {
            (from..to).map(|row| (picture[row * 96 + 48][1] - picture[(row + 1) * 96 + 48][1]).abs()).sum()
        };
        let (upper, lower) = (change(10, 46), change(50, 86));
        assert!(upper > 10.0 * lower, "{on}: {upper} {lower}");
    }
}

fn pixels_of(path: &Path) -> Vec<[f32; 3]> {
    pixels(path).pixels
}

#[test]
fn translucent_and_glossy_patches() {
    let place = Place::new();
    let bake = |name: &str, more: &[&str]| {
        place.json(&[&["bake", "waffle", "--texels", "8x8", "--rays", "64", "--order", "4", "-o", name], more].concat())
    };
    let report = bake("wax.prt", &["--sigma-s", "40", "--sigma-a", "0", "--thickness", "0.05"]);
    let both = number(&report, "/reflectance/0") + number(&report, "/transmittance/0");
    assert!((both - 1.0).abs() < 0.02, "no light is lost without absorption: {both}");
    let report = bake("gloss.prt", &["--brdf", "ggx:0.4", "--rows", "3"]);
    assert_eq!(number(&report, "/rows"), 3.0);
    let three = number(&report, "/factor_error");
    let report = bake("gloss.prt", &["--brdf", "ggx:0.4"]);
    assert!(number(&report, "/factor_error") <= 0.2 && three > 0.2, "as many rows as it takes: {report}");
    let from = |name: &str, eye: &str| render(&place, name, &["gloss.prt", "--on", "patch", "--eye", eye]);
    let [left, right] = [("left", "-3,0,4"), ("right", "3,0,4")].map(|(name, eye)| from(name, eye));
    assert!(distance(&left, &right) > 0.05, "gloss depends on the view");
    for name in ["wax.prt", "gloss.prt"] {
        let traced = ["render", name, "--on", "patch", "--part", "traced", "-o", "x.png"];
        place.refuses(&traced, 1, &[name, "traced transfer of", "is not known"]);
    }
}

#[test]
fn what_cannot_be_done_is_said() {
    let place = Place::new();
    place.bake_scene(&[]);
    place.json(&["fit", "scene.prt", "-o", "lobes.prt"]);
    place.refuses(&["fit", "lobes.prt", "-o", "x.prt"], 1, &["lobes.prt", "kind zonal", "vertex-transfer is needed"]);
    place.refuses(&["fit", "scene.prt", "-o", "scene.prt"], 1, &["scene.prt"]);
    place.refuses(&["fit", "absent.prt"], 1, &["absent.prt"]);
    place.refuses(&["fit", "scene.prt", "--lobes", "0"], 2, &["--lobes"]);
    place.refuses(&["fit", "scene.prt", "--target-error", "-1"], 2, &["--target-error"]);
    place.refuses(&["fit", "scene.prt", "--per-vertex"], 2, &["--target-error"]);
    let deformed = ["render", "scene.prt", "--bend", "30", "-o", "x.png"];
    place.refuses(&deformed, 1, &["scene.prt", "follow no deformation", "prt fit"]);
    place.refuses(&["render", "lobes.prt", "--part", "shadowed", "-o", "x.png"], 1, &["lobes.prt"]);
    let character = ["render", "lobes.prt", "--character", "absent.glb", "-o", "x.png"];
    place.refuses(&character, 1, &["absent.glb"]);
    place.refuses(&["bake", "weave", "--sigma-s", "3", "--bounces", "2"], 2, &["--sigma-s"]);
    place.refuses(&["bake", "weave", "--brdf", "mirror"], 2, &["ggx"]);
    place.refuses(&["bake", "scene.obj", "--height", "0.3"], 2, &["height fields"]);
    place.refuses(&["bake", "weave", "--texels", "8x16"], 1, &["weave", "square"]);
    place.refuses(&["bake", "absent.png"], 1, &["absent.png"]);
    place.json(&["bake", "weave", "--texels", "8x8", "--rays", "16"]);
    place.refuses(
        &["render", "weave.prt", "--on", "scene.obj", "-o", "x.png"],
        1,
        &["scene.obj", "texture coordinates"],
    );
    place.refuses(&["fit", "weave.prt"], 1, &["kind texture-zonal"]);
}

#[test]
fn a_skinned_character_moves_with_its_lobes() {
    let Some(fox) = prt_tests::data_path("a skinned character", "characters/fox.glb") else { return };
    let place = Place::new();
    place.json(&["bake", fox.to_str().unwrap(), "-o", "fox.prt", "--rays", "64", "--order", "4"]);
    place.json(&["fit", "fox.prt", "-o", "lobes.prt"]);
    let at = |time: &str| {
        let clip = ["--character", fox.to_str().unwrap(), "--clip", "Run", "--time", time, "--eye", "200,100,200"];
        render(&place, "fox", &[&["lobes.prt"], clip.as_slice()].concat())
    };
    let coverage = |path: &Path| pixels(path).pixels.iter().filter(|pixel| pixel[1] > 0.0).count();
    let first = at("0");
    assert!(coverage(&first) > 200);
    let first = pixels(&first);
    assert_ne!(pixels(&at("0.5")), first, "the fox runs");
    let no_clip = ["render", "lobes.prt", "--character", fox.to_str().unwrap(), "--clip", "Fly", "-o", "x.png"];
    place.refuses(&no_clip, 1, &["no clip Fly", "Survey, Walk, Run"]);
}
