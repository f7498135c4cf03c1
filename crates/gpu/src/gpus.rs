//! The GPUs of a process: opened at first use, kept, opened once more when they are lost.

use std::sync::atomic::{AtomicBool, AtomicU32, AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex};
use std::time::Duration;

use wavesplat_compute::locks::lock;
use wavesplat_splat::picture::base_picture::BasePicture;
use wavesplat_splat::render::plan::Plan;
use wavesplat_splat::render::progress::ProgressCallback;
use wavesplat_splat::source::slices::Slices;

use crate::adapter::{Adapter, Choice, resolved};
use crate::draw::Schedule;
use crate::failure::{Failure, GpuResult};
use crate::gpu::{DEFAULT_BUDGET_BYTES, Gpu};
use crate::report::GpuReport;

/// Longest wait at the end of a process for a GPU that is being opened.
const MAX_WAITING: Duration = Duration::from_secs(10);

/// Choice of the device that draws.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum DeviceChoice {
    /// The CPU.
    #[default]
    Cpu,
    /// The best GPU where there is one, from the second frame of a process on, once it is open: opening takes as long
    /// as some frames do, which the CPU draws meanwhile.
    Auto,
    /// This GPU, opened if it is not open; the CPU where the GPU cannot draw.
    Gpu(Choice),
}

/// A frame that a GPU drew.
pub struct DrawnOnGpu {
    /// Base planes, in the order and layout of the CPU's `draw_base_planes`.
    pub pictures: Vec<BasePicture>,
    /// Cost of the frame.
    pub report: GpuReport,
    /// The GPU that drew.
    pub adapter: Adapter,
    /// Reason why the GPU was opened once more, if it was.
    pub reopened: Option<String>,
}

/// GPUs by choice: open, being opened, or refused. [`Gpus::of_process`] has the GPUs of this process.
#[derive(Default)]
pub struct Gpus {
    opened: Mutex<Vec<(Choice, Opened)>>,
    /// Signalled when `opened` changes.
    changed: Condvar,
    /// Budget for samples per GPU in bytes; 0: [`DEFAULT_BUDGET_BYTES`].
    budget_bytes: AtomicUsize,
    /// Frames that were asked for with [`DeviceChoice::Auto`].
    n_asked: AtomicUsize,
    /// Whether fetches and texels are counted.
    counts: AtomicBool,
    /// Whether self-tests are made to fail.
    fails: AtomicBool,
    /// The process that opened them: a forked one cannot use them. 0: none yet.
    process: AtomicU32,
}

/// State of a chosen GPU.
#[derive(Clone)]
enum Opened {
    /// A thread is opening the GPU.
    Opening,
    Open(Arc<Gpu>),
    Refused(Failure),
}

static PROCESS: Gpus = Gpus {
    opened: Mutex::new(Vec::new()),
    changed: Condvar::new(),
    budget_bytes: AtomicUsize::new(0),
    n_asked: AtomicUsize::new(0),
    counts: AtomicBool::new(false),
    fails: AtomicBool::new(false),
    process: AtomicU32::new(0),
};

impl Gpus {
    /// The GPUs of this process.
    pub fn of_process() -> &'static Self {
        &PROCESS
    }

    /// Sets the budget for samples per GPU in bytes; what does not fit is drawn in pages.
    pub fn set_budget(&self, budget_bytes: usize) {
        self.budget_bytes.store(budget_bytes, Ordering::Relaxed);
    }

    /// Budget for samples per GPU in bytes.
    pub fn budget_bytes(&self) -> usize {
        match self.budget_bytes.load(Ordering::Relaxed) {
            0 => DEFAULT_BUDGET_BYTES,
            n => n,
        }
    }

    /// Turns counting of fetches and texels on or off for the next frames; for benchmarks without a GPU.
    pub fn set_counts(&self, counts: bool) {
        self.counts.store(counts, Ordering::Relaxed);
    }

    /// Makes the self-tests of GPUs that are opened from now on fail, or pass again; for tests of faulty devices.
    pub fn set_self_test_fails(&self, fails: bool) {
        self.fails.store(fails, Ordering::Relaxed);
    }

    /// Waits until no thread is opening a GPU: drivers do not cope with a process that ends meanwhile.
    pub fn settle(&self) {
        if self.is_forked_child() {
            return;
        }
        let opened = lock(&self.opened);
        let is_opening =
            |opened: &mut Vec<(Choice, Opened)>| opened.iter().any(|(_, slot)| matches!(slot, Opened::Opening));
        // The time limit keeps a driver that hangs from blocking the program's exit.
        drop(self.changed.wait_timeout_while(opened, MAX_WAITING, is_opening));
    }

    /// Whether this process is a fork of one that has asked for GPUs: drivers do not survive a fork.
    pub fn is_forked_child(&self) -> bool {
        let own = std::process::id();
        let first = self.process.compare_exchange(0, own, Ordering::Relaxed, Ordering::Relaxed);
        first.is_err_and(|process| process != own)
    }

    /// Draws the base planes of a plan, as the CPU's `draw_base_planes` does. `slices`: one per layer. A lost GPU is
    /// opened once more.
    pub fn draw_base_planes(
        &'static self,
        choice: &DeviceChoice,
        plan: &Plan,
        slices: &[&Slices],
        callback: &dyn ProgressCallback,
    ) -> GpuResult<DrawnOnGpu> {
        let budget_bytes = self.budget_bytes();
        let (choice, gpu) = match choice {
            DeviceChoice::Cpu => return Err(Failure::DrawnByCpu("the CPU was asked for".to_owned())),
            DeviceChoice::Auto => (&Choice::Best, self.open_beside(&Choice::Best)?),
            DeviceChoice::Gpu(choice) => (choice, self.open(choice)?),
        };
        let schedule = Schedule { counts: self.counts.load(Ordering::Relaxed), ..Schedule::default() };
        let first = draw(&gpu, (budget_bytes, schedule), plan, slices, callback);
        let Err(Failure::Lost(why)) = first else { return first };
        self.forget(choice);
        let gpu = self.open(choice)?;
        match draw(&gpu, (budget_bytes, schedule), plan, slices, callback) {
            Ok(drawn) => Ok(DrawnOnGpu { reopened: Some(why), ..drawn }),
            Err(failure) => {
                if matches!(failure, Failure::Lost(_)) {
                    // A GPU that is lost again and again is left alone.
                    self.set(choice, Opened::Refused(failure.clone()));
                }
                Err(failure)
            }
        }
    }

    /// Opens a GPU, or returns the one that is open.
    pub fn open(&self, choice: &Choice) -> GpuResult<Arc<Gpu>> {
        if self.is_forked_child() {
            return Err(Failure::DrawnByCpu("a process that was made by forking draws on the CPU".to_owned()));
        }
        match self.slot(choice) {
            Some(Opened::Open(gpu)) => Ok(gpu),
            Some(Opened::Refused(failure)) => Err(failure),
            // No waiting for another thread that is opening it: that one may never finish.
            Some(Opened::Opening) | None => self.open_now(choice),
        }
    }

    /// Opens and tests a GPU of its own, beside one that may be open.
    pub fn tested(&self, choice: &Choice) -> GpuResult<Gpu> {
        if self.is_forked_child() {
            return Err(Failure::DrawnByCpu("a process that was made by forking draws on the CPU".to_owned()));
        }
        std::panic::catch_unwind(|| Gpu::open(choice, self.budget_bytes()))
            .unwrap_or_else(|_| Err(Failure::Refused("opening the GPU ended in a panic".to_owned())))
    }

    fn open_now(&self, choice: &Choice) -> GpuResult<Arc<Gpu>> {
        // All choices that stand for one GPU share its device.
        let open: Vec<Arc<Gpu>> = {
            let opened = lock(&self.opened);
            let open = opened.iter().filter_map(|(_, slot)| match slot {
                Opened::Open(gpu) if gpu.lost().is_none() => Some(gpu.clone()),
                _ => None,
            });
            open.collect()
        };
        // Enumerating adapters takes a while, and there is nothing to share where no GPU is open.
        let adapter = if open.is_empty() { None } else { std::panic::catch_unwind(|| resolved(choice)).ok() };
        let same =
            adapter.and_then(Result::ok).and_then(|wanted| open.into_iter().find(|gpu| *gpu.adapter() == wanted));
        if let Some(gpu) = same {
            self.set(choice, Opened::Open(gpu.clone()));
            return Ok(gpu);
        }
        // A panic on the way to the driver must not end the program.
        let fails = self.fails.load(Ordering::Relaxed);
        let open = || Gpu::open_with(choice, DEFAULT_BUDGET_BYTES, fails).map(Arc::new);
        let opened = std::panic::catch_unwind(open)
            .unwrap_or_else(|_| Err(Failure::Refused("opening the GPU ended in a panic".to_owned())));
        let slot = match &opened {
            Ok(gpu) => Opened::Open(gpu.clone()),
            Err(failure) => Opened::Refused(failure.clone()),
        };
        self.set(choice, slot);
        opened
    }

    /// The GPU if it is open; else an error, and from the second frame on a thread that opens it.
    fn open_beside(&'static self, choice: &Choice) -> GpuResult<Arc<Gpu>> {
        if self.is_forked_child() {
            return self.open(choice);
        }
        let is_first = self.n_asked.fetch_add(1, Ordering::Relaxed) == 0;
        match self.slot(choice) {
            Some(Opened::Open(gpu)) => return Ok(gpu),
            Some(Opened::Refused(failure)) => return Err(failure),
            Some(Opened::Opening) => {}
            None if !may_have_gpu() => {
                return Err(Failure::NoAdapter("no GPU was found: the system has no device file of one".to_owned()));
            }
            None if is_first => {
                let why = "the first frame of a process is drawn by the CPU; a GPU is opened beside the next";
                return Err(Failure::DrawnByCpu(why.to_owned()));
            }
            None => {
                self.set(choice, Opened::Opening);
                let wanted = choice.clone();
                let opens = std::thread::Builder::new().name("wavesplat-gpu".to_owned());
                if let Err(error) = opens.spawn(move || self.open_now(&wanted).map(|_| ())) {
                    self.forget(choice);
                    return Err(Failure::Refused(error.to_string()));
                }
            }
        }
        Err(Failure::DrawnByCpu("the GPU is being opened; the CPU draws meanwhile".to_owned()))
    }

    fn slot(&self, choice: &Choice) -> Option<Opened> {
        let opened = lock(&self.opened);
        opened.iter().find(|(own, _)| own == choice).map(|(_, slot)| slot.clone())
    }

    fn set(&self, choice: &Choice, slot: Opened) {
        let mut opened = lock(&self.opened);
        opened.retain(|(own, _)| own != choice);
        opened.push((choice.clone(), slot));
        self.changed.notify_all();
    }

    /// Drops a GPU; the next use opens it anew.
    pub fn forget(&self, choice: &Choice) {
        lock(&self.opened).retain(|(own, _)| own != choice);
    }
}

fn draw(
    gpu: &Gpu,
    (budget_bytes, schedule): (usize, Schedule),
    plan: &Plan,
    slices: &[&Slices],
    callback: &dyn ProgressCallback,
) -> GpuResult<DrawnOnGpu> {
    gpu.set_budget(budget_bytes);
    let (pictures, report) = gpu.draw_base_planes_by(schedule, plan, slices, callback)?;
    Ok(DrawnOnGpu { pictures, report, adapter: gpu.adapter().clone(), reopened: None })
}

/// Whether the system has a device file of a GPU: no driver need be loaded to see that there is none.
fn may_have_gpu() -> bool {
    if !cfg!(target_os = "linux") {
        return true;
    }
    let has_render_node = has_file("/dev/dri", |name| name.starts_with("renderD"));
    let is_card = |name: &str| name == "dxg" || name.strip_prefix("nvidia").is_some_and(|n| n.parse::<u32>().is_ok());
    has_render_node || has_file("/dev", is_card)
}

/// Whether a folder has a file whose name satisfies `is_wanted`.
fn has_file(folder: &str, is_wanted: impl Fn(&str) -> bool) -> bool {
    let mut files = std::fs::read_dir(folder).into_iter().flatten().flatten();
    files.any(|file| is_wanted(&file.file_name().to_string_lossy()))
}
