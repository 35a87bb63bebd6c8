//! glTF that is in order. Documents are built as JSON with a buffer of little-endian numbers.

use std::fmt::Write as _;

use prt_bake::{Error, MeshSource, load_mesh};
use serde_json::{Value, json};

use crate::scratch::{Scratch, assert_near, mesh, srgb};

/// A document in the making.
#[derive(Default)]
pub(crate) struct Builder {
    pub(crate) bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

pub(crate) const FLOAT: u32 = 5126;

impl Builder {
    /// Adds a buffer view.
    pub(crate) fn view(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.push(json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()}));
        self.bytes.extend(bytes);
        self.views.len() - 1
    }

    /// Adds an accessor over a view of its own.
    pub(crate) fn accessor(&mut self, kind: &str, component: u32, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        self.raw_accessor(json!({"bufferView": view, "componentType": component, "count": count, "type": kind}))
    }

    pub(crate) fn raw_accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    pub(crate) fn floats<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let kind = ["SCALAR", "SCALAR", "VEC2", "VEC3", "VEC4"].get(N).copied().unwrap_or("MAT4");
        let bytes: Vec<u8> = values.as_flattened().iter().flat_map(|value| value.to_le_bytes()).collect();
        self.accessor(kind, FLOAT, values.len(), &bytes)
    }

    /// The whole document; `rest` holds everything but asset, buffers, views and accessors, or overrides them.
    pub(crate) fn json(&self, rest: Value) -> Value {
        let mut document = json!({
            "asset": {"version": "2.0"},
            "buffers": [{"byteLength": self.bytes.len()}],
            "bufferViews": self.views,
            "accessors": self.accessors,
        });
        let Value::Object(rest) = rest else { panic!("an object") };
        document.as_object_mut().unwrap().extend(rest);
        document
    }

    pub(crate) fn glb(&self, rest: Value) -> Vec<u8> {
        glb(&self.json(rest), &self.bytes)
    }

    pub(crate) fn load(&self, rest: Value) -> Result<MeshSource, Error> {
        mesh("glb", self.glb(rest))
    }
}

pub(crate) fn glb(json: &Value, binary: &[u8]) -> Vec<u8> {
    let (mut json, mut binary) = (json.to_string().into_bytes(), binary.to_vec());
    json.resize(json.len().next_multiple_of(4), b' ');
    binary.resize(binary.len().next_multiple_of(4), 0);
    let mut out = b"glTF\x02\0\0\0".to_vec();
    out.extend((12 + 8 + json.len() as u32 + 8 + binary.len() as u32).to_le_bytes());
    out.extend((json.len() as u32).to_le_bytes());
    out.extend(b"JSON");
    out.extend(json);
    out.extend((binary.len() as u32).to_le_bytes());
    out.extend(b"BIN\0");
    out.extend(binary);
    out
}

pub(crate) const TRIANGLE: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

/// A node with a mesh of one primitive.
pub(crate) fn single(primitive: Value) -> Value {
    json!({"nodes": [{"mesh": 0}], "meshes": [{"primitives": [primitive]}]})
}

/// A triangle whose material is the only one, with further parts of the document.
fn with_material(attributes: Value, material: Value, rest: Value) -> Value {
    let mut document = single(json!({"attributes": attributes, "material": 0}));
    let Value::Object(rest) = rest else { panic!("an object") };
    document["materials"] = json!([material]);
    document.as_object_mut().unwrap().extend(rest);
    document
}

#[test]
fn transforms_multiply_down_the_hierarchy() {
    let mut builder = Builder::default();
    let (positions, normals) = (builder.floats(&TRIANGLE), builder.floats(&[[0.0, 0.6, 0.8]; 3]));
    let half_turn = std::f64::consts::FRAC_1_SQRT_2;
    let mesh = builder
        .load(json!({
            "scene": 1,
            "scenes": [{"nodes": [3]}, {"nodes": [0]}],
            "nodes": [
                {"translation": [10, 0, 0], "children": [1]},
                {"rotation": [0, 0, half_turn, half_turn], "children": [2]},
                {"matrix": [2, 0, 0, 0,  0, 1, 0, 0,  0, 0, 1, 0,  0, 0, 5, 1], "mesh": 0},
                {"mesh": 0},
            ],
            "meshes": [{"primitives": [{"attributes": {"POSITION": positions, "NORMAL": normals}}]}],
        }))
        .unwrap();
    let expected = [[10.0, 0.0, 5.0], [10.0, 2.0, 5.0], [9.0, 0.0, 5.0]];
    for (position, expected) in mesh.positions.iter().zip(expected) {
        // The rotation is stored in f32.
        assert!((0..3).all(|i| (position[i] - expected[i]).abs() < 1e-6), "{position:?}");
    }
    assert_near(&mesh.normals[0], &[-0.6, 0.0, 0.8], 1e-6);
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
}

#[test]
fn normals_follow_the_inverse_transpose() {
    let mut builder = Builder::default();
    let diagonal = std::f32::consts::FRAC_1_SQRT_2;
    let (positions, normals) = (builder.floats(&TRIANGLE), builder.floats(&[[diagonal, diagonal, 0.0]; 3]));
    let attributes = json!({"attributes": {"POSITION": positions, "NORMAL": normals}});
    for (scale, expected) in [([4.0, 1.0, 1.0], [1.0, 4.0]), ([-4.0, 1.0, 1.0], [-1.0, 4.0])] {
        let mut document = single(attributes.clone());
        document["nodes"][0]["scale"] = json!(scale);
        let mesh = builder.load(document).unwrap();
        let length = 17_f32.sqrt();
        assert_near(&mesh.normals[0], &[expected[0] / length, expected[1] / length, 0.0], 1e-6);
        assert_eq!(mesh.triangles, [if scale[0] < 0.0 { [0, 2, 1] } else { [0, 1, 2] }], "a mirror turns faces over");
    }
}

#[test]
fn scenes_or_all_roots() {
    let mut builder = Builder::default();
    let positions = builder.floats(&TRIANGLE);
    let base = json!({
        "nodes": [{"mesh": 0, "children": [1]}, {"mesh": 0}, {"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": positions}}, {"attributes": {"POSITION": positions}}]}],
    });
    for (scenes, triangles) in [
        (json!({}), 6),
        (json!({"scenes": [{"nodes": [2]}, {"nodes": [0]}]}), 2),
        (json!({"scene": 0, "scenes": [{"nodes": [0, 1]}]}), 4),
    ] {
        let mut document = base.clone();
        document.as_object_mut().unwrap().extend(scenes.as_object().unwrap().clone());
        let mesh = builder.load(document).unwrap();
        assert_eq!((mesh.triangles.len(), mesh.positions.len()), (triangles, 3 * triangles));
        assert_eq!(mesh.triangles[1], [3, 4, 5]);
    }
}

#[test]
fn index_types_and_topologies() {
    let mut builder = Builder::default();
    let positions = builder.floats(&[[0.0; 3], [1.0; 3], [2.0; 3], [3.0; 3], [4.0; 3]]);
    let bytes = builder.accessor("SCALAR", 5121, 3, &[4, 0, 2]);
    let shorts = builder.accessor("SCALAR", 5123, 3, &[4, 0, 0, 0, 2, 0]);
    let words = builder.accessor("SCALAR", 5125, 3, &[4, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0]);
    for indices in [bytes, shorts, words] {
        let mesh = builder.load(single(json!({"attributes": {"POSITION": positions}, "indices": indices}))).unwrap();
        assert_eq!(mesh.triangles, [[4, 0, 2]]);
    }
    for (mode, expected) in
        [(4, vec![[0, 1, 2]]), (5, vec![[0, 1, 2], [1, 3, 2], [2, 3, 4]]), (6, vec![[1, 2, 0], [2, 3, 0], [3, 4, 0]])]
    {
        let mesh = builder.load(single(json!({"attributes": {"POSITION": positions}, "mode": mode}))).unwrap();
        assert_eq!(mesh.triangles, expected, "mode {mode}");
    }
    for mode in 0..4 {
        let document = json!({
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [
                {"attributes": {"POSITION": positions}, "mode": mode}, {"attributes": {"POSITION": positions}, "indices": bytes},
            ]}],
        });
        let mesh = builder.load(document).unwrap();
        assert_eq!((mesh.triangles.len(), mesh.positions.len()), (1, 5), "points and lines are passed over");
    }
}

#[test]
fn interleaved_sparse_and_quantized_attributes() {
    let mut builder = Builder::default();
    // Positions as normalised shorts and normals as normalised bytes, 12 bytes a vertex.
    let mut bytes = Vec::new();
    for i in 0..3_i16 {
        for value in [i * 10_000, -32768, 32767] {
            bytes.extend(value.to_le_bytes());
        }
        bytes.extend([0, 0, 0, 0, 127, 0]);
    }
    let view = builder.view(&bytes);
    let positions = builder.raw_accessor(
        json!({"bufferView": view, "componentType": 5122, "normalized": true, "count": 3, "type": "VEC3"}),
    );
    let normals = builder.raw_accessor(json!({"bufferView": view, "byteOffset": 8, "componentType": 5120, "normalized": true, "count": 3, "type": "VEC3"}));
    let indices = builder.view(&[1, 0, 2, 0]);
    let values = builder.view(&[0.25_f32, 0.5, 0.75, 1.0].map(f32::to_le_bytes).concat());
    let uvs = builder.raw_accessor(json!({"componentType": FLOAT, "count": 3, "type": "VEC2", "sparse": {
        "count": 2, "indices": {"bufferView": indices, "componentType": 5123}, "values": {"bufferView": values}}}));
    let mut document =
        builder.json(single(json!({"attributes": {"POSITION": positions, "NORMAL": normals, "TEXCOORD_0": uvs}})));
    document["bufferViews"][view]["byteStride"] = json!(12);
    document["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let mesh = mesh("glb", glb(&document, &builder.bytes)).unwrap();
    assert_eq!(mesh.positions[1], [10_000.0 / 32_767.0, -1.0, 1.0]);
    assert_eq!(mesh.normals, [[0.0, 0.0, 1.0]; 3]);
    assert_eq!(mesh.uvs, [[0.0, 0.0], [0.25, 0.5], [0.75, 1.0]]);
}

#[test]
fn missing_parts_of_a_merged_mesh_are_marked() {
    let mut builder = Builder::default();
    let (positions, normals) = (builder.floats(&TRIANGLE), builder.floats(&[[0.0, 0.0, 1.0]; 3]));
    let document = json!({
        "nodes": [{"mesh": 0}],
        "materials": [{}],
        "meshes": [{"primitives": [
            {"attributes": {"POSITION": positions}, "material": 0},
            {"attributes": {"POSITION": positions, "NORMAL": normals, "_CUSTOM": normals, "TANGENT": normals}},
        ]}],
    });
    let mesh = builder.load(document).unwrap();
    assert_eq!(mesh.normals[2..4], [[0.0; 3], [0.0, 0.0, 1.0]]);
    assert_eq!(mesh.albedo[2], [1.0; 3], "a material without a base colour is white");
    assert!(mesh.albedo[3][0].is_nan() && mesh.uvs.is_empty());
}

#[test]
fn factor_times_vertex_colour() {
    let mut builder = Builder::default();
    let positions = builder.floats(&TRIANGLE);
    let colors = builder.accessor("VEC4", 5121, 3, &[255, 51, 0, 9, 255, 255, 255, 0, 0, 0, 0, 255]);
    let attributes = json!({"POSITION": positions, "COLOR_0": colors});
    let material = json!({"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 2.0, 0.1]}});
    let albedo = builder.load(with_material(attributes.clone(), material, json!({}))).unwrap().albedo;
    assert_near(albedo.as_flattened(), &[0.5, 0.1, 0.0, 0.5, 0.5, 1.0, 0.0, 0.0, 0.0], 1e-7);
    let plain = builder.load(single(json!({"attributes": attributes}))).unwrap().albedo;
    assert_near(&plain[0], &[1.0, 0.2, 0.0], 1e-7);
    let old = json!({"extensions": {"KHR_materials_pbrSpecularGlossiness": {"diffuseFactor": [0.25, 0.5, 1.0, 1.0]}}});
    let albedo = builder.load(with_material(json!({"POSITION": positions}), old, json!({}))).unwrap().albedo;
    assert_eq!(albedo, [[0.25, 0.5, 1.0]; 3]);
}

/// A PNG of 2 × 2 texels: red, green; blue, grey of half the display range.
pub(crate) fn checker_png() -> Vec<u8> {
    let pixels = [[255, 0, 0], [0, 255, 0], [0, 0, 255], [128, 128, 128]];
    let image = image::RgbImage::from_raw(2, 2, pixels.concat()).unwrap();
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// Albedo at three texture coordinates under a sampler and further properties of the texture's use.
fn sampled(uvs: [[f32; 2]; 3], sampler: Value, info: Value) -> Vec<[f32; 3]> {
    let mut builder = Builder::default();
    let (positions, uvs) = (builder.floats(&TRIANGLE), builder.floats(&uvs));
    let png = builder.view(&checker_png());
    let mut info = info;
    info["index"] = json!(0);
    let document = with_material(
        json!({"POSITION": positions, "TEXCOORD_0": uvs, "TEXCOORD_1": uvs}),
        json!({"pbrMetallicRoughness": {"baseColorTexture": info}}),
        json!({
            "textures": [{"source": 0, "sampler": 0}], "samplers": [sampler],
            "images": [{"bufferView": png, "mimeType": "image/png"}],
            "extensionsRequired": ["KHR_texture_transform"],
        }),
    );
    builder.load(document).unwrap().albedo
}

#[test]
fn textures_are_sampled_in_linear_light_with_the_samplers_wrap() {
    let gray = srgb(128.0 / 255.0);
    let centers = sampled([[0.25, 0.25], [0.75, 0.25], [0.75, 0.75]], json!({}), json!({}));
    assert_near(centers.as_flattened(), &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, gray, gray, gray], 1e-6);
    let middle = sampled([[0.5, 0.25], [0.5, 0.5], [f32::NAN, 0.0]], json!({}), json!({"texCoord": 1}));
    assert_near(&middle[0], &[0.5, 0.5, 0.0], 1e-6);
    assert_near(&middle[1], &[(1.0 + gray) / 4.0; 3], 1e-6);
    assert_eq!(middle[2], [1.0; 3], "no texture where there is no coordinate");
    // At the corner, repeating mixes all four texels, clamping and mirroring give the corner's.
    let corner = [[0.0, 0.0], [1.25, 0.25], [-0.25, 0.25]];
    let mean = [(1.0 + gray) / 4.0; 3];
    for (mode, expected) in [
        (10_497, [mean, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]),
        (33_071, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]),
        (33_648, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]),
    ] {
        let colors = sampled(corner, json!({"wrapS": mode, "wrapT": mode, "magFilter": 9728}), json!({}));
        assert_near(colors.as_flattened(), expected.as_flattened(), 1e-6);
    }
    let far = sampled([[1e30, 1e-30], [-1e9, 0.25], [3.25, 0.25]], json!({"wrapS": 33_648}), json!({}));
    assert_near(&far[2], &[0.0, 1.0, 0.0], 1e-6);
}

#[test]
fn texture_transforms() {
    let transform = |value: Value| json!({"extensions": {"KHR_texture_transform": value}, "texCoord": 7});
    let moved = transform(json!({"offset": [0.5, 0.0], "scale": [0.25, 0.25], "texCoord": 0}));
    assert_near(&sampled([[1.0, 1.0]; 3], json!({}), moved)[0], &[0.0, 1.0, 0.0], 1e-6);
    // A quarter turn counter-clockwise, v running down, takes (0.75, 0.25) to (0.25, −0.75), which wraps to (0.25, 0.25).
    let turned = transform(json!({"rotation": std::f64::consts::FRAC_PI_2, "texCoord": 1}));
    assert_near(&sampled([[0.75, 0.25]; 3], json!({}), turned)[0], &[1.0, 0.0, 0.0], 1e-5);
}

#[test]
fn data_uris_and_files_beside() {
    let mut builder = Builder::default();
    let (positions, uvs) = (builder.floats(&TRIANGLE), builder.floats(&[[0.75, 0.25]; 3]));
    let rest = with_material(
        json!({"POSITION": positions, "TEXCOORD_0": uvs}),
        json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}),
        json!({"textures": [{"source": 0}], "images": [{"uri": "tex%20ture.png"}]}),
    );
    let mut document = builder.json(rest);
    document["buffers"][0]["uri"] = json!("sub/data%2Ebin");
    let scratch = Scratch::new();
    std::fs::create_dir(scratch.path().join("sub")).unwrap();
    scratch.write("sub/data.bin", &builder.bytes);
    scratch.write("tex ture.png", checker_png());
    let beside = load_mesh(&scratch.write("test.gltf", document.to_string())).unwrap();
    assert_eq!(beside.albedo, [[0.0, 1.0, 0.0]; 3]);

    let hex = checker_png().iter().fold(String::new(), |mut text, byte| {
        write!(text, "%{byte:02x}").unwrap();
        text
    });
    document["images"][0]["uri"] = json!(format!("data:image/png,{hex}"));
    document["buffers"][0]["uri"] = json!(format!("data:application/octet-stream;base64,{}", base64(&builder.bytes)));
    assert_eq!(mesh("gltf", document.to_string()).unwrap(), beside);
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for group in bytes.chunks(3) {
        let bits = (0..3).fold(0_usize, |bits, i| bits << 8 | usize::from(group.get(i).copied().unwrap_or(0)));
        (0..4).for_each(|i| text.push(if i <= group.len() { DIGITS[bits >> (18 - 6 * i) & 63].into() } else { '=' }));
    }
    text
}

#[test]
fn morph_targets_at_their_default_weights() {
    let mut builder = Builder::default();
    let positions = builder.floats(&TRIANGLE);
    let normals = builder.floats(&[[0.0, 0.0, 1.0]; 3]);
    let (up, side) = (builder.floats(&[[0.0, 0.0, 2.0]; 3]), builder.floats(&[[1.0, 0.0, 0.0]; 3]));
    let mut document = single(json!({
        "attributes": {"POSITION": positions, "NORMAL": normals},
        "targets": [{"POSITION": up}, {"POSITION": side, "NORMAL": side}],
    }));
    assert_eq!(builder.load(document.clone()).unwrap().positions[0], [0.0, 0.0, 0.0]);
    document["meshes"][0]["weights"] = json!([0.5, 0.0]);
    assert_eq!(builder.load(document.clone()).unwrap().positions[1], [1.0, 0.0, 1.0]);
    document["nodes"][0]["weights"] = json!([0.25, 1.0]);
    let mesh = builder.load(document).unwrap();
    assert_eq!(mesh.positions[1], [2.0, 0.0, 0.5]);
    let diagonal = std::f32::consts::FRAC_1_SQRT_2;
    assert_near(&mesh.normals[1], &[diagonal, 0.0, diagonal], 1e-6);
}

/// Two joints along x, the second turned by a quarter; weights that do not add up to one, and a vertex without any.
#[test]
fn skins_in_their_rest_pose() {
    let mut builder = Builder::default();
    let positions = builder.floats(&[[2.0, 0.0, 0.0]; 3]);
    let normals = builder.floats(&[[1.0, 0.0, 0.0]; 3]);
    let joints = builder.accessor("VEC4", 5121, 3, &[0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0]);
    let weights = builder.floats(&[[1.0, 1.0, 0.0, 0.0], [3.0, 0.0, 0.0, 0.0], [0.0; 4]]);
    let identity = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let mut back = identity;
    back[12] = -1.0;
    let inverse_bind = builder.floats::<16>(&[identity, back]);
    let half_turn = std::f64::consts::FRAC_1_SQRT_2;
    let document = json!({
        "nodes": [
            {"mesh": 0, "skin": 0, "translation": [100, 100, 100]},
            {"children": [2], "translation": [0, 0, 3]},
            {"translation": [1, 0, 0], "rotation": [0, 0, half_turn, half_turn]},
        ],
        "skins": [{"joints": [1, 2], "inverseBindMatrices": inverse_bind}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": positions, "NORMAL": normals, "JOINTS_0": joints, "WEIGHTS_0": weights}}]}],
    });
    let mesh = builder.load(document).unwrap();
    // Joint 1 alone leaves the vertex at (2, 0, 3); joint 2 alone turns it about (1, 0) to (1, 1, 3).
    let expected = [[1.5, 0.5, 3.0], [1.0, 1.0, 3.0], [1.0, 1.0, 3.0]];
    for (position, expected) in mesh.positions.iter().zip(expected) {
        assert!((0..3).all(|i| (position[i] - expected[i]).abs() < 1e-6), "{position:?}");
    }
    assert_near(&mesh.normals[1], &[0.0, 1.0, 0.0], 1e-6);
}

#[test]
fn oddities_that_exporters_write() {
    let mut builder = Builder::default();
    let positions = builder.floats(&TRIANGLE);
    let mut document = single(json!({"attributes": {"POSITION": positions}, "extras": "text"}));
    document["extras"] = json!([1, "two"]);
    document["cameras"] = json!([]);
    document["extensionsUsed"] = json!(["VENDOR_unknown"]);
    document["extensionsRequired"] = json!(["KHR_materials_unlit", "KHR_lights_punctual"]);
    let mut bytes = builder.glb(document);
    bytes.extend(b"trailing bytes");
    assert_eq!(mesh("glb", &bytes).unwrap().triangles.len(), 1);
    assert_eq!(mesh("gltf", &bytes).unwrap().triangles.len(), 1, "the contents decide, not the extension");
}
