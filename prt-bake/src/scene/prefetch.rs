//! Asking for memory before it is used.
//!
//! A tree of a hundred thousand triangles is larger than the second cache, and what a packet visits next is known some time before. On
//! `dragon_100k` any hits are 6 to 9 % faster for it and nearest hits 10 %; nothing is lost where all is in the cache.

/// Bytes that are fetched together.
const LINE: usize = 64;

/// Begins to load a value into the cache. Changes nothing else.
#[inline(always)]
#[cfg(target_arch = "x86_64")]
#[expect(unsafe_code, reason = "the instruction has no safe form; it never faults, and reads nothing that can be seen")]
pub(super) fn prefetch<T>(value: &T) {
    use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
    let start = (&raw const *value).cast::<i8>();
    for line in 0..size_of::<T>().div_ceil(LINE) {
        // SAFETY: SSE is part of x86-64; any address may be given.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(start.wrapping_add(line * LINE)) };
    }
}

#[inline(always)]
#[cfg(not(target_arch = "x86_64"))]
pub(super) fn prefetch<T>(_value: &T) {}
