//! Which face a texel shows.

use glam::DVec2;

use super::Coverage;
use super::layout::Layout;
use super::triangle::{covered_share, nearest};
use crate::{Error, Progress};

/// A texel that belongs to no face.
pub(super) const NO_FACE: u32 = u32::MAX;

/// A bilinear lookup anywhere on a face reads texels whose centres are nearer to it than this: the diagonal of a texel.
const LOOKUP_REACH: f64 = std::f64::consts::SQRT_2;

/// A centre within this of a face counts as on it: much more than the rounding of places on the largest atlas, which is 1e-12.
pub(super) const ON_FACE: f64 = 1e-6;

/// A centre this near to an edge counts as lying on it when overlaps are looked for: more than the rounding of a texture coordinate in
/// `f32` on the largest atlas, which is 1e-3 texels.
const EDGE_WIDTH: f64 = 0.01;

/// Faces that only meet cover the surroundings of a centre once. An edge that lies a little more and a little less than [`EDGE_WIDTH`] away
/// for its two faces makes it 1½ times; two layers of faces make it twice.
const MOST_COVERED: f32 = 1.75;

/// A face of which twice the area, in texels, is at most this fraction of its longest edge squared has no inside.
const DEGENERATE_ASPECT: f64 = 1e-9;

/// The face of each texel.
#[derive(Debug)]
pub(super) struct Raster {
    /// `[H, W]`; [`NO_FACE`] where there is none.
    pub(super) faces: Vec<u32>,
    /// `[H, W]`: inside, border or empty.
    pub(super) coverage: Vec<Coverage>,
    /// Texels whose centre lies in several faces.
    pub(super) overlapping: usize,
    /// `[T]`.
    pub(super) is_degenerate: Vec<bool>,
}

/// What is known of a texel while faces are laid down.
#[derive(Debug, Clone, Copy)]
struct Claim {
    face: u32,
    distance_squared: f64,
    /// How often faces cover the surroundings of the centre.
    covered: f32,
}

impl Claim {
    const NONE: Self = Self { face: NO_FACE, distance_squared: f64::INFINITY, covered: 0.0 };

    /// The nearest face wins; of several the one with the lowest number, which comes first.
    fn add(&mut self, face: u32, distance_squared: f64) {
        let distance_squared = if distance_squared <= ON_FACE * ON_FACE { 0.0 } else { distance_squared };
        if distance_squared < self.distance_squared {
            (self.face, self.distance_squared) = (face, distance_squared);
        }
    }

    fn coverage(&self) -> Coverage {
        match self.face {
            NO_FACE => Coverage::Empty,
            _ if self.distance_squared == 0.0 => Coverage::Inside,
            _ => Coverage::Border,
        }
    }
}

impl Raster {
    /// Lays down the faces one after another.
    ///
    /// # Errors
    /// [`Error::Cancelled`]; [`Error::Atlas`] if no texel belongs to a face.
    pub(super) fn new(layout: &Layout, progress: &dyn Progress) -> Result<Self, Error> {
        let mut claims = vec![Claim::NONE; layout.grid.texel_count()];
        let is_degenerate: Vec<bool> = (0..layout.face_count()).map(|face| is_degenerate(layout, face)).collect();
        for face in (0..layout.face_count()).filter(|&face| !is_degenerate[face]) {
            if progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            lay_down(layout, face, &mut claims);
        }
        let faces: Vec<u32> = claims.iter().map(|claim| claim.face).collect();
        if faces.iter().all(|&face| face == NO_FACE) {
            let count = layout.face_count();
            return Err(Error::Atlas(format!("none of its {count} faces has an area in texture coordinates")));
        }
        let coverage = claims.iter().map(Claim::coverage).collect();
        let overlapping = claims.iter().filter(|claim| claim.covered > MOST_COVERED).count();
        Ok(Self { faces, coverage, overlapping, is_degenerate })
    }

    /// How many texels have their centre on each face.
    pub(super) fn texels_of_faces(&self) -> Vec<usize> {
        let mut counts = vec![0; self.is_degenerate.len()];
        for (&face, _) in self.faces.iter().zip(&self.coverage).filter(|(_, coverage)| **coverage == Coverage::Inside) {
            counts[face as usize] += 1;
        }
        counts
    }
}

fn is_degenerate(layout: &Layout, face: usize) -> bool {
    let [a, b, c] = layout.corners(face);
    let longest = [b - a, c - b, a - c].into_iter().map(|edge| edge.length_squared()).fold(0.0, f64::max);
    (b - a).perp_dot(c - a).abs() <= DEGENERATE_ASPECT * longest
}

fn lay_down(layout: &Layout, face: usize, claims: &mut [Claim]) {
    let corners = layout.corners(face);
    let lower = corners[0].min(corners[1]).min(corners[2]) - LOOKUP_REACH - 0.5;
    let upper = corners[0].max(corners[1]).max(corners[2]) + LOOKUP_REACH - 0.5;
    for row in lower.y.ceil() as i64..=upper.y.floor() as i64 {
        for column in lower.x.ceil() as i64..=upper.x.floor() as i64 {
            let Some(texel) = layout.grid.texel(column, row) else { continue };
            let center = DVec2::new(column as f64 + 0.5, row as f64 + 0.5);
            let found = nearest(corners, center);
            if found.distance_squared < LOOKUP_REACH * LOOKUP_REACH {
                claims[texel].add(face as u32, found.distance_squared);
                claims[texel].covered += covered_share(corners, center, EDGE_WIDTH) as f32;
            }
        }
    }
}
