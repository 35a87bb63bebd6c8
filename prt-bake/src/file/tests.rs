#![expect(clippy::unwrap_used, reason = "tests")]

use std::fs;

use proptest::prelude::*;
use sh_core::Order;

use super::*;

fn surface() -> BakedSurface {
    let order = Order::new(2).unwrap();
    let value = |i: usize| i as f32 * 0.25 - 1.0;
    BakedSurface {
        metadata: Metadata {
            rays: 64,
            bounces: 1,
            seed: u64::MAX,
            shadowed: true,
            source: Some(Source { name: "a b.obj".to_owned(), sha256: "00ff".to_owned() }),
            error: Some(0.001_25),
        },
        positions: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 1e-30]],
        normals: vec![[0.0, 0.0, 1.0]; 3],
        triangles: vec![[0, 1, 2], [2, 1, 0]],
        albedo: vec![[0.5, 0.25, 1.0]; 3],
        uvs: Some(vec![[0.0, 1.0]; 3]),
        transfer: TransferVectors { order, channels: 3, values: (0..36).map(value).collect() },
        transfer_shadowed: Some(TransferVectors { order, channels: 1, values: (0..12).map(value).collect() }),
    }
}

fn bytes_of(surface: &BakedSurface) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.prt");
    assert_eq!(surface.write(&path).unwrap(), fs::metadata(&path).unwrap().len());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "no temporary file is left");
    fs::read(path).unwrap()
}

/// The file with `from` in its header replaced by `to`, which must be as long.
fn altered(from: &str, to: &str) -> Vec<u8> {
    assert_eq!(from.len(), to.len());
    let mut bytes = bytes_of(&surface());
    let at = bytes.windows(from.len()).position(|window| window == from.as_bytes()).expect("the header has it");
    bytes[at..at + to.len()].copy_from_slice(to.as_bytes());
    bytes
}

#[test]
fn what_is_written_is_read() {
    let mut surface = surface();
    assert_eq!(read::surface(&bytes_of(&surface)).unwrap(), surface);
    surface.uvs = None;
    surface.transfer_shadowed = None;
    surface.metadata.source = None;
    surface.metadata.error = None;
    assert_eq!(read::surface(&bytes_of(&surface)).unwrap(), surface);
}

#[test]
fn the_same_surface_is_the_same_bytes() {
    assert!((0..8).all(|_| bytes_of(&surface()) == bytes_of(&surface())));
}

#[test]
fn tensors_have_the_promised_names_types_and_shapes() {
    let info = read::info(&bytes_of(&surface())).unwrap();
    let described: Vec<String> =
        info.tensors.iter().map(|tensor| format!("{} {} {:?}", tensor.name, tensor.dtype, tensor.shape)).collect();
    assert_eq!(
        described,
        [
            "albedo F32 [3, 3]",
            "index U32 [2, 3]",
            "normal F32 [3, 3]",
            "position F32 [3, 3]",
            "transfer F32 [3, 3, 4]",
            "transfer_shadowed F32 [3, 1, 4]",
            "uv F32 [3, 2]"
        ]
    );
    assert_eq!(info.metadata["format"], "prt/1");
    assert_eq!(info.metadata["kind"], "vertex-transfer");
    assert_eq!(info.metadata["convention"], "real, condon-shortley, i=l(l+1)+m");
    assert_eq!(info.metadata["source"], "a b.obj sha256:00ff");
}

#[test]
fn wrong_files_are_refused_with_the_reason() {
    let cases = [
        ("prt/1", "prt/2", "newer than"),
        ("prt/1", "prt/0", "its format is prt/0"),
        ("\"order\":\"2\"", "\"order\":\"3\"", "tensor transfer has shape [3, 3, 4]; [3, 3, 9]"),
        ("\"order\":\"2\"", "\"order\":\"0\"", "its order is 0"),
        ("\"order\":\"2\"", "\"order\":\"x\"", "not a valid value"),
        ("\"rays\":\"64\"", "\"ways\":\"64\"", "no entry \"rays\""),
        ("vertex-transfer", "vertex-sediment", "kind"),
        ("[2,3]", "[3,2]", "tensor index has shape [3, 2]; [any, 3]"),
        ("\"albedo\"", "\"albino\"", "tensor albedo is missing"),
        ("[3,2]", "[2,3]", "tensor uv has shape"),
    ];
    for (from, to, reason) in cases {
        let error = read::surface(&altered(from, to)).unwrap_err();
        assert!(error.contains(reason), "{from} -> {to}: {error}");
    }
}

#[test]
fn wrong_values_are_refused() {
    let mut wild = surface();
    wild.triangles[1][2] = 3;
    assert!(read::surface(&bytes_of(&wild)).unwrap_err().contains("face 1 of tensor index uses vertex 3 of 3"));
    let mut undefined = surface();
    undefined.transfer.values[5] = f32::NAN;
    assert!(
        read::surface(&bytes_of(&undefined)).unwrap_err().contains("tensor transfer has the value NaN at element 5")
    );
}

#[test]
fn errors_name_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.prt");
    fs::write(&path, &bytes_of(&surface())[..300]).unwrap();
    assert!(BakedSurface::read(&path).unwrap_err().to_string().contains("cut.prt"));
    assert!(BakedSurface::read(folder.path()).is_err());
    assert!(file_info(&folder.path().join("absent.prt")).unwrap_err().to_string().contains("absent.prt"));
    let mut short = surface();
    short.normals.pop();
    assert!(short.write(&path).unwrap_err().to_string().contains("2 normals for 3"));
}

proptest! {
    #[test]
    fn no_bytes_make_the_reader_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let _ = read::surface(&bytes);
    }

    #[test]
    fn no_damage_makes_the_reader_panic(place in 0_usize..1500, byte in any::<u8>(), cut in 0_usize..1500) {
        let mut bytes = bytes_of(&surface());
        let place = place % bytes.len();
        bytes[place] = byte;
        bytes.truncate(bytes.len().min(cut.max(8)));
        let _ = read::surface(&bytes);
    }
}
