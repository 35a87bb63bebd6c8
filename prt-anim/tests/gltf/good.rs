//! Documents in order.

use prt_anim::{Character, Deformed, Playback};
use serde_json::json;

use crate::builder::{Builder, TRIANGLE, rich, write};

fn deform(character: &Character, clip: usize, time: f64) -> Deformed {
    let (mut pose, mut out) = (character.skeleton.rest_pose(), Deformed::default());
    character.clips[clip].sample(time, Playback::Clamp, &mut pose);
    character.mesh.skin.deform(&character.skeleton, &pose, &mut out);
    out
}

#[track_caller]
fn assert_near(a: &[[f32; 3]], b: &[[f32; 3]]) {
    assert_eq!(a.len(), b.len());
    let near = a.as_flattened().iter().zip(b.as_flattened()).all(|(a, b)| (a - b).abs() < 1e-6);
    assert!(near, "{a:?} {b:?}");
}

#[test]
fn a_whole_character() {
    let (builder, rest) = rich();
    let character = builder.load(rest).unwrap();
    assert_eq!(character.skeleton.find("hand"), Some(2));
    // The skinned node's own transform has no influence; all joints stand at (1, 2, 3).
    let moved = TRIANGLE.map(|[x, y, z]| [x + 1.0, y + 2.0, z + 3.0]);
    assert_near(character.mesh.positions(), &[moved, moved].concat());
    assert_near(character.mesh.normals(), &[[0.0, 0.0, 1.0]; 6]);
    assert_eq!(character.mesh.triangles, [[0, 1, 2], [3, 4, 5]]);
    assert_eq!(character.mesh.albedo, [[[0.5, 0.25, 1.0]; 3], [[0.8; 3]; 3]].concat());
    let report = &character.report;
    assert_eq!((report.weights_normalized, report.rigid_vertices, report.normals_computed), (1, 3, 3));
    assert_eq!((report.morphed_primitives, report.morph_channels, report.weights_dropped), (1, 1, 0));
    assert_eq!((character.clips[0].name(), character.clips[0].duration()), (Some("all"), 1.0));
    // At ½ s the clip has the hip at (0, 1, 0), and the hand not yet turned and scaled by (1 + 3) / 2.
    let out = deform(&character, 0, 0.5);
    let hand = TRIANGLE.map(|[x, y, _]| [2.0 * x, 1.0 + 2.0 * y, 0.0]);
    assert_near(&out.positions, &[hand, hand].concat());
    // At 1 s it has made a half turn about z and is three times as large.
    let out = deform(&character, 0, 1.0);
    assert_near(&out.positions[4..], &[[-3.0, 2.0, 0.0], [0.0, -1.0, 0.0]]);
    assert_near(&out.frames[5], &[[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]]);
}

/// A skin whose joints have moved since it was bound, seen through sixteen-bit joints and weights of eight bits.
#[test]
fn quantized_influences_and_bound_poses() {
    for (component, weights) in [(5121, vec![51, 204, 0, 0]), (5123, vec![0x33, 0x33, 0xcc, 0xcc, 0, 0, 0, 0])] {
        let mut builder = Builder::default();
        let positions = builder.floats(&TRIANGLE);
        let joints = builder.accessor("VEC4", 5123, 3, &[1, 0, 0, 0, 0, 0, 0, 0].repeat(3));
        let weights = builder.raw_weights(component, &weights.repeat(3));
        let mut down = [0.0; 16];
        [0, 5, 10, 15].iter().for_each(|&i| down[i] = 1.0);
        let still = down;
        down[14] = -10.0;
        let matrices = builder.floats::<16>(&[still, down]);
        let character = builder
            .load(json!({
                "nodes": [{"mesh": 0, "skin": 0}, {"translation": [5, 0, 0]}, {"translation": [0, 0, 10]}],
                "skins": [{"joints": [1, 2], "inverseBindMatrices": matrices}],
                "meshes": [{"primitives": [{"attributes": {"POSITION": positions, "JOINTS_0": joints, "WEIGHTS_0": weights}}]}],
            }))
            .unwrap();
        // A fifth of joint 1 (where it was bound) and four fifths of joint 0, five to the right.
        assert_near(character.mesh.positions(), &TRIANGLE.map(|[x, y, z]| [x + 4.0, y, z]));
        assert_eq!(character.report.weights_normalized, 0);
        assert_eq!(character.mesh.skin.parts().bones_per_vertex, 4);
    }
}

impl Builder {
    fn raw_weights(&mut self, component: u32, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        self.raw(
            json!({"bufferView": view, "componentType": component, "count": 3, "type": "VEC4", "normalized": true}),
        )
    }
}

/// Three sets of joints: the eight largest weights stay.
#[test]
fn many_influences() {
    let mut builder = Builder::default();
    let positions = builder.floats(&TRIANGLE);
    let mut attributes = json!({"POSITION": positions});
    for set in 0..3_u8 {
        let numbers = [4 * set, 4 * set + 1, 4 * set + 2, 4 * set + 3].repeat(3);
        let weights = [f32::from(set) + 0.1; 4];
        attributes[format!("JOINTS_{set}")] = builder.accessor("VEC4", 5121, 3, &numbers).into();
        attributes[format!("WEIGHTS_{set}")] = builder.floats(&[weights; 3]).into();
    }
    let mut nodes = vec![json!({"mesh": 0, "skin": 0})];
    nodes.extend((0..12).map(|i| json!({"translation": [i, 0, 0]})));
    let character = builder
        .load(json!({
            "nodes": nodes,
            "skins": [{"joints": (1..=12).collect::<Vec<_>>()}],
            "meshes": [{"primitives": [{"attributes": attributes}]}],
        }))
        .unwrap();
    assert_eq!((character.report.weights_dropped, character.report.weights_normalized), (12, 3));
    let skin = character.mesh.skin.parts();
    assert_eq!((skin.bones_per_vertex, &skin.bone_indices[..8]), (8, &[8, 9, 10, 11, 4, 5, 6, 7][..]));
    // (2.1 (8 + 9 + 10 + 11) + 1.1 (4 + 5 + 6 + 7)) / (4 · 3.2)
    let expected = (2.1 * 38.0 + 1.1 * 22.0) / 12.8;
    assert!((character.mesh.positions()[0][0] - expected).abs() < 1e-5);
}

/// A mirrored part: faces are turned back, so that normals and winding agree outside.
#[test]
fn mirrors_and_matrices() {
    let mut builder = Builder::default();
    let positions = builder.floats(&TRIANGLE);
    let character = builder
        .load(json!({
            "nodes": [
                {"mesh": 0, "scale": [-1, 1, 1]},
                {"mesh": 0, "matrix": [0, 2, 0, 0,  -3, 0, 0, 0,  0, 0, -4, 0,  7, 8, 9, 1]},
                {"mesh": 0, "matrix": [0, 0, 0, 0,  0, 5, 0, 0,  0, 0, 0, 0,  0, 0, 0, 1]},
            ],
            "meshes": [{"primitives": [{"attributes": {"POSITION": positions}, "mode": 4}, {"attributes": {"POSITION": positions}, "mode": 0}]}],
        }))
        .unwrap();
    assert_eq!(character.report.other_primitives, 3);
    assert_eq!(character.mesh.triangles, [[0, 2, 1], [3, 5, 4], [6, 7, 8]]);
    let positions = character.mesh.positions();
    assert_near(&positions[..3], &[[0.0; 3], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_near(&positions[3..6], &[[7.0, 8.0, 9.0], [7.0, 10.0, 9.0], [4.0, 8.0, 9.0]]);
    assert_near(&positions[6..], &[[0.0; 3], [0.0; 3], [0.0, 5.0, 0.0]]);
    assert_near(&character.mesh.normals()[..6], &[[[0.0, 0.0, 1.0]; 3], [[0.0, 0.0, -1.0]; 3]].concat());
}

#[test]
fn strips_morphs_and_scenes() {
    let mut builder = Builder::default();
    let positions = builder.floats(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]]);
    let moved = builder.floats(&[[0.0, 0.0, 4.0]; 4]);
    let primitive = json!({"attributes": {"POSITION": positions}, "mode": 5, "targets": [{"POSITION": moved}]});
    let character = builder
        .load(json!({
            "scene": 1, "scenes": [{"nodes": [0]}, {"nodes": [1]}],
            "nodes": [{"mesh": 0}, {"mesh": 0, "weights": [0.5]}],
            "meshes": [{"weights": [0.25], "primitives": [primitive]}],
        }))
        .unwrap();
    assert_eq!(character.mesh.triangles, [[0, 1, 2], [1, 3, 2]]);
    assert_near(character.mesh.positions(), &[[0.0, 0.0, 2.0], [1.0, 0.0, 2.0], [0.0, 1.0, 2.0], [1.0, 1.0, 2.0]]);
    assert_eq!((character.skeleton.joints().len(), character.clips.len()), (2, 0));
}

/// The same bytes as JSON with a file beside it, and with its data inside.
#[test]
fn gltf_with_files_and_data() {
    let (builder, rest) = rich();
    let whole = builder.load(rest.clone()).unwrap();
    let glb = builder.glb(&builder.json(rest.clone()));
    let json_length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let mut document = builder.json(rest);
    write("some data.bin", &glb[28 + json_length..]);
    document["buffers"][0]["uri"] = "some%20data.bin".into();
    let beside = prt_anim::load_character(&write("test.gltf", document.to_string().as_bytes())).unwrap();
    assert!(beside == whole);
}

/// Two skins number their joints each for itself; a mesh that uses both nodes' skins gets the bones of both.
#[test]
fn several_skins() {
    let mut builder = Builder::default();
    let positions = builder.floats(&TRIANGLE);
    let joints = builder.accessor("VEC4", 5121, 3, &[1, 0, 0, 0].repeat(3));
    let weights = builder.floats(&[[1.0, 0.0, 0.0, 0.0]; 3]);
    let attributes = json!({"POSITION": positions, "JOINTS_0": joints, "WEIGHTS_0": weights});
    let character = builder
        .load(json!({
            "nodes": [
                {"mesh": 0, "skin": 0}, {"mesh": 0, "skin": 1}, {"mesh": 0, "skin": 0},
                {"translation": [5, 0, 0]}, {"translation": [0, 7, 0]}, {"translation": [0, 0, 9]},
            ],
            "skins": [{"joints": [3, 4]}, {"joints": [4, 5]}],
            "meshes": [{"primitives": [{"attributes": attributes}]}],
        }))
        .unwrap();
    let [up, out] = [TRIANGLE.map(|[x, y, z]| [x, y + 7.0, z]), TRIANGLE.map(|[x, y, z]| [x, y, z + 9.0])];
    assert_near(character.mesh.positions(), &[up, out, up].concat());
    let bones: Vec<usize> = character.mesh.skin.parts().bones.iter().map(|bone| bone.joint).collect();
    assert_eq!(bones, [3, 4, 4, 5]);
}
