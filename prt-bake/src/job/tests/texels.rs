use super::super::header::Header;
use super::*;
use crate::{TexelOptions, TexelTransfer, file_info};

/// The folded sheet in two colours, laid out on the middle of an atlas: flat where it is folded, with a gap around.
fn laid_out_fold(cells: u32) -> Mesh {
    let sheet = fold(cells);
    let uv = |&[x, y, _]: &[f64; 3]| [x, y].map(|at| (0.5 + 0.9 * at) as f32);
    let source = MeshSource {
        positions: sheet.positions().to_vec(),
        albedo: sheet.albedo().to_vec(),
        uvs: sheet.positions().iter().map(uv).collect(),
        triangles: sheet.triangles().to_vec(),
        ..MeshSource::default()
    };
    Mesh::new(source, &MeshOptions::default()).unwrap().0
}

fn options() -> BakeOptions {
    BakeOptions { keep_shadowed: false, ..super::options() }
}

fn texels() -> TexelOptions {
    TexelOptions { width: 24, height: 18, gutter: 2, v_up: true }
}

fn atlas_place() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fold.exr");
    (folder, path)
}

#[test]
fn an_image_holds_what_a_bake_in_memory_gives() {
    let (folder, path) = atlas_place();
    let mesh = laid_out_fold(5);
    let source = Source { name: "fold.obj".to_owned(), sha256: "2".repeat(64) };
    let target = BakeTarget { source: Some(source.clone()), ..BakeTarget::new(&path) };
    for bounces in [0, 1, 3] {
        let options = BakeOptions { bounces, ..options() };
        let report = bake_texels_to_file(&mesh, &options, &texels(), &target, &()).unwrap();
        let (mut atlas, in_memory) = bake_texels(&mesh, &options, &texels(), &()).unwrap();
        atlas.metadata.source = Some(source.clone());
        assert_eq!(TexelTransfer::read_exr(&path).unwrap(), atlas);
        let info = file_info(&path).unwrap();
        assert_eq!(info.metadata.get("identity"), atlas.metadata.identity.as_ref());
        assert_eq!((info.tensors.len(), info.bytes), (1 + 16 * report.channels.unwrap(), report.bytes));
        assert!(info.tensors.iter().all(|tensor| tensor.shape == [18, 24] && tensor.dtype == "F32"));
        assert_eq!(report.metadata, Some(atlas.metadata));
        assert_eq!(report.channels, Some(if bounces == 0 { 1 } else { 3 }));
        assert_eq!(report.bytes, fs::metadata(&path).unwrap().len());
        assert_eq!((report.bake.rays_traced, report.bake.error), (in_memory.rays_traced, in_memory.error));
        assert_eq!(files(folder.path()), ["fold.exr"]);
    }
}

#[test]
fn a_bake_of_texels_that_stops_anywhere_goes_on_to_the_same_bytes() {
    let (folder, path) = atlas_place();
    let mesh = laid_out_fold(7);
    let whole = BakeTarget::new(&path);
    bake_texels_to_file(&mesh, &options(), &texels(), &whole, &()).unwrap();
    let expected = fs::read(&path).unwrap();
    let vertices = mesh.positions().len();
    let count = 3 * vertices;
    // While vertices are traced, while their bounces are followed, at the first texel, among the texels.
    for stop in [1, vertices / 2, vertices + 30, 2 * vertices + 1, count, count + 1, count + 150] {
        fs::remove_file(&path).unwrap();
        let error = bake_texels_to_file(&mesh, &options(), &texels(), &whole, &stop_after(stop)).unwrap_err();
        assert!(matches!(error, Error::Cancelled), "{error}");
        assert_eq!(files(folder.path()), ["fold.exr.journal"]);
        let info = journal_info(&whole.journal_path()).unwrap();
        assert_eq!((info.vertices, info.settings["width"].as_str()), (vertices, "24"));
        assert!(info.texels > 200 && info.vertices_done >= stop.min(vertices), "{info:?}");
        assert!(info.texels_done + count >= stop && info.texels_done < info.texels, "{info:?}");
        let refused = bake_texels_to_file(&mesh, &options(), &texels(), &whole, &()).unwrap_err();
        assert!(matches!(refused, Error::Unfinished { .. }), "{refused}");
        let resume = BakeTarget { unfinished: Unfinished::Resume, ..whole.clone() };
        let report = bake_texels_to_file(&mesh, &options(), &texels(), &resume, &()).unwrap();
        assert_eq!(report.bake.vertices_resumed, info.texels_done);
        assert_eq!(fs::read(&path).unwrap(), expected, "stopped after {stop}");
        assert_eq!(files(folder.path()), ["fold.exr"]);
    }
}

#[test]
fn a_torn_journal_of_texels_loses_only_what_is_torn() {
    let (_folder, path) = atlas_place();
    let mesh = laid_out_fold(5);
    let bake = |target: &BakeTarget, progress: &dyn Progress| {
        bake_texels_to_file(&mesh, &options(), &texels(), target, progress)
    };
    let target = BakeTarget { unfinished: Unfinished::Resume, ..BakeTarget::new(&path) };
    bake(&target, &()).unwrap();
    let expected = fs::read(&path).unwrap();
    fs::remove_file(&path).unwrap();
    bake(&target, &stop_after(3 * mesh.positions().len() + 200)).unwrap_err();
    let journal = fs::read(target.journal_path()).unwrap();
    for cut in (8..journal.len()).step_by(journal.len() / 13) {
        fs::write(target.journal_path(), &journal[..cut]).unwrap();
        bake(&target, &()).unwrap();
        assert_eq!(fs::read(&path).unwrap(), expected, "cut at {cut}");
        fs::remove_file(&path).unwrap();
    }
}

#[test]
fn parts_of_an_atlas_merge_to_the_same_bytes() {
    let (folder, path) = atlas_place();
    let mesh = laid_out_fold(6);
    let source = Source { name: "fold.obj".to_owned(), sha256: "3".repeat(64) };
    let target = BakeTarget { source: Some(source), ..BakeTarget::new(&path) };
    for (bounces, count) in [(0, 2), (1, 3), (3, 40)] {
        let options = BakeOptions { bounces, ..options() };
        let whole = bake_texels_to_file(&mesh, &options, &texels(), &target, &()).unwrap();
        let expected = fs::read(&path).unwrap();
        fs::remove_file(&path).unwrap();
        let parts: Vec<PathBuf> = (1..=count).map(|number| folder.path().join(format!("{number}.part"))).collect();
        for (number, part) in (1..).zip(&parts) {
            let target =
                BakeTarget { path: part.clone(), part: Some(Part::new(number, count).unwrap()), ..target.clone() };
            let report = bake_texels_to_file(&mesh, &options, &texels(), &target, &()).unwrap();
            let found = report.bake.texels.unwrap();
            let passes = found.vertices.map_or(0, |vertices| vertices.bounce_energy.len() + 1);
            assert!(report.metadata.is_none() && found.texels_inside == 0 && passes == bounces);
            assert!(journal_info(part).unwrap().is_complete);
        }
        let merged = merge_parts(&parts, &path, None, &()).unwrap();
        assert_eq!(fs::read(&path).unwrap(), expected, "{count} parts");
        let [of_whole, of_parts] = [whole, merged].map(|report| (report.bake.vertices, report.bake.texels.unwrap()));
        let same = |texels: crate::TexelReport| crate::TexelReport { vertices: None, ..texels };
        assert_eq!((format!("{:?}", of_whole.0), same(of_whole.1)), (format!("{:?}", of_parts.0), same(of_parts.1)));
        // A vertex bake of the same mesh is of another kind, and so is another size.
        let other = BakeTarget { unfinished: Unfinished::Resume, ..BakeTarget::new(&path) };
        fs::rename(&parts[0], other.journal_path()).unwrap();
        let error = bake_to_file(&mesh, &options, &other, &()).unwrap_err().to_string();
        assert!(error.contains("texels are baked there, but vertices now"), "{error}");
        let wider = TexelOptions { width: 25, ..texels() };
        let error = bake_texels_to_file(&mesh, &options, &wider, &other, &()).unwrap_err().to_string();
        assert!(error.contains("is of another bake"), "{error}");
        fs::remove_file(other.journal_path()).unwrap();
        fs::remove_file(&path).unwrap();
        parts[1..].iter().for_each(|part| fs::remove_file(part).unwrap());
    }
}

#[test]
fn an_atlas_that_is_up_to_date_is_not_baked_again() {
    let (_folder, path) = atlas_place();
    let mesh = laid_out_fold(3);
    let update = BakeTarget { update: true, ..BakeTarget::new(&path) };
    let baked = |options: &BakeOptions, texels: &TexelOptions| {
        !bake_texels_to_file(&mesh, options, texels, &update, &()).unwrap().was_up_to_date
    };
    let unshadowed = BakeOptions { shadowed: false, bounces: 0, ..options() };
    for options in [options(), unshadowed] {
        assert!(baked(&options, &texels()));
        assert!(!baked(&options, &texels()));
        assert!(baked(&options, &TexelOptions { gutter: 3, ..texels() }));
        assert!(baked(&BakeOptions { seed: 1, ..options.clone() }, &TexelOptions { gutter: 3, ..texels() }));
    }
    assert!(baked(&options(), &texels()));
    let whole = fs::read(&path).unwrap();
    for damaged in [&b"something else"[..], &whole[..whole.len() - 1], &whole[..whole.len() / 2], &whole[..2000]] {
        fs::write(&path, damaged).unwrap();
        assert!(baked(&options(), &texels()), "{} of {} bytes", damaged.len(), whole.len());
        assert_eq!(fs::read(&path).unwrap(), whole);
    }
}

#[test]
fn unshadowed_texels_have_no_parts() {
    let (folder, path) = atlas_place();
    let unshadowed = BakeOptions { shadowed: false, bounces: 0, ..options() };
    let target = BakeTarget { part: Some(Part::new(1, 2).unwrap()), ..BakeTarget::new(&path) };
    let error = bake_texels_to_file(&laid_out_fold(3), &unshadowed, &texels(), &target, &()).unwrap_err().to_string();
    assert!(error.contains("part 1/2 of transfer without shadows"), "{error}");
    assert!(files(folder.path()).is_empty());
}

#[test]
fn parts_of_texels_and_of_vertices_do_not_take_each_other_s_place() {
    let (_folder, path) = atlas_place();
    let mesh = laid_out_fold(3);
    let target = BakeTarget { part: Some(Part::new(1, 2).unwrap()), ..BakeTarget::new(&path) };
    bake_texels_to_file(&mesh, &options(), &texels(), &target, &()).unwrap();
    let error = bake_to_file(&mesh, &options(), &target, &()).unwrap_err().to_string();
    assert!(error.contains("fold.exr is of another bake: texels are baked there, but vertices now"), "{error}");
    bake_texels_to_file(&mesh, &options(), &texels(), &target, &()).unwrap();
}

#[test]
fn what_a_part_claims_is_checked_before_it_is_believed() {
    let (folder, path) = atlas_place();
    let mesh = laid_out_fold(3);
    let target = BakeTarget { part: Some(Part::new(1, 2).unwrap()), ..BakeTarget::new(&path) };
    bake_texels_to_file(&mesh, &options(), &texels(), &target, &()).unwrap();
    let header = Header::read(&Journal::open(&path).unwrap()).unwrap().unwrap();
    type Change = fn(&mut Header);
    let changes: [(Change, &str); 4] = [
        (|header| header.vertex_count = usize::MAX, "its header claims 18446744073709551615 points"),
        (|header| header.channels = 0, "points of 0 channels"),
        (|header| header.channels = 2, "points of 2 channels"),
        (|header| header.vertex_count = 1 << 40, "points of 3 channels"),
    ];
    for (change, words) in changes {
        let claimed = folder.path().join("claimed");
        let mut changed = header.clone();
        change(&mut changed);
        changed.append_to(&Journal::create(&claimed).unwrap()).unwrap();
        for error in [journal_info(&claimed).unwrap_err(), merge_parts(&[claimed], &path, None, &()).unwrap_err()] {
            assert!(error.to_string().contains(words), "{error}");
        }
    }
    // An atlas that its own header does not fit to.
    let journal = Journal::resume(&path).unwrap();
    let wider = TexelOptions { width: 25, ..texels() };
    header.clone().with_texels(&wider, header.shared_count()).append_to(&journal).unwrap();
    drop(journal);
    let other = folder.path().join("other.exr");
    let second = BakeTarget { path: other.clone(), part: Some(Part::new(2, 2).unwrap()), ..BakeTarget::new("") };
    bake_texels_to_file(&mesh, &options(), &texels(), &second, &()).unwrap();
    let journal = Journal::resume(&other).unwrap();
    let header = Header::read(&journal).unwrap().unwrap();
    header.clone().with_texels(&wider, header.shared_count()).append_to(&journal).unwrap();
    drop(journal);
    let error = merge_parts(&[path, other], &folder.path().join("all.exr"), None, &()).unwrap_err().to_string();
    assert!(error.contains("its atlas is of another size"), "{error}");
}

#[cfg(unix)]
#[test]
fn an_atlas_needs_a_file() {
    let mesh = laid_out_fold(3);
    for part in [None, Some(Part::new(1, 2).unwrap())] {
        let target = BakeTarget { part, ..BakeTarget::new("/dev/null") };
        let error = bake_texels_to_file(&mesh, &options(), &texels(), &target, &()).unwrap_err().to_string();
        assert!(error.contains("cannot write /dev/null: parts and images need a regular file"), "{error}");
    }
}
