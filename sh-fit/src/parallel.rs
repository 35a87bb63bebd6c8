//! Spreading work over threads. The only file that knows whether there are any.

use crate::Error;

/// Items that are handed out together: a few hundred microseconds of work.
const BLOCK: usize = 8;

/// Threads of one fit.
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

    /// Calls `work(scratch, number, item)` once for each item, and `progress` with the number of items that were done.
    pub(crate) fn for_each<T: Send, S>(
        &self,
        items: &mut [T],
        progress: &(dyn Fn(usize) + Sync),
        new_scratch: impl Fn() -> S + Sync + Send,
        work: impl Fn(&mut S, usize, &mut T) + Sync + Send,
    ) {
        let do_block = |scratch: &mut S, (block, items): (usize, &mut [T])| {
            (block * BLOCK..).zip(&mut *items).for_each(|(number, item)| work(scratch, number, item));
            progress(items.len());
        };
        #[cfg(feature = "parallel")]
        {
            use rayon::prelude::*;
            self.pool.install(|| items.par_chunks_mut(BLOCK).enumerate().for_each_init(new_scratch, do_block));
        }
        #[cfg(not(feature = "parallel"))]
        {
            let mut scratch = new_scratch();
            items.chunks_mut(BLOCK).enumerate().for_each(|block| do_block(&mut scratch, block));
        }
    }
}
