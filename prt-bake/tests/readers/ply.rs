//! Stanford PLY.

use prt_bake::MeshSource;

use crate::scratch::{assert_near, assert_refused, mesh, srgb};

/// The same square pyramid in one of the encodings, with types of every kind and things to be skipped.
pub(crate) fn pyramid(encoding: &str) -> Vec<u8> {
    let header = format!(
        "ply\nformat {encoding} 1.0\ncomment made by \u{e9}\nobj_info x\n\
         element camera 2\nproperty float32 fov\nproperty list ushort int16 tags\n\
         element vertex 5\nproperty double x\nproperty float y\nproperty int z\nproperty list uchar float spare\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\nproperty float s\nproperty float t\n\
         element face 5\nproperty short material\nproperty list char uint vertex_indices\nproperty list uchar float texcoord\n\
         element empty 4000000000\nend_header\n"
    );
    let mut out = Writer { bytes: header.into_bytes(), encoding };
    for tags in [0, 3] {
        out.float(1.5).int(2, tags);
        (0..tags).for_each(|tag| {
            out.int(2, -tag);
        });
        out.line();
    }
    let corners = [(0.0, 0.0, 0), (1.0, 0.0, 0), (1.0, 1.0, 0), (0.0, 1.0, 0), (0.5, 0.5, 2)];
    for (i, (x, y, z)) in corners.into_iter().enumerate() {
        out.double(x).float(y).int(4, z).int(1, 1).float(7.0);
        out.int(1, 255).int(1, 50 * i as i64).int(1, 0).int(1, 9).float(0.25 * i as f32).float(1.0).line();
    }
    for face in [&[0, 3, 2, 1][..], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]] {
        out.int(2, -7).int(1, face.len() as i64);
        face.iter().for_each(|&corner| {
            out.int(4, corner);
        });
        out.int(1, 0).line();
    }
    out.bytes
}

struct Writer<'a> {
    bytes: Vec<u8>,
    encoding: &'a str,
}

impl Writer<'_> {
    fn put(&mut self, text: &str, mut little_endian: Vec<u8>) -> &mut Self {
        match self.encoding {
            "ascii" => self.bytes.extend(format!("{text} ").bytes()),
            "binary_little_endian" => self.bytes.extend(little_endian),
            _ => {
                little_endian.reverse();
                self.bytes.extend(little_endian);
            }
        }
        self
    }

    fn int(&mut self, size: usize, value: i64) -> &mut Self {
        self.put(&value.to_string(), value.to_le_bytes()[..size].to_vec())
    }

    fn float(&mut self, value: f32) -> &mut Self {
        self.put(&value.to_string(), value.to_le_bytes().to_vec())
    }

    fn double(&mut self, value: f64) -> &mut Self {
        self.put(&value.to_string(), value.to_le_bytes().to_vec())
    }

    fn line(&mut self) {
        if self.encoding == "ascii" {
            self.bytes.push(b'\n');
        }
    }
}

pub(crate) const ENCODINGS: [&str; 3] = ["ascii", "binary_little_endian", "binary_big_endian"];

#[test]
fn the_same_in_every_encoding() {
    let meshes: Vec<MeshSource> = ENCODINGS.iter().map(|encoding| mesh("ply", pyramid(encoding)).unwrap()).collect();
    assert_eq!(meshes[0], meshes[1]);
    assert_eq!(meshes[0], meshes[2]);
    let mesh = &meshes[0];
    assert_eq!(mesh.positions[4], [0.5, 0.5, 2.0]);
    assert_eq!(mesh.triangles, [[0, 3, 2], [0, 2, 1], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]);
    assert_eq!(mesh.uvs[3], [0.75, 1.0]);
    assert_near(&mesh.albedo[2], &[1.0, srgb(100.0 / 255.0), 0.0], 1e-6);
    assert!(mesh.normals.is_empty());
}

#[test]
fn truncation_at_any_byte_is_an_error() {
    for encoding in ENCODINGS {
        let bytes = pyramid(encoding);
        // The blank and the line end behind the last number may be missing.
        let end = if encoding == "ascii" { bytes.len() - 2 } else { bytes.len() };
        for length in 1..end {
            assert_refused(mesh("ply", &bytes[..length]), "is not a valid PLY file");
        }
    }
}

#[test]
fn floats_are_linear_colours_and_normals_are_read() {
    let header = "ply\r\nformat ascii 1.0\r\nelement face 1\r\nproperty list int int vertex_index\r\nelement vertex 3\r\nproperty float x\r\n\
                  property float y\r\nproperty float z\r\nproperty float nx\r\nproperty float ny\r\nproperty float nz\r\n\
                  property float r\r\nproperty float g\r\nproperty float b\r\nproperty float u\r\nproperty float v\r\nend_header\r\n";
    let body = "3 0 1 2\r\n0 0 0 0 0 1 0.5 2 nan 0 0\r\n1 0 0 0 0 1 0.5 2 -1 0 1\r\n0 1 0 0 0 1 0 0 0 1 1";
    let mesh = mesh("ply", format!("{header}{body}")).unwrap();
    assert_eq!(mesh.normals, [[0.0, 0.0, 1.0]; 3]);
    assert!(mesh.albedo[0][0].is_nan());
    assert_eq!(mesh.albedo[1], [0.5, 1.0, 0.0]);
    assert_eq!(mesh.uvs[1], [0.0, 1.0]);
}

#[test]
fn strips() {
    let text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                element tristrips 1\nproperty list int int vertex_indices\nend_header\n\
                0 0 0 1 0 0 0 1 0 1 1 0 8 0 1 2 3 -1 3 2 1\n";
    assert_eq!(mesh("ply", text).unwrap().triangles, [[0, 1, 2], [2, 1, 3], [3, 2, 1]]);
}

#[test]
fn lying_headers() {
    let vertex = "property float x\nproperty float y\nproperty float z\n";
    let face = "property list uchar int vertex_indices\n";
    for encoding in ENCODINGS {
        let file = |vertices: u64, faces: u64, body: &[u8]| {
            let mut bytes = format!(
                "ply\nformat {encoding} 1.0\nelement vertex {vertices}\n{vertex}element face {faces}\n{face}end_header\n"
            )
            .into_bytes();
            bytes.extend(body);
            bytes
        };
        assert_refused(mesh("ply", file(4_000_000_000, 1, b"1 2 3 ")), "claims 4000000000 elements `vertex`");
        assert_refused(mesh("ply", file(u64::MAX, 1, b"1 2 3 ")), "claims 18446744073709551615 elements `vertex`");
        assert_refused(mesh("ply", file(0, 4_000_000_000, b"1 2 3 ")), "claims 4000000000 elements `face`");
    }
    let list = |body: &[u8]| {
        let header = "ply\nformat binary_little_endian 1.0\nelement x 1\nproperty list uint double y\nelement face 1\nproperty list int int vertex_index\nend_header\n";
        mesh("ply", [header.as_bytes(), body].concat())
    };
    assert_refused(list(&[255, 255, 255, 255, 0]), "ends in the middle");
    assert_refused(list(&[0, 0, 0, 0, 255, 255, 255, 127, 0, 0]), "ends in the middle");
    assert_refused(list(&[0, 0, 0, 0, 255, 255, 255, 255, 0, 0]), "a list has the length -1");
}

#[test]
fn bad_input() {
    let head = "ply\nformat ascii 1.0\n";
    let vertex = "element vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
    let face = "element face 1\nproperty list uchar int vertex_indices\n";
    for (text, words) in [
        (String::new(), "it is empty"),
        ("PLY\n".into(), "does not begin with the line `ply`"),
        (head.into(), "no line `end_header`"),
        ("ply\nend_header\n".into(), "no line `format`"),
        ("ply\nformat utf8 1.0\nend_header\n".into(), "unknown encoding `utf8`"),
        (format!("{head}element vertex\n"), "header line 3: an element needs a name and a count"),
        (format!("{head}element vertex -1\n"), "`-1` is not a count"),
        (format!("{head}property float x\n"), "a property before any element"),
        (format!("{head}element vertex 1\nproperty quad x\n"), "unknown type `quad`"),
        (format!("{head}element vertex 1\nproperty list float int x\n"), "must be an integer type"),
        (format!("{head}nonsense\n"), "unknown keyword `nonsense`"),
        (format!("{head}element vertex 1\nproperty float x\nend_header\n1 2"), "lacks x, y or z"),
        (
            format!("{head}{vertex}element face 1\nproperty int a\nend_header\n0 0 0 1"),
            "lacks a list of integers `vertex_indices`",
        ),
        (format!("{head}{vertex}{vertex}{face}end_header\n0 0 0 0 0 0 3 0 0 0"), "two elements `vertex`"),
        (format!("{head}{vertex}{face}end_header\n0 0 zero 3 0 0 0"), "line 10: `zero` is not a number"),
        (format!("{head}{vertex}{face}end_header\n0 0 0\n3 0 0 0.5"), "line 11: `0.5` is not a whole number"),
        (format!("{head}{vertex}{face}end_header\n0 0 0\n3 0 0 1"), "face 0 refers to vertex 1 but there are 1"),
        (format!("{head}{vertex}{face}end_header\n0 0 0\n3 0 0 -1"), "refers to vertex -1"),
        (format!("{head}{vertex}{face}end_header\n0 0 0\n"), "it ends in line 11 in the middle of the data"),
        (format!("{head}{vertex}end_header\n0 0 0\n"), "holds no faces (and 1 vertices)"),
    ] {
        assert_refused(mesh("ply", text), words);
    }
    let not_text = [format!("{head}{vertex}{face}end_header\n0 0 0\n").as_bytes(), b"3 0 \xff 0"].concat();
    assert_refused(mesh("ply", not_text), "line 11 is not UTF-8 text");
}
