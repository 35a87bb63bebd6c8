//! Random bytes and random damage: whatever a file holds, its reader answers with a mesh, an image or an error.

use std::sync::LazyLock;

use exr::prelude::{Blocks, Compression, Vec2};
use image::ImageFormat;
use proptest::prelude::*;
use serde_json::json;

use crate::gltf::{Builder, TRIANGLE, checker_png};
use crate::scratch::{assert_no_giant_allocation, image, mesh};
use crate::{exr as exr_files, hdr, ply, standard};

/// Extension and contents of small files that are in order, several of each format.
static MESHES: LazyLock<Vec<(&str, Vec<u8>)>> = LazyLock::new(|| {
    let mut files: Vec<(&str, Vec<u8>)> =
        ply::ENCODINGS.iter().map(|encoding| ("ply", ply::pyramid(encoding))).collect();
    files.push(("obj", b"mtllib a.mtl\nv 0 0 0\nv 1 0 0 1\nv 1 1 0 .5 .5 .5\nv 0 1 0\nvt 0 0\nvn 0 0 1\nusemtl a\nf 1/1/1 2/1/1 3//1 -1\nf 1 2 \\\n3\n".to_vec()));
    files.push((
        "off",
        b"COFF\n4 2 0\n0 0 0 255 0 0\n1 0 0 1 2 3\n1 1 0 1 1 1\n0 1 0 4 4 4\n4 0 1 2 3\n3 0 1 2\n".to_vec(),
    ));
    let document = rich_gltf();
    files.push(("gltf", document[20..20 + u32::from_le_bytes(document[12..16].try_into().unwrap()) as usize].to_vec()));
    files.push(("glb", document));
    files
});

static IMAGES: LazyLock<Vec<(&str, Vec<u8>)>> = LazyLock::new(|| {
    let line: Vec<[u8; 4]> = (0..20).map(|x| [x / 5, x, 7, 128 + x / 9]).collect();
    let picture = image::DynamicImage::from(image::RgbImage::from_fn(9, 7, |x, y| image::Rgb([x as u8, y as u8, 200])));
    vec![
        ("hdr", hdr::new_runs(20, &[line.clone(), line])),
        ("hdr", b"#?RGBE\nEXPOSURE=2\nFORMAT=32-bit_rle_xyze\n\n+X 2 -Y 2\n\x05\x05\x05\x88\x01\x01\x01\x01\x07\x07\x07\x88\x01\x01\x01\x01".to_vec()),
        ("exr", exr_files::small_rgb(Compression::Uncompressed, Blocks::ScanLines)),
        ("exr", exr_files::small_rgb(Compression::RLE, Blocks::Tiles(Vec2(8, 8)))),
        ("exr", exr_files::small_rgb(Compression::ZIP16, Blocks::ScanLines)),
        ("exr", exr_files::small_rgb(Compression::PIZ, Blocks::ScanLines)),
        ("exr", exr_files::small_rgb(Compression::PXR24, Blocks::ScanLines)),
        ("exr", exr_files::small_rgb(Compression::DWAA(None), Blocks::ScanLines)),
        ("exr", exr_files::small_half(Compression::B44, Blocks::Tiles(Vec2(16, 4)))),
        ("png", standard::encoded(&picture, ImageFormat::Png)),
        ("jpg", standard::encoded(&picture, ImageFormat::Jpeg)),
    ]
});

/// Skin, morph target, texture, sparse accessor and hierarchy in one document.
fn rich_gltf() -> Vec<u8> {
    let mut builder = Builder::default();
    let (positions, uvs) = (builder.floats(&TRIANGLE), builder.floats(&[[0.5, 0.5]; 3]));
    let joints = builder.accessor("VEC4", 5121, 3, &[0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0]);
    let weights = builder.floats(&[[0.5, 0.5, 0.0, 0.0]; 3]);
    let matrices = builder.floats::<16>(&[[1.0; 16]; 2]);
    let indices = builder.accessor("SCALAR", 5123, 3, &[0, 0, 1, 0, 2, 0]);
    let (sparse, values, png) = (builder.view(&[2]), builder.view(&[0; 12]), builder.view(&checker_png()));
    let moved = builder.raw_accessor(json!({"componentType": 5126, "count": 3, "type": "VEC3", "sparse": {
        "count": 1, "indices": {"bufferView": sparse, "componentType": 5121}, "values": {"bufferView": values}}}));
    builder.glb(json!({
        "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0, "skin": 0, "scale": [1, 2, 3]}, {"children": [2], "translation": [1, 2, 3]}, {"mesh": 0, "rotation": [0, 0, 0, 1]}],
        "skins": [{"joints": [1, 2], "inverseBindMatrices": matrices}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "textures": [{"source": 0}], "images": [{"bufferView": png}],
        "meshes": [{"weights": [0.5], "primitives": [{
            "attributes": {"POSITION": positions, "TEXCOORD_0": uvs, "JOINTS_0": joints, "WEIGHTS_0": weights},
            "indices": indices, "material": 0, "mode": 4, "targets": [{"POSITION": moved}],
        }]}],
    }))
}

/// One thing done to a file. Places are fractions of its length.
#[derive(Debug, Clone)]
enum Damage {
    Set(f64, u8),
    Flip(f64, u8),
    Word(f64, u32),
    Cut(f64),
    Remove(f64, usize),
    Repeat(f64, usize),
    /// Replaces the n-th run of digits, which is how text formats lie.
    Number(f64, &'static str),
}

fn damage() -> impl Strategy<Value = Damage> {
    let place = 0.0..1.0_f64;
    let words = prop::sample::select(vec![
        0,
        1,
        0x7f,
        0xff,
        0xffff,
        0x1_0000,
        0x7fff_ffff,
        0x8000_0000,
        u32::MAX,
        u32::MAX - 1,
    ]);
    let numbers = prop::sample::select(vec![
        "0",
        "-1",
        "1",
        "3",
        "255",
        "65536",
        "2147483648",
        "4294967295",
        "18446744073709551615",
        "1e400",
        "nan",
        "99999999999999999999999",
    ]);
    prop_oneof![
        (place.clone(), any::<u8>()).prop_map(|(at, value)| Damage::Set(at, value)),
        (place.clone(), 0..8_u8).prop_map(|(at, bit)| Damage::Flip(at, bit)),
        (place.clone(), words).prop_map(|(at, word)| Damage::Word(at, word)),
        place.clone().prop_map(Damage::Cut),
        (place.clone(), 1..40_usize).prop_map(|(at, length)| Damage::Remove(at, length)),
        (place.clone(), 1..400_usize).prop_map(|(at, length)| Damage::Repeat(at, length)),
        (place, numbers).prop_map(|(at, number)| Damage::Number(at, number)),
    ]
}

fn apply(bytes: &mut Vec<u8>, damage: &Damage) {
    let length = bytes.len();
    if length == 0 {
        return;
    }
    let index = |at: f64| ((at * length as f64) as usize).min(length - 1);
    match *damage {
        Damage::Set(at, value) => bytes[index(at)] = value,
        Damage::Flip(at, bit) => bytes[index(at)] ^= 1 << bit,
        Damage::Word(at, word) => {
            bytes[index(at)..].iter_mut().zip(word.to_le_bytes()).for_each(|(byte, value)| *byte = value);
        }
        Damage::Cut(at) => bytes.truncate(index(at)),
        Damage::Remove(at, count) => {
            bytes.drain(index(at)..(index(at) + count).min(length));
        }
        Damage::Repeat(at, count) => {
            let piece = bytes[index(at)..(index(at) + count).min(length)].to_vec();
            bytes.splice(index(at)..index(at), piece);
        }
        Damage::Number(at, number) => {
            let digits = |from: usize| bytes[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
            if let Some(from) = (index(at)..length).find(|&from| digits(from) > 0) {
                let count = digits(from);
                bytes.splice(from..from + count, number.bytes());
            }
        }
    }
}

/// At least so many cases; the variable `PROPTEST_CASES` asks for more.
fn config(cases: u32) -> ProptestConfig {
    let default = ProptestConfig::default();
    ProptestConfig { cases: cases.max(default.cases), failure_persistence: None, ..default }
}

proptest! {
    #![proptest_config(config(2000))]

    #[test]
    fn damaged_meshes(file in 0..7_usize, damages in prop::collection::vec(damage(), 1..4)) {
        let (extension, mut bytes) = MESHES[file].clone();
        damages.iter().for_each(|damage| apply(&mut bytes, damage));
        if let Ok(mesh) = mesh(extension, &bytes) {
            let vertices = mesh.positions.len();
            prop_assert!(mesh.triangles.as_flattened().iter().all(|&corner| (corner as usize) < vertices));
            for length in [mesh.normals.len(), mesh.uvs.len(), mesh.albedo.len()] {
                prop_assert!(length == 0 || length == vertices);
            }
        }
    }

    #[test]
    fn damaged_images(file in 0..11_usize, damages in prop::collection::vec(damage(), 1..4)) {
        let (extension, mut bytes) = IMAGES[file].clone();
        damages.iter().for_each(|damage| apply(&mut bytes, damage));
        if let Ok(image) = image(extension, &bytes) {
            prop_assert_eq!(image.pixels.len(), image.width * image.height);
            prop_assert!(image.pixels.iter().flatten().all(|value| value.is_finite()));
        }
    }
}

proptest! {
    #![proptest_config(config(256))]

    #[test]
    fn random_bytes(bytes in prop::collection::vec(any::<u8>(), 0..400), start in 0..6_usize) {
        let starts: [&[u8]; 6] = [b"", b"glTF\x02\0\0\0", b"ply\nformat ascii 1.0\nelement vertex ", b"#?RADIANCE\n\n-Y 2 +X 9\n", b"\x76\x2f\x31\x01\x02\0\0\0", b"OFF\n"];
        let bytes = [starts[start], &bytes].concat();
        for extension in ["glb", "gltf", "obj", "ply", "off"] {
            drop(mesh(extension, &bytes));
        }
        for extension in ["hdr", "exr", "png", "jpg"] {
            drop(image(extension, &bytes));
        }
    }
}

#[test]
fn the_files_are_in_order_before_they_are_damaged() {
    for (extension, bytes) in MESHES.iter().filter(|(extension, _)| *extension != "gltf") {
        mesh(extension, bytes).unwrap();
    }
    for (extension, bytes) in IMAGES.iter() {
        image(extension, bytes).unwrap();
    }
    assert_no_giant_allocation();
}
