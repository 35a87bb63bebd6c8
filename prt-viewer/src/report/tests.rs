//! Whole reports, of surfaces of every kind.

#![expect(clippy::unwrap_used, reason = "tests")]

use prt_bake::{BakedSurface, Geometry, Metadata, TransferVectors, VertexStats};
use quick_xml::Reader;
use quick_xml::events::Event;
use serde_json::{Value, json};
use sh_core::Order;

use super::advice::Weight;
use super::color::{Ramp, Scale, false_color};
use super::findings::Findings;
use super::pictures::{self, Pictures};
use super::{Paths, ReportInput, advice, page, write};

/// A square of side 2 at z = 0 that faces +z, as a grid of vertices.
fn square(cells: u32) -> Geometry {
    let row = cells + 1;
    let positions: Vec<[f32; 3]> = (0..row * row)
        .map(|i| [2.0 * (i % row) as f32 / cells as f32 - 1.0, 2.0 * (i / row) as f32 / cells as f32 - 1.0, 0.0])
        .collect();
    let corner = |x: u32, y: u32| y * row + x;
    let cell = |i: u32| {
        let (x, y) = (i % cells, i / cells);
        let [a, b, c, d] = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
        [[a, b, c], [a, c, d]]
    };
    let count = positions.len();
    Geometry {
        positions,
        normals: vec![[0.0, 0.0, 1.0]; count],
        triangles: (0..cells * cells).flat_map(cell).collect(),
        albedo: vec![[0.8; 3]; count],
        uvs: None,
    }
}

/// Transfer through which a share of a constant light arrives, of this order.
fn baked(geometry: Geometry, order: usize, share: f32) -> BakedSurface {
    let order = Order::new(order).unwrap();
    let mut transfer = TransferVectors::zero(geometry.vertex_count(), 1, order);
    let first = share / (4.0 * std::f32::consts::PI).sqrt();
    transfer.values.iter_mut().step_by(order.coeff_count()).for_each(|value| *value = first);
    let metadata = Metadata { rays: 64, shadowed: true, ..Metadata::default() };
    BakedSurface { metadata, geometry, transfer, transfer_shadowed: None, validity: None }
}

fn stats(count: usize) -> Vec<VertexStats> {
    vec![VertexStats { directions: 64, occluded: 32, rays: 64, error: 0.01, validity: 1.0 }; count]
}

/// Everything of a report but the files.
struct Made {
    page: String,
    pictures: Pictures,
    advice: Vec<advice::Advice>,
}

fn make(scene: &str, baked: &BakedSurface, vertices: &[VertexStats], numbers: &Value) -> Made {
    let input = ReportInput { scene, baked, vertices, numbers, command: "prt bake 'a <b> & c.obj'" };
    let findings = Findings::of(baked, vertices);
    let pictures = pictures::draw(&input, &findings);
    let advice = advice::of(&input, &findings, &pictures);
    Made { page: page::page(&input, &findings, &pictures, &advice), pictures, advice }
}

/// Parses as XML: tags match, attributes are unique, references are known. Returns the names of all elements.
fn elements(page: &str) -> Vec<String> {
    let mut reader = Reader::from_str(page);
    let (mut names, mut open) = (Vec::new(), 0);
    loop {
        let event = reader.read_event().unwrap_or_else(|error| panic!("at {}: {error}", reader.buffer_position()));
        match event {
            Event::Start(tag) | Event::Empty(tag) if !attributes_are_sound(&tag) => {
                panic!("attributes of {:?}", String::from_utf8_lossy(&tag))
            }
            Event::Start(tag) => {
                open += 1;
                names.push(String::from_utf8(tag.name().as_ref().to_vec()).unwrap());
            }
            Event::Empty(tag) => names.push(String::from_utf8(tag.name().as_ref().to_vec()).unwrap()),
            Event::End(_) => open -= 1,
            Event::GeneralRef(name) => assert!(is_known_reference(&String::from_utf8_lossy(&name)), "{name:?}"),
            Event::Eof => break,
            _ => {}
        }
    }
    assert_eq!(open, 0, "an element stays open");
    names
}

fn attributes_are_sound(tag: &quick_xml::events::BytesStart<'_>) -> bool {
    tag.attributes()
        .with_checks(true)
        .all(|attribute| attribute.is_ok_and(|attribute| !attribute.value.contains(&b'<')))
}

fn is_known_reference(name: &str) -> bool {
    ["lt", "gt", "amp", "quot", "apos", "#39"].contains(&name)
}

/// The page stands alone and is well-formed; its pictures, decoded.
fn checked(page: &str) -> Vec<image::RgbaImage> {
    let names = elements(page);
    assert!(!names.iter().any(|name| ["script", "link", "iframe", "object"].contains(&name.as_str())));
    for reference in ["http:", "https:", "//", "url(", "@import"] {
        let outside = page.split("base64,").map(|part| part.split_once("\"/>").map_or(part, |(_, rest)| rest));
        assert!(outside.clone().all(|part| !part.contains(reference)), "{reference} in the page");
    }
    let sources: Vec<&str> = page.split("src=\"").skip(1).collect();
    sources.iter().map(|source| decoded(source.strip_prefix("data:image/png;base64,").unwrap())).collect()
}

fn decoded(source: &str) -> image::RgbaImage {
    let text = source.split('"').next().unwrap();
    let digit = |c: u8| match c {
        b'A'..=b'Z' => c - b'A',
        b'a'..=b'z' => c - b'a' + 26,
        b'0'..=b'9' => c - b'0' + 52,
        b'+' => 62,
        _ => 63,
    };
    let mut bytes = Vec::new();
    for group in text.as_bytes().chunks(4) {
        let bits = group.iter().fold(0_u32, |bits, &c| bits << 6 | u32::from(digit(c)));
        let padding = group.iter().filter(|&&c| c == b'=').count();
        bytes.extend(&bits.to_be_bytes()[1..4 - padding]);
    }
    image::load_from_memory_with_format(&bytes, image::ImageFormat::Png).unwrap().into_rgba8()
}

fn texts(made: &Made) -> String {
    made.advice.iter().map(|advice| advice.text.as_str()).collect::<Vec<_>>().join("\n")
}

fn panels(made: &Made) -> Vec<&'static str> {
    made.pictures.panels.iter().map(|panel| panel.name).collect()
}

#[test]
fn a_page_has_what_it_must_and_nothing_from_elsewhere() {
    let baked = baked(square(8), 3, 0.5);
    let mut vertices = stats(81);
    vertices[..9].iter_mut().for_each(|stats| stats.rays = 640);
    vertices[40].validity = 0.1;
    vertices[41].error = f32::NAN;
    let numbers = json!({
        "vertices": 81, "triangles": 128, "faces_dropped": 5, "faces_degenerate": 5, "order": 3, "rays_traced": 12345, "error": 0.034,
        "bounce_energy": [0.2, 0.04], "seconds": { "load": 0.1, "trace": 2.5, "total": 2.7 }, "inside": "fill", "bins": { "free": 7 },
        "warnings": ["something <odd> of the bake"],
    });
    let made = make("bunny & <friends> \"2\".obj", &baked, &vertices, &numbers);
    let pictures = checked(&made.page);
    assert_eq!(panels(&made), ["occlusion", "error", "invalid", "rays"]);
    // All sides but the one behind, and the one beside the title.
    assert_eq!(pictures.len(), 4 * 3 + 1);
    for picture in &pictures {
        let opaque = picture.pixels().filter(|pixel| pixel[3] == 255).count() as f32;
        let share = opaque / (picture.width() * picture.height()) as f32;
        assert!((0.1..0.95).contains(&share), "{share} of a picture is covered");
    }
    for expected in [
        "<title>bunny &amp; &lt;friends&gt; &quot;2&quot;.obj: bake report</title>",
        "prt bake &#39;a &lt;b&gt; &amp; c.obj&#39;",
        "<dd>50 %</dd>",
        "12,345",
        "Bins: free",
        "prefers-color-scheme: dark",
        "Bounce 2",
        "Band 2",
        "2.5 s",
        "something &lt;odd&gt; of the bake",
        "not estimated",
        env!("CARGO_PKG_VERSION"),
    ] {
        assert!(made.page.contains(expected), "{expected} is missing");
    }
    assert!(!made.page.contains("<friends>"));
    assert_eq!(
        texts(&made),
        "1 vertex lies inside geometry (1.2 % of all) and was filled from neighbours.\n\
         The estimated error is 3.40 %, above 1 %: more rays would help.\n\
         something <odd> of the bake\n\
         Bounce 2 still adds 4 % of the direct light: one more would be seen.\n\
         5 faces were left out: 5 without area."
    );
    assert_eq!(made.advice[2].weight, Weight::Warning);
}

/// The colour of the middle of a picture is that of the scale, and the rest of the page agrees.
#[test]
fn pictures_show_the_numbers() {
    let surface = baked(square(8), 2, 0.25);
    let mut vertices = stats(81);
    vertices.iter_mut().for_each(|stats| stats.error = 0.01);
    let made = make("square", &surface, &vertices, &json!({}));
    let pictures = checked(&made.page);
    let middle = |picture: &image::RgbaImage| picture.get_pixel(picture.width() / 2, picture.height() / 2).0;
    let occlusion = middle(&pictures[1]);
    assert!(occlusion[..3].iter().all(|channel| channel.abs_diff(64) <= 1) && occlusion[3] == 255, "{occlusion:?}");
    assert_eq!(panels(&made), ["occlusion", "error"], "rays that do not vary are not drawn");
    // 0.01 is the upper end of the decade below it; the hue survives the shading.
    let scale = Scale::decades_around([0.01].into_iter());
    let expected = false_color(Ramp::Heat, scale, 0.01);
    let found = middle(&pictures[4]).map(|channel| super::color::decode_srgb(f32::from(channel) / 255.0));
    let brightness = found[0] / expected[0];
    assert!((0.55..1.0).contains(&brightness), "{brightness}");
    assert!((1..3).all(|k| (found[k] - brightness * expected[k]).abs() < 0.01), "{found:?} {expected:?}");
    assert_eq!(texts(&made), "");
    assert!(made.page.contains("Nothing stands out"));
}

#[test]
fn backs_are_told_from_black() {
    let mut inside_out = square(4);
    inside_out.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
    // A second sheet that faces the front keeps the views.
    let sheet = square(1);
    inside_out.positions.extend(sheet.positions.iter().map(|[x, y, _]| [0.6 * x, 0.6 * y, 0.1]));
    inside_out.triangles.extend(sheet.triangles.iter().map(|corners| corners.map(|vertex| vertex + 25)));
    inside_out.normals.extend(sheet.normals);
    inside_out.albedo.extend(sheet.albedo);
    let made = make("sheet", &baked(inside_out, 1, 1.0), &stats(29), &json!({}));
    assert!((0.2..0.95).contains(&made.pictures.back_share), "{}", made.pictures.back_share);
    assert!(texts(&made).contains("backs of faces") && made.page.contains("backs of faces</span>"), "{}", texts(&made));
    let front = &checked(&made.page)[1];
    let has = |color: [u8; 3]| front.pixels().any(|pixel| pixel.0[..3] == color && pixel[3] == 255);
    assert!(has([255; 3]) && has(super::raster::BACK.map(super::color::encode_srgb)) && !has([0; 3]));
}

#[test]
fn occlusion_is_without_reflected_light_where_that_is_known() {
    let mut surface = baked(square(1), 1, 0.9);
    let shown = |surface: &BakedSurface, vertices: &[VertexStats]| {
        let made = make("square", surface, vertices, &json!({}));
        let picture = &checked(&made.page)[1];
        picture.get_pixel(picture.width() / 2, picture.height() / 2)[0]
    };
    assert_eq!(shown(&surface, &stats(4)), 230, "0.9 arrives, without bounces");
    surface.metadata.bounces = 2;
    assert!(shown(&surface, &stats(4)).abs_diff(128) <= 1, "half of the directions are open");
    assert_eq!(shown(&surface, &[]), 230, "nothing else is known");
    surface.transfer_shadowed = Some(baked(square(1), 1, 0.2).transfer);
    assert_eq!(shown(&surface, &stats(4)), 51, "0.2 arrives directly");
}

/// Where few errors are known they are dots, and validity may come from the file alone.
#[test]
fn what_is_known_of_few_vertices_is_marked() {
    let mut surface = baked(square(8), 2, 0.5);
    let mut vertices = stats(81);
    vertices.iter_mut().skip(1).for_each(|stats| stats.error = f32::NAN);
    vertices[40].error = 0.01;
    let made = make("square", &surface, &vertices, &json!({}));
    assert_eq!(panels(&made), ["occlusion", "error"]);
    assert!(made.page.contains("It was estimated at 2 vertices."));
    let scale = Scale::decades_around([0.01].into_iter());
    let color = false_color(Ramp::Heat, scale, 0.01).map(super::color::encode_srgb);
    let dots = checked(&made.page)[4].pixels().filter(|pixel| pixel.0[..3] == color).count();
    // Two dots of radius 8 within their rims.
    assert!((300..500).contains(&dots), "{dots}");

    let mut validity = vec![1.0; 81];
    validity[7] = 0.1;
    surface.validity = Some(validity);
    let made = make("square", &surface, &[], &json!({ "inside": "black" }));
    assert_eq!(panels(&made), ["occlusion", "invalid"]);
    assert_eq!(texts(&made), "1 vertex lies inside geometry (1.2 % of all) and was made black.");
}

#[test]
fn extremes_are_reported_too() {
    let scaled = |scale: f32| {
        let mut geometry = square(2);
        geometry.positions.iter_mut().flatten().for_each(|x| *x *= scale);
        geometry
    };
    let triangle = Geometry {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 1e-20]],
        normals: vec![[0.0, -1.0, 0.0]; 3],
        triangles: vec![[0, 1, 2]],
        albedo: vec![[0.0; 3]; 3],
        uvs: None,
    };
    for (geometry, pictures_expected) in
        [(scaled(1e30), true), (scaled(1e-35), true), (triangle, true), (scaled(0.0), false)]
    {
        let count = geometry.vertex_count();
        let order = if count == 3 { 9 } else { 1 };
        let made = make("extreme", &baked(geometry, order, 1.0), &stats(count), &json!({}));
        assert_eq!(!checked(&made.page).is_empty(), pictures_expected);
        assert_eq!(texts(&made).contains("no extent"), !pictures_expected, "{}", texts(&made));
    }
}

#[test]
fn numbers_that_are_none_are_reported_too() {
    let mut surface = baked(square(2), 2, 0.5);
    surface.transfer.values[0] = f32::NAN;
    surface.transfer.values[4] = f32::INFINITY;
    let mut vertices = stats(9);
    for (stats, error) in vertices.iter_mut().zip([f32::INFINITY, -1.0, 0.0, 1e-30, 1e30, f32::NAN]) {
        stats.error = error;
    }
    let made = make(
        "odd",
        &surface,
        &vertices,
        &json!({ "error": null, "seconds": 3, "bounce_energy": "none", "warnings": 7 }),
    );
    checked(&made.page);
    assert!(texts(&made).contains("2 vertices have transfer that is not a number."), "{}", texts(&made));
    assert!(texts(&made).contains("The lit picture is missing"), "{}", texts(&made));
    let empty = make("", &baked(Geometry::default(), 1, 0.0), &[], &Value::Null);
    assert!(checked(&empty.page).is_empty());
}

#[test]
fn without_rays_there_is_still_a_report() {
    let mut surface = baked(square(2), 3, 1.0);
    surface.metadata.shadowed = false;
    let made = make("open", &surface, &[], &json!({ "order": 3 }));
    checked(&made.page);
    assert_eq!(panels(&made), ["occlusion"]);
    assert!(texts(&made).contains("Shadows were left out"), "{}", texts(&made));
}

#[test]
fn the_file_has_all_numbers_and_what_was_found() {
    let folder = tempfile::tempdir().unwrap();
    let paths = Paths { html: folder.path().join("a.html"), json: folder.path().join("a.json") };
    let surface = baked(square(2), 3, 0.5);
    let mut vertices = stats(9);
    vertices[0].error = 0.0;
    vertices[8] = VertexStats { error: f32::NAN, validity: 0.2, rays: 6, ..vertices[8] };
    let numbers = json!({ "order": 3, "error": 0.01, "of_others": [1, 2] });
    let command = "prt bake a.obj";
    let input = ReportInput { scene: "a.obj", baked: &surface, vertices: &vertices, numbers: &numbers, command };
    let before = surface.clone();
    write(&paths, &input).unwrap();
    assert_eq!(surface, before, "the surface stays as it is");
    checked(&std::fs::read_to_string(&paths.html).unwrap());
    let file: Value = serde_json::from_slice(&std::fs::read(&paths.json).unwrap()).unwrap();
    for (name, value) in numbers.as_object().unwrap() {
        assert_eq!(&file[name], value);
    }
    assert_eq!((&file["command"], &file["title"]), (&json!(command), &json!("a.obj")));
    assert_eq!(file["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(file["findings"]["invalid_vertices"], 1);
    let error = &file["findings"]["error"];
    assert_eq!((&error["estimated_vertices"], &error["exact_vertices"]), (&json!(8), &json!(1)));
    let counted = error["histogram"]["counts"].as_array().unwrap().iter().filter_map(Value::as_u64).sum::<u64>();
    assert_eq!((counted, &error["histogram"]["below"], &error["histogram"]["missing"]), (7, &json!(1), &json!(1)));
    let rays = &file["findings"]["rays"];
    assert_eq!((&rays["fewest"], &rays["median"], &rays["total"]), (&json!(6), &json!(64), &json!(8 * 64 + 6)));
    assert_eq!(file["findings"]["band_energy"], json!([1.0, 0.0, 0.0]));
    let arriving = file["findings"]["arriving"]["mean"].as_f64().unwrap();
    assert!((arriving - 0.5).abs() < 1e-6);
    assert!(file["warnings"].as_array().unwrap().iter().any(|text| text.as_str().unwrap().contains("inside geometry")));
}
