//! Progress callbacks of Python, and Ctrl-C.

use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, ThreadId};
use std::time::{Duration, Instant};

use pyo3::prelude::*;
use wavesplat::ProgressCallback;

/// Calls a Python function with the progress, from any thread, at most every few hundredths of a second; stops when it
/// returns False or when the caller is interrupted.
pub(crate) struct PyProgress {
    callback: Option<Py<PyAny>>,
    state: Mutex<ProgressState>,
    /// The Python thread that called, which takes part in drawing: only there can signals be checked.
    caller: ThreadId,
    interrupted: AtomicBool,
}

struct ProgressState {
    reported_at: Option<Instant>,
    checked_at: Instant,
    error: Option<PyErr>,
}

/// Interval of callbacks: short enough for a smooth bar, long enough to cost nothing.
const PROGRESS_EVERY: Duration = Duration::from_millis(40);

/// Interval of checks for signals: short enough for a prompt Ctrl-C. Longer than [`PROGRESS_EVERY`], since for a check
/// the caller waits for the interpreter lock, five milliseconds where other threads run Python.
const SIGNALS_EVERY: Duration = Duration::from_millis(100);

impl PyProgress {
    pub(crate) fn new(callback: Option<Py<PyAny>>) -> Self {
        let state = Mutex::new(ProgressState { reported_at: None, checked_at: Instant::now(), error: None });
        Self { callback, state, caller: thread::current().id(), interrupted: AtomicBool::new(false) }
    }

    /// Runs `work` without the interpreter lock; an error that stopped it takes the place of its result.
    pub(crate) fn watch<T: Send>(&self, py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
        let result = py.detach(work);
        let error = self.state.lock().ok().and_then(|mut state| state.error.take());
        error.map_or(Ok(result), Err)
    }

    /// Checks for signals, if called on the caller's thread.
    fn look_out(&self) {
        if thread::current().id() != self.caller {
            return;
        }
        let Ok(mut state) = self.state.try_lock() else { return };
        if state.checked_at.elapsed() >= SIGNALS_EVERY {
            #[expect(clippy::redundant_closure_for_method_calls, reason = "the method alone is not general enough")]
            let signals = Python::attach(|py| py.check_signals());
            if let Err(error) = signals {
                state.error = Some(error);
                self.interrupted.store(true, Ordering::Relaxed);
            }
            state.checked_at = Instant::now();
        }
    }

    /// Calls the Python function. False stops, any other result continues; an exception stops and reaches the caller.
    fn ask(&self, callback: &Py<PyAny>, fraction: f32) -> ControlFlow<()> {
        let Ok(mut state) = self.state.try_lock() else { return ControlFlow::Continue(()) };
        if fraction < 1.0 && state.reported_at.is_some_and(|at| at.elapsed() < PROGRESS_EVERY) {
            return ControlFlow::Continue(());
        }
        state.reported_at = Some(Instant::now());
        let answer = Python::attach(|py| {
            let answer = callback.call1(py, (fraction,))?;
            PyResult::Ok(answer.is_none(py) || answer.extract::<bool>(py).unwrap_or(true))
        });
        match answer {
            Ok(true) => ControlFlow::Continue(()),
            Ok(false) => ControlFlow::Break(()),
            Err(error) => {
                state.error = Some(error);
                ControlFlow::Break(())
            }
        }
    }
}

impl ProgressCallback for PyProgress {
    fn progress(&self, fraction: f32) -> ControlFlow<()> {
        self.look_out();
        if self.interrupted.load(Ordering::Relaxed) {
            return ControlFlow::Break(());
        }
        self.callback.as_ref().map_or(ControlFlow::Continue(()), |callback| self.ask(callback, fraction))
    }
}
