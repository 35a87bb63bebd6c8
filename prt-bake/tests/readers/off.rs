//! Object File Format.

use crate::scratch::{assert_near, assert_refused, mesh, srgb};

const BODY: &str = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n3 0 1 2 255 0 0\n";

#[test]
fn counts_on_either_line_and_comments() {
    for head in ["OFF\n4 2 0\n", "OFF 4 2 0\n", "4 2\n", "# c\nOFF # d\n\n4 2 0 # e\n\n", "\u{feff}OFF\r\n4 2 0\r\n"] {
        let mesh = mesh("off", format!("{head}{BODY}")).unwrap();
        assert_eq!(mesh.positions.len(), 4, "{head}");
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
    }
}

#[test]
fn colours_normals_and_coordinates() {
    let text = "STCNOFF\n3 1 0\n0 0 0  0 0 1  255 128 0 255  0.5 1\n1 0 0  0 0 1  0 0 0  0 0\n0 1 0  0 0 1  1.0 0.5 0.0  1 1\n3 0 1 2\n";
    let mesh = mesh("off", text).unwrap();
    assert_eq!(mesh.normals, [[0.0, 0.0, 1.0]; 3]);
    assert_eq!(mesh.uvs, [[0.5, 1.0], [0.0, 0.0], [1.0, 1.0]]);
    assert_near(&mesh.albedo[0], &[1.0, srgb(128.0 / 255.0), 0.0], 1e-6);
    assert_near(&mesh.albedo[2], &[1.0, 0.5, 0.0], 0.0);
}

#[test]
fn bad_input() {
    for (text, words) in [
        ("", "it is empty"),
        ("# nothing\n", "holds only comments"),
        ("OOF\n", "begins with `OOF`"),
        ("OFF\n", "ends before the counts"),
        ("OFF\n3 x 0\n", "line 2: `x` is not a count of faces"),
        ("OFF\n-3 1 0\n", "`-3` is not a count of vertices"),
        ("OFF BINARY\n", "binary OFF is not supported"),
        ("4OFF\n1 1 1\n", "`4OFF`"),
        ("nOFF\n3\n1 1 1\n", "the kind `nOFF` of OFF is not supported"),
        ("OFF\n4000000000 1 0\n0 0 0\n", "ends before the 4000000000 vertices"),
        ("OFF\n1 4000000000 0\n0 0 0\n3 0 0 0\n", "ends before the 4000000000 faces"),
        ("OFF\n1 1 0\n0 0\n3 0 0 0\n", "line 3 has 2 numbers"),
        ("OFF\n1 1 0\n0 0 z\n3 0 0 0\n", "line 3: `z` is not a number"),
        ("OFF\n1 1 0\n0 0 0\n3 0 0 1\n", "face 0 refers to vertex 1 but there are 1"),
        ("OFF\n1 1 0\n0 0 0\n3 0 0 -1\n", "line 4: `-1` is not a vertex number"),
        ("OFF\n1 1 0\n0 0 0\n4000000000 0 0 0\n", "line 4 ends before all corners"),
        ("OFF\n1 0 0\n0 0 0\n", "holds no faces (and 1 vertices)"),
    ] {
        assert_refused(mesh("off", text), words);
    }
    assert_refused(mesh("off", b"OFF\n1 1 0\n\xe4\n"), "line 3 is not UTF-8 text");
}
