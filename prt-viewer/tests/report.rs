//! `prt bake --report`.

#![expect(clippy::unwrap_used, reason = "tests")]

mod program;

use std::fs;

use program::{Place, number};
use serde_json::Value;

const BAKE: [&str; 7] = ["bake", "scene.obj", "-o", "scene.prt", "--rays", "64", "--bounces=1"];

fn read(place: &Place, name: &str) -> String {
    fs::read_to_string(place.path(name)).unwrap()
}

#[test]
fn a_report_lies_beside_the_result_and_leaves_it_as_it_is() {
    let place = Place::new();
    place.write_scene();
    place.json(&BAKE);
    let plain = fs::read(place.path("scene.prt")).unwrap();
    let printed = place.json(&[BAKE.as_slice(), &["--report"]].concat());
    assert!(plain == fs::read(place.path("scene.prt")).unwrap(), "the report changes the baked file");
    assert_eq!(place.files(), ["scene.obj", "scene.prt", "scene.report.html", "scene.report.json"]);

    let file: Value = serde_json::from_str(&read(&place, "scene.report.json")).unwrap();
    for name in printed.as_object().unwrap().keys() {
        assert!(file.get(name).is_some(), "{name} is missing");
    }
    for name in ["vertices", "rays_traced", "error", "bounce_energy", "output_bytes"] {
        assert_eq!(file[name], printed[name], "{name}");
    }
    assert_eq!(number(&file, "/findings/rays/total"), number(&file, "/rays_traced"));
    assert_eq!(file["command"], "prt bake scene.obj -o scene.prt --rays 64 --bounces=1 --report --json");
    let page = read(&place, "scene.report.html");
    assert!(page.contains("<title>scene.obj: bake report</title>") && page.contains("data:image/png;base64,"));
    assert!(page.contains("24 faces were left out: 24 without area."), "what was dropped is told");
    assert!(page.contains("--bounces=1 --report --json</pre>"));
}

#[test]
fn a_report_goes_where_it_is_told() {
    let place = Place::new();
    place.write_scene();
    let bake = ["bake", "scene.obj", "--rays", "16", "--report"];
    fs::create_dir(place.path("docs")).unwrap();
    place.json(&[bake.as_slice(), &["docs"]].concat());
    place.json(&[bake.as_slice(), &["my page.html"]].concat());
    assert_eq!(place.files(), ["docs", "my page.html", "my page.json", "scene.obj", "scene.prt"]);
    assert!(place.path("docs/scene.report.html").exists() && place.path("docs/scene.report.json").exists());
}

#[test]
fn names_are_text_and_never_markup() {
    let place = Place::new();
    place.write_scene();
    let name = "a <b> & 'c'.obj";
    fs::rename(place.path("scene.obj"), place.path(name)).unwrap();
    place.json(&["bake", name, "-o", "out.prt", "--rays", "16", "--report"]);
    let page = read(&place, "out.report.html");
    assert!(
        page.contains("<h1>a &lt;b&gt; &amp; &#39;c&#39;.obj</h1>") && !page.contains("<b> & "),
        "the name is escaped"
    );
}

#[test]
fn reports_that_cannot_be_written_are_refused_before_baking() {
    let place = Place::new();
    place.write_scene();
    place.refuses(&["bake", "scene.obj", "--report", "scene.obj"], 2, &["--report", ".html"]);
    place.refuses(&["bake", "scene.obj", "--report", "no/page.html"], 1, &["cannot write no/page.html", "no folder"]);
    place.refuses(&["bake", "scene.obj", "-o", "a.html", "--report=a.html"], 1, &["a.html", "baked file"]);
    place.refuses(&["bake", "scene.obj", "--part", "1/2", "--report"], 2, &["whole bakes"]);
    fs::copy(place.path("scene.obj"), place.path("other.obj")).unwrap();
    place.refuses(&["bake", "scene.obj", "other.obj", "--report", "a.html"], 2, &["folder"]);
    place.refuses(&["bake", "bumps", "--report"], 2, &["vertices of meshes"]);
    place.refuses(&["bake", "scene.obj", "--texels", "8", "--report"], 2, &["vertices of meshes"]);
}

#[test]
fn each_of_several_scenes_has_its_report_and_what_is_up_to_date_keeps_it() {
    let place = Place::new();
    place.write_scene();
    fs::copy(place.path("scene.obj"), place.path("other.obj")).unwrap();
    let bake = ["bake", "scene.obj", "other.obj", "--rays", "16", "--update", "--report"];
    place.json(&bake);
    for name in ["scene.report.html", "scene.report.json", "other.report.html", "other.report.json"] {
        assert!(place.path(name).exists(), "{name}");
    }
    let first: Value = serde_json::from_str(&read(&place, "scene.report.json")).unwrap();
    fs::remove_file(place.path("other.report.html")).unwrap();
    place.json(&bake);
    assert_eq!(first, serde_json::from_str::<Value>(&read(&place, "scene.report.json")).unwrap());
    assert_eq!(first["up_to_date"], false);
    let other: Value = serde_json::from_str(&read(&place, "other.report.json")).unwrap();
    assert_eq!(other["up_to_date"], true, "made from the file, for it was lost");
}
