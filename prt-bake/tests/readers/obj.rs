//! Wavefront OBJ.

use prt_bake::{MeshSource, SurfaceMaterial, load_mesh};

use crate::gltf::checker_png;
use crate::scratch::{Scratch, assert_near, assert_refused, mesh, srgb};

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn every_form_of_a_corner() {
    for (face, has_uvs, has_normals) in [
        ("f 1 2 3", false, false),
        ("f 1/1 2/2 3/3", true, false),
        ("f 1//1 2//1 3//1", false, true),
        ("f 1/1/1 2/2/1 3/3/1", true, true),
        ("f -4/-3/-1 -3/-2/-1 -2/-1/-1", true, true),
    ] {
        let mesh = mesh("obj", format!("{SQUARE}vt 0 0\nvt 0.5 0\nvt 0.5 0.25\nvn 0 0 2\n{face}\n")).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2]], "{face}");
        assert_eq!(mesh.positions[2], [1.0, 1.0, 0.0], "{face}");
        assert_eq!(mesh.uvs.get(2), has_uvs.then_some(&[0.5, 0.25]), "{face}");
        assert_eq!(mesh.normals.get(2), has_normals.then_some(&[0.0, 0.0, 2.0]), "{face}");
    }
}

#[test]
fn polygons_become_triangles() {
    let mesh = mesh("obj", format!("{SQUARE}f 1 2 3 4\nv 2 0.5 0\nf 1 2 5 3 4\nf 1 2\n")).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 4], [0, 4, 2], [0, 2, 3], [0, 1, 1]]);
}

#[test]
fn positions_only_keep_their_order_and_number() {
    let mesh = mesh("obj", format!("v 9 9 9\n{SQUARE}vn 0 0 1\nf 5 4 3\nf 3 2 5\n")).unwrap();
    assert_eq!(mesh.positions.len(), 5);
    assert_eq!(mesh.positions[0], [9.0; 3]);
    assert_eq!(mesh.triangles, [[4, 3, 2], [2, 1, 4]]);
    assert!(mesh.normals.is_empty() && mesh.uvs.is_empty() && mesh.albedo.is_empty());
}

#[test]
fn distinct_corners_become_vertices_in_order_of_first_use() {
    let text = format!("{SQUARE}vt 0 0\nvt 1 1\nvn 0 0 1\nf 3/1/1 2/1/1 1/1/1\nf 1/2/1 3/1/1 4/1\n");
    let mesh = mesh("obj", text).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [3, 0, 4]]);
    assert_eq!(mesh.positions, [[1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0; 3], [0.0; 3], [0.0, 1.0, 0.0]]);
    assert_eq!(mesh.uvs[3], [1.0, 1.0]);
    assert_eq!(mesh.normals[3..], [[0.0, 0.0, 1.0], [0.0; 3]], "a missing normal is marked by zero");
}

#[test]
fn what_writers_put_around_it() {
    let plain = mesh("obj", format!("{SQUARE}f 1 2 3 4\n")).unwrap();
    let odd = "\u{feff}# Käfer\r\no body\r\ng a b\r\ns off\r\nv 0 0 0 1.0\r\n\tv  1   0 0 # one\r\nv 1 1 \\\r\n 0\r\nv 0 1 0\r\n\
               l 1 2\r\np 1\r\ncstype bezier\r\nusemtl unknown\r\nf 1 2 \\\r\n3 \\\r\n4";
    let odd = mesh("OBJ", odd).unwrap();
    assert_eq!((&odd.parts[..], &odd.face_part[..]), (&["body/a b".to_owned()][..], &[0, 0][..]));
    assert_eq!(MeshSource { parts: Vec::new(), face_part: Vec::new(), ..odd }, plain);
}

#[test]
fn positions_keep_double_precision() {
    let mesh = mesh("obj", "v 1000000.123456789 -1e-300 .5\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    assert_eq!(mesh.positions[0], [1_000_000.123_456_789, -1e-300, 0.5]);
}

#[test]
fn vertex_colours_are_srgb() {
    let faces = "v 0 0 0 1 0.5 0\nv 1 0 0 0 0 0\nv 0 1 0\nf 1 2 3\n";
    let albedo = mesh("obj", faces).unwrap().albedo;
    assert_near(&albedo[0], &[1.0, srgb(0.5), 0.0], 1e-6);
    assert!(albedo[2][0].is_nan(), "no colour is NaN");
    let bytes = mesh("obj", "v 0 0 0 255 128 0\nv 1 0 0 0 0 1\nv 0 1 0 0 0 0\nf 1 2 3\n").unwrap().albedo;
    assert_near(&bytes[0], &[1.0, srgb(128.0 / 255.0), 0.0], 1e-6);
}

#[test]
fn material_libraries() {
    let scratch = Scratch::new();
    scratch.write(
        "my colours.mtl",
        "newmtl red paint\nKd 0.5 0.25 0\nmap_Kd x.png\nnewmtl grey\nKd 2\nnewmtl none\nKd xyz 1 1 1\n",
    );
    let text = format!(
        "mtllib my colours.mtl\n{SQUARE}usemtl red paint\nf 1 2 3\nusemtl grey\nf 1 3 4\nusemtl none\nf 2 3 4\n"
    );
    let mesh = load_mesh(&scratch.write("test.obj", text)).unwrap();
    // Vertices 1 and 3 are shared by two colours, 2, 3 and 4 by a third: the copies stand behind the file's own.
    assert_eq!(mesh.triangles, [[0, 1, 2], [4, 5, 3], [6, 7, 8]]);
    assert_eq!(mesh.positions[4..6], [[0.0; 3], [1.0, 1.0, 0.0]]);
    assert_eq!(mesh.albedo[..3], [[0.5, 0.25, 0.0]; 3]);
    assert_eq!(mesh.albedo[3..6], [[1.0; 3]; 3], "Kd is clamped");
    assert!(mesh.albedo[6..].iter().all(|albedo| albedo[0].is_nan()));
    assert_eq!(mesh.face_material, [0, 1, SurfaceMaterial::NONE]);
    assert!(mesh.materials[0].texture.is_none() && mesh.warnings.len() == 1, "{:?}", mesh.warnings);
    assert!(mesh.warnings[0].contains("red paint") && mesh.warnings[0].contains("x.png"), "{:?}", mesh.warnings);
}

#[test]
fn textures_of_colour_and_of_opacity() {
    let scratch = Scratch::new();
    scratch.write("checker.png", checker_png());
    let library =
        "newmtl tiles\nKd 0.5 1 1\nmap_Kd -s 2 1 checker.png\nnewmtl net\nmap_Kd checker.png\nmap_d checker.png\n";
    scratch.write("my.mtl", library);
    // The lower left quarter of the image is blue: v runs up.
    let corners = "vt 0.125 0.25\nvt 0.375 0.25\nvt 0.375 0.75\nf 1/1 2/2 3/3\n";
    let text = format!("mtllib my.mtl\n{SQUARE}usemtl tiles\n{corners}usemtl net\nf 1/1 3/2 4/3\n");
    let source = load_mesh(&scratch.write("test.obj", text)).unwrap();
    let gray = srgb(128.0 / 255.0);
    let tiles = [0.0, 0.0, 1.0, 0.5 * gray, gray, gray, 0.0, 1.0, 0.0];
    assert_near(source.albedo[..3].as_flattened(), &tiles, 1e-6);
    let net = &source.materials[1];
    // Opacity is the red of the image: 1 above, 0 and one half below.
    assert_eq!((net.alpha_cutoff, source.materials[0].alpha_cutoff), (Some(0.5), None));
    let there = [[0.25, 0.75], [0.75, 0.75], [0.25, 0.25], [0.75, 0.25]].map(|uv| net.is_there(uv));
    assert_eq!(there, [true, false, false, true]);
    assert!(source.warnings.is_empty() && source.parts.is_empty());
}

#[test]
fn objects_and_groups_are_parts() {
    let text = format!(
        "{SQUARE}f 1 2 3\no car\ng wheel\nf 1 2 3 4\ng\nf 2 3 4\no house\ng empty\ng wheel\nf 1 2 4\no car\nf 1 3 4\n"
    );
    let source = mesh("obj", text).unwrap();
    assert_eq!(source.parts, ["", "car/wheel", "car", "house/wheel"]);
    assert_eq!(source.face_part, [0, 1, 1, 2, 3, 2]);
}

#[test]
fn missing_libraries_are_no_error_and_bad_ones_are() {
    let text = format!("mtllib nowhere.mtl other.mtl\n{SQUARE}usemtl a\nf 1 2 3\n");
    assert!(mesh("obj", &text).unwrap().albedo.is_empty());
    let scratch = Scratch::new();
    let library = scratch.write("other.mtl", "newmtl a\nKd 0.5 red 0\n");
    let message = load_mesh(&scratch.write("test.obj", text)).unwrap_err().to_string();
    assert!(message.contains(library.to_str().unwrap()) && message.contains("line 2: `red`"), "{message}");
}

#[test]
fn nan_is_left_to_cleaning() {
    let mesh = mesh("obj", "v nan 0 inf\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    assert!(mesh.positions[0][0].is_nan() && mesh.positions[0][2].is_infinite());
}

#[test]
fn bad_input() {
    for (text, words) in [
        ("", "it is empty"),
        ("v 0 0\nf 1 1 1\n", "line 1 has 2 numbers where 3 are needed"),
        ("# a\nv 0 0 0,5\n", "line 2: `0,5` is not a number"),
        ("v 0 0 0\nf 1 1 2\n", "line 2: vertex 2 is referred to but there are 1"),
        ("v 0 0 0\n\\\nf 1//1 1 1\n", "line 2: normal 1 is referred to but there are 0"),
        ("v 0 0 0\nf 1/1 1 1\n", "line 2: texture coordinate 1 is referred to but there are 0"),
        ("v 0 0 0\nf 0 1 1\n", "index `0` is not valid"),
        ("v 0 0 0\nf 1 -2 1\n", "index `-2` reaches before the first"),
        ("v 0 0 0\nf 1 1 99999999999\n", "index `99999999999` is out of range"),
        ("v 0 0 0\nf 1 1 99999999999999999999999\n", "is not a whole number"),
        ("v 0 0 0\nf 1 1 1.5\n", "index `1.5` is not a whole number"),
        ("v 0 0 0\nf 1 1 /1\n", "`/1` is not a corner"),
        ("v 0 0 0\nf 1 1 1/1/1/1\n", "line 2"),
        ("v 0 0 0\nv 0 0 1\n", "holds no faces (and 2 vertices)"),
        ("just words\n", "holds no faces (and 0 vertices)"),
    ] {
        assert_refused(mesh("obj", text), words);
    }
    assert_refused(mesh("obj", b"v 0 0 0\nv 1 \xff 0\n"), "line 2 is not UTF-8 text");
    assert_refused(mesh("obj", format!("v 0 0 {}\n", "x".repeat(1 << 20))), "line 1: `xxxxx");
}

#[test]
fn a_huge_concave_polygon_is_cut_in_time() {
    let n = 200_000;
    let mut text = String::new();
    for i in 0..n {
        let (angle, radius) = (f64::from(i) / f64::from(n) * std::f64::consts::TAU, if i % 2 == 0 { 1.0 } else { 0.5 });
        text += &format!("v {} {} 0\n", radius * angle.cos(), radius * angle.sin());
    }
    text += "f";
    (1..=n).for_each(|i| text += &format!(" {i}"));
    assert_eq!(mesh("obj", text).unwrap().triangles.len(), n as usize - 2);
}
