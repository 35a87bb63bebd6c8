//! What vertices inside of solids get instead of their own black transfer.

use glam::DVec3;

use super::nearest::NearestPoint;
use crate::mesh::weld_positions;
use crate::{InsidePolicy, TransferVectors};

/// A vertex is filled from at most this many others: those that weigh most.
const MAX_SOURCES: usize = 4;

/// Edges count as at least this share of the distance to the farthest neighbour, so that copies at one position do not weigh infinitely.
const SHORTEST_EDGE: f64 = 1e-3;

/// A valid vertex, and its weight.
pub(crate) type VertexWeight = (u32, f32);

/// For each invalid vertex the valid ones whose transfer it takes.
///
/// Applied to the transfer of a pass it changes invalid vertices alone and reads valid ones alone: one vertex needs but the rows of
/// its sources. The rows it makes are weighted means, so that it adds no energy.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct InsidePlan {
    /// Numbers of the vertices that are replaced, ascending.
    vertices: Vec<u32>,
    /// For each of them where its sources end in `sources`; they begin where those of the one before end.
    ends: Vec<usize>,
    sources: Vec<VertexWeight>,
}

impl InsidePlan {
    /// Decides for every vertex that is not valid.
    ///
    /// [`InsidePolicy::Fill`] takes the mean of the neighbours along edges, weighted by the inverse of the length of the edge, ring by ring
    /// from the valid vertices inwards. What no edge leads to is filled across coincident positions (copies at creases), and
    /// a part without any valid vertex from the valid vertex nearest in space. If no vertex at all is valid, nothing is replaced.
    ///
    /// # Panics
    /// If `positions` and `is_valid` differ in length.
    pub(crate) fn new(policy: InsidePolicy, triangles: &[[u32; 3]], positions: &[[f64; 3]], is_valid: &[bool]) -> Self {
        assert_eq!(positions.len(), is_valid.len(), "a position for each vertex");
        let invalid: Vec<u32> =
            (0..).zip(is_valid).filter(|(_, is_valid)| !**is_valid).map(|(vertex, _)| vertex).collect();
        if policy == InsidePolicy::Keep || invalid.is_empty() {
            return Self::default();
        }
        if policy == InsidePolicy::Black {
            return Self { ends: vec![0; invalid.len()], vertices: invalid, sources: Vec::new() };
        }
        if invalid.len() == is_valid.len() {
            return Self::default();
        }
        let mut filling = Filling::new(positions, is_valid);
        filling.grow(&Links::along_edges(triangles, filling.is_valid, None));
        if filling.is_open(&invalid) {
            let welded = weld_positions(positions);
            filling.grow(&Links::along_edges(triangles, filling.is_valid, Some(&welded)));
        }
        filling.take_nearest(&invalid);
        Self::from_lists(invalid, &filling.sources)
    }

    fn from_lists(vertices: Vec<u32>, lists: &[Vec<VertexWeight>]) -> Self {
        let mut plan = Self { vertices, ..Self::default() };
        for &vertex in &plan.vertices {
            plan.sources.extend(&lists[vertex as usize]);
            plan.ends.push(plan.sources.len());
        }
        plan
    }

    /// What replaces the transfer of a vertex: `None` if it stays; else valid vertices and their weights, which add up to 1, and
    /// none if it becomes black.
    pub(crate) fn sources(&self, vertex: usize) -> Option<&[VertexWeight]> {
        let place = self.vertices.binary_search(&u32::try_from(vertex).ok()?).ok()?;
        let start = if place == 0 { 0 } else { self.ends[place - 1] };
        Some(&self.sources[start..self.ends[place]])
    }

    /// Numbers of the vertices that are replaced, ascending.
    pub(crate) fn vertices(&self) -> &[u32] {
        &self.vertices
    }

    /// Replaces the transfer of the invalid vertices.
    pub(crate) fn apply(&self, transfer: &mut TransferVectors) {
        let row_length = transfer.channels * transfer.order.coeff_count();
        let mut sum = vec![0.0; row_length];
        for &vertex in self.vertices() {
            sum.fill(0.0);
            for &(source, weight) in self.sources(vertex as usize).unwrap_or_default() {
                let row = &transfer.values[source as usize * row_length..][..row_length];
                sum.iter_mut().zip(row).for_each(|(sum, &value)| *sum += f64::from(weight) * f64::from(value));
            }
            let row = &mut transfer.values[vertex as usize * row_length..][..row_length];
            row.iter_mut().zip(&sum).for_each(|(value, &sum)| *value = sum as f32);
        }
    }
}

/// The neighbours of the invalid vertices.
#[derive(Debug)]
struct Links {
    /// Pairs of an invalid vertex and a neighbour, sorted.
    pairs: Vec<[u32; 2]>,
}

impl Links {
    /// Along the edges of faces, and, if the first vertex at each position is given, between a vertex and the first one at its position.
    fn along_edges(triangles: &[[u32; 3]], is_valid: &[bool], first_at_position: Option<&[u32]>) -> Self {
        let edges = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let copies =
            first_at_position.into_iter().flat_map(|first| (0..).zip(first).map(|(copy, &first)| [copy, first]));
        let mut pairs: Vec<[u32; 2]> = edges
            .chain(copies)
            .flat_map(|[a, b]| [[a, b], [b, a]])
            .filter(|&[from, to]| from != to && !is_valid[from as usize])
            .collect();
        pairs.sort_unstable();
        pairs.dedup();
        Self { pairs }
    }

    fn of(&self, vertex: u32) -> impl Iterator<Item = u32> {
        let start = self.pairs.partition_point(|[from, _]| *from < vertex);
        self.pairs[start..].iter().take_while(move |[from, _]| *from == vertex).map(|[_, to]| *to)
    }
}

/// Sources as they spread from the valid vertices.
#[derive(Debug)]
struct Filling<'a> {
    positions: &'a [[f64; 3]],
    is_valid: &'a [bool],
    /// For each vertex its sources; none for valid vertices and for those that were not reached.
    sources: Vec<Vec<VertexWeight>>,
}

impl<'a> Filling<'a> {
    fn new(positions: &'a [[f64; 3]], is_valid: &'a [bool]) -> Self {
        Self { positions, is_valid, sources: vec![Vec::new(); is_valid.len()] }
    }

    fn is_filled(&self, vertex: u32) -> bool {
        self.is_valid[vertex as usize] || !self.sources[vertex as usize].is_empty()
    }

    fn is_open(&self, invalid: &[u32]) -> bool {
        invalid.iter().any(|&vertex| !self.is_filled(vertex))
    }

    /// Fills ring by ring all that links lead to.
    fn grow(&mut self, links: &Links) {
        let mut ring: Vec<u32> =
            links.pairs.iter().filter(|[_, to]| self.is_filled(*to)).map(|[from, _]| *from).collect();
        loop {
            ring.sort_unstable();
            ring.dedup();
            ring.retain(|&vertex| !self.is_filled(vertex));
            if ring.is_empty() {
                return;
            }
            let lists: Vec<_> = ring.iter().map(|&vertex| self.blend(vertex, links)).collect();
            for (&vertex, list) in ring.iter().zip(lists) {
                self.sources[vertex as usize] = list;
            }
            ring = ring.iter().flat_map(|&vertex| links.of(vertex)).collect();
        }
    }

    /// The mean of what the filled neighbours of a vertex take, weighted by the inverse of their distance.
    fn blend(&self, vertex: u32, links: &Links) -> Vec<VertexWeight> {
        let neighbours: Vec<u32> = links.of(vertex).filter(|&neighbour| self.is_filled(neighbour)).collect();
        let position = |vertex: u32| DVec3::from_array(self.positions[vertex as usize]);
        let distance = |&neighbour: &u32| position(vertex).distance(position(neighbour));
        let farthest = neighbours.iter().map(distance).fold(f64::MIN_POSITIVE, f64::max);
        let mut entries: Vec<(u32, f64)> = Vec::new();
        for neighbour in &neighbours {
            let weight = 1.0 / (distance(neighbour) / farthest).max(SHORTEST_EDGE);
            match &*self.sources[*neighbour as usize] {
                [] => entries.push((*neighbour, weight)),
                list => entries.extend(list.iter().map(|&(source, share)| (source, weight * f64::from(share)))),
            }
        }
        heaviest(entries)
    }

    /// Fills what was not reached from the valid vertex that is nearest in space.
    fn take_nearest(&mut self, invalid: &[u32]) {
        if !self.is_open(invalid) {
            return;
        }
        let position = |vertex: u32| DVec3::from_array(self.positions[vertex as usize]);
        let valid = (0..).zip(self.is_valid).filter(|(_, is_valid)| **is_valid);
        let tree = NearestPoint::new(valid.map(|(vertex, _)| (position(vertex), vertex)).collect());
        for &vertex in invalid {
            if self.sources[vertex as usize].is_empty() {
                self.sources[vertex as usize] =
                    tree.find(position(vertex)).map(|source| (source, 1.0)).into_iter().collect();
            }
        }
    }
}

/// The sources of the largest weights, each once, with weights that add up to 1.
fn heaviest(mut entries: Vec<(u32, f64)>) -> Vec<VertexWeight> {
    entries.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    entries.dedup_by(|next, kept| {
        let is_same = next.0 == kept.0;
        kept.1 += if is_same { next.1 } else { 0.0 };
        is_same
    });
    entries.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    entries.truncate(MAX_SOURCES);
    let sum: f64 = entries.iter().map(|(_, weight)| weight).sum();
    entries.into_iter().map(|(source, weight)| (source, (weight / sum) as f32)).collect()
}

#[cfg(test)]
#[path = "inside_tests.rs"]
mod tests;
