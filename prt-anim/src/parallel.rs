//! Spreading work over threads. The only file that knows whether there are any.

#[cfg(feature = "parallel")]
use rayon::prelude::*;

/// Items that a thread takes at least: posing a vertex takes about 100 ns, handing out work some microseconds.
#[cfg(feature = "parallel")]
const BLOCK: usize = 512;

/// `out[i] = make(i)` for all `i`.
pub(crate) fn fill<T: Send>(out: &mut [T], make: impl Fn(usize) -> T + Sync + Send) {
    #[cfg(feature = "parallel")]
    out.par_iter_mut().with_min_len(BLOCK).enumerate().for_each(|(i, item)| *item = make(i));
    #[cfg(not(feature = "parallel"))]
    out.iter_mut().enumerate().for_each(|(i, item)| *item = make(i));
}

/// `(a[i], b[i], c[i]) = make(i)` for all `i`.
pub(crate) fn fill_three<A: Send, B: Send, C: Send>(
    (a, b, c): (&mut [A], &mut [B], &mut [C]),
    make: impl Fn(usize) -> (A, B, C) + Sync + Send,
) {
    let set = |(i, ((a, b), c)): (usize, ((&mut A, &mut B), &mut C))| (*a, *b, *c) = make(i);
    #[cfg(feature = "parallel")]
    a.par_iter_mut().zip(b).zip(c).with_min_len(BLOCK).enumerate().for_each(set);
    #[cfg(not(feature = "parallel"))]
    a.iter_mut().zip(b).zip(c).enumerate().for_each(set);
}
