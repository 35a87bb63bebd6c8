//! `prt bake` and `prt info`.

#![expect(clippy::unwrap_used, clippy::print_stdout, reason = "tests")]

mod program;

use program::{Place, number};

#[test]
fn the_report_has_what_scripts_rely_on() {
    let place = Place::new();
    let report = place.bake_scene(&["--bounces", "1", "--seed", "3", "--threads", "1"]);
    // 9 rows of 12 corners and 9 by 9; the two poles' rows are of coincident corners, whose faces have no area.
    let (vertices, triangles) = (number(&report, "/vertices"), number(&report, "/triangles"));
    assert_eq!((vertices, triangles), (189.0, 2.0 * (7.0 * 12.0 + 64.0)));
    assert_eq!(number(&report, "/faces_dropped"), 24.0);
    assert_eq!(number(&report, "/order"), 4.0);
    assert_eq!(number(&report, "/rays_per_vertex"), 128.0);
    assert_eq!(number(&report, "/bounces"), 1.0);
    // Half of the shared directions are above a vertex; hits are traced again for the bounce.
    let rays = number(&report, "/rays_traced");
    assert!(rays > 110.0 * vertices && rays < 300.0 * vertices, "{rays}");
    for seconds in ["load", "build", "trace", "total"] {
        assert!(number(&report, &format!("/seconds/{seconds}")) >= 0.0);
    }
    assert!(number(&report, "/seconds/total") >= number(&report, "/seconds/trace"));
    assert!(number(&report, "/mrays_per_second") > 0.0);
    if cfg!(target_os = "linux") {
        assert!(number(&report, "/peak_memory_bytes") > 1e6);
    }
    assert_eq!(number(&report, "/output_bytes"), std::fs::metadata(place.path("scene.prt")).unwrap().len() as f64);
    assert!((0.0..0.2).contains(&number(&report, "/error")));
    assert!((0.01..0.5).contains(&number(&report, "/occluded_share")));
    let bounce = number(&report, "/bounce_energy/0");
    assert!((0.001..0.5).contains(&bounce), "{bounce}");
    assert_eq!(place.files(), ["scene.obj", "scene.prt"]);
}

#[test]
fn the_summary_is_for_people() {
    let place = Place::new();
    place.write_scene();
    let run = place.run(&["bake", "scene.obj", "--rays", "16"]);
    assert_eq!(run.status, Some(0), "{}", run.stderr);
    assert!(run.stdout.contains("189 vertices") && run.stdout.contains("wrote scene.prt"), "{}", run.stdout);
    assert_eq!(place.files(), ["scene.obj", "scene.prt"], "the default name is that of the mesh");
}

#[test]
fn the_same_seed_is_the_same_file_for_any_number_of_threads() {
    let place = Place::new();
    let bytes = |more: &[&str]| {
        place.bake_scene(more);
        std::fs::read(place.path("scene.prt")).unwrap()
    };
    let one = bytes(&["--bounces", "2", "--threads", "1"]);
    assert!(one == bytes(&["--bounces", "2", "--threads", "3"]));
    assert!(one != bytes(&["--bounces", "2", "--seed", "1"]));
}

#[test]
fn unshadowed_transfer_traces_nothing() {
    let place = Place::new();
    let report = place.bake_scene(&["--unshadowed", "--bounces", "0"]);
    assert_eq!((number(&report, "/rays_traced"), number(&report, "/rays_per_vertex")), (0.0, 0.0));
    assert_eq!(number(&report, "/mrays_per_second"), 0.0);
    assert!(report["error"].is_null());
}

#[test]
fn texels_of_a_mesh_are_an_image_with_named_channels() {
    let place = Place::new();
    place.write_roof();
    let report = place.json(&["bake", "roof.obj", "--texels", "32", "--rays", "256", "--order", "3"]);
    assert_eq!((number(&report, "/width"), number(&report, "/height")), (32.0, 32.0));
    assert_eq!((number(&report, "/texels_inside"), number(&report, "/texels_overlapping")), (1024.0, 0.0));
    let atlas = prt_bake::TexelTransfer::read_exr(&place.path("roof.exr")).unwrap();
    assert!(atlas.v_up && atlas.metadata.source.is_some());
    let info = place.json(&["info", "roof.exr"]);
    assert_eq!(info["metadata"]["kind"], "texture-transfer");
    assert_eq!(info["tensors"][1]["name"], "transfer.0");
    let dc = |row: usize, column: usize| atlas.transfer.vector(32 * row + column, 0)[0];
    // Below the roof it is dark, beside it light; the roof itself sees the whole sky.
    assert!(dc(16, 8) < 0.5 * dc(1, 1), "{} {}", dc(16, 8), dc(1, 1));
    assert!((dc(16, 24) - dc(2, 30)).abs() < 1e-6);
    let adaptive = place.json(&["bake", "roof.obj", "--texels", "32", "--error", "0.01"]);
    assert!(number(&adaptive, "/error") < 0.01 && number(&adaptive, "/savings/open_vertices") >= 512.0, "{adaptive}");
    let timed = place.json(&["bake", "roof.obj", "--texels", "64", "--time", "0.5s", "--bounces", "1"]);
    assert!(number(&timed, "/target_error") > 0.0 && number(&timed, "/expected_seconds") > 0.0, "{timed}");
    assert!(number(&timed, "/error") < 0.1, "{timed}");
    place.write("plain.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    place.refuses(&["bake", "plain.obj", "--texels", "8"], 1, &["plain.obj", "no texture coordinates"]);
    place.refuses(&["bake", "roof.obj", "--texels", "8", "-o", "roof.prt"], 1, &["roof.prt", ".exr"]);
    place.refuses(&["bake", "roof.obj", "plain.obj", "--texels", "8"], 2, &["one mesh at a time"]);
    place.refuses(&["bake", "roof.obj", "--gutter", "2"], 2, &["--texels"]);
}

#[test]
fn work_follows_the_error_that_is_asked_for() {
    let place = Place::new();
    place.write_scene();
    let bake = |more: &[&str]| place.json(&[&["bake", "scene.obj", "--order", "4"], more].concat());
    let (coarse, fine) = (bake(&["--error", "0.02"]), bake(&["--error", "0.002"]));
    assert!(number(&coarse, "/rays_traced") < 0.5 * number(&fine, "/rays_traced"));
    assert!(number(&coarse, "/error") < 0.02 && number(&fine, "/error") < 0.002, "{coarse} {fine}");
    // Most of the sphere sees the whole sky.
    assert!(number(&fine, "/savings/open_vertices") > 20.0);
    assert_eq!(number(&fine, "/target_error"), 0.002);
    let fixed = bake(&["--rays", "64"]);
    assert!(fixed["target_error"].is_null() && number(&fixed, "/rays_per_vertex") == 64.0);

    let timed = bake(&["--time", "0.4s"]);
    assert!(number(&timed, "/target_error") > 0.0 && number(&timed, "/expected_seconds") > 0.0, "{timed}");
    let auto = place.json(&["bake", "scene.obj", "--rays", "64", "--order", "auto"]);
    let errors = auto["order_errors"].as_array().unwrap();
    let order = number(&auto, "/order") as usize;
    assert!(errors[order - 1].as_f64().unwrap() <= 0.1 && errors[order - 2].as_f64().unwrap() > 0.1, "{auto}");
    for wrong in [&["--error", "0"][..], &["--error", "0.1", "--time", "1s"], &["--time", "soon"], &["--order", "best"]]
    {
        place.refuses(&[&["bake", "scene.obj"], wrong].concat(), 2, &["--"]);
    }
    place.refuses(&["bake", "bumps", "--error", "0.1"], 2, &["height field"]);
}

#[test]
fn info_tells_metadata_and_tensors() {
    let place = Place::new();
    place.bake_scene(&["--bounces", "1", "--keep-shadowed", "--albedo", "0.9,0.5,0.1", "--seed", "7"]);
    let info = place.json(&["info", "scene.prt"]);
    assert_eq!(info["metadata"]["format"], "prt/1");
    assert_eq!(info["metadata"]["order"], "4");
    assert_eq!(info["metadata"]["seed"], "7");
    assert!(info["metadata"]["source"].as_str().unwrap().starts_with("scene.obj sha256:"));
    let shape = |name: &str| {
        let tensors = info["tensors"].as_array().unwrap();
        let tensor = tensors.iter().find(|tensor| tensor["name"] == name).unwrap_or_else(|| panic!("{name} in {info}"));
        assert!(tensor["dtype"] == "F32" || name == "index");
        tensor["shape"].to_string()
    };
    assert_eq!(shape("position"), "[189,3]");
    assert_eq!(shape("transfer"), "[189,3,16]", "coloured light has three channels");
    assert_eq!(shape("transfer_shadowed"), "[189,1,16]");
    let people = place.run(&["info", "scene.prt"]);
    assert!(
        people.stdout.contains("transfer_shadowed") && people.stdout.contains("vertex-transfer"),
        "{}",
        people.stdout
    );
}

#[test]
fn info_tells_of_meshes_and_images_too() {
    let place = Place::new();
    place.write_scene();
    let mesh = place.json(&["info", "scene.obj"]);
    assert_eq!(
        (&mesh["content"], number(&mesh, "/vertices"), number(&mesh, "/faces_dropped")),
        (&"mesh".into(), 189.0, 24.0)
    );
    assert_eq!(number(&mesh, "/bounds/1/1"), 1.5);
    prt_bake::Image { width: 2, height: 1, pixels: vec![[0.0, 0.5, 1.0]; 2] }.save(&place.path("a.exr")).unwrap();
    let image = place.json(&["info", "a.exr"]);
    assert_eq!((number(&image, "/width"), number(&image, "/mean"), number(&image, "/largest")), (2.0, 0.5, 1.0));
}

#[test]
fn bad_input_is_one_clear_error() {
    let place = Place::new();
    place.write_scene();
    place.refuses(&["bake", "absent.obj"], 1, &["absent.obj", "No such file"]);
    place.refuses(&["bake", "."], 1, &["cannot"]);
    place.write("empty.obj", "");
    place.refuses(&["bake", "empty.obj"], 1, &["empty.obj"]);
    place.write("scene.xyz", "0 0 0");
    place.refuses(&["bake", "scene.xyz"], 1, &["scene.xyz", "unknown extension"]);
    place.write("lies.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float z\nend_header\n");
    place.refuses(&["bake", "lies.ply"], 1, &["lies.ply"]);
    place.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    place.refuses(&["bake", "flat.obj"], 1, &["flat.obj", "no usable triangle"]);
}

#[test]
fn outputs_that_cannot_be_written_are_refused_before_baking() {
    let place = Place::new();
    place.write_scene();
    place.refuses(&["bake", "scene.obj", "-o", "no/such/a.prt"], 1, &["cannot write no/such/a.prt", "no folder"]);
    place.refuses(&["bake", "scene.obj", "-o", "."], 1, &["cannot write ."]);
    place.refuses(&["bake", "scene.obj", "-o", "./scene.obj"], 1, &["cannot write ./scene.obj", "file to read"]);
    if cfg!(target_os = "linux") {
        let many = ["bake", "scene.obj", "--rays", "16", "-o", "/dev/full"];
        place.refuses(&many, 1, &["cannot write /dev/full", "No space left"]);
    }
}

#[cfg(unix)]
#[test]
fn folders_without_permission_are_refused() {
    use std::os::unix::fs::PermissionsExt;
    let place = Place::new();
    place.write_scene();
    std::fs::create_dir(place.path("locked")).unwrap();
    std::fs::set_permissions(place.path("locked"), std::fs::Permissions::from_mode(0o555)).unwrap();
    if std::fs::write(place.path("locked/probe"), "").is_ok() {
        println!("skipped: this user may write everywhere");
        return;
    }
    place.refuses(
        &["bake", "scene.obj", "-o", "locked/a.prt"],
        1,
        &["cannot write locked/a.prt", "cannot be written to"],
    );
}

#[test]
fn wrong_usage_has_status_2() {
    let place = Place::new();
    place.write_scene();
    for wrong in [
        &["--order", "0"] as &[&str],
        &["--order", "100"],
        &["--order", "x"],
        &["--rays", "0"],
        &["--rays", "-1"],
        &["--threads", "0"],
        &["--albedo", "1,2,3"],
        &["--albedo", "0.5"],
        &["--crease", "-1"],
        &["--bounces", "1000"],
        &["--unshadowed", "--bounces", "1"],
        &["--no-such-flag"],
    ] {
        place.refuses(&[&["bake", "scene.obj"], wrong].concat(), 2, &[]);
    }
    place.refuses(&["bake"], 2, &["Usage"]);
    place.refuses(&["no-such-verb"], 2, &[]);
}

#[test]
fn files_that_are_not_baked_are_refused() {
    let place = Place::new();
    place.bake_scene(&[]);
    place.refuses(&["info", "absent.prt"], 1, &["absent.prt"]);
    place.write("text.prt", "not at all");
    place.refuses(&["info", "text.prt"], 1, &["text.prt", "not a valid"]);
    let mut newer = std::fs::read(place.path("scene.prt")).unwrap();
    let format = newer.windows(5).position(|window| window == b"prt/1").unwrap();
    newer[format + 4] = b'2';
    place.write("newer.prt", &newer);
    place.refuses(&["render", "newer.prt", "-o", "a.png"], 1, &["newer.prt", "newer than"]);
    place.write("cut.prt", &newer[..newer.len() / 2]);
    place.refuses(&["render", "cut.prt", "-o", "a.png"], 1, &["cut.prt"]);
}
