//! What is wrong before a byte is read.

use std::path::Path;

use prt_bake::{Environment, Image, load_mesh};

use crate::scratch::Scratch;

#[track_caller]
fn assert_both(path: &Path, words: &str) {
    for message in [load_mesh(path).unwrap_err().to_string(), Image::load(path).unwrap_err().to_string()] {
        assert!(message.contains(&path.display().to_string()) && message.contains(words), "{message}");
    }
}

#[test]
fn missing_files_and_folders() {
    let scratch = Scratch::new();
    assert_both(&scratch.path().join("nothing.obj"), "cannot read");
    assert_both(&scratch.path().join("nothing.obj"), "No such file");
    assert_both(Path::new(""), "cannot read");
    let folder = scratch.path().join("folder.ply");
    std::fs::create_dir(&folder).unwrap();
    assert_both(&folder, "is a directory");
    assert_both(&scratch.write("file", "x").join("below.obj"), "cannot read");
    if Path::new("/dev/zero").exists() {
        assert_both(Path::new("/dev/zero"), "not a regular file");
    }
    let message = Environment::load(&scratch.path().join("none.hdr")).unwrap_err().to_string();
    assert!(message.contains("cannot read") && message.contains("none.hdr"), "{message}");
}

#[test]
fn unknown_extensions_list_what_is_read() {
    let scratch = Scratch::new();
    for name in ["x.stl", "noextension", ".obj", "x."] {
        let path = scratch.write(name, "x");
        let message = load_mesh(&path).unwrap_err().to_string();
        assert!(message.ends_with("unknown extension; a mesh may be one of glb, gltf, obj, ply, off"), "{message}");
        let message = Image::load(&path).unwrap_err().to_string();
        assert!(
            message.ends_with("unknown extension; an image may be one of hdr, pic, rgbe, exr, png, jpg, jpeg"),
            "{message}"
        );
    }
}

#[cfg(unix)]
#[test]
fn no_permission() {
    use std::os::unix::fs::PermissionsExt;

    let scratch = Scratch::new();
    let path = scratch.write("secret.obj", "v 0 0 0\n");
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o000)).unwrap();
    if std::fs::read(&path).is_ok() {
        println!("skipped: this user may read everything");
        return;
    }
    assert_both(&path, "Permission denied");
}
