#![expect(clippy::unwrap_used, reason = "tests")]

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use sh_core::Order;

use super::*;
use crate::{
    BakeOptions, BakedSurface, Error, InsidePolicy, Mesh, MeshOptions, MeshSource, Progress, Source, VertexStats,
    bake_diffuse,
};

mod texels;

/// A folded sheet in two colours: every vertex sees another.
fn fold(cells: u32) -> Mesh {
    let mut source = MeshSource::default();
    for i in 0..=cells {
        for j in 0..=cells {
            let [x, y] = [i, j].map(|k| f64::from(k) / f64::from(cells) - 0.5);
            source.positions.push([x, y, 1.5 * x.abs()]);
            source.albedo.push(if i % 2 == 0 { [0.9, 0.3, 0.1] } else { [0.5; 3] });
            if i < cells && j < cells {
                let a = i * (cells + 1) + j;
                let [b, c, d] = [a + cells + 1, a + cells + 2, a + 1];
                source.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    Mesh::new(source, &MeshOptions::default()).unwrap().0
}

/// The sheet, and a box that stands through it: some of its vertices are inside.
fn pierced_fold(cells: u32) -> Mesh {
    let sheet = fold(cells);
    let first = u32::try_from(sheet.positions().len()).unwrap();
    let mut source = MeshSource {
        positions: sheet.positions().to_vec(),
        triangles: sheet.triangles().to_vec(),
        ..MeshSource::default()
    };
    let corner = |i: u32| [0.3 * f64::from(i & 1) + 0.05, 0.3 * f64::from(i >> 1 & 1), f64::from(i >> 2) - 0.2];
    source.positions.extend((0..8).map(corner));
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    source.triangles.extend(faces.map(|face| face.map(|vertex| first + vertex)));
    Mesh::new(source, &MeshOptions::default()).unwrap().0
}

fn options() -> BakeOptions {
    let order = Order::new(4).unwrap();
    BakeOptions { order, rays_per_vertex: 256, bounces: 3, keep_shadowed: true, ..BakeOptions::default() }
}

/// A folder of its own, and the name of a file there.
fn place() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fold.prt");
    (folder, path)
}

/// Cancels after some vertices.
struct StopAfter(AtomicUsize);

impl Progress for StopAfter {
    fn advance(&self, vertices: usize, _rays: u64) {
        let left = self.0.load(Ordering::Relaxed);
        self.0.store(left.saturating_sub(vertices), Ordering::Relaxed);
    }

    fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed) == 0
    }
}

fn stop_after(vertices: usize) -> StopAfter {
    StopAfter(AtomicUsize::new(vertices))
}

fn files(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_file_holds_what_a_bake_in_memory_gives() {
    let (folder, path) = place();
    let mesh = fold(9);
    let source = Source { name: "fold.obj".to_owned(), sha256: "0".repeat(64) };
    let target = BakeTarget { source: Some(source.clone()), ..BakeTarget::new(&path) };
    let report = bake_to_file(&mesh, &options(), &target, &()).unwrap();
    let (mut baked, in_memory) = bake_diffuse(&mesh, &options(), &()).unwrap();
    baked.metadata.source = Some(source);
    assert_eq!(BakedSurface::read(&path).unwrap(), baked);
    assert_eq!((report.bytes, report.channels), (fs::metadata(&path).unwrap().len(), Some(3)));
    assert_eq!(report.bake.rays_traced, in_memory.rays_traced);
    assert_eq!(report.bake.bounce_energy, in_memory.bounce_energy);
    assert_eq!(files(folder.path()), ["fold.prt"]);
}

#[test]
fn a_bake_that_stops_anywhere_goes_on_to_the_same_bytes() {
    let (folder, path) = place();
    let mesh = fold(9);
    let whole = BakeTarget::new(&path);
    bake_to_file(&mesh, &options(), &whole, &()).unwrap();
    let expected = fs::read(&path).unwrap();
    let vertices = mesh.positions().len();
    // In the first pass, at its end, in each of the bounces.
    for stop in [1, vertices / 2, vertices, vertices + 1, 2 * vertices + 30, 3 * vertices + 60] {
        fs::remove_file(&path).unwrap();
        let error = bake_to_file(&mesh, &options(), &whole, &stop_after(stop)).unwrap_err();
        assert!(matches!(error, Error::Cancelled), "{error}");
        assert_eq!(files(folder.path()), ["fold.prt.journal"]);
        let refused = bake_to_file(&mesh, &options(), &whole, &()).unwrap_err().to_string();
        assert!(refused.contains("fold.prt.journal holds an unfinished bake"), "{refused}");
        let resume = BakeTarget { unfinished: Unfinished::Resume, ..whole.clone() };
        let report = bake_to_file(&mesh, &options(), &resume, &()).unwrap();
        assert!(report.bake.vertices_resumed >= stop.min(vertices), "{stop}: {}", report.bake.vertices_resumed);
        assert_eq!(fs::read(&path).unwrap(), expected, "stopped after {stop}");
        assert_eq!(files(folder.path()), ["fold.prt"]);
    }
}

#[test]
fn a_journal_that_is_torn_anywhere_loses_only_what_is_torn() {
    let (_folder, path) = place();
    let mesh = fold(6);
    let target = BakeTarget { unfinished: Unfinished::Resume, ..BakeTarget::new(&path) };
    bake_to_file(&mesh, &options(), &target, &()).unwrap();
    let expected = fs::read(&path).unwrap();
    fs::remove_file(&path).unwrap();
    bake_to_file(&mesh, &options(), &target, &stop_after(2 * mesh.positions().len())).unwrap_err();
    let journal = fs::read(target.journal_path()).unwrap();
    let cuts = (0..12).chain((12..journal.len()).step_by(journal.len() / 23)).chain([journal.len() - 1]);
    for cut in cuts {
        let mut torn = journal[..cut].to_vec();
        // What a disk may leave behind after a power failure.
        torn.extend(std::iter::repeat_n(0, cut % 3 * 50));
        let is_empty_file = torn.len() < 8;
        fs::write(target.journal_path(), &torn).unwrap();
        match bake_to_file(&mesh, &options(), &target, &()) {
            Ok(_) => assert_eq!(fs::read(&path).unwrap(), expected, "cut at {cut}"),
            Err(error) => {
                // Not a journal at all: it is not ours to overwrite.
                assert!(!is_empty_file && cut < 8, "cut at {cut}: {error}");
                assert!(error.to_string().contains("fold.prt.journal is not a valid bake journal"), "{error}");
            }
        }
        let _ = fs::remove_file(&path);
    }
}

#[test]
fn a_changed_byte_in_a_journal_is_noticed() {
    let (_folder, path) = place();
    let mesh = fold(5);
    let target = BakeTarget { unfinished: Unfinished::Resume, ..BakeTarget::new(&path) };
    bake_to_file(&mesh, &options(), &target, &()).unwrap();
    let expected = fs::read(&path).unwrap();
    fs::remove_file(&path).unwrap();
    bake_to_file(&mesh, &options(), &target, &stop_after(2 * mesh.positions().len())).unwrap_err();
    let journal = fs::read(target.journal_path()).unwrap();
    let mut least_resumed = usize::MAX;
    for place in (8..journal.len()).step_by(journal.len() / 40) {
        let mut changed = journal.clone();
        changed[place] ^= 0x10;
        fs::write(target.journal_path(), &changed).unwrap();
        match bake_to_file(&mesh, &options(), &target, &()) {
            Ok(report) => {
                assert_eq!(fs::read(&path).unwrap(), expected, "byte {place} changed");
                least_resumed = least_resumed.min(report.bake.vertices_resumed);
                fs::remove_file(&path).unwrap();
            }
            // What the journal is for cannot be known: it is not thrown away.
            Err(error) => {
                assert!(place < 400 && error.to_string().contains("first record is damaged"), "{place}: {error}");
                assert_eq!(fs::read(target.journal_path()).unwrap(), changed);
            }
        }
    }
    // One block of 16 at most, unless its length was hit and all after it is lost.
    assert!(least_resumed < usize::MAX, "none was resumed");
    let mut changed = journal.clone();
    changed[journal.len() / 3] ^= 0x10;
    fs::write(target.journal_path(), &changed).unwrap();
    let report = bake_to_file(&mesh, &options(), &target, &()).unwrap();
    assert!(report.bake.vertices_resumed + 16 >= mesh.positions().len(), "{}", report.bake.vertices_resumed);
}

#[test]
fn parts_merge_to_the_same_bytes_in_any_order() {
    let (folder, path) = place();
    let mesh = fold(9);
    let source = Source { name: "fold.obj".to_owned(), sha256: "1".repeat(64) };
    let target = BakeTarget { source: Some(source), ..BakeTarget::new(&path) };
    bake_to_file(&mesh, &options(), &target, &()).unwrap();
    let expected = fs::read(&path).unwrap();
    fs::remove_file(&path).unwrap();
    // More parts than blocks too: some have nothing to do.
    for count in [1, 2, 3, 11] {
        let mut parts: Vec<PathBuf> = (1..=count).map(|number| folder.path().join(format!("{number}.part"))).collect();
        for (number, part) in (1..).zip(&parts) {
            let target =
                BakeTarget { path: part.clone(), part: Some(Part::new(number, count).unwrap()), ..target.clone() };
            let report = bake_to_file(&mesh, &options(), &target, &()).unwrap();
            assert!(report.metadata.is_none() && journal_info(part).unwrap().is_complete);
        }
        parts.rotate_left(1);
        merge_parts(&parts, &path, None, &()).unwrap();
        assert_eq!(fs::read(&path).unwrap(), expected, "{count} parts");
        let twice = [parts.as_slice(), &parts[..1]].concat();
        let error = merge_parts(&twice, &path, None, &()).unwrap_err().to_string();
        assert!(error.contains("are both part"), "{error}");
        if count > 1 {
            let error = merge_parts(&parts[1..], &path, None, &()).unwrap_err().to_string();
            assert!(error.contains("missing: 2"), "{error}");
        }
        parts.iter().for_each(|part| fs::remove_file(part).unwrap());
    }
}

#[test]
fn vertices_inside_are_filled_alike_in_one_run_and_in_parts() {
    let (folder, path) = place();
    let mesh = pierced_fold(12);
    let report = bake_to_file(&mesh, &options(), &BakeTarget::new(&path), &()).unwrap();
    assert!((3..60).contains(&report.bake.invalid_vertices), "{}", report.bake.invalid_vertices);
    let whole = BakedSurface::read(&path).unwrap();
    let expected = fs::read(&path).unwrap();
    let parts = [1, 2, 3].map(|number| {
        let path = folder.path().join(number.to_string());
        let target = BakeTarget { part: Some(Part::new(number, 3).unwrap()), ..BakeTarget::new(path) };
        bake_to_file(&mesh, &options(), &target, &()).unwrap();
        target.path
    });
    merge_parts(&parts, &path, None, &()).unwrap();
    assert_eq!(fs::read(&path).unwrap(), expected);

    let baked = |inside| bake_diffuse(&mesh, &BakeOptions { inside, ..options() }, &()).unwrap().0;
    let (kept, black) = (baked(InsidePolicy::Keep), baked(InsidePolicy::Black));
    let validity = whole.validity.clone().unwrap();
    for (vertex, _) in validity.iter().enumerate().filter(|(_, validity)| **validity < VertexStats::VALID) {
        let dc = |surface: &BakedSurface| surface.transfer.vector(vertex, 0)[0];
        assert!(dc(&whole) > dc(&kept) && dc(&black) == 0.0, "{vertex}");
    }
    // All others sees the fill only by what is reflected.
    let direct = |surface: &BakedSurface| surface.transfer_shadowed.clone().unwrap();
    let (filled, kept) = (direct(&whole), direct(&kept));
    let valid = (0..validity.len()).filter(|&vertex| validity[vertex] >= VertexStats::VALID);
    valid.for_each(|vertex| assert_eq!(filled.vector(vertex, 0), kept.vector(vertex, 0)));
}

#[test]
fn bounces_stop_when_they_add_too_little() {
    let mesh = fold(9);
    let all = BakeOptions { bounces: 8, ..options() };
    let energies = bake_diffuse(&mesh, &all, &()).unwrap().1.bounce_energy;
    assert_eq!(energies.len(), 8);
    let threshold = 0.5 * (energies[2] + energies[3]);
    let (baked, report) =
        bake_diffuse(&mesh, &BakeOptions { bounce_threshold: Some(threshold), ..all.clone() }, &()).unwrap();
    assert_eq!(report.bounce_energy, energies[..4]);
    assert_eq!(baked.metadata.bounces, 4);
    assert_eq!(baked.transfer, bake_diffuse(&mesh, &BakeOptions { bounces: 4, ..all }, &()).unwrap().0.transfer);
}

#[test]
fn what_does_not_belong_together_is_refused_by_name() {
    let (folder, path) = place();
    let mesh = fold(6);
    let resume = BakeTarget { unfinished: Unfinished::Resume, ..BakeTarget::new(&path) };
    bake_to_file(&mesh, &options(), &resume, &stop_after(20)).unwrap_err();
    let other = BakeOptions { rays_per_vertex: 128, ..options() };
    let error = bake_to_file(&mesh, &other, &resume, &()).unwrap_err().to_string();
    assert!(error.contains("is of another bake: rays per vertex is 256 there, but 128 now"), "{error}");
    let error = bake_to_file(&fold(7), &options(), &resume, &()).unwrap_err().to_string();
    assert!(error.contains("the mesh is another one"), "{error}");
    // The number of threads may change.
    bake_to_file(&mesh, &BakeOptions { threads: Some(1), ..options() }, &resume, &()).unwrap();

    let part = |number, name: &str, options: &BakeOptions| {
        let part = Part::new(number, 2).unwrap();
        let target = BakeTarget { path: folder.path().join(name), part: Some(part), ..BakeTarget::new("") };
        bake_to_file(&mesh, options, &target, &()).unwrap();
        target.path
    };
    let parts = [part(1, "a", &options()), part(2, "b", &other)];
    let error = merge_parts(&parts, &path, None, &()).unwrap_err().to_string();
    assert!(error.contains("b is of another bake: rays per vertex"), "{error}");
    let error = merge_parts(std::slice::from_ref(&path), &path, None, &()).unwrap_err().to_string();
    assert!(error.contains("fold.prt is not a valid bake journal"), "{error}");
    assert!(merge_parts(&[], &path, None, &()).is_err());
}

#[test]
fn what_holds_nothing_is_not_kept_and_what_holds_something_is_not_overwritten() {
    let (folder, path) = place();
    let mesh = fold(6);
    bake_to_file(&mesh, &options(), &BakeTarget::new(&path), &stop_after(0)).unwrap_err();
    assert!(files(folder.path()).is_empty());

    let other = BakeOptions { seed: 9, ..options() };
    bake_to_file(&mesh, &other, &BakeTarget::new(&path), &stop_after(20)).unwrap_err();
    let parts = [1, 2].map(|number| {
        let target = BakeTarget {
            part: Some(Part::new(number, 2).unwrap()),
            ..BakeTarget::new(folder.path().join(number.to_string()))
        };
        bake_to_file(&mesh, &options(), &target, &()).unwrap();
        target.path
    });
    let error = merge_parts(&parts, &path, None, &()).unwrap_err();
    assert!(matches!(error, Error::Unfinished { .. }), "{error}");
    let discard = BakeTarget { unfinished: Unfinished::Discard, ..BakeTarget::new(&path) };
    bake_to_file(&mesh, &options(), &discard, &()).unwrap();
    assert_eq!(files(folder.path()), ["1", "2", "fold.prt"]);
}

#[test]
fn what_killed_bakes_left_half_written_is_removed() {
    let (folder, path) = place();
    for name in [".fold.prtAbC123.part", ".fold.prtother.prt", ".other.prtAbC123.part", "fold.prtAbC123.part"] {
        fs::write(folder.path().join(name), "x").unwrap();
    }
    bake_to_file(&fold(3), &options(), &BakeTarget::new(&path), &()).unwrap();
    assert_eq!(
        files(folder.path()),
        [".fold.prtother.prt", ".other.prtAbC123.part", "fold.prt", "fold.prtAbC123.part"]
    );
}

#[test]
fn a_part_takes_the_place_of_nothing_else() {
    let (_folder, path) = place();
    let mesh = fold(4);
    let part = |number| BakeTarget { part: Some(Part::new(number, 2).unwrap()), ..BakeTarget::new(&path) };
    let bake = |target: &BakeTarget| bake_to_file(&mesh, &options(), target, &()).map(|_| ());
    bake(&part(1)).unwrap();
    bake(&part(1)).unwrap();
    let error = bake(&part(2)).unwrap_err().to_string();
    assert!(error.contains("part 1/2 is in") && error.contains("fold.prt"), "{error}");
    bake(&BakeTarget::new(&path)).unwrap();
    let error = bake(&part(1)).unwrap_err().to_string();
    assert!(error.contains("fold.prt is no part"), "{error}");
}

#[test]
fn a_journal_is_written_by_one_bake_at_a_time() {
    let (_folder, path) = place();
    let target = BakeTarget { unfinished: Unfinished::Resume, ..BakeTarget::new(&path) };
    let held = Journal::create(&target.journal_path()).unwrap();
    let error = bake_to_file(&fold(3), &options(), &target, &()).unwrap_err().to_string();
    assert!(error.contains("another bake is writing it"), "{error}");
    drop(held);
    bake_to_file(&fold(3), &options(), &target, &()).unwrap();
}

#[test]
fn what_is_up_to_date_is_not_baked_again() {
    let (_folder, path) = place();
    let update = BakeTarget { update: true, ..BakeTarget::new(&path) };
    let baked = |mesh: &Mesh, options: &BakeOptions| !bake_to_file(mesh, options, &update, &()).unwrap().was_up_to_date;
    assert!(baked(&fold(4), &options()), "there is no file yet");
    assert!(!baked(&fold(4), &options()));
    assert!(!baked(&fold(4), &BakeOptions { threads: Some(1), ..options() }));
    assert!(baked(&fold(4), &BakeOptions { seed: 1, ..options() }));
    assert!(baked(&fold(4), &options()), "the file is of another seed");
    let mut repainted = fold(4);
    repainted.set_albedo([0.5; 3]).unwrap();
    assert!(baked(&repainted, &options()));
    fs::write(&path, b"something else").unwrap();
    assert!(baked(&repainted, &options()));
}

/// The two halves of a bake.
fn two_parts(mesh: &Mesh, folder: &Path) -> [PathBuf; 2] {
    [1, 2].map(|number| {
        let path = folder.join(format!("{number}.part"));
        let target = BakeTarget { part: Some(Part::new(number, 2).unwrap()), ..BakeTarget::new(&path) };
        bake_to_file(mesh, &options(), &target, &()).unwrap();
        path
    })
}

#[test]
fn a_part_with_a_damaged_block_is_not_complete() {
    let (folder, path) = place();
    let parts = two_parts(&fold(6), folder.path());
    assert!(journal_info(&parts[0]).unwrap().is_complete);
    let key = Journal::open(&parts[0]).unwrap().keys()[0];
    let whole = fs::read(&parts[0]).unwrap();
    let payload = {
        let mut payload = Vec::new();
        Journal::open(&parts[0]).unwrap().read(key, &mut payload).unwrap();
        payload
    };
    let start = whole.windows(payload.len()).position(|window| window == payload).unwrap();
    let mut damaged = whole.clone();
    damaged[start] ^= 1;
    fs::write(&parts[0], damaged).unwrap();
    let info = journal_info(&parts[0]).unwrap();
    assert!(!info.is_complete && info.vertices_done < info.vertices, "{info:?}");
    let error = merge_parts(&parts, &path, None, &()).unwrap_err().to_string();
    assert!(error.contains("1.part is not a valid bake journal file: blocks are damaged"), "{error}");
    assert_eq!(files(folder.path()), ["1.part", "2.part"]);
}

#[test]
fn a_merge_keeps_what_it_did_not_make_and_leaves_nothing_if_it_fails() {
    let (folder, path) = place();
    let mesh = fold(6);
    let parts = two_parts(&mesh, folder.path());
    let error = merge_parts(&parts, &path, None, &stop_after(0)).unwrap_err();
    assert!(matches!(error, Error::Cancelled), "{error}");
    assert_eq!(files(folder.path()), ["1.part", "2.part"]);
    // A journal of which nobody knows what it is for, for its first record is damaged.
    let target = BakeTarget::new(&path);
    bake_to_file(&mesh, &options(), &target, &stop_after(40)).unwrap_err();
    let mut journal = fs::read(target.journal_path()).unwrap();
    journal[40] ^= 1;
    fs::write(target.journal_path(), &journal).unwrap();
    let error = merge_parts(&parts, &path, None, &()).unwrap_err().to_string();
    assert!(
        error.contains("fold.prt.journal is not a valid bake journal file: its first record is damaged"),
        "{error}"
    );
    assert_eq!(fs::read(target.journal_path()).unwrap(), journal);
}

#[cfg(unix)]
#[test]
fn a_part_needs_a_file() {
    let target = BakeTarget { part: Some(Part::new(1, 2).unwrap()), ..BakeTarget::new("/dev/null") };
    let error = bake_to_file(&fold(3), &options(), &target, &()).unwrap_err().to_string();
    assert!(error.contains("cannot write /dev/null: parts and images need a regular file"), "{error}");
    bake_to_file(&fold(3), &options(), &BakeTarget::new("/dev/null"), &()).unwrap();
}
