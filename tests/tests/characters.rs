//! Characters that are baked by `prt-bake` and posed by `prt-anim`: two readers of the same files.
#![expect(clippy::unwrap_used, reason = "tests")]

use prt_anim::{Character, Deformed, Playback, load_character};
use prt_bake::{Mesh, MeshOptions, load_mesh};
use prt_tests::data_path;

const NAMES: [&str; 8] = [
    "cesium_man",
    "fox",
    "gdquest_mannequiny",
    "kaykit_barbarian",
    "kaykit_knight",
    "quaternius_mech_george",
    "quaternius_wolf",
    "robot_expressive",
];

/// Calls `check` with all characters that are there.
fn for_each(test: &str, check: impl Fn(&str, &std::path::Path, &Character)) {
    for name in NAMES {
        let Some(path) = data_path(test, &format!("characters/{name}.glb")) else { continue };
        check(name, &path, &load_character(&path).unwrap());
    }
}

fn distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    (glam::Vec3::from(a)).distance(b.into())
}

fn diagonal(positions: &[[f32; 3]]) -> f32 {
    let points = || positions.iter().map(|&point| glam::Vec3::from(point));
    points().reduce(glam::Vec3::max).unwrap().distance(points().reduce(glam::Vec3::min).unwrap())
}

/// The rest pose is the mesh that is baked: vertices, faces and normals in the same order.
#[test]
fn both_readers_agree() {
    for_each("both_readers_agree", |name, path, character| {
        let (source, mesh) = (load_mesh(path).unwrap(), &character.mesh);
        assert_eq!(source.positions.len(), mesh.positions().len(), "{name}");
        assert!(source.triangles == mesh.triangles, "{name}");
        assert!(source.uvs.is_empty() || source.uvs == mesh.uvs, "{name}");
        // Both round to f32, here once more for the weights; joints may lie ten times further out than the vertices.
        let tolerance = 2e-6 * diagonal(mesh.positions());
        for (theirs, &ours) in source.positions.iter().zip(mesh.positions()) {
            assert!(distance(theirs.map(|value| value as f32), ours) < tolerance, "{name} {theirs:?} {ours:?}");
        }
        for (&theirs, &ours) in source.normals.iter().zip(mesh.normals()) {
            assert!(distance(theirs, ours) < 1e-5, "{name} {theirs:?} {ours:?}");
        }
    });
}

/// A cleaned mesh finds its joints, and moves as the character does.
#[test]
fn baked_meshes_are_bound() {
    for_each("baked_meshes_are_bound", |name, path, character| {
        let (baked, _) = Mesh::new(load_mesh(path).unwrap(), &MeshOptions::default()).unwrap();
        let positions: Vec<[f32; 3]> = baked.positions().iter().map(|p| p.map(|value| value as f32)).collect();
        let binding = character.mesh.bind_to(&positions, baked.normals()).unwrap();
        // The vertices of twins, the backs of two-sided faces, come last.
        let originals = 1 + *baked.original_triangles().as_flattened().iter().max().unwrap() as usize;
        // Cleaning keeps the order where no vertex is split. The knight has weapons that lie in one another.
        let in_order = binding.sources[..originals].windows(2).all(|pair| pair[0] < pair[1]);
        assert!(in_order || character.report.normals_computed > 0, "{name}");
        let mut pose = character.skeleton.rest_pose();
        let (mut whole, mut bound) = (Deformed::default(), Deformed::default());
        character.clips[0].sample(0.4 * character.clips[0].duration(), Playback::Loop, &mut pose);
        character.mesh.skin.deform(&character.skeleton, &pose, &mut whole);
        binding.skin.deform(&character.skeleton, &pose, &mut bound);
        for (vertex, &source) in binding.sources.iter().enumerate() {
            assert_eq!(bound.positions[vertex], whole.positions[source as usize], "{name}");
            // Where the file has normals the baked mesh keeps them, and twins have their own.
            if character.report.normals_computed == 0 && vertex < originals {
                let (ours, theirs) = (bound.normals[vertex], whole.normals[source as usize]);
                assert!(
                    distance(ours, theirs) < 1e-4,
                    "{name} {vertex} {source} {ours:?} {theirs:?} {:?} {:?}",
                    baked.normals()[vertex],
                    character.mesh.normals()[source as usize]
                );
            }
        }
        // Joints are found by place alone: a file in another order, or moved a little, is bound or refused.
        let moved: Vec<[f32; 3]> = positions.iter().map(|&[x, y, z]| [x, y + 0.01 * diagonal(&positions), z]).collect();
        assert!(character.mesh.bind_to(&moved, baked.normals()).is_err(), "{name}");
    });
}

/// In the rest pose nothing turns, in any pose of any clip everything is finite and every frame a rotation.
#[test]
fn all_clips_play() {
    for_each("all_clips_play", |name, _, character| {
        let mut out = Deformed::default();
        character.mesh.skin.deform(&character.skeleton, &character.skeleton.rest_pose(), &mut out);
        for (vertex, &frame) in out.frames.iter().enumerate() {
            let frame = glam::Mat3::from_cols_array_2d(&frame);
            assert!(frame.abs_diff_eq(glam::Mat3::IDENTITY, 1e-5), "{name} {vertex} {frame}");
        }
        assert!(out.positions == character.mesh.positions(), "{name}");
        let size = diagonal(character.mesh.positions());
        for clip in &character.clips {
            for step in 0..=4 {
                let mut pose = character.skeleton.rest_pose();
                clip.sample(clip.duration() * f64::from(step) / 4.0, Playback::Clamp, &mut pose);
                character.mesh.skin.deform(&character.skeleton, &pose, &mut out);
                assert!(out.positions.as_flattened().iter().all(|value| value.is_finite()), "{name}");
                // A character that is torn apart grows: none of these does much more than stretch its arms.
                let posed = diagonal(&out.positions);
                assert!(posed < 3.0 * size && posed > 0.3 * size, "{name} {:?} {posed} {size}", clip.name());
                for &frame in &out.frames {
                    let frame = glam::Mat3::from_cols_array_2d(&frame);
                    assert!((frame * frame.transpose()).abs_diff_eq(glam::Mat3::IDENTITY, 1e-6));
                    assert!(frame.determinant() > 0.0);
                }
            }
        }
    });
}

/// Counts as the data's README has them, which another program made.
#[test]
fn counts_are_known() {
    let Some(path) = data_path("counts_are_known", "characters/robot_expressive.glb") else { return };
    let robot = load_character(&path).unwrap();
    assert_eq!((robot.mesh.positions().len(), robot.mesh.triangles.len()), (7214, 3237));
    assert_eq!(robot.mesh.positions().len() - robot.report.rigid_vertices, 1108);
    assert_eq!((robot.report.weights_normalized, robot.clips.len()), (752, 14));
    let wave = robot.clips.iter().find(|clip| clip.name() == Some("Wave")).unwrap();
    assert!((wave.duration() - 1.83).abs() < 0.005);
    let Some(path) = data_path("counts_are_known", "characters/quaternius_wolf.glb") else { return };
    let wolf = load_character(&path).unwrap();
    assert_eq!((wolf.mesh.positions().len(), wolf.mesh.triangles.len(), wolf.clips.len()), (3994, 1962, 12));
    assert_eq!((wolf.report.rigid_vertices, wolf.mesh.skin.parts().bones.len()), (0, 51));
}
