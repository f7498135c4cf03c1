//! Progress of a frame, told to a callback that may cancel it.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Told about progress from worker threads; may stop the work.
pub trait ProgressCallback: Sync {
    /// `fraction` of the work that is done, `0..=1`. `Break` stops; the result is then
    /// [`wavesplat_core::Error::Cancelled`].
    fn progress(&self, fraction: f32) -> ControlFlow<()>;
}

/// A monitor that does not mind.
impl ProgressCallback for () {
    fn progress(&self, _: f32) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// Tells a monitor of tiles that are done, and remembers that it asked to stop.
pub(crate) struct Progress<'a> {
    monitor: &'a dyn ProgressCallback,
    n_done: AtomicUsize,
    n_all: usize,
    stopped: AtomicBool,
}

impl<'a> Progress<'a> {
    /// Of this many tiles.
    pub(crate) fn new(monitor: &'a dyn ProgressCallback, n_all: usize) -> Self {
        Self { monitor, n_done: AtomicUsize::new(0), n_all, stopped: AtomicBool::new(false) }
    }

    /// Whether the monitor asked to stop.
    pub(crate) fn is_stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }

    /// One more is done.
    pub(crate) fn tile_done(&self) {
        let done = self.n_done.fetch_add(1, Ordering::Relaxed) + 1;
        if self.monitor.progress(done as f32 / self.n_all as f32).is_break() {
            self.stopped.store(true, Ordering::Relaxed);
        }
    }
}
