//! Independent pieces of work, on all threads or on one: the only file that names rayon.

/// Calls `work` for every index of `0..n` and returns the results in order.
pub fn map<T: Send>(n: usize, work: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    #[cfg(feature = "threads")]
    {
        use rayon::prelude::*;
        (0..n).into_par_iter().with_max_len(1).map(work).collect()
    }
    #[cfg(not(feature = "threads"))]
    {
        (0..n).map(work).collect()
    }
}

/// Calls `work` for every index of `0..n`.
pub fn for_each(n: usize, work: impl Fn(usize) + Sync + Send) {
    #[cfg(feature = "threads")]
    {
        use rayon::prelude::*;
        (0..n).into_par_iter().with_max_len(1).for_each(work);
    }
    #[cfg(not(feature = "threads"))]
    {
        (0..n).for_each(work);
    }
}

/// Calls `work` with the index and the contents of each chunk of `chunk_len` elements.
pub fn for_each_chunk<T: Send>(data: &mut [T], chunk_len: usize, work: impl Fn(usize, &mut [T]) + Sync + Send) {
    #[cfg(feature = "threads")]
    {
        use rayon::prelude::*;
        data.par_chunks_mut(chunk_len).enumerate().for_each(|(i, chunk)| work(i, chunk));
    }
    #[cfg(not(feature = "threads"))]
    {
        data.chunks_mut(chunk_len).enumerate().for_each(|(i, chunk)| work(i, chunk));
    }
}

/// Runs `work` with `n_threads` threads (all processors where `None`); with those of the caller if they are as many.
pub fn with_threads<T: Send>(n_threads: Option<usize>, work: impl FnOnce() -> T + Send) -> T {
    #[cfg(feature = "threads")]
    if let Some(n) = n_threads
        && n != rayon::current_num_threads()
        && let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(n).build()
    {
        return pool.install(work);
    }
    let _ = n_threads;
    work()
}

/// Threads that [`map`] uses here.
pub fn n_threads() -> usize {
    #[cfg(feature = "threads")]
    {
        rayon::current_num_threads()
    }
    #[cfg(not(feature = "threads"))]
    {
        1
    }
}

#[cfg(all(test, feature = "threads"))]
mod tests {
    use super::*;

    #[test]
    fn work_has_the_threads_that_were_asked_for() {
        for n in [1, 2, 5] {
            with_threads(Some(n), || {
                assert_eq!(n_threads(), n);
                assert_eq!(with_threads(Some(n), n_threads), n);
                assert_eq!(with_threads(Some(3), n_threads), 3);
                assert_eq!(map(9, |i| i * i), [0, 1, 4, 9, 16, 25, 36, 49, 64]);
            });
        }
    }
}
