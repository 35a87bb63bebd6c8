//! Random damage: whatever a file holds, it is refused or gives a character that can be posed.

use proptest::prelude::*;
use prt_anim::{Character, Deformed, Error, Playback};

use crate::builder::{load_bytes, rich};

/// Plays all clips; everything is finite, whatever the keys hold.
fn check(loaded: Result<Character, Error>) {
    let Ok(character) = loaded else { return };
    let vertices = character.mesh.positions().len();
    assert!(character.mesh.triangles.as_flattened().iter().all(|&vertex| (vertex as usize) < vertices));
    assert!(character.mesh.positions().as_flattened().iter().all(|value| value.is_finite()));
    assert_eq!((character.mesh.uvs.len(), character.mesh.albedo.len()), (vertices, vertices));
    let mut out = Deformed::default();
    for clip in &character.clips {
        let mut pose = character.skeleton.rest_pose();
        clip.sample(0.3 * clip.duration(), Playback::Loop, &mut pose);
        character.mesh.skin.deform(&character.skeleton, &pose, &mut out);
        let mut values = out.positions.as_flattened().iter().chain(out.frames.as_flattened().as_flattened());
        assert!(values.all(|value| value.is_finite()));
    }
}

fn flip(bytes: &mut [u8], at: f64, bit: u8) {
    let length = bytes.len();
    bytes[((at * length as f64) as usize).min(length - 1)] ^= 1 << bit;
}

/// Replaces the first run of digits after a place.
fn set_number(bytes: &mut Vec<u8>, at: f64, number: &str) {
    let from = (at * bytes.len() as f64) as usize;
    let Some(start) = (from..bytes.len()).find(|&i| bytes[i].is_ascii_digit()) else { return };
    let count = bytes[start..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    bytes.splice(start..start + count, number.bytes());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 800, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn damaged_documents(
        flips in prop::collection::vec((0.0..1.0_f64, 0..8_u8), 0..3),
        number in prop::option::of((0.0..0.8_f64, prop::sample::select(vec!["0", "1", "2", "255", "65536", "4294967295", "18446744073709551615", "-1", "1e39"]))),
        cut in prop::option::weighted(0.1, 0.0..1.0_f64),
    ) {
        let (builder, rest) = rich();
        let document = builder.json(rest).to_string();
        let mut json = document.into_bytes();
        if let Some((at, number)) = number {
            set_number(&mut json, at, number);
        }
        // Still text: put together as bytes, so that the container is in order.
        let text = String::from_utf8(json).unwrap();
        let mut bytes = match serde_json::from_str(&text) {
            Ok(document) => builder.glb(&document),
            Err(_) => text.into_bytes(),
        };
        flips.iter().for_each(|&(at, bit)| flip(&mut bytes, at, bit));
        if let Some(cut) = cut {
            bytes.truncate((cut * bytes.len() as f64) as usize);
        }
        check(load_bytes(&bytes));
    }

    /// Keys, weights and matrices of random bits.
    #[test]
    fn damaged_numbers(words in prop::collection::vec((0.0..1.0_f64, prop::sample::select(vec![0.0, f32::NAN, f32::INFINITY, f32::MAX, f32::MIN_POSITIVE, -1.0, 1e-45])), 1..6)) {
        let (builder, rest) = rich();
        let mut bytes = builder.glb(&builder.json(rest));
        let start = 28 + u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
        for (at, value) in words {
            let place = start + (at * (bytes.len() - start) as f64) as usize / 4 * 4;
            bytes[place..place + 4].copy_from_slice(&value.to_le_bytes());
        }
        check(load_bytes(&bytes));
    }
}

#[test]
fn the_document_is_in_order_before_it_is_damaged() {
    let (builder, rest) = rich();
    check(Ok(builder.load(rest).unwrap()));
}

/// Places that are damaged in each part; the header has 28 bytes.
const PLACES: usize = 28;

/// A real file cut at many places, and with single bits flipped in its header, its JSON and its numbers.
#[test]
fn a_damaged_fox() {
    let beside = || std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    let folder = std::env::var_os("PRT_DATA").map_or_else(beside, std::path::PathBuf::from);
    let Ok(fox) = std::fs::read(folder.join("characters/fox.glb")) else {
        eprintln!("skipped: a_damaged_fox needs {}", folder.display());
        return;
    };
    let json = u32::from_le_bytes(fox[12..16].try_into().unwrap()) as usize;
    for i in 0..PLACES {
        let whole = fox.len() * i / PLACES;
        load_bytes(&fox[..whole]).unwrap_err();
        let mut bytes = fox.clone();
        bytes[i] ^= 1 << (i % 8);
        check(load_bytes(&bytes));
        for place in [20 + json * i / PLACES, 28 + json + (fox.len() - 28 - json) * i / PLACES] {
            let mut bytes = fox.clone();
            bytes[place] ^= 1 << (7 - i % 8);
            check(load_bytes(&bytes));
        }
    }
}
