//! `prt demo`: things that deform, beside ray tracing.

#![expect(clippy::unwrap_used, clippy::print_stdout, reason = "tests")]

mod program;

use program::{Place, pixels};

#[test]
fn lobes_are_nearer_to_ray_tracing_than_undeformed_transfer_in_every_demo() {
    let place = Place::new();
    let quick = ["--rays", "128", "--cells", "24", "--size", "96x96", "--backend", "cpu", "-o", "sheet.exr"];
    let report = place.json(&[&["demo", "all"], quick.as_slice()].concat());
    let rows = report["rows"].as_array().unwrap();
    let mut traced = 0;
    for row in rows {
        let error = |part: &str| row[part].as_f64();
        println!("{}: {:?} {:?} {:?}", row["name"], error("unshadowed"), error("undeformed"), error("lobes"));
        let Some((lobes, undeformed)) = error("lobes").zip(error("undeformed")) else { continue };
        traced += 1;
        assert!(lobes < undeformed, "{row}");
        assert!(error("unshadowed").is_none_or(|unshadowed| lobes < unshadowed), "shadows count: {row}");
    }
    assert_eq!((rows.len(), traced), (10, 8), "two of the vases cannot be traced");
    let sheet = pixels(&place.path("sheet.exr"));
    assert_eq!((sheet.width, sheet.height), (4 * 96, rows.len() * 96));
}

#[test]
fn the_names_of_demos_are_listed() {
    let place = Place::new();
    place.refuses(&["demo", "dragon"], 2, &["patch, vase, bat, wrinkles, head, all"]);
    let help = place.run(&["demo", "--help"]);
    assert!(help.stdout.contains("A bat with wings of thin membrane"), "{}", help.stdout);
    let absent = ["demo", "head", "--mesh", "absent.obj"];
    place.refuses(&absent, 1, &["absent.obj"]);
}
