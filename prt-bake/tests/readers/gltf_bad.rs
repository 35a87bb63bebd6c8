//! glTF that lies, is damaged or asks for what is not read.

use serde_json::{Value, json};

use crate::gltf::{Builder, FLOAT, TRIANGLE, checker_png, glb, single};
use crate::scratch::{assert_refused, mesh};

/// A triangle whose document is changed before it is written.
fn changed(change: impl FnOnce(&mut Value)) -> Vec<u8> {
    let mut builder = Builder::default();
    let positions = builder.floats(&TRIANGLE);
    let indices = builder.accessor("SCALAR", 5121, 3, &[0, 1, 2]);
    let mut document = builder.json(single(json!({"attributes": {"POSITION": positions}, "indices": indices})));
    change(&mut document);
    glb(&document, &builder.bytes)
}

#[track_caller]
fn assert_change_refused(change: impl FnOnce(&mut Value), words: &str) {
    assert_refused(mesh("glb", changed(change)), words);
}

#[test]
fn containers() {
    let good = changed(|_| ());
    let with = |at: usize, bytes: &[u8]| {
        let mut bad = good.clone();
        bad[at..at + bytes.len()].copy_from_slice(bytes);
        bad
    };
    assert_refused(mesh("glb", ""), "it is empty");
    assert_refused(mesh("glb", "glTF"), "ends within a chunk's header");
    assert_refused(mesh("glb", with(4, &[1])), "version 1 of binary glTF is not supported");
    assert_refused(mesh("glb", with(8, &[255; 4])), "its header claims 4294967295 bytes");
    assert_refused(mesh("glb", with(8, &[0; 4])), "its header claims 0 bytes");
    assert_refused(mesh("glb", with(12, &[255; 4])), "the JSON chunk claims 4294967295 bytes");
    assert_refused(mesh("glb", with(16, b"BIN\0")), "there is no JSON chunk at byte 12");
    let json_length = u32::from_le_bytes(good[12..16].try_into().unwrap()) as usize;
    assert_refused(mesh("glb", with(20 + json_length, &[255, 255, 255, 0])), "the BIN chunk claims 16777215 bytes");
    assert_refused(mesh("glb", &good[..good.len() - 1]), "its header claims");
    assert_refused(mesh("gltf", "{"), "EOF while parsing");
    assert_refused(mesh("gltf", b"{\"asset\": \"\xff\"}"), "is not a valid glTF file");
    assert_refused(mesh("gltf", "[".repeat(100_000)), "is not a valid glTF file");
    assert_refused(
        mesh("gltf", r#"{"asset": {"version": "1.0"}, "nodes": {"a": {}}}"#),
        "glTF version `1.0` is not supported",
    );
    assert_refused(mesh("gltf", r#"{"asset": {"version": "3.1"}}"#), "glTF version `3.1` is not supported");
    assert_refused(mesh("gltf", r#"{"asset": {"version": "2.0"}}"#), "holds no faces");
}

#[test]
fn extensions() {
    for name in
        ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "EXT_mesh_gpu_instancing", "KHR_texture_basisu"]
    {
        let words = format!("the glTF extension {name}, which the file requires, is not supported");
        assert_change_refused(|document| document["extensionsRequired"] = json!([name]), &words);
    }
    assert_change_refused(
        |document| {
            document["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
            document["accessors"][0].as_object_mut().unwrap().remove("bufferView");
        },
        "the glTF extension KHR_draco_mesh_compression is not supported",
    );
    assert_change_refused(
        |document| {
            document["extensionsUsed"] = json!(["EXT_meshopt_compression"]);
            document["buffers"].as_array_mut().unwrap().push(json!({"byteLength": 36}));
            document["bufferViews"][0]["buffer"] = json!(1);
        },
        "the glTF extension EXT_meshopt_compression is not supported",
    );
}

#[test]
fn hierarchies() {
    assert_change_refused(
        |document| document["nodes"] = json!([{"children": [1]}, {"children": [2]}, {"children": [1], "mesh": 0}]),
        "node 1 has two parents",
    );
    assert_change_refused(
        |document| document["nodes"] = json!([{}, {"children": [2]}, {"children": [1], "mesh": 0}]),
        "node 1 is its own ancestor",
    );
    assert_change_refused(
        |document| document["nodes"] = json!([{"children": [0], "mesh": 0}]),
        "node 0 is its own ancestor",
    );
    assert_change_refused(|document| document["nodes"][0]["children"] = json!([7]), "node 0 has a child 7");
    assert_change_refused(
        |document| document["nodes"][0]["rotation"] = json!([0, 0, 0, 0]),
        "a rotation of length zero",
    );
    assert_change_refused(|document| document["scenes"] = json!([{"nodes": [9]}]), "it refers to node 9");
    assert_change_refused(|document| document["scene"] = json!(3), "it refers to scene 3");
    let chain = |length: usize| -> Value {
        (0..length).map(|i| if i + 1 < length { json!({"children": [i + 1]}) } else { json!({"mesh": 0}) }).collect()
    };
    assert_change_refused(|document| document["nodes"] = chain(100_000), "more than 4096 nodes one below the other");
    assert_eq!(mesh("glb", changed(|document| document["nodes"] = chain(4096))).unwrap().triangles.len(), 1);
}

#[test]
fn references_and_ranges() {
    type Change = fn(&mut Value);
    let changes: [(Change, &str); 21] = [
        (|d| d["nodes"][0]["mesh"] = json!(1), "it refers to mesh 1"),
        (|d| d["nodes"][0]["skin"] = json!(0), "it refers to skin 0"),
        (|d| d["meshes"][0]["primitives"][0]["material"] = json!(4), "it refers to material 4"),
        (|d| d["meshes"][0]["primitives"][0]["indices"] = json!(2), "it refers to accessor 2"),
        (|d| d["meshes"][0]["primitives"][0]["attributes"] = json!({"NORMAL": 0}), "a primitive has no positions"),
        (
            |d| d["meshes"][0]["primitives"][0]["attributes"] = json!({"POSITION": 1}),
            "accessor 1 has elements of type Scalar",
        ),
        (|d| d["meshes"][0]["primitives"][0]["indices"] = json!(0), "accessor 0 has elements of type Vec3"),
        (|d| d["meshes"][0]["primitives"][0]["mode"] = json!(9), "unknown mode"),
        (|d| d["accessors"][0]["bufferView"] = json!(5), "it refers to buffer view 5"),
        (|d| d["accessors"][0]["count"] = json!(4), "accessor 0 needs more bytes than its buffer view has (36)"),
        (|d| d["accessors"][0]["count"] = json!(4_000_000_000_u32), "accessor 0 claims 4000000000 elements"),
        (|d| d["accessors"][0]["count"] = json!(u64::MAX), "accessor 0 claims 18446744073709551615 elements"),
        (|d| d["accessors"][0]["byteOffset"] = json!(u64::MAX), "accessor 0 needs more bytes"),
        (|d| d["accessors"][0]["componentType"] = json!(5127), "accessor 0 has an unknown component type"),
        (|d| d["accessors"][0]["type"] = json!("VEC9"), "accessor 0 has an unknown type"),
        (|d| d["accessors"][1]["componentType"] = json!(5126), "accessor 1 needs more bytes"),
        (
            |d| d["bufferViews"][0]["byteOffset"] = json!(u64::MAX),
            "buffer view 0 claims 36 bytes from byte 18446744073709551615",
        ),
        (
            |d| d["bufferViews"][0]["byteLength"] = json!(40),
            "buffer view 0 claims 40 bytes from byte 0 of a buffer of 40",
        ),
        (|d| d["bufferViews"][0]["buffer"] = json!(1), "it refers to buffer 1"),
        (|d| d["bufferViews"][0]["byteStride"] = json!(4), "elements of 12 bytes at a distance of 4"),
        (|d| d["buffers"][0]["byteLength"] = json!(1_000_000), "buffer 0 claims 1000000 bytes and has"),
    ];
    for (change, words) in changes {
        if words.contains("claims 40 bytes") {
            // One byte more than the buffer has, counting its padding.
            assert_change_refused(
                |d| d["bufferViews"][0]["byteLength"] = json!(41),
                "claims 41 bytes from byte 0 of a buffer of 40",
            );
        } else {
            assert_change_refused(change, words);
        }
    }
    let mut builder = Builder::default();
    let positions = builder.floats(&TRIANGLE);
    let indices = builder.accessor("SCALAR", 5121, 3, &[0, 1, 3]);
    let primitive = json!({"attributes": {"POSITION": positions}, "indices": indices});
    assert_refused(builder.load(single(primitive)), "a primitive of 3 vertices refers to vertex 3");
    let short = builder.floats(&[[0.0; 3]; 2]);
    let primitive = json!({"attributes": {"POSITION": positions, "NORMAL": short}});
    assert_refused(builder.load(single(primitive)), "a primitive of 3 vertices has an attribute of 2");
}

#[test]
fn sparse_accessors() {
    let sparse = |indices: &[u8], count: usize| {
        let mut builder = Builder::default();
        let (indices, values) = (builder.view(indices), builder.view(&[0; 24]));
        let positions = builder.raw_accessor(json!({"componentType": FLOAT, "count": 3, "type": "VEC3", "sparse": {
            "count": count, "indices": {"bufferView": indices, "componentType": 5121}, "values": {"bufferView": values}}}));
        builder.load(single(json!({"attributes": {"POSITION": positions}})))
    };
    assert_eq!(sparse(&[0, 2], 2).unwrap().positions.len(), 3);
    assert_refused(sparse(&[0, 3], 2), "sparse indices that do not increase or lie past its end");
    assert_refused(sparse(&[1, 1], 2), "sparse indices that do not increase");
    assert_refused(sparse(&[0, 1, 2], 3), "needs more bytes than its buffer view has (24)");
    assert_refused(sparse(&[0, 1, 2], 4), "replaces more elements than it has");
}

#[test]
fn skins() {
    let skinned = |joint: u8, skin: Value| {
        let mut builder = Builder::default();
        let positions = builder.floats(&TRIANGLE);
        let joints = builder.accessor("VEC4", 5121, 3, &[joint; 12]);
        let weights = builder.floats(&[[0.25; 4]; 3]);
        let matrix = builder.floats::<16>(&[[1.0; 16]]);
        assert_eq!(matrix, 3);
        builder.load(json!({
            "nodes": [{"mesh": 0, "skin": 0}], "skins": [skin],
            "meshes": [{"primitives": [{"attributes": {"POSITION": positions, "JOINTS_0": joints, "WEIGHTS_0": weights}}]}],
        }))
    };
    skinned(0, json!({"joints": [0]})).unwrap();
    assert_refused(skinned(1, json!({"joints": [0]})), "a vertex follows joint 1 of a skin of 1 joints");
    assert_refused(skinned(0, json!({"joints": [8]})), "it refers to node 8");
    assert_refused(
        skinned(0, json!({"joints": [0, 0], "inverseBindMatrices": 3})),
        "2 joints and 1 inverse bind matrices",
    );
    assert_refused(skinned(0, json!({"joints": []})), "joint 0 of a skin of 0 joints");
}

#[test]
fn images_and_uris() {
    let textured = |image: Value| {
        let mut builder = Builder::default();
        let positions = builder.floats(&TRIANGLE);
        let png = checker_png();
        builder.view(&png[..png.len() / 2]);
        builder.view(b"RIFF\x24\0\0\0WEBPVP8 ");
        let mut document = single(json!({"attributes": {"POSITION": positions}, "material": 0}));
        document["materials"] = json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]);
        document["textures"] = json!([{"source": 0}]);
        document["images"] = json!([image]);
        builder.load(document)
    };
    assert_refused(textured(json!({"bufferView": 1})), "image 0: ");
    assert_refused(textured(json!({"bufferView": 2})), "image 0: the image format WebP is not supported");
    assert_refused(textured(json!({"bufferView": 0})), "image 0: it begins neither as a PNG nor as a JPEG image");
    assert_refused(textured(json!({})), "image 0 has no data");
    assert_refused(textured(json!({"uri": "data:image/png;base64,A"})), "not valid base64");
    assert_refused(textured(json!({"uri": "data:image/png;base64"})), "a data URI has no comma");
    assert_refused(textured(json!({"uri": "https://example.org/a.png"})), "data at `https://example.org/a.png`");
    assert_refused(textured(json!({"uri": "/etc/passwd"})), "only relative files and data URIs are read");
    let message = textured(json!({"uri": "no such.png"})).unwrap_err().to_string();
    assert!(message.contains("cannot read") && message.contains("no such.png"), "{message}");
}

/// A small file whose nodes repeat one mesh until nothing could hold it.
#[test]
fn repeated_meshes_are_limited() {
    let mut builder = Builder::default();
    let positions = builder.floats(&vec![[0.0; 3]; 30_000]);
    let nodes: Vec<_> = (0..30_000).map(|_| json!({"mesh": 0})).collect();
    let result =
        builder.load(json!({"nodes": nodes, "meshes": [{"primitives": [{"attributes": {"POSITION": positions}}]}]}));
    assert_refused(
        result,
        "a scene that repeats its meshes to more than 4554304 vertices or triangles is not supported",
    );
}
