#![expect(clippy::unwrap_used, reason = "tests")]

use super::*;

mod materials;

/// A cube with eight shared vertices and quads split in two, without normals.
fn cube() -> MeshSource {
    let positions = (0..8).map(|i| [f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)]).collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    MeshSource { positions, triangles, ..MeshSource::default() }
}

#[test]
fn a_cube_is_split_at_its_creases_into_faces_with_axis_normals() {
    let (mesh, report) = Mesh::new(cube(), &MeshOptions::default()).unwrap();
    assert_eq!((mesh.positions().len(), report.vertices_split), (24, 16));
    for triangle in mesh.triangles() {
        let [a, b, c] = corners(mesh.positions(), *triangle);
        let face = (b - a).cross(c - a).normalize().as_vec3();
        for &vertex in triangle {
            assert!(face.distance(glam::Vec3::from_array(mesh.normals()[vertex as usize])) < 1e-6);
        }
    }
}

#[test]
fn a_cube_below_the_crease_angle_keeps_its_corners_with_diagonal_normals() {
    let options = MeshOptions { crease_angle: 2.0, ..MeshOptions::default() };
    let (mesh, report) = Mesh::new(cube(), &options).unwrap();
    assert_eq!((mesh.positions().len(), report.vertices_split), (8, 0));
    // Three right angles weigh alike, however many triangles share each of them.
    for (position, normal) in mesh.positions().iter().zip(mesh.normals()) {
        let diagonal = (glam::DVec3::from_array(*position) - 0.5).normalize().as_vec3();
        assert!(diagonal.distance(glam::Vec3::from_array(*normal)) < 1e-6, "{position:?} {normal:?}");
    }
}

#[test]
fn coincident_vertices_share_a_normal_but_stay_apart() {
    let mut source = cube();
    let corner = source.positions[7];
    source.positions.push(corner);
    let last = u32::try_from(source.positions.len() - 1).unwrap();
    source.triangles[3] = source.triangles[3].map(|vertex| if vertex == 7 { last } else { vertex });
    let (mesh, _) = Mesh::new(source, &MeshOptions { crease_angle: 2.0, ..MeshOptions::default() }).unwrap();
    assert_eq!(mesh.positions().len(), 9);
    assert_eq!(mesh.normals()[7], mesh.normals()[8]);
}

#[test]
fn bad_faces_are_dropped_and_counted() {
    let mut source = cube();
    source.positions.extend([[f64::NAN, 0.0, 0.0], [2.0, 0.0, 0.0], [9.0, 9.0, 9.0]]);
    let again = [source.triangles[5][1], source.triangles[5][2], source.triangles[5][0]];
    source.triangles.extend([[0, 1, 8], [0, 0, 1], [0, 1, 9], again]);
    let (mesh, report) = Mesh::new(source, &MeshOptions::default()).unwrap();
    assert_eq!((report.non_finite, report.degenerate, report.duplicate), (1, 2, 1));
    assert_eq!((report.faces_dropped(), report.vertices_unused, mesh.triangles().len()), (4, 3, 12));
}

#[test]
fn positions_that_the_baked_file_cannot_hold_are_not_finite() {
    for (largest, dropped) in [(3e38, 0), (1e39, 1), (f64::INFINITY, 1), (f64::NAN, 1)] {
        let mut source = cube();
        source.positions.push([largest, 0.0, 0.0]);
        source.triangles.push([2, 4, 8]);
        let (mesh, report) = Mesh::new(source, &MeshOptions::default()).unwrap();
        assert_eq!(report.non_finite, dropped, "{largest}");
        assert!(mesh.positions().iter().flatten().all(|&coordinate| (coordinate as f32).is_finite()));
    }
}

#[test]
fn two_sheets_back_to_back_are_no_duplicates() {
    let mut source = cube();
    source.triangles = vec![[0, 1, 2], [2, 1, 0]];
    let (mesh, report) = Mesh::new(source, &MeshOptions::default()).unwrap();
    assert_eq!((mesh.triangles().len(), report.faces_dropped()), (2, 0));
    assert_eq!(mesh.positions().len(), 6, "each sheet has its own normals");
}

#[test]
fn given_normals_are_kept_and_made_unit_length() {
    let mut source = cube();
    source.normals = vec![[0.0, 0.0, 3.0]; 8];
    source.normals[0] = [f32::NAN, 0.0, 0.0];
    let (mesh, report) = Mesh::new(source, &MeshOptions::default()).unwrap();
    assert_eq!(mesh.normals()[1], [0.0, 0.0, 1.0]);
    assert_eq!(report.normals_computed, 1);
}

#[test]
fn a_mesh_without_a_usable_face_is_an_error() {
    for triangles in [vec![], vec![[0, 0, 1]]] {
        let error = Mesh::new(MeshSource { triangles, ..cube() }, &MeshOptions::default()).unwrap_err();
        assert!(matches!(error, Error::EmptyMesh { .. }), "{error}");
    }
    assert!(Mesh::new(MeshSource::default(), &MeshOptions::default()).is_err());
}

#[test]
fn inconsistent_sources_are_errors() {
    let past_end = MeshSource { triangles: vec![[0, 1, 8]], ..cube() };
    assert!(Mesh::new(past_end, &MeshOptions::default()).unwrap_err().to_string().contains("face 0"));
    let short = MeshSource { normals: vec![[0.0; 3]; 7], ..cube() };
    assert!(Mesh::new(short, &MeshOptions::default()).unwrap_err().to_string().contains("7 normals for 8"));
}

#[test]
fn size_and_place_do_not_matter_for_normals() {
    let (reference, _) = Mesh::new(cube(), &MeshOptions::default()).unwrap();
    for (scale, offset) in [(1e-6, 0.0), (1e6, 0.0), (1.0, 1e6), (1e-36, 0.0)] {
        let mut source = cube();
        source.positions.iter_mut().flatten().for_each(|coordinate| *coordinate = *coordinate * scale + offset);
        let (mesh, _) = Mesh::new(source, &MeshOptions::default()).unwrap();
        assert_eq!(mesh.normals(), reference.normals(), "scale {scale} offset {offset}");
    }
}

#[test]
fn a_scene_smaller_than_the_baked_file_can_hold_is_an_error() {
    for scale in [1e-40, 1e-160, 1e-310, 1e-320] {
        let mut source = cube();
        source.positions.iter_mut().flatten().for_each(|coordinate| *coordinate *= scale);
        let error = Mesh::new(source, &MeshOptions::default()).unwrap_err().to_string();
        assert!(error.contains("12 are degenerate"), "{scale}: {error}");
    }
}

#[test]
fn a_scene_that_is_small_beside_something_far_away_is_warned_of() {
    for (distance, is_warned) in [(10.0, false), (1e4, false), (1e6, true), (1e9, true)] {
        let mut source = cube();
        source.positions.extend([[distance, 0.0, 0.0], [distance, 1.0, 0.0], [distance, 0.0, 1.0]]);
        source.triangles.push([8, 9, 10]);
        let warnings = Mesh::new(source, &MeshOptions::default()).unwrap().1.warnings;
        assert_eq!(
            warnings.iter().any(|warning| warning.contains("13 of 13 faces")),
            is_warned,
            "{distance}: {warnings:?}"
        );
    }
}

#[test]
fn missing_albedo_is_filled_in_and_the_rest_limited() {
    let mut source = cube();
    source.albedo = vec![[0.5, 2.0, -1.0]; 8];
    source.albedo[3] = [f32::NAN; 3];
    let (mesh, _) = Mesh::new(source, &MeshOptions { crease_angle: 2.0, ..MeshOptions::default() }).unwrap();
    assert_eq!(mesh.albedo()[0], [0.5, 1.0, 0.0]);
    assert_eq!(mesh.albedo()[3], [0.8; 3]);
}
