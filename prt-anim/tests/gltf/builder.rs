//! Documents built as JSON with a buffer of little-endian numbers.

use std::path::PathBuf;

use prt_anim::{Character, Error, load_character};
use serde_json::{Value, json};

/// A document in the making.
#[derive(Default)]
pub(crate) struct Builder {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Builder {
    pub(crate) fn view(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.push(json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()}));
        self.bytes.extend(bytes);
        self.views.len() - 1
    }

    pub(crate) fn accessor(&mut self, kind: &str, component: u32, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        self.raw(json!({"bufferView": view, "componentType": component, "count": count, "type": kind}))
    }

    pub(crate) fn raw(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    pub(crate) fn floats<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let kind = ["SCALAR", "SCALAR", "VEC2", "VEC3", "VEC4"].get(N).copied().unwrap_or("MAT4");
        let bytes: Vec<u8> = values.as_flattened().iter().flat_map(|value| value.to_le_bytes()).collect();
        self.accessor(kind, 5126, values.len(), &bytes)
    }

    /// The whole document; `rest` holds everything but asset, buffers, views and accessors.
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

    pub(crate) fn glb(&self, document: &Value) -> Vec<u8> {
        let (mut json, mut binary) = (document.to_string().into_bytes(), self.bytes.clone());
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

    pub(crate) fn load(&self, rest: Value) -> Result<Character, Error> {
        load_bytes(&self.glb(&self.json(rest)))
    }
}

thread_local! {
    /// One folder for each test's thread: making one takes longer than reading a small file.
    static SCRATCH: tempfile::TempDir = tempfile::tempdir().unwrap();
}

/// Writes a file that lives as long as its thread.
pub(crate) fn write(name: &str, bytes: &[u8]) -> PathBuf {
    SCRATCH.with(|folder| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    })
}

pub(crate) fn load_bytes(bytes: &[u8]) -> Result<Character, Error> {
    load_character(&write("test.glb", bytes))
}

pub(crate) const TRIANGLE: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

/// Two joints, a skin, a rigid part, a morph target, and a clip with all interpolations.
pub(crate) fn rich() -> (Builder, Value) {
    let mut builder = Builder::default();
    let (positions, normals) = (builder.floats(&TRIANGLE), builder.floats(&[[0.0, 0.0, 1.0]; 3]));
    let joints = builder.accessor("VEC4", 5121, 3, &[0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0]);
    let weights = builder.floats(&[[0.5, 0.5, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [2.0, 0.0, 0.0, 0.0]]);
    let mut up = [0.0; 16];
    [0, 5, 10, 15].iter().for_each(|&i| up[i] = 1.0);
    let matrices = builder.floats::<16>(&[up; 2]);
    let indices = builder.accessor("SCALAR", 5123, 3, &[0, 0, 1, 0, 2, 0]);
    let times = builder.floats(&[[0.0], [1.0]]);
    let shifts = builder.floats(&[[0.0; 3], [0.0, 2.0, 0.0]]);
    let turns = builder.floats(&[[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 1.0, 0.0]]);
    let scales = builder.floats(&[[0.0; 3], [1.0; 3], [0.0; 3], [0.0; 3], [3.0; 3], [0.0; 3]]);
    let fades = builder.floats(&[[0.0], [1.0]]);
    let rest = json!({
        "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [
            {"mesh": 0, "skin": 0, "translation": [9, 9, 9]},
            {"name": "hip", "children": [2], "translation": [1, 2, 3]},
            {"name": "hand", "mesh": 1, "rotation": [0, 0, 0, 1]},
        ],
        "skins": [{"joints": [1, 2], "inverseBindMatrices": matrices}],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 2.0, 1.0]}}],
        "meshes": [
            {"primitives": [{
                "attributes": {"POSITION": positions, "NORMAL": normals, "JOINTS_0": joints, "WEIGHTS_0": weights},
                "indices": indices, "material": 0, "targets": [{"POSITION": positions}],
            }]},
            {"primitives": [{"attributes": {"POSITION": positions}}]},
        ],
        "animations": [{"name": "all", "samplers": [
            {"input": times, "output": shifts},
            {"input": times, "output": turns, "interpolation": "STEP"},
            {"input": times, "output": scales, "interpolation": "CUBICSPLINE"},
            {"input": times, "output": fades},
        ], "channels": [
            {"sampler": 0, "target": {"node": 1, "path": "translation"}},
            {"sampler": 1, "target": {"node": 2, "path": "rotation"}},
            {"sampler": 2, "target": {"node": 2, "path": "scale"}},
            {"sampler": 3, "target": {"node": 0, "path": "weights"}},
        ]}],
    });
    (builder, rest)
}
