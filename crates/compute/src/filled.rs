//! Arrays filled chunk by chunk, each just before it is worked on, while it is in the cache.
//!
//! Filled as a whole first, a large array goes through memory twice.
#![allow(unsafe_code, reason = "memory that nothing has been written to yet")]

use std::mem::MaybeUninit;
use std::ptr;

use crate::{pages, parallel};

/// Array of `n` zeros (default values), worked on chunk by chunk as it is filled.
///
/// `work` gets the index and the contents of each chunk of `chunk_len`. Filling with one constant value lets zeros be
/// written in the fastest way that there is.
pub fn in_chunks<T: Copy + Default + Send>(
    n: usize,
    chunk_len: usize,
    work: impl Fn(usize, &mut [T]) + Sync + Send,
) -> Vec<T> {
    let mut all = Vec::with_capacity(n);
    let places = &mut all.spare_capacity_mut()[..n];
    pages::prefer_large(places);
    parallel::for_each_chunk(places, chunk_len, |k, chunk| {
        chunk.fill(MaybeUninit::new(T::default()));
        // SAFETY: all of it has just been written, and `MaybeUninit` has the layout of what it holds.
        work(k, unsafe { &mut *(ptr::from_mut(chunk) as *mut [T]) });
    });
    // SAFETY: there is room for as many, and all chunks have been written.
    unsafe { all.set_len(n) };
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunks_are_filled_and_then_worked_on() {
        for (n, chunk_len) in [(0, 3), (2, 3), (3, 3), (100, 7)] {
            let numbers = in_chunks(n, chunk_len, |k, chunk: &mut [u32]| {
                assert!(chunk.iter().all(|x| *x == 0) && chunk.len() == chunk_len.min(n - k * chunk_len));
                chunk[0] = k as u32 + 1;
            });
            let want = |i: usize| if i.is_multiple_of(chunk_len) { (i / chunk_len) as u32 + 1 } else { 0 };
            assert_eq!(numbers, (0..n).map(want).collect::<Vec<_>>());
        }
    }
}
