//! All of an atlas but its transfer: what it takes to finish it where the mesh is not.

use glam::{DVec2, Vec3};
use serde::{Deserialize, Serialize};

use super::edges::smooth_neighbors;
use super::grid::Grid;
use super::layout::Layout;
use super::points::Points;
use super::raster::Raster;
use super::seam::{self, Cut};
use super::{Coverage, TexelOptions, TexelReport};
use crate::{BakeOptions, Error, Mesh, Progress, Scene, Source};

/// Bytes of a cut: two sides with two ends of two coordinates.
const CUT_SIZE: usize = 8 * 8;

/// All of an atlas but its transfer.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct AtlasPlan {
    pub(super) grid: Grid,
    /// `[H, W]`: inside, border or empty.
    pub(super) coverage: Vec<Coverage>,
    /// Where lookups on two sides of an edge should agree.
    pub(super) cuts: Vec<Cut>,
    pub(crate) head: Head,
}

/// What is a few numbers and names.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Head {
    size: [usize; 2],
    wraps: [bool; 2],
    v_up: bool,
    overlapping: usize,
    degenerate: usize,
    wrapped: usize,
    without_center: usize,
    per_face: usize,
    /// Bounces that were followed.
    pub(crate) bounces: usize,
    pub(crate) source: Option<Source>,
}

impl AtlasPlan {
    pub(super) fn new(layout: &Layout, raster: &Raster) -> Self {
        let counts = raster.texels_of_faces().into_iter().zip(&raster.is_degenerate);
        let mut counts: Vec<usize> = counts.filter(|&(_, &degenerate)| !degenerate).map(|(count, _)| count).collect();
        counts.sort_unstable();
        let grid = layout.grid;
        let head = Head {
            size: [grid.width, grid.height],
            wraps: grid.wraps,
            v_up: grid.v_up,
            overlapping: raster.overlapping,
            degenerate: raster.is_degenerate.iter().filter(|&&degenerate| degenerate).count(),
            wrapped: (0..layout.face_count()).filter(|&face| layout.is_wrapped(face)).count(),
            without_center: counts.partition_point(|&count| count == 0),
            per_face: counts.get(counts.len() / 2).copied().unwrap_or_default(),
            ..Head::default()
        };
        Self { grid, coverage: raster.coverage.clone(), cuts: seam::cuts(layout), head }
    }

    /// Whether it is as large as was asked for, and the same way up.
    pub(crate) fn is_of(&self, texels: &TexelOptions) -> bool {
        let Grid { width, height, v_up, .. } = self.grid;
        (width, height, v_up) == (texels.width, texels.height, texels.v_up)
    }

    pub(crate) fn texel_count(&self) -> usize {
        self.coverage.len()
    }

    /// Texels that a point of the surface is baked for, in their order.
    pub(crate) fn baked(&self) -> impl Iterator<Item = u32> + '_ {
        (0..).zip(&self.coverage).filter(|(_, coverage)| coverage.is_baked()).map(|(texel, _)| texel)
    }

    /// What the report says of the atlas, without its transfer.
    pub(super) fn report(&self) -> TexelReport {
        let Head { overlapping, degenerate, wrapped, without_center, per_face, .. } = self.head;
        TexelReport {
            texels_overlapping: overlapping,
            faces_degenerate: degenerate,
            faces_wrapped: wrapped,
            faces_without_center: without_center,
            texels_per_face: per_face,
            ..TexelReport::default()
        }
    }

    /// Length of the head, the head, a byte for each texel, the cuts.
    pub(crate) fn to_bytes(&self, source: Option<&Source>) -> Vec<u8> {
        let head = serde_json::json!(Head { source: source.cloned(), ..self.head.clone() }).to_string();
        let mut bytes = Vec::with_capacity(8 + head.len() + self.coverage.len() + CUT_SIZE * self.cuts.len());
        bytes.extend_from_slice(&(head.len() as u64).to_le_bytes());
        bytes.extend_from_slice(head.as_bytes());
        bytes.extend(self.coverage.iter().map(|coverage| (4.0 * coverage.value()) as u8));
        let coordinates = self.cuts.iter().flatten().flatten().flat_map(DVec2::to_array);
        bytes.extend(coordinates.flat_map(f64::to_le_bytes));
        bytes
    }

    /// Reads what [`to_bytes`](Self::to_bytes) made; says what is wrong with it.
    pub(crate) fn from_bytes(bytes: &[u8]) -> Result<Self, String> {
        let fail = |what: &str| Err(format!("its atlas {what}"));
        let Some((length, rest)) = bytes.split_first_chunk() else { return fail("has no head") };
        let Some((head, rest)) = rest.split_at_checked(u64::from_le_bytes(*length) as usize) else {
            return fail("has no head");
        };
        let head: Head = serde_json::from_slice(head).map_err(|error| format!("its atlas: {error}"))?;
        let [width, height] = head.size;
        if ![width, height].iter().all(|size| (1..=TexelOptions::MAX_SIZE).contains(size)) {
            return fail("has no size");
        }
        let Some((coverage, cuts)) = rest.split_at_checked(width * height) else { return fail("ends early") };
        let coverage: Option<Vec<Coverage>> =
            coverage.iter().map(|&byte| Coverage::of_value(0.25 * f32::from(byte))).collect();
        let Some(coverage) = coverage else { return fail("has an unknown mark of coverage") };
        let (cuts, rest) = cuts.as_chunks::<CUT_SIZE>();
        if !rest.is_empty() {
            return fail("ends in the middle of a cut");
        }
        let grid = Grid { width, height, wraps: head.wraps, v_up: head.v_up };
        Ok(Self { grid, coverage, cuts: cuts.iter().map(cut).collect(), head })
    }
}

fn cut(bytes: &[u8; CUT_SIZE]) -> Cut {
    let coordinate = |k: usize| f64::from_le_bytes(std::array::from_fn(|byte| bytes[8 * k + byte]));
    [0, 1].map(|side| [0, 1].map(|end| DVec2::new(coordinate(4 * side + 2 * end), coordinate(4 * side + 2 * end + 1))))
}

/// A mesh laid out on texels.
#[derive(Debug)]
pub(crate) struct LaidOut<'a> {
    pub(super) layout: Layout<'a>,
    pub(super) raster: Raster,
    pub(crate) plan: AtlasPlan,
    /// Texels that a point of the surface is baked for, in their order.
    pub(crate) texels: Vec<u32>,
}

impl<'a> LaidOut<'a> {
    /// # Errors
    /// [`Error::Option`] if the atlas is too large; [`Error::Atlas`] if the mesh cannot be laid out; [`Error::Cancelled`].
    pub(crate) fn new(
        mesh: &'a Mesh,
        options: &BakeOptions,
        texels: &TexelOptions,
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        texels.validate(options.order, options.channel_count(mesh))?;
        let layout = Layout::new(mesh, texels)?;
        let raster = Raster::new(&layout, progress)?;
        let plan = AtlasPlan::new(&layout, &raster);
        let texels = plan.baked().collect();
        Ok(Self { layout, raster, plan, texels })
    }

    /// Adds the shading normals of some of the texels that are baked, and where their rays start.
    pub(crate) fn add_points(
        &self,
        scene: &Scene,
        numbers: Vec<usize>,
        normals: &mut Vec<[f32; 3]>,
        origins: &mut Vec<Vec3>,
    ) {
        let points = Points::new(self, scene, &smooth_neighbors(&self.layout), numbers);
        normals.extend(points.normals);
        origins.extend(points.origins);
    }

    pub(crate) fn mesh(&self) -> &'a Mesh {
        self.layout.mesh
    }
}
