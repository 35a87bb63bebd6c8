//! Documents with one fault each.

use std::path::Path;

use prt_anim::{Error, load_character};
use serde_json::{Value, json};

use crate::builder::{load_bytes, rich, write};

#[track_caller]
fn refuse(words: &str, change: impl Fn(&mut Value)) {
    let (builder, rest) = rich();
    let mut document = builder.json(rest);
    change(&mut document);
    let Err(error) = load_bytes(&builder.glb(&document)) else { panic!("accepted: {words}") };
    let message = error.to_string();
    assert!(message.contains("test.glb") && message.contains(words), "expected `{words}` in: {message}");
    assert!(!message.ends_with('.') && !message.contains('\n'), "{message}");
}

#[test]
fn references_to_nothing() {
    refuse("skin 7, which is not there", |d| d["nodes"][0]["skin"] = 7.into());
    refuse("mesh 7, which is not there", |d| d["nodes"][0]["mesh"] = 7.into());
    refuse("node 7, which is not there", |d| d["skins"][0]["joints"] = json!([1, 7]));
    refuse("node 7, which is not there", |d| d["scenes"][0]["nodes"] = json!([7]));
    refuse("scene 7, which is not there", |d| d["scene"] = 7.into());
    refuse("material 7, which is not there", |d| d["meshes"][0]["primitives"][0]["material"] = 7.into());
    refuse("accessor 77, which is not there", |d| d["skins"][0]["inverseBindMatrices"] = 77.into());
    refuse("node 1 has a child 7, which is not there", |d| d["nodes"][1]["children"] = json!([7]));
    refuse("animation 0, channel 1: it refers to sampler 9", |d| {
        d["animations"][0]["channels"][1]["sampler"] = 9.into();
    });
    refuse("animation 0, channel 0: it refers to node 9", |d| {
        d["animations"][0]["channels"][0]["target"]["node"] = 9.into();
    });
}

#[test]
fn nodes_that_are_no_trees() {
    refuse("node 2 has two parents", |d| d["nodes"][0]["children"] = json!([2]));
    refuse("cycle", |d| d["nodes"][2]["children"] = json!([1]));
    refuse("shear in the matrix of node 1", |d| {
        d["nodes"][1] = json!({"matrix": [1, 0, 0, 0, 0.5, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]});
    });
    refuse("node 2 has a rotation of length zero", |d| d["nodes"][2]["rotation"] = json!([0, 0, 0, 0]));
}

#[test]
fn skins_that_do_not_fit() {
    refuse("follows joint 1 of a skin of 1 joints", |d| d["skins"][0]["joints"] = json!([1]));
    refuse("skin 0 has 3 joints and 2 inverse bind matrices", |d| d["skins"][0]["joints"] = json!([0, 1, 2]));
    refuse("joints that are not whole numbers", |d| {
        d["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] = 3.into();
    });
    refuse("has elements of type", |d| d["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] = 0.into());
    refuse("has an attribute of 2", |d| d["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = 7.into());
    refuse("rests at a position that is not finite", |d| d["nodes"][1]["translation"] = json!([1e39, 0, 0]));
}

#[test]
fn lies_about_sizes() {
    refuse("claims 4000000000000 elements", |d| d["accessors"][0]["count"] = json!(4_000_000_000_000_u64));
    refuse("accessor 0 needs more bytes than its buffer view has", |d| d["accessors"][0]["count"] = 4.into());
    refuse("buffer view 0 claims 99999 bytes", |d| d["bufferViews"][0]["byteLength"] = 99999.into());
    refuse("buffer 0 claims 99999 bytes", |d| d["buffers"][0]["byteLength"] = 99999.into());
    // The number 1.0 of a position, 0x3f80 in its upper half.
    refuse("a primitive of 3 vertices refers to vertex 16256", |d| {
        d["accessors"][5] = json!({"bufferView": 0, "componentType": 5123, "count": 18, "type": "SCALAR"});
    });
}

#[test]
fn animations_that_do_not_fit() {
    let sampler = |d: &mut Value, i: usize, what: &str, value: Value| d["animations"][0]["samplers"][i][what] = value;
    refuse("2 times have 2 values; 3 for each", |d| sampler(d, 0, "interpolation", "CUBICSPLINE".into()));
    refuse("channel 1: accessor 7 has elements of type Vec3", |d| sampler(d, 1, "output", 7.into()));
    refuse("unknown interpolation", |d| sampler(d, 1, "interpolation", "QUINTIC".into()));
    refuse("channel 0: accessor 7 has elements", |d| sampler(d, 0, "input", 7.into()));
    refuse("key 1 is earlier than key 0", |d| {
        // The times 0 and 1 from the other end of the data: 1.0 stands in the x of the second position, followed by zeros.
        d["bufferViews"].as_array_mut().unwrap().push(json!({"buffer": 0, "byteOffset": 12, "byteLength": 8}));
        let view = d["bufferViews"].as_array().unwrap().len() - 1;
        d["accessors"]
            .as_array_mut()
            .unwrap()
            .push(json!({"bufferView": view, "componentType": 5126, "count": 2, "type": "SCALAR"}));
        let accessor = d["accessors"].as_array().unwrap().len() - 1;
        sampler(d, 0, "input", accessor.into());
    });
    refuse("its times are not floating-point", |d| {
        d["accessors"]
            .as_array_mut()
            .unwrap()
            .push(json!({"bufferView": 5, "componentType": 5123, "count": 2, "type": "SCALAR"}));
        let accessor = d["accessors"].as_array().unwrap().len() - 1;
        sampler(d, 0, "input", accessor.into());
    });
    refuse("unknown property", |d| d["animations"][0]["channels"][0]["target"]["path"] = "colour".into());
}

/// A hundred bytes that would become gigabytes.
#[test]
fn repetition_is_limited() {
    refuse("repeats its meshes", |d| {
        d["accessors"][0] = json!({"componentType": 5126, "count": 100, "type": "VEC3"});
        d["meshes"] = json!([{"primitives": vec![json!({"attributes": {"POSITION": 0}}); 300]}]);
        d["nodes"] = json!(vec![json!({"mesh": 0}); 300]);
        d["scenes"] = json!([{"nodes": (0..300).collect::<Vec<_>>()}]);
        d["animations"] = json!([]);
        d["skins"] = json!([]);
    });
    refuse("clips whose channels share their data", |d| {
        d["accessors"][6] = json!({"componentType": 5126, "count": 300, "type": "SCALAR"});
        d["accessors"][7] = json!({"componentType": 5126, "count": 300, "type": "VEC3"});
        let channel = d["animations"][0]["channels"][0].clone();
        d["animations"][0]["channels"] = json!(vec![channel; 8000]);
    });
}

#[test]
fn files_that_are_none() {
    let error = load_character(Path::new("/nowhere/x.glb")).unwrap_err();
    assert!(matches!(error, Error::Io { .. }) && error.to_string().contains("/nowhere/x.glb"), "{error}");
    let folder = write("test.bin", b"");
    let error = load_character(folder.parent().unwrap()).unwrap_err();
    assert!(matches!(error, Error::Io { .. }), "{error}");
    for bytes in [&b""[..], b"glTF", b"{", b"solid", b"glTF\x01\0\0\0\x0c\0\0\0"] {
        load_bytes(bytes).unwrap_err();
    }
    refuse("holds no faces (and 0 vertices)", |d| d["scenes"] = json!([{"nodes": []}]));
    refuse("KHR_draco_mesh_compression, which the file requires", |d| {
        d["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    });
    refuse("glTF version `1.0` is not supported", |d| d["asset"]["version"] = "1.0".into());
}
