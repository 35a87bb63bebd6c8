//! The vertices of another mesh, found on a skinned one.

use std::collections::HashMap;

use glam::DVec3;

use crate::{Error, Skin, SkinnedMesh};

/// Largest distance between partners, as a fraction of the diagonal of the skinned mesh: far above what rounding to `f32` and another order
/// of multiplications change, far below any detail.
const RELATIVE_TOLERANCE: f64 = 1e-5;

/// Partners whose distances differ by less than this fraction of the tolerance stand at one place, and their normals decide.
const SAME_PLACE: f64 = 0.25;

/// Normals that are so near to one another count as equal: far above rounding, far below what is smoothed or creased.
const SAME_NORMAL: f64 = 1e-5;

/// How the vertices of another mesh, such as a baked one, follow the joints of a [`SkinnedMesh`].
#[derive(Debug, Clone, PartialEq)]
pub struct Binding {
    /// For each vertex of the other mesh the vertex of the skinned one that stands at its place.
    pub sources: Vec<u32>,
    /// The skin of the other mesh: positions of those vertices, with the other mesh's normals.
    pub skin: Skin,
}

impl SkinnedMesh {
    /// Finds for each vertex of another mesh its joints and weights: those of the nearest vertex in the rest pose, and among several at
    /// one place of the one with the most similar normal. Where several have that too (parts that hide one another), the meshes are taken to be
    /// in the same order, as a baked mesh and its file are.
    ///
    /// A partner is at most 1e-5 of the diagonal away, and four rounding errors of the largest coordinate.
    ///
    /// - `positions`, `normals`: `[W]`, of the other mesh
    ///
    /// # Errors
    /// [`Error::Unbound`] if vertices have no partner: the other mesh was made from another file, moved, or not in the rest pose.
    ///
    /// # Panics
    /// If lengths differ.
    pub fn bind_to(&self, positions: &[[f32; 3]], normals: &[[f32; 3]]) -> Result<Binding, Error> {
        assert_eq!(normals.len(), positions.len(), "one normal for each vertex is needed");
        let places = Places::new(self.positions(), self.normals());
        let mut previous = None;
        let found: Vec<Option<u32>> = positions
            .iter()
            .zip(normals)
            .map(|(position, normal)| {
                previous = places.nearest(vector(position), vector(normal), previous);
                previous
            })
            .collect();
        let unbound = found.iter().filter(|source| source.is_none()).count();
        if let Some(first) = found.iter().position(Option::is_none) {
            let (vertices, tolerance) = (positions.len(), places.tolerance);
            return Err(Error::Unbound { unbound, vertices, first, tolerance });
        }
        let sources: Vec<u32> = found.into_iter().flatten().collect();
        let skin = self.skin.gather(&sources, normals);
        Ok(Binding { sources, skin })
    }
}

/// Vertices by the cell of a grid that they lie in.
struct Places<'a> {
    positions: &'a [[f32; 3]],
    normals: &'a [[f32; 3]],
    /// Also the width of a cell.
    tolerance: f64,
    cells: HashMap<[i64; 3], Vec<u32>>,
}

impl<'a> Places<'a> {
    fn new(positions: &'a [[f32; 3]], normals: &'a [[f32; 3]]) -> Self {
        let tolerance = tolerance(positions);
        let mut cells: HashMap<_, Vec<u32>> = HashMap::with_capacity(positions.len());
        for (position, number) in positions.iter().zip(0..) {
            cells.entry(cell(vector(position), tolerance)).or_default().push(number);
        }
        Self { positions, normals, tolerance, cells }
    }

    /// The vertex at a position whose normal is nearest; of equals the first one after `previous`, or else the first one.
    fn nearest(&self, position: DVec3, normal: DVec3, previous: Option<u32>) -> Option<u32> {
        let mut near: Vec<(f64, u32)> = self.around(position).collect();
        keep_smallest(&mut near, SAME_PLACE * self.tolerance);
        let difference = |vertex: u32| vector(&self.normals[vertex as usize]).distance(normal);
        near.iter_mut().for_each(|candidate| candidate.0 = difference(candidate.1));
        keep_smallest(&mut near, SAME_NORMAL);
        let after =
            near.iter().map(|candidate| candidate.1).filter(|&vertex| previous.is_none_or(|last| vertex > last));
        after.min().or_else(|| near.iter().map(|candidate| candidate.1).min())
    }

    /// Distance and number of all vertices within the tolerance.
    fn around(&self, position: DVec3) -> impl Iterator<Item = (f64, u32)> {
        let [x, y, z] = cell(position, self.tolerance);
        let neighbors = (0..27)
            .map(move |i| [x.saturating_add(i % 3 - 1), y.saturating_add(i / 3 % 3 - 1), z.saturating_add(i / 9 - 1)]);
        let vertices = neighbors.filter_map(|cell| self.cells.get(&cell)).flatten();
        vertices
            .map(move |&vertex| (vector(&self.positions[vertex as usize]).distance(position), vertex))
            .filter(|&(distance, _)| distance <= self.tolerance)
    }
}

/// Keeps what is no larger than the smallest and a tolerance; all where the numbers are undefined.
fn keep_smallest(candidates: &mut Vec<(f64, u32)>, tolerance: f64) {
    let smallest = candidates.iter().map(|candidate| candidate.0).fold(f64::INFINITY, f64::min);
    candidates.retain(|candidate| candidate.0.is_nan() || candidate.0 <= smallest + tolerance);
}

fn tolerance(positions: &[[f32; 3]]) -> f64 {
    let points = || positions.iter().map(vector);
    let low = points().fold(DVec3::INFINITY, DVec3::min);
    let high = points().fold(DVec3::NEG_INFINITY, DVec3::max);
    let largest = points().map(|point| point.abs().max_element()).fold(0.0, f64::max);
    let diagonal = if positions.is_empty() { 0.0 } else { low.distance(high) };
    (RELATIVE_TOLERANCE * diagonal + 4.0 * f64::from(f32::EPSILON) * largest).max(f64::from(f32::MIN_POSITIVE))
}

fn cell(position: DVec3, width: f64) -> [i64; 3] {
    position.to_array().map(|coordinate| (coordinate / width).floor() as i64)
}

fn vector(array: &[f32; 3]) -> DVec3 {
    DVec3::from(array.map(f64::from))
}
