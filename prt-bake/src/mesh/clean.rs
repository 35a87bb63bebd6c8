//! Checking a source and dropping what cannot be used.

use std::collections::HashSet;

use glam::DVec3;

use super::{Mesh, MeshReport, MeshSource, corners, weld_positions};
use crate::{Error, SurfaceMaterial};

/// A face is degenerate if twice its area is at most about this fraction of its longest edge squared. Three points on a line, rounded
/// to `f32` far from the origin, must fall below it; a sliver of 1 : 10⁶ must not.
const DEGENERATE_ASPECT: f64 = 1e-9;

/// Checks that arrays that belong together have one length and that faces point at vertices.
pub(super) fn check_shapes(source: &MeshSource) -> Result<(), Error> {
    let vertex_count = source.positions.len();
    if u32::try_from(vertex_count).is_err() {
        return Err(Error::InconsistentMesh(format!("{vertex_count} vertices; at most {} are supported", u32::MAX)));
    }
    let of_vertices = [
        ("normals", source.normals.len()),
        ("uvs", source.uvs.len()),
        ("albedo", source.albedo.len()),
        ("texture uvs", source.texture_uvs.len()),
        ("tints", source.tints.len()),
    ];
    of_vertices.into_iter().try_for_each(|(what, length)| check_length(what, length, "vertices", vertex_count))?;
    check_length("materials", source.face_material.len(), "faces", source.triangles.len())?;
    check_length("parts", source.face_part.len(), "faces", source.triangles.len())?;
    check_numbers(source)?;
    let past_end =
        source.triangles.iter().position(|triangle| triangle.iter().any(|&vertex| vertex as usize >= vertex_count));
    match past_end {
        Some(face) => Err(Error::InconsistentMesh(format!(
            "face {face} uses vertices {:?}, but there are {vertex_count}",
            source.triangles[face]
        ))),
        None => Ok(()),
    }
}

fn check_length(what: &str, length: usize, of: &str, count: usize) -> Result<(), Error> {
    if length != 0 && length != count {
        return Err(Error::InconsistentMesh(format!("{length} {what} for {count} {of}")));
    }
    Ok(())
}

/// Checks the numbers of materials and parts, and the numbers in materials.
fn check_numbers(source: &MeshSource) -> Result<(), Error> {
    let past_end = |number: u32, count: usize| number != SurfaceMaterial::NONE && number as usize >= count;
    for (what, numbers, count) in
        [("material", &source.face_material, source.materials.len()), ("part", &source.face_part, source.parts.len())]
    {
        if let Some(face) = numbers.iter().position(|&number| past_end(number, count)) {
            let number = numbers[face];
            return Err(Error::InconsistentMesh(format!("face {face} has {what} {number}, but there are {count}")));
        }
    }
    let is_bad = |material: &SurfaceMaterial| {
        !material.base_color.iter().chain(&material.alpha_cutoff).all(|value| value.is_finite())
    };
    match source.materials.iter().position(is_bad) {
        Some(material) => Err(Error::InconsistentMesh(format!("the numbers of material {material} are not finite"))),
        None => Ok(()),
    }
}

/// Drops faces that are not finite, have no area, or repeat an earlier one.
pub(super) fn drop_bad_faces(source: &mut MeshSource, report: &mut MeshReport) -> Result<(), Error> {
    let given = source.triangles.len();
    let welded = weld_positions(&source.positions);
    let mut seen = HashSet::with_capacity(given);
    let positions = &source.positions;
    let mut is_good = |&triangle: &[u32; 3]| {
        let counter = if !is_finite(positions, triangle) {
            &mut report.non_finite
        } else if is_degenerate(positions, triangle) {
            &mut report.degenerate
        } else if !seen.insert(smallest_first(triangle.map(|vertex| welded[vertex as usize]))) {
            &mut report.duplicate
        } else {
            return true;
        };
        *counter += 1;
        false
    };
    let good: Vec<bool> = source.triangles.iter().map(&mut is_good).collect();
    source.retain_faces(&good);
    if source.triangles.is_empty() {
        return Err(Error::EmptyMesh { reason: why_empty(given, report) });
    }
    Ok(())
}

fn why_empty(given: usize, report: &MeshReport) -> String {
    match given {
        0 => "it has no faces".to_owned(),
        _ => format!("of {given} faces, {} are degenerate and {} not finite", report.degenerate, report.non_finite),
    }
}

/// A position that `f32` cannot hold would be infinite in the baked file.
fn is_finite(positions: &[[f64; 3]], triangle: [u32; 3]) -> bool {
    let largest = f64::from(f32::MAX);
    triangle.iter().flat_map(|&vertex| positions[vertex as usize]).all(|coordinate| coordinate.abs() <= largest)
}

/// Edges are measured in units of the longest one, so that nothing over- or underflows at any scale that the baked file can hold.
fn is_degenerate(positions: &[[f64; 3]], triangle: [u32; 3]) -> bool {
    let [a, b, c] = corners(positions, triangle);
    let edges = [b - a, c - b, a - c];
    let unit = edges.iter().map(|edge| edge.abs().max_element()).fold(0.0, f64::max);
    unit < f64::from(f32::MIN_POSITIVE) || (edges[0] / unit).cross(edges[1] / unit).length() <= DEGENERATE_ASPECT
}

/// A face is small if its edges are shorter than this share of the scene: fifty times the distance beside it at which rays start.
const SMALL: f64 = 1.2e-5;

/// Where more than this share of the faces is small, what is to be baked is small beside something else.
const MANY: f64 = 0.01;

/// Says so if what is to be baked is so small beside the whole scene that its shadows are wrong: rays are traced in `f32`, in a frame that
/// holds all of it.
pub(super) fn warn_of_small_faces(mesh: &Mesh) -> Option<String> {
    let (positions, triangles) = (mesh.positions(), mesh.triangles());
    let [lower, upper] = mesh.bounds().map(DVec3::from_array);
    let small = SMALL * (upper - lower).max_element();
    let is_small = |&&triangle: &&[u32; 3]| {
        let [a, b, c] = corners(positions, triangle);
        [b - a, c - b, a - c].iter().all(|edge| edge.abs().max_element() < small)
    };
    let count = triangles.iter().filter(is_small).count();
    (count as f64 > MANY * triangles.len() as f64).then(|| {
        let of = triangles.len();
        format!("{count} of {of} faces are smaller than 1/80,000 of the scene and lose their shadows: bake them without what is far away")
    })
}

/// The same cycle of three, starting with the smallest: equal for faces that differ only in which corner comes first.
fn smallest_first([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a <= b && a <= c {
        [a, b, c]
    } else if b <= a && b <= c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

/// Drops vertices that no face uses; the others keep their order.
pub(super) fn drop_unused_vertices(source: &mut MeshSource, report: &mut MeshReport) {
    let mut used = vec![false; source.positions.len()];
    source.triangles.iter().flatten().for_each(|&vertex| used[vertex as usize] = true);
    report.vertices_unused = used.iter().filter(|&&used| !used).count();
    if report.vertices_unused == 0 {
        return;
    }
    source.retain_vertices(&used);
    let new_number = new_numbers(&used);
    source.triangles.iter_mut().flatten().for_each(|vertex| *vertex = new_number[*vertex as usize]);
}

fn new_numbers(used: &[bool]) -> Vec<u32> {
    let mut next = 0;
    let number = |&used: &bool| {
        let number = next;
        next += u32::from(used);
        number
    };
    used.iter().map(number).collect()
}

/// Fills in the albedo that the file does not give, and limits the rest to 0 to 1.
pub(super) fn complete_albedo(albedo: &mut Vec<[f32; 3]>, vertex_count: usize, default: [f32; 3]) {
    albedo.resize(vertex_count, default);
    for value in albedo {
        *value = if value.iter().all(|channel| channel.is_finite()) {
            value.map(|channel| channel.clamp(0.0, 1.0))
        } else {
            default
        };
    }
}

/// Limits colours to 0 to 1; what is not finite is white.
pub(super) fn limit_tints(tints: &mut [[f32; 3]]) {
    for channel in tints.iter_mut().flatten() {
        *channel = if channel.is_finite() { channel.clamp(0.0, 1.0) } else { 1.0 };
    }
}
