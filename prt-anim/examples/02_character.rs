//! Plays every clip of a character and says how far its vertices turn.
//!
//! `cargo run --release --example 02_character -p prt-anim -- FILE.glb`
#![expect(clippy::print_stdout, reason = "an example shows what it finds")]

use std::error::Error;
use std::path::PathBuf;

use prt_anim::{Deformed, Playback, load_character};

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args_os().nth(1).map(PathBuf::from).ok_or("which file? (.glb or .gltf)")?;
    let character = load_character(&path)?;
    println!("{} joints, {} vertices", character.skeleton.joints().len(), character.mesh.positions().len());
    println!("{:?}", character.report);

    let (mut pose, mut deformed) = (character.skeleton.rest_pose(), Deformed::default());
    for clip in &character.clips {
        clip.sample(0.5 * clip.duration(), Playback::Loop, &mut pose);
        character.mesh.skin.deform(&character.skeleton, &pose, &mut deformed);
        // The trace of a rotation is 1 + 2 cos(angle).
        let angles =
            deformed.frames.iter().map(|[c0, c1, c2]| ((c0[0] + c1[1] + c2[2] - 1.0) / 2.0).clamp(-1.0, 1.0).acos());
        let mean = angles.sum::<f32>() / deformed.frames.len() as f32;
        println!(
            "{:>30} {:5.2} s, turned by {:5.1} degrees",
            clip.name().unwrap_or("-"),
            clip.duration(),
            mean.to_degrees()
        );
    }
    Ok(())
}
