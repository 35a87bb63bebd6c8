use std::fs;

use super::scenes::{plates, torus};
use super::{bake, options, texels};
use crate::{BakeOptions, Error, Image, Source, TexelOptions, TexelTransfer};

fn written(atlas: &TexelTransfer) -> (tempfile::TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("atlas.exr");
    assert_eq!(atlas.write_exr(&path).unwrap(), fs::metadata(&path).unwrap().len());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "no temporary file is left");
    (folder, path)
}

fn colored() -> TexelTransfer {
    let mut mesh = plates(2);
    mesh.set_albedo([0.8, 0.4, 0.0]).unwrap();
    bake(&mesh, &BakeOptions { bounces: 1, ..options(2) }, &texels(9, 21)).0
}

#[test]
fn what_is_written_is_read() {
    let mut grey = bake(&torus([12, 8], 0.0), &options(4), &TexelOptions { v_up: true, ..texels(20, 33) }).0;
    grey.wraps = [true, false];
    grey.metadata.source = Some(Source { name: "a b.obj".to_owned(), sha256: "00ff".to_owned() });
    grey.metadata.seed = u64::MAX;
    // Numbers that are hard to write as text, or in half precision.
    grey.transfer.values[..4].copy_from_slice(&[f32::MIN_POSITIVE, 1e-42, -f32::MAX, 0.1]);
    for atlas in [grey, colored()] {
        let (_folder, path) = written(&atlas);
        assert_eq!(TexelTransfer::read_exr(&path).unwrap(), atlas);
    }
}

#[test]
fn channels_have_the_promised_names_and_sort() {
    let names = |atlas: &TexelTransfer| -> Vec<String> {
        let (_folder, path) = written(atlas);
        let meta = exr::meta::MetaData::read_from_file(&path, false).unwrap();
        meta.headers[0].channels.list.iter().map(|channel| channel.name.to_string()).collect()
    };
    let grey = bake(&plates(2), &options(4), &texels(4, 4)).0;
    let mut expected = vec!["coverage".to_owned()];
    expected.extend((0..16).map(|i| format!("transfer.{i:02}")));
    assert_eq!(names(&grey), expected);
    assert_eq!(names(&colored())[..5], ["coverage", "transfer.0.b", "transfer.0.g", "transfer.0.r", "transfer.1.b"]);
}

#[test]
fn other_images_and_damaged_ones_are_refused() {
    let refused = |path: &std::path::Path, words: &str| {
        let error = TexelTransfer::read_exr(path).unwrap_err();
        assert!(error.to_string().contains(words), "{error}");
        assert!(error.to_string().contains("atlas.exr"), "{error}");
    };
    let (_folder, path) = written(&colored());
    let bytes = fs::read(&path).unwrap();
    fs::write(&path, &bytes[..bytes.len() - 40]).unwrap();
    refused(&path, "atlas.exr");
    let alter = |from: &[u8], to: &[u8]| {
        let at = bytes.windows(from.len()).position(|window| window == from).unwrap();
        let mut altered = bytes.clone();
        altered[at..at + to.len()].copy_from_slice(to);
        fs::write(&path, altered).unwrap();
    };
    alter(b"transfer.3.r", b"transfer.3.s");
    refused(&path, "no channel transfer.3.r");
    alter(b"texture-transfer", b"texture-transfix");
    refused(&path, "texture-transfix");
    alter(b"condon-shortley", b"condon-longleyy");
    refused(&path, "convention");
    Image { width: 2, height: 1, pixels: vec![[0.0; 3]; 2] }.save_exr(&path, crate::ExrPrecision::Float).unwrap();
    refused(&path, "format");
    assert!(matches!(TexelTransfer::read_exr(&path.with_extension("none")), Err(Error::Io { .. })));
}

#[test]
fn values_that_are_no_numbers_are_refused() {
    let mut atlas = colored();
    atlas.transfer.values[7] = f32::NAN;
    let (_folder, path) = written(&atlas);
    let error = TexelTransfer::read_exr(&path).unwrap_err().to_string();
    assert!(error.contains("NaN"), "{error}");
}

#[test]
fn arrays_of_wrong_length_are_not_written() {
    let mut atlas = colored();
    atlas.coverage.pop();
    let folder = tempfile::tempdir().unwrap();
    assert!(atlas.write_exr(&folder.path().join("x.exr")).is_err());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
