//! Writing images, whole or not at all.

use std::fs;
use std::path::Path;

use prt_bake::{ExrPrecision, Image, save_png};

use crate::scratch::{Scratch, assert_near};

fn gradient() -> Image {
    let pixels = (0..37 * 19).map(|i| [i as f32 * 0.1 - 1.0, 1e30 / (i + 1) as f32, 1e-30 * i as f32]).collect();
    Image { width: 37, height: 19, pixels }
}

fn names(folder: &Path) -> Vec<String> {
    fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
}

#[test]
fn floats_survive_exactly_and_halves_to_their_precision() {
    let scratch = Scratch::new();
    let path = scratch.path().join("test.EXR");
    gradient().save(&path).unwrap();
    assert_eq!(Image::load(&path).unwrap(), gradient());
    gradient().save_exr(&path, ExrPrecision::Half).unwrap();
    let half = Image::load(&path).unwrap();
    assert_eq!(half.pixels[0][1], 65504.0, "what a half cannot hold is clamped");
    for (half, exact) in half.pixels.iter().zip(gradient().pixels) {
        assert!((half[0] - exact[0]).abs() <= exact[0].abs() / 2048.0);
    }
    assert_eq!(names(scratch.path()), ["test.EXR"], "no temporary file is left");
}

#[test]
fn the_same_image_gives_the_same_bytes() {
    let scratch = Scratch::new();
    let bytes = ["a.exr", "b.exr"].map(|name| {
        let path = scratch.path().join(name);
        gradient().save(&path).unwrap();
        fs::read(path).unwrap()
    });
    assert_eq!(bytes[0], bytes[1]);
}

#[test]
fn png_is_srgb_and_clamped() {
    let scratch = Scratch::new();
    let path = scratch.path().join("test.png");
    let image = Image { width: 3, height: 1, pixels: vec![[-1.0, 0.0, 2.0], [0.5, 0.001, f32::NAN], [0.2; 3]] };
    image.save(&path).unwrap();
    let read = Image::load(&path).unwrap();
    assert_eq!(read.pixels[0], [0.0, 0.0, 1.0]);
    assert_near(&read.pixels[1][..2], &[0.5, 0.001], 0.005);
    save_png(&path, 2, 1, &[[1, 2, 3], [255, 0, 128]]).unwrap();
    assert_eq!(image::open(&path).unwrap().into_rgb8().into_raw(), [1, 2, 3, 255, 0, 128]);
}

#[test]
fn failures_name_the_file_and_leave_the_old_one() {
    let scratch = Scratch::new();
    let nowhere = scratch.path().join("no/such/folder/test.exr");
    let message = gradient().save(&nowhere).unwrap_err().to_string();
    assert!(message.starts_with(&format!("cannot write {}: ", nowhere.display())), "{message}");
    assert!(!message.contains(".part"), "{message}");
    let message = gradient().save(&scratch.path().join("test.gif")).unwrap_err().to_string();
    assert!(message.contains("unknown extension; an image may be one of exr, png"), "{message}");
    let folder = scratch.path().join("folder.exr");
    fs::create_dir(&folder).unwrap();
    assert!(gradient().save(&folder).unwrap_err().to_string().contains("is a directory"));

    // An image without pixels cannot be written as PNG, which is found out when the file is begun.
    let old = scratch.write("old.png", "old");
    save_png(&old, 0, 0, &[]).unwrap_err();
    assert_eq!(fs::read(&old).unwrap(), b"old");
    let mut left = names(scratch.path());
    left.sort();
    assert_eq!(left, ["folder.exr", "old.png"]);
}

#[cfg(unix)]
#[test]
fn permissions_links_and_full_disks() {
    use std::os::unix::fs::{PermissionsExt, symlink};

    let scratch = Scratch::new();
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
    let plain = scratch.write("plain", "x");
    let path = scratch.path().join("test.png");
    save_png(&path, 1, 1, &[[1; 3]]).unwrap();
    assert_eq!(mode(&path), mode(&plain), "what the umask leaves");

    let target = scratch.write("target.png", "old");
    let link = scratch.path().join("link.png");
    symlink(&target, &link).unwrap();
    save_png(&link, 1, 1, &[[1; 3]]).unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink(), "the link stays");
    assert_ne!(fs::read(&target).unwrap(), b"old");

    let full = Path::new("/dev/full");
    if full.exists() {
        let message = save_png(full, 1, 1, &[[1; 3]]).unwrap_err().to_string();
        assert!(message.starts_with("cannot write /dev/full: No space left"), "{message}");
    }
}
