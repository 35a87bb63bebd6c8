//! The first pass: rays from every vertex.

use std::time::Instant;

use super::Part;
use super::block::HitLists;
use super::blocks::Blocks;
use super::journal::Journal;
use crate::diffuse::{DirectPass, ErrorProbe, Ladder, Scratch, ValidityTest, ray_origins};
use crate::parallel::Threads;
use crate::{BakeOptions, BakeReport, Error, Mesh, Pass, Progress, Scene, VertexStats};

/// Traces from the vertices of a part that the journal does not have yet.
pub(super) fn trace(
    mesh: &Mesh,
    options: &BakeOptions,
    part: Part,
    journal: &Journal,
    threads: &Threads,
    progress: &dyn Progress,
    report: &mut BakeReport,
) -> Result<(), Error> {
    let blocks = Blocks::of(mesh.positions().len(), options.rays_per_vertex);
    let all = part.blocks(blocks.count());
    let vertex_count = |numbers: &[u32]| numbers.iter().map(|&block| blocks.vertices(block).len()).sum::<usize>();
    let (done, missing): (Vec<u32>, Vec<u32>) = all.partition(|&block| journal.has_block(block, options.bounces > 0));
    report.vertices_resumed = vertex_count(&done);
    progress.start(Pass::Direct, vertex_count(&done) + vertex_count(&missing));
    progress.advance(vertex_count(&done), 0);
    if missing.is_empty() {
        return Ok(());
    }
    let start = Instant::now();
    let scene = Scene::new(mesh);
    let origins = ray_origins(mesh, &scene);
    let ladder = Ladder::new(options);
    let direct = DirectPass { mesh, scene: &scene, ladder: &ladder, normals: mesh.normals(), origins: &origins };
    let probe = ErrorProbe::new(options, mesh.positions().len());
    let validity = ValidityTest::new(&scene, mesh);
    let tracer = Tracer { direct, validity, probe, keep_hits: options.bounces > 0, blocks, journal, progress };
    report.build = start.elapsed();
    threads.for_each_block(
        &missing,
        progress,
        || tracer.direct.scratch(),
        |scratch, &block| tracer.block(scratch, block),
    )
}

/// All that the blocks of the first pass share.
struct Tracer<'a> {
    direct: DirectPass<'a>,
    validity: ValidityTest<'a>,
    probe: Option<ErrorProbe>,
    keep_hits: bool,
    blocks: Blocks,
    journal: &'a Journal,
    progress: &'a dyn Progress,
}

impl Tracer<'_> {
    /// Traces from the vertices of a block and writes down what was found. Returns the numbers of vertices and of rays.
    fn block(&self, scratch: &mut Scratch, block: u32) -> Result<(usize, u64), Error> {
        let vertices = self.blocks.vertices(block);
        let length = self.direct.ladder.order.coeff_count();
        let mut rows = vec![0.0; vertices.len() * length];
        let mut stats = vec![VertexStats::default(); vertices.len()];
        let (mut hits, mut found) = (HitLists::default(), Vec::new());
        for ((vertex, row), stats) in vertices.clone().zip(rows.chunks_exact_mut(length)).zip(&mut stats) {
            if self.progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            *stats = self.direct.shadowed_vector(scratch, vertex, row);
            self.validity.complete(self.direct.normals[vertex], self.direct.origins[vertex], stats);
            if self.keep_hits {
                found.clear();
                stats.rays += self.direct.nearest_hits(scratch, vertex, &mut found);
                hits.push(found.iter().copied());
            }
            if let Some(probe) = self.probe.as_ref().filter(|probe| probe.samples(vertex)) {
                stats.error = probe.estimate(&self.direct, scratch, vertex, row);
            }
        }
        if self.keep_hits {
            self.journal.append_hits(block, &hits)?;
        }
        self.journal.append_stats(0, block, &stats)?;
        self.journal.append_rows(0, block, &rows)?;
        Ok((vertices.len(), stats.iter().map(|stats| u64::from(stats.rays)).sum()))
    }
}
