//! What all bakes into a file have in common.

use std::path::Path;

use super::header::Header;
use super::journal::Journal;
use crate::{BakeReport, BakedSurface, Error, Metadata, Source, TexelTransfer, TransferVectors};

/// A bake in blocks.
pub(super) trait Job {
    /// What comes of it.
    type Baked: Baked;

    fn header(&self) -> &Header;

    /// Traces the blocks that the journal does not have yet; none where transfer follows from the normals.
    fn trace(&mut self, journal: &Journal) -> Result<(), Error>;

    /// What it takes to put parts together where the scene is not.
    fn surface(&self, source: Option<&Source>) -> Result<Vec<u8>, Error>;

    /// Puts the result together from the blocks of the whole.
    fn finish(self, journal: &Journal, source: Option<&Source>) -> Result<(Self::Baked, BakeReport), Error>;

    /// What there is to tell of a part.
    fn into_report(self) -> BakeReport;
}

/// The result of a bake.
pub(super) trait Baked {
    fn metadata(&self) -> &Metadata;
    fn metadata_mut(&mut self) -> &mut Metadata;
    fn transfer(&self) -> &TransferVectors;

    /// Writes the file; returns its size.
    fn write_to(&self, path: &Path) -> Result<u64, Error>;

    /// Takes down where it comes from.
    fn complete(&mut self, header: &Header, source: Option<&Source>) {
        let metadata = self.metadata_mut();
        metadata.identity = Some(header.identity());
        metadata.source = source.cloned();
    }
}

impl Baked for BakedSurface {
    fn metadata(&self) -> &Metadata {
        &self.metadata
    }

    fn metadata_mut(&mut self) -> &mut Metadata {
        &mut self.metadata
    }

    fn transfer(&self) -> &TransferVectors {
        &self.transfer
    }

    fn write_to(&self, path: &Path) -> Result<u64, Error> {
        self.write(path)
    }
}

impl Baked for TexelTransfer {
    fn metadata(&self) -> &Metadata {
        &self.metadata
    }

    fn metadata_mut(&mut self) -> &mut Metadata {
        &mut self.metadata
    }

    fn transfer(&self) -> &TransferVectors {
        &self.transfer
    }

    fn write_to(&self, path: &Path) -> Result<u64, Error> {
        self.write_exr(path)
    }
}
