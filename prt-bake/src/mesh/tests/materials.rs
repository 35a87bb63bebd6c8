//! What belongs to faces follows them through cleaning, and two-sided ones get their twins.

use std::sync::Arc;

use super::*;
use crate::{Texture, TextureMap, TextureWrap};

/// Red on the left, white on the right.
fn texture() -> TextureMap {
    let pixels = vec![[255, 0, 0, 255], [255; 4]];
    TextureMap::new(Arc::new(Texture::new(2, 1, pixels, [TextureWrap::ClampToEdge; 2])))
}

fn plain() -> SurfaceMaterial {
    SurfaceMaterial::default()
}

fn two_sided() -> SurfaceMaterial {
    SurfaceMaterial { two_sided: true, ..plain() }
}

/// The cube, all of one material.
fn cube_of(material: SurfaceMaterial) -> MeshSource {
    MeshSource { materials: vec![material], face_material: vec![0; 12], ..cube() }
}

/// Three triangles in a row along x, of the materials 0, 1 and none, in parts of their own; texture coordinates are the positions.
fn row() -> MeshSource {
    let corners = |x: f64| [[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0], [x, 1.0, 0.0]];
    let positions: Vec<[f64; 3]> = [0.0, 2.0, 4.0].into_iter().flat_map(corners).collect();
    MeshSource {
        uvs: positions.iter().map(|&[x, y, _]| [x as f32, y as f32]).collect(),
        albedo: vec![[0.5; 3]; 9],
        positions,
        triangles: vec![[0, 1, 2], [3, 4, 5], [6, 7, 8]],
        materials: vec![two_sided(), SurfaceMaterial { texture: Some(texture()), ..plain() }],
        face_material: vec![0, 1, SurfaceMaterial::NONE],
        parts: ["a", "b", "c"].map(str::to_owned).to_vec(),
        face_part: vec![0, 1, 2],
        ..MeshSource::default()
    }
}

fn build(source: MeshSource) -> (Mesh, MeshReport) {
    Mesh::new(source, &MeshOptions::default()).unwrap()
}

#[test]
fn faces_with_a_twin_come_behind_the_others_and_their_twins_last() {
    let (mesh, report) = build(row());
    assert_eq!((mesh.twin_count(), report.faces_twinned, report.faces_enclosed), (1, 1, 0));
    assert_eq!(mesh.triangles(), [[3, 4, 5], [6, 7, 8], [0, 1, 2], [9, 11, 10]]);
    assert_eq!(mesh.original_triangles(), &mesh.triangles()[..3]);
    assert_eq!(mesh.face_parts(), [1, 2, 0, 0]);
    assert_eq!((0..4).map(|face| mesh.material_number(face)).collect::<Vec<_>>(), [1, SurfaceMaterial::NONE, 0, 0]);
    for (original, twin) in [(0, 9), (1, 10), (2, 11)] {
        assert_eq!(mesh.positions()[original], mesh.positions()[twin]);
        assert_eq!(mesh.uvs().unwrap()[original], mesh.uvs().unwrap()[twin]);
        assert_eq!((mesh.normals()[original], mesh.normals()[twin]), ([0.0, 0.0, 1.0], [0.0, 0.0, -1.0]));
    }
}

#[test]
fn two_sidedness_is_the_files_or_the_callers() {
    let count =
        |two_sided| Mesh::new(row(), &MeshOptions { two_sided, ..MeshOptions::default() }).unwrap().0.twin_count();
    assert_eq!([TwoSided::Never, TwoSided::AsFile, TwoSided::Always].map(count), [0, 1, 3]);
    let never = Mesh::new(row(), &MeshOptions { two_sided: TwoSided::Never, ..MeshOptions::default() }).unwrap().0;
    assert_eq!(never.triangles(), row().triangles, "the order of the source");
}

#[test]
fn what_light_cannot_reach_needs_no_twin() {
    let twins = |source: MeshSource| {
        let (mesh, report) = build(source);
        (mesh.twin_count(), report.faces_enclosed)
    };
    assert_eq!(twins(cube_of(two_sided())), (0, 12));
    for (scale, offset) in [(1e-6, 0.0), (1e6, 0.0), (1.0, 1e6)] {
        let mut far = cube_of(two_sided());
        far.positions.iter_mut().flatten().for_each(|x| *x = *x * scale + offset);
        assert_eq!(twins(far), (0, 12), "scale {scale} offset {offset}");
    }
    let mut turned_inwards = cube_of(two_sided());
    turned_inwards.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    assert_eq!(twins(turned_inwards), (12, 0));
    let mut open = cube_of(two_sided());
    open.triangles.truncate(11);
    open.face_material.truncate(11);
    assert_eq!(twins(open), (11, 0));
    let mut one_turned = cube_of(two_sided());
    one_turned.triangles[0].swap(1, 2);
    assert_eq!(twins(one_turned), (12, 0));
    let lattice = SurfaceMaterial { base_color: [1.0, 1.0, 1.0, 0.1], alpha_cutoff: Some(0.5), ..two_sided() };
    assert_eq!(twins(cube_of(lattice)), (12, 0));
    let mut half = cube_of(plain());
    half.materials.push(two_sided());
    half.face_material[6..].fill(1);
    assert_eq!(twins(half), (0, 6), "one-sided faces stop light as well");
}

#[test]
fn one_part_closed_says_nothing_of_another() {
    let mut source = cube_of(two_sided());
    source.positions.extend([[5.0, 0.0, 0.0], [6.0, 0.0, 0.0], [5.0, 1.0, 0.0]]);
    source.triangles.push([8, 9, 10]);
    source.face_material.push(0);
    let (mesh, report) = build(source);
    assert_eq!((mesh.twin_count(), report.faces_enclosed, mesh.triangles().len()), (1, 12, 14));
}

#[test]
fn materials_and_parts_follow_their_faces_when_others_are_dropped() {
    let mut source = row();
    source.triangles.insert(1, [0, 0, 1]);
    source.face_material.insert(1, 0);
    source.face_part.insert(1, 2);
    source.triangles.remove(0);
    source.face_material.remove(0);
    source.face_part.remove(0);
    let (mesh, report) = build(source);
    assert_eq!((report.degenerate, report.vertices_unused), (1, 3));
    assert_eq!((mesh.face_parts(), mesh.material_number(0), mesh.triangles()[0]), (&[1, 2][..], 1, [0, 1, 2]));
    assert_eq!(mesh.albedo_at(0, [0.0, 0.0]), [1.0; 3], "the texture's right end");
}

#[test]
fn coordinates_and_tints_follow_vertices_that_are_split() {
    let mut source = cube_of(SurfaceMaterial { texture: Some(texture()), ..plain() });
    source.texture_uvs = source.positions.iter().map(|&[x, y, _]| [x as f32, y as f32]).collect();
    source.tints = source.positions.iter().map(|&[_, y, z]| [1.0, y as f32, z as f32]).collect();
    let (mesh, report) = build(source);
    assert_eq!(report.vertices_split, 16);
    for (face, triangle) in mesh.triangles().iter().enumerate() {
        let [a, b, c] = corners(mesh.positions(), *triangle);
        let q = 0.25 * a + 0.25 * b + 0.5 * c;
        let white = ((q.x - 0.25) * 2.0).clamp(0.0, 1.0);
        let expected = [1.0, white * q.y, white * q.z].map(|channel| channel as f32);
        let albedo = mesh.albedo_at(face, [0.25, 0.5]);
        assert!((0..3).all(|k| (albedo[k] - expected[k]).abs() < 1e-6), "{albedo:?} {expected:?}");
    }
}

#[test]
fn albedo_comes_from_the_texture_where_there_is_one() {
    let (mut mesh, _) = build(MeshSource { uvs: vec![[0.0, 0.0]; 9], ..row() });
    assert_eq!((mesh.albedo_at(0, [0.3, 0.3]), mesh.albedo_at(1, [0.3, 0.3])), ([1.0, 0.0, 0.0], [0.5; 3]));
    assert_eq!(mesh.channel_count(), 3);
    mesh.set_albedo([0.7; 3]).unwrap();
    assert_eq!((mesh.albedo_at(0, [0.3, 0.3]), mesh.channel_count()), ([0.7; 3], 1));
}

#[test]
fn textures_are_held_once() {
    let (mesh, _) = build(row());
    let textured = mesh.memory_bytes();
    let mut shared = row();
    shared.materials.push(SurfaceMaterial { alpha_cutoff: Some(0.5), ..shared.materials[1].clone() });
    assert_eq!(build(shared).0.memory_bytes(), textured);
    let mut without = row();
    without.materials[1].texture = None;
    assert_eq!(build(without).0.memory_bytes(), textured - 8);
}

/// Spoils something of a source.
type Spoil = fn(&mut MeshSource);

#[test]
fn wrong_numbers_are_errors() {
    let cases: [(Spoil, &str); 6] = [
        (|source| source.face_material = vec![0; 2], "2 materials for 3 faces"),
        (|source| source.face_part.push(0), "4 parts for 3 faces"),
        (|source| source.face_material[2] = 2, "face 2 has material 2, but there are 2"),
        (|source| source.face_part[1] = 3, "face 1 has part 3, but there are 3"),
        (|source| source.tints.push([1.0; 3]), "1 tints for 9 vertices"),
        (|source| source.materials[1].alpha_cutoff = Some(f32::NAN), "material 1"),
    ];
    for (spoil, message) in cases {
        let mut source = row();
        spoil(&mut source);
        let error = Mesh::new(source, &MeshOptions::default()).unwrap_err().to_string();
        assert!(error.contains(message), "{error}");
    }
}

#[test]
#[cfg(feature = "trace")]
fn whatever_decides_a_bake_is_in_the_fingerprint() {
    let hash = |change: Spoil| {
        let mut source = MeshSource { tints: vec![[0.5; 3]; 9], ..row() };
        change(&mut source);
        build(source).0.content_hash()
    };
    let plain = hash(|_| {});
    let changes: [Spoil; 8] = [
        |source| source.face_material[2] = 1,
        |source| source.materials[0].two_sided = false,
        |source| source.materials[1].alpha_cutoff = Some(0.5),
        |source| source.materials[1].base_color[3] = 0.5,
        |source| source.materials[1].texture = None,
        |source| source.materials[1].texture.iter_mut().for_each(|map| map.rotation = 1.0),
        |source| source.tints[3] = [0.25; 3],
        |source| {
            let other = Texture::new(2, 1, vec![[255, 1, 0, 255], [255; 4]], [TextureWrap::ClampToEdge; 2]);
            source.materials[1].texture = Some(TextureMap::new(Arc::new(other)));
        },
    ];
    for (number, change) in changes.into_iter().enumerate() {
        assert_ne!(hash(change), plain, "change {number}");
    }
    let names = hash(|source| (source.parts[0], source.materials[0].name) = ("z".to_owned(), "y".to_owned()));
    assert_eq!(names, plain, "names decide nothing");
}
