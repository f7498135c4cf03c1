//! Progress of a frame, reported to a callback that may cancel it.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Called from worker threads with the progress of a frame; may cancel it.
pub trait ProgressCallback: Sync {
    /// Receives the `fraction` of the work that is done, `0..=1`. `Break` stops the frame; the result is then
    /// [`wavesplat_core::Error::Cancelled`].
    fn progress(&self, fraction: f32) -> ControlFlow<()>;
}

/// No progress reports; never cancels.
impl ProgressCallback for () {
    fn progress(&self, _: f32) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// Progress of a part of the work, reported as a range of the whole.
pub struct ProgressPart<'a> {
    /// Callback of the whole work.
    pub of: &'a dyn ProgressCallback,
    /// Progress of the whole when the part begins.
    pub from: f32,
    /// Progress of the whole when the part ends.
    pub to: f32,
}

impl ProgressCallback for ProgressPart<'_> {
    fn progress(&self, fraction: f32) -> ControlFlow<()> {
        self.of.progress(self.from + (self.to - self.from) * fraction)
    }
}

/// Counter of the tiles of a frame that are done, which calls the callback and remembers that it asked to stop.
pub struct Progress<'a> {
    callback: &'a dyn ProgressCallback,
    n_done: AtomicUsize,
    n_all: usize,
    stopped: AtomicBool,
}

impl<'a> Progress<'a> {
    /// Progress over `n_all` tiles, none done yet.
    pub fn new(callback: &'a dyn ProgressCallback, n_all: usize) -> Self {
        Self { callback, n_done: AtomicUsize::new(0), n_all, stopped: AtomicBool::new(false) }
    }

    /// Whether the callback asked to stop.
    pub fn is_stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }

    /// Calls the callback in the middle of a slow tile; returns whether it asked to stop.
    pub fn ask(&self) -> bool {
        let done = self.n_done.load(Ordering::Relaxed);
        if self.callback.progress(done as f32 / self.n_all as f32).is_break() {
            self.stopped.store(true, Ordering::Relaxed);
        }
        self.is_stopped()
    }

    /// Counts one more tile as done and calls the callback.
    pub fn tile_done(&self) {
        let done = self.n_done.fetch_add(1, Ordering::Relaxed) + 1;
        if self.callback.progress(done as f32 / self.n_all as f32).is_break() {
            self.stopped.store(true, Ordering::Relaxed);
        }
    }
}
