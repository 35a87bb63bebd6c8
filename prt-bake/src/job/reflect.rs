//! The further passes: light that arrives after reflections. Source: [SKS02](sh_core#references) section 5.

use sh_core::Order;

use super::blocks::Blocks;
use super::journal::Journal;
use crate::diffuse::{InsidePlan, Reflection};
use crate::parallel::Threads;
use crate::{Error, Pass, Progress, TransferVectors};

/// A journal with all blocks of direct light, and the surface that reflects it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reflector<'a> {
    pub(crate) journal: &'a Journal,
    pub(crate) triangles: &'a [[u32; 3]],
    pub(crate) blocks: Blocks,
    /// Of the result: colour is carried only if it is reflected.
    pub(crate) channels: usize,
    pub(crate) order: Order,
    /// How many bounces to follow.
    pub(crate) bounces: usize,
    /// Stop after a bounce that adds less than this share of the length of the direct transfer.
    pub(crate) threshold: Option<f64>,
    /// What replaces the transfer of vertices inside of solids, in every pass.
    pub(crate) inside: &'a InsidePlan,
    pub(crate) threads: &'a Threads,
}

impl Reflector<'_> {
    /// Follows the bounces that were asked for, and writes down what each adds. Returns the lengths of what they added, relative to direct
    /// transfer.
    pub(crate) fn reflect(&self, progress: &dyn Progress) -> Result<Vec<f64>, Error> {
        let mut added = Vec::new();
        if self.bounces == 0 {
            return Ok(added);
        }
        // The transfer of the pass before: the only array of the size of the output that is held.
        let mut before = self.read_pass(0)?;
        let direct_length = length(&before);
        for bounce in 1..=self.bounces {
            progress.start(Pass::Bounce(bounce), self.blocks.vertex_count());
            self.bounce(bounce, before, progress)?;
            before = self.read_pass(bounce)?;
            let share = length(&before) / direct_length.max(f64::MIN_POSITIVE);
            added.push(share);
            if self.threshold.is_some_and(|threshold| share < threshold) {
                break;
            }
        }
        Ok(added)
    }

    /// One more bounce, for the blocks that the journal does not have yet.
    fn bounce(&self, bounce: usize, before: TransferVectors, progress: &dyn Progress) -> Result<(), Error> {
        let blocks = self.blocks;
        let (done, missing): (Vec<u32>, Vec<u32>) =
            (0..blocks.count()).partition(|&block| self.journal.has_rows(bounce, block));
        progress.advance(done.iter().map(|&block| blocks.vertices(block).len()).sum(), 0);
        let reflection = Reflection::new(self.triangles, before);
        self.threads.for_each_block(&missing, progress, Vec::new, |sum, &block| {
            let vertices = blocks.vertices(block);
            let hits = self.journal.read_hits(block, vertices.len(), self.triangles.len())?;
            let mut rows = Vec::with_capacity(vertices.len() * reflection.row_length());
            for hits in hits.iter() {
                reflection.gather(hits, sum);
                rows.extend(sum.iter().map(|&value| value as f32));
            }
            self.journal.append_rows(bounce, block, &rows)?;
            Ok((vertices.len(), 0))
        })
    }

    /// The transfer that a pass brought, in the channels of the result.
    fn read_pass(&self, pass: usize) -> Result<TransferVectors, Error> {
        let channels = self.channels;
        let read_channels = if pass == 0 { 1 } else { channels };
        let mut transfer = TransferVectors::zero(self.blocks.vertex_count(), channels, self.order);
        let length = self.order.coeff_count();
        let mut rows = Vec::new();
        for block in 0..self.blocks.count() {
            let vertices = self.blocks.vertices(block);
            rows.resize(vertices.len() * read_channels * length, 0.0);
            self.journal.read_rows(pass, block, &mut rows)?;
            let out = &mut transfer.values[vertices.start * channels * length..];
            let copies = channels / read_channels;
            for (out, row) in out.chunks_exact_mut(copies * length).zip(rows.chunks_exact(length)) {
                out.chunks_exact_mut(length).for_each(|out| out.copy_from_slice(row));
            }
        }
        self.inside.apply(&mut transfer);
        Ok(transfer)
    }

    /// Direct light alone, of one channel.
    pub(crate) fn direct(&self) -> Result<TransferVectors, Error> {
        Self { channels: 1, ..*self }.read_pass(0)
    }

    /// The light of all passes together, in the order in which they came.
    pub(crate) fn total(&self, bounces: usize) -> Result<TransferVectors, Error> {
        let mut total = self.read_pass(0)?;
        let length = total.channels * self.order.coeff_count();
        let mut rows = Vec::new();
        for bounce in 1..=bounces {
            for block in 0..self.blocks.count() {
                let vertices = self.blocks.vertices(block);
                rows.resize(vertices.len() * length, 0.0);
                self.journal.read_rows(bounce, block, &mut rows)?;
                let sums = &mut total.values[vertices.start * length..];
                sums.iter_mut().zip(&rows).for_each(|(sum, &added)| *sum += added);
            }
        }
        self.inside.apply(&mut total);
        Ok(total)
    }
}

fn length(transfer: &TransferVectors) -> f64 {
    transfer.values.iter().map(|&value| f64::from(value).powi(2)).sum::<f64>().sqrt()
}
