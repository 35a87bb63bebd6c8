//! Normals where the file gives none: angle-weighted, smooth across edges up to the crease angle.

use std::collections::HashMap;

use glam::DVec3;

use super::links::DisjointSets;
use super::{MeshReport, MeshSource, corners, unit_vector, weld_positions};

/// One corner of a face: `3 * face + k`.
type Corner = usize;

/// Makes every normal unit length; computes the missing ones, splitting vertices in which smooth patches meet at a crease.
pub(super) fn complete(source: &mut MeshSource, crease_angle: f32, report: &mut MeshReport) {
    source.normals.resize(source.positions.len(), [0.0; 3]);
    source.normals.iter_mut().for_each(|normal| *normal = unit_or_zero(*normal));
    let missing: Vec<bool> = source.normals.iter().map(|&normal| normal == [0.0; 3]).collect();
    report.normals_computed = missing.iter().filter(|&&missing| missing).count();
    if report.normals_computed > 0 {
        let patches = SmoothPatches::new(source, f64::from(crease_angle));
        assign(source, &missing, &patches, report);
    }
}

fn unit_or_zero(normal: [f32; 3]) -> [f32; 3] {
    let normal = DVec3::from_array(normal.map(f64::from));
    if normal.is_finite() { unit_vector(normal).as_vec3().to_array() } else { [0.0; 3] }
}

/// Gives each vertex the normal of its patch; a vertex in several patches is copied once for each further one.
fn assign(source: &mut MeshSource, missing: &[bool], patches: &SmoothPatches, report: &mut MeshReport) {
    let mut vertex_of: HashMap<(u32, usize), u32> = HashMap::new();
    let mut is_taken = vec![false; missing.len()];
    for corner in 0..3 * source.triangles.len() {
        let original = source.triangles[corner / 3][corner % 3];
        if !missing[original as usize] {
            continue;
        }
        let patch = patches.patch_of[corner];
        let vertex = *vertex_of.entry((original, patch)).or_insert_with(|| {
            if std::mem::replace(&mut is_taken[original as usize], true) {
                report.vertices_split += 1;
                source.copy_vertex(original)
            } else {
                original
            }
        });
        source.normals[vertex as usize] = patches.normals[patch];
        source.triangles[corner / 3][corner % 3] = vertex;
    }
}

/// The corners at each position, grouped so that two are together if smooth edges lead from one face to the other.
struct SmoothPatches {
    /// For each corner the number of its patch.
    patch_of: Vec<usize>,
    /// For each patch the sum of its faces' normals, weighted by their angle at the position; unit length.
    normals: Vec<[f32; 3]>,
}

impl SmoothPatches {
    fn new(source: &MeshSource, crease_angle: f64) -> Self {
        let face_normals: Vec<DVec3> =
            source.triangles.iter().map(|&triangle| face_normal(&source.positions, triangle)).collect();
        let welded = weld_positions(&source.positions);
        let mut links = DisjointSets::new(3 * source.triangles.len());
        link_across_edges(source, &welded, &mut links, |a, b| {
            face_normals[a].dot(face_normals[b]) >= crease_angle.cos()
        });
        Self::sum(source, &face_normals, &mut links)
    }

    fn sum(source: &MeshSource, face_normals: &[DVec3], links: &mut DisjointSets) -> Self {
        let mut number_of_root = HashMap::new();
        let mut sums: Vec<DVec3> = Vec::new();
        let mut patch_of = Vec::with_capacity(3 * source.triangles.len());
        for corner in 0..3 * source.triangles.len() {
            let patch = *number_of_root.entry(links.root(corner)).or_insert_with(|| {
                sums.push(DVec3::ZERO);
                sums.len() - 1
            });
            sums[patch] += face_normals[corner / 3] * corner_angle(source, corner);
            patch_of.push(patch);
        }
        // Faces that cancel exactly leave no direction; any unit vector keeps later code free of special cases.
        let normals = sums.iter().map(|sum| sum.normalize_or(DVec3::Z).as_vec3().to_array()).collect();
        Self { patch_of, normals }
    }
}

fn face_normal(positions: &[[f64; 3]], triangle: [u32; 3]) -> DVec3 {
    let [a, b, c] = corners(positions, triangle);
    unit_vector(unit_vector(b - a).cross(unit_vector(c - a)))
}

fn corner_angle(source: &MeshSource, corner: Corner) -> f64 {
    let at = corners(&source.positions, source.triangles[corner / 3]);
    let (p, q, r) = (at[corner % 3], at[(corner + 1) % 3], at[(corner % 3 + 2) % 3]);
    unit_vector(q - p).angle_between(unit_vector(r - p))
}

/// Links the corners of faces at both ends of every edge that `is_smooth` lets pass. Both faces of an edge must run along it in
/// opposite senses, or one is turned inside out and there is no common outside.
fn link_across_edges(
    source: &MeshSource,
    welded: &[u32],
    links: &mut DisjointSets,
    is_smooth: impl Fn(usize, usize) -> bool,
) {
    let mut edges: HashMap<(u32, u32), Vec<Corner>> = HashMap::with_capacity(3 * source.triangles.len());
    let end = |corner: Corner| welded[source.triangles[corner / 3][corner % 3] as usize];
    let next = |corner: Corner| corner / 3 * 3 + (corner + 1) % 3;
    for corner in 0..3 * source.triangles.len() {
        for &other in edges.get(&(end(next(corner)), end(corner))).into_iter().flatten() {
            if is_smooth(corner / 3, other / 3) {
                links.join(corner, next(other));
                links.join(next(corner), other);
            }
        }
        edges.entry((end(corner), end(next(corner)))).or_default().push(corner);
    }
}
