//! A look at some vertices before the bake.

use std::time::{Duration, Instant};

use glam::Vec3;

use super::{DirectPass, Ladder, ray_origins};
use crate::parallel::Threads;
use crate::{BakeOptions, Error, Mesh, Scene, TransferVectors, VertexStats};

/// A scene, and some points of its surface.
#[derive(Debug)]
pub(super) struct Pilot<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) scene: Scene,
    /// Shading normals of the points.
    pub(super) normals: Vec<[f32; 3]>,
    /// Where their rays start, in the frame that is traced in.
    pub(super) origins: Vec<Vec3>,
}

impl<'a> Pilot<'a> {
    /// The points are some vertices.
    pub(super) fn of_vertices(mesh: &'a Mesh, vertices: &[usize]) -> Self {
        let scene = Scene::new(mesh);
        let all = if vertices.is_empty() { Vec::new() } else { ray_origins(mesh, &scene) };
        let origins = vertices.iter().map(|&vertex| all[vertex]).collect();
        let normals = vertices.iter().map(|&vertex| mesh.normals()[vertex]).collect();
        Self { mesh, scene, normals, origins }
    }

    pub(super) fn direct<'b>(&'b self, ladder: &'b Ladder) -> DirectPass<'b> {
        DirectPass { mesh: self.mesh, scene: &self.scene, ladder, normals: &self.normals, origins: &self.origins }
    }
}

/// At most `count` of `all` numbers, evenly spaced: the order of a mesh, or of an atlas, mostly goes along the surface.
pub(super) fn spread(all: usize, count: usize) -> Vec<usize> {
    let count = count.min(all);
    (0..count).map(|number| (2 * number + 1) * all / (2 * count)).collect()
}

/// Transfer of some vertices of a mesh, made as [`bake_diffuse`](crate::bake_diffuse) makes it.
#[derive(Debug, Clone)]
pub struct VertexSample {
    /// One row for each vertex, of one channel: direct light alone.
    pub transfer: TransferVectors,
    /// What was found at each vertex; empty without shadows.
    pub stats: Vec<VertexStats>,
    /// Time to build the tree and the sets of directions.
    pub build: Duration,
    /// Time to trace and sum, that of all threads added up.
    pub trace: Duration,
}

/// Bakes direct light at some vertices, in the shadow of the whole mesh: to measure what options cost and bring before a mesh is baked with
/// them. The rows are those of a bake with the same options, bit for bit.
///
/// # Errors
/// If an option is out of range.
///
/// # Panics
/// If there is no vertex of some number.
pub fn bake_vertices(mesh: &Mesh, options: &BakeOptions, vertices: &[usize]) -> Result<VertexSample, Error> {
    options.validate()?;
    let normals: Vec<[f32; 3]> = vertices.iter().map(|&vertex| mesh.normals()[vertex]).collect();
    let mut transfer = TransferVectors::unshadowed(options.order, &normals);
    if !options.shadowed {
        return Ok(VertexSample { transfer, stats: Vec::new(), build: Duration::ZERO, trace: Duration::ZERO });
    }
    let start = Instant::now();
    let pilot = Pilot::of_vertices(mesh, vertices);
    let ladder = Ladder::new(options);
    let direct = pilot.direct(&ladder);
    let build = start.elapsed();
    let rows = transfer.values.chunks_exact_mut(options.order.coeff_count());
    let mut items: Vec<_> = rows.map(|row| (row, VertexStats::default(), Duration::ZERO)).collect();
    Threads::new(options.threads)?.for_each(
        &mut items,
        &(),
        || direct.scratch(),
        |scratch, number, (row, stats, time)| {
            let start = Instant::now();
            *stats = direct.shadowed_vector(scratch, number, row);
            *time = start.elapsed();
            u64::from(stats.rays)
        },
    )?;
    let (stats, times): (Vec<VertexStats>, Vec<Duration>) =
        items.iter().map(|(_, stats, time)| (*stats, *time)).unzip();
    Ok(VertexSample { transfer, stats, build, trace: times.iter().sum() })
}
