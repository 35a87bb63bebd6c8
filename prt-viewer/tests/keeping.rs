//! What is kept of a bake that is stopped, killed or shared out: `prt bake --resume`, `--part`, `--update` and `prt merge`.

#![cfg(unix)]
#![expect(clippy::unwrap_used, clippy::print_stderr, reason = "tests")]

mod program;

use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::process::{Child, Command};
use std::time::{Duration, Instant};

use program::{Place, number};

/// Enough work to be killed in: about two seconds.
const LONG: [&str; 10] = ["bake", "scene.obj", "--rays", "65536", "--bounces", "2", "--order", "5", "--threads", "1"];

/// The same for the texels of an atlas; most of it is theirs.
const LONG_ATLAS: [&str; 10] =
    ["bake", "roof.obj", "--texels", "64x48", "--rays", "8192", "--bounces", "3", "--threads", "1"];

fn signal(child: &Child, name: &str) {
    assert!(Command::new("kill").args([name, &child.id().to_string()]).status().unwrap().success());
}

/// Bytes of the journal beside an output.
fn journal_bytes(place: &Place, output: &str) -> u64 {
    fs::metadata(place.path(&format!("{output}.journal"))).map_or(0, |metadata| metadata.len())
}

/// Waits until the journal has grown, or the program has ended.
fn wait_for_growth(place: &Place, output: &str, child: &mut Child, from: u64) {
    let start = Instant::now();
    while journal_bytes(place, output) <= from && child.try_wait().unwrap().is_none() {
        assert!(start.elapsed() < Duration::from_secs(60), "nothing is written");
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn killing_it_again_and_again_loses_nothing_and_ends_with_the_same_bytes() {
    let place = Place::new();
    place.write_scene();
    kill_again_and_again(&place, &LONG, "scene.prt");
    assert_eq!(place.files(), ["scene.obj", "scene.prt"]);
}

#[test]
fn killing_a_bake_of_texels_loses_nothing_either() {
    let place = Place::new();
    place.write_roof();
    kill_again_and_again(&place, &LONG_ATLAS, "roof.exr");
    assert_eq!(place.files(), ["roof.exr", "roof.obj"]);
}

/// Kills a bake and resumes it, until it comes to its end.
fn kill_again_and_again(place: &Place, bake: &[&str], output: &str) {
    assert_eq!(place.run(bake).status, Some(0));
    let expected = fs::read(place.path(output)).unwrap();
    fs::remove_file(place.path(output)).unwrap();

    let resume = [bake, &["--resume"]].concat();
    let (mut kills, mut grown) = (0, 0);
    loop {
        let mut child = place.spawn(&resume);
        // Each time a little later after something was written, so that it is killed in all that it does.
        wait_for_growth(place, output, &mut child, grown);
        std::thread::sleep(Duration::from_millis(7 * kills % 30));
        if let Some(status) = child.try_wait().unwrap() {
            assert!(status.success());
            break;
        }
        signal(&child, "-KILL");
        let status = child.wait().unwrap();
        if status.success() {
            break;
        }
        assert_eq!(status.signal(), Some(9));
        kills += 1;
        match fs::read(place.path(output)) {
            Ok(bytes) => assert!(bytes == expected, "no half file under its name"),
            Err(_) => assert!(journal_bytes(place, output) >= grown, "what was written stays"),
        }
        grown = journal_bytes(place, output);
        assert!(kills < 500, "it gets on");
    }
    eprintln!("killed {kills} times");
    assert!(kills >= 5, "killed {kills} times only");
    assert_eq!(fs::read(place.path(output)).unwrap(), expected);
}

#[test]
fn memory_is_that_of_the_mesh_the_tree_and_the_output() {
    let place = Place::new();
    let cells = 150;
    let mut text = String::new();
    for i in 0..=cells {
        for k in 0..=cells {
            let [x, z] = [i, k].map(|k| f64::from(k) / f64::from(cells) - 0.5);
            text += &format!("v {x} {} {z}\n", 2.0 * x.abs());
        }
    }
    for a in (1..=cells * (cells + 1)).filter(|a| a % (cells + 1) != 0) {
        text += &format!("f {a} {} {} {}\n", a + 1, a + cells + 2, a + cells + 1);
    }
    place.write("scene.obj", text);
    let report = place.json(&["bake", "scene.obj", "--rays", "1024", "--bounces", "2", "--order", "5"]);
    // The hits for reflection alone, at 12 bytes each, are more than is allowed for.
    let hits = 12.0 * number(&report, "/rays_traced") * number(&report, "/occluded_share") / 1.5;
    assert!(hits > 70e6, "{hits}");
    // Per vertex: f64 and f32 positions, normals, albedo. Per triangle: corners, number, two nodes; three indices twice.
    let mesh = 72.0 * number(&report, "/vertices") + 24.0 * number(&report, "/triangles");
    let tree = 104.0 * number(&report, "/triangles");
    let bound = mesh + tree + number(&report, "/output_bytes") + 64e6;
    let peak = number(&report, "/peak_memory_bytes");
    eprintln!("peak {:.1} MB, bound {:.1} MB, hits {:.1} MB", peak / 1e6, bound / 1e6, hits / 1e6);
    if cfg!(target_os = "linux") {
        assert!(peak < bound, "{peak} of {bound}");
    }
}

#[test]
fn ctrl_c_keeps_what_is_done_and_says_how_to_go_on() {
    let place = Place::new();
    place.write_scene();
    let mut child = place.spawn(&LONG);
    wait_for_growth(&place, "scene.prt", &mut child, 20_000);
    signal(&child, "-INT");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("scene.prt.journal: --resume goes on from there"), "{message}");
    assert!(message.ends_with("prt: cancelled\n"), "{message}");
    assert_eq!(place.files(), ["scene.obj", "scene.prt.journal"]);

    let info = place.json(&["info", "scene.prt.journal"]);
    let done = number(&info, "/vertices_done");
    assert!(done > 0.0 && done <= number(&info, "/vertices") && info["complete"] == false, "{info}");
    assert_eq!(info["settings"]["rays_per_vertex"], "65536");

    place.refuses(&LONG, 1, &["scene.prt.journal holds an unfinished bake", "--resume", "--restart"]);
    place.refuses(&["bake", "scene.obj", "--resume"], 1, &["is of another bake", "bounces is 2 there, but 0 now"]);
    let resumed = place.json(&[LONG.as_slice(), &["--resume"]].concat());
    assert!(number(&resumed, "/vertices_resumed") > 0.0);
    let bytes = fs::read(place.path("scene.prt")).unwrap();
    assert_eq!(number(&place.json(&[LONG.as_slice(), &["--restart"]].concat()), "/vertices_resumed"), 0.0);
    assert_eq!(fs::read(place.path("scene.prt")).unwrap(), bytes);
}

#[test]
fn ctrl_c_before_anything_is_done_leaves_nothing() {
    let place = Place::new();
    place.write_scene();
    // Minutes for the first block.
    let mut child = place.spawn(&["bake", "scene.obj", "--rays", "1000000", "--order", "16", "--threads", "1"]);
    std::thread::sleep(Duration::from_millis(700));
    assert!(child.try_wait().unwrap().is_none(), "it still bakes");
    signal(&child, "-INT");
    let asked = Instant::now();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    assert!(asked.elapsed() < Duration::from_secs(20), "{:?}", asked.elapsed());
    assert_eq!(place.files(), ["scene.obj"]);
}

#[test]
fn parts_from_several_runs_merge_to_the_same_bytes() {
    let place = Place::new();
    place.write_scene();
    let bake = |more: &[&str]| place.json(&[&["bake", "scene.obj", "--rays", "128", "--bounces", "2"], more].concat());
    let whole = bake(&[]);
    let expected = fs::read(place.path("scene.prt")).unwrap();
    for part in ["1/3", "2/3", "3/3"] {
        let report = bake(&["--part", part]);
        assert_eq!(number(&report, "/part/1"), 3.0);
        let info = place.json(&["info", report["output"].as_str().unwrap()]);
        assert!(info["complete"] == true && info["vertices"] == info["vertices_done"], "{info}");
        assert!(number(&report, "/rays_traced") < 0.5 * number(&whole, "/rays_traced"));
    }
    fs::remove_file(place.path("scene.prt")).unwrap();
    // A farm has the parts, not the scene.
    fs::remove_file(place.path("scene.obj")).unwrap();
    let parts = ["scene.2-of-3.part", "scene.3-of-3.part", "scene.1-of-3.part"];
    assert_eq!(place.files(), ["scene.1-of-3.part", "scene.2-of-3.part", "scene.3-of-3.part"]);
    place.refuses(&[&["merge", "-o", "scene.prt"], &parts[..2]].concat(), 1, &["of 3 parts", "missing: 1"]);
    place.refuses(&["merge", "-o", parts[0], parts[0]], 1, &["it is the file to read"]);
    place.refuses(&[&["merge", "-o", "scene.exr"], parts.as_slice()].concat(), 1, &["scene.exr", ".prt"]);
    let merged = place.json(&[&["merge", "--report", "-o", "scene.prt"], parts.as_slice()].concat());
    let page = fs::read_to_string(place.path("scene.report.html")).unwrap();
    assert!(page.contains("<h1>scene.obj</h1>") && page.contains("Energy of each bounce"), "{page}");
    assert_eq!(fs::read(place.path("scene.prt")).unwrap(), expected);
    assert_eq!(number(&merged, "/rays_traced"), number(&whole, "/rays_traced"));
    assert_eq!(number(&merged, "/output_bytes"), expected.len() as f64);
}

#[test]
fn an_atlas_is_stopped_resumed_shared_out_and_updated_as_vertices_are() {
    let place = Place::new();
    place.write_roof();
    let mut child = place.spawn(&LONG_ATLAS);
    wait_for_growth(&place, "roof.exr", &mut child, 60_000);
    signal(&child, "-INT");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    assert!(String::from_utf8(output.stderr).unwrap().contains("roof.exr.journal: --resume goes on from there"));
    let info = place.json(&["info", "roof.exr.journal"]);
    let done = number(&info, "/texels_done");
    assert!(done > 0.0 && done < number(&info, "/texels") && info["settings"]["width"] == "64", "{info}");
    place.refuses(&LONG_ATLAS, 1, &["roof.exr.journal holds an unfinished bake", "--resume", "--restart"]);
    place.refuses(&["bake", "roof.obj", "--texels", "64", "--resume"], 1, &["is of another bake"]);
    let resume = [LONG_ATLAS.as_slice(), &["--resume"]].concat();
    assert!(number(&place.json(&resume), "/texels_resumed") >= done);
    let expected = fs::read(place.path("roof.exr")).unwrap();
    assert_eq!(place.json(&[LONG_ATLAS.as_slice(), &["--update"]].concat())["up_to_date"], true);
    fs::remove_file(place.path("roof.exr")).unwrap();

    for part in ["1/2", "2/2"] {
        let report = place.json(&[LONG_ATLAS.as_slice(), &["--part", part]].concat());
        assert_eq!((number(&report, "/part/1"), number(&report, "/texels_inside")), (2.0, 0.0));
        assert_eq!(number(&report, "/bounces"), 3.0);
        let [trace, write] = ["/seconds/trace", "/seconds/write"].map(|step| number(&report, step));
        assert!(trace > write && number(&report, "/rays_traced") > 1e6, "{report}");
    }
    fs::remove_file(place.path("roof.obj")).unwrap();
    let parts = ["roof.1-of-2.part", "roof.2-of-2.part"];
    assert_eq!(place.files(), parts);
    place.refuses(&[&["merge", "-o", "roof.prt"], parts.as_slice()].concat(), 1, &["roof.prt", ".exr"]);
    let merged = place.json(&[&["merge", "-o", "roof.exr"], parts.as_slice()].concat());
    assert_eq!(fs::read(place.path("roof.exr")).unwrap(), expected);
    assert_eq!((number(&merged, "/texels"), number(&merged, "/bounces")), (number(&info, "/texels"), 3.0));
}

#[test]
fn parts_without_a_point_of_their_own_are_parts_too() {
    let place = Place::new();
    place.write_roof();
    let bake = |more: &[&str]| place.json(&[&["bake", "roof.obj", "--texels", "4", "--rays", "64"], more].concat());
    for part in ["1/3", "2/3", "3/3"] {
        bake(&["--part", part]);
    }
    let parts = ["roof.1-of-3.part", "roof.2-of-3.part", "roof.3-of-3.part"];
    let info = place.json(&["info", parts[0]]);
    assert_eq!((number(&info, "/texels"), &info["complete"], &info["bakes_texels"]), (0.0, &true.into(), &true.into()));
    let line = place.run(&["info", parts[0]]).stdout;
    assert!(line.contains("part 1 of 3, 0 of 0 texels traced, complete"), "{line}");
    place.refuses(&[&["merge", "-o", "roof.prt"], parts.as_slice()].concat(), 1, &["roof.prt", "texels", ".exr"]);
    place.refuses(&[&["merge", "--report", "-o", "roof.exr"], parts.as_slice()].concat(), 2, &["not for texels"]);
    place.json(&[&["merge", "-o", "roof.exr"], parts.as_slice()].concat());
    let merged = fs::read(place.path("roof.exr")).unwrap();
    bake(&["-o", "whole.exr"]);
    assert_eq!(fs::read(place.path("whole.exr")).unwrap(), merged);
    place.refuses(&["bake", "roof.obj", "-o", "vertices.exr"], 1, &["vertices.exr", ".prt"]);
}

#[test]
fn the_only_part_of_one_is_a_part() {
    let place = Place::new();
    place.write_roof();
    for (texels, output) in [(&["--texels", "8"][..], "roof.exr"), (&[], "roof.prt")] {
        let bake = [&["bake", "roof.obj", "--rays", "64"], texels].concat();
        place.json(&bake);
        let expected = fs::read(place.path(output)).unwrap();
        let report = place.json(&[bake.as_slice(), &["--part", "1/1"]].concat());
        assert_eq!((report["output"].as_str().unwrap(), number(&report, "/part/1")), ("roof.1-of-1.part", 1.0));
        place.json(&["merge", "roof.1-of-1.part", "-o", output]);
        assert_eq!(fs::read(place.path(output)).unwrap(), expected);
        fs::remove_file(place.path("roof.1-of-1.part")).unwrap();
    }
}

#[test]
fn a_device_takes_neither_parts_nor_images_nor_reports() {
    let place = Place::new();
    place.write_roof();
    std::os::unix::fs::symlink("/dev/null", place.path("null.exr")).unwrap();
    let bake = |more: &[&'static str]| [&["bake", "roof.obj", "--rays", "64", "-o"], more].concat();
    for output in [&["/dev/null", "--part", "1/2"][..], &["null.exr", "--texels", "8", "--part", "1/2"]] {
        place.refuses(&bake(output), 1, &["cannot write", "regular file"]);
    }
    place.refuses(&bake(&["null.exr", "--texels", "8"]), 1, &["cannot write null.exr", "regular file"]);
    place.refuses(&bake(&["/dev/null", "--report", "page.html"]), 1, &["/dev/null", "device"]);
    assert_eq!(place.run(&bake(&["/dev/null"])).status, Some(0));
}

#[test]
fn update_bakes_only_what_changed() {
    let place = Place::new();
    place.write_scene();
    let up_to_date = |more: &[&str]| {
        let bake = ["bake", "scene.obj", "--rays", "32", "--update"];
        place.json(&[bake.as_slice(), more].concat())["up_to_date"].as_bool().unwrap()
    };
    assert!(!up_to_date(&[]));
    assert!(up_to_date(&[]) && up_to_date(&["--threads", "1", "--nice", "5"]));
    assert!(!up_to_date(&["--order", "3"]) && up_to_date(&["--order", "3"]));
    let text = fs::read_to_string(place.path("scene.obj")).unwrap();
    // A comment changes the file, but nothing of the mesh.
    place.write("scene.obj", format!("# touched\n{text}"));
    assert!(up_to_date(&["--order", "3"]));
    place.write("scene.obj", text.replacen("v ", "v 0.1", 1));
    assert!(!up_to_date(&["--order", "3"]));
    assert!(!up_to_date(&["--unshadowed"]) && up_to_date(&["--unshadowed"]));
    assert!(!up_to_date(&["--order", "3"]));
    // What was baked in a time is as good as it is, however long the next pilot would take.
    let in_time = ["bake", "scene.obj", "--time", "0.3s", "-o", "timed.prt", "--resume"];
    place.write("other.obj", text.replacen("v ", "v 0.2", 1));
    place.json(&["bake", "other.obj", "--error", "0.9", "-o", "timed.prt"]);
    let timed = (place.json(&in_time), fs::read(place.path("timed.prt")).unwrap());
    assert!(number(&timed.0, "/expected_seconds") > 0.0, "an error of another scene does not count: {}", timed.0);
    assert_eq!(place.json(&in_time)["up_to_date"], true);
    assert!(timed.0["up_to_date"] == false && timed.1 == fs::read(place.path("timed.prt")).unwrap());
    let run = place.run(&["bake", "scene.obj", "--rays", "32", "--update", "--order", "3"]);
    assert_eq!(run.stdout, "scene.prt is up to date\n");
}

#[test]
fn several_meshes_are_baked_each_and_only_where_they_changed() {
    let place = Place::new();
    place.write_scene();
    let text = fs::read_to_string(place.path("scene.obj")).unwrap();
    place.write("other.obj", text.replacen("v ", "v 0.1", 1));
    place.write("broken.obj", "v 0 0 0\n");
    fs::create_dir(place.path("out")).unwrap();
    let bake = ["bake", "scene.obj", "other.obj", "-o", "out", "--rays", "32", "--update"];
    let state = || {
        let report = place.json(&bake);
        ["/scenes/0", "/scenes/1"].map(|scene| report.pointer(scene).unwrap()["up_to_date"].as_bool().unwrap())
    };
    assert_eq!((state(), state()), ([false; 2], [true; 2]));
    place.write("other.obj", &text);
    assert_eq!(state(), [true, false]);
    assert_eq!(fs::read_dir(place.path("out")).unwrap().count(), 2);
    // What cannot be baked does not hold up the rest.
    let run = place.run(&["bake", "broken.obj", "scene.obj", "--rays", "16", "--json"]);
    assert_eq!(run.status, Some(1), "{}", run.stderr);
    assert!(run.stderr.contains("broken.obj holds no faces") && run.stderr.contains("1 of 2 scenes"), "{}", run.stderr);
    assert!(place.path("scene.prt").exists() && run.stdout.contains("\"failed\":[{"), "{}", run.stdout);
    place.refuses(&["bake", "scene.obj", "out/../scene.obj"], 1, &["two of the scenes"]);
    place.refuses(&["bake", "scene.obj", "other.obj", "-o", "scene.obj"], 1, &["scene.obj is not a folder"]);
    place.refuses(&["bake", "bumps", "scene.obj"], 2, &["one at a time"]);
}

#[test]
fn wrong_usage_of_parts_has_status_2() {
    let place = Place::new();
    place.write_scene();
    for part in ["0/2", "3/2", "x", "1/0", "1"] {
        place.refuses(&["bake", "scene.obj", "--part", part], 2, &["part"]);
    }
    place.refuses(&["bake", "scene.obj", "--resume", "--restart"], 2, &["--restart"]);
    place.refuses(&["bake", "scene.obj", "--nice", "20"], 2, &["20"]);
    place.refuses(&["bake", "bumps", "--part", "1/2"], 2, &["height field"]);
    place.refuses(&["merge", "-o", "a.prt"], 2, &["PART"]);
    place.refuses(&["merge", "scene.obj", "-o", "a.prt"], 1, &["scene.obj is not a valid bake journal"]);
}
