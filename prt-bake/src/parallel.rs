//! Spreading work over threads. The only file that knows whether there are any.

use crate::{Error, Progress};

/// Vertices that are handed out and reported together.
const BLOCK: usize = 16;

/// Threads of one bake.
#[derive(Debug)]
pub(crate) struct Threads {
    #[cfg(feature = "parallel")]
    pool: rayon::ThreadPool,
}

impl Threads {
    /// `None` takes as many as the machine has.
    pub(crate) fn new(count: Option<usize>) -> Result<Self, Error> {
        #[cfg(feature = "parallel")]
        {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(count.unwrap_or(0)).build();
            Ok(Self { pool: pool.map_err(|error| Error::Option(format!("cannot start threads: {error}")))? })
        }
        #[cfg(not(feature = "parallel"))]
        match count {
            None | Some(1) => Ok(Self {}),
            Some(count) => {
                Err(Error::Option(format!("{count} threads, but this build has one: enable feature `parallel`")))
            }
        }
    }

    pub(crate) fn count(&self) -> usize {
        #[cfg(feature = "parallel")]
        return self.pool.current_num_threads();
        #[cfg(not(feature = "parallel"))]
        1
    }

    /// Calls `work(scratch, block)` once for each block; it returns the numbers of vertices and of rays that it did.
    ///
    /// # Errors
    /// What `work` returns first, or [`Error::Cancelled`] if the caller asked to stop; then some blocks were not worked on.
    pub(crate) fn for_each_block<B: Sync, S>(
        &self,
        blocks: &[B],
        progress: &dyn Progress,
        new_scratch: impl Fn() -> S + Sync + Send,
        work: impl Fn(&mut S, &B) -> Result<(usize, u64), Error> + Sync + Send,
    ) -> Result<(), Error> {
        let do_block = |scratch: &mut S, block: &B| {
            if progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            let (vertices, rays) = work(scratch, block)?;
            progress.advance(vertices, rays);
            Ok(())
        };
        #[cfg(feature = "parallel")]
        {
            use rayon::prelude::*;
            self.pool.install(|| blocks.par_iter().try_for_each_init(new_scratch, do_block))
        }
        #[cfg(not(feature = "parallel"))]
        {
            let mut scratch = new_scratch();
            blocks.iter().try_for_each(|block| do_block(&mut scratch, block))
        }
    }

    /// Calls `work(scratch, number, item)` once for each item; it returns the number of rays that it traced.
    ///
    /// # Errors
    /// [`Error::Cancelled`] if the caller asked to stop; then some items were not worked on.
    pub(crate) fn for_each<T: Send, S>(
        &self,
        items: &mut [T],
        progress: &dyn Progress,
        new_scratch: impl Fn() -> S + Sync + Send,
        work: impl Fn(&mut S, usize, &mut T) -> u64 + Sync + Send,
    ) -> Result<(), Error> {
        let do_block = |scratch: &mut S, (block, items): (usize, &mut [T])| {
            if progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            let rays = (block * BLOCK..).zip(&mut *items).map(|(number, item)| work(scratch, number, item)).sum();
            progress.advance(items.len(), rays);
            Ok(())
        };
        #[cfg(feature = "parallel")]
        {
            use rayon::prelude::*;
            self.pool.install(|| items.par_chunks_mut(BLOCK).enumerate().try_for_each_init(new_scratch, do_block))
        }
        #[cfg(not(feature = "parallel"))]
        {
            let mut scratch = new_scratch();
            items.chunks_mut(BLOCK).enumerate().try_for_each(|block| do_block(&mut scratch, block))
        }
    }
}
