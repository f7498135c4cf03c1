//! Thread pool: independent pieces of work on all threads or on one. The only file that names rayon.
//!
//! The caller's thread works too, and pieces are handed out one by one in their order. Rayon's own loops run on its
//! threads only: the caller sleeps and has to be woken, and between two loops all threads look for work for a while. A
//! frame of a millisecond feels that.

#[cfg(feature = "threads")]
use std::cell::RefCell;
#[cfg(feature = "threads")]
use std::sync::atomic::{AtomicUsize, Ordering};
#[cfg(feature = "threads")]
use std::sync::{Arc, Mutex, OnceLock};

#[cfg(feature = "threads")]
use crate::locks::lock;

/// Calls `work` for every index of `0..n` and returns the results in order.
pub fn map<T: Send>(n: usize, work: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    let mut results: Vec<Option<T>> = Vec::new();
    results.resize_with(n, || None);
    share(results.iter_mut().enumerate(), |(i, result)| *result = Some(work(i)));
    // All pieces are done.
    results.into_iter().flatten().collect()
}

/// Calls `work` for every index of `0..n`.
pub fn for_each(n: usize, work: impl Fn(usize) + Sync + Send) {
    share(0..n, work);
}

/// Calls `work` with the index and the contents of each chunk of `chunk_len` elements.
pub fn for_each_chunk<T: Send>(data: &mut [T], chunk_len: usize, work: impl Fn(usize, &mut [T]) + Sync + Send) {
    share(data.chunks_mut(chunk_len).enumerate(), |(i, chunk)| work(i, chunk));
}

/// Calls `work` with every piece.
fn share<P: Send>(pieces: impl ExactSizeIterator<Item = P> + Send, work: impl Fn(P) + Sync) {
    #[cfg(feature = "threads")]
    {
        let n_helpers = pieces.len().min(n_threads()).saturating_sub(1);
        if n_helpers == 0 {
            return pieces.for_each(work);
        }
        let pieces = Mutex::new(pieces);
        let work_off = || {
            loop {
                // Not as the condition of the loop: that would keep the lock while a piece is worked on.
                let piece = lock(&pieces).next();
                let Some(piece) = piece else { return };
                work(piece);
            }
        };
        in_scope(|scope| {
            call_helper(scope, 0, n_helpers, &work_off);
            work_off();
        });
    }
    #[cfg(not(feature = "threads"))]
    pieces.for_each(work);
}

/// Runs `work` here, and waits for the helpers that it calls.
#[cfg(feature = "threads")]
fn in_scope<'a>(work: impl FnOnce(&rayon::Scope<'a>)) {
    match OWN.with_borrow(|own| own.as_ref().and_then(|own| own.helpers.clone())) {
        Some(helpers) => helpers.in_place_scope(work),
        None => match forked_pool(N_FORKS.load(Ordering::Relaxed)) {
            Some(pool) => pool.in_place_scope(work),
            None => rayon::in_place_scope(work),
        },
    }
}

/// How often this process and its ancestors were forked since the pool was made.
#[cfg(feature = "threads")]
static N_FORKS: AtomicUsize = AtomicUsize::new(0);

/// Declares that this process was just made by `fork`, which keeps no thread but the caller's: helpers are made anew.
/// Otherwise the first parallel work would wait for ever for the parent's threads.
pub fn after_fork() {
    #[cfg(feature = "threads")]
    N_FORKS.fetch_add(1, Ordering::Relaxed);
}

/// The thread pool of the `n`th process of a chain of forks; `None` for the first process, whose threads are rayon's
/// own, and where the system refuses threads.
#[cfg(feature = "threads")]
fn forked_pool(n: usize) -> Option<&'static rayon::ThreadPool> {
    /// One pool for each process of a chain: a lock that is held while forking stays held.
    static POOLS: [OnceLock<Option<rayon::ThreadPool>>; 8] = [const { OnceLock::new() }; 8];
    POOLS.get(n.checked_sub(1)?)?.get_or_init(|| rayon::ThreadPoolBuilder::new().build().ok()).as_ref()
}

/// Starts the `k`th of `n` helpers, which first starts two others: helpers are woken as a binary tree, since waking all
/// of them one by one would hold up the caller.
#[cfg(feature = "threads")]
fn call_helper<'a>(scope: &rayon::Scope<'a>, k: usize, n: usize, work_off: &'a (impl Fn() + Sync)) {
    if k < n {
        scope.spawn(move |scope| {
            call_helper(scope, 2 * k + 1, n, work_off);
            call_helper(scope, 2 * k + 2, n, work_off);
            work_off();
        });
    }
}

/// The calling thread and `n - 1` pool threads.
#[cfg(feature = "threads")]
#[derive(Clone)]
struct Threads {
    n: usize,
    /// Number of forks of the process when they were started.
    n_forks: usize,
    /// Pool of `n - 1` threads; `None` where that is 0.
    helpers: Option<Arc<rayon::ThreadPool>>,
}

#[cfg(feature = "threads")]
thread_local! {
    /// The caller's own threads, while it does not use the pool of all.
    static OWN: RefCell<Option<Threads>> = const { RefCell::new(None) };
}

/// Runs `work` with `n_threads` threads, the calling one among them. `None`, and the number that the caller has
/// already, keep its threads: all processors by default.
pub fn with_threads<T>(n_threads: Option<usize>, work: impl FnOnce() -> T) -> T {
    #[cfg(feature = "threads")]
    if let Some(n) = n_threads
        && n != self::n_threads()
        && let Some(own) = Threads::kept(n).or_else(|| Threads::new(n))
    {
        /// Restores the caller's threads, after a panic too, and keeps those that the work had for the next call.
        struct Before(Option<Threads>);
        impl Drop for Before {
            fn drop(&mut self) {
                if let Some(own) = OWN.replace(self.0.take()) {
                    own.keep();
                }
            }
        }
        let _before = Before(OWN.replace(Some(own)));
        return work();
    }
    let _ = n_threads;
    work()
}

/// Threads that no call uses at present: to start some takes as long as to draw a small picture.
#[cfg(feature = "threads")]
static KEPT: Mutex<Vec<Threads>> = Mutex::new(Vec::new());

/// Most calls whose threads are kept.
#[cfg(feature = "threads")]
const MAX_KEPT: usize = 4;

#[cfg(feature = "threads")]
impl Threads {
    /// `n` kept threads, for one call alone; `None` where there are none. Does not wait for the lock: after a fork,
    /// its owner may not exist in this process, and nobody would release it.
    fn kept(n: usize) -> Option<Self> {
        let mut kept = KEPT.try_lock().ok()?;
        let n_forks = N_FORKS.load(Ordering::Relaxed);
        let place = kept.iter().position(|own| own.n_forks == n_forks && own.n == n)?;
        Some(kept.swap_remove(place))
    }

    /// Keeps the threads for the next call.
    fn keep(self) {
        let n_forks = N_FORKS.load(Ordering::Relaxed);
        if self.n_forks != n_forks {
            // Threads of the process that this one was forked from, which are not here: their end would be waited for.
            std::mem::forget(self);
            return;
        }
        let Ok(mut kept) = KEPT.try_lock() else { return };
        kept.extract_if(.., |own| own.n_forks != n_forks).for_each(std::mem::forget);
        if kept.len() >= MAX_KEPT {
            kept.remove(0);
        }
        kept.push(self);
    }

    /// Starts the pool threads; `None` where the system refuses them.
    fn new(n: usize) -> Option<Self> {
        let helpers =
            if n > 1 { Some(Arc::new(rayon::ThreadPoolBuilder::new().num_threads(n - 1).build().ok()?)) } else { None };
        Some(Self { n, n_forks: N_FORKS.load(Ordering::Relaxed), helpers })
    }
}

/// Number of threads that the caller's work is shared among.
pub fn n_threads() -> usize {
    #[cfg(feature = "threads")]
    {
        OWN.with_borrow(|own| own.as_ref().map(|own| own.n)).unwrap_or_else(|| match N_FORKS.load(Ordering::Relaxed) {
            0 => rayon::current_num_threads(),
            n => forked_pool(n).map_or(1, rayon::ThreadPool::current_num_threads),
        })
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
    fn a_panic_reaches_the_caller_who_has_its_threads_back() {
        let n = n_threads();
        for n_threads in [1, 3] {
            let panic = std::panic::catch_unwind(|| {
                with_threads(Some(n_threads), || for_each(50, |i| assert!(i != 30, "thirty")));
            });
            assert_eq!(panic.unwrap_err().downcast_ref::<&str>(), Some(&"thirty"));
        }
        assert_eq!(n_threads(), n);
    }

    #[test]
    fn threads_are_kept_for_the_next_call_and_never_shared_by_two() {
        // No other test asks for as many.
        let ids = || {
            let barrier = std::sync::Barrier::new(7);
            let mut ids = map(7, |_| {
                barrier.wait();
                std::thread::current().id()
            });
            let own = std::thread::current().id();
            ids.retain(|id| *id != own);
            ids.sort_by_key(|id| format!("{id:?}"));
            ids
        };
        let first = with_threads(Some(7), ids);
        assert_eq!(first.len(), 6);
        assert_eq!(with_threads(Some(7), ids), first);
        let both_in = std::sync::Barrier::new(2);
        let call = || {
            with_threads(Some(7), || {
                both_in.wait();
                ids()
            })
        };
        let [one, other] = std::thread::scope(|scope| {
            let other = scope.spawn(call);
            [call(), other.join().unwrap()]
        });
        assert!(one.iter().all(|id| !other.contains(id)));
    }

    #[test]
    fn pieces_are_done_once_by_all_threads() {
        with_threads(Some(4), || {
            // One piece per thread, each of which waits for the others.
            let barrier = std::sync::Barrier::new(4);
            for_each(4, |_| {
                barrier.wait();
            });
            let mut numbers = vec![1; 103];
            for_each_chunk(&mut numbers, 10, |k, chunk| chunk.iter_mut().for_each(|number| *number += k));
            assert!(numbers.iter().enumerate().all(|(i, number)| *number == 1 + i / 10));
            // From within, too.
            assert_eq!(map(7, |i| map(i, |k| k).len()), [0, 1, 2, 3, 4, 5, 6]);
        });
        for_each(0, |_| unreachable!());
    }

    #[test]
    fn a_forked_process_has_threads_of_its_own() {
        assert!(forked_pool(1).unwrap().current_num_threads() >= 1);
        assert!(forked_pool(9).is_none(), "too long a chain: one thread");
    }

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
