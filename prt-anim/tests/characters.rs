//! Real characters, which stand outside the project.

use std::path::{Path, PathBuf};

use prt_anim::{Character, Deformed, Playback, load_character};

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

fn path(name: &str) -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    let folder = std::env::var_os("PRT_DATA").map_or_else(beside, PathBuf::from);
    let path = folder.join("characters").join(format!("{name}.glb"));
    if path.exists() {
        return Some(path);
    }
    eprintln!("skipped: {} is not there", path.display());
    None
}

#[test]
fn all_clips_play() {
    for name in NAMES {
        let Some(path) = path(name) else { return };
        let character = load_character(&path).unwrap();
        eprintln!(
            "{name} {} {} {} {:?}",
            character.skeleton.joints().len(),
            character.clips.len(),
            character.mesh.positions().len(),
            character.report
        );
        let mut out = Deformed::default();
        for clip in &character.clips {
            for step in 0..=3 {
                let mut pose = character.skeleton.rest_pose();
                clip.sample(clip.duration() * f64::from(step) / 3.0, Playback::Clamp, &mut pose);
                character.mesh.skin.deform(&character.skeleton, &pose, &mut out);
                assert!(out.positions.iter().flatten().all(|v| v.is_finite()));
            }
        }
    }
}
