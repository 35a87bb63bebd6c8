//! What is kept of a block of vertices or texels, as bytes.

use std::ops::Range;

use super::blocks::Blocks;
use super::journal::{Journal, Key};
use crate::diffuse::HitRecord;
use crate::{Error, VertexStats};

/// Pass under which the transfer of texels is kept; that of vertices is kept under its bounce, direct light under 0.
pub(crate) const TEXELS: usize = 0x4000_0000;
/// What is added to a pass to keep the statistics of its vertices or texels.
const STATS: u32 = 0x8000_0000;
/// Pass under which the hits are kept along which light is reflected.
const HITS: u32 = 0x8000_0001;
/// Bytes of the statistics of a vertex.
const STATS_SIZE: usize = 20;

/// Hits of some vertices, one list after another.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct HitLists {
    /// Where the hits of each vertex end.
    ends: Vec<usize>,
    records: Vec<HitRecord>,
}

impl HitLists {
    /// Adds the list of the next vertex.
    pub(crate) fn push(&mut self, hits: impl IntoIterator<Item = HitRecord>) {
        self.records.extend(hits);
        self.ends.push(self.records.len());
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &[HitRecord]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.records[start..end])
    }
}

impl Journal {
    /// Whether the transfer that a pass brings to a block is there.
    pub(crate) fn has_rows(&self, pass: usize, block: u32) -> bool {
        self.contains(key(pass as u32, block))
    }

    /// Whether all of the first pass of a block is there, with the hits if light is reflected.
    pub(crate) fn has_block(&self, block: u32, has_hits: bool) -> bool {
        let is_there = |pass| self.contains(key(pass, block));
        is_there(0) && is_there(STATS) && (!has_hits || is_there(HITS))
    }

    /// Whether all of a block of texels is there.
    pub(crate) fn has_texels(&self, block: u32) -> bool {
        [TEXELS as u32, STATS | TEXELS as u32].iter().all(|&pass| self.contains(key(pass, block)))
    }

    /// The blocks that a pass has brought transfer to, and whose statistics are there.
    pub(crate) fn blocks_of(&self, pass: usize) -> impl Iterator<Item = u32> {
        let pass = pass as u32;
        let blocks = self.keys().into_iter().filter(move |key| key.pass == pass).map(|key| key.block);
        blocks.filter(move |&block| self.contains(key(STATS | pass, block)))
    }

    pub(crate) fn append_rows(&self, pass: usize, block: u32, rows: &[f32]) -> Result<(), Error> {
        let bytes: Vec<u8> = rows.iter().flat_map(|value| value.to_le_bytes()).collect();
        self.append(key(pass as u32, block), &bytes)
    }

    /// Reads the transfer of a block into `rows`.
    pub(crate) fn read_rows(&self, pass: usize, block: u32, rows: &mut [f32]) -> Result<(), Error> {
        let bytes = self.read_exactly(key(pass as u32, block), 4 * rows.len())?;
        rows.iter_mut().zip(bytes.as_chunks().0).for_each(|(value, &bytes)| *value = f32::from_le_bytes(bytes));
        Ok(())
    }

    pub(crate) fn append_stats(&self, pass: usize, block: u32, stats: &[VertexStats]) -> Result<(), Error> {
        let bytes: Vec<u8> = stats.iter().flat_map(stats_to_bytes).collect();
        self.append(key(STATS | pass as u32, block), &bytes)
    }

    /// Reads the statistics of a block into `stats`.
    fn read_stats(&self, pass: usize, block: u32, stats: &mut [VertexStats]) -> Result<(), Error> {
        let bytes = self.read_exactly(key(STATS | pass as u32, block), STATS_SIZE * stats.len())?;
        stats.iter_mut().zip(bytes.as_chunks().0).for_each(|(stats, bytes)| *stats = stats_from_bytes(bytes));
        Ok(())
    }

    /// The statistics of the vertices, or texels, of some blocks.
    ///
    /// - `pass`: 0 or [`TEXELS`]
    pub(crate) fn all_stats(
        &self,
        pass: usize,
        blocks: Blocks,
        numbers: Range<u32>,
    ) -> Result<Vec<VertexStats>, Error> {
        let mut all = Vec::new();
        for block in numbers {
            let first = all.len();
            all.resize(first + blocks.vertices(block).len(), VertexStats::default());
            self.read_stats(pass, block, &mut all[first..])?;
        }
        Ok(all)
    }

    pub(crate) fn append_hits(&self, block: u32, hits: &HitLists) -> Result<(), Error> {
        let mut bytes = Vec::with_capacity(8 * hits.ends.len() + HitRecord::SIZE * hits.records.len());
        hits.ends.iter().for_each(|&end| bytes.extend_from_slice(&(end as u64).to_le_bytes()));
        hits.records.iter().for_each(|record| bytes.extend_from_slice(&record.to_bytes()));
        self.append(key(HITS, block), &bytes)
    }

    /// Reads the hits of a block of `vertex_count` vertices, on faces below `face_count`.
    pub(crate) fn read_hits(&self, block: u32, vertex_count: usize, face_count: usize) -> Result<HitLists, Error> {
        let mut bytes = Vec::new();
        self.read(key(HITS, block), &mut bytes)?;
        let wrong = || self.malformed(format!("the hits of block {block} do not fit together"));
        let (ends, records) = bytes.split_at_checked(8 * vertex_count).ok_or_else(wrong)?;
        let (records, rest) = records.as_chunks();
        let hits = HitLists {
            ends: ends.as_chunks().0.iter().map(|&end| u64::from_le_bytes(end) as usize).collect(),
            records: records.iter().map(HitRecord::from_bytes).collect(),
        };
        let is_right = rest.is_empty()
            && hits.ends.is_sorted()
            && hits.ends.last().copied().unwrap_or(0) == hits.records.len()
            && hits.records.iter().all(|record| (record.triangle() as usize) < face_count);
        if is_right { Ok(hits) } else { Err(wrong()) }
    }

    fn read_exactly(&self, key: Key, size: usize) -> Result<Vec<u8>, Error> {
        let mut bytes = Vec::new();
        self.read(key, &mut bytes)?;
        if bytes.len() == size {
            return Ok(bytes);
        }
        let reason = format!("block {} of pass {:#x} has {} bytes instead of {size}", key.block, key.pass, bytes.len());
        Err(self.malformed(reason))
    }
}

impl Key {
    /// Whether the record is of a block of texels.
    pub(super) fn is_of_texels(self) -> bool {
        self.pass & !STATS == TEXELS as u32
    }
}

fn key(pass: u32, block: u32) -> Key {
    Key { pass, block }
}

fn stats_to_bytes(stats: &VertexStats) -> [u8; STATS_SIZE] {
    let VertexStats { directions, occluded, rays, error, validity } = *stats;
    let mut bytes = [0; STATS_SIZE];
    let words = [directions, occluded, rays, error.to_bits(), validity.to_bits()];
    bytes.as_chunks_mut().0.iter_mut().zip(words).for_each(|(bytes, word)| *bytes = word.to_le_bytes());
    bytes
}

fn stats_from_bytes(bytes: &[u8; STATS_SIZE]) -> VertexStats {
    let word = |k: usize| u32::from_le_bytes(std::array::from_fn(|byte| bytes[4 * k + byte]));
    VertexStats {
        directions: word(0),
        occluded: word(1),
        rays: word(2),
        error: f32::from_bits(word(3)),
        validity: f32::from_bits(word(4)),
    }
}
